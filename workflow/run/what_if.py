"""A scene's answer with another device, from the pads that its run has pressed.

For the command `asperity what-if`; as a module it prints a line a device and writes their table and
picture.
"""

import argparse
import csv
import json
import math
import sys
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import asdict
from itertools import product
from pathlib import Path
from typing import Any

from asperity.guards.foreign_text import as_file_name, shown, wrapped
from asperity.words import beam_is_plated, device_of
from mesoscale.answer.release import answer, answered_in_part
from mesoscale.answer.switches import PadModel
from mesoscale.answer.what_if import with_device
from mesoscale.errors import InputError
from mesoscale.settings import DeviceSettings
from mesoscale.settings.definitions import BY_NAME
from mesoscale.settings.device import PLATED_NICKEL
from workflow.report.available import Results, results_in
from workflow.report.numbers import show
from workflow.report.verdict import does, interval_of, volts
from workflow.run.contact_settings import contact_on
from workflow.run.measured_device import remember_measured
from workflow.run.pads import ScenePoints, load_model, points_of
from workflow.scene import SceneError, load_scene
from workflow.schemas import UnfitTable

NUMBERS: tuple[str, ...] = (
    "pull_in_V",
    "release_5_V",
    "release_V",
    "release_95_V",
    "median_error_V",
    "stuck",
    "stuck_low",
    "stuck_high",
    "switches",
    "no_answer",
    "never_close",
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
        if results.has("pad/measured.h5"):
            remember_measured(str(folder / "pad/measured.h5"), scene.device)
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


def what_if(scene: PressedScene, words: Sequence[str]) -> Iterator[dict[str, Any]]:
    """A row for the scene's own device, and one for each combination of the values of its keys.

    Parameters
    ----------
    words : such as gap_um=1,1.5,2 and material=aluminium, as the engineer writes them.

    Returns
    -------
    Rows with `device` in words, the keys with their values, and `NUMBERS`: quantiles of release and
    pull-in, the share that sticks with its interval, how many switches have an answer and how many
    none, and how many press their pad harder than it was computed. Where too many have none, the
    `reason` says so, with what is known all the same.

    Raises
    ------
    InputError : no key of the device, a value that it does not accept, or another kind of switch.
    """
    keys = values_of(words)
    if scene.device.measured and not set(keys) <= {"hold_voltage_V", "release_at"}:
        raise InputError(
            f"{' '.join(words)}: device.measured tells of the device as it is; another one was not"
            " measured"
        )
    known = scene.device.model_dump(mode="json", include=set(keys))
    rows = [({"device": AS_RUN} | known, scene.device)]
    departs = scene.device.spread.youngs_modulus_GPa
    for values in product(*keys.values()):
        of_keys = dict(zip(keys, values, strict=True))
        changes = [f"{key}={value}" for key, value in of_keys.items()]
        changed = device_of(changes)
        stated = scene.device.model_dump() | changed
        if "youngs_modulus_GPa" in changed and departs == PLATED_NICKEL:
            stated["spread"].pop("youngs_modulus_GPa")  # another metal is no plated nickel
        if beam_is_plated(changes):  # the modulus and the scatter that are the defaults
            stated.pop("youngs_modulus_GPa")
            stated["spread"].pop("youngs_modulus_GPa")
        device = DeviceSettings(**stated)
        if device.kind != scene.device.kind:
            raise InputError(
                f"{' '.join(changes)}: another kind of switch; copy the scene, change it and run it"
            )
        rows.append(({"device": " ".join(changes)} | of_keys, device))
    for row, device in rows:
        yield row | _answered(scene.with_device(device))


def values_of(words: Sequence[str]) -> dict[str, list[str]]:
    """Values by key of a device, from words such as gap_um=1,1.5,2.

    Raises
    ------
    InputError : a key of another section, or one that is given twice.
    """
    keys: dict[str, list[str]] = {}
    for word in words:
        key, _, values = word.removeprefix("device.").partition("=")
        if "." in key or key in BY_NAME:
            raise InputError(
                f"{word}: changes what pads are pressed from; change it in a copy of the scene, or"
                " sweep it (asperity sweep)"
            )
        if key in keys:
            raise InputError(f"{word}: {key} is given twice; write {key}=1,2")
        keys[key] = values.split(",")
    return keys


def _answered(model: PadModel) -> dict[str, Any]:
    """The numbers of a row; where too many switches have no answer, what is known all the same."""
    try:
        return numbers_of(asdict(answer(model))) | {"reason": ""}
    except InputError as error:
        known = answered_in_part(model)
        if known is None:
            return {"reason": str(error)}
        low, high = known.stuck
        first, last = (volts(value) for value in known.median_V)
        median = f"median {first}"
        if first != last:
            median = f"median between {first.replace('sticks', 'sticking')} and {last}"
        if known.median_V[1] == math.inf:
            median = "median not known"
        closing = known.solved + known.refused
        return {
            "stuck_low": low,
            "stuck_high": high,
            "switches": known.solved,
            "no_answer": known.refused,
            "reason": (
                f"of the {closing} that close, {low:.0%} to {high:.0%} stick, {median}: {error}"
            ),
        }


def numbers_of(answer: Mapping[str, Any]) -> dict[str, float]:
    """The numbers of a row, but for its reason, from `answer` of pad_switch.json."""
    release_V = answer["release_V"]["quantiles"]
    return {
        "pull_in_V": answer["pull_in_V"]["quantiles"]["0.5"],
        "release_5_V": release_V["0.05"],
        "release_V": release_V["0.5"],
        "release_95_V": release_V["0.95"],
        "median_error_V": answer["quantile_error_V"]["0.5"],
        "stuck": answer["stuck"]["value"],
        "stuck_low": answer["stuck"]["low"],
        "stuck_high": answer["stuck"]["high"],
        "switches": answer["points"],
        "no_answer": len(answer["refused"]),
        "never_close": answer["never_close"]["value"],
        "continued": answer["deepened"],
    }


LEGEND = (
    "medians over the switches of the points; ± is the standard error of the median, by the number"
    " of switches; a switch that sticks counts as the lowest release"
)
"""What the lines mean, said once behind them."""


def line_of(row: dict[str, Any]) -> str:
    """A row in words."""
    if row["reason"]:
        return f"{row['device']}: no interval: {row['reason']}"
    ends = volts(row["release_5_V"]), volts(row["release_95_V"])
    interval = interval_of(*ends).replace("\u00a0", " ")
    words = f"{row['device']}: closes at {show(row['pull_in_V'])} V and {does(row['release_V'])}"
    if row["release_V"]:
        words += f" ± {show(row['median_error_V'], 1)} V"
    closing = row["switches"] + row["no_answer"]
    words += f" {interval}; of {row['switches']} switches"
    if row["never_close"]:
        words += f" that close, {row['stuck']:.0%} stick"
        count = round(closing / (1.0 - row["never_close"]))
        words += f"; {row['never_close']:.0%} of all {count} never close and are left out"
    else:
        words += f" {row['stuck']:.0%} stick"
    if row["no_answer"]:
        words += f"; {row['no_answer']} have no answer"
    if row["continued"]:
        words += f"; {row['continued']} of {row['switches']} press harder than their pads were"
    return words


def write_answers(scene: str, words: Sequence[str], rows: Sequence[dict[str, Any]]) -> None:
    """Write rows as a table and a picture in the working folder, and name both.

    The files are named by the question, so that another question keeps them.

    Parameters
    ----------
    words : the question, such as gap_um=1,1.5,2.
    """
    name = as_file_name("_".join([scene, *words]))
    table = Path(f"{name}.csv")
    keys = [key for key in rows[-1] if key not in ("device", *NUMBERS)]
    with table.open("w", encoding="utf-8", newline="") as stream:
        writer = csv.DictWriter(stream, ("device", *keys, *NUMBERS), restval="")
        writer.writeheader()
        writer.writerows(rows)
    written = [str(table)]
    picture = Path(f"{name}.png")
    varied = [key for key in keys if len({row[key] for row in rows if row["device"] != AS_RUN}) > 1]
    if len(varied) == 1 and _draw(picture, varied[0], rows):
        written.append(str(picture))
    print(f"written: {', '.join(written)}")


def _draw(path: Path, key: str, rows: Sequence[dict[str, Any]]) -> bool:
    """Draw release and pull-in against the values, where these are numbers; says whether."""
    try:
        solved = [
            (float(row[key]), row) for row in rows if row["device"] != AS_RUN and not row["reason"]
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
    axes.set(xlabel=key, ylabel="voltage (V)", ylim=(0.0, None))
    axes.legend()
    figure.savefig(path)
    plt.close(figure)
    return True


def main(arguments: list[str] | None = None) -> int:
    """Print a line a device, and write their table and picture."""
    parser = argparse.ArgumentParser(prog="asperity what-if", description=__doc__)
    parser.add_argument("scene")
    parser.add_argument("changes", nargs="+")
    chosen = parser.parse_args(arguments)
    try:
        scene = PressedScene(chosen.scene)
        rows = []
        for row in what_if(scene, chosen.changes):
            rows.append(row)
            print(wrapped(shown(line_of(row))), flush=True)
        print(wrapped(LEGEND))
        write_answers(scene.name, chosen.changes, rows)
    except (InputError, SceneError, UnfitTable, OSError) as error:
        print(f"ERROR {shown(str(error))}", file=sys.stderr)
        return 1
    except KeyboardInterrupt:
        print("\ninterrupted; the lines above are computed, no table is written", file=sys.stderr)
        return 130
    return 0


if __name__ == "__main__":
    sys.exit(main())
