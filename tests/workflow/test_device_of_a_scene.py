"""What a plan says of the device of a scene."""

from workflow.scene.checks import mistakes
from workflow.scene.definition import Scene


def test_a_plan_asks_whether_the_electrode_can_pull_the_beam_down():
    scene = Scene.model_validate({"name": "beside", "device": {"electrode": [0.0, 0.02]}})
    (line,) = mistakes(scene, {})
    assert line.startswith("device: more than 10000 V are needed to pull the beam down")
    assert (
        mistakes(Scene.model_validate({"name": "parts", "device": {"electrode": [0.2, 0.8]}}), {})
        == []
    )
