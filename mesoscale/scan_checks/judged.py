"""The scan is the judge: surfaces made from a description are pressed beside the scans."""

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from mesoscale.contact import run_cycle
from mesoscale.inputs.contact import ContactInputs
from mesoscale.scan_checks.surface import contacting_heights
from mesoscale.settings import ContactSettings, TopographySettings
from mesoscale.settings.contact import NOMINAL_SEED
from mesoscale.topography.description.heights import common_heights, height_quantiles
from mesoscale.topography.description.intervals import CONFIDENCE, REACH, student_reach
from mesoscale.topography.description.one_spectrum import OneSpectrum, merge
from mesoscale.topography.description.parameters import Topography, analyse
from mesoscale.topography.description.trusted_range import TrustedSpectrum
from mesoscale.topography.height_synthesis import synthesize_heights
from mesoscale.topography.measurements.cleaning import Scan, clean
from mesoscale.topography.roughness_spectrum import RoughSpectrum, SpectrumTable
from mesoscale.topography.synthesis import synthesize_spectrum

Array = np.ndarray
# share of the cell; beyond, contacts have merged and asperities one by one say nothing
MOST_CONTACT = 0.5
LOADS_NN = (1000.0, 7000.0)  # per cell of the contact settings: 1 and 7 uN


@dataclass(frozen=True)
class Described:
    """A description of a surface from which surfaces are drawn.

    Attributes
    ----------
    topography, one : eq. 9, and the measured spectrum where that is used.
    heights : maps of heights that the scans allow (`height_synthesis.Z`); none for normal heights.
    """

    topography: Topography
    merged: OneSpectrum | None
    heights: tuple[tuple[float, ...], ...]

    def spectra(self, count: int) -> Iterator[Callable[[Array], Array]]:
        """`count` spectra C(q) that the measurements allow for a place of the surface."""
        from scipy.special import ndtri

        # spread evenly, the first ones too: twenty random places can have half of the film's
        # scatter
        golden = 0.5 * (5.0**0.5 - 1.0)  # its multiples (modulo 1) are spread evenly, however many
        places = ndtri((np.arange(count) + 0.5) * golden % 1.0)
        if self.merged is not None:
            scatter = self.merged.place_sd
            for psd, place in zip(
                self.merged.draws(places=False, count=count), places, strict=True
            ):
                # as the contact's own surfaces
                yield SpectrumTable(*self.merged.carried_on(psd * math.exp(scatter * place))).psd
            return
        rng = np.random.default_rng(1)
        estimates, fitted = self.topography.estimates, self.topography.likelihood
        rms = estimates["rms"]
        error = 0.5 * math.log(rms.interval[1] / rms.interval[0]) / REACH  # of the typical place
        if fitted is not None:  # and one more place besides
            error = math.hypot(error, fitted.amplitude_sd / 2)
        for place in places:
            q0, slope = (rng.uniform(*estimates[name].scatter) for name in ("q0", "slope"))
            rms_nm = rms.value * math.exp(error * place)
            yield RoughSpectrum.from_rms(rms_nm, q0, slope, self.topography.cutoff).psd


