"""Asperities that feel each other: the model-form error of single ones."""

import numpy as np

from workflow.report.available import Results
from workflow.report.drawing import BLUE, GREEN, ORANGE, SOFT, draw
from workflow.report.numbers import column, number, show
from workflow.report.page import COMPUTED, Section, Table


def describe(results: Results) -> Section | None:
    """Both models side by side."""
    if not results.has("coupling/comparison.csv"):
        return None
    rows = results.csv("coupling/comparison.csv")
    section = Section(
        "coupling",
        "Asperities that feel each other",
        "Elastic contact of the same surfaces twice: each asperity on its own, and coupled through an elastic "
        "half-space (boundary elements). The difference is the model-form error of neglecting the interaction, "
        "together with that of spherical asperities cut out by a plane.",
        COMPUTED,
    )
    section.add(coupling_curves(results), "Left: one surface. Right: all surfaces.", wide=True)
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
        curve.legend()
        area.axhline(1, color=SOFT, linewidth=0.8)
        area.set(xscale="log", xlabel="force on the cell (µN)", ylabel="contact area over the half-space's")
        area.set_ylim(bottom=0)

    label = "Force and contact area of single asperities and of an elastic half-space"
    return draw("coupling", label, plot, (9.4, 3.7), columns=2)


def _spread(values: np.ndarray) -> str:
    known = values[np.isfinite(values)]
    if not known.size:
        return "–"
    return f"{show(known.mean())} ± {show(known.std(ddof=1) if known.size > 1 else 0.0, 2)}"
