"""A pad's closed form as a function of the inputs, through the pads of many draws of them.

Lengths are taken in units of the RMS height. With z the other inputs, scaled to -1 .. 1 over their ranges, and d the
logarithm of D0 over its smallest value, the closed form of `mesoscale.pad.compact` has

    c0, c1      linear in z and ln rms
    b0          linear in z and ln rms
    ln beta/A_H linear in z, ln rms and d

and its other numbers are the same for all inputs. Every part is one least squares over all pads, in which a pad counts
by its cells, so the scatter of a draw's few cells averages out as that of all cells together.

Where places of a film differ, pads of few cells scatter by where they touch, and more than a pad's repulsion reaches in
separation. Lines of ln p over s are then too flat (regression dilution). There the separation is fitted as a function
of the repulsion, with a level and a slope that are linear in z and ln rms, and c0 and c1 are those of the same line.

A straight line through the releases of the draws was tried instead: it foretells a draw left out less well, and gives
neither curves nor held states.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import lsq_linear, minimize_scalar

from mesoscale.errors import InputError
from mesoscale.inputs.definitions import RMS_SCATTER
from mesoscale.inputs.distributions import InputTable
from mesoscale.pad.carried import CarriedPad
from mesoscale.pad.compact import CompactPad, UNIT_GPa, lift
from mesoscale.pad.memory import PadLaw

Array = NDArray[np.float64]

CLOSING_FLOOR = 1e-3
"""Share of the largest repulsion down to which closing is fitted: beyond, few of a draw's cells touch."""
OPENING_FLOOR = 0.03
MOST_LIFTED = 30.0
"""Three times the largest that pads of the shipped scenes have."""
SPAN = 0.999
"""Central share of an unbounded distribution that -1 .. 1 spans; the fit does not depend on it."""


@dataclass(frozen=True)
class SampledPad:
    """The pad of one set of inputs.

    Attributes
    ----------
    values : inputs by name.
    gap_cutoff_nm : D0.
    cells : number of its cells, its weight.
    """

    values: Mapping[str, float]
    gap_cutoff_nm: float
    cells: int
    law: PadLaw


@dataclass(frozen=True)
class PadResponse:
    """Closed form of a pad at any inputs.

    Attributes
    ----------
    names : inputs besides the RMS height and the Hamaker constant, in the order of z.
    centre, half : z = (value - centre) / half, shape (n,).
    rms_nm, gap_cutoff_nm : where ln rms and d are zero.
    closing : coefficients of c0 and of c1 (constant, z, ln rms), then c2, shape (2 n + 5,); with `slopes` those of
        s / rms at the mean -ln p, which comes last, and of its slope there.
    opening : of b0, then b1 and b2, shape (n + 4,).
    attraction : of ln beta / A_H (with d), then m and n, shape (n + 5,).
    lifted : the same for all inputs.
    offset : whether the walls are D0 apart at touch (law `offset`).
    slopes : smallest and largest slope of a pad by itself, where separations are fitted: no other pad goes beyond.
    """

    names: tuple[str, ...]
    centre: Array
    half: Array
    rms_nm: float
    gap_cutoff_nm: float
    closing: Array
    opening: Array
    attraction: Array
    lifted: float
    offset: bool
    slopes: tuple[float, float] | None = None

    def at(self, values: Mapping[str, float], gap_cutoff_nm: float) -> CompactPad:
        """The closed form at one set of inputs."""
        row = _features(self.names, self.centre, self.half, self.rms_nm, values)
        size, rms = row.size, values["rms"]
        d = np.log(gap_cutoff_nm / self.gap_cutoff_nm)
        strength = float(row @ self.attraction[:size] + d * self.attraction[size])
        c0, c1, c2 = float(row @ self.closing[:size]), float(row @ self.closing[size:-1]), float(self.closing[-1])
        if self.slopes:
            c1 = 1.0 / float(np.clip(c1, *self.slopes))
            c0, c2 = c2 - c0 * c1, 0.0
        return CompactPad(
            c0=c0,
            c1_per_nm=c1 / rms,
            c2_per_nm2=c2 / rms**2,
            b0_per_nm=float(row @ self.opening[:size]) / rms,
            b1_per_nm2=float(self.opening[-2]) / rms**2,
            b2_per_nm2=float(self.opening[-1]) / rms**2,
            beta=float(np.exp(strength)) * values["hamaker"],
            m=float(self.attraction[-2]),
            n=float(self.attraction[-1]),
            lifted=self.lifted,
            hamaker=values["hamaker"],
            offset_nm=values.get("gap_cutoff", gap_cutoff_nm) if self.offset else 0.0,
        )


