"""The answer: release voltage and probability of sticking over all that is uncertain, and what
makes them so.

It is taken from the switches of `mesoscale.answer.switches` as they are. A point without an answer
has its reason, and the probability's interval counts it both ways.
"""

from dataclasses import asdict, dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from mesoscale.answer.known import ENDS, fit_additive, known
from mesoscale.answer.other_devices import by_capacitance, release_by_key
from mesoscale.answer.switches import PadModel, Solved
from mesoscale.errors import InputError
from mesoscale.pad.adhesion import adhesion_of
from mesoscale.pad.curves import PadCurves, attracting
from mesoscale.settings import DeviceSettings
from mesoscale.settings.device import EVEN_CHARGE
from mesoscale.switch import release_or_nan_V, switch_of
from mesoscale.switch.charge import shift_V
from mesoscale.switch.switch import NEVER_CLOSES

Array = NDArray[np.float64]

WORKS = (1.0 / 3.0, 1.0, 3.0)
"""Both laws of attraction differ by a factor of 3 in their work at touch (docs/contact.md); no
statistics decides.
"""
ELECTRODES = {"beam": "bending", "plate": "flat"}
"""What the result files call them."""
SOLVED_SHARE = 0.8
"""Of the points must be solved, since those that cannot be are no random part of them."""
FEWEST = 8
"""Switches that close, of which an answer can be."""
RESAMPLES = 1000
"""Of the points, for the errors of quantiles."""


@dataclass(frozen=True)
class Sensitivity:
    """What one uncertain number does to the release."""

    name: str
    varies: str
    share_of_variance: float
    interval_shrinks_by: float


@dataclass(frozen=True)
class Answer:
    """Over all that is uncertain.

    Attributes
    ----------
    release_V : 0 where it sticks; this, pull-in and capacitance as `describe` gives them.
    quantile_error_V : standard errors of the 5, 50 and 95 % quantiles of the release, by the number
        of points.
    stuck : share that sticks, with its interval.
    causes : share of the variance by what is common to all devices, what is of each, and the number
        of cells.
    sensitivity : by what varies, the largest first.
    points, refused : number of solved switches, and why the others are none.
    never_close : share of all points that the hold voltage never closes, with its interval; they
        are no part of the release.
    pull_in_shrinks_by : share by which the interval of the release shrinks where the pull-in of the
        device is known.
    deepened : of the solved, those that press harder than their pads were computed.
    cells : of all pads together.
    cells_error_V : root mean square error of a point by its number of cells.
    explained : share of the variance that the fit behind the causes predicts of switches left out
        one at a time.
    noise : share that a number seems to explain by chance, taken off those of `sensitivity`.
    known : bands of what is not known and of what differs between devices; see
        `mesoscale.answer.known.known`.
    """

    release_V: dict[str, Any]
    quantile_error_V: dict[str, float]
    stuck: dict[str, float]
    pull_in_V: dict[str, Any]
    capacitance_fF: dict[str, Any]
    causes: dict[str, float]
    sensitivity: tuple[Sensitivity, ...]
    points: int
    refused: tuple[str, ...]
    never_close: dict[str, float]
    pull_in_shrinks_by: float
    deepened: int
    cells: int
    cells_error_V: float
    explained: float
    noise: float
    known: dict[str, Any]


