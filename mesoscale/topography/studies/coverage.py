"""How often the stated intervals hold the truth: sets of maps, of grainy maps, of line profiles, of both together.

python -m mesoscale.topography.studies.coverage KIND FIRST LAST TABLE adds the rows of sets FIRST .. LAST - 1 of one
kind to a table (about 5 s a set); without KIND it prints the shares of the table.
"""

import sys
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from mesoscale.errors import InputError
from mesoscale.settings import SyntheticScanSettings, TopographySettings
from mesoscale.tables import grow_table, load_table
from mesoscale.topography.analysis import trusted_measurement
from mesoscale.topography.description.heights import common_heights, compare_heights, height_quantiles, not_gaussian
from mesoscale.topography.description.trusted_range import TrustedSpectrum
from mesoscale.topography.height_synthesis import Z, synthesize_heights
from mesoscale.topography.measurements.cleaning import Scan, clean
from mesoscale.topography.measurements.loading import Measurement
from mesoscale.topography.measurements.profiles import Profile
from mesoscale.topography.pooling import parameters_of
from mesoscale.topography.profile_conversion import projected
from mesoscale.topography.roughness_spectrum import RoughSpectrum, mean_square
from mesoscale.topography.studies.recovery import TOLERANCE, random_truth
from mesoscale.topography.synthetic_scans import dilate, measure, synthetic_scans

# the tip meets the surface on 1 nm or 5 nm; of what it traces every fourth pixel is kept, for speed
BASE = SyntheticScanSettings(
    pixels=1024, small_scans=4, large_scans=3, large_length_nm=5000.0, rms_variation=0.0, seed=17
)
THINNED = 4
# of grainy maps: one step for both sizes, because finer roughness under a tip changes all waves of its image
GRAINY_MAPS = ((1000.0, 512), (3000.0, 1536))
LINES = ((8000.0, 4), (2000.0, 4))  # length in nm and number of the profiles of a set
LINE_POINTS, FINER = 2048, 4
SHAPES = 0.1, 0.3  # log-normal heights: skewness 0.3 to 0.95; for more the spectrum can no longer be kept
COLUMNS = (
    *("kind", "set", "measurements", "refused", "doubts"),
    *(name + suffix for name in TOLERANCE for suffix in ("_true", "", "_low", "_high", "_covered")),
)


def maps(truth: SyntheticScanSettings, stated_nm: float) -> Iterator[Measurement]:
    """Scans of a Gaussian surface, seen with a tip whose radius is stated as `stated_nm`."""
    for item in synthetic_scans(truth):
        yield Measurement(_thinned(item.scan, THINNED), stated_nm, True)


def _thinned(scan: Scan, stride: int) -> Scan:
    return replace(scan, heights_nm=np.ascontiguousarray(scan.heights_nm[::stride, ::stride]))