def judge(
    scans: Sequence[Scan],
    spectra: Sequence[TrustedSpectrum],
    name: str,
    inputs: ContactInputs,
    settings: TopographySettings,
    contact: ContactSettings,
    most_contact: float = MOST_CONTACT,
) -> Iterator[dict[str, Any]]:
    """Rows of topography/judged.csv: pressing each scan, and what its description says of it.

    Each scan is left out of the description that it judges, as far as there are others; a lone one
    meets the description made from itself, which tests nothing. A scan that the others say nothing
    of is passed over. The surfaces go the way of the scan: they are cut from larger ones, levelled
    as it is, and made periodic. They are as blunt as the scan: what the tips took is left out of
    both.

    Parameters
    ----------
    scans : as measured, with square pixels.
    spectra : of all measurements, line profiles too, as the images show them.
    name : a key of `choice.DESCRIPTIONS`.
    inputs : of the contact; the surfaces replace its roughness.
    most_contact : loads that press more than this share of the scan into contact are left out.
    """
    cleaned = {scan.name: clean(scan, settings) for scan in scans}
    spectra = [replace(item, tip_radius_nm=0.0) for item in spectra]
    for scan in cleaned.values():
        left_out = len(spectra) > 1
        used = list(spectra)
        if left_out:
            used = [item for item in spectra if item.name != scan.name]
        other_scans = [item for item in cleaned.values() if item.name != scan.name] or [scan]
        heights = ()
        if name == "measured_heights":
            heights = tuple(height_maps(other_scans))
        topography = analyse(used, settings)
        # without this scan eq. 9 may have nothing to say
        merged = None
        if name != "power_law" or "rms" not in topography.estimates:
            merged = merge(used)
        if merged is None and "rms" not in topography.estimates:
            continue
        described = Described(topography, merged, heights)
        yield from _judged(scan, described, name, left_out, inputs, settings, contact, most_contact)


def disagreeing(rows: Sequence[Mapping[str, Any]]) -> list[Mapping[str, Any]]:
    """First contacts further from their description than the worst of so many scans by chance.

    Parameters
    ----------
    rows : of topography/judged.csv, also as words.
    """
    from scipy.special import ndtri

    contacts = [row for row in rows if row["quantity"] == "first_contact"]
    # of films whose description is right, 5 % are named
    share = 1 - 0.05 / (2 * max(len(contacts), 1))
    largest = float(ndtri(share)) / REACH

    def away(row: Mapping[str, Any]) -> float:
        low = math.log(float(row["low"]))
        pressed = math.log(float(row["pressed"]))
        high = math.log(float(row["high"]))
        return abs(pressed - (low + high) / 2) / ((high - low) / 2)

    return sorted((row for row in contacts if away(row) > largest), key=away, reverse=True)


def testable(rows: Sequence[Mapping[str, Any]]) -> bool:
    """Does another measurement than the scan itself say what is expected of it?"""
    return any(str(row["left_out"]) == "True" for row in rows)


def height_maps(scans: Sequence[Scan], count: int = 10) -> Iterator[tuple[float, ...]]:
    """Maps of heights that few grains allow: blocks of the scans drawn anew (bootstrap)."""
    blocks = []
    cuts = 4
    for scan in scans:
        standard = (scan.heights_nm - scan.heights_nm.mean()) / scan.rms_nm
        for row in np.array_split(standard, cuts):
            blocks += np.array_split(row, cuts, axis=1)
    rng = np.random.default_rng(2)
    for _ in range(count):
        picks = rng.integers(len(blocks), size=len(blocks))
        drawn = [blocks[k].ravel() for k in picks]
        yield common_heights([height_quantiles(np.concatenate(drawn))])


