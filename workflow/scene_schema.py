"""The JSON Schema of a scene, by which editors complete keys and mark mistakes.

`python -m workflow.scene` rewrites config/scene.schema.json; a test fails when the two drift apart.
"""

import json
from typing import Any

from workflow.scene import ROOT, Scene

SCHEMA = ROOT / "config" / "scene.schema.json"


def scene_schema() -> str:
    """Text of config/scene.schema.json."""
    schema = Scene.model_json_schema(mode="validation")
    schema = {"$schema": "https://json-schema.org/draft/2020-12/schema", **_first_paragraphs(schema)}
    return json.dumps(schema, indent=1, ensure_ascii=False) + "\n"


def _first_paragraphs(item: Any) -> Any:
    """Descriptions without the lists of keys that docstrings add, which the schema holds anyway."""
    if isinstance(item, dict):
        return {
            key: value.split("\n\n")[0] if key == "description" and isinstance(value, str) else _first_paragraphs(value)
            for key, value in item.items()
        }
    return [_first_paragraphs(entry) for entry in item] if isinstance(item, list) else item
