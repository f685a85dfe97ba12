"""Contact curves at central inputs: figures 4 and 11."""

from collections.abc import Iterator, Mapping
from typing import Any

import matplotlib
import numpy as np

from mesoscale.law.compact import Law, pressure
from mesoscale.law.parameters import PARAMETERS
from workflow.report.available import CsvRow, Results
from workflow.report.drawing import BLUE, INK, ORANGE, SERIES, SOFT, draw
from workflow.report.numbers import number, show
from workflow.report.page import Block, Figure, stage

MODELS = {
    "elastic": ("elastic", ":"),
    "nonlinear": ("non-linear elastic", "--"),
    "plastic": ("asperity plasticity", "-"),
}


@stage("Curves of one cell at central inputs", "contact/nominal.h5")
def describe(results: Results) -> Iterator[Block]:
    """The picture of the contact, and figures 4 and 11."""
    contact, coupled = results.contact, results.coupled
    yield (
        f"Closing and opening of one surface of {contact['length_nm']:g} nm with"
        f" {contact['pixels']}² grid points."
    )
    yield Figure(
        spots(results),
        "One cell, a square of rough surface, seen from the flat: high is light. Coloured is where"
        " the flat has reached it, by the load at which it did.",
        front=True,
    )
    yield Figure(
        nominal_models(results),
        f"Three models of {'coupled asperities' if coupled else 'the single asperity'}. Elastic"
        " contacts reopen along their closing line; plastic ones do not.",
        "Figure 4",
        front=True,
    )
    yield Figure(
        nominal_loads(results),
        "Closing (solid) and opening (dashed) up to several largest loads; thin lines: the fitted"
        " law.",
        "Figure 11",
        wide=True,
    )


