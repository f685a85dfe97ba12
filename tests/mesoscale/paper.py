"""Scene `paper` as the settings of mesoscale, read without the workflow."""

import json
from pathlib import Path

import yaml

from mesoscale.settings import ContactSettings, InputsSettings

_SCENES = Path(__file__).parents[2] / "config" / "scenes"
_TABLE, _SCENE = (
    yaml.safe_load((_SCENES / f"{name}.yaml").read_text(encoding="utf-8"))
    for name in ("table1", "paper")
)
# JSON: a list may fill a tuple
INPUTS = InputsSettings.model_validate_json(json.dumps(_TABLE["inputs"]))
CONTACT = ContactSettings.model_validate_json(json.dumps(_SCENE["contact"]))
