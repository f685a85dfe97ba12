"""How well the analysis returns known truth: sets of synthetic scans with random truth and artefacts."""

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

import numpy as np

from mesoscale.settings import SyntheticScanSettings, TopographySettings
from mesoscale.topography.analysis import trusted_scan
from mesoscale.topography.description.parameters import Topography, analyse
from mesoscale.topography.description.trusted_range import TrustedSpectrum
from mesoscale.topography.synthetic_scans import synthetic_scans

TOLERANCE = {"q0": 0.20, "slope": 0.15, "rms": 0.05}  # relative for q0 and rms, absolute for the slope
COLUMNS = (
    *("set", "method", "tip_radius_nm", "told_tip_radius_nm", "gate"),
    *(
        name + suffix
        for name in TOLERANCE
        for suffix in ("_true", "", "_low", "_high", "_error", "_within", "_covered")
    ),
)
TIP_UNCERTAINTY = 0.2  # the analysis is told a tip radius that is wrong by up to this share


def random_truth(number: int, base: SyntheticScanSettings) -> tuple[SyntheticScanSettings, float]:
    """Truth and artefacts of set `number`, and the tip radius (nm) that the analysis is told."""
    rng = np.random.default_rng(np.random.SeedSequence(base.seed, spawn_key=(99, number)))
    tip = float(rng.uniform(2, 10))
    truth = base.model_copy(
        update={
            "seed": int(rng.integers(2**31)),
            "q0": float(rng.uniform(0.015, 0.035)),
            "slope": float(rng.uniform(2.2, 3.8)),
            "rms_nm": float(np.exp(rng.uniform(np.log(2), np.log(12)))),
            "tip_radius_nm": tip,
            "noise_nm": float(rng.uniform(0.02, 0.1)),
            "line_noise_nm": float(rng.uniform(0, 0.5)),
            "tilt_deg": float(rng.uniform(0, 2)),
            "drift_nm": float(rng.uniform(0, 10)),
            "step_nm": float(rng.uniform(0.002, 0.05)),
        }
    )
    return truth, tip * float(rng.uniform(1 - TIP_UNCERTAINTY, 1 + TIP_UNCERTAINTY))


def analysed_set(
    truth: SyntheticScanSettings, settings: TopographySettings
) -> tuple[Topography, list[TrustedSpectrum], list[float]]:
    """Parameters, spectra and true RMS heights (nm) of the scans of one synthetic set."""
    spectra, rms = [], []
    for item in synthetic_scans(truth):
        spectra.append(trusted_scan(item.scan, settings))
        rms.append(item.truth.rms_nm)
    return analyse(spectra, settings), spectra, rms


def recovery_rows(
    numbers: range, base: SyntheticScanSettings, settings: TopographySettings
) -> Iterator[dict[str, Any]]:
    """One row per set and method: truth, estimate, interval, error, whether within tolerance and covered."""
    for number in numbers:
        truth, stated_radius = random_truth(number, base)
        known = {"q0": truth.q0, "slope": truth.slope, "rms": truth.rms_nm}
        stated_settings = settings.model_copy(update={"tip_radius_nm": stated_radius, "convention": "areal"})
        result, spectra, _ = analysed_set(truth, stated_settings)
        for method in ("likelihood", "lines"):
            if method == "lines":
                result = analyse(spectra, stated_settings.model_copy(update={"method": "lines"}))
            row: dict[str, Any] = {"set": number, "method": method, "tip_radius_nm": truth.tip_radius_nm}
            row["told_tip_radius_nm"] = stated_radius
            row["gate"] = "; ".join(reason for reason in result.reasons if not reason.startswith("H ="))
            for name, value in known.items():
                estimate = result.estimates.get(name)
                row[f"{name}_true"] = value
                if estimate is None:
                    continue
                low, high = estimate.interval
                error = estimate.value - value if name == "slope" else estimate.value / value - 1
                row[f"{name}"] = estimate.value
                row[f"{name}_low"], row[f"{name}_high"] = low, high
                row[f"{name}_error"] = error
                row[f"{name}_within"] = abs(error) <= TOLERANCE[name]
                row[f"{name}_covered"] = low <= value <= high
            yield row


def summary(rows: Sequence[Mapping[str, Any]], method: str) -> dict[str, float]:
    """Shares of sets within tolerance and covered, for one method; rows as made here or read from their table."""
    mine = [row for row in rows if row["method"] == method]
    result: dict[str, float] = {"sets": len(mine)}
    for name in TOLERANCE:
        for kind in ("within", "covered"):
            yes = sum(str(row.get(f"{name}_{kind}")).lower() == "true" for row in mine)
            result[f"{name}_{kind}"] = yes / max(len(mine), 1)
    return result
