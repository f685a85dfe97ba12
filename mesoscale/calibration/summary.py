"""What the measurements changed, and whether they agree: result files of the calibration."""

from importlib.metadata import version
from typing import Any

import numpy as np
from numpy.typing import NDArray

from mesoscale.calibration.observables import (
    CURVES,
    NAMES,
    SCALARS,
    curve_names,
    enter_by_logarithm,
    force_levels_nN,
)
from mesoscale.calibration.posterior import RESPONSE_ERROR, Calibration, Posterior
from mesoscale.calibration.responses import fit_responses
from mesoscale.calibration.sampling import Sampling

Array = NDArray[np.float64]


def _spread(states: dict[str, Array]) -> dict[str, float]:
    """Quantiles before and after."""
    quantiles = {"q05": 0.05, "q50": 0.5, "q95": 0.95}
    spread = {}
    for state, values in states.items():
        for name, share in quantiles.items():
            spread[f"{state}_{name}"] = float(np.quantile(values, share))
    return spread


def summary_rows(result: Calibration) -> list[dict[str, Any]]:
    """Prior and posterior of every input; none without a posterior."""
    if not result.chain.converged:
        return []
    prior = result.model.prior.sample(len(result.x), 1)
    rows = []
    for k, row in enumerate(result.model.prior.rows):
        spread = _spread({"prior": prior[:, k], "posterior": result.x[:, k]})
        rows.append({"parameter": row.name, "unit": row.unit, **spread})
    return rows


def sample_rows(result: Calibration) -> list[dict[str, float]]:
    """Samples of the posterior; none if the chain has not converged."""
    if not result.chain.converged:
        return []
    columns = [*result.model.prior.names, "log_likelihood"]
    values = np.column_stack([result.x, result.chain.log_likelihood]).tolist()
    return [dict(zip(columns, row, strict=True)) for row in values]


def predictive_rows(result: Calibration) -> list[dict[str, Any]]:
    """What the next surface and switch will show, before and after the data (5, 50, 95 %)."""
    if not result.chain.converged:
        return []
    rng = np.random.default_rng(np.random.SeedSequence([0xCE]))
    model = result.model
    picks = rng.integers(len(result.x), size=1000)
    states = {"prior": model.prior.sample(1000, 2), "posterior": result.x[picks]}
    responses = fit_responses(NAMES, model.cycles, model.prior)
    seen: dict[str, Array] = {}
    for state, x in states.items():
        prediction = responses(x)
        root = np.linalg.cholesky(prediction.scatter * (1 + prediction.error)[:, None, None])
        normals = rng.standard_normal(prediction.mean.shape)
        f = prediction.mean + np.einsum("mjk,mk->mj", root, normals)
        values = np.exp(np.minimum(f, 700.0))
        seen[state] = np.where(enter_by_logarithm(NAMES), values, f)
    rows = []
    for branch in CURVES.values():
        first = NAMES.index(curve_names(branch)[0])
        for k, force in enumerate(force_levels_nN(model.max_force_nN)):
            separation = {}
            for state, y in seen.items():
                steps = y[:, first + 1 : first + 1 + k]
                separation[state] = y[:, first] - steps.sum(axis=1)
            row = {"quantity": f"{branch} separation", "unit": "nm", "force_nN": force}
            rows.append({**row, **_spread(separation)})
    for kind, name in SCALARS.items():
        values = {state: y[:, NAMES.index(name)] for state, y in seen.items()}
        row = {"quantity": kind, "unit": name.rpartition("_")[2], "force_nN": ""}
        rows.append({**row, **_spread(values)})
    for kind, volts in model.voltages.items():
        width = np.hypot(volts.shared_V, volts.each_V)
        values = {}
        for state, x in states.items():
            values[state] = volts(x) + width * rng.standard_normal(len(x))
        rows.append({"quantity": kind, "unit": "V", "force_nN": "", **_spread(values)})
    return rows


