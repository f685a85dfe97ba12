"""Error of q0, slope and RMS against the run time of the analysis, one knob at a time."""

import time
from collections.abc import Callable, Iterator
from typing import Any

import numpy as np

from mesoscale.settings import SyntheticScanSettings, TopographySettings
from mesoscale.topography.analysis import trusted_scan
from mesoscale.topography.description.likelihood import fit, skip_blurred_shells
from mesoscale.topography.description.parameters import analyse
from mesoscale.topography.description.trusted_range import trusted_range
from mesoscale.topography.measurements.cleaning import Scan, clean
from mesoscale.topography.roughness_spectrum import mean_square
from mesoscale.topography.spectrum import radial_spectrum
from mesoscale.topography.synthetic_scans import synthetic_scans

METRIC = {"q0": "relative RMS error", "slope": "absolute RMS error", "rms": "relative RMS error"}
PIXELS = (128, 256, 512, 1024)
SECTIONS = (1, 4, 25, 100)
FLAT_SHARES = (0.0, 0.5, 0.9, 0.99)
BINS = (4, 8, 12, 24)
TOLD_TIPS = (0.0, 0.8, 1.0, 1.2)
SCANS = ((1, 1), (2, 2), (4, 2), (8, 3))


def accuracy_points(
    base: SyntheticScanSettings,
    settings: TopographySettings,
    repeats: int,
    progress: Callable[[float, str], None] | None = None,
) -> Iterator[dict[str, Any]]:
    """Every value of every knob: RMS error over `repeats` surfaces, mean time of one analysis."""
    truth = base.model_copy(update={"rms_variation": 0.0, "pixels": min(base.pixels, 512)})
    cases: list[tuple[str, Any, SyntheticScanSettings, TopographySettings]] = []
    for pixels in PIXELS:
        if pixels <= base.pixels:
            few = truth.model_copy(update={"pixels": pixels, "small_scans": 2, "large_scans": 2})
            cases.append(("pixels", pixels, few, settings))
    for sections in SECTIONS:
        few = truth.model_copy(update={"small_scans": 2, "large_scans": 2})
        cases.append(("sections", sections, few, settings.model_copy(update={"sections": sections})))
    for small, large in SCANS:
        some = truth.model_copy(update={"small_scans": small, "large_scans": large})
        cases.append(("scans", small + large, some, settings))
    for flat in FLAT_SHARES:  # steep, because side lobes of the window cover steep spectra first
        few = truth.model_copy(update={"small_scans": 2, "large_scans": 2, "slope": 3.8, "tip_radius_nm": 1.0})
        cases.append(("flat share of window", flat, few, settings.model_copy(update={"tip_radius_nm": 1.0})))
    for tip in (0.0, 2.0, 5.0, 10.0, 20.0):
        few = truth.model_copy(update={"small_scans": 2, "large_scans": 2, "tip_radius_nm": tip})
        cases.append(("tip radius nm", tip, few, settings.model_copy(update={"tip_radius_nm": tip})))
    few = truth.model_copy(update={"small_scans": 2, "large_scans": 2})
    cases += [("bins per decade", bins, few, settings) for bins in BINS]
    for stated in TOLD_TIPS:
        other = settings.model_copy(update={"tip_radius_nm": stated * truth.tip_radius_nm})
        cases.append(("told over true tip radius", stated, few, other))
    for number, (knob, value, scans, analysis) in enumerate(cases):
        yield from _case(knob, value, scans, analysis, repeats)
        if progress:
            progress((number + 1) / len(cases), f"{knob} {value}")


def _case(
    knob: str, value: Any, truth: SyntheticScanSettings, settings: TopographySettings, repeats: int
) -> Iterator[dict[str, Any]]:
    known = {"q0": truth.q0, "slope": truth.slope, "rms": truth.rms_nm}
    errors: dict[str, list[float]] = {name: [] for name in known}
    wall, cpu = [], []
    for repeat in range(repeats):
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
    """Estimates of one set; a flat share replaces the Hann window, a number of bins that of the likelihood."""
    if knob == "flat share of window":
        spectra = []
        for scan in scans:
            heights = clean(scan, settings).heights_nm
            spectrum = radial_spectrum(heights, scan.lengths_nm, 25, settings.section_fraction, value, skip_lines=True)
            spectra.append(trusted_range(scan.name, spectrum, settings.tip_radius_nm))
    else:
        spectra = [trusted_scan(scan, settings) for scan in scans]
    result = analyse(spectra, settings)
    if knob == "bins per decade" and result.likelihood is not None:
        knee = result.likelihood.q0
        fitted = fit(skip_blurred_shells(spectra, knee), knee, per_decade=value)
        if fitted is None:
            return {}
        rms = float(np.sqrt(mean_square(fitted.plateau, fitted.q0, fitted.slope, result.cutoff)))
        return {"q0": fitted.q0, "slope": fitted.slope, "rms": rms}
    return {name: estimate.value for name, estimate in result.estimates.items()}
