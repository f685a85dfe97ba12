"""pad/model.h5 and the files of its parts: the pads that were pressed, and the switches on them."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import asdict
from typing import Any

import numpy as np

from mesoscale.answer.points import (
    Design,
    Point,
    central_point,
    cutoff_range,
    on_pad_grid,
    plan_points,
)
from mesoscale.answer.switches import PadModel, Solved, press_pad, surfaces_of
from mesoscale.failure.population import Population
from mesoscale.inputs.distributions import InputTable
from mesoscale.inputs.table import film_table, from_rows
from mesoscale.pad.curves import Flats
from mesoscale.pad.grid import PadGrid
from mesoscale.pad.pressed import Pad
from mesoscale.settings import ContactSettings, DeviceSettings, FailureSettings, PadSettings
from mesoscale.switch import States
from workflow.files.results import Dataset, load_csv, load_h5, load_json, write_h5
from workflow.run.contact_settings import contact_settings
from workflow.run.job import settings_from_job
from workflow.schemas import UnfitTable

STATES = ("pull_in_V", "release_V", "capacitance_fF", "deepened")
CURVES = {
    "separation_nm": ("nm", "separation, falling", ("separation",)),
    "depth": ("1", "position in separation_nm from which the pad is opened", ("depth",)),
    "weight": ("1", "share of each cell in the pad", ("cell",)),
    "rms_ratio": ("1", "RMS height of each cell's place over the median place's", ("cell",)),
    "first_contact_nm": ("nm", "first contact", ("cell",)),
    "settled": ("1", "whether flow came to rest", ("cell",)),
    "closing_GPa": (
        "GPa",
        "repulsive and attractive pressure while closing",
        ("cell", "force", "separation"),
    ),
    "opening_GPa": (
        "GPa",
        "the same while opening from each depth; not a number below it",
        ("cell", "depth", "force", "separation"),
    ),
}


def write_solved(
    path: str,
    solved: Mapping[int, Solved],
    provenance: Mapping[str, Any],
    design: Design | None = None,
) -> None:
    """Write switches by their numbers, a group each; with the design, everything that was computed
    of the pad.
    """
    groups: dict[str, dict[str, Dataset]] = {}
    attributes: dict[str, dict[str, Any]] = {}
    for number, solved_point in solved.items():
        name = f"point_{number:04d}"
        groups[name] = {}
        if solved_point.pad is not None:
            groups[name] = _curves(solved_point.pad)
        attributes[name] = _stated(solved_point)
    if design is not None:
        drawn = Dataset(
            design.probability, "1", "probability of what is drawn, by `drawn`", ("point", "drawn")
        )
        groups["design"] = {"probability": drawn}
        attributes["design"] = {"drawn": list(design.names), "varies": list(design.varies)}
    write_h5(path, groups, {}, provenance, attributes)


def _stated(solved: Solved) -> dict[str, Any]:
    """What a file states of a switch beside the curves of its pad."""
    stated: dict[str, Any] = {}
    if solved.states is not None:
        stated |= solved.states.numbers
    stated |= {
        "halves_V": solved.halves_V,
        "refused": solved.refused,
        "inputs": solved.point.values,
        "gap_cutoff_nm": solved.point.gap_cutoff_nm,
        "device": solved.point.device.model_dump(mode="json", exclude={"spread"}),
    }
    if solved.pad is not None:
        stated |= asdict(solved.pad.flats)
    return stated


def _curves(pad: Pad) -> dict[str, Dataset]:
    values = {
        "separation_nm": pad.grid.separation_nm,
        "depth": pad.grid.depths,
        "weight": pad.weight,
        "rms_ratio": pad.rms_ratio,
        "first_contact_nm": pad.first_contact_nm,
        "settled": pad.settled.astype(int),
        "closing_GPa": pad.closing,
        "opening_GPa": pad.opening,
    }
    return {name: Dataset(values[name], *described) for name, described in CURVES.items()}


class ScenePoints:
    """All points of a scene by their numbers, of which 0 is the central one.

    Attributes
    ----------
    on_grid : the contact on the grid of the pads.
    """

    def __init__(
        self, table: InputTable, contact: ContactSettings, device: DeviceSettings, count: int
    ):
        self.table, self.contact, self.device = table, contact, device
        self.on_grid = on_pad_grid(contact, table)
        self.cutoffs_nm = cutoff_range(table, contact)
        self.design = plan_points(table, contact, device, count)
        self.by_number = dict(
            enumerate((central_point(table, contact, device), *self.design.points))
        )


def points_of(
    inputs: str, contact: ContactSettings, device: DeviceSettings, count: int
) -> ScenePoints:
    """So many points and the central one, from pad/inputs.csv."""
    return ScenePoints(from_rows(load_csv(inputs)), contact, device, count)


def points_of_job(snakemake: Any) -> tuple[ScenePoints, PadSettings]:
    """The points of a job that has the inputs of a cell, and sections `contact`, `device` and `pad`
    of its scene.
    """
    contact = contact_settings(snakemake.params.contact, snakemake)
    device = settings_from_job(DeviceSettings, snakemake.params.device)
    pad = settings_from_job(PadSettings, snakemake.params.pad)
    if measured := snakemake.input.get("measured"):
        from workflow.run.measured_device import remember_measured  # compiles

        remember_measured(measured, device)
    path = snakemake.input.get("topography")
    film = load_json(path)["film"] if path else {}
    table = film_table(from_rows(load_csv(snakemake.input.inputs)), film, pad.rms_scatter)
    return ScenePoints(table, contact, device, pad.points), pad


class UnfitModel(UnfitTable):
    """A file of pads that no run wrote so; the message is one line."""


def _check(where: str, fits: bool | np.bool_, what: str) -> None:
    if not fits:
        raise UnfitModel(f"{where}: {what}; delete the file and run again")


def _check_solved(where: str, stated: Mapping[str, Any]) -> None:
    """See that a point has either a reason or all states, each in its range.

    Raises
    ------
    UnfitModel
    """
    for name in ("halves_V", "refused"):
        _check(where, name in stated, f"no attribute {name}")
    halves = np.asarray(stated["halves_V"])
    _check(
        where,
        halves.shape == (2,) and halves.dtype.kind == "f" and not (halves < 0.0).any(),
        "halves_V: no two V",
    )
    _check(where, isinstance(stated["refused"], str), "refused: no text")
    for name in STATES:
        if stated["refused"]:
            _check(where, name not in stated, f"{name} of a point without an answer")
            continue
        value = np.asarray(stated.get(name, np.nan))
        number = (
            value.shape == ()
            and value.dtype.kind in "fiu"
            and np.isfinite(value)
            and 0.0 <= value <= 1e9
        )
        _check(
            where,
            bool(number),
            f"{name} = {stated.get(name)!r:.40}: accepted is a number from 0 on",
        )


def _check_curves(where: str, stated: Mapping[str, Any], curves: Mapping[str, np.ndarray]) -> None:
    """See that the curves of a pad have the shapes and ranges in which they are written.

    Raises
    ------
    UnfitModel
    """
    for name in CURVES:
        _check(
            where,
            name in curves and np.asarray(curves[name]).dtype.kind in "fiu",
            f"no numbers {name}",
        )
    sizes = {"force": 2}
    for name, (_, _, dims) in CURVES.items():
        shape = curves[name].shape
        _check(where, len(shape) == len(dims), f"{name}: {len(shape)} dimensions for {len(dims)}")
        for dim, size in zip(dims, shape, strict=True):
            _check(
                where,
                size == sizes.setdefault(dim, size) and size > 0,
                f"{name}: {size} along {dim}",
            )
    separation = curves["separation_nm"]
    depth = curves["depth"]
    finite = [np.isfinite(curves[name]).all() for name in CURVES if name != "opening_GPa"]
    _check(
        where,
        all(finite) and not np.isinf(curves["opening_GPa"]).any(),
        "values that are not finite",
    )
    _check(
        where,
        separation.size > 1 and (np.diff(separation) < 0.0).all(),
        "separation_nm does not fall",
    )
    places = (
        depth.dtype.kind in "iu"
        and (np.diff(depth) > 0).all()
        and depth[0] >= 0
        and depth[-1] < separation.size
    )
    _check(where, bool(places), "depth: no rising positions in separation_nm")
    weight = curves["weight"]
    _check(
        where, (weight >= 0.0).all() and abs(weight.sum() - 1.0) < 1e-6, "weight: no shares of 1"
    )
    _check(where, (curves["rms_ratio"] > 0.0).all(), "rms_ratio: not positive")
    for name in ("closing_GPa", "opening_GPa"):
        repulsive, attractive = np.moveaxis(curves[name], -2, 0)
        nothing = 1e-9 * np.nanmax(np.abs(curves[name]))
        signs = not (repulsive < -nothing).any() and not (attractive > nothing).any()
        _check(where, signs, f"{name}: repulsion is positive and attraction negative")
    for name in ("hamaker", "offset_nm"):
        value = np.asarray(stated.get(name, np.nan))
        number = (
            value.shape == () and value.dtype.kind in "fiu" and np.isfinite(value) and value >= 0.0
        )
        _check(
            where,
            bool(number),
            f"{name} = {stated.get(name)!r:.40}: accepted is a number from 0 on",
        )


def load_model(paths: Sequence[str], points: ScenePoints) -> PadModel:
    """The pad from pad/model.h5, or from the files of its parts.

    Raises
    ------
    UnfitModel : a file that no run wrote so, or that is of another scene.
    """
    solved = dict(item for path in paths for item in _of_file(path, points.by_number))
    _check(", ".join(paths), 0 in solved, "no central point")
    central = solved.pop(0)
    return PadModel(central, points.design, tuple(solved[number] for number in sorted(solved)))


def _of_file(path: str, points: Mapping[int, Point]) -> Iterator[tuple[int, Solved]]:
    groups, _, attributes = load_h5(path)
    for name, stated in attributes.items():
        if not name.startswith("point_"):
            continue
        where = f"{path}: {name}"
        digits = name.removeprefix("point_")
        is_number = digits.isascii() and digits.isdigit()
        _check(where, is_number and int(digits) in points, "no point of this scene")
        number = int(digits)
        _check_solved(where, stated)
        refused = str(stated["refused"])
        _check(where, name in groups or bool(refused), "no curves")
        pad = None
        if name in groups:
            _check_curves(where, stated, groups[name])
            pad = _pad_in(stated, groups[name])
        states = None
        if not refused:
            states = _states_in(stated)
        first_V, second_V = (float(value) for value in stated["halves_V"])
        yield number, Solved(points[number], pad, states, (first_V, second_V), refused)


def _pad_in(stated: Mapping[str, Any], curves: Mapping[str, np.ndarray]) -> Pad:
    """The pad of a group of a file."""
    return Pad(
        grid=PadGrid(curves["separation_nm"], curves["depth"]),
        weight=curves["weight"],
        rms_ratio=curves["rms_ratio"],
        first_contact_nm=curves["first_contact_nm"],
        closing=curves["closing_GPa"],
        opening=curves["opening_GPa"],
        settled=curves["settled"].astype(bool),
        flats=Flats(float(stated["hamaker"]), float(stated["offset_nm"])),
    )


def _states_in(stated: Mapping[str, Any]) -> States:
    """What a file states that a switch does."""
    pull_in_V, release_V, capacitance_fF, deepened = (float(stated[key]) for key in STATES)
    touches = "touches" in stated  # stated only of a switch that does
    return States(pull_in_V, release_V, capacitance_fF, bool(deepened), touches)


def population_of_job(snakemake: Any) -> tuple[Population, float]:
    """All switches of a job that also has section `failure` of its scene, and the share of them
    that may fail.
    """
    failure_settings = settings_from_job(FailureSettings, snakemake.params.failure)
    assert failure_settings.probability is not None, "rules refuse scenes without it"
    points, pad = points_of_job(snakemake)
    model = load_model([snakemake.input.model], points)

    def press(point: Point, times: int, number: int) -> Pad:
        surfaces = surfaces_of(100_000 + number)  # beyond those of the points of an answer
        return press_pad(point, points.on_grid, times * pad.point_cells, surfaces)

    pads = {k: solved_point.pad for k, solved_point in enumerate(model.points) if solved_point.pad}
    known = points.design.probability[np.array(list(pads), int)], list(pads.values())
    population = Population(
        points.table, points.device, points.cutoffs_nm, failure_settings.release_V, press, known
    )
    return population, failure_settings.probability
