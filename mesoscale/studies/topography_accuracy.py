"""Error of q0, slope and RMS against the run time of the analysis, one knob at a time."""

from collections.abc import Iterator
from functools import partial
from typing import Any

import numpy as np

from mesoscale.settings import TopographySettings
from mesoscale.studies.driver import Knob, Progress, StudyRow, Try, rows_of, timed
from mesoscale.topography.description.likelihood import fit, skip_blurred_shells
from mesoscale.topography.description.parameters import analyse
from mesoscale.topography.description.trusted_range import trusted_range
from mesoscale.topography.measurements.cleaning import Scan, clean
from mesoscale.topography.roughness_spectrum import mean_square
from mesoscale.topography.spectrum import hann_spectrum
from mesoscale.topography.synthetic_scans import ScanSet, synthetic_scans

METRICS = {"q0": "relative RMS error", "slope": "absolute RMS error", "rms": "relative RMS error"}
Value = tuple[Any, ScanSet, float | None]
"""Value of a knob, the scans, and the tip radius that the analysis is told where it is not the scene's."""


def accuracy_points(settings: TopographySettings, progress: Progress | None = None) -> Iterator[StudyRow]:
    """Every value of every knob: RMS error over three surfaces, mean time of one analysis."""
    base = ScanSet(**settings.synthetic.model_dump(), rms_variation=0.0)
    metrics, cases, truth = tuple(METRICS.values()), tuple(METRICS), "truth of the synthetic scans"
    knobs = []
    for name, values in _values(base).items():
        tries = map(partial(_tried, settings, name), values)
        knobs.append(Knob(name, metrics, truth, tries, cases))
    yield from rows_of(knobs, progress)


def _values(base: ScanSet) -> dict[str, list[Value]]:
    """The values of each knob."""
    truth = base.model_copy(update={"pixels": min(base.pixels, 512)})

    def few(**changes: Any) -> ScanSet:
        return truth.model_copy(update={"small_scans": 2, "large_scans": 2, **changes})

    sets = ((1, 1), (2, 2), (4, 2), (8, 3))
    steep = few(slope=3.8, tip_radius_nm=1.0)  # side lobes of the window cover steep spectra first
    return {
        "pixels": [(pixels, few(pixels=pixels), None) for pixels in (128, 256, 512, 1024) if pixels <= base.pixels],
        "sections": [(sections, few(), None) for sections in (1, 4, 25)],
        "scans": [(small + large, few(small_scans=small, large_scans=large), None) for small, large in sets],
        "flat share of window": [(flat, steep, 1.0) for flat in (0.0, 0.5, 0.9, 0.99)],
        "tip radius nm": [(tip, few(tip_radius_nm=tip), tip) for tip in (0.0, 2.0, 5.0, 10.0, 20.0)],
        "bins per decade": [(bins, few(), None) for bins in (4, 8, 12, 24)],
        "told over true tip radius": [(x, few(), x * truth.tip_radius_nm) for x in (0.0, 0.8, 1.0, 1.2)],
    }


def _tried(settings: TopographySettings, knob: str, tried: Value) -> Try:
    """RMS errors of q0, slope and RMS height."""
    value, truth, radius_nm = tried
    analysis = settings if radius_nm is None else settings.model_copy(update={"tip_radius_nm": radius_nm})
    errors, costs = [], []
    for repeat in range(3):
        scans = [item.scan for item in synthetic_scans(truth.model_copy(update={"seed": truth.seed + 1000 * repeat}))]
        estimates, cost = timed(partial(_estimates, scans, analysis, knob, value))
        q0, slope, rms = (estimates.get(name, np.nan) for name in METRICS)
        errors.append([q0 / truth.q0 - 1, slope - truth.slope, rms / truth.rms_nm - 1])
        costs.append(cost)
    return Try(value, np.sqrt(np.mean(np.square(errors), axis=0)), np.mean(costs, axis=0))


def _estimates(scans: list[Scan], settings: TopographySettings, knob: str, value: Any) -> dict[str, float]:
    """Estimates of one set; a knob of the spectrum or of the likelihood takes its value."""
    changes = {"sections": {"sections": value}, "flat share of window": {"flat": value}}.get(knob, {})
    cleaned = [clean(scan, settings) for scan in scans]
    radius = settings.tip_nm
    spectra = [trusted_range(item.name, hann_spectrum(item, **changes), radius, item.rms_nm) for item in cleaned]
    result = analyse(spectra, settings)
    if knob == "bins per decade" and result.likelihood is not None:
        knee = result.likelihood.q0
        fitted = fit(skip_blurred_shells(spectra, knee), knee, per_decade=value)
        if fitted is None:
            return {}
        rms = float(np.sqrt(mean_square(fitted.plateau, fitted.q0, fitted.slope, result.cutoff)))
        return {"q0": fitted.q0, "slope": fitted.slope, "rms": rms}
    return {name: estimate.value for name, estimate in result.estimates.items()}
