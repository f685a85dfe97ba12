"""`python -m workflow.scene` rewrites config/config.yaml and config/scene.schema.json."""

from workflow.scene.documented import DEFAULTS, SCHEMA, documented_defaults, scene_schema

DEFAULTS.write_text(documented_defaults(), encoding="utf-8")
SCHEMA.write_text(scene_schema(), encoding="utf-8")
