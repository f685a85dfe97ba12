"""The scan is the judge: surfaces made from a description are pressed beside the measured scans themselves."""

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from mesoscale.contact import run_cycle
from mesoscale.inputs.contact import ContactInputs
from mesoscale.settings import ContactSettings, TopographySettings
from mesoscale.topography.description.choice import carried_on
from mesoscale.topography.description.heights import common_heights, height_quantiles
from mesoscale.topography.description.likelihood import TrustedSpectrum
from mesoscale.topography.description.one_spectrum import OneSpectrum, merge
from mesoscale.topography.description.parameters import Topography, analyse
from mesoscale.topography.height_synthesis import synthesize_heights
from mesoscale.topography.measurements.cleaning import Scan, clean
from mesoscale.topography.pressing import contacting_heights
from mesoscale.topography.roughness_spectrum import RoughSpectrum, SpectrumTable
from mesoscale.topography.synthesis import synthesize_spectrum

Array = np.ndarray
SITES = 256  # a scan is thinned to at most so many sites a side, and so are the surfaces beside it
MAPS, BLOCKS = 10, 4  # maps of heights drawn, and blocks a side of a scan that they are drawn from
TOUCHED, PRESSED = 40, 10  # surfaces that are brought to first contact, and of these the ones that are pressed
LOADS_NN = (1000.0, 7000.0)  # per cell of the contact settings: 1 and 7 uN
COLUMNS = ("scan", "description", "left_out", "quantity", "unit", "pressed", "median", "low", "high", "inside")


@dataclass(frozen=True)
class Described:
    """A description of a surface from which surfaces are drawn.

    Attributes
    ----------
    topography, one : eq. 9, and the measured spectrum where that is used.
    heights : maps of heights that the scans allow (`height_synthesis.Z`); none for normal heights.
    """

    topography: Topography
    one: OneSpectrum | None
    heights: tuple[tuple[float, ...], ...]

    def spectra(self, count: int) -> Iterator[Callable[[Array], Array]]:
        """`count` spectra C(q) that the measurements allow for a place of the surface."""
        rng = np.random.default_rng(1)
        if self.one is not None:
            for psd in self.one.draws(places=True, count=count):
                yield SpectrumTable(*carried_on(self.one, psd)).psd  # as the contact's own surfaces
            return
        estimates = self.topography.estimates
        for _ in range(count):
            q0, slope, rms = (rng.uniform(*estimates[name].scatter) for name in ("q0", "slope", "rms"))
            yield RoughSpectrum.from_rms(rms, q0, slope, self.topography.cutoff).psd


def judge(
    scans: Sequence[Scan],
    spectra: Sequence[TrustedSpectrum],
    name: str,
    inputs: ContactInputs,
    settings: TopographySettings,
    contact: ContactSettings,
) -> Iterator[dict[str, Any]]:
    """Rows of topography/judged.csv: pressing each scan, and what its description says of it.

    Each scan is left out of the description that it judges, as far as there are others; a lone scan judges the
    description made from itself. The surfaces go the way of the scan: they are cut from larger ones, levelled as it
    is, and made periodic.

    Parameters
    ----------
    scans : as measured, with square pixels.
    spectra : of all measurements, line profiles too.
    name : a key of `choice.DESCRIPTIONS`.
    inputs : of the contact; the surfaces replace its roughness.
    """
    cleaned = {scan.name: clean(scan, settings) for scan in scans}
    for scan in cleaned.values():
        left_out = len(cleaned) > 1
        used = [item for item in spectra if item.name != scan.name] if left_out else list(spectra)
        others = [item for item in cleaned.values() if item.name != scan.name] or [scan]
        heights = tuple(height_maps(others)) if name == "measured_heights" else ()
        described = Described(analyse(used, settings), merge(used) if name != "power_law" else None, heights)
        yield from _judged(scan, described, name, left_out, inputs, settings, contact)