def checks(result: Calibration) -> dict[str, dict[str, Any]]:
    """Whether each table agrees with what the others and the prior predict, by kind."""
    rng = np.random.default_rng(np.random.SeedSequence([Sampling.seed, 0xCC]))
    agreement = {}
    for data in result.tables:
        other_tables = [other for other in result.tables if other is not data]
        reference = result.model.posterior(other_tables)
        if other_tables:
            z = reference.draw().z
            expectation = "what the other measurements and the prior lead to"
        else:
            z = rng.standard_normal((len(result.x), len(reference.free)))
            expectation = "the prior"
        table = result.model.posterior([data])
        probability = predictive_probability(table, reference.inputs(z), rng)
        verdict = f"agrees with {expectation}"
        if probability < 0.01:
            as_unlikely = "no" if probability == 0 else "few"
            verdict = (
                f"contradicts {expectation}: {as_unlikely} made-up data sets are as unlikely; an"
                " error that is too small, another contact area, a prior too narrow, or the model"
                " itself"
            )
        agreement[data.kind] = {"probability": probability, "verdict": verdict}
    return agreement


def predictive_probability(data: Posterior, x: Array, rng: np.random.Generator) -> float:
    """Share of made-up data sets less likely than the measured ones, at samples x (m, n).

    Box, J. R. Statist. Soc. A 143, 383 (1980): the predictive density at the data is compared with
    those of its draws.
    """
    replicates = 200  # a probability is known to 0.015 at 0.05
    x = x[rng.integers(len(x), size=replicates)]

    def log_predictive(some: Posterior) -> float:
        return float(np.logaddexp.reduce(some.log_likelihood(x)))

    measured = log_predictive(data)
    made_up = [log_predictive(data.simulated(x[k : k + 1], rng)) for k in range(replicates)]
    return float(np.mean(np.array(made_up) <= measured))


def posterior_json(result: Calibration, agreement: dict[str, dict[str, Any]]) -> dict[str, Any]:
    """Content of posterior.json: the gate, the chain, the tables, and inputs for the next stage.

    Parameters
    ----------
    agreement : see `checks`; empty without a posterior.
    """
    chain, surfaces = result.chain, result.posterior.surfaces
    tables = {}
    for data in result.tables:
        tables[data.kind] = {
            "file": data.file,
            "source": data.source,
            "rows": len(data),
            "discrepancy": data.discrepancy,
            **agreement.get(data.kind, {}),
        }
    sampler = {
        "sampler": f"emcee {version('emcee')}",
        "r_hat": chain.r_hat,
        "independent_draws": chain.effective,
        "steps": chain.steps,
    }
    return {
        "gate": {"passed": not result.chain.reasons, "reasons": result.chain.reasons},
        "remarks": _remarks(result, tables) if chain.converged else [],
        "chain": sampler,
        "cycles": len(result.model.cycles.x),
        "response_error_share": max(result.error_share.values(), default=0.0),
        "tables": tables,
        "points_left_out": surfaces.left_out if surfaces else 0,
        "inputs": _inputs(result) if chain.converged else {},
    }


def _remarks(result: Calibration, tables: dict[str, dict[str, Any]]) -> list[str]:
    """Contradictions, outliers, and responses that are not exact, in words."""
    surfaces, shares = result.posterior.surfaces, result.error_share
    remarks = [
        f"{kind} ({row['file']}) {row['verdict']}"
        for kind, row in tables.items()
        if "contradicts" in row.get("verdict", "")
    ]
    if surfaces is not None:
        remarks += surfaces.outliers(result.x[:: max(1, len(result.x) // 50)])
    if shares and max(shares.values()) > RESPONSE_ERROR:
        worst = max(shares, key=shares.__getitem__)
        remarks.append(
            f"the responses' error is {shares[worst]:.2g} of the posterior's width ({worst}), above"
            f" {RESPONSE_ERROR:g}; it is part of that width: raise measurements.runs to narrow it"
        )
    return remarks


def _inputs(result: Calibration) -> dict[str, Any]:
    """Marginal distributions of the posterior with their rank correlations."""
    from scipy.stats import rankdata  # slow to import

    names, free = result.model.prior.names, result.posterior.free
    ranked = [rankdata(result.x[:, k]) for k in free]
    ranks = np.corrcoef(ranked).reshape(len(free), -1)
    inputs: dict[str, Any] = {}
    for k, name in enumerate(names):
        place = np.flatnonzero(free == k)
        partners = {}
        for j, other in enumerate(free):
            if place.size and other < k:
                partners[names[other]] = float(ranks[place[0], j])
        values = result.x[:, k]
        inputs[name] = {
            "distribution": "samples",
            "a": float(values.mean()),
            "b": float(values.std()),
            "values": np.quantile(values, np.linspace(0, 1, 401)).tolist(),
            "correlation": partners,
        }
    return inputs