def _judged(
    scan: Scan,
    described: Described,
    name: str,
    left_out: bool,
    inputs: ContactInputs,
    settings: TopographySettings,
    contact: ContactSettings,
    most_contact: float,
) -> Iterator[dict[str, Any]]:
    measured, side = contacting_heights(scan)
    # at most so many sites a side; the surfaces beside it are thinned, too
    stride = -(-len(measured) // 256)
    measured = np.ascontiguousarray(measured[::stride, ::stride])
    sites = len(measured)
    chosen = contact.model_copy(update={"pixels": sites, "length_nm": side})
    truth, share = _press(measured, inputs, chosen, contact.length_nm)
    truth = {
        quantity: value
        for quantity, value in truth.items()
        if share.get(quantity, 0.0) <= most_contact
    }
    made: dict[str, list[float]] = {quantity: [] for quantity in truth}
    touched = 40  # surfaces that are brought to first contact
    pressed = 20  # of these
    for number, psd in enumerate(described.spectra(touched)):
        height = _rms(psd, 2 * side, 2 * sites)
        seed = NOMINAL_SEED + number
        if described.heights:
            chart = described.heights[number % len(described.heights)]
            larger = synthesize_heights(2 * sites, 2 * side, psd, chart, height, seed)
        else:
            larger = synthesize_spectrum(2 * sites, 2 * side, psd, height, seed)
        drawn = Scan(larger[:sites, :sites], (side, side), scan.name)
        surface, _ = contacting_heights(clean(drawn, settings))
        if number < pressed:
            values, _ = _press(surface, inputs, chosen, contact.length_nm)
        else:
            values = {"rms": float(np.std(surface)), "first_contact": -float(surface.min())}
        for quantity in values.keys() & made.keys():
            made[quantity].append(values[quantity])
    for quantity, value in truth.items():
        low, middle, high = _predicted(
            np.array(made[quantity]), not quantity.startswith("separation")
        )
        yield {
            "scan": scan.name,
            "description": name,
            "left_out": left_out,
            "quantity": quantity,
            "unit": "nm^2" if quantity.startswith("area") else "nm",
            "in_contact": share.get(quantity, 0.0),
            "pressed": value,
            "median": middle,
            "low": low,
            "high": high,
            "inside": low <= value <= high,
        }


def _press(
    surface: Array, inputs: ContactInputs, contact: ContactSettings, cell_nm: float
) -> tuple[dict[str, float], dict[str, float]]:
    """RMS, first contact, separation at both pressures, area at the larger; nm, nm^2; at minima.

    Besides, for what is read at a load, the share of the cell in contact there.
    """
    area = (contact.length_nm / cell_nm) ** 2
    first_contact = float(surface.mean() - surface.min())
    values = {"rms": float(np.std(surface)), "first_contact": first_contact}
    force_nN = LOADS_NN[-1] * area
    cycle = run_cycle(
        replace(inputs, rms=values["rms"]),
        contact,
        NOMINAL_SEED,
        force_nN,
        surface,
        contact_at="lowest",
    )
    closing = cycle.closing
    force = np.maximum.accumulate(closing.repulsive_nN)
    share: dict[str, float] = {}
    for load in LOADS_NN:
        name = f"separation_{load / 1000:g}uN"
        values[name] = float(np.interp(load * area, force, closing.separation_nm))
        area_nm2 = float(np.interp(load * area, force, closing.contact_area_nm2))
        share[name] = area_nm2 / contact.length_nm**2
    name = f"area_{LOADS_NN[-1] / 1000:g}uN"
    values[name] = float(closing.contact_area_nm2[-1])
    share[name] = values[name] / contact.length_nm**2
    return values, share


def _rms(psd: Callable[[Array], Array], side: float, sites: int) -> float:
    """RMS height of the waves that a grid of `sites` over `side` nm holds."""
    q = np.geomspace(2 * math.pi / side, math.pi * sites / side, 400)
    return float(np.sqrt(np.trapezoid(2 * np.pi * q * psd(q), q)))


def _predicted(values: Array, positive: bool) -> tuple[float, float, float]:
    """Lower end, middle and upper end of where one more surface is expected.

    What is positive by nature is taken by its logarithm, with Student's distribution. Separations
    are skewed as the RMS height is, and negative in full contact: only their order counts. One more
    lies between the j-th of n from below and the j-th from above with probability 1 - 2 j / (n +
    1).
    """
    count = len(values)
    if positive:
        logs = np.log(values)
        middle = float(np.mean(logs))
        deviation = float(np.std(logs, ddof=1))
        reach = student_reach(count - 1) * deviation * math.sqrt(1 + 1 / count)
        return math.exp(middle - reach), math.exp(middle), math.exp(middle + reach)
    ordered = np.sort(values)
    outside = max(int((count + 1) * (1 - CONFIDENCE) / 2 + 1e-9), 1)
    return float(ordered[outside - 1]), float(np.median(ordered)), float(ordered[-outside])
