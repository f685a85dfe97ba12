"""Hard cases of the topography stage: each recovers known truth, doubts or refuses (target
`stability`).
"""

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import partial
from typing import Any

import numpy as np

from mesoscale.errors import InputError
from mesoscale.settings import TopographySettings
from mesoscale.studies.driver import HardCase
from mesoscale.topography.description.parameters import Topography, analyse
from mesoscale.topography.description.trusted_range import TrustedSpectrum, trusted_map
from mesoscale.topography.measurements.cleaning import Scan, clean
from mesoscale.topography.measurements.loading import with_limits
from mesoscale.topography.roughness_spectrum import RoughSpectrum
from mesoscale.topography.synthetic_scans import ScanSet, surface_patch, synthetic_scans

TRUTH = ScanSet.model_validate(
    {
        "pixels": 256,
        "small_scans": 3,
        "large_scans": 3,
        "large_length_nm": 4000.0,
        "rms_variation": 0.0,
    }
)
WITHIN = {"q0": 0.25, "slope": 0.25, "rms": 0.1}  # coarse: a few scans of 256 x 256 pixels


def trusted_scan(scan: Scan, settings: TopographySettings) -> TrustedSpectrum:
    """Spectrum and trusted range of a raw scan."""
    return trusted_map(clean(scan, settings), with_limits(scan, settings))


@dataclass(frozen=True)
class Case:
    """Scans, what they show, and what the analysis must answer.

    `expected` is "recovers" (known truth within `WITHIN`), "doubts" (the gate fails, with `word`
    among the reasons) or "refuses" (an input error with `word` in it).
    """

    name: str
    description: str
    scans: Callable[[], list[Scan]]
    expected: str
    word: str = ""
    truth: ScanSet = TRUTH


def _standard(change: Callable[[Scan], Scan] = lambda scan: scan, **truth: Any) -> list[Scan]:
    """The standard set with changed truth, each scan passed through `change`."""
    return [change(item.scan) for item in synthetic_scans(TRUTH.model_copy(update=truth))]


def _edit(function: Callable[[np.ndarray], np.ndarray]) -> list[Scan]:
    return _standard(lambda scan: replace(scan, heights_nm=function(scan.heights_nm.copy())))


def _alone(heights: np.ndarray, length_nm: float = 1000.0) -> list[Scan]:
    return [Scan(heights, (length_nm, length_nm), "scan")]


def _tilted(heights: np.ndarray) -> np.ndarray:
    return (
        heights
        + 3.0 * np.arange(heights.shape[0])[:, None]
        - 1.5 * np.arange(heights.shape[1])[None, :]
    )


def _spiked(heights: np.ndarray) -> np.ndarray:
    heights[100, 57] += 2000.0
    return heights


def _holed(heights: np.ndarray) -> np.ndarray:
    holes = np.random.default_rng(0).random(heights.shape) < 0.01
    heights[holes] = np.nan
    heights[40:46, 90:96] = np.nan
    return heights


