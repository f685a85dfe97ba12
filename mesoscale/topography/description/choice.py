"""Which description of a surface is used, by which evidence, and what it hands on to the random surfaces."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from mesoscale.settings import TopographySettings
from mesoscale.topography.description.cell import HELD
from mesoscale.topography.description.confidence import QUANTILES, REACH
from mesoscale.topography.description.doubts import Doubt
from mesoscale.topography.description.heights import HeightTest, common_heights, not_gaussian
from mesoscale.topography.description.one_spectrum import OneSpectrum
from mesoscale.topography.description.parameters import Topography, inputs
from mesoscale.topography.roughness_spectrum import hurst_from_slope, mean_square

DESCRIPTIONS = {
    "power_law": "plateau and power law of eq. 9, normal heights",
    "measured_spectrum": "the measured spectrum with its band, normal heights",
    "measured_heights": "the measured spectrum with its band, and the measured distribution of heights",
}
EXTENSION_DECADES = 1.0  # the last slope is carried on this far beyond what is measured
POSSIBLE_SLOPES = (-4.0, -2.1)  # of a self-affine surface (0 < H < 1); shallower ones have no finite RMS height
END_DECADES = 0.3  # over which that slope is taken
HURST_ENDS = (0.05, 1.95)  # of the bending exponent; it is a coordinate, the spectrum itself is the measured one
SLOWEST_BEND, FASTEST_BEND = 0.02, 0.7  # of ln q0


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
    topography: Topography, one: OneSpectrum | None, tests: Sequence[HeightTest], settings: TopographySettings
) -> Choice:
    """The first description that the measurements do not contradict, or the scene's."""
    power_law = not topography.doubts
    strange = not_gaussian(tests)
    known = one is not None
    if not tests:
        heights = "no map of heights: not tested"
    else:
        heights = strange or f"as Gaussian surfaces of the same spectrum ({len(tests)} scans)"
    evidence = (
        {
            "test": "spectrum has the shape of eq. 9",
            "outcome": "; ".join(topography.reasons) or _fitted(topography),
            "passed": power_law,
        },
        {
            "test": "heights and highest point are a Gaussian surface's",
            "outcome": heights,
            "passed": not strange,
        },
        {
            "test": "spectrum is measured band by band",
            "outcome": f"{int((one.count > 0).sum())} bands of {one.first:.2g} to {one.q[-1]:.2g} /nm" if one else "no",
            "passed": known,
        },
    )
    if settings.description != "auto":
        return Choice(settings.description, evidence, overridden=True)
    if strange and known:
        return Choice("measured_heights", evidence, overridden=False)
    return Choice("power_law" if power_law or not known else "measured_spectrum", evidence, overridden=False)


def _fitted(topography: Topography) -> str:
    fitted = topography.likelihood
    if fitted is None:
        return ""
    apart = f"; each measurement at a level of its own, a factor of {np.exp(fitted.amplitude_sd):.2g} apart in C"
    return f"misses the bands by {np.expm1(fitted.misfit):.0%} (RMS)" + (apart if fitted.amplitude_sd > 0 else "")


def surface_of(
    choice: Choice,
    topography: Topography,
    one: OneSpectrum | None,
    quantiles: Sequence[np.ndarray],
    settings: TopographySettings,
    cell_nm: float,
) -> dict[str, Any]:
    """What random surfaces are made from besides q0, hurst and rms: entries of `contact.surface`; none for eq. 9."""
    if choice.name == "power_law" or one is None:
        return {}
    q, psd = _table(one, 2 * np.pi / cell_nm)
    pivot_q0, pivot_hurst = _nearest(topography, one, settings)
    heights = list(common_heights(quantiles)) if choice.name == "measured_heights" and len(quantiles) else []
    return {
        "spectrum": {"q": q.tolist(), "psd": psd.tolist(), "q0": pivot_q0, "hurst": pivot_hurst},
        "heights": heights,
    }


