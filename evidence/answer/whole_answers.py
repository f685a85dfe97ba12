"""Does what-if give the interval that a whole run of the other device has?

`asperity what-if` solves the switches of another device on the pads of the scene. Here each of
twelve devices has all its pads pressed anew as well, at the same points and on the same surfaces.
`error_V` is what the answer states for each quantile by the number of its switches. `cpu_s` is the
processor time of what-if, `whole_cpu_s` that of the pads and switches of a whole run.
"""

import time
from argparse import ArgumentParser, Namespace
from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from mesoscale.answer.points import central_point, plan_points
from mesoscale.answer.release import answer
from mesoscale.answer.switches import PadModel, solve_point, solve_points, surfaces_of
from mesoscale.answer.what_if import with_device
from mesoscale.inputs.table import film_table, input_table
from mesoscale.settings import ContactSettings, DeviceSettings, InputRow

OTHERS: list[dict[str, float]] = [
    {"spring_N_per_m": 700.0},
    {"spring_N_per_m": 950.0},
    {"gap_um": 3.1},
    {"gap_um": 3.6},
    {"width_um": 130.0},
    {"width_um": 150.0},
    {"dielectric_nm": 220.0},
    {"dielectric_nm": 260.0},
    {"permittivity": 7.0},
    {"length_um": 540.0},
    {"gap_um": 3.3, "spring_N_per_m": 850.0},
    {"dielectric_nm": 210.0, "width_um": 128.0},
]
"""What differs from the device of the pads."""
PLATE = DeviceSettings(spring_N_per_m=800.0)
CONTACT = ContactSettings(mechanics="asperity", pixels=64, length_nm=500.0, attraction="clamped")
WEAK = InputRow(values=(0.02, 0.06))
"""Hamaker constant (1e-18 J) with which most of these plates let go."""
POINTS, CELLS = 36, 2
ENDS = ("0.05", "0.5", "0.95")


def arguments(parser: ArgumentParser) -> None:
    """None."""


def rows(_: Namespace) -> Iterator[dict[str, Any]]:
    """A row a quantile of a device."""
    pressed = whole(PLATE)[0]
    for changes in OTHERS:
        device = PLATE.model_copy(update=changes)
        anew, whole_cpu_s = whole(device)
        began = time.process_time()
        found = answer(with_device(pressed, anew.central.point, anew.design))
        cpu_s = time.process_time() - began
        wanted = answer(anew)
        for end in ENDS:
            yield {
                "device": " ".join(f"{key}={value:g}" for key, value in changes.items()),
                "quantile": end,
                "release_V": found.release_V["quantiles"][end],
                "whole_V": wanted.release_V["quantiles"][end],
                "error_V": wanted.quantile_error_V[end],
                "stuck": found.stuck["value"],
                "whole_stuck": wanted.stuck["value"],
                "cpu_s": cpu_s,
                "whole_cpu_s": whole_cpu_s,
            }


def whole(device: DeviceSettings) -> tuple[PadModel, float]:
    """All pads and switches of a device, and their processor time (s)."""
    began = time.process_time()
    table = film_table(input_table(hamaker=WEAK), {}, (0.0, 0.1))
    planned = plan_points(table, CONTACT, device, count=POINTS)
    central = solve_point(central_point(table, CONTACT, device), CONTACT, CELLS, surfaces_of(0))
    solved = solve_points(list(enumerate(planned.points, 1)), CONTACT, CELLS)
    return PadModel(central, planned, tuple(solved)), time.process_time() - began


def figures(table: Sequence[Mapping[str, str]]) -> dict[str, str]:
    """How far what-if is from whole runs, against the stated errors, and what both cost.

    Quantiles at which both stick are left out: they agree, and say little.
    """
    free = [row for row in table if float(row["release_V"]) or float(row["whole_V"])]
    apart = [abs(float(row["release_V"]) - float(row["whole_V"])) for row in free]
    errors = [float(row["error_V"]) for row in free]
    within = sum(gap <= error for gap, error in zip(apart, errors, strict=True))
    medians = [row for row in table if row["quantile"] == "0.5"]
    least, most = (end(float(row["cpu_s"]) for row in medians) for end in (min, max))
    whole_s = sum(float(row["whole_cpu_s"]) for row in medians) / len(medians)
    return {
        "devices": str(len(medians)),
        "within": f"{within} of {len(free)}",
        "most_apart": f"{max(apart):.2g} V",
        "least_error": f"{min(errors):.2g} V",
        "most_error": f"{max(errors):.2g} V",
        "cpu": f"{least:.1g} to {most:.1g} s",
        "whole_cpu": f"{whole_s:.0f} s",
    }
