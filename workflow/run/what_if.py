"""A scene's answer with another device, from the pads that its run has pressed.

For the command `asperity what-if`; as a module it prints a line a device and writes their table and
picture.
"""

import argparse
import csv
import json
import sys
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Any

from asperity.guards.foreign_text import shown, wrapped
from asperity.words import device_of
from mesoscale.answer.release import answer
from mesoscale.answer.switches import PadModel
from mesoscale.answer.what_if import with_device
from mesoscale.errors import InputError
from mesoscale.settings import DeviceSettings
from mesoscale.settings.device import PLATED_NICKEL
from workflow.report.available import Results, results_in
from workflow.report.numbers import show
from workflow.report.verdict import does, interval_of, volts
from workflow.run.contact_settings import contact_on
from workflow.run.pads import ScenePoints, load_model, points_of
from workflow.scene import SceneError, load_scene
from workflow.schemas import UnfitTable

COLUMNS: tuple[str, ...] = (
    "value",
    "pull_in_V",
    "release_5_V",
    "release_V",
    "release_95_V",
    "median_error_V",
    "stuck",
    "switches",
    "no_answer",
    "continued",
    "reason",
)
AS_RUN = "as run"


class PressedScene:
    """The pads of a run, and all that another device on them needs.

    Raises
    ------
    InputError : no pads were pressed, or not by this version.
    """

    def __init__(self, given: str) -> None:
        scene = load_scene(given)
        folder = Path("results") / scene.name
        results = results_in(folder)
        if not results.has("pad/model.h5", "pad/inputs.csv", "inputs.csv"):
            raise InputError(f"{folder}: no pads are pressed; first: asperity run {given} answer")
        self.name = scene.name
        self.device = scene.device
        self.count = scene.pad.points
        described = {}
        if results.uses("topography"):
            described = results.json("topography/parameters.json")
        self._contact = contact_on(scene.contact, described)
        self._inputs = str(folder / "pad/inputs.csv")
        self._model = load_model([str(folder / "pad/model.h5")], self.points_of(self.device))
        _check_unchanged(results, self._model, given)

    def points_of(self, device: DeviceSettings) -> ScenePoints:
        """The points of a device."""
        return points_of(self._inputs, self._contact, device, self.count)

    def with_device(self, device: DeviceSettings) -> PadModel:
        """The switches of another device on the pads."""
        if device == self.device:
            return self._model
        points = self.points_of(device)
        return with_device(self._model, points.by_number[0], points.design)


def _check_unchanged(results: Results, model: PadModel, given: str) -> None:
    """See that the pads are of the scene as it is now.

    Raises
    ------
    InputError
    """
    stated = results.h5("pad/model.h5")[2]["point_0000"]
    device = model.central.point.device.model_dump(mode="json", exclude={"spread"})
    values = model.central.point.values
    if json.loads(stated["device"]) != device or json.loads(stated["inputs"]) != values:
        raise InputError(
            f"{given}: changed since its pads were pressed; first: asperity run {given} answer"
        )


def what_if(scene: PressedScene, word: str) -> Iterator[dict[str, Any]]:
    """A row for the scene's own device, and one for each value of a key of it.

    Parameters
    ----------
    word : such as gap_um=1,1.5,2 or material=aluminium, as the engineer writes it.

    Returns
    -------
    Rows with `COLUMNS`: quantiles of release and pull-in, the share that sticks, how many switches
    have an answer and how many none, and how many press their pad harder than it was computed. A
    value that the answer cannot be had for has a `reason` and no numbers.

    Raises
    ------
    InputError : no key of the device, a value that it does not accept, or another kind of switch.
    """
    name, _, values = word.removeprefix("device.").partition("=")
    if "." in name:
        raise InputError(
            f"{word}: changes what pads are pressed from; copy the scene, change it and run it"
        )
    if scene.device.measured and name not in ("hold_voltage_V", "release_at"):
        raise InputError(
            f"{word}: device.measured tells of the device as it is; another one was not measured"
        )
    devices = {AS_RUN: scene.device}
    departs = scene.device.spread.youngs_modulus_GPa
    for value in values.split(","):
        changes = device_of([f"{name}={value}"])
        stated = scene.device.model_dump() | changes
        if "youngs_modulus_GPa" in changes and departs == PLATED_NICKEL:
            stated["spread"].pop("youngs_modulus_GPa")  # another metal is no plated nickel
        device = DeviceSettings(**stated)
        if device.kind != scene.device.kind:
            raise InputError(
                f"{word}: another kind of switch; copy the scene, change it and run it"
            )
        devices[value] = device
    for value, device in devices.items():
        try:
            numbers = numbers_of(asdict(answer(scene.with_device(device))))
        except InputError as error:
            yield {"value": value, "reason": str(error)}
        else:
            yield {"value": value, **numbers, "reason": ""}


