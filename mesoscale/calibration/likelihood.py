"""Prior and likelihood of the inputs, given all tables of measurements."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.special import gammaln, log_ndtr, ndtr

from mesoscale.calibration.measurements import Measurements
from mesoscale.calibration.observables import LAWS
from mesoscale.calibration.responses import Prediction, ResponseFits, Responses
from mesoscale.calibration.surfaces import Expected, SurfaceData, surface_data
from mesoscale.calibration.switches import SwitchModel, law_values
from mesoscale.inputs.distributions import InputTable
from mesoscale.inputs.hardness import HardnessLaw

Array = NDArray[np.float64]

DRAWS = 12
"""Pads drawn to know the scatter between switches at given inputs; in pairs of opposite sign."""
SMALLEST_SCATTER_V = 1e-3
"""Of switches: keeps a sharp threshold of sticking differentiable."""
SWITCH_KINDS = ("release", "pull_in", "sticking")


@dataclass(frozen=True)
class DirectData:
    """Values that the inputs alone decide: hardness points and elastic moduli.

    Attributes
    ----------
    kind, values, variances, area_nm2 : hardness: contact areas; else empty.
    """

    kind: str
    values: Array
    variances: Array
    area_nm2: Array
    discrepancy: float

    def model(self, table: dict[str, Array]) -> Array:
        """Predictions from inputs by name, shape (m, values)."""
        if self.kind == "modulus":
            return np.repeat(table["e_star"][:, None], len(self.values), axis=1)
        return HardnessLaw.of({name: values[:, None] for name, values in table.items()}).pressure(self.area_nm2)

    def log_likelihood(self, table: dict[str, Array]) -> Array:
        """Shape (m,); the model's own error is one share for all values."""
        model = self.model(table)
        return normal_with_common(self.values - model, self.variances, self.discrepancy * model)

    def simulated(self, table: dict[str, Array], rng: np.random.Generator) -> "DirectData":
        """Data with the same errors, drawn at one point."""
        model = self.model(table)[0] * (1 + self.discrepancy * rng.standard_normal())
        return replace(self, values=model + np.sqrt(self.variances) * rng.standard_normal(model.shape))


def normal_with_common(residuals: Array, variances: Array, common: Array) -> Array:
    """Logarithm of a normal density with covariance diag(variances) + common common^T, over the last axis."""
    variances = np.broadcast_to(variances, residuals.shape)
    common = np.broadcast_to(common, residuals.shape)
    separate = (residuals**2 / variances).sum(axis=-1)
    cross = (residuals * common / variances).sum(axis=-1)
    gain = 1 + (common**2 / variances).sum(axis=-1)
    return -0.5 * (separate - cross**2 / gain + np.log(gain) + np.log(2 * np.pi * variances).sum(axis=-1))


@dataclass(frozen=True)
class Predicted:
    """What the model predicts at m inputs: computed once, it serves many data sets.

    Attributes
    ----------
    inputs : by name, shape (m,) each.
    surfaces : observables of the data on surfaces; None without such data.
    voltages : mean and deviation between switches (V) by name, shape (m,) each; empty without data on switches.
    """

    inputs: dict[str, Array]
    surfaces: Prediction | None
    voltages: dict[str, tuple[Array, Array]]

    def at(self, place: int) -> "Predicted":
        """The prediction at one of the inputs."""
        here = slice(place, place + 1)
        return Predicted(
            {name: values[here] for name, values in self.inputs.items()},
            None if self.surfaces is None else self.surfaces.at(place),
            {name: (mean[here], sd[here]) for name, (mean, sd) in self.voltages.items()},
        )


