"""The answer: release voltage and probability of sticking, with what cells, inputs, D0 and the device leave open.

The switch is solved at points that fill the joint distribution of the inputs, D0 and properties of the device, each on
the pad that `mesoscale.pad.carried` gives there. A point that cannot be solved has its reason, and the probability's
interval counts it both ways. The finite number of computed cells is a separate cause: it is no property of the switch,
and resampling the cells of the central pad tells its part.
"""

from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from mesoscale.device.electrode import solve_deepened
from mesoscale.device.pressing import pressure_to_compute
from mesoscale.device.spread import properties_at, varied, with_properties
from mesoscale.device.statistics import describe, probability
from mesoscale.errors import InputError
from mesoscale.inputs.distributions import InputTable
from mesoscale.pad.carried import CarriedPad, Factors, factors_of
from mesoscale.pad.compact import CompactPad
from mesoscale.pad.curves import PadCells
from mesoscale.pad.memory import Flats, FLOOR_GPa, PadLaw, law_of
from mesoscale.pad.response import PadResponse, SampledPad, fit_response, law_of_compact
from mesoscale.settings import DeviceSettings

Array = NDArray[np.float64]

POINTS = 128
"""Solved switches behind the interval: its ends are quantiles known to 2 % in probability. The expansion behind the
causes has 41 terms in `reduced`: of switches left out, 128 explain 76 % of the variance, 64 explain 49 %."""
SOLVED = 0.8
"""Share of the points that must be solved, since those that cannot be are no random part of them."""
BLOCKS = 6
"""Of the draws, each of which is left out once."""
BLOCK_POINTS = 24
"""Switches behind each: the first of those behind the interval."""
SOLVED_TO_RANK = 0.5
"""The same where causes are only compared with each other."""
FAR_NM = 300.0
REACH_RMS, REACH_GPa = 60.0, 1e-10
"""Largest reach of a pad that is looked at, in RMS heights, and the push that ends it: 0.1 Pa, a ten-thousandth of what
counts as landed."""
FALLS = 1e4
"""A pad has lost contact far out: its repulsion is there below this part of its largest."""
LEAST_SHARE = 1e-6
Model = tuple[PadResponse, Factors | None]
"""The closed form of a pad at any inputs, and the factors of the central curves on it."""


@dataclass(frozen=True)
class Point:
    """One switch of the joint distribution.

    Attributes
    ----------
    values : inputs by name.
    device : settings with its own properties.
    """

    values: dict[str, float]
    gap_cutoff_nm: float
    device: DeviceSettings


def plan_points(
    table: InputTable, settings: DeviceSettings, low_nm: float, high_nm: float, count: int = POINTS
) -> tuple[list[str], list[str], Array, list[Point]]:
    """Names and causes of what varies, its probabilities at the points, shape (points, k), and the points."""
    from scipy.stats import qmc  # slow to import

    device = varied(settings)
    names = [*table.names, "gap_cutoff_nm", *device]
    causes = ["inputs"] * len(table.names) + ["gap_cutoff"]
    causes += [f"device_{getattr(settings.spread, name).varies}" for name in device]
    units = qmc.LatinHypercube(len(names), rng=0).random(count)
    values = values_at(units, table, settings, low_nm, high_nm)
    points = [point_of(row, table.names, settings) for row in values]
    chosen = np.flatnonzero(np.ptp(values, axis=0) > 0)
    return [names[k] for k in chosen], [causes[k] for k in chosen], units[:, chosen], points


def values_at(units: Array, table: InputTable, settings: DeviceSettings, low_nm: float, high_nm: float) -> Array:
    """Inputs, D0 (nm) and the `varied` properties of the device at probabilities; both of shape (m, k)."""
    inputs = len(table.rows)
    return np.column_stack(
        [
            table.transform(units[:, :inputs]),
            low_nm + (high_nm - low_nm) * units[:, inputs],
            properties_at(settings, units[:, inputs + 1 :]),
        ]
    )


