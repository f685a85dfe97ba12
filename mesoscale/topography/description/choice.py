"""Which description of a surface is used, by which evidence, and what to doubt about it."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from mesoscale.settings import TopographySettings
from mesoscale.topography.description.cell import HELD, share_on_cells
from mesoscale.topography.description.doubts import Doubt
from mesoscale.topography.description.heights import HeightTest, not_gaussian
from mesoscale.topography.description.one_spectrum import OneSpectrum
from mesoscale.topography.description.parameters import Topography
from mesoscale.topography.measurements.cleaning import (
    FORM_TAKEN,
    LINES_CUT,
    MANY_SPIKES,
    MARKED,
    STAND_INS,
)
from mesoscale.topography.measurements.profiles import OVERHANG, THERE_AND_BACK

DESCRIPTIONS = {
    "power_law": "plateau and power law of eq. 9, normal heights",
    "measured_spectrum": "the measured spectrum with its band, normal heights",
    "measured_heights": (
        "the measured spectrum with its band, and the measured distribution of heights"
    ),
}


STEPS_TO_TELL = {
    FORM_TAKEN: (
        "form",
        "if this is roughness, set topography.detrend to plane, and measure a larger area",
    ),
    LINES_CUT: ("aborted_scan", "measure the whole area again"),
    THERE_AND_BACK: ("there_and_back", "give one of both directions a file"),
    OVERHANG: (
        "overhang",
        "the contact is on top: nothing to do where the heights are seen from above",
    ),
    MARKED: (
        "marked_pixels",
        "if these pixels are wrong, replace them by data of their surroundings, and save again",
    ),
    STAND_INS: (
        "missing_points",
        "they were filled from their neighbours: if they are heights, measure again",
    ),
    MANY_SPIKES: (
        "spikes",
        "look at the map: dust, noise or a wrong number for missing points; measure again",
    ),
}
"""Steps of a measurement that a user should hear of: code of the doubt and remedy."""


HIGH_NM = 1000.0
HIGH_SHARE = 0.005
"""RMS height, and its share of the length, from both of which on the unit may be mistaken: an
optical map of 1 mm may have 2 um.
"""
STEEP_SHARE = 0.3
"""Share of the length that no RMS height has: the length may be in another unit."""
FLAT_NM = 0.01
"""RMS height below that of cleaved crystals, which have 0.03 nm."""
TREATED = {
    "smoothed": (
        "smoothed or filtered: its spectrum falls as that of no measured map; what the filter took"
        " is put back"
    ),
    "median": (
        "smoothed by a median, or pixels are repeated: neighbours have exactly the same height"
    ),
    "interpolated": (
        "interpolated: it is smoother at even distances, between the points that were measured"
    ),
}
"""Signs by which a map shows what was done to it, by the kind of `treatment.Treatment`."""


@dataclass(frozen=True)
class Choice:
    """The description in use.

    Attributes
    ----------
    name : a key of `DESCRIPTIONS`.
    evidence : rows with `test`, `outcome` and `passed`, in the order they were asked.
    overridden : the scene set it.
    """

    name: str
    evidence: tuple[dict[str, Any], ...]
    overridden: bool


def choose(
    topography: Topography,
    merged: OneSpectrum | None,
    tests: Sequence[HeightTest],
    settings: TopographySettings,
) -> Choice:
    """The first description that the measurements do not contradict, or the scene's."""
    power_law = not topography.doubts
    strange = not_gaussian(tests)
    heights = "no map of heights: not tested"
    if tests:
        heights = f"as Gaussian surfaces of the same spectrum ({len(tests)} scans)"
    bands = "no"
    if merged is not None:
        measured = int((merged.count > 0).sum())
        bands = f"{measured} bands of {merged.first:.2g} to {merged.q[-1]:.2g} /nm"
    shape = "; ".join(topography.reasons) or _fitted(topography)
    asked = (
        ("spectrum has the shape of eq. 9", shape, power_law),
        ("heights and highest point are a Gaussian surface's", strange or heights, not strange),
        ("spectrum is measured band by band", bands, merged is not None),
    )
    evidence = tuple(
        {"test": test, "outcome": outcome, "passed": passed} for test, outcome, passed in asked
    )
    if settings.description != "auto":
        return Choice(settings.description, evidence, overridden=True)
    if strange and merged is not None:
        return Choice("measured_heights", evidence, overridden=False)
    if power_law or merged is None:
        return Choice("power_law", evidence, overridden=False)
    return Choice("measured_spectrum", evidence, overridden=False)


def _fitted(topography: Topography) -> str:
    fitted = topography.likelihood
    if fitted is None:
        return ""
    misses = f"misses the bands by {np.expm1(fitted.misfit):.0%} (RMS)"
    if fitted.amplitude_sd <= 0:
        return misses
    return (
        f"{misses}; each measurement at a level of its own, a factor of"
        f" {np.exp(fitted.amplitude_sd):.2g} apart in C"
    )