@dataclass(frozen=True)
class Posterior:
    """Density of the inputs in the space where their prior is standard normal.

    Attributes
    ----------
    table : the prior.
    surfaces, surface_responses : of the observables that `surfaces` sees.
    direct, switches, switch, law_responses : of the laws; for the switch.
    """

    table: InputTable
    surfaces: SurfaceData | None
    surface_responses: Responses | None
    direct: tuple[DirectData, ...]
    switches: tuple[Measurements, ...]
    switch: SwitchModel | None
    law_responses: Responses | None

    @cached_property
    def free(self) -> NDArray[np.int_]:
        """Inputs that have a width; the others are not sampled."""
        return np.flatnonzero([np.ptp(row.distribution.span()) > 0 for row in self.table.rows])

    def inputs(self, z: Array) -> Array:
        """Inputs (m, n) from points z (m, free) where their prior is standard normal."""
        every = np.zeros((len(z), len(self.table.rows)))
        every[:, self.free] = z
        return self.table.transform(np.clip(ndtr(every), 1e-15, 1 - 1e-15))  # an unbounded prior stays finite

    def log_likelihood(self, x: Array) -> Array:
        """Logarithm of the likelihood at inputs x (m, n), shape (m,)."""
        return self.likelihood_of(self.predict(x))

    def predict(self, x: Array) -> Predicted:
        """What the model predicts of the data at inputs x (m, n)."""
        surfaces = self.surface_responses
        inputs = dict(zip(self.table.names, x.T, strict=True))
        return Predicted(
            inputs,
            surfaces(x) if surfaces is not None else None,
            self.switch_voltages(x, inputs["hamaker"]) if self.switches else {},
        )

    def likelihood_of(self, predicted: Predicted) -> Array:
        """Logarithm of the likelihood of what is predicted, shape (m,)."""
        result = np.zeros(len(next(iter(predicted.inputs.values()))))
        if self.surfaces is not None and predicted.surfaces is not None:
            result += self.surfaces.log_likelihood(predicted.surfaces)
        for data in self.direct:
            result += data.log_likelihood(predicted.inputs)
        if self.switches:
            result += self._switches(predicted.voltages)
        return result

    def simulated(self, predicted: Predicted, rng: np.random.Generator) -> "Posterior":
        """The posterior of data made up at one predicted point, with the same errors as the measured ones."""
        surfaces = self.surfaces
        if surfaces is not None and predicted.surfaces is not None:
            surfaces = surfaces.simulated(predicted.surfaces, rng)
        direct = tuple(data.simulated(predicted.inputs, rng) for data in self.direct)
        switches = []
        for data in self.switches:
            mean, sd = (values[0] for values in predicted.voltages[_voltage(data)])
            shared = self._shared_V(data, mean)
            if data.kind == "sticking":
                margin = mean / np.hypot(sd, shared)
                total = data.columns["switches"]
                drawn = {"stuck": rng.binomial(total.astype(int), ndtr(-margin)).astype(float), "switches": total}
            else:
                error = data.columns[f"{data.kind}_error"]
                spread = np.hypot(error, sd) * rng.standard_normal(error.shape)
                values = mean + shared * rng.standard_normal() + spread
                drawn = {data.kind: values, f"{data.kind}_error": error}
            switches.append(replace(data, columns=drawn))
        return replace(self, surfaces=surfaces, direct=direct, switches=tuple(switches))

    def _switches(self, voltages: dict[str, tuple[Array, Array]]) -> Array:
        result = np.zeros(1)
        for data in self.switches:
            mean, sd = voltages[_voltage(data)]
            shared = self._shared_V(data, mean)
            if data.kind == "sticking":
                spread = np.hypot(sd, shared)
                stuck, total = data.columns["stuck"].sum(), data.columns["switches"].sum()
                margin = mean / spread
                ways = gammaln(total + 1) - gammaln(stuck + 1) - gammaln(total - stuck + 1)
                result = result + ways + stuck * log_ndtr(-margin) + (total - stuck) * log_ndtr(margin)
                continue
            measured = data.columns[data.kind]
            variances = data.columns[f"{data.kind}_error"] ** 2 + sd[:, None] ** 2
            result = result + normal_with_common(measured - mean[:, None], variances, shared[:, None])
        return result

    def _shared_V(self, data: Measurements, mean: Any) -> Any:
        """Standard deviation that all values of a table share: the model's own error, and what all devices share."""
        devices_V = self.switch.scatter_V[_voltage(data)][0] if self.switch else 0.0
        return np.hypot(data.discrepancy * np.abs(mean), devices_V)

    def switch_voltages(self, x: Array, hamaker: Array) -> dict[str, tuple[Array, Array]]:
        """Mean and deviation between switches of pull-in and release (with sign, V), shape (m,) each.

        Raises
        ------
        ValueError : the posterior was made without a switch.
        """
        if self.switch is None or self.law_responses is None:
            raise ValueError("no switch in this posterior")
        prediction = self.law_responses(x)
        values = law_values(prediction)
        # a switch averages many cells: the scatter of its law falls with their number
        root = np.linalg.cholesky(prediction.scatter + 1e-12 * np.eye(len(LAWS))) / np.sqrt(self.switch.cells)
        half = np.random.default_rng(0x5EED).standard_normal((DRAWS // 2, len(LAWS)))
        shifts = np.einsum("mjk,dk->dmj", root, np.concatenate([half, -half]))
        is_log = np.array([row.scale != "length" for row in LAWS])
        drawn = np.where(is_log, values * np.exp(np.where(is_log, shifts, 0.0)), values + shifts)
        laws = self.switch.laws(drawn.reshape(-1, len(LAWS)), np.tile(hamaker, DRAWS))
        voltages = {}
        for name, volts in (("pull_in", self.switch.pull_in_V(laws[0])), ("release", self.switch.release_V(laws[1]))):
            draws = volts.reshape(DRAWS, -1)
            scatter = np.hypot(draws.std(axis=0), self.switch.scatter_V[name][1])
            voltages[name] = draws.mean(axis=0), np.maximum(scatter, SMALLEST_SCATTER_V)
        return voltages


def _voltage(data: Measurements) -> str:
    """Which voltage a table on switches is about."""
    return "pull_in" if data.kind == "pull_in" else "release"


def direct_data(tables: Iterable[Measurements]) -> tuple[DirectData, ...]:
    """Hardness points and moduli among the tables."""
    data = []
    for table in tables:
        if table.kind == "hardness":
            area = table.columns["area"]
            values, errors = table.columns["hardness"], table.columns["hardness_error"]
        elif table.kind == "modulus":
            area = np.empty(0)
            values, errors = table.columns["e_star"], table.columns["e_star_error"]
        else:
            continue
        data.append(DirectData(table.kind, values, errors**2, area, table.discrepancy))
    return tuple(data)


def posterior_of(
    table: InputTable,
    tables: Sequence[Measurements],
    responses: ResponseFits | None,
    law_responses: Responses | None,
    switch: SwitchModel | None,
    max_force_nN: float,
    expected: Expected,
) -> Posterior:
    """The posterior given some tables of measurements.

    Parameters
    ----------
    responses : from which those of the observables that the tables see are picked.

    Raises
    ------
    InputError : see `surface_data` and `ResponseFits.pick`.
    """
    surfaces = surface_data(tables, max_force_nN, expected)
    picked = None
    if surfaces is not None:
        if responses is None:
            raise ValueError("data on surfaces need responses")
        picked = responses.pick(surfaces.names)
    switches = tuple(data for data in tables if data.kind in SWITCH_KINDS)
    return Posterior(table, surfaces, picked, direct_data(tables), switches, switch, law_responses)