def point_of(row: Array, names: Sequence[str], settings: DeviceSettings) -> Point:
    """The switch of a row of `values_at`."""
    inputs = len(names)
    values = dict(zip(names, row[:inputs].tolist(), strict=True))
    return Point(values, float(row[inputs]), with_properties(settings, row[inputs + 1 :]))


def cutoff_range(gap_cutoff_nm: float, draws: Sequence[SampledPad]) -> tuple[float, float]:
    """D0 (nm) of the central pad, and the largest of the draws."""
    return gap_cutoff_nm, max(gap_cutoff_nm, *(draw.gap_cutoff_nm for draw in draws))


def released_on_pad(
    cells: PadCells,
    draws: Sequence[SampledPad],
    table: InputTable,
    flats: Flats,
    settings: DeviceSettings,
    cutoffs_nm: tuple[float, float],
    count: int,
) -> tuple[Array, Array]:
    """Inputs (m, n) and release voltages (m,) of switches over inputs, D0 and devices; 0 V where one sticks.

    Parameters
    ----------
    cells, draws, cutoffs_nm : as `answer` takes them.
    count : points that are tried; those that cannot be solved are left out.

    Raises
    ------
    InputError : too few draws, or half of the points cannot be solved.
    """
    model = model_of(cells, draws, table, flats, cutoffs_nm[0])
    points = plan_points(table, settings, *cutoffs_nm, count)[3]
    solved, refused = solve_points(points, model)
    if len(solved) < SOLVED_TO_RANK * count:
        raise InputError(f"device: {len(refused)} of {count} switches cannot be solved, the last: {refused[-1]}")
    values = np.array([[points[place].values[name] for name in table.names] for place in solved])
    return values, np.array([state["release_V"] for state in solved.values()])


def answer(
    cells: PadCells,
    draws: Sequence[SampledPad],
    table: InputTable,
    flats: Flats,
    settings: DeviceSettings,
    cutoffs_nm: tuple[float, float],
    released: Callable[[], Array],
    threads: int,
) -> dict[str, Any]:
    """`answer` of device/pad_switch.json.

    Parameters
    ----------
    cells : of the pad at central inputs and the first D0.
    draws : pads at other inputs.
    cutoffs_nm : range of D0.
    released : gives release voltages (V) on pads of resampled cells.
    threads : switches that are solved at once.

    Raises
    ------
    InputError : too few draws, or the switch cannot be solved at central inputs.
    """
    middle = table.medians()
    model = model_of(cells, draws, table, flats, cutoffs_nm[0])
    by_curves = solve_deepened(settings, law_of(cells, flats))
    at_curves = Point(middle, cutoffs_nm[0], settings)
    middle_nm = float(np.mean(cutoffs_nm))
    in_the_middle = _solve(Point(middle, middle_nm, settings), model)
    names, causes, units, points = plan_points(table, settings, *cutoffs_nm)
    solved, refused = solve_points(points, model, threads)
    if len(solved) < SOLVED * len(points):
        raise InputError(f"device: {len(refused)} of {len(points)} switches cannot be solved, the first: {refused[0]}")
    solved_values = {key: np.array([state[key] for state in solved.values()]) for key in by_curves}
    release = solved_values["release_V"]
    stuck = release == 0.0
    cells_V = float(released().std(ddof=1))
    first, error = first_order(units[list(solved)], release)
    rng = np.random.default_rng(np.random.SeedSequence([0, 0xA15]))
    noisy = np.where(stuck, 0.0, np.maximum(release + cells_V * rng.normal(size=release.size), 0.0))
    variance = float(noisy.var()) or 1.0
    shares = first * float(release.var()) / variance
    return {
        "electrode": "bending" if settings.bends else "flat",
        "release_V": describe(noisy),
        "stuck": _probability(int(stuck.sum()), stuck.size, len(refused)),
        "pull_in_V": describe(solved_values["pull_in_V"]),
        "capacitance_fF": describe(solved_values["capacitance_fF"]),
        "landed_share": describe(solved_values["landed_share"]),
        "causes": [
            {"cause": cause, "share_of_variance": share, "deviation_V": float(np.sqrt(share * variance))}
            for cause, share in (
                *(
                    (cause, float(sum(s for s, c in zip(shares, causes, strict=True) if c == cause)))
                    for cause in ("inputs", "gap_cutoff", "device_common", "device_each")
                ),
                ("cells", cells_V**2 / variance),
            )
        ],
        "sensitivity": sorted(
            (
                {
                    "name": name,
                    "cause": cause,
                    "share_of_variance": float(share),
                    "interval_shrinks_by": float(1.0 - np.sqrt(max(1.0 - share, 0.0))),
                }
                for name, cause, share in zip(names, causes, shares, strict=True)
            ),
            key=lambda row: -row["share_of_variance"],
        ),
        "central": {"gap_cutoff_nm": middle_nm, **in_the_middle},
        "at_curves": {
            "gap_cutoff_nm": cutoffs_nm[0],
            "by_curves": by_curves,
            "by_carried_curves": _solve(at_curves, model),
            "by_closed_form": _solve(at_curves, (model[0], None)),
        },
        "design": {
            "draws": len(draws),
            "cells_per_draw": draws[0].cells,
            "points": len(solved),
            "deepened": int(solved_values["deepened"].sum()),
            "refused": refused,
            "response_error_V": error,
            "cells_error_V": cells_V,
            "draws_error_V": draws_error_V(cells, draws, table, flats, points, cutoffs_nm[0], threads),
        },
    }


