"""What measurements of the open device say of its properties, before any pad is pressed.

Properties are standard normal numbers z behind the departures of `device.spread`. Pull-in,
capacitance and resonance are a polynomial of second degree of z, fitted to beams that are solved
over the prior, and again near the posterior. The posterior is weighed by importance: draws of the
prior first, then of normal distributions around it mixed with the prior (Hesterberg, Technometrics
37 (1995) 185). Where hardly a draw counts, the likelihood is raised to a power that grows to 1.
What the polynomial misses counts as an error of the measurement.
"""

from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray
from scipy.special import ndtr, ndtri

from mesoscale.answer.departures import (
    departed_properties,
    stated_departures,
    with_properties,
)
from mesoscale.errors import InputError
from mesoscale.inputs.distributions import Distribution, InputTable, UncertainInput
from mesoscale.settings import DeviceSettings
from mesoscale.settings.device import MEASURABLE, unit_of
from mesoscale.switch.beam import beam_of
from mesoscale.switch.beam_motion import MovingBeam
from mesoscale.switch.charge import shift_V
from mesoscale.switch.resonance import lowest_kHz

Array = NDArray[np.float64]

ELEMENTS = 32
"""Of a beam that is compared with a measurement: pull-in is within 0.02 % of that of 128."""
STEPS = 24
"""Of its way down; with 81 pull-in is the same to 0.01 %."""
PRIOR_BEAMS = 160
"""Solved over the prior: a polynomial of nine numbers has 55 terms."""
NEAR_BEAMS = 24
"""Solved near the posterior, in each of `ROUNDS`."""
ROUNDS = 2
DRAWS = 40_000
"""Of the prior, and of the distribution around the posterior."""
KEPT = 4000
"""Draws of the posterior."""
FROM_PRIOR = 0.2
"""Share of the second draws that are of the prior."""
WIDER = 1.5
"""Variance of the others over that of the posterior."""
FEWEST = 1000
"""Independent draws that a posterior needs."""
MOST_STEPS = 12
"""Distributions between prior and posterior, each drawn around the one before."""
SOLVED_SHARE = 0.8
"""Of the beams over the prior must pull in."""
DOUBTED, REFUSED = 3.0, 4.0
"""Deviations between a measurement and the stated device from which it is doubted and refused."""
RIDGE = 1e-4
"""Share of independence that keeps a correlation positive definite."""


@dataclass(frozen=True)
class Narrowed:
    """What is known of a device after measurements.

    Attributes
    ----------
    table : departures from the stated properties.
    before, after : deviations of the departures, shape (k,), and their quotients say what remains.
    stated : mean and deviation of each measured number by the stated device alone.
    doubt : what contradicts what; empty where nothing does.
    missed : what the polynomial misses of each measured number near the posterior, as a share.
    z : draws of the posterior, shape (s, k).
    """

    table: InputTable
    before: Array
    after: Array
    stated: dict[str, tuple[float, float]]
    doubt: str
    missed: dict[str, float]
    z: Array


@dataclass(frozen=True)
class Solved:
    """Beams at numbers z (m, k), and the logarithms of what can be measured (m, 3)."""

    z: Array
    logarithms: Array

    def __add__(self, other: "Solved") -> "Solved":
        return Solved(np.vstack([self.z, other.z]), np.vstack([self.logarithms, other.logarithms]))


def observed(settings: DeviceSettings) -> dict[str, float]:
    """Pull-in (V), capacitance without voltage (fF) and lowest resonance (kHz) of a device.

    Raises
    ------
    InputError : no voltage pulls it in; it touches before it snaps.
    """
    beam = beam_of(settings, ELEMENTS)
    moving = MovingBeam(beam, settings)
    capacitance_fF = moving.capacitance_fF()
    pull_in = moving.come_down(STEPS)
    if pull_in.touches:
        raise InputError(
            "device.measured: this beam touches before it snaps, and the voltage of touch is also"
            " its pad's; measured are devices that snap"
        )
    return dict(
        zip(
            MEASURABLE,
            (pull_in.voltage + shift_V(settings), capacitance_fF, lowest_kHz(beam, settings)),
            strict=True,
        )
    )


