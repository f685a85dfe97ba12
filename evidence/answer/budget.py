"""Does what the interval holds add up to its width, and what does the budget in volts cost?

Of finished scenes: what the interval holds, added in quadrature, beside the 5 to 95 % of the
answer; processor time of the switch on its pads and of the budget. With `--press` all pads are
pressed again, which is the rest of the answer.
"""

from argparse import ArgumentParser, Namespace
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from time import process_time
from typing import Any

import numpy as np

from asperity.guards.foreign_yaml import load_mapping
from evidence.record import ROOT
from evidence.scenes import finished
from mesoscale.answer.budget import budget, effects_of
from mesoscale.answer.release import switch_on_pad
from mesoscale.answer.switches import solve_point, solve_points, surfaces_of
from workflow.scene import load_scene


def arguments(parser: ArgumentParser) -> None:
    """Finished scenes."""
    parser.add_argument("results", nargs="+", type=Path)
    parser.add_argument("--press", action="store_true")


def rows(given: Namespace) -> Iterator[dict[str, Any]]:
    """A row for each scene."""
    effects = effects_of(load_mapping(ROOT / "config" / "effects.yaml", "table of effects"))
    for folder in given.results:
        points, model = finished(folder)
        area, pad = points.contact.length_nm**2, load_scene(folder.name).pad
        switch_on_pad(model, area)  # compiles
        times = [process_time()]
        if given.press:
            solve_point(points.by_number[0], points.on_grid, pad.cells, surfaces_of(0))
            asked = [(number, point) for number, point in points.by_number.items() if number]
            assert len([*solve_points(asked, points.on_grid, pad.point_cells)]) == pad.points
        times.append(process_time())
        switch = switch_on_pad(model, area)
        times.append(process_time())
        found = budget(effects, switch, model.central)
        times.append(process_time())
        held = [row["volts"] for row in found if row["held"]]
        low, high = (switch["answer"]["release_V"]["quantiles"][q] for q in ("0.05", "0.95"))
        yield {
            "scene": folder.name,
            "effects": len(found),
            "quadrature_V": float(np.linalg.norm(held)),
            "interval_V": high - low,
            **dict(
                zip(
                    ("press_cpu_s", "switch_cpu_s", "budget_cpu_s"),
                    np.diff(times).tolist(),
                    strict=True,
                )
            ),
        }


def figures(table: Sequence[Mapping[str, str]]) -> dict[str, str]:
    """Of each scene the two widths; where its pads were pressed, the cost of the answer over that
    without budget.
    """
    shown = {}
    for row in table:
        scene, without = row["scene"], float(row["press_cpu_s"]) + float(row["switch_cpu_s"])
        shown[f"{scene}_quadrature"] = f"{float(row['quadrature_V']):.1f} V"
        shown[f"{scene}_interval"] = f"{float(row['interval_V']):.1f} V"
        if float(row["press_cpu_s"]) > 1.0:
            shown[f"{scene}_cost"] = f"{1.0 + float(row['budget_cpu_s']) / without:.2f}"
    return shown