def spots(results: Results) -> str | None:
    """Heights of the surface, and where the flat touches it under rising load."""
    if not results.has("contact/spots.h5"):
        return None
    groups, attributes, _ = results.h5("contact/spots.h5")
    steps = groups["spots"]
    side = float(attributes["length_nm"])
    heights = steps["towards_flat_nm"]
    step = steps["step"]
    load = steps["repulsive_nN"] / 1e3
    shades = matplotlib.colormaps["gray"]((heights - heights.min()) / (np.ptp(heights) or 1.0))
    colors = matplotlib.colormaps["autumn_r"](np.linspace(0.0, 1.0, load.size))
    shades[step >= 0] = colors[step[step >= 0]]

    def plot(axis):
        axis.imshow(
            shades.transpose(1, 0, 2),
            origin="lower",
            extent=(0, side, 0, side),
            interpolation="none",
        )
        for k in sorted({0, load.size // 2, load.size - 1}):
            words = (
                f"{show(load[k])} µN: {steps['asperities'][k]};"
                f" {show(100 * steps['cut_share'][k], 2)} %"
            )
            axis.plot([], [], "s", color=colors[k], label=words)
        axis.set(xlabel="nm")
        axis.grid(False)
        axis.legend(
            title="load: asperities in contact; area reached",
            loc="upper center",
            bbox_to_anchor=(0.5, -0.12),
        )

    return draw(
        "spots", "Heights of the surface and where the flat has reached it", plot, (5.0, 5.2)
    )


def nominal_models(results: Results) -> str | None:
    """Figure 4: the three models of plasticity up to 1e4 nN."""
    groups, attributes, curve_attributes = results.h5("contact/nominal.h5")
    present = [model for model in MODELS if f"{model}/closing" in groups]
    if not present:
        return None
    top = max(float(curve_attributes[model]["max_force_nN"]) for model in present) / 1e3
    deepest = min(float(_total(groups[f"{model}/opening"])[1].min()) for model in present)

    def plot(axis):
        for model in present:
            label, style = MODELS[model]
            for branch, color in (("closing", BLUE), ("opening", ORANGE)):
                separation, force = _total(groups[f"{model}/{branch}"])
                if model == "plastic":
                    axis.plot(separation, force, style, color=color, label=f"{label}, {branch}")
                elif branch == "closing":  # reversible: opening is the same line
                    axis.plot(separation, force, style, color=SOFT, label=label)
        axis.axhline(0, color=SOFT, linewidth=0.8)
        reach = float(curve_attributes[present[-1]]["first_contact_nm"])
        axis.set(xlim=(None, reach + 8), ylim=(min(-0.12 * top, 1.08 * deepest), 1.04 * top))
        axis.set(xlabel="mean separation (nm)", ylabel=_force_on(attributes))
        axis.legend()

    return draw("fig4", "Force against mean separation for three models of plasticity", plot)


def nominal_loads(results: Results) -> str | None:
    """Figure 11: cycles to various largest loads, with the fitted law as thin lines."""
    groups, attributes, curve_attributes = results.h5("contact/nominal.h5")
    loads = sorted({name.split("/")[0] for name in groups if name.startswith("load_")}, key=_load)
    if not loads:
        return None
    area = float(attributes["cell_area_nm2"])
    fits = results.rows("law/nominal.csv")

    def plot(axis, zoom):
        for panel in (axis, zoom):
            for i, load in enumerate(loads):
                color = SERIES[i % len(SERIES)]
                for branch, style in (("closing", "-"), ("opening", "--")):
                    separation, force = _total(groups[f"{load}/{branch}"])
                    label = f"{_load(load) / 1e3:g} µN" if branch == "closing" else None
                    panel.plot(separation, force, style, color=color, label=label, linewidth=1.6)
                    row = _fit_of(fits, load, branch)
                    if row is not None:
                        h = np.linspace(separation.min(), separation.max(), 300)
                        hamaker = number(curve_attributes[load]["hamaker"])
                        fitted = area * _pressure(h, row, hamaker) / 1e3
                        panel.plot(h, fitted, "-", color=INK, linewidth=0.6)
            panel.axhline(0, color=SOFT, linewidth=0.8)
            panel.set(xlabel="mean separation (nm)", ylabel=_force_on(attributes))
        contact = float(curve_attributes[loads[0]]["first_contact_nm"])
        highest = max(_load(load) for load in loads) / 1e3
        deepest = max(-float(_total(groups[f"{load}/opening"])[1].min()) for load in loads)
        near = max(deepest, 0.05 * highest)
        axis.set(xlim=(None, contact + 8), ylim=(-0.06 * highest, 1.03 * highest))
        zoom.set(xlim=(None, contact + 8), ylim=(-1.1 * near, 3.3 * near), title="near zero force")
        axis.set_title("full range")
        axis.legend(title="largest load")

    return draw(
        "fig11",
        "Closing and opening curves up to several largest loads",
        plot,
        (9.4, 4.0),
        columns=2,
    )


def _force_on(attributes: Mapping[str, Any]) -> str:
    """The axis of the force on a cell."""
    return f"force on {float(attributes['cell_area_nm2']) / 1e6:.3g} µm² (µN)"


def _total(curve: dict[str, np.ndarray]) -> tuple[np.ndarray, np.ndarray]:
    """Separation (nm) and total force (µN)."""
    return curve["separation_nm"], (curve["repulsive_nN"] + curve["attractive_nN"]) / 1e3


def _load(name: str) -> float:
    return float(name.removeprefix("load_"))


def _pressure(h: np.ndarray, row: CsvRow, hamaker: float) -> np.ndarray:
    """Total pressure of a fitted row (GPa), eqs 10 to 13."""
    parameters = {name: number(row[name]) for name in PARAMETERS}
    attractive, repulsive = pressure(h, Law(**parameters, hamaker=hamaker))
    return attractive + repulsive


def _fit_of(rows: list[CsvRow], curve: str, branch: str) -> CsvRow | None:
    """The fit of a curve; None where it gave no law."""
    return next(
        (
            row
            for row in rows
            if row["curve"] == curve and row["branch"] == branch and row["C_r_GPa"]
        ),
        None,
    )
