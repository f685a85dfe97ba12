"""Error of q0, slope and RMS height against the processor time of an analysis of scans, one choice
at a time.

Synthetic scans have a known truth. What is told are the deviations of the analysis from it over
several surfaces.
"""

from collections.abc import Callable, Iterator, Sequence
from functools import cache, partial, reduce
from typing import Any

import numpy as np

from mesoscale.settings import TopographySettings
from mesoscale.studies.driver import (
    Choice,
    Cost,
    Errors,
    Knob,
    Progress,
    Quantity,
    StudyRow,
    root_mean_square,
    rows_of,
    timed,
)
from mesoscale.topography.description.likelihood import fit, skip_blurred_shells
from mesoscale.topography.description.parameters import analyse
from mesoscale.topography.description.trusted_range import TrustedSpectrum, trusted_range
from mesoscale.topography.measurements.cleaning import Scan, clean
from mesoscale.topography.roughness_spectrum import mean_square
from mesoscale.topography.spectrum import hann_spectrum
from mesoscale.topography.synthetic_scans import ScanSet, synthetic_scans

SURFACES = 3
PIXELS = (64, 128, 256, 512, 1024)
SECTIONS = (1, 4, 25)
SCANS = ((1, 1), (2, 2), (4, 2), (8, 3))
"""Small and large ones."""
FEW = (2, 2)
MOST = (8, 3)
FLAT_SHARES = (0.99, 0.9, 0.5, 0.0)
BINS = (4, 8, 12, 24)
TIPS_NM = (0.0, 5.0, 20.0)
TOLD_OVER_TRUE = (0.0, 0.8, 1.0, 1.2)
MOST_PIXELS = 512
"""Of scans whose pixels are not the choice that is tried."""
MISSED = 1.0
"""Relative deviation that counts where the analysis states no number."""

Estimates = dict[str, float]
Analysis = Callable[[list[Scan]], Estimates]
Tried = tuple[Any, ScanSet, tuple[int, int], Analysis]
"""Value of a knob, the surfaces, how many small and large scans are used, and the analysis of
cleaned scans.
"""


def accuracy_points(
    settings: TopographySettings,
    volts: dict[str, float] | None = None,
    progress: Progress | None = None,
) -> Iterator[StudyRow]:
    """Rows of accuracy/topography.csv without the stage.

    Parameters
    ----------
    settings : of the scene; its synthetic scans say how many there are, and of how many pixels.
    volts : what an error of 1 % of q0, slope or RMS height moves in the release of the scene's
        switch, V.
    """
    quantities = [
        Quantity(name, "%", volts=(volts or {}).get(name)) for name in ("q0", "slope", "rms")
    ]
    cleaned = cache(partial(_cleaned, settings))  # most knobs are tried on the same scans
    yield from rows_of(list(_knobs(settings, quantities, cleaned)), progress)


Cleaned = Callable[[ScanSet, int], list[tuple[Scan, Cost]]]
"""Cleaned scans of a surface of a set, and what each cost."""


def _cleaned(settings: TopographySettings, truth: ScanSet, surface: int) -> list[tuple[Scan, Cost]]:
    seeded = truth.model_copy(update={"seed": truth.seed + 1000 * surface})
    return [timed(partial(clean, item.scan, settings)) for item in synthetic_scans(seeded)]