def numbers_of(answer: Mapping[str, Any]) -> dict[str, float]:
    """The columns of a row, but for its value and reason, from `answer` of pad_switch.json."""
    release_V = answer["release_V"]["quantiles"]
    return {
        "pull_in_V": answer["pull_in_V"]["quantiles"]["0.5"],
        "release_5_V": release_V["0.05"],
        "release_V": release_V["0.5"],
        "release_95_V": release_V["0.95"],
        "median_error_V": answer["quantile_error_V"]["0.5"],
        "stuck": answer["stuck"]["value"],
        "switches": answer["points"],
        "no_answer": len(answer["refused"]),
        "continued": answer["deepened"],
    }


def line_of(name: str, row: dict[str, Any]) -> str:
    """A row in words."""
    value = row["value"]
    device = value if value == AS_RUN else f"{name} = {value}"
    if row["reason"]:
        return f"{device}: no answer: {row['reason']}"
    ends = volts(row["release_5_V"]), volts(row["release_95_V"])
    interval = interval_of(*ends).replace("\u00a0", " ")
    words = (
        f"{device}: closes at {show(row['pull_in_V'])} V and {does(row['release_V'])}"
        f" {interval}, {row['stuck']:.0%} stick"
    )
    if row["continued"]:
        words += f"; {row['continued']} of {row['switches']} press harder than their pads were"
    return words


def write_answers(scene: str, key: str, rows: Sequence[dict[str, Any]]) -> None:
    """Write the rows of a key as a table and a picture in the working folder, and name both."""
    table = Path(f"{scene}_{key.rpartition('.')[2]}.csv")
    with table.open("w", encoding="utf-8", newline="") as stream:
        writer = csv.DictWriter(stream, COLUMNS, restval="")
        writer.writeheader()
        writer.writerows(rows)
    written = [str(table)]
    if _draw(table.with_suffix(".png"), key, rows):
        written.append(str(table.with_suffix(".png")))
    print(f"written: {', '.join(written)}")


def _draw(path: Path, name: str, rows: Sequence[dict[str, Any]]) -> bool:
    """Draw release and pull-in against the values, where these are numbers; says whether."""
    try:
        solved = [
            (float(row["value"]), row)
            for row in rows
            if row["value"] != AS_RUN and not row["reason"]
        ]
    except ValueError:
        return False
    if len(solved) < 2:
        return False
    import matplotlib.pyplot as plt

    solved.sort(key=lambda pair: pair[0])
    x = [value for value, _ in solved]
    figure, axes = plt.subplots(figsize=(5.5, 3.8), layout="constrained")
    low, middle, high, pull_in = (
        [row[column] for _, row in solved]
        for column in ("release_5_V", "release_V", "release_95_V", "pull_in_V")
    )
    axes.fill_between(x, low, high, alpha=0.25, label="release, 5 to 95 %")
    axes.plot(x, middle, "o-", label="release, median")
    axes.plot(x, pull_in, "s--", color="0.5", label="pull-in, median")
    axes.set(xlabel=name, ylabel="voltage (V)", ylim=(0.0, None))
    axes.legend()
    figure.savefig(path)
    plt.close(figure)
    return True


def main(arguments: list[str] | None = None) -> int:
    """Print a line a device, and write the table and picture of each key."""
    parser = argparse.ArgumentParser(prog="asperity what-if", description=__doc__)
    parser.add_argument("scene")
    parser.add_argument("changes", nargs="+")
    chosen = parser.parse_args(arguments)
    try:
        scene = PressedScene(chosen.scene)
        for word in chosen.changes:
            name = word.removeprefix("device.").partition("=")[0]
            rows = []
            for row in what_if(scene, word):
                rows.append(row)
                print(wrapped(shown(line_of(name, row))), flush=True)
            write_answers(scene.name, name, rows)
    except (InputError, SceneError, UnfitTable, OSError) as error:
        print(f"ERROR {shown(str(error))}", file=sys.stderr)
        return 1
    except KeyboardInterrupt:
        print("\ninterrupted; the lines above are computed, no table is written", file=sys.stderr)
        return 130
    return 0


if __name__ == "__main__":
    sys.exit(main())
