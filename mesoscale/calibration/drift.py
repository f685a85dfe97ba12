"""Rates of charging narrowed by a drift that was measured: shift against hold time at voltages.

The switch is the central one of the scene. Charge where it touches follows injection times time,
so one table a voltage serves all injections; emission through gaps is known at some barriers and
straight between them. What one table of drift says of the rates is then as fast as a look-up.
"""

from collections.abc import Mapping
from dataclasses import dataclass, fields
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.constants import Boltzmann, elementary_charge

from mesoscale.answer.switches import Solved, surfaces_of
from mesoscale.calibration.measurements import Measurements
from mesoscale.calibration.posterior import Posterior, Progress
from mesoscale.calibration.sampling import Chain, Sampling
from mesoscale.calibration.values import ValueData
from mesoscale.charging.cycles import driven_V
from mesoscale.charging.gaps import GAPS_NM, HeldGaps, held_gaps
from mesoscale.charging.lifetime import times_s
from mesoscale.charging.rates import GUESSES, ZERO_C_K, Rates, contactless_V, shifts_V
from mesoscale.inputs.distributions import Distribution, InputTable, UncertainInput
from mesoscale.settings import ContactSettings, LifetimeSettings
from mesoscale.settings.lifetime import RANGES
from mesoscale.switch.charge import PER_CM2, shift_V
from mesoscale.theory.charging import charge_shift

Array = NDArray[np.float64]

UNITS = dict(zip(RANGES, ("A/m^2", "eV", "1/cm^2", "1", "eV"), strict=True))
BY_LOGARITHM = ("injection_A_m2", "traps_e_cm2")
HUMIDITY_OF_A_DECADE = 0.6
"""Injection at 80 % humidity is ten times that at 20 % (J. MEMS 22 (2013) 637)."""
BARRIERS = 25
"""Barriers at which emission is known; with twice as many a shift changes by less than 0.1 %."""
INJECTED_C_M2 = np.geomspace(1e-24, 1e12, 721)
"""Injection times time at which a shift is known."""
ALL_TRAPS_E_CM2 = 1e30
LEAST_V = 1e-9
"""Gaps that shift by less in no row are left out."""
MADE_UP = 400
"""Tables that are made up; a probability is known to 0.01 at 0.05."""
TOLD = 201
"""Draws of the posterior of which three stand for it."""
ENDS = {"least": 0.05, "central": 0.5, "most": 0.95}


@dataclass(frozen=True)
class DriftModel:
    """Shifts of the rows of a table by the rates.

    Attributes
    ----------
    names : of the rates, as in the settings.
    touching, shares : shares of the pulled area that touches, and at each gap, shape (gaps,).
    injected_V : where it touches with an injection of 1 A/m^2, by `INJECTED_C_M2`, shape (rows,
        known).
    barriers_eV, emitted_V : at barriers, shape (barriers, gaps, rows).
    full_V : shift by one charge a square centimetre.
    seconds, rests : of hold, and of rest over the time at which recovery begins, shape (rows,).
    inverse_eV : 1 / kT of each row less that of the device, shape (rows,).
    wetter : ratio of injection by humidity, shape (rows,).
    contactless_V : shift of the other sign, shape (rows,).
    """

    names: tuple[str, ...]
    touching: float
    shares: Array
    injected_V: Array
    barriers_eV: Array
    emitted_V: Array
    full_V: float
    seconds: Array
    rests: Array
    inverse_eV: Array
    wetter: Array
    contactless_V: Array

    def __call__(self, x: Array) -> Array:
        """Shifts (V) at rates x of shape (m, n), shape (m, rows)."""
        rates = {name: x[:, [place]] for place, name in enumerate(self.names)}
        warmer = np.exp(-rates["activation_eV"] * self.inverse_eV)
        with np.errstate(divide="ignore"):
            injected = np.log(rates["injection_A_m2"] * warmer * self.wetter * self.seconds)
        known = np.log(INJECTED_C_M2)
        full = self.full_V * rates["traps_e_cm2"]
        touching = np.empty_like(injected)
        for row, shifts in enumerate(self.injected_V):
            touching[:, row] = np.interp(injected[:, row], known, shifts, left=0.0)
        shift = self.touching * np.minimum(touching, full)
        if self.shares.size:
            last = self.barriers_eV.size - 1
            place = np.interp(rates["barrier_eV"][:, 0], self.barriers_eV, np.arange(last + 1.0))
            below = np.minimum(place.astype(int), max(last - 1, 0))
            above = np.minimum(below + 1, last)
            share = (place - below)[:, None, None]
            emitted = self.emitted_V[below] + share * (
                self.emitted_V[above] - self.emitted_V[below]
            )
            shift += np.einsum("g,mgr->mr", self.shares, np.minimum(emitted, full[:, :, None]))
        left = (1.0 + self.rests) ** -rates["recovery_exponent"]
        return left * shift - self.contactless_V


