"""What measurements teach: information gained, contradictions, what the model can give."""

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from mesoscale.calibration.likelihood import Posterior
from mesoscale.calibration.measurements import CURVES, Measurements, by_specimen
from mesoscale.calibration.observables import CURVES as BRANCHES
from mesoscale.calibration.observables import LAWS, NAMES, curve_names, force_levels_nN
from mesoscale.calibration.posterior import Calibration, Cycles, draw
from mesoscale.calibration.sampling import SEED
from mesoscale.calibration.surfaces import SCALAR_COLUMNS, pseudo_inverse
from mesoscale.calibration.switches import SwitchModel
from mesoscale.errors import InputError
from mesoscale.inputs.distributions import InputTable
from mesoscale.inputs.hardness import HardnessLaw

Array = NDArray[np.float64]

REPLICATES = 200
"""Made-up data sets behind a probability; it is known to 0.015 at 0.05."""
CONFLICT = 0.01
"""Probability below which measurements contradict what else is known."""
OUTLIER = 0.01
"""The same for the least likely of all specimens."""
FAR_DEVICES = 3.0
"""Standard deviations between devices that a measured voltage may lie away from the model."""
MARGIN = 0.5
"""A value farther outside than this share of the range that the model gives over the prior is refused."""


def information_bits(z: Array, others: Array | None = None) -> float:
    """Information gained from the state of knowledge of `others` (None: the prior, standard normal) to that of z.

    Kullback-Leibler divergence of normal distributions with the samples' means and covariances; of a posterior with
    several modes it is a lower bound of what was learned.
    """
    size = z.shape[1]
    mean, covariance = z.mean(axis=0), np.cov(z, rowvar=False).reshape(size, size)
    from_mean = np.zeros(size) if others is None else others.mean(axis=0)
    from_covariance = np.eye(size) if others is None else np.cov(others, rowvar=False).reshape(size, size)
    inverse = np.linalg.inv(from_covariance)
    off = from_mean - mean
    log_ratio = np.linalg.slogdet(from_covariance)[1] - np.linalg.slogdet(covariance)[1]
    nats = 0.5 * (np.trace(inverse @ covariance) + off @ inverse @ off - size + log_ratio)
    return float(nats / np.log(2))


def learned(result: Calibration, tables: Sequence[Measurements], max_force_nN: float) -> list[dict[str, Any]]:
    """What each table taught: one row per kind, with bits and contradictions."""
    rng = np.random.default_rng(np.random.SeedSequence([SEED, 0xCC]))
    rows = []
    for data in tables:
        only = result.given([data], max_force_nN)
        rest = [other for other in tables if other is not data]
        by_itself = draw(only).z if rest else result.chain.z
        without = draw(result.given(rest, max_force_nN)).z if rest else rng.standard_normal(result.chain.z.shape)
        probability = predictive_probability(only, only.inputs(without), rng)
        rows.append(
            {
                "kind": data.kind,
                "file": data.file,
                "rows": len(data),
                "alone_bits": information_bits(by_itself),
                "added_bits": information_bits(result.chain.z, without if rest else None),
                "probability": probability,
                "verdict": _verdict(data, probability, bool(rest)),
            }
        )
    return rows


def _verdict(data: Measurements, probability: float, beside_others: bool) -> str:
    others = "what the other measurements and the prior lead to" if beside_others else "the prior"
    if probability >= CONFLICT:
        return "agrees with " + others
    return (
        f"contradicts {others}: {'no' if probability == 0 else 'few'} made-up data sets are as unlikely; an error that "
        "is too small, another contact area, a prior too narrow, or the model itself"
    )


def predictive_probability(data: Posterior, x: Array, rng: np.random.Generator) -> float:
    """Share of made-up data sets that are less likely than the measured ones, given samples x (m, n) of the inputs.

    Box, J. R. Statist. Soc. A 143, 383 (1980): the predictive density at the data is compared with those of its draws.
    """
    predicted = data.predict(x[rng.integers(len(x), size=REPLICATES)])
    inverses = None
    if data.surfaces is not None:
        inverses = np.array([pseudo_inverse(precision)[0] for precision in data.surfaces.precision])

    def log_predictive(some: Posterior) -> float:
        if some.surfaces is not None and inverses is not None:
            # without the part of the likelihood that no input decides: points about their curve
            known = some.surfaces.information
            constant = float(np.einsum("sj,sjk,sk->", known, inverses, known))
            some = replace(some, surfaces=replace(some.surfaces, constant=constant, begins=None))
        return float(np.logaddexp.reduce(some.likelihood_of(predicted)))

    measured = log_predictive(data)
    made_up = [log_predictive(data.simulated(predicted.at(k), rng)) for k in range(REPLICATES)]
    return float(np.mean(np.array(made_up) <= measured))