def draws_error_V(
    cells: PadCells,
    draws: Sequence[SampledPad],
    table: InputTable,
    flats: Flats,
    points: Sequence[Point],
    gap_cutoff_nm: float,
    threads: int = 1,
) -> float | None:
    """Standard error (V) of the median release by the number of draws and of their cells; None with too few draws.

    The draws are left out block by block (delete-a-group jackknife, Kott, J. Off. Stat. 17 (2001) 521), and the medians
    are those of the same points in all of them.
    """
    medians = []
    for block in range(BLOCKS):
        kept = [draw for k, draw in enumerate(draws) if k % BLOCKS != block]
        try:
            model = model_of(cells, kept, table, flats, gap_cutoff_nm)
        except InputError:
            return None
        solved, _ = solve_points(points[:BLOCK_POINTS], model, threads)
        medians.append(np.median([state["release_V"] for state in solved.values()]))
    return float(np.sqrt((BLOCKS - 1) * np.var(medians)))


def try_answer(
    cells: PadCells,
    draws: Sequence[SampledPad],
    table: InputTable,
    flats: Flats,
    settings: DeviceSettings,
    gap_cutoff_nm: float,
    released: Callable[[], Array],
    threads: int,
) -> dict[str, Any]:
    """`answer` for device/pad_switch.json, or None with `answer_status` that says why there is none."""
    cutoffs_nm = cutoff_range(gap_cutoff_nm, draws)
    try:
        state = answer(cells, draws, table, flats, settings, cutoffs_nm, released, threads)
    except InputError as error:
        return {"answer": None, "answer_status": str(error)}
    return {"answer": state, "answer_status": "ok"}


def _probability(stuck: int, solved: int, refused: int) -> dict[str, float | int]:
    """Share that sticks; the interval is that of all points, with those refused once as released and once as stuck."""
    total = solved + refused
    least, most = probability(stuck, total), probability(stuck + refused, total)
    return {**probability(stuck, solved), "low": least["low"], "high": most["high"]}


def model_of(
    cells: PadCells, draws: Sequence[SampledPad], table: InputTable, flats: Flats, gap_cutoff_nm: float
) -> Model:
    """The closed form through the central pad and the draws, and the factors of the central curves on it."""
    central = SampledPad(table.medians(), gap_cutoff_nm, cells.count, law_of(cells, flats))
    response = fit_response([central, *draws], table)
    return response, factors_of(central.law, response.at(central.values, gap_cutoff_nm))