def drift_model(
    data: Measurements, gaps: HeldGaps, before_V: float, humidity: float, settings: LifetimeSettings
) -> DriftModel:
    """The model of a table of drift.

    Parameters
    ----------
    gaps : of the switch that was measured.
    before_V : its shift before it was held.
    humidity : of rows that name none, for which the rates hold.
    """
    columns = data.columns
    device = gaps.device
    seconds = columns["time"]
    usual = np.full(len(data), device.temperature_C)
    temperatures = columns.get("temperature", usual)
    felt_V = columns["hold"] - before_V
    injected = np.zeros((len(data), INJECTED_C_M2.size))
    for volts, celsius in set(zip(felt_V.tolist(), temperatures.tolist(), strict=True)):
        rows = (felt_V == volts) & (temperatures == celsius)
        at_temperature = device.model_copy(update={"temperature_C": celsius})
        injecting = Rates(1.0, settings.barrier_eV[0], ALL_TRAPS_E_CM2)
        injected[rows] = shifts_V(
            volts, GAPS_NM[:1], INJECTED_C_M2, at_temperature, settings, injecting
        )
    low, high = settings.barrier_eV
    barriers = np.unique(np.linspace(low, high, BARRIERS))
    emitted = np.zeros((barriers.size, GAPS_NM.size - 1, len(data)))
    for volts in set(felt_V.tolist()):
        rows = felt_V == volts
        for place, barrier in enumerate(barriers.tolist()):
            rates = Rates(1.0, barrier, ALL_TRAPS_E_CM2)
            emitted[place][:, rows] = shifts_V(
                volts, GAPS_NM[1:], seconds[rows], device, settings, rates
            )
    shares = gaps.shares[1:-1]
    felt = (shares > 0.0) & (emitted.max(axis=(0, 2)) > LEAST_V)
    thermal_eV = Boltzmann / elementary_charge * (temperatures + ZERO_C_K)
    usual_eV = Boltzmann / elementary_charge * (usual + ZERO_C_K)
    wetter = columns.get("humidity", np.full(len(data), humidity)) - humidity
    return DriftModel(
        RANGES,
        gaps.touching,
        shares[felt],
        injected,
        barriers,
        emitted[:, felt],
        float(charge_shift(PER_CM2, device.dielectric_nm, device.permittivity)),
        seconds,
        columns.get("rest", np.zeros(len(data))) / settings.recovery_s,
        1.0 / thermal_eV - 1.0 / usual_eV,
        10.0 ** (wetter / HUMIDITY_OF_A_DECADE),
        contactless_V(seconds, settings),
    )


def prior_of_rates(settings: LifetimeSettings) -> InputTable:
    """The ranges of the settings as distributions; prefactors are uniform in their logarithm."""
    rows = []
    for name in RANGES:
        low, high = getattr(settings, name)
        kind = "log_uniform" if name in BY_LOGARITHM else "uniform"
        if low == high:
            kind = "fixed"
        distribution = Distribution(kind, low, high)
        rows.append(UncertainInput(name, UNITS[name], distribution, "literature", "lifetime"))
    return InputTable(tuple(rows), np.eye(len(rows)))


@dataclass(frozen=True)
class Drift:
    """What a table of drift says of the rates.

    Attributes
    ----------
    x : draws of the posterior, shape (s, n).
    probability : share of tables made up by draws of the posterior that fit their draw no better
        than the measured one does (Gelman, Meng and Stern, Statistica Sinica 6 (1996) 733).
    """

    data: Measurements
    posterior: Posterior
    chain: Chain
    x: Array
    probability: float


def narrow_rates(
    data: Measurements,
    model: DriftModel,
    settings: LifetimeSettings,
    sampling: Sampling | None = None,
    progress: Progress | None = None,
) -> Drift:
    """The posterior of the rates given a table of drift."""
    columns = data.columns
    values = ValueData(columns["shift"], columns["shift_error"], model, data.discrepancy)
    posterior = Posterior(prior_of_rates(settings), (values,))
    chain = posterior.draw(sampling, progress)
    x = posterior.inputs(chain.z)
    return Drift(data, posterior, chain, x, _fit_probability(posterior, x[:MADE_UP]))