def _knobs(
    settings: TopographySettings, quantities: Sequence[Quantity], cleaned: Cleaned
) -> Iterator[Knob]:
    base = ScanSet(**settings.synthetic.model_dump(), rms_variation=0.0)
    truth = _counted(base.model_copy(update={"pixels": min(base.pixels, MOST_PIXELS)}), MOST)
    usual = partial(estimates, settings)

    def few(**changes: Any) -> ScanSet:
        return _counted(truth.model_copy(update=changes), FEW)

    def with_tip(radius_nm: float) -> TopographySettings:
        return settings.model_copy(update={"tip_radius_nm": radius_nm})

    def knob(name: str, shipped: Any, values: Sequence[Tried]) -> Knob:
        choices = [Choice(value, partial(_errors, cleaned, *tried)) for value, *tried in values]
        return Knob(
            name,
            quantities,
            choices,
            shipped,
            "truth of the synthetic scans",
            samples=f"{SURFACES} surfaces",
        )

    pixels = [count for count in PIXELS if count <= base.pixels]
    yield knob(
        "pixels a side", base.pixels, [(count, few(pixels=count), FEW, usual) for count in pixels]
    )
    counts = [(sum(used), truth, used, usual) for used in SCANS]
    yield knob("scans", base.small_scans + base.large_scans, counts)
    sections = [(count, truth, FEW, partial(usual, sections=count)) for count in SECTIONS]
    yield knob("sections", 25, sections)
    # side lobes of the window cover steep spectra first
    steep = few(slope=3.8, tip_radius_nm=1.0)
    windows = [
        (flat, steep, FEW, partial(estimates, with_tip(1.0), flat=flat)) for flat in FLAT_SHARES
    ]
    yield knob("flat share of the window, steep spectrum", 0.0, windows)
    yield knob(
        "bins a decade", 12, [(count, truth, FEW, partial(usual, bins=count)) for count in BINS]
    )
    radii = [
        (radius, few(tip_radius_nm=radius), FEW, partial(estimates, with_tip(radius)))
        for radius in TIPS_NM
    ]
    yield knob("tip radius, nm", base.tip_radius_nm, radii)
    told_over_true = [
        (ratio, truth, FEW, partial(estimates, with_tip(ratio * truth.tip_radius_nm)))
        for ratio in TOLD_OVER_TRUE
    ]
    yield knob("told over true tip radius", 1.0, told_over_true)


def _counted(truth: ScanSet, counts: tuple[int, int]) -> ScanSet:
    small, large = counts
    return truth.model_copy(update={"small_scans": small, "large_scans": large})


def _errors(cleaned: Cleaned, truth: ScanSet, used: tuple[int, int], analysis: Analysis) -> Errors:
    """Errors over the surfaces in %, and the mean cost of one analysis, cleaning included."""
    true_values = {"q0": truth.q0, "slope": truth.slope, "rms": truth.rms_nm}
    small, large = used
    deviations = []
    costs = []
    for surface in range(SURFACES):
        every = cleaned(truth, surface)
        sample = [*every[:small], *every[truth.small_scans : truth.small_scans + large]]
        estimated, cost = timed(partial(analysis, [scan for scan, _ in sample]))
        deviations.append(
            [100 * _relative(estimated.get(name), value) for name, value in true_values.items()]
        )
        costs += [cost, *(of_cleaning for _, of_cleaning in sample)]
    return Errors(*root_mean_square(deviations), reduce(Cost.__add__, costs).times(1 / SURFACES))


def _relative(estimate: float | None, true_value: float) -> float:
    if estimate is None:
        return MISSED
    return estimate / true_value - 1


def estimates(
    settings: TopographySettings,
    scans: list[Scan],
    sections: int = 25,
    flat: float = 0.0,
    bins: int | None = None,
) -> Estimates:
    """Estimates of q0 (1/nm), slope and RMS height (nm) of a set of cleaned scans, where they are
    identifiable.

    Parameters
    ----------
    sections, flat : as `hann_spectrum` takes them.
    bins : of a decade, which share a discrepancy in the fit; None: the usual ones.
    """
    radius_nm = settings.tip_nm
    spectra = [
        trusted_range(scan.name, hann_spectrum(scan, sections, flat), radius_nm, scan.rms_nm)
        for scan in scans
    ]
    result = analyse(spectra, settings)
    if bins is not None and result.likelihood is not None:
        return _with_bins(spectra, result.likelihood.q0, result.cutoff, bins)
    return {name: estimate.value for name, estimate in result.estimates.items()}


def _with_bins(
    spectra: Sequence[TrustedSpectrum], knee: float, cutoff: float, bins: int
) -> Estimates:
    """The estimates of the likelihood with so many bins a decade."""
    fitted = fit(skip_blurred_shells(spectra, knee), knee, per_decade=bins)
    if fitted is None:
        return {}
    rms_nm = float(np.sqrt(mean_square(fitted.plateau, fitted.q0, fitted.slope, cutoff)))
    return {"q0": fitted.q0, "slope": fitted.slope, "rms": rms_nm}