def grainy_maps(truth: SyntheticScanSettings, stated_nm: float) -> Iterator[Measurement]:
    """Scans of a surface of the same spectrum whose heights are distributed log-normally: tall grains."""
    rng = np.random.default_rng(np.random.SeedSequence(truth.seed, spawn_key=(2,)))
    heights = common_heights([np.exp(rng.uniform(*SHAPES) * Z)])
    for (length, sites), count in zip(GRAINY_MAPS, (truth.small_scans, truth.large_scans), strict=True):
        for _ in range(count):
            spectrum = RoughSpectrum.from_rms(truth.rms_nm, truth.q0, truth.slope, truth.q1)
            rms = _random_rms(spectrum, 2 * length, 2 * sites, rng)
            larger = synthesize_heights(2 * sites, 2 * length, spectrum.psd, heights, rms, int(rng.integers(2**31)))
            surface = dilate(larger[:sites, :sites], truth.tip_radius_nm, length / sites)
            scan = measure(surface, length, truth, rng, f"grainy_{rng.integers(2**31)}")
            yield Measurement(_thinned(scan, sites * THINNED // truth.pixels), stated_nm, True)


def _random_rms(spectrum: RoughSpectrum, length: float, sites: int, rng: np.random.Generator) -> float:
    """RMS height of one periodic surface: `synthesize_heights` gives each the same, chance does not."""
    q = np.geomspace(2 * np.pi / length, np.pi * sites / length, 400)
    square = np.trapezoid(2 * np.pi * q * spectrum.psd(q), q)
    fourth = np.trapezoid(2 * np.pi * q * spectrum.psd(q) ** 2, q) * (2 * np.pi / length) ** 2
    return float(np.sqrt(square * max(1 + np.sqrt(2 * fourth) / square * rng.standard_normal(), 0.1)))


def lines(truth: SyntheticScanSettings, _stated_nm: float = 0.0) -> Iterator[Measurement]:
    """Profiles of two lengths across a Gaussian surface, by an instrument without tip, tilted and noisy."""
    rng = np.random.default_rng(np.random.SeedSequence(truth.seed, spawn_key=(3,)))
    spectrum = RoughSpectrum.from_rms(truth.rms_nm, truth.q0, truth.slope, truth.q1)
    q = np.geomspace(1e-5, truth.q1, 4000)
    for length, count in LINES:
        for number in range(count):
            heights = _line(q, spectrum.psd(q), length, rng)
            heights += truth.noise_nm * rng.standard_normal(LINE_POINTS)
            heights += np.linspace(0, length * np.tan(np.radians(truth.tilt_deg * rng.uniform(-1, 1))), LINE_POINTS)
            yield Measurement(Profile(heights, length, f"line_{length:g}_{number}"), 0.0, True)


def _line(q: np.ndarray, psd: np.ndarray, length: float, rng: np.random.Generator) -> np.ndarray:
    """Heights along a line across a surface, cut from twice its length, sampled from finer points."""
    n, step = 2 * FINER * LINE_POINTS, length / LINE_POINTS / FINER
    k = 2 * np.pi * np.fft.rfftfreq(n, step)[1:]
    c1 = np.where(k < q[-1], projected(q, psd, np.minimum(k, 0.999 * q[-1])), 0.0)
    noise = rng.standard_normal((2, len(k))) / np.sqrt(2)
    waves = (noise[0] + 1j * noise[1]) * np.sqrt(c1 * 2 * np.pi / (n * step)) * n
    return np.fft.irfft(np.concatenate([[0.0], waves]), n)[: n // 2 : FINER]


def mixed(truth: SyntheticScanSettings, stated_nm: float) -> Iterator[Measurement]:
    """Maps of 1 um, too small for the plateau, and the long profiles, which see it."""
    yield from maps(truth.model_copy(update={"large_scans": 0}), stated_nm)
    yield from (item for item in lines(truth) if item.data.name.startswith(f"line_{LINES[0][0]:g}"))


KINDS: dict[str, Callable[[SyntheticScanSettings, float], Iterator[Measurement]]] = {
    "areal": maps,
    "grainy": grainy_maps,
    "lines": lines,
    "mixed": mixed,
}


def coverage_rows(kind: str, numbers: range) -> Iterator[dict[str, Any]]:
    """One row per set: truth, estimate, interval, and whether it covers."""
    for number in numbers:
        truth, stated = random_truth(number, BASE)
        settings = TopographySettings(scans=("set",), tip_radius_nm=stated)
        spectra, quantiles, refused = _trusted(KINDS[kind](truth, stated), settings)
        result, _, _ = parameters_of(spectra, quantiles, settings)
        cutoff = min(result.cutoff, truth.q1)
        spectrum = RoughSpectrum.from_rms(truth.rms_nm, truth.q0, truth.slope, truth.q1)
        rms = float(np.sqrt(mean_square(spectrum.plateau, truth.q0, truth.slope, cutoff)))
        row: dict[str, Any] = {"kind": kind, "set": number, "measurements": len(spectra), "refused": refused}
        row["doubts"] = " ".join(doubt.code for doubt in result.doubts)
        for name, value in (("q0", truth.q0), ("slope", truth.slope), ("rms", rms)):
            row[f"{name}_true"] = value
            if name in result.estimates:
                low, high = result.estimates[name].interval
                row |= {name: result.estimates[name].value, f"{name}_low": low, f"{name}_high": high}
                row[f"{name}_covered"] = low <= value <= high
        yield row


def _trusted(
    measured: Iterator[Measurement], settings: TopographySettings
) -> tuple[list[TrustedSpectrum], dict[str, np.ndarray], int]:
    """Spectra of the measurements, heights of maps where they are not Gaussian, and how many say nothing (noise)."""
    spectra, tests, quantiles, refused = [], [], {}, 0
    for item in measured:
        try:
            spectra.append(trusted_measurement(item, settings))
        except InputError:
            refused += 1
            continue
        if isinstance(item.data, Scan):
            cleaned = clean(item.data, settings)
            tests.append(compare_heights(cleaned.name, cleaned.heights_nm, cleaned.lengths_nm))
            quantiles[cleaned.name] = height_quantiles(cleaned.heights_nm)
    return spectra, quantiles if not_gaussian(tests) else {}, refused


def shares(rows: Sequence[Mapping[str, Any]], kind: str) -> dict[str, float]:
    """Sets of a kind; of each parameter the share covered, and mean, RMS and largest error.

    Errors are relative, that of the slope absolute.
    """
    mine = [row for row in rows if row["kind"] == kind and row.get("q0")]
    result: dict[str, float] = {"sets": len(mine)}
    for name in TOLERANCE:
        true, value = (np.array([float(row[key]) for row in mine]) for key in (f"{name}_true", name))
        error = value - true if name == "slope" else value / true - 1
        result[f"{name}_covered"] = float(np.mean([str(row[f"{name}_covered"]) == "True" for row in mine]))
        result[f"{name}_bias"], result[f"{name}_error"] = float(error.mean()), float(np.sqrt(np.mean(error**2)))
        result[f"{name}_worst"] = float(np.abs(error).max())
    return result


def main(arguments: Sequence[str]) -> None:
    """Add rows to a table as they are made, or print its shares."""
    path = Path(arguments[-1])
    if len(arguments) == 1:
        rows = load_table(path)
        for kind in KINDS:
            if any(row["kind"] == kind for row in rows):
                print(kind, *(f"{key} {value:.3g}" for key, value in shares(rows, kind).items()), sep="  ")
        return
    kind, first, last = arguments[0], int(arguments[1]), int(arguments[2])
    grow_table(path, coverage_rows(kind, range(first, last)), 6, COLUMNS)


if __name__ == "__main__":
    main(sys.argv[1:])