def _fit_probability(posterior: Posterior, x: Array) -> float:
    """See `Drift.probability`."""
    rng = np.random.default_rng(np.random.SeedSequence([0xD81F]))
    measured = posterior.log_likelihood(x)
    made_up = [posterior.simulated(draw[None], rng).log_likelihood(draw[None])[0] for draw in x]
    return float(np.mean(np.array(made_up) <= measured))


def rates_of(row: Array) -> Rates:
    """Rates of a row of draws."""
    named = dict(zip(RANGES, row.tolist(), strict=True))
    return Rates(
        named["injection_A_m2"],
        named["barrier_eV"],
        named["traps_e_cm2"],
        named["recovery_exponent"],
    )


def telling_rates(
    x: Array, gaps: HeldGaps, felt_V: float, end_s: float, settings: LifetimeSettings
) -> dict[str, Rates]:
    """Three draws that stand for a posterior: those of the 5, 50 and 95 % of the shift at the end
    of a life, by the names of the guesses.

    Parameters
    ----------
    x : draws, shape (s, n).
    felt_V : hold voltage.
    """
    drawn = [rates_of(row) for row in x[:TOLD]]
    end = np.array([end_s])
    shifts = [
        float(gaps.mean_V(driven_V(felt_V, GAPS_NM, end, gaps.device, settings, rates))[0])
        for rates in drawn
    ]
    order = np.argsort(np.abs(shifts))
    return {guess: drawn[order[round(ENDS[guess] * (len(drawn) - 1))]] for guess in GUESSES}


def rates_by_drift(
    data: Measurements,
    solved: Solved,
    contact: ContactSettings,
    settings: LifetimeSettings,
    progress: Progress | None = None,
) -> tuple[Drift, dict[str, Rates]]:
    """What a table of drift of the central switch says of the rates, and three draws that stand for
    it; none if the chain has not converged.

    Parameters
    ----------
    contact : on the grid of the pads.

    Raises
    ------
    InputError : the switch has no answer.
    """
    gaps = held_gaps(solved, contact, surfaces_of(0))
    before_V = shift_V(solved.point.device)
    humidity = solved.point.humidity(contact)
    drift = narrow_rates(
        data,
        drift_model(data, gaps, before_V, humidity, settings),
        settings,
        progress=progress,
    )
    if drift.chain.reasons:
        return drift, {}
    felt_V = solved.held_V - before_V
    return drift, telling_rates(drift.x, gaps, felt_V, float(times_s(settings)[-1]), settings)


def rate_rows(drift: Drift) -> list[dict[str, float]]:
    """Rows of lifetime/rates.csv: draws of the posterior; none if the chain has not converged."""
    if not drift.chain.converged:
        return []
    columns = [*RANGES, "log_likelihood"]
    values = np.column_stack([drift.x, drift.chain.log_likelihood]).tolist()
    return [dict(zip(columns, row, strict=True)) for row in values]


def drift_json(drift: Drift, guesses: Mapping[str, Rates]) -> dict[str, Any]:
    """Content of lifetime/rates.json.

    Parameters
    ----------
    guesses : see `telling_rates`; empty without a posterior.
    """
    prior = drift.posterior.prior.sample(len(drift.x), 1)
    narrowed = {}
    for place, name in enumerate(RANGES):
        spread: dict[str, str | float] = {"unit": UNITS[name]}
        for state, draws in (("prior", prior), ("posterior", drift.x)):
            for end, share in (("q05", 0.05), ("q50", 0.5), ("q95", 0.95)):
                spread[f"{state}_{end}"] = float(np.quantile(draws[:, place], share))
        narrowed[name] = spread
    by_guess = {
        guess: {field.name: getattr(rates, field.name) for field in fields(rates)}
        for guess, rates in guesses.items()
    }
    return {
        "gate": {"passed": not drift.chain.reasons, "reasons": drift.chain.reasons},
        "file": drift.data.file,
        "source": drift.data.source,
        "rows": len(drift.data),
        "probability": drift.probability,
        "r_hat": drift.chain.r_hat,
        "independent_draws": drift.chain.effective,
        "rates": narrowed if drift.chain.converged else {},
        "guesses": by_guess,
    }