def solve_points(
    points: Sequence[Point], model: Model, threads: int = 1
) -> tuple[dict[int, dict[str, float]], list[str]]:
    """The switches of points, by their place, and why the others cannot be solved; so many at once."""

    def solved(point: Point) -> dict[str, float] | str:
        try:
            return _solve(point, model)
        except InputError as error:
            return str(error)

    with ThreadPoolExecutor(threads) as pool:
        states = list(pool.map(solved, points))
    refused = [state for state in states if isinstance(state, str)]
    return {place: state for place, state in enumerate(states) if not isinstance(state, str)}, refused


def _solve(point: Point, model: Model) -> dict[str, float]:
    """The switch of a point, on the curves carried there."""
    return solve_deepened(point.device, pad_at(point, model))


def pad_at(point: Point, model: Model) -> PadLaw:
    """The curves carried to a point."""
    form, s = _form_at(point, model)
    return law_of_compact(form, pressure_to_compute(point.device)(s), s)


def carried_share(point: Point, model: Model) -> float:
    """Largest pressure that the closed form carries at a point, over that to which pads are computed.

    Below 1 the switch is beyond the model: its pad would be closed more than any that was computed. A closed form must
    also fall by `FALLS` with the separation, or the share is what it falls by, in logarithm.
    """
    form, s = _form_at(point, model)
    pushes, pulls = form.closing_GPa(s)
    carried = float(((pushes + pulls) / pressure_to_compute(point.device)(s)).max())
    fallen = float(np.log(max(pushes.max(), FLOOR_GPa) / max(pushes[-1], FLOOR_GPa)) / np.log(FALLS))
    return max(min(carried, fallen), LEAST_SHARE)


def _form_at(point: Point, model: Model) -> tuple[CompactPad | CarriedPad, Array]:
    """The closed form at a point with the factors of the central curves, and separations for it (nm)."""
    response, factors = model
    compact = response.at(point.values, point.gap_cutoff_nm)
    form = CarriedPad(compact, factors) if factors else compact
    rms = point.values["rms"]
    # as far as the roughest place of the film touches: beyond the last separation a pad is two flats
    tried = np.arange(1.0, REACH_RMS, 0.5) * rms
    reach = tried[np.flatnonzero(form.closing_GPa(tried)[0] > REACH_GPa)[-1:]].max(initial=8.0 * rms)
    near = np.arange(0.01 * rms, reach + rms, 0.01 * rms)
    return form, np.concatenate([near, np.geomspace(near[-1], max(FAR_NM, 2.0 * near[-1]), 24)[1:]])


def first_order(units: Array, values: Array) -> tuple[Array, float]:
    """First-order shares of the variance of `values` by an expansion of second degree, and its leave-one-out error.

    Legendre's polynomials of the probabilities `units` (points, k), without products (Sudret, Reliab. Eng. Syst. Saf.
    93 (2008) 964). What noise alone would seem to explain is taken off.
    """
    x = 2.0 * units - 1.0
    columns = np.hstack([np.ones((len(x), 1)), np.sqrt(3.0) * x, np.sqrt(5.0) * (1.5 * x**2 - 0.5)])
    coefficients = np.linalg.lstsq(columns, values, rcond=None)[0]
    left = values - columns @ coefficients
    hat = np.einsum("pi,ip->p", columns, np.linalg.pinv(columns))
    error = float(np.sqrt(np.mean((left / (1.0 - hat)) ** 2)))
    linear, square = coefficients[1 : units.shape[1] + 1], coefficients[units.shape[1] + 1 :]
    explained = linear**2 + square**2
    total = float(explained.sum() + np.mean(left**2))
    noise = float((left**2).sum()) / max(len(x) - columns.shape[1], 1) / len(x)
    return np.maximum(explained - 2.0 * noise, 0.0) / (total or 1.0), error
