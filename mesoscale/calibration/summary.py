"""Rows and values of the result files of the calibration."""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from importlib.metadata import version
from typing import Any

import numpy as np
from numpy.typing import NDArray

from mesoscale.calibration.learning import information_bits
from mesoscale.calibration.measurements import Measurements
from mesoscale.calibration.observables import CURVES, LEVELS, curve_names, force_levels_nN
from mesoscale.calibration.posterior import Calibration
from mesoscale.calibration.responses import untransformed

Array = NDArray[np.float64]

QUANTILES = {"q05": 0.05, "q50": 0.5, "q95": 0.95}
MARGINAL_POINTS = 401
"""Quantiles of a posterior that stand in posterior.json and go on into inputs.csv."""
PREDICTED = 1000
_STATES = ("prior", "posterior")


def _spread(state: str, values: Array) -> dict[str, float]:
    return {f"{state}_{name}": float(np.quantile(values, share)) for name, share in QUANTILES.items()}


def summary_rows(result: Calibration) -> list[dict[str, Any]]:
    """Prior and posterior of every input; none without a posterior."""
    if not result.chain.converged:
        return []
    table = result.posterior.table
    prior = table.sample(len(result.x), 1)
    places = {place: k for k, place in enumerate(result.posterior.free)}
    return [
        {
            "parameter": row.name,
            "unit": row.unit,
            "prior_mean": prior[:, k].mean(),
            "prior_sd": prior[:, k].std(),
            "posterior_mean": result.x[:, k].mean(),
            "posterior_sd": result.x[:, k].std(),
            "bits": information_bits(result.chain.z[:, [places[k]]]) if k in places else 0.0,
            **_spread("prior", prior[:, k]),
            **_spread("posterior", result.x[:, k]),
        }
        for k, row in enumerate(table.rows)
    ]


def sample_rows(result: Calibration) -> list[dict[str, float]]:
    """Samples of the posterior; none if the chain has not converged."""
    if not result.chain.converged:
        return []
    columns = [*result.posterior.table.names, "log_likelihood"]
    values = np.column_stack([result.x, result.chain.log_likelihood]).tolist()
    return [dict(zip(columns, row, strict=True)) for row in values]


def predictive_rows(result: Calibration, max_force_nN: float) -> list[dict[str, Any]]:
    """What the next surface and the next switch will show, before and after the measurements (5, 50, 95 %)."""
    if not result.chain.converged:
        return []
    rng = np.random.default_rng(np.random.SeedSequence([0xCE]))
    states = {
        "prior": result.posterior.table.sample(PREDICTED, 2),
        "posterior": result.x[rng.integers(len(result.x), size=PREDICTED)],
    }
    drawn = {state: _next_surface(result, x, rng) for state, x in states.items()}
    with_switch = replace(result.posterior, switch=result.switch, law_responses=result.laws)
    hamaker = result.posterior.table.names.index("hamaker")
    volts = {state: with_switch.switch_voltages(x, x[:, hamaker]) for state, x in states.items()}
    rows = []
    names = [row.name for row in result.responses.observables]
    for branch in CURVES.values():
        first = names.index(curve_names(branch)[0])
        separations = {
            state: y[:, first : first + 1]
            - np.cumsum(np.column_stack([np.zeros(len(y)), y[:, first + 1 : first + LEVELS]]), axis=1)
            for state, y in drawn.items()
        }
        for k, force in enumerate(force_levels_nN(max_force_nN)):
            spread = {
                key: value for state in _STATES for key, value in _spread(state, separations[state][:, k]).items()
            }
            rows.append({"quantity": f"{branch} separation", "unit": "nm", "force_nN": force, **spread})
    for name, unit in (("contact_begin_nm", "nm"), ("pull_off_nN", "nN")):
        place = names.index(name)
        spread = {key: value for state in _STATES for key, value in _spread(state, drawn[state][:, place]).items()}
        rows.append({"quantity": name.rpartition("_")[0], "unit": unit, "force_nN": "", **spread})
    for kind in ("pull_in", "release"):
        values = {
            state: mean + sd * rng.standard_normal(len(sd)) for state, v in volts.items() for mean, sd in [v[kind]]
        }
        spread = {key: value for state in _STATES for key, value in _spread(state, values[state]).items()}
        rows.append({"quantity": kind, "unit": "V", "force_nN": "", **spread})
    return rows


def _next_surface(result: Calibration, x: Array, rng: np.random.Generator) -> Array:
    """Observables of one more surface at each of the inputs x (m, n), in their units, shape (m, k)."""
    prediction = result.responses.every(x)
    root = np.linalg.cholesky(
        prediction.scatter * (1 + prediction.error)[:, None, None] + 1e-12 * np.eye(prediction.mean.shape[1])
    )
    drawn = prediction.mean + np.einsum("mjk,mk->mj", root, rng.standard_normal(prediction.mean.shape))
    return untransformed(result.responses.observables, drawn)


def posterior_json(
    result: Calibration, tables: Sequence[Measurements], lessons: Sequence[Mapping[str, Any]], remarks: Sequence[str]
) -> dict[str, Any]:
    """Content of posterior.json: the gate, the chain, and the inputs as the next stage takes them."""
    from scipy.stats import rankdata

    names = result.posterior.table.names
    chain = result.chain
    conflicts = [
        f"{row['kind']} ({row['file']}) {row['verdict']}" for row in lessons if "contradicts" in row["verdict"]
    ]
    shares = [row["error_share"] for row in result.checks if row["round"] == result.checks[-1]["round"]]
    inputs: dict[str, Any] = {}
    if chain.converged:
        ranks = np.corrcoef([rankdata(column) for column in result.x.T]) if len(names) > 1 else np.eye(1)
        probabilities = np.linspace(0, 1, MARGINAL_POINTS)
        for k, name in enumerate(names):
            partners = {
                names[j]: float(ranks[k, j])
                for j in range(k)
                if np.isfinite(ranks[k, j]) and k in result.posterior.free and j in result.posterior.free
            }
            inputs[name] = {
                "distribution": "samples",
                "a": float(result.x[:, k].mean()),
                "b": float(result.x[:, k].std()),
                "values": np.quantile(result.x[:, k], probabilities).tolist(),
                "correlation": partners,
            }
    return {
        "gate": {"passed": not result.reasons, "reasons": result.reasons},
        "remarks": [*conflicts, *remarks],
        "chain": {
            "sampler": f"emcee {version('emcee')}",
            "converged": chain.converged,
            "r_hat": chain.r_hat,
            "independent_draws": chain.effective,
            "steps": chain.steps,
            "acceptance": chain.acceptance,
            "autocorrelation_steps": chain.autocorrelation,
        },
        "information_bits": information_bits(chain.z) if chain.converged else None,
        "cycles": result.cycles,
        "response_error_share": max(shares, default=0.0),
        "rounds": max((row["round"] for row in result.checks), default=0),
        "tables": {
            data.kind: {
                "file": data.file,
                "source": data.source,
                "rows": len(data),
                "discrepancy": data.discrepancy,
            }
            for data in tables
        },
        "points_left_out": result.posterior.surfaces.left_out if result.posterior.surfaces else 0,
        "inputs": inputs,
    }