def answer(model: PadModel) -> Answer:
    """The answer of the solved points.

    Raises
    ------
    InputError : too few of them have an answer.
    """
    solved = [model.points[k] for k in model.solved]
    never, refused = _never_and_refused(model)
    if never and len(solved) < FEWEST:
        raise InputError(
            f"device: {len(never)} of {len(model.points)} switches never close: {never[0]}"
        )
    closing = len(model.points) - len(never)
    if len(solved) < SOLVED_SHARE * closing:
        raise InputError(
            f"device: {len(refused)} of {closing} switches cannot be solved: {refused[0]}"
        )
    release = model.states("release_V")
    stuck = model.states("release_V") == 0.0
    errors = np.array([point.error_V for point in solved])
    known_errors = errors[np.isfinite(errors)]
    error_V = 0.0
    if known_errors.size:
        error_V = float(np.sqrt(np.mean(known_errors**2)))
    names, varies, varying = model.design.names, model.design.varies, model.design.varying
    fit = fit_additive(model.design.probability[model.solved][:, varying], release)
    cells = fit.deviation(release, np.where(np.isfinite(errors), errors, error_V))
    rows = [
        (names[k], varies[k], share)
        for k, share in zip(varying, fit.shares().tolist(), strict=True)
    ]
    by_cause = {
        kind: float(sum(share for _, of, share in rows if of == kind))
        for kind in ("common", "each")
    }
    by_cause["cells"] = cells**2 / fit.variance
    return Answer(
        describe(release),
        _quantile_errors(release),
        _probability(int(stuck.sum()), stuck.size, len(refused)),
        describe(model.states("pull_in_V")),
        describe(model.states("capacitance_fF")),
        by_cause,
        tuple(
            sorted(
                (Sensitivity(*row, 1.0 - float(np.sqrt(max(1.0 - row[2], 0.0)))) for row in rows),
                key=lambda row: -row.share_of_variance,
            )
        ),
        len(solved),
        tuple(refused),
        probability(len(never), len(model.points)),
        shrinks_by(model.states("pull_in_V"), release),
        int(model.states("deepened").sum()),
        sum(point.pad.count for point in solved if point.pad),
        error_V,
        fit.explained,
        fit.noise,
        known(fit, np.array([varies[k] == "common" for k in varying], bool), cells),
    )


def shrinks_by(known: Array, release: Array) -> float:
    """Share by which the interval of the release shrinks where a number of each switch is known;
    both of shape (m,).

    The release is fitted by the number and its square, and each switch predicted by the others.
    """
    if known.std() == 0.0 or release.std() == 0.0 or known.size < FEWEST:
        return 0.0
    columns = np.vander((known - known.mean()) / known.std(), 3)
    inverse = np.linalg.pinv(columns)
    free = 1.0 - np.einsum("pi,ip->p", columns, inverse)
    left = (release - columns @ (inverse @ release)) / np.maximum(free, 1e-9)
    remains = float(np.sqrt(np.mean(left**2))) / float(release.std())
    return max(1.0 - remains, 0.0)


def _never_and_refused(model: PadModel) -> tuple[list[str], list[str]]:
    """Reasons of points that the hold voltage never closes, and of those that cannot be solved."""
    never = [reason for reason in model.refused if NEVER_CLOSES in reason]
    return never, [reason for reason in model.refused if reason not in never]


@dataclass(frozen=True)
class PartAnswer:
    """What is known of switches of which too many have no answer.

    Attributes
    ----------
    solved, refused : how many have an answer, and how many none.
    stuck : share that sticks, if none of those without an answer does, and if all do.
    median_V : median release, if all of these stick, and if they let go above all others; infinite
        where they decide it.
    """

    solved: int
    refused: int
    stuck: tuple[float, float]
    median_V: tuple[float, float]


def answered_in_part(model: PadModel) -> PartAnswer | None:
    """What is known whatever those without an answer do; None where no switch has one."""
    release = model.states("release_V")
    refused = len(_never_and_refused(model)[1])
    if release.size == 0:
        return None
    total = release.size + refused
    stuck = int((release == 0.0).sum())
    if_stuck = np.append(release, np.zeros(refused))
    if_released = np.append(release, np.full(refused, np.inf))
    return PartAnswer(
        release.size,
        refused,
        (stuck / total, (stuck + refused) / total),
        (
            float(np.quantile(if_stuck, 0.5, method="lower")),
            float(np.quantile(if_released, 0.5, method="higher")),
        ),
    )


def describe(values: Array) -> dict[str, Any]:
    """Deviation and quantiles."""
    quantiles = np.quantile(values, ENDS)
    deviation = 0.0
    if values.size > 1:
        deviation = float(values.std(ddof=1))
    return {
        "std": deviation,
        "quantiles": {f"{q:g}": float(value) for q, value in zip(ENDS, quantiles, strict=True)},
    }


def probability(count: int, total: int) -> dict[str, float]:
    """Share of `count` in `total` with its 95 % Wilson interval, which stays sensible at 0 and
    1.
    """
    from scipy.stats import binomtest  # slow to import

    ends = binomtest(count, total).proportion_ci(0.95, method="wilson")
    return {"value": count / total, "low": float(ends.low), "high": float(ends.high)}


