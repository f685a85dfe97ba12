"""Finished scenes as the studies of pads take them."""

from pathlib import Path
from types import SimpleNamespace

from mesoscale.answer.switches import PadModel
from workflow.run.contact_settings import contact_settings
from workflow.run.pads import ScenePoints, load_model, points_of
from workflow.scene import load_scene


def finished(folder: Path) -> tuple[ScenePoints, PadModel]:
    """Points and pads of a finished scene, which its folder is named after."""
    scene, described = load_scene(folder.name), folder / "topography" / "parameters.json"
    found = SimpleNamespace(input={"topography": described} if described.exists() else {})
    contact = contact_settings(scene.contact.model_dump(mode="json"), found)
    points = points_of(str(folder / "pad" / "inputs.csv"), contact, scene.device, scene.pad.points)
    return points, load_model([str(folder / "pad" / "model.h5")], points)
