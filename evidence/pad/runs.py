"""Scenes that a study runs in a folder of their own."""

import os
import subprocess
import sys
import tempfile
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import yaml

from evidence.record import ROOT
from mesoscale.device.points import PadModel
from workflow.run.contact_settings import contact_settings
from workflow.run.pads import Points, load_model, points_of
from workflow.scene import load_scene


@contextmanager
def results_of(scene: str | Mapping[str, Any], target: str, tree: Path = ROOT) -> Iterator[Path]:
    """The results of a shipped scene, by its name, or of one with these keys, up to a target; `tree` is the product."""
    with tempfile.TemporaryDirectory() as folder:
        name = given = scene
        if not isinstance(scene, str):
            name, given = scene["name"], str(Path(folder) / "scene.yaml")
            Path(given).write_text(yaml.safe_dump(dict(scene)), encoding="utf-8")
        command = [sys.executable, "-m", "asperity", "run", "--cores", "1", str(given), target]
        about = os.environ | {"PYTHONPATH": str(tree)}
        subprocess.run(command, check=True, cwd=folder, env=about, stdout=subprocess.DEVNULL)
        yield Path(folder) / "results" / str(name)


def finished(folder: Path) -> tuple[Points, PadModel]:
    """Points and pads of a finished scene, which its folder is named after."""
    scene, described = load_scene(folder.name), folder / "topography" / "parameters.json"
    found = SimpleNamespace(input={"topography": described} if described.exists() else {})
    contact = contact_settings(scene.contact.model_dump(mode="json"), found)
    points = points_of(str(folder / "pad" / "inputs.csv"), contact, scene.device, scene.pad.points)
    return points, load_model([str(folder / "pad" / "model.h5")], points)
