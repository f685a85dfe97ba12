"""Figures of what a scene may ask for on top: repeated closing under creep, and elastic coupling."""

from workflow.report.available import Results, column
from workflow.report.drawing import BLUE, GREEN, ORANGE, SERIES, SOFT, draw


def history_curves(results: Results) -> str:
    """Closing and opening of the first surface, a few of its cycles."""
    groups, _, facts = results.h5("history/curves.h5")
    names = sorted(name for name in facts if "/" not in name)

    def plot(axis):
        for number, name in enumerate(names):
            color = SERIES[number % len(SERIES)]
            for branch, style in (("closing", "-"), ("opening", "--")):
                curve = groups[f"{name}/{branch}"]
                force = (curve["repulsive_nN"] + curve["attractive_nN"]) / 1e3
                label = f"cycle {int(facts[name]['cycle'])}" if branch == "closing" else None
                axis.plot(curve["separation_nm"], force, style, color=color, label=label, linewidth=1.5)
        first = groups[f"{names[0]}/closing"]
        contact = float(first["separation_nm"][first["repulsive_nN"] > 0].max())
        axis.axhline(0, color=SOFT, linewidth=0.8)
        axis.set(xlim=(None, contact + 6), xlabel="mean separation (nm)", ylabel="force on the cell (µN)")
        axis.legend(fontsize=8.5)

    return draw("history", "Force against separation of a surface that is closed again and again", plot)


def history_drift(results: Results) -> str:
    """Energy lost by each cycle, and how far the closed contact sinks and grows with the time under load."""
    cycles = results.csv("history/cycles.csv")
    dwell = results.csv("history/dwell.csv")
    seeds = sorted({row["seed"] for row in cycles}, key=int)

    def plot(energy, sunk):
        for number, seed in enumerate(seeds):
            color = SERIES[number % len(SERIES)]
            part = [row for row in cycles if row["seed"] == seed]
            lost = column(part, "dissipated_nN_nm")
            some = lost > 0  # an elastic cycle loses nothing but rounding
            energy.plot(column(part, "cycle")[some], lost[some], "o-", color=color, markersize=3)
            held = [row for row in dwell if row["seed"] == seed]
            x, depth = (column(held, "held_s"), "separation_nm") if held else (column(part, "cycle"), "closed_nm")
            closed = column(held or part, depth)
            sunk.plot(x, closed[0] - closed, "-", color=color)
        energy.set(xscale="log", yscale="log", xlabel="cycle", ylabel="energy lost (nN nm)")
        sunk.set(xscale="symlog" if dwell else "log", xlabel="time under load (s)" if dwell else "cycle")
        sunk.set(ylabel="sunk since first closed (nm)")

    return draw("drift", "Energy lost by each cycle and sinking of the closed contact", plot, (9.4, 3.6), columns=2)


def coupling_curves(results: Results) -> str:
    """Force against separation of both models, and the ratio of their contact areas."""
    rows = results.csv("coupling/comparison.csv")
    first = min(int(row["seed"]) for row in rows)

    def plot(curve, area):
        for prefactor, color, label in (
            ("hertz", BLUE, "single asperities, p = 4/3 (Hertz)"),
            ("paper", ORANGE, "single asperities, p = 2/3 (paper)"),
        ):
            part = [row for row in rows if row["prefactor"] == prefactor]
            one = [row for row in part if int(row["seed"]) == first]
            load = column(one, "load_nN") / 1e3
            curve.plot(column(one, "separation_nm"), load, "s--", color=color, markersize=4, label=label)
            if prefactor == "hertz":
                coupled = column(one, "separation_coupled_nm")
                curve.plot(coupled, load, "o-", color=GREEN, markersize=4, label="elastic half-space")
            ratio = column(part, "contact_area_nm2") / column(part, "contact_area_coupled_nm2")
            area.plot(column(part, "load_nN") / 1e3, ratio, "s", color=color, markersize=4, alpha=0.7)
        curve.set(yscale="log", xlabel="mean separation (nm)", ylabel="force on the cell (µN)")
        curve.legend(fontsize=8.5)
        area.axhline(1, color=SOFT, linewidth=0.8)
        area.set(xscale="log", xlabel="force on the cell (µN)", ylabel="contact area over the half-space's")
        area.set_ylim(bottom=0)

    label = "Force and contact area of single asperities and of an elastic half-space"
    return draw("coupling", label, plot, (9.4, 3.7), columns=2)
