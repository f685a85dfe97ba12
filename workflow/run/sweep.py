"""A scene run again for several values of one of its keys: table and picture of the release.

For the command `asperity sweep`. Each value has a scene file of its own, which extends the scene,
and results of its own. Jobs whose inputs are the same are done once (`workflow.run.shared`).
"""

import argparse
import subprocess
import sys
from pathlib import Path
from typing import Any

import yaml

from asperity.guards.foreign_text import shown, wrapped
from asperity.guards.foreign_yaml import MistakenYaml
from asperity.words import SCALAR_KEYS, device_of
from mesoscale.errors import InputError
from workflow.files.results import load_json
from workflow.run.what_if import line_of, numbers_of, write_answers
from workflow.scene import SceneError, load_scene
from workflow.scene.loading import find_scene

TARGET = "answer"


def scenes_of(given: str, word: str) -> dict[str, Path]:
    """Write a scene for each value of a key, and see that each is one.

    Parameters
    ----------
    given : name or file of the scene.
    word : the key with its sections, and the values, such as contact.pixels=128,256. Keys of the
        device need no section, and are written as on the command line.

    Returns
    -------
    The scene files by value.

    Raises
    ------
    InputError : no key and values.
    SceneError : a value that a scene does not accept.
    """
    key, equals, values = word.partition("=")
    if not equals or not all(values.split(",")):
        raise InputError(f"{word}: accepted is a key and its values: contact.pixels=128,256")
    base = load_scene(given)
    if base.pad.points == 0:
        raise InputError(f"{given}: pad.points = 0: a sweep compares intervals; give pad.points")
    parent = given
    if Path(given).suffix:
        parent = str(find_scene(given).resolve())
    contents = {value: _content(key, value) for value in values.split(",")}
    files = {}
    for value, content in contents.items():
        file = Path(f"{base.name}_{key.rpartition('.')[2]}_{value}.yaml")
        head = {"extends": parent, "name": file.stem}
        file.write_text(yaml.safe_dump(head | content, sort_keys=False), encoding="utf-8")
        files[value] = file
    try:
        for file in files.values():
            load_scene(str(file))
    except SceneError:
        for file in files.values():
            file.unlink()
        raise
    return files


def _content(key: str, value: str) -> Any:
    """What a scene says for the value of a key."""
    of_device = key.removeprefix("device.")
    if of_device == "material" or of_device in SCALAR_KEYS:
        return {"device": device_of([f"{of_device}={value}"])}
    content = yaml.safe_load(value)
    for section in reversed(key.split(".")):
        content = {section: content}
    return content


def row_of(key: str, value: str, name: str) -> dict[str, Any]:
    """What the finished run of a scene says, as a row of the table."""
    row = {"device": f"{key}={value}", key: value}
    content = load_json(f"results/{name}/answer/pad_switch.json")
    if content["answer"] is None:
        return row | {"reason": content["answer_status"]}
    return row | numbers_of(content["answer"]) | {"reason": ""}


def main(arguments: list[str] | None = None) -> int:
    """Run the scenes one after the other, and write their table and picture."""
    parser = argparse.ArgumentParser(prog="asperity sweep", description=__doc__)
    parser.add_argument("scene")
    parser.add_argument("values")
    parser.add_argument("--hours", default="")
    chosen = parser.parse_args(arguments)
    key = chosen.values.partition("=")[0]
    rows = []
    try:
        name = load_scene(chosen.scene).name
        files = scenes_of(chosen.scene, chosen.values)
        for value, file in files.items():
            print(wrapped(shown(f"{file}: {key} = {value}")), flush=True)
            command = [sys.executable, "-m", "asperity", "run", str(file), TARGET]
            if chosen.hours:
                command += ["--hours", chosen.hours]
            if status := subprocess.run(command, check=False).returncode:
                print(f"ERROR {file}: see above; what is finished is kept", file=sys.stderr)
                return status
            rows.append(row_of(key, value, file.stem))
            print(wrapped(shown(line_of(rows[-1]))), flush=True)
    except (InputError, MistakenYaml, SceneError, OSError, yaml.YAMLError) as error:
        print(f"ERROR {shown(str(error))}", file=sys.stderr)
        return 1
    except KeyboardInterrupt:
        print("\ninterrupted; what is finished is kept: sweep again", file=sys.stderr)
        return 130
    write_answers(name, [chosen.values], rows)
    return 0


if __name__ == "__main__":
    sys.exit(main())
