"""From measurements to the posterior of the inputs, with responses refined where it lies."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray
from scipy.special import ndtr

from mesoscale.calibration.measurements import Measurements
from mesoscale.calibration.observables import Cycles, cycles_of_rows, observe_runs
from mesoscale.calibration.sampling import Chain, Sampling, sample
from mesoscale.calibration.surfaces import KINDS, SurfaceData, expected_over_prior, surface_data
from mesoscale.calibration.values import ValueData
from mesoscale.calibration.voltages import StickingData, Voltage
from mesoscale.errors import InputError
from mesoscale.inputs.distributions import InputTable
from mesoscale.inputs.hardness import HardnessLaw
from mesoscale.settings import ContactSettings
from mesoscale.uncertainty.designs import Run

Array = NDArray[np.float64]
Progress = Callable[[float, str], None]

FIRST_SEED, FIRST_LOCAL_SEED = 1_500_000_000, 1_700_000_000
"""Surfaces of the cycles over the prior, and where the posterior lies, differ from those of all
other designs.
"""
RESPONSE_ERROR = 0.5
"""Error of the responses that is small enough, in standard deviations of the posterior prediction.
"""


@dataclass(frozen=True)
class Posterior:
    """Density of the inputs in the space where their prior is standard normal.

    Attributes
    ----------
    prior, data : data that are independent of each other at given inputs.
    """

    prior: InputTable
    data: tuple[SurfaceData | ValueData | StickingData, ...]

    @cached_property
    def free(self) -> NDArray[np.int_]:
        """Inputs that have a width; the others are not sampled."""
        widths = [np.ptp(row.distribution.span()) for row in self.prior.rows]
        return np.flatnonzero([width > 0 for width in widths])

    @property
    def surfaces(self) -> SurfaceData | None:
        """The part that was measured on surfaces."""
        return next((data for data in self.data if isinstance(data, SurfaceData)), None)

    def inputs(self, z: Array) -> Array:
        """Inputs (m, n) from points z (m, free) where their prior is standard normal."""
        variables = np.zeros((len(z), len(self.prior.rows)))
        variables[:, self.free] = z
        # an unbounded prior stays finite
        probability = np.clip(ndtr(variables), 1e-15, 1 - 1e-15)
        return self.prior.transform(probability)

    def log_likelihood(self, x: Array) -> Array:
        """Logarithm of the likelihood at inputs x (m, n), shape (m,)."""
        return sum((data.log_likelihood(x) for data in self.data), np.zeros(len(x)))

    def simulated(self, x: Array, rng: np.random.Generator) -> "Posterior":
        """The posterior of data made up at inputs x (1, n), with the measured errors."""
        return Posterior(self.prior, tuple(data.simulated(x, rng) for data in self.data))

    def draw(self, settings: Sampling | None = None, progress: Progress | None = None) -> Chain:
        """Samples."""
        return sample(
            lambda z: self.log_likelihood(self.inputs(z)), len(self.free), settings, progress
        )


@dataclass(frozen=True)
class Model:
    """What measurements are compared with.

    Attributes
    ----------
    cycles : contact cycles behind the responses.
    voltages : pull-in and release of the switch; needed for tables on switches alone.
    """

    prior: InputTable
    cycles: Cycles
    voltages: Mapping[str, Voltage]
    max_force_nN: float

    def posterior(self, tables: Sequence[Measurements]) -> Posterior:
        """The posterior given some tables of measurements.

        Raises
        ------
        InputError : see `surface_data`.
        """
        surfaces = surface_data(tables, self.cycles, self.prior, self.max_force_nN)
        values = tuple(self._part(data) for data in tables if data.kind not in KINDS)
        if surfaces is None:
            return Posterior(self.prior, values)
        return Posterior(self.prior, (surfaces, *values))

    def _part(self, data: Measurements) -> ValueData | StickingData:
        """The data of a table that was measured on no surface."""
        column = "e_star" if data.kind == "modulus" else data.kind
        if column == "sticking":
            release = self.voltages["release"]
            return StickingData(
                data.columns["stuck"], data.columns["switches"], data.discrepancy, release
            )
        values = data.columns[column]
        errors = data.columns[f"{column}_error"]
        if column in ("release", "pull_in"):
            volts = self.voltages[column]

            def voltage(x: Array) -> Array:
                return volts(x)[:, None]

            return ValueData(
                values, errors, voltage, data.discrepancy, volts.shared_V, volts.each_V
            )

        def inputs(x: Array) -> dict[str, Array]:
            return {name: x[:, [k]] for k, name in enumerate(self.prior.names)}

        def modulus(x: Array) -> Array:
            return inputs(x)["e_star"]

        def hardness(x: Array) -> Array:
            return HardnessLaw.of(inputs(x)).pressure(data.columns["area"])

        model = modulus if column == "e_star" else hardness
        return ValueData(values, errors, model, data.discrepancy)

    def check_range(self, data: Measurements) -> None:
        """Refuse a table that the model cannot give anywhere in the prior.

        Raises
        ------
        InputError
        """
        (model_data,) = self.posterior([data]).data
        if isinstance(model_data, StickingData):
            return
        if isinstance(model_data, SurfaceData):
            shares = model_data.misfits(
                *expected_over_prior(self.cycles, model_data.responses.names)
            )
            if shares.min() < 1e-9:  # six standard deviations of one number
                name = model_data.specimens[int(shares.argmin())]
                raise InputError(
                    f"{data.file}: {data.kind} of {name}: the model gives nothing like it anywhere"
                    " in the prior; look at units, columns and contact area, or widen the inputs"
                )
            return
        model = model_data.model(self.prior.sample(2000, 1))
        low = model.min(axis=0)
        high = model.max(axis=0)
        error = np.hypot(model_data.errors, np.hypot(model_data.shared, model_data.single))
        reach = 0.5 * (high - low) + 3 * error
        values = model_data.values
        wrong = np.flatnonzero((values > high + reach) | (values < low - reach))
        if wrong.size:
            raise InputError(
                f"{data.file}: row {wrong[0] + 1}: {data.kind} = {values[wrong[0]]:.4g}: the"
                f" model gives {low.min():.3g} .. {high.max():.3g} anywhere in the prior; look at"
                " unit and columns, or widen the inputs"
            )


@dataclass(frozen=True)
class Calibration:
    """What the measurements say.

    Attributes
    ----------
    tables, model : with the cycles of all rounds.
    x : samples of the inputs, shape (s, n).
    error_share : largest error of the responses in standard deviations of the posterior prediction,
        by observable.
    """

    tables: tuple[Measurements, ...]
    model: Model
    posterior: Posterior
    chain: Chain
    x: Array
    error_share: Mapping[str, float]


def calibrate(
    tables: Sequence[Measurements],
    model: Model,
    contact: ContactSettings,
    progress: Progress | None = None,
) -> Calibration:
    """The posterior of the inputs given the measurements.

    Parameters
    ----------
    model : with cycles over the prior; more are added where the posterior lies.

    Raises
    ------
    InputError : measurements that cannot be used.
    """
    if not tables:
        raise InputError("measurements.tables: is empty; name at least one table of measurements")
    for data in tables:
        model.check_range(data)
    rng = np.random.default_rng(np.random.SeedSequence([Sampling.seed, 0xCB]))
    turn = 0
    rounds = 3
    more = round(0.375 * len(model.cycles.x))
    while True:
        posterior = model.posterior(tables)
        chain = posterior.draw(progress=progress)
        shares = _error_shares(posterior, chain)
        exact = max(shares.values(), default=0.0) <= RESPONSE_ERROR and (turn > 0 or not shares)
        if exact or not chain.converged or turn == rounds:
            return Calibration(
                tuple(tables), model, posterior, chain, posterior.inputs(chain.z), shares
            )
        picks = rng.integers(len(chain.z), size=more)
        centre = chain.z.mean(axis=0)
        # wider, so that its tails are known, too
        x = posterior.inputs(centre + 1.3 * (chain.z[picks] - centre))
        runs = []
        for index, row in enumerate(x.tolist(), turn * more):
            values = dict(zip(model.prior.names, row, strict=True))
            runs.append(Run(index, -1, FIRST_LOCAL_SEED + index, values))
        added = cycles_of_rows(observe_runs(runs, contact, progress), model.prior.names)
        model = Model(model.prior, model.cycles + added, model.voltages, model.max_force_nN)
        turn += 1


def _error_shares(posterior: Posterior, chain: Chain) -> dict[str, float]:
    """Error of the responses beside the width of the posterior, by observable that the data use."""
    if posterior.surfaces is None:
        return {}
    responses = posterior.surfaces.responses
    stride = max(1, len(chain.z) // 500)
    prediction = responses(posterior.inputs(chain.z[::stride]))
    known = np.einsum("mkk->mk", prediction.scatter) * prediction.error[:, None]
    shares = np.sqrt(known.mean(axis=0)) / prediction.mean.std(axis=0)
    return dict(zip(responses.names, shares.tolist(), strict=True))