def _half_missing(heights: np.ndarray) -> np.ndarray:
    heights[: heights.shape[0] // 2] = np.nan
    return heights


def _lost_lines(heights: np.ndarray) -> np.ndarray:
    heights[:, [17, 80]] = np.nan
    return heights


def _streaked(heights: np.ndarray) -> np.ndarray:
    return heights + 4.0 * np.random.default_rng(1).standard_normal(heights.shape[1])[None, :]


def _stepped(heights: np.ndarray) -> np.ndarray:
    """Two terraces of 60 nm: an edge along the slow axis in the middle of each line."""
    heights[heights.shape[0] // 2 :] += 60.0
    return heights


def _saturated(heights: np.ndarray) -> np.ndarray:
    """The scanner's range ends within the roughness."""
    centred = heights - heights.mean()
    return np.clip(centred, -0.3 * centred.std(), 0.3 * centred.std())


def _wide(scan: Scan) -> Scan:
    """Only the middle three quarters of the lines: a scan that is not square."""
    ny = scan.heights_nm.shape[1]
    rows_measured = 3 * ny // 4
    return replace(
        scan,
        heights_nm=scan.heights_nm[:, :rows_measured],
        lengths_nm=(scan.lengths_nm[0], scan.lengths_nm[1] * rows_measured / ny),
    )


def _thinned(scan: Scan) -> Scan:
    """Every second line only: pixels twice as long along the slow axis."""
    return replace(scan, heights_nm=scan.heights_nm[:, ::2])


def _rough(slope: float, q0: float, pixels: int = 256, length_nm: float = 1000.0) -> np.ndarray:
    rng = np.random.default_rng(7)
    return surface_patch(RoughSpectrum.from_rms(1.0, q0, slope, 3.0), pixels, length_nm, rng)


def _one_wave() -> np.ndarray:
    x = np.arange(256) * 1000 / 256
    noise = 0.01 * np.random.default_rng(0).standard_normal((256, 256))
    return 5 * np.sin(2 * np.pi * x / 61)[:, None] * np.sin(2 * np.pi * x / 61)[None, :] + noise


CASES = (
    Case("standard", "small and large scans of one surface", _standard, "recovers"),
    Case("tilted", "tilt of 770 nm over a scan", lambda: _edit(_tilted), "recovers"),
    Case("spike", "one spike of 2 um in each scan", lambda: _edit(_spiked), "recovers"),
    Case("holes", "1 % missing pixels and a hole", lambda: _edit(_holed), "recovers"),
    Case("lost lines", "two scan lines missing", lambda: _edit(_lost_lines), "recovers"),
    Case(
        "half missing",
        "half of each scan missing",
        lambda: _edit(_half_missing),
        "refuses",
        "missing",
    ),
    Case("streaks", "scan lines offset by 4 nm", lambda: _edit(_streaked), "recovers"),
    Case("not square", "scans of 256 x 192 pixels", lambda: _standard(_wide), "recovers"),
    Case(
        "oblong pixels",
        "pixels twice as long across the lines",
        lambda: _standard(_thinned),
        "recovers",
    ),
    Case(
        "one size",
        "large scans only",
        lambda: _standard(small_scans=0, large_length_nm=3000.0, large_scans=4),
        "recovers",
    ),
    Case("coarse digits", "height steps of 0.5 nm", lambda: _standard(step_nm=0.5), "recovers"),
    Case("loud", "0.5 nm noise per pixel", lambda: _standard(noise_nm=0.5), "recovers"),
    Case("64", "scans of 64 x 64 pixels", lambda: _standard(pixels=64), "doubts", "identifiable"),
    Case(
        "many pixels",
        "one scan of 2048 x 2048 pixels over 8 um",
        lambda: _standard(
            pixels=2048, small_scans=0, large_scans=1, large_length_nm=8000, tip_radius_nm=2.0
        ),
        "recovers",
    ),
    Case("steps", "a terrace edge of 60 nm in each scan", lambda: _edit(_stepped), "doubts"),
    Case(
        "saturated",
        "heights cut off at 0.3 of their RMS",
        lambda: _edit(_saturated),
        "refuses",
        "cut off",
    ),
    Case(
        "constant",
        "all heights equal",
        lambda: _alone(np.zeros((256, 256))),
        "doubts",
        "identifiable",
    ),
    Case(
        "white noise",
        "no surface, only noise",
        lambda: _alone(np.random.default_rng(0).standard_normal((256, 256))),
        "doubts",
        "identifiable",
    ),
    Case(
        "no plateau",
        "roll-off far below the scan",
        lambda: _alone(_rough(2.8, 1e-3)),
        "doubts",
        "plateau",
    ),
    Case("no power law", "one wavelength of 61 nm", lambda: _alone(_one_wave()), "doubts"),
    Case(
        "H above 1",
        "slope 4.6, as grainy films have",
        lambda: _alone(_rough(4.6, 0.05)),
        "doubts",
        "H =",
    ),
    Case("H below 0", "slope 0.8", lambda: _alone(_rough(0.8, 0.05)), "doubts"),
)


def hard_cases(settings: TopographySettings) -> list[HardCase]:
    """The scans with their judges; the analysis has the scene's settings, the scans are the same in
    all scenes.
    """
    return [
        HardCase(
            case.name,
            case.description,
            _must(case.expected, case.word),
            partial(check, case, settings),
        )
        for case in CASES
    ]


def _must(expected: str, word: str) -> str:
    """What an answer must be, in words."""
    if expected == "recovers":
        return "q0, slope and RMS height are recovered"
    return f"{expected}: {word}" if word else expected


def check(case: Case, settings: TopographySettings) -> tuple[bool, str]:
    """Does the analysis answer as it must? With its answer in words."""
    try:
        scans = case.scans()
        result = analyse([trusted_scan(scan, settings) for scan in scans], settings)
    except InputError as error:
        return case.expected == "refuses" and case.word in str(error), str(error)
    if case.expected == "refuses":
        return False, "was not refused"
    if case.expected == "doubts":
        text = "; ".join(result.reasons)
        return bool(result.reasons) and case.word in text, text or "no doubts: " + _numbers(result)
    errors = {name: _error(result, name, case.truth) for name in WITHIN}
    fine = not result.reasons and all(abs(errors[name]) <= WITHIN[name] for name in WITHIN)
    text = ", ".join(f"{name} {value:+.3f}" for name, value in errors.items())
    return fine, "errors: " + text + "".join(f"; {reason}" for reason in result.reasons)


def _error(result: Topography, name: str, truth: ScanSet) -> float:
    true = {"q0": truth.q0, "slope": truth.slope, "rms": truth.rms_nm}[name]
    if name not in result.estimates:
        return float("inf")
    value = result.estimates[name].value
    return value - true if name == "slope" else value / true - 1


def _numbers(result: Topography) -> str:
    return ", ".join(f"{name} {estimate.value:.3g}" for name, estimate in result.estimates.items())