def _quantile_errors(release: Array) -> dict[str, float]:
    """Standard errors of quantiles by resampling the points; a Latin hypercube errs by less."""
    rng = np.random.default_rng(np.random.SeedSequence([0, 0xB007]))
    picks = rng.integers(release.size, size=(RESAMPLES, release.size))
    errors = np.quantile(release[picks], ENDS, axis=1).std(axis=1)
    return {f"{end:g}": float(error) for end, error in zip(ENDS, errors, strict=True)}


def _probability(stuck: int, solved: int, refused: int) -> dict[str, float]:
    """Share that sticks; the interval is that of all points, with those refused once as released
    and once as stuck.
    """
    total = solved + refused
    if_released = probability(stuck, total)
    if_stuck = probability(stuck + refused, total)
    return {"value": stuck / solved, "low": if_released["low"], "high": if_stuck["high"]}


def switch_on_pad(model: PadModel, cell_area_nm2: float) -> dict[str, Any]:
    """Content of answer/pad_switch.json, but for its `reserve`; without points there is no
    answer.
    """
    central = model.central
    settings = central.point.device
    content = None
    status = "the scene asks for no points (pad.points: 0)"
    if model.points:
        try:
            content = asdict(answer(model))
            status = "ok"
        except InputError as error:
            status = str(error)
    cells_computed = 0
    adhesion = []
    by_key = []
    falls = []
    if central.pad:
        cells_computed = central.pad.count
        adhesion = [asdict(opened) for opened in adhesion_of(central.pad.curves)]
    if central.pad and central.states:
        by_key = release_by_key(settings, central.pad.curves)
        falls = by_capacitance(settings, central.pad.curves)
    reasons = _reasons(central)
    reversed_drive = {}
    if central.pad and central.states and shift_V(settings):
        reversed_drive = {"reversed": _reversed(settings, central.pad.curves)}
    return {
        "electrode": ELECTRODES[settings.kind],
        "cells_computed": cells_computed,
        "cells_of_pad": settings.pad_um2 * 1e6 / cell_area_nm2,
        "central": _central(central),
        "by_attraction": [
            {"times": times, "release_V": _release_V(central, times)} for times in WORKS
        ],
        "adhesion": adhesion,
        "by_key": by_key,
        "by_capacitance": falls,
        **reversed_drive,
        "gate": {"passed": not reasons, "reasons": reasons},
        "answer": content,
        "answer_status": status,
    }


def _central(central: Solved) -> dict[str, float] | None:
    """What the switch at central inputs does; None where it has no answer."""
    if central.states is None:
        return None
    return {**central.states.numbers, "error_V": central.error_V}


def _reversed(settings: DeviceSettings, pad: PadCurves) -> dict[str, Any]:
    """What the switch does driven with the other polarity, which its even charge shifts the other
    way; a reason where it has no answer.
    """
    opposite = {name: -getattr(settings, name) for name in EVEN_CHARGE}
    try:
        return switch_of(settings.model_copy(update=opposite)).states(pad).numbers
    except InputError as error:
        return {"reason": str(error)}


def _reasons(central: Solved) -> list[str]:
    """Why the switch at central inputs is not to be trusted; nothing where it is."""
    if central.refused or central.pad is None:
        return [central.refused]
    reasons = []
    if unsettled := int((~central.pad.settled).sum()):
        reasons.append(f"{unsettled} cells in which flow did not come to rest")
    if min(central.halves_V) == 0.0 < max(central.halves_V):
        reasons.append(
            f"the {central.pad.count} computed cells do not decide whether the switch sticks: on"
            f" one half of them it does, on the other it lets go at {max(central.halves_V):.3g} V;"
            " raise pad.cells"
        )
    return reasons


def _release_V(central: Solved, times: float) -> float | None:
    """Release at `times` the attraction; None where it is not known."""
    if central.pad is None:
        return None
    release = release_or_nan_V(central.point.device, attracting(central.pad.curves, times))
    return release if np.isfinite(release) else None