def height_maps(scans: Sequence[Scan], count: int = MAPS) -> Iterator[tuple[float, ...]]:
    """Maps of heights that few grains allow: from blocks of the scans drawn anew (bootstrap over places)."""
    blocks = []
    for scan in scans:
        standard = (scan.heights_nm - scan.heights_nm.mean()) / scan.rms_nm
        blocks += [part for row in np.array_split(standard, BLOCKS) for part in np.array_split(row, BLOCKS, axis=1)]
    rng = np.random.default_rng(2)
    for _ in range(count):
        drawn = [blocks[k].ravel() for k in rng.integers(len(blocks), size=len(blocks))]
        yield common_heights([height_quantiles(np.concatenate(drawn))])


def _judged(
    scan: Scan,
    described: Described,
    name: str,
    left_out: bool,
    inputs: ContactInputs,
    settings: TopographySettings,
    contact: ContactSettings,
) -> Iterator[dict[str, Any]]:
    measured, side = contacting_heights(scan)
    stride = -(-len(measured) // SITES)
    measured = np.ascontiguousarray(measured[::stride, ::stride])
    sites = len(measured)
    chosen = contact.model_copy(update={"pixels": sites, "length_nm": side})
    truth = _press(measured, inputs, chosen, contact.length_nm)
    made: dict[str, list[float]] = {quantity: [] for quantity in truth}
    for number, psd in enumerate(described.spectra(TOUCHED)):
        height = _rms(psd, 2 * side, 2 * sites)
        seed = contact.nominal_seed + number
        if described.heights:
            chart = described.heights[number % len(described.heights)]
            larger = synthesize_heights(2 * sites, 2 * side, psd, chart, height, seed)
        else:
            larger = synthesize_spectrum(2 * sites, 2 * side, psd, height, seed)
        surface, _ = contacting_heights(clean(Scan(larger[:sites, :sites], (side, side), scan.name), settings))
        if number < PRESSED:
            values = _press(surface, inputs, chosen, contact.length_nm)
        else:
            values = {"rms": float(np.std(surface)), "first_contact": -float(surface.min())}
        for quantity, value in values.items():
            made[quantity].append(value)
    for quantity, value in truth.items():
        low, middle, high = _predicted(np.array(made[quantity]), 0.9, not quantity.startswith("separation"))
        yield {
            "scan": scan.name,
            "description": name,
            "left_out": left_out,
            "quantity": quantity,
            "unit": "nm^2" if quantity.startswith("area") else "nm",
            "pressed": value,
            "median": middle,
            "low": low,
            "high": high,
            "inside": low <= value <= high,
        }


def _press(surface: Array, inputs: ContactInputs, contact: ContactSettings, cell_nm: float) -> dict[str, float]:
    """RMS, first contact, separation at both pressures and area at the larger; nm, nm^2. Contact is at the minima."""
    area = (contact.length_nm / cell_nm) ** 2
    values = {"rms": float(np.std(surface)), "first_contact": float(surface.mean() - surface.min())}
    cycle = run_cycle(replace(inputs, rms=values["rms"]), contact, contact.nominal_seed, LOADS_NN[-1] * area, surface)
    closing = cycle.closing
    force = np.maximum.accumulate(closing.repulsive_nN)
    for load in LOADS_NN:
        values[f"separation_{load / 1000:g}uN"] = float(np.interp(load * area, force, closing.separation_nm))
    values[f"area_{LOADS_NN[-1] / 1000:g}uN"] = float(closing.contact_area_nm2[-1])
    return values


def _rms(psd: Callable[[Array], Array], side: float, sites: int) -> float:
    """RMS height of the waves that a grid of `sites` over `side` nm holds."""
    q = np.geomspace(2 * math.pi / side, math.pi * sites / side, 400)
    return float(np.sqrt(np.trapezoid(2 * np.pi * q * psd(q), q)))


def _predicted(values: Array, confidence: float, positive: bool) -> tuple[float, float, float]:
    """Lower end, middle and upper end of where one more surface is expected, by Student's distribution.

    What is positive by nature is taken by its logarithm; separations are not, in full contact.
    """
    from scipy.special import stdtrit

    given = np.log(values) if positive else values
    count, middle = len(given), float(np.mean(given))
    reach = float(stdtrit(count - 1, 0.5 + confidence / 2)) * float(np.std(given, ddof=1)) * math.sqrt(1 + 1 / count)
    low, high = middle - reach, middle + reach
    return (math.exp(low), math.exp(middle), math.exp(high)) if positive else (low, middle, high)