def narrowed(settings: DeviceSettings) -> Narrowed:
    """Departures of the device as its measurements leave them.

    Raises
    ------
    InputError : the measurements contradict the stated device, or each other.
    """
    device, measured = _asked(settings)
    return _REMEMBERED.get((device, measured)) or _narrowed(device, measured)


def remember(settings: DeviceSettings, posterior: Narrowed) -> None:
    """Take a posterior that another process has found for the device."""
    _REMEMBERED[_asked(settings)] = posterior


def of_draws(
    settings: DeviceSettings,
    z: Array,
    stated: dict[str, tuple[float, float]],
    doubt: str,
    missed: dict[str, float],
) -> Narrowed:
    """What is known of a device by draws of its posterior; see `Narrowed`."""
    table = stated_departures(settings)
    rng = np.random.default_rng(np.random.SeedSequence([0, 0xB4]))
    before = _departures(table, rng.standard_normal((KEPT, z.shape[1]))).std(axis=0)
    after = _departures(table, z)
    names = list(stated)
    return Narrowed(
        _as_table(table, after, names), before, after.std(axis=0), stated, doubt, missed, z
    )


Measured = tuple[tuple[str, tuple[float, float]], ...]
"""Values and errors by name, in the order of `MEASURABLE`."""
_REMEMBERED: dict[tuple[DeviceSettings, Measured], Narrowed] = {}


def _asked(settings: DeviceSettings) -> tuple[DeviceSettings, Measured]:
    """A device without what does not change its posterior, and what was measured of it."""
    assert settings.measured is not None
    closed = {"measured": None, "hold_voltage_V": None, "release_at": "jump"}
    return settings.model_copy(update=closed), tuple(settings.measured.stated.items())


@lru_cache(maxsize=8)
def _narrowed(settings: DeviceSettings, measured: Measured) -> Narrowed:
    beams = over_prior(settings)
    names = [name for name, _ in measured]
    values = np.array([value for _, (value, _) in measured])
    errors = np.array([error for _, (_, error) in measured])
    columns = [MEASURABLE.index(name) for name in names]
    stated = np.exp(beams.logarithms[:, columns])
    doubt = _contradicted(names, values, errors, stated)
    rng = np.random.default_rng(np.random.SeedSequence([0, 0x3EA5]))
    missed = _missed(beams, columns)
    z = np.empty((0, beams.z.shape[1]))
    for last in (False,) * ROUNDS + (True,):
        z = _posterior(beams, columns, values, np.hypot(errors, missed * values), rng)
        if last:
            break
        near = solved_at(settings, z[:NEAR_BEAMS])
        missed = _missed_near(beams, near, columns)
        beams = beams + near
    return of_draws(
        settings,
        z,
        {
            name: (float(column.mean()), float(column.std()))
            for name, column in zip(names, stated.T, strict=True)
        },
        doubt,
        dict(zip(names, missed.tolist(), strict=True)),
    )


@lru_cache(maxsize=8)
def over_prior(settings: DeviceSettings) -> Solved:
    """Beams over the stated departures.

    Raises
    ------
    InputError : too many of them do not pull in.
    """
    from scipy.stats import qmc  # slow to import

    count = len(settings.varied)
    units = qmc.LatinHypercube(count, rng=0).random(PRIOR_BEAMS) if count else np.empty((1, 0))
    wanted = ndtri(units)
    solved = solved_at(settings, wanted)
    if len(solved.z) < SOLVED_SHARE * len(wanted):
        observed(settings)  # has the reason where the stated device is one of them
        raise InputError(
            f"device.measured: {len(wanted) - len(solved.z)} of {len(wanted)} devices of"
            " device.spread do not snap; narrow it"
        )
    return solved