def outliers(result: Calibration) -> list[str]:
    """Specimens that the posterior cannot explain, in words."""
    surfaces, responses = result.posterior.surfaces, result.posterior.surface_responses
    if surfaces is None or responses is None:
        return []
    chosen = result.x[:: max(1, len(result.x) // 50)]
    shares = np.mean([surfaces.misfits(responses(point[None])) for point in chosen], axis=0)
    limit = OUTLIER / len(shares)
    return [
        f"specimen {name} lies far from the others (probability {share:.1g}); its data are used as they are"
        for name, share in zip(surfaces.specimens, shares, strict=True)
        if share < limit
    ]


def check_range(
    tables: Sequence[Measurements], table: InputTable, cycles: Cycles, max_force_nN: float, switch: SwitchModel
) -> None:
    """Refuse measurements that the model cannot give anywhere in the prior.

    Parameters
    ----------
    cycles : over the prior.

    Raises
    ------
    InputError
    """
    samples = dict(zip(table.names, table.sample(2000, 1).T, strict=True))
    for data in tables:
        if data.kind in CURVES:
            _check_curves(data, cycles, max_force_nN)
        elif data.kind in SCALAR_COLUMNS:
            _check_values(data, data.kind, cycles.y[:, NAMES.index(SCALAR_COLUMNS[data.kind])])
        elif data.kind == "modulus":
            _check_values(data, "e_star", samples["e_star"])
        elif data.kind == "hardness":
            area = np.median(data.columns["area"])
            _check_values(data, "hardness", HardnessLaw.of(samples).pressure(area))
        elif data.kind in ("release", "pull_in"):
            laws = cycles.y[:, -len(LAWS) :]
            whole = np.isfinite(laws).all(axis=1)
            closing, opening = switch.laws(laws[whole], cycles.x[whole, table.names.index("hamaker")])
            volts = switch.release_V(opening) if data.kind == "release" else switch.pull_in_V(closing)
            devices_V = FAR_DEVICES * float(np.hypot(*switch.scatter_V[data.kind]))
            ends = np.array([np.nanmin(volts) - devices_V, np.nanmax(volts) + devices_V])
            _check_values(data, data.kind, np.maximum(ends, 0.0))


def _check_values(data: Measurements, column: str, model: Array) -> None:
    low, high = np.nanmin(model), np.nanmax(model)
    width = MARGIN * (high - low)
    values, errors = data.columns[column], data.columns[f"{column}_error"]
    wrong = np.flatnonzero((values - 3 * errors > high + width) | (values + 3 * errors < low - width))
    if wrong.size:
        raise InputError(
            f"{data.file}: row {wrong[0] + 1}, {column} = {values[wrong[0]]:.4g}: the model gives {low:.3g} .. "
            f"{high:.3g} anywhere in the prior; look at unit and columns, or widen the inputs"
        )


def _check_curves(data: Measurements, cycles: Cycles, max_force_nN: float) -> None:
    """By how much the separation changes between two forces, whatever the zero."""
    levels = np.log(force_levels_nN(max_force_nN))
    names = curve_names(BRANCHES[data.kind])
    curves = cycles.y[:, [NAMES.index(name) for name in names]]
    curves = curves[np.isfinite(curves).all(axis=1)]
    separations = np.column_stack([np.zeros(len(curves)), -np.cumsum(curves[:, 1:], axis=1)])
    for specimen, rows in by_specimen(data).items():
        force, separation = data.columns["force"][rows], data.columns["separation"][rows]
        inside = (force >= np.exp(levels[0])) & (force <= np.exp(levels[-1]))
        if inside.sum() < 2:
            continue  # refused where it is used, with the range of forces
        low, high = np.argmin(np.where(inside, force, np.inf)), np.argmax(np.where(inside, force, -np.inf))
        ends = np.log(force[[low, high]])
        spans = np.array([np.interp(ends[0], levels, row) - np.interp(ends[1], levels, row) for row in separations])
        span = separation[low] - separation[high]
        width = MARGIN * np.ptp(spans)
        if not spans.min() - width <= span <= spans.max() + width:
            raise InputError(
                f"{data.file}: curve {specimen}: separation changes by {span:.4g} nm from {force[low]:.4g} to "
                f"{force[high]:.4g} nN, the model gives {spans.min():.3g} .. {spans.max():.3g} nm anywhere in the "
                "prior; look at units, columns and contact area"
            )
