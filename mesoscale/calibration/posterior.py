"""From measurements to the posterior of the inputs, with responses that are refined where it lies."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from mesoscale.calibration.likelihood import SWITCH_KINDS, Posterior, posterior_of
from mesoscale.calibration.measurements import ON_SURFACES, Measurements
from mesoscale.calibration.observables import LAWS, NAMES, OBSERVABLES
from mesoscale.calibration.observed import observe
from mesoscale.calibration.responses import ResponseFits, Responses, fit_responses, transformed
from mesoscale.calibration.sampling import MAX_STEPS, SEED, Chain, sample
from mesoscale.calibration.surfaces import Expected, SurfaceData
from mesoscale.calibration.switches import SwitchModel
from mesoscale.errors import InputError
from mesoscale.inputs.distributions import InputTable
from mesoscale.settings import ContactSettings, DeviceSettings, MeasurementsSettings
from mesoscale.uncertainty.designs import Run
from mesoscale.uncertainty.runs import compute_all

Array = NDArray[np.float64]
Progress = Callable[[float, str], None]

FIRST_SEED = 1_500_000_000
"""Surfaces of the cycles over the prior differ from those of all other designs."""
FIRST_LOCAL_SEED = 1_700_000_000
WIDENING = 1.3
"""Cycles near the posterior are spread wider than it, so that its tails are known, too."""
RESPONSE_ERROR = 0.5
"""Error of the responses that is small enough, in standard deviations of the posterior prediction."""


@dataclass(frozen=True)
class Cycles:
    """Contact cycles behind the responses.

    Attributes
    ----------
    x : inputs, shape (m, n).
    y : observables and laws in the order of NAMES, shape (m, k); NaN where missing.
    """

    x: Array
    y: Array


@dataclass(frozen=True)
class Calibration:
    """What the measurements say.

    Attributes
    ----------
    posterior, chain, x : samples of the inputs, shape (s, n).
    responses : of the observables, to be picked from.
    laws, expected, switch, checks : the responses where the posterior lies, one row per round and observable.
    cycles : how many are behind the responses.
    added : those of them where the posterior lies, as rows of `observe_runs`.
    """

    posterior: Posterior
    chain: Chain
    x: Array
    responses: ResponseFits
    laws: Responses
    expected: Expected
    switch: SwitchModel
    checks: list[dict[str, Any]] = field(default_factory=list)
    cycles: int = 0
    added: list[dict[str, Any]] = field(default_factory=list)

    def given(self, tables: Sequence[Measurements], max_force_nN: float) -> Posterior:
        """The posterior given other tables, by the same responses."""
        prior = self.posterior.table
        return posterior_of(prior, tables, self.responses, self.laws, self.switch, max_force_nN, self.expected)

    @property
    def reasons(self) -> list[str]:
        """Why there is no posterior."""
        return [] if self.chain.converged else [f"the chain has not converged: {self.chain.reason}"]


def observe_runs(
    runs: Sequence[Run], contact: ContactSettings, progress: Progress | None = None
) -> list[dict[str, float]]:
    """Compute cycles: one row each with seed, inputs and what can be measured; NaN where a cycle failed."""
    rows = []
    for run, cycle in compute_all(runs, contact, progress):
        nothing = dict.fromkeys(NAMES, np.nan)
        seen = nothing if isinstance(cycle, str) else observe(cycle, contact.max_force_nN)
        rows.append({"run": run.index, "seed": run.seed, **run.values, **seen})
    return rows


def cycles_of_rows(rows: Sequence[Mapping[str, Any]], names: Sequence[str]) -> Cycles:
    """Cycles from rows of `observe_runs`, or the same as text."""

    def column(row: Mapping[str, Any], name: str) -> float:
        return float(row[name]) if row[name] != "" else np.nan

    x = np.array([[column(row, name) for name in names] for row in rows])
    return Cycles(x, np.array([[column(row, name) for name in NAMES] for row in rows]))


def expected_of(cycles: Cycles) -> Expected:
    """What the prior expects of the observables."""
    seen = transformed(OBSERVABLES, cycles.y[:, : len(OBSERVABLES)])
    mean = np.nanmean(seen, axis=0)
    centred = np.where(np.isnan(seen), 0.0, seen - mean)
    return Expected(
        tuple(row.name for row in OBSERVABLES), mean, np.cov(centred, rowvar=False) + 1e-6 * np.eye(len(OBSERVABLES))
    )


def responses_of(table: InputTable, cycles: Cycles) -> tuple[ResponseFits, Responses]:
    """Responses of the observables, to be picked from, and of the laws.

    Raises
    ------
    InputError : too few cycles give all of the laws.
    """
    ranges, rms = table.ranges(), table.names.index("rms")
    count = len(OBSERVABLES)
    return (
        ResponseFits(OBSERVABLES, cycles.x, cycles.y[:, :count], ranges, rms),
        fit_responses(LAWS, cycles.x, cycles.y[:, count:], ranges, rms, "the laws"),
    )


def calibrate(
    table: InputTable,
    tables: Sequence[Measurements],
    cycles: Cycles,
    contact: ContactSettings,
    device: DeviceSettings,
    settings: MeasurementsSettings,
    progress: Progress | None = None,
) -> Calibration:
    """The posterior of the inputs given the measurements.

    Parameters
    ----------
    table : the prior.
    cycles : over the prior; more are added where the posterior lies.

    Raises
    ------
    InputError : measurements that cannot be used.
    """
    if not tables:
        raise InputError("measurements.tables: is empty; name at least one table of measurements")
    switch = SwitchModel.of(device, contact.length_nm**2)
    expected = expected_of(cycles)
    needs_cycles = any(data.kind in (*ON_SURFACES, *SWITCH_KINDS) for data in tables)
    checks: list[dict[str, Any]] = []
    rng = np.random.default_rng(np.random.SeedSequence([SEED, 0xCB]))
    turn, local = 0, []
    while True:
        responses, laws = responses_of(table, cycles)
        posterior = posterior_of(table, tables, responses, laws, switch, contact.max_force_nN, expected)
        chain = draw(posterior, progress=progress)
        rows = response_errors(posterior, chain, turn)
        checks += rows
        small = all(row["error_share"] <= RESPONSE_ERROR for row in rows)
        if not needs_cycles or not chain.converged or turn == settings.rounds or (turn > 0 and small):
            break
        picks = rng.integers(len(chain.z), size=settings.local_runs)
        centre = chain.z.mean(axis=0)
        x = posterior.inputs(centre + WIDENING * (chain.z[picks] - centre))
        first = turn * settings.local_runs
        runs = [
            Run(first + k, -1, FIRST_LOCAL_SEED + first + k, dict(zip(table.names, row, strict=True)))
            for k, row in enumerate(x.tolist())
        ]
        observed = observe_runs(runs, contact, progress)
        local += observed
        added = cycles_of_rows(observed, table.names)
        for row, bias in zip(rows, response_bias(posterior, added), strict=True):
            row |= bias
        cycles = Cycles(np.vstack([cycles.x, added.x]), np.vstack([cycles.y, added.y]))
        turn += 1
    return Calibration(
        posterior, chain, posterior.inputs(chain.z), responses, laws, expected, switch, checks, len(cycles.x), local
    )


def draw(posterior: Posterior, max_steps: int = MAX_STEPS, progress: Progress | None = None) -> Chain:
    """Samples of a posterior."""
    return sample(
        lambda z: posterior.log_likelihood(posterior.inputs(z)),
        len(posterior.free),
        max_steps=max_steps,
        progress=progress,
    )


def _seen(posterior: Posterior) -> tuple[Responses, tuple[str, ...]] | None:
    """The responses that the data of a posterior use."""
    if isinstance(posterior.surfaces, SurfaceData) and posterior.surface_responses is not None:
        return posterior.surface_responses, posterior.surfaces.names
    if posterior.switches and posterior.law_responses is not None:
        return posterior.law_responses, tuple(row.name for row in LAWS)
    return None


def response_errors(posterior: Posterior, chain: Chain, turn: int) -> list[dict[str, Any]]:
    """Error of the responses beside the width of the posterior, one row per observable that the data use."""
    seen = _seen(posterior)
    if seen is None:
        return []
    responses, names = seen
    prediction = responses(posterior.inputs(chain.z[:: max(1, len(chain.z) // 500)]))
    known = np.einsum("mkk->mk", prediction.scatter) * prediction.error[:, None]
    error, width = np.sqrt(known.mean(axis=0)), prediction.mean.std(axis=0)
    return [
        {
            "round": turn,
            "observable": name,
            "runs": responses.runs,
            "terms": len(responses.degrees),
            "error": error[k],
            "posterior_sd": width[k],
            "error_share": error[k] / width[k],
            "bias": "",
            "bias_error": "",
        }
        for k, name in enumerate(names)
    ]


def response_remarks(result: Calibration) -> list[str]:
    """What the last round left of the responses' error, in words; nothing where it is small enough."""
    last = [row for row in result.checks if row["round"] == result.checks[-1]["round"]]
    worst = max(last, key=lambda row: row["error_share"], default=None)
    if worst is None or worst["error_share"] <= RESPONSE_ERROR:
        return []
    return [
        f"the responses' error is {worst['error_share']:.2g} of the posterior's width ({worst['observable']}), above "
        f"{RESPONSE_ERROR:g}; it is part of that width: raise "
        "measurements.local_runs or measurements.rounds to narrow it"
    ]


def response_bias(posterior: Posterior, added: Cycles) -> list[dict[str, float]]:
    """Mean difference of new cycles from responses that have not seen them, with its standard error."""
    seen = _seen(posterior)
    if seen is None:
        return []
    responses, names = seen
    places = [NAMES.index(name) for name in names]
    off = transformed(responses.observables, added.y[:, places]) - responses(added.x).mean
    count = np.maximum(np.isfinite(off).sum(axis=0), 1)
    return [
        {"bias": float(bias), "bias_error": float(error)}
        for bias, error in zip(np.nanmean(off, axis=0), np.nanstd(off, axis=0) / np.sqrt(count), strict=True)
    ]
