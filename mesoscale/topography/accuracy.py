"""Error of q0, slope and RMS against the run time of the analysis, one knob at a time."""

import time
from collections.abc import Callable, Iterator
from typing import Any

import numpy as np

from mesoscale.settings import TopographySettings
from mesoscale.topography.description.likelihood import fit, skip_blurred_shells
from mesoscale.topography.description.parameters import analyse
from mesoscale.topography.description.trusted_range import trusted_range
from mesoscale.topography.measurements.cleaning import Scan, clean
from mesoscale.topography.roughness_spectrum import mean_square
from mesoscale.topography.spectrum import hann_spectrum
from mesoscale.topography.synthetic_scans import ScanSet, synthetic_scans

REPEATS = 3  # surfaces of each value
METRIC = {"q0": "relative RMS error", "slope": "absolute RMS error", "rms": "relative RMS error"}
PIXELS = (128, 256, 512, 1024)
SECTIONS = (1, 4, 25)
SCANS = ((1, 1), (2, 2), (4, 2), (8, 3))
FLAT_SHARES = (0.0, 0.5, 0.9, 0.99)
TIPS_NM = (0.0, 2.0, 5.0, 10.0, 20.0)
BINS = (4, 8, 12, 24)
TOLD_TIPS = (0.0, 0.8, 1.0, 1.2)


def accuracy_points(
    settings: TopographySettings, progress: Callable[[float, str], None] | None = None
) -> Iterator[dict[str, Any]]:
    """Every value of every knob: RMS error over REPEATS surfaces, mean time of one analysis."""
    cases = list(_cases(ScanSet(**settings.synthetic.model_dump(), rms_variation=0.0)))
    for number, (knob, value, scans, radius_nm) in enumerate(cases):
        analysis = settings if radius_nm is None else settings.model_copy(update={"tip_radius_nm": radius_nm})
        yield from _case(knob, value, scans, analysis)
        if progress:
            progress((number + 1) / len(cases), f"{knob} {value}")


def _cases(base: ScanSet) -> Iterator[tuple[str, Any, ScanSet, float | None]]:
    """Knob, value, scans, and the tip radius that the analysis is told where it is not the scene's."""
    truth = base.model_copy(update={"pixels": min(base.pixels, 512)})

    def few(**changes: Any) -> ScanSet:
        return truth.model_copy(update={"small_scans": 2, "large_scans": 2, **changes})

    yield from (("pixels", pixels, few(pixels=pixels), None) for pixels in PIXELS if pixels <= base.pixels)
    yield from (("sections", sections, few(), None) for sections in SECTIONS)
    yield from (("scans", small + large, few(small_scans=small, large_scans=large), None) for small, large in SCANS)
    steep = few(slope=3.8, tip_radius_nm=1.0)  # side lobes of the window cover steep spectra first
    yield from (("flat share of window", flat, steep, 1.0) for flat in FLAT_SHARES)
    yield from (("tip radius nm", tip, few(tip_radius_nm=tip), tip) for tip in TIPS_NM)
    yield from (("bins per decade", bins, few(), None) for bins in BINS)
    yield from (("told over true tip radius", factor, few(), factor * truth.tip_radius_nm) for factor in TOLD_TIPS)


def _case(knob: str, value: Any, truth: ScanSet, settings: TopographySettings) -> Iterator[dict[str, Any]]:
    known = {"q0": truth.q0, "slope": truth.slope, "rms": truth.rms_nm}
    errors: dict[str, list[float]] = {name: [] for name in known}
    wall, cpu = [], []
    for repeat in range(REPEATS):
        scans = [item.scan for item in synthetic_scans(truth.model_copy(update={"seed": truth.seed + 1000 * repeat}))]
        started, busy = time.perf_counter(), time.process_time()
        estimates = _estimates(scans, settings, knob, value)
        wall.append(time.perf_counter() - started)
        cpu.append(time.process_time() - busy)
        for name, true in known.items():
            estimate = estimates.get(name, float("nan"))
            errors[name].append(estimate - true if name == "slope" else estimate / true - 1)
    for name in known:
        yield {
            "case": name,
            "knob": knob,
            "value": value,
            "error": float(np.sqrt(np.mean(np.square(errors[name])))),
            "error_metric": METRIC[name],
            "reference": "truth of the synthetic scans",
            "wall_s": float(np.mean(wall)),
            "cpu_s": float(np.mean(cpu)),
        }


def _estimates(scans: list[Scan], settings: TopographySettings, knob: str, value: Any) -> dict[str, float]:
    """Estimates of one set; a knob of the spectrum or of the likelihood takes its value."""
    changes = {"sections": {"sections": value}, "flat share of window": {"flat": value}}.get(knob, {})
    cleaned = [clean(scan, settings) for scan in scans]
    radius = settings.tip_radius_nm
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
