"""Sections of what a scene may ask for on top: repeated closing under creep, and elastic coupling."""

import numpy as np

from workflow.report import figures_beyond as figures
from workflow.report.available import Results, Row, column, number, show
from workflow.report.page import COMPUTED, Section, Table


def history(results: Results) -> Section:
    """Shakedown and creep."""
    rows = results.csv("history/cycles.csv")
    last = max(int(row["cycle"]) for row in rows)
    held = max(number(row["held_s"]) for row in rows)
    section = Section(
        "history",
        "Closed again and again",
        f"{last} cycles of the same surfaces, each from what the last one left"
        + (
            f", {show(held)} s under load in all: the hardness falls with time by the creep law of the scene. "
            if held
            else ". "
        )
        + _shakedown(rows),
        COMPUTED,
    )
    section.add(figures.history_curves(results), "Cycles of one surface; opening is dashed.")
    section.add(
        figures.history_drift(results),
        "Left: energy lost by each cycle, one line per surface. Right: how far the closed contact sinks.",
        wide=True,
    )
    shown = [row for row in rows if int(row["cycle"]) in (1, 2, 5, 10, 20, 50, 100, last)]
    lines = [
        (
            row["seed"],
            row["cycle"],
            show(row["held_s"]) if held else "–",
            show(row["closed_nm"], 4),
            show(row["last_contact_nm"], 4),
            show(row["contact_area_nm2"]),
            show(row["dissipated_nN_nm"]),
            show(row["pull_off_nN"]),
            "stuck" if number(row["release_V"]) == 0 else show(row["release_V"]),
            show(row["critical_landed_fraction"]),
        )
        for row in shown
    ]
    header = (
        "surface",
        "cycle",
        "time under load (s)",
        "closed (nm)",
        "last contact (nm)",
        "contact area (nm²)",
        "energy lost (nN nm)",
        "pull-off (nN)",
        "release (V)",
        "critical landed fraction",
    )
    section.blocks.append(Table("Cycles, and the switch that would follow each", header, lines, heads=2))
    if not all(row["converged"] == "True" for row in rows):
        section.notes.append("Some cycles did not converge or missed their force: see column converged.")
    if held:
        section.notes.append("The constants of the creep law are the scene's, not results of this work.")
    section.files += ["history/cycles.csv", "history/dwell.csv", "history/curves.h5"]
    return section


def coupling(results: Results) -> Section:
    """The model-form error of single asperities."""
    rows = results.csv("coupling/comparison.csv")
    section = Section(
        "coupling",
        "Asperities that feel each other",
        "Elastic contact of the same surfaces twice: each asperity on its own, and coupled through an elastic "
        "half-space (boundary elements). The difference is the model-form error of neglecting the interaction, "
        "together with that of spherical asperities cut out by a plane.",
        COMPUTED,
    )
    section.add(figures.coupling_curves(results), "Left: one surface. Right: all surfaces.", wide=True)
    lines = []
    loads = sorted({number(row["load_nN"]) for row in rows})
    for prefactor, label in (("hertz", "4/3 (Hertz)"), ("paper", "2/3 (paper)")):
        for load in loads:
            part = [row for row in rows if row["prefactor"] == prefactor and number(row["load_nN"]) == load]
            shift = column(part, "separation_nm") - column(part, "separation_coupled_nm")
            area = column(part, "contact_area_nm2") / column(part, "contact_area_coupled_nm2")
            lines.append((label, show(load), *map(_spread, (shift, column(part, "force_ratio"), area))))
    header = ("p of eq. 3", "force (nN)", "separation error (nm)", "force ratio", "contact area ratio")
    section.blocks.append(
        Table("Single asperities against the half-space (mean ± deviation over surfaces)", header, lines, heads=2)
    )
    section.notes.append(
        "Separation error: at equal force. Force ratio: at equal separation; above 1, single asperities are too stiff. "
        "Both models are elastic: the yield limit, which carries most of the load in the plastic model, is in neither."
    )
    if not all(row["solved"] == "True" for row in rows):
        section.notes.append("Some solutions of the half-space did not reach their tolerance: see column solved.")
    section.files.append("coupling/comparison.csv")
    return section


def _shakedown(rows: list[Row]) -> str:
    """How much less energy the last cycle loses than the first."""
    by_cycle = {
        n: column([row for row in rows if int(row["cycle"]) == n], "dissipated_nN_nm").mean() for n in _ends(rows)
    }
    first, last = by_cycle[min(by_cycle)], by_cycle[max(by_cycle)]
    if len(by_cycle) < 2 or not np.isfinite(first) or first <= 0:
        return ""
    return f"The last cycle loses {show(100 * max(last, 0.0) / first, 2)} % of the energy that the first one lost."


def _ends(rows: list[Row]) -> set[int]:
    numbers = [int(row["cycle"]) for row in rows]
    return {min(numbers), max(numbers)}


def _spread(values: np.ndarray) -> str:
    known = values[np.isfinite(values)]
    if not known.size:
        return "–"
    return f"{show(known.mean())} ± {show(known.std(ddof=1) if known.size > 1 else 0.0, 2)}"
