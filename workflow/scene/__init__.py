"""A scene: what one run depends on, from the documented defaults and a YAML file."""

from workflow.scene.definition import Scene
from workflow.scene.loading import SCENES, SceneError, files_of, find_scene, load_scene, locate

__all__ = ["SCENES", "Scene", "SceneError", "files_of", "find_scene", "load_scene", "locate"]