def rows_of(
    choice: Choice,
    topography: Topography,
    one: OneSpectrum | None,
    settings: TopographySettings,
    cell_nm: float,
) -> dict[str, dict[str, Any]]:
    """Distributions of q0, hurst and rms, with the ranges that the settings ask for.

    The RMS height is that of the waves of a cell of side `cell_nm`, and of a film whose spectrum is flat beyond, as the
    pad makes it (`pad.cells`). With a measured spectrum q0 and hurst are coordinates that bend the spectrum about
    the eq. 9 nearest to it, as far as its band allows.
    """
    if choice.name == "power_law" or one is None:
        rows = inputs(topography, settings)
        if "rms" in rows:
            share = np.sqrt(_share_on_cells(topography, cell_nm))
            rows["rms"] |= {key: float(rows["rms"][key] * share) for key in ("a", "b")}
        return rows
    drawn = one.draws(places=settings.ranges == "scatter")
    rms = np.sqrt(_cell_mean_square(one, drawn, cell_nm))
    pivot_q0, pivot_hurst = _nearest(topography, one, settings)
    bend_q0, bend_hurst = _bends(one, pivot_q0, drawn)
    hurst = np.clip([pivot_hurst - bend_hurst, pivot_hurst + bend_hurst], *HURST_ENDS)
    ranges = {
        "q0": [pivot_q0 * np.exp(-bend_q0), pivot_q0 * np.exp(bend_q0)],
        "hurst": hurst,
        "rms": np.quantile(rms, QUANTILES),
    }
    return {name: {"distribution": "uniform", "a": float(a), "b": float(b)} for name, (a, b) in ranges.items()}


def cell_waves(cell_nm: float) -> tuple[np.ndarray, np.ndarray, float]:
    """Wave vectors (1/nm) of a periodic cell, the area (1/nm^2) that each stands for, and where an integral takes over.

    The mean plane counts as one more wave of the longest: the spectrum of the film is flat there.
    """
    step = 2.0 * np.pi / cell_nm
    numbers = np.arange(-SUMMED, SUMMED + 1)
    squared, count = np.unique(numbers[:, None] ** 2 + numbers**2, return_counts=True)
    inside = squared <= SUMMED**2
    return step * np.sqrt(np.maximum(squared[inside], 1)), step**2 * count[inside], SUMMED * step


def _share_on_cells(topography: Topography, cell_nm: float) -> float:
    """Share of the mean square height of eq. 9 that is left where it is flat beyond the longest wave of a cell."""
    fitted = topography.likelihood or topography.line_fit
    if fitted is None or fitted.q0 >= 2.0 * np.pi / cell_nm:
        return 1.0
    waves, areas, end = cell_waves(cell_nm)
    whole, summed = (mean_square(1.0, fitted.q0, fitted.slope, high) for high in (topography.cutoff, end))
    areas = np.where(waves <= topography.cutoff, areas, 0.0)  # a coarse film ends before the sum does
    return float(((waves / fitted.q0) ** -fitted.slope @ areas + max(whole - summed, 0.0)) / whole)


def _cell_mean_square(one: OneSpectrum, psd: np.ndarray, cell_nm: float) -> np.ndarray:
    """Mean square height (nm^2) of cells by spectra (..., m) on the bands of `one`."""
    waves, areas, end = cell_waves(cell_nm)
    logs, known = np.log(psd).reshape(-1, len(one.q)), waves <= one.q[-1]
    summed = [np.exp(np.interp(np.log(waves[known]), np.log(one.q), row)) @ areas[known] for row in logs]
    return np.reshape(summed, psd.shape[:-1]) + one.moment(0, low=end, psd=psd) + _tail(one, psd)


