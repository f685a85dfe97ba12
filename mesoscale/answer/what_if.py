"""Other devices on the pads that a scene has pressed: the answer without pressing again.

A pad depends on its device by how deep it is closed alone. Its curves hold for another device; one
that presses harder has them continued.
"""

from dataclasses import replace

from mesoscale.answer.points import Design, Point
from mesoscale.answer.switches import PadModel, Solved, solved_without_error


def with_device(model: PadModel, central: Point, design: Design) -> PadModel:
    """The model with the switches of another device on its pads.

    Errors by the number of cells are left out: they hardly differ from those of the model.

    Parameters
    ----------
    central, design : points of the other device; all else as in the model.
    """
    points = [
        _solved_again(before, point)
        for before, point in zip(model.points, design.points, strict=True)
    ]
    return PadModel(_solved_again(model.central, central), design, tuple(points))


def _solved_again(before: Solved, point: Point) -> Solved:
    """The switch of a point on the pad of another; without a pad its reason stays."""
    if before.pad is None:
        return replace(before, point=point)
    return solved_without_error(point, before.pad)