def solved_at(settings: DeviceSettings, z: Array) -> Solved:
    """Beams at numbers z (m, k); those that do not snap are left out."""
    moved = _departures(stated_departures(settings), z)
    kept, logarithms = [], []
    for numbers, values in zip(z, departed_properties(settings, moved), strict=True):
        try:
            row = observed(with_properties(settings, values))
        except InputError:
            continue
        kept.append(numbers)
        logarithms.append(np.log(list(row.values())))
    return Solved(
        np.reshape(kept, (len(kept), z.shape[1])),
        np.reshape(logarithms, (len(kept), len(MEASURABLE))),
    )


def _departures(table: InputTable, z: Array) -> Array:
    """Departures of numbers z; both of shape (m, k)."""
    return table.transform(ndtr(z)) if table.rows else z


def _terms(z: Array) -> Array:
    """All products of up to two of the numbers, shape (m, terms)."""
    first, second = np.triu_indices(z.shape[1])
    return np.hstack([np.ones((len(z), 1)), z, z[:, first] * z[:, second]])


def _fit(beams: Solved, columns: list[int]) -> Array:
    """Coefficients of the terms, shape (terms, measured)."""
    fitted, *_ = np.linalg.lstsq(_terms(beams.z), beams.logarithms[:, columns], rcond=None)
    return np.asarray(fitted, float)


def _missed(beams: Solved, columns: list[int]) -> Array:
    """Root mean square error of beams that are left out one at a time, as shares."""
    terms = _terms(beams.z)
    left = beams.logarithms[:, columns] - terms @ _fit(beams, columns)
    free = 1.0 - np.einsum("pi,ip->p", terms, np.linalg.pinv(terms))
    errors: Array = np.sqrt(np.mean((left / np.maximum(free, 1e-3)[:, None]) ** 2, axis=0))
    return errors


def _missed_near(beams: Solved, near: Solved, columns: list[int]) -> Array:
    """Root mean square error at beams near the posterior that no fit has seen, as shares."""
    left = near.logarithms[:, columns] - _terms(near.z) @ _fit(beams, columns)
    errors: Array = np.sqrt(np.square(left).mean(axis=0))
    return errors


def _posterior(
    beams: Solved, columns: list[int], values: Array, errors: Array, rng: np.random.Generator
) -> Array:
    """Draws of the posterior, shape (KEPT, k).

    Raises
    ------
    InputError : hardly a device has what was measured.
    """
    coefficients = _fit(beams, columns)
    count = beams.z.shape[1]

    def log_likelihood(z: Array) -> Array:
        off = (np.exp(_terms(z) @ coefficients) - values) / errors
        return -0.5 * (off**2).sum(axis=1)

    z = rng.standard_normal((DRAWS, count))
    log_prior = log_drawn = -0.5 * (z**2).sum(axis=1)
    for _ in range(MOST_STEPS):
        likelihood = log_likelihood(z)
        share = _bearable(likelihood, log_prior - log_drawn)
        weight = _weights(share * likelihood + log_prior - log_drawn)
        if share == 1.0 or count == 0:
            return z[rng.choice(DRAWS, KEPT, p=weight)]
        mean = weight @ z
        centred = z - mean
        spread = (weight[:, None] * centred).T @ centred
        narrow = np.linalg.cholesky(WIDER * spread + RIDGE * np.eye(count))
        around = mean + rng.standard_normal((DRAWS, count)) @ narrow.T
        of_prior = rng.random(DRAWS) < FROM_PRIOR
        z = np.where(of_prior[:, None], rng.standard_normal((DRAWS, count)), around)
        log_prior = -0.5 * (z**2).sum(axis=1)
        scaled = np.linalg.solve(narrow, (z - mean).T)
        log_around = -0.5 * (scaled**2).sum(axis=0) - np.log(np.diag(narrow)).sum()
        log_drawn = np.logaddexp(np.log(FROM_PRIOR) + log_prior, np.log1p(-FROM_PRIOR) + log_around)
    raise InputError(
        "device.measured: hardly a device of device.spread has what was measured; widen the spread"
        " or the errors"
    )


