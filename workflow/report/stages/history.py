"""Closed again and again: shakedown and creep."""

from collections.abc import Iterator

import numpy as np

from workflow.report.available import CsvRow, Results
from workflow.report.drawing import SERIES, draw
from workflow.report.numbers import column, number, show
from workflow.report.page import Block, Figure, stage


@stage("Closed again and again", "history/cycles.csv", "history/dwell.csv")
def describe(results: Results) -> Iterator[Block]:
    """Shakedown and creep."""
    rows = results.csv("history/cycles.csv")
    last = max(int(row["cycle"]) for row in rows)
    held = max(number(row["held_s"]) for row in rows)
    cycles = f"{last} cycles of the same surfaces, each from what the last one left"
    if held:
        cycles += (
            f", {show(held)} s under load in all: the hardness falls with time by the creep law of"
            " the scene"
        )
    yield f"{cycles}. {_shakedown(rows)}"
    yield Figure(
        history_drift(results),
        "Left: energy lost by each cycle, one line per surface. Right: how far the closed contact"
        " sinks.",
        wide=True,
    )
    if not all(row["converged"] == "True" for row in rows):
        yield "Some cycles did not converge or missed their force: see column converged."
    if held:
        yield "The constants of the creep law are the scene's, not results of this work."


def history_drift(results: Results) -> str:
    """Energy lost by each cycle, and how far the closed contact sinks and grows with the time under
    load.
    """
    cycles = results.csv("history/cycles.csv")
    dwell = results.csv("history/dwell.csv")
    seeds = sorted({row["seed"] for row in cycles}, key=int)

    def plot(energy, sunk):
        for place, seed in enumerate(seeds):
            color = SERIES[place % len(SERIES)]
            of_seed = [row for row in cycles if row["seed"] == seed]
            lost = column(of_seed, "dissipated_nN_nm")
            some = lost > 0  # an elastic cycle loses nothing but rounding
            energy.plot(column(of_seed, "cycle")[some], lost[some], "o-", color=color, markersize=3)
            held = [row for row in dwell if row["seed"] == seed]
            if held:
                time_or_cycle = column(held, "held_s")
                closed_nm = column(held, "separation_nm")
            else:
                time_or_cycle = column(of_seed, "cycle")
                closed_nm = column(of_seed, "closed_nm")
            sunk.plot(time_or_cycle, closed_nm[0] - closed_nm, "-", color=color)
        energy.set(xscale="log", yscale="log", xlabel="cycle", ylabel="energy lost (nN nm)")
        if dwell:
            sunk.set(xscale="symlog", xlabel="time under load (s)")
        else:
            sunk.set(xscale="log", xlabel="cycle")
        sunk.set(ylabel="sunk since first closed (nm)")

    return draw(
        "drift",
        "Energy lost by each cycle and sinking of the closed contact",
        plot,
        (9.4, 3.6),
        columns=2,
    )


def _shakedown(rows: list[CsvRow]) -> str:
    """How much less energy the last cycle loses than the first."""
    numbers = [int(row["cycle"]) for row in rows]
    by_cycle = {
        n: column([row for row in rows if int(row["cycle"]) == n], "dissipated_nN_nm").mean()
        for n in {min(numbers), max(numbers)}
    }
    first = by_cycle[min(by_cycle)]
    last = by_cycle[max(by_cycle)]
    if len(by_cycle) < 2 or not np.isfinite(first) or first <= 0:
        return ""
    return (
        f"The last cycle loses {show(100 * max(last, 0.0) / first, 2)} % of the energy that the"
        " first one lost."
    )