def fit_response(pads: Sequence[SampledPad], table: InputTable) -> PadResponse:
    """The closed form through all pads.

    Raises
    ------
    InputError : fewer pads than the response has slopes.
    """
    varied = [name for name in table.names if name not in ("rms", "hamaker") and _varies(table, name)]
    if len(pads) < len(varied) + 4:
        raise InputError(
            f"pad.draws = {len(pads) - 1}: accepted are at least {len(varied) + 3} with {len(varied)} inputs that vary "
            "besides the RMS height and the Hamaker constant"
        )
    spans = np.array([table.rows[table.names.index(name)].distribution.span(SPAN) for name in varied]).reshape(-1, 2)
    centre, half = spans.mean(axis=1), np.ptp(spans, axis=1) / 2.0
    medians = table.medians()
    least = min(pad.gap_cutoff_nm for pad in pads)
    names, parts = tuple(varied), [[], [], []]
    for pad in pads:
        row = _features(names, centre, half, medians["rms"], pad.values)
        d = np.log(pad.gap_cutoff_nm / least)
        for kept, new in zip(parts, _equations(pad, row, d), strict=True):
            # each pad's points share their scatter: a pad counts by its cells and not by its separations
            share = np.sqrt(pad.cells / max(len(new[1]), 1))
            kept.append((*new, np.full(len(new[1]), share)))
    closing, opening, attraction = (_joined(part) for part in parts)
    if RMS_SCATTER.name in table.names:
        slopes = [np.polyfit(levels, columns[:, len(varied) + 2], 1)[0] for columns, levels, _ in parts[0]]
        repulsion, reach = _positions(*closing), (float(min(slopes)), float(max(slopes)))
    else:
        repulsion, reach = _solve(*closing, 1)[0], None
    lifted = _lifted(*attraction)
    return PadResponse(
        names,
        centre,
        half,
        medians["rms"],
        least,
        repulsion,
        _solve(*opening, 1)[0],
        _attraction(*attraction, lifted)[0],
        lifted,
        any(pad.law.flats.offset_nm > 0 for pad in pads),
        reach,
    )


def _joined(part: Sequence[tuple[Array, Array, Array]]) -> tuple[Array, Array, Array]:
    """Columns, wanted values and weights of all pads."""
    columns, wanted, weights = zip(*part, strict=True)
    return np.concatenate(columns), np.concatenate(wanted), np.concatenate(weights)


def _solve(columns: Array, wanted: Array, weights: Array, signed: int) -> tuple[Array, float]:
    """Weighted least squares and its misfit; the last `signed` numbers are not negative: none grows on opening."""
    lowest = np.full(columns.shape[1], -np.inf)
    lowest[len(lowest) - signed :] = 0.0
    solved = lsq_linear(columns * weights[:, None], wanted * weights, (lowest, np.inf))
    return np.asarray(solved.x, float), float(solved.cost)


def _positions(columns: Array, levels: Array, weights: Array) -> Array:
    """Level and slope of s / rms over -ln p, and the mean of that, from the equations of -ln p over s / rms."""
    size = (columns.shape[1] - 1) // 2
    row, at = columns[:, :size], columns[:, size]
    middle = float(np.average(levels, weights=weights**2))
    turned = np.hstack([row, row * (levels - middle)[:, None]])
    return np.append(_solve(turned, at, weights, 0)[0], middle)


def _attraction(columns: Array, wanted: Array, weights: Array, lifted: float) -> tuple[Array, float]:
    """The attraction at one `lifted`; the last column is the logarithm of the load that is left."""
    return _solve(columns, wanted - np.log(lift(np.exp(columns[:, -1]), lifted)), weights, 2)


def _lifted(columns: Array, wanted: Array, weights: Array) -> float:
    """The `lifted` of least misfit."""
    minimum: Any = minimize_scalar(
        lambda lifted: _attraction(columns, wanted, weights, lifted)[1],
        bounds=(0.0, MOST_LIFTED),
        options={"xatol": 1e-7},
    )
    return float(minimum.x)