def description_doubts(
    topography: Topography,
    name: str,
    merged: OneSpectrum | None,
    attributes: Mapping[str, Mapping[str, Any]],
    tests: Sequence[HeightTest],
    cell_nm: float,
) -> Iterator[Doubt]:
    """Doubts of the measurements besides those of eq. 9, which only count where eq. 9 is used.

    Parameters
    ----------
    name : of the description.
    merged : the measured spectrum, used or not.
    attributes : of the records, by name.
    """
    used = None if name == "power_law" else merged
    share, square_nm2 = share_on_cells(topography, used, cell_nm)
    if share < HELD**2:
        text = (
            f"a cell of {cell_nm:g} nm has {np.sqrt(share):.0%} of the RMS height; the rest, "
            f"{np.sqrt(square_nm2 * (1 - share)):.3g} nm, is in longer waves, which no stage has"
        )
        remedy = (
            "a larger contact.length_nm with as many more contact.pixels holds more of them; on a"
            " wide electrode they lift and tilt whole cells: device.spread.bow_nm can stand for"
            " those as long as the electrode"
        )
        yield Doubt("waves_beyond_cell", text, remedy, "rms")
    for measured, values in attributes.items():
        yield from _doubts_of_record(measured, values)
    for test in tests:
        # isotropic surfaces C ~ q^-2.5 to q^-4 without a plateau reach 1.4
        if test.anisotropy > 2.0:
            text = (
                f"{test.name}: slopes are {test.anisotropy:.2g} times as steep in one direction as"
                " across it"
            )
            remedy = (
                "random surfaces are isotropic: trust the pressed scan, and look for ridges or"
                " noise of lines"
            )
            yield Doubt("anisotropic", text, remedy, "contact")
    if merged is not None:
        gap = merged.q[(merged.count == 0) & (np.cumsum(merged.count) > 0)]
        if len(gap):
            text = (
                f"nothing is measured from {gap[0]:.2g} to {gap[-1]:.2g} /nm; the spectrum is"
                " bridged there"
            )
            yield Doubt("gap", text, "add scans of the sizes between", "spectrum")
        if len(merged.names) == 1:
            text = (
                "one measurement: how much places differ is unknown, the ranges hold its own error"
                " only"
            )
            yield Doubt("one_place", text, "measure other places of the surface", "rms")
    lines = topography.line_fit
    if lines is not None and not lines.settled:
        text = (
            "the knee of the two lines through the spectrum swings between two places; q1 and the"
            " line fits are those of the last one"
        )
        yield Doubt("knee_unsettled", text, "add scans of other sizes about the knee", "q1")
    first = next(iter(topography.doubts), None)
    if name != "power_law" and first is not None and not first.fatal:
        text = f"{first.text}; used instead: {DESCRIPTIONS[name]}"
        remedy = first.remedy
        if first.code not in ("no_plateau", "short_range"):
            text = f"eq. 9 does not describe this surface: {text}"
            remedy = "nothing to do"
        yield Doubt("no_power_law", text, remedy, "q0")


def _unit_doubt(name: str, values: Mapping[str, Any]) -> Iterator[Doubt]:
    """A map that is most likely in another unit than it says."""
    rms_nm = float(values["rms_nm"])
    length_nm = float(values["length_x_nm"])
    high = rms_nm > max(HIGH_NM, HIGH_SHARE * length_nm)
    if high or rms_nm > STEEP_SHARE * length_nm:
        than = "higher than films have"
    elif 0.0 < rms_nm < FLAT_NM:
        than = "less than atoms leave"
    else:
        return
    text = (
        f"{name}: an RMS height of {rms_nm:.3g} nm over {length_nm:.3g} nm, {than}, as in another"
        " unit"
    )
    remedy = (
        "positions and heights may have units of their own (unit: um, height_unit: nm; --unit"
        " um,nm)"
    )
    yield Doubt("unit_unlikely", text, remedy, "rms")


def _doubts_of_record(name: str, values: Mapping[str, Any]) -> Iterator[Doubt]:
    yield from _unit_doubt(name, values)
    share, skewness = (float(values.get(f"alignment_{key}", 0.0)) for key in ("share", "skewness"))
    # clean maps reach 0.33 and, where they are grainy, 0.4; their RMS heights are right
    # nevertheless
    if share > 0.4 or abs(skewness) > 0.5:
        text = (
            f"{name}: aligning the scan lines by their medians took {share:.0%} of the RMS height"
            f" and changed the skewness by {skewness:+.2f}"
        )
        remedy = "if the lines have no offsets, set topography.line_alignment to none"
        yield Doubt("alignment_took_roughness", text, remedy, "rms")
    if treatment := str(values.get("treatment", "")):
        signs = TREATED[treatment]
        text = (
            f"{name}: {signs}; what it shows is trusted to {float(values['trusted_high']):.2g} /nm"
        )
        yield Doubt("treated", text, "give the map as it was measured, without filters", "spectrum")
    for step in values["steps"].split("; "):
        for begins, (code, remedy) in STEPS_TO_TELL.items():
            if step.startswith(begins):
                yield Doubt(code, f"{name}: {step}", remedy, "rms")
    if not values["radius_stated"]:
        text = (
            f"{name}: neither scene nor file states the tip radius; taken is"
            f" {values['tip_radius_nm']:g} nm"
        )
        yield Doubt("tip_not_stated", text, "state it in topography.instruments", "spectrum")