def share_on_cells(
    topography: Topography, one: OneSpectrum | None, choice: Choice, cell_nm: float
) -> tuple[float, float]:
    """Share of the mean square height (nm^2) that cells have, and all of it, by the description in use."""
    if choice.name == "power_law" or one is None:
        fitted = topography.likelihood
        whole = mean_square(fitted.plateau, fitted.q0, fitted.slope, topography.cutoff) if fitted else 0.0
        return _share_on_cells(topography, cell_nm), whole
    whole = float(one.moment(0, psd=one.psd) + _tail(one, one.psd))
    return float(_cell_mean_square(one, one.psd, cell_nm)) / whole, whole


def _table(one: OneSpectrum, low: float) -> tuple[np.ndarray, np.ndarray]:
    """Points (1/nm, nm^4) of the spectrum from the longest wave of a cell on, with its last slope carried on."""
    q, psd = carried_on(one, one.psd)
    if low > q[0]:  # longer waves do not fit on the cell
        first = float(np.exp(np.interp(np.log(low), np.log(q), np.log(psd))))
        q, psd = np.concatenate([[low], q[q > low]]), np.concatenate([[first], psd[q > low]])
    return q, psd


def carried_on(one: OneSpectrum, psd: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Points (1/nm, nm^4) of a spectrum (m,) on the bands of `one`, with its last slope carried on for a decade."""
    end = float(one.q[-1])
    beyond = end * 10 ** np.linspace(0.1, EXTENSION_DECADES, 10)
    slope = _end_slope(one, psd)
    return np.concatenate([one.q, beyond]), np.concatenate([psd, psd[-1] * (beyond / end) ** slope])


def _end_slope(one: OneSpectrum, psd: np.ndarray) -> np.ndarray:
    """Logarithmic slopes of the ends of spectra (..., m).

    A spectrum that ends before its power law says nothing of it: the slopes are then spread over `POSSIBLE_SLOPES`.
    """
    end = one.q > one.q[-1] * 10 ** -(END_DECADES + 0.01)
    logs = np.log(psd[..., end]).reshape(-1, np.count_nonzero(end))
    slopes = np.polyfit(np.log(one.q[end]), logs.T, 1)[0]
    unseen = slopes > POSSIBLE_SLOPES[1]
    count = np.count_nonzero(unseen)
    slopes[unseen] = np.interp((np.arange(count) + 0.5) / max(count, 1), (0, 1), POSSIBLE_SLOPES)
    return slopes.reshape(psd.shape[:-1])


def _tail(one: OneSpectrum, psd: np.ndarray) -> np.ndarray:
    """Mean square heights of the continuations of spectra (..., m), nm^2."""
    power = _end_slope(one, psd) + 2.0
    return 2.0 * np.pi * psd[..., -1] * one.q[-1] ** 2 * (10.0 ** (EXTENSION_DECADES * power) - 1.0) / power


def _nearest(topography: Topography, one: OneSpectrum, settings: TopographySettings) -> tuple[float, float]:
    """q0 and Hurst exponent about which the spectrum is bent."""
    fitted = topography.likelihood
    if fitted is None:
        return float(np.sqrt(one.q[0] * one.q[-1])), 0.8
    hurst = float(np.clip(hurst_from_slope(fitted.slope, settings.convention), 0.2, 1.8))
    return float(np.clip(fitted.q0, one.q[0], one.q[-1])), hurst


def _bends(one: OneSpectrum, q0: float, drawn: np.ndarray) -> tuple[float, float]:
    """How far ln q0 and the Hurst exponent may be from the pivot, at the intervals' level."""
    logs, log_q = np.log(drawn), np.log(one.q)
    long, short = one.q <= q0, one.q >= q0
    slopes = np.polyfit(log_q[short], logs[:, short].T, 1)[0] if short.sum() > 2 else np.array([-3.0, -3.4])
    bend_hurst = max(REACH * float(np.std(slopes)) / 2, 0.02)
    fall = max(abs(float(np.mean(slopes))), 1.0)
    if long.sum() > 1 and short.sum() > 2:
        step = logs[:, short].mean(axis=1) - logs[:, long].mean(axis=1)
        bend_q0 = REACH * float(np.std(step)) / fall
    else:
        bend_q0 = 0.1
    return float(np.clip(bend_q0, SLOWEST_BEND, FASTEST_BEND)), bend_hurst


def description_doubts(
    topography: Topography,
    choice: Choice,
    one: OneSpectrum | None,
    attributes: Mapping[str, Mapping[str, Any]],
    disagreements: Sequence[str],
    cell_nm: float,
    tests: Sequence[HeightTest] = (),
) -> list[Doubt]:
    """Doubts of the measurements besides those of eq. 9, which only count where eq. 9 is used."""
    doubts = []
    share, whole = share_on_cells(topography, one, choice, cell_nm)
    if share < HELD**2:
        text = (
            f"a cell of {cell_nm:g} nm has {np.sqrt(share):.0%} of the RMS height; the rest, "
            f"{np.sqrt(whole * (1 - share)):.3g} nm, is in longer waves, which no stage has"
        )
        remedy = (
            "a larger contact.length_nm with as many more contact.pixels holds more of them; on a wide electrode they "
            "lift and tilt whole cells: device.spread.bow_nm can stand for those as long as the electrode"
        )
        doubts.append(Doubt("waves_beyond_cell", text, remedy, "rms"))
    for name, values in attributes.items():
        share, skewness = (float(values.get(f"alignment_{key}", 0.0)) for key in ("share", "skewness"))
        if share > MOST_ALIGNED or abs(skewness) > MOST_SKEWED:
            text = (
                f"{name}: aligning the scan lines by their medians took {share:.0%} of the RMS height and changed the "
                f"skewness by {skewness:+.2f}"
            )
            remedy = "if the lines have no offsets, set topography.line_alignment to none"
            doubts.append(Doubt("alignment_took_roughness", text, remedy, "rms"))
        if values.get("radius_stated") is not None and not values["radius_stated"]:
            text = f"{name}: neither scene nor file states the tip radius; taken is {values['tip_radius_nm']:g} nm"
            doubts.append(Doubt("tip_not_stated", text, "state it in topography.instruments", "spectrum"))
    for test in tests:
        if test.anisotropy > MOST_ANISOTROPIC:
            text = f"{test.name}: slopes are {test.anisotropy:.2g} times as steep in one direction as across it"
            remedy = "random surfaces are isotropic: trust the pressed scan, and look for ridges or noise of lines"
            doubts.append(Doubt("anisotropic", text, remedy, "contact"))
    for text in disagreements:
        remedy = "check their units, height scales and places; the band of the spectrum holds both"
        doubts.append(Doubt("measurements_disagree", text, remedy, "spectrum"))
    bridged = (one.count == 0) & (np.cumsum(one.count) > 0) if one is not None else np.zeros(0, dtype=bool)
    if one is not None and bridged.any():
        gap = one.q[bridged]
        text = f"nothing is measured from {gap[0]:.2g} to {gap[-1]:.2g} /nm; the spectrum is bridged there"
        doubts.append(Doubt("gap", text, "add scans of the sizes between", "spectrum"))
    if one is not None and len(one.names) == 1:
        text = "one measurement: how much places differ is unknown, the ranges hold its own error only"
        doubts.append(Doubt("one_place", text, "measure other places of the surface", "rms"))
    if choice.name != "power_law" and topography.doubts:
        text = f"eq. 9 does not describe this surface ({topography.doubts[0].text}); used: {DESCRIPTIONS[choice.name]}"
        doubts.append(Doubt("no_power_law", text, "", "q0"))
    return doubts


SUMMED = 16  # longest waves that are summed one by one; beyond, sum and integral differ by less than a per cent
MOST_ANISOTROPIC = 2.0  # ratio of slopes; isotropic surfaces C ~ q^-2.5 to q^-4 without a plateau reach 1.4
MOST_SKEWED = 0.3  # skewness that aligning lines may add without a word
MOST_ALIGNED = 0.1  # share of the RMS height that aligning lines may take without a word