def _varies(table: InputTable, name: str) -> bool:
    low, high = table.rows[table.names.index(name)].distribution.span(SPAN)
    return high > low


def _features(names: Sequence[str], centre: Array, half: Array, rms_nm: float, values: Mapping[str, float]) -> Array:
    z = (np.array([values[name] for name in names]) - centre) / half
    return np.concatenate([[1.0], z, [np.log(values["rms"] / rms_nm)]])


def _equations(pad: SampledPad, row: Array, d: float) -> list[tuple[Array, Array]]:
    """Columns and wanted values of closing, opening and attraction of one pad."""
    law, rms = pad.law, pad.values["rms"]
    s, (pushes, pulls) = law.separation_nm, law.closing
    far, hamaker = law.flats.pull_GPa(s), law.flats.hamaker
    used = (pushes > CLOSING_FLOOR * pushes.max()) & (-pulls > far)
    at = s[used, None] / rms
    closing = np.hstack([np.tile(row, (len(at), 1)), row * at, at**2]), -np.log(pushes[used])
    near = np.log((-pulls - far)[used] / (UNIT_GPa * hamaker))
    head = np.append(row, d)
    attraction = [np.hstack([np.tile(head, (len(at), 1)), np.log(pushes[used] / UNIT_GPa)[:, None], 0.0 * at])]
    strengths = [near]
    opening, decays = [], []
    for depth, (up, down) in zip(law.depth_nm, law.opening, strict=True):
        above = np.flatnonzero(np.isfinite(up))
        if up[above[0]] <= CLOSING_FLOOR * pushes.max():
            continue
        share, pull = up[above] / up[above[0]], -down[above] - far[above]
        use = (s[above] > depth) & (share > OPENING_FLOOR) & (pull > 0)
        risen, decay = ((s[above] - depth) / rms)[use, None], -np.log(share[use])
        opening.append(np.hstack([row * risen, depth / rms * risen, risen**2]))
        decays.append(decay)
        load = np.full_like(risen, np.log(up[above[0]] / UNIT_GPa))
        attraction.append(np.hstack([np.tile(head, (len(risen), 1)), load, -decay[:, None]]))
        strengths.append(np.log(pull[use] / (UNIT_GPa * hamaker)))
    return [
        closing,
        (np.concatenate(opening), np.concatenate(decays)),
        (np.concatenate(attraction), np.concatenate(strengths)),
    ]


def law_of_compact(
    compact: CompactPad | CarriedPad, wanted_GPa: Array, separation_nm: Array, depths: int = 24
) -> PadLaw:
    """Curves of a closed form from where its closing carries what is wanted, or the most that it does, to far away.

    Parameters
    ----------
    wanted_GPa : net pressure at rising `separation_nm`, shape (n,).

    Raises
    ------
    InputError : the form presses hardest where the pad is farthest away, or without end.
    """
    net = np.add(*compact.closing_GPa(separation_nm))
    deep = np.flatnonzero(net >= wanted_GPa)
    s = separation_nm[deep[-1] if deep.size else int(net.argmax()) :]
    if s.size == 1:
        raise InputError(f"separation {s[0]:.4g} nm: the closed form of the pad still presses there")
    load = compact.closing_GPa(s)[0]
    if not 0.0 < load[0] < np.inf:
        raise InputError(f"separation {s[0]:.4g} nm: the closed form of the pad carries {load[0]:.3g} GPa")
    shallow = np.flatnonzero(load > 1e-4 * load[0])[-1]
    # on the separations, so that every opening starts where closing ended
    depth = s[np.unique(np.linspace(0, shallow, depths).round().astype(int))]
    opening = np.full((depth.size, 2, s.size), np.nan)
    closing = np.stack(compact.closing_GPa(s))
    for k, deepest in enumerate(depth):
        above = s >= deepest - 1e-9
        opening[k][:, above] = compact.opening_GPa(s[above], deepest)
        # what was flattened never pushes harder than it did on the way down, as a fitted rebound may
        opening[k, 0, above] = np.minimum(opening[k, 0, above], closing[0, above])
    return PadLaw(s, closing, depth, opening, compact.flats)
