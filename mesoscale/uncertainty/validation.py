"""Response surfaces against direct cycles: bias of mean and deviation, errors, Q²."""

from collections.abc import Iterable, Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from mesoscale.uncertainty.propagation import SURFACES, to_paper_outputs
from mesoscale.uncertainty.runs import OUTPUT_UNITS, OUTPUTS
from mesoscale.uncertainty.surrogate import Surrogate

Array = NDArray[np.float64]


def read_direct_runs(rows: Iterable[Mapping[str, str]], names: Sequence[str]) -> tuple[Array, Array]:
    """Inputs (m, n), and closing and opening parameters (m, 8; NaN where missing), of direct runs."""
    rows = list(rows)
    inputs = np.array([[float(row[name]) for name in names] for row in rows]).reshape(len(rows), len(names))
    outputs = np.array([[float(row[name]) if row[name] else np.nan for name in SURFACES] for row in rows])
    return inputs, outputs.reshape(len(rows), len(SURFACES))


def validation_rows(
    inputs: Array,
    direct: Array,
    surfaces: Sequence[Surrogate | None],
    propagated: Array,
    bootstrap: int,
    seed: int,
) -> list[dict[str, Any]]:
    """Rows of uq/validation.csv, one per output of Table 2.

    Parameters
    ----------
    inputs, direct : the direct runs, (m, n) and (m, 8).
    surfaces : the response surfaces in the order of SURFACES.
    propagated : closing and opening parameters of the propagated samples, shape (k, 8).

    Notes
    -----
    Every direct run has its own surface, so `q2` (1 - mean squared error / variance of the runs) includes the
    scatter between surfaces and cannot reach 1. Intervals (5 to 95 %) are bootstraps over the direct runs.
    """
    predicted = to_paper_outputs(
        np.stack([s(inputs) if s else np.full(len(inputs), np.nan) for s in surfaces], axis=1).reshape(-1, 8)
    )
    truth, samples = to_paper_outputs(direct), to_paper_outputs(propagated)
    rng = np.random.default_rng(np.random.SeedSequence([seed, 0xB1]))
    rows = []
    for k, (output, unit) in enumerate(zip(OUTPUTS, OUTPUT_UNITS, strict=True)):
        usable = np.isfinite(truth[:, k])
        y, fit = truth[usable, k], predicted[usable, k]
        row: dict[str, Any] = {
            "output": output,
            "unit": unit,
            "runs": len(truth),
            "missing": int((~usable).sum()),
        }
        if len(y) >= 3:
            picks = rng.integers(len(y), size=(bootstrap, len(y)))
            resampled = y[picks]
            statistics = {
                "mean": (y.mean(), resampled.mean(axis=1), samples[:, k].mean()),
                "dev": (y.std(ddof=1), resampled.std(axis=1, ddof=1), samples[:, k].std()),
                "q05": (
                    np.quantile(y, 0.05),
                    np.quantile(resampled, 0.05, axis=1),
                    np.quantile(samples[:, k], 0.05),
                ),
                "q50": (
                    np.quantile(y, 0.5),
                    np.quantile(resampled, 0.5, axis=1),
                    np.quantile(samples[:, k], 0.5),
                ),
                "q95": (
                    np.quantile(y, 0.95),
                    np.quantile(resampled, 0.95, axis=1),
                    np.quantile(samples[:, k], 0.95),
                ),
            }
            for name, (direct_value, draws, surface_value) in statistics.items():
                low, high = np.quantile(draws, [0.05, 0.95])
                row |= {
                    f"{name}_direct": direct_value,
                    f"{name}_direct_low": low,
                    f"{name}_direct_high": high,
                    f"{name}_surface": surface_value,
                }
            errors = fit - y
            q2 = 1 - (errors**2).mean() / y.var() if y.var() > 0 else np.nan
            draws = 1 - (errors[picks] ** 2).mean(axis=1) / np.maximum(resampled.var(axis=1), 1e-300)
            low, high = np.quantile(draws, [0.05, 0.95]) if np.isfinite(draws).all() else (np.nan, np.nan)
            row |= {
                "rmse": np.sqrt((errors**2).mean()),
                "bias": errors.mean(),
                "q2": q2,
                "q2_low": low,
                "q2_high": high,
            }
        rows.append(row)
    return rows


VALIDATION_COLUMNS = (
    "output",
    "unit",
    "runs",
    "missing",
    *(
        f"{name}_{kind}"
        for name in ("mean", "dev", "q05", "q50", "q95")
        for kind in ("direct", "direct_low", "direct_high", "surface")
    ),
    "rmse",
    "bias",
    "q2",
    "q2_low",
    "q2_high",
)