def _bearable(likelihood: Array, others: Array) -> float:
    """Largest power of the likelihood, up to 1, with which enough draws count; logarithms (s,)."""
    low, high = 0.0, 1.0
    if _independent(_weights(likelihood + others)) >= FEWEST:
        return 1.0
    for _ in range(20):
        middle = 0.5 * (low + high)
        if _independent(_weights(middle * likelihood + others)) >= FEWEST:
            low = middle
        else:
            high = middle
    return low


def _independent(weight: Array) -> float:
    """Number of equal draws that tell as much as weighted ones."""
    return 1.0 / float((weight**2).sum())


def _weights(logarithm: Array) -> Array:
    weight = np.exp(logarithm - logarithm.max())
    return weight / weight.sum()


def _contradicted(names: list[str], values: Array, errors: Array, stated: Array) -> str:
    """What contradicts what, in words; empty where nothing does.

    Parameters
    ----------
    stated : what devices of the stated spread have, shape (m, measured).

    Raises
    ------
    InputError : a contradiction beyond doubt.
    """
    mean, deviation = stated.mean(axis=0), stated.std(axis=0)
    deviations = np.abs(values - mean) / np.hypot(deviation, errors)
    worst = int(np.argmax(deviations))
    far = float(deviations[worst])
    line = (
        f"device.measured.{names[worst]} = {values[worst]:.4g} +- {errors[worst]:.3g} contradicts"
        f" the stated device, which has {mean[worst]:.4g} +- {deviation[worst]:.3g} by"
        f" device.spread, {far:.1f} deviations away; correct one of them, or widen the spread"
    )
    if len(names) > 1 and far < DOUBTED:
        far = _together(values - mean, errors, stated)
        line = (
            f"device.measured: {' and '.join(names)} contradict each other: no device of"
            f" device.spread has them all, by {far:.1f} deviations; correct one of them"
        )
    if far > REFUSED:
        raise InputError(line)
    return line if far > DOUBTED else ""


def _together(off: Array, errors: Array, stated: Array) -> float:
    """Deviations of a normal number that is as unlikely as all measurements together."""
    from scipy.stats import chi2, norm  # slow to import

    covariance = np.cov(stated.T) + np.diag(errors**2)
    unlikely = chi2.sf(off @ np.linalg.solve(covariance, off), off.size)
    return float(norm.isf(0.5 * unlikely))


def _as_table(stated: InputTable, moved: Array, names: list[str]) -> InputTable:
    """Departures as samples of the posterior, correlated by rank."""
    source = f"narrowed by device.measured: {', '.join(names)}"
    rows = tuple(
        UncertainInput(
            row.name,
            row.unit,
            Distribution("samples", values=np.sort(column)),
            row.origin,
            f"{row.source}; {source}" if row.source else source,
            row.varies,
        )
        for row, column in zip(stated.rows, moved.T, strict=True)
    )
    count = len(rows)
    if count < 2:
        return InputTable(rows, np.eye(count))
    ranks = moved.argsort(axis=0).argsort(axis=0)
    rank_correlation = (1.0 - RIDGE) * np.corrcoef(ranks.T) + RIDGE * np.eye(count)
    return InputTable(rows, rank_correlation)


def what_remains(settings: DeviceSettings) -> dict[str, object]:
    """What result files say of the measurements: of each property, and what contradicts what."""
    posterior = narrowed(settings)
    measured = settings.measured
    assert measured is not None
    middle = departed_properties(
        settings, posterior.table.transform(np.full((1, len(posterior.after)), 0.5))
    )
    return {
        "measured": {
            name: {
                "value": value,
                "error": error,
                "by_stated_device": posterior.stated[name][0],
                "deviation_of_stated_devices": posterior.stated[name][1],
            }
            for name, (value, error) in measured.stated.items()
        },
        "properties": [
            {
                "name": name,
                "unit": unit_of(name),
                "stated": getattr(settings, name),
                "typical": float(typical),
                "remains": float(after / before) if before else 1.0,
            }
            for name, typical, before, after in zip(
                settings.varied, middle[0], posterior.before, posterior.after, strict=True
            )
        ],
        "doubt": posterior.doubt,
    }
