"""Do shorter steps of separation move the releases of an answer?

Points of a finished scene are pressed again on the same surfaces, with the steps of its pads, with
half and with a quarter of them. Those that release at the lowest voltages come first, since there a
small change of the pull moves the release most. A point that sticks has a release of 0.
"""

from argparse import ArgumentParser, Namespace
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from time import process_time
from typing import Any

import numpy as np

from evidence.scenes import finished
from mesoscale.answer.switches import press_pad, surfaces_of
from mesoscale.pad.grid import usual_step_nm
from mesoscale.switch import release_or_nan_V

SHARES = (1.0, 0.5, 0.25)
NEAR_STICKING = 0.05
"""Release over pull-in, below which a switch counts as near sticking."""


def arguments(parser: ArgumentParser) -> None:
    """Finished scenes, and how many points of each."""
    parser.add_argument("results", nargs="+", type=Path)
    parser.add_argument("--points", type=int, default=12, help="that release lowest")
    parser.add_argument("--others", type=int, default=12, help="of the other points")


def rows(given: Namespace) -> Iterator[dict[str, Any]]:
    """A row for each point and step."""
    for folder in given.results:
        points, model = finished(folder)
        released = [
            (point.states.release_V, number)
            for number, point in enumerate(model.points)
            if point.states is not None and point.states.release_V > 0.0
        ]
        numbers = [number for _, number in sorted(released)]
        for number in numbers[: given.points] + sorted(numbers[given.points :])[: given.others]:
            solved = model.points[number]
            inputs, _ = solved.point.contact_of(points.on_grid)
            for share in SHARES:
                started = process_time()
                pad = press_pad(
                    solved.point,
                    points.on_grid,
                    solved.pressed.count,
                    surfaces_of(number + 1),
                    step_nm=share * usual_step_nm(inputs.rms),
                )
                yield {
                    "scene": folder.name,
                    "point": number,
                    "cells": pad.count,
                    "pull_in_V": solved.states.pull_in_V if solved.states else np.nan,
                    "share_of_step": share,
                    "release_V": release_or_nan_V(solved.point.device, pad.curves),
                    "error_V": solved.error_V,
                    "cpu_s": process_time() - started,
                }


def figures(table: Sequence[Mapping[str, str]]) -> dict[str, str]:
    """Largest and median change from each step to the quarter, near sticking and elsewhere."""
    release = {
        (row["scene"], row["point"], row["share_of_step"]): float(row["release_V"]) for row in table
    }
    found = {}
    for scene in dict.fromkeys(row["scene"] for row in table):
        for near in (True, False):
            numbers = [
                row["point"]
                for row in table
                if row["scene"] == scene
                and float(row["share_of_step"]) == 1.0
                and (float(row["release_V"]) < NEAR_STICKING * float(row["pull_in_V"])) == near
            ]
            for share, words in (("1", "usual"), ("0.5", "half")):
                changes = [
                    release[scene, number, "0.25"] - release[scene, number, share]
                    for number in numbers
                ]
                if changes:
                    name = f"{scene}_{'near' if near else 'other'}_{words}"
                    largest = max(changes, key=abs)
                    found[name] = f"{np.median(changes):+.2f} V, at most {largest:+.2f} V"
    return found
