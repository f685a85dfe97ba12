"""Scene `paper` as the settings of mesoscale, read without the workflow."""

import json
from pathlib import Path

import yaml

from mesoscale.settings import ContactSettings, InputsSettings, LawSettings

_SCENE = yaml.safe_load((Path(__file__).parents[2] / "config" / "scenes" / "paper.yaml").read_text(encoding="utf-8"))
INPUTS = InputsSettings.model_validate_json(json.dumps(_SCENE["inputs"]))  # JSON: a list may fill a tuple
CONTACT = ContactSettings.model_validate_json(json.dumps(_SCENE["contact"]))
LAW = LawSettings.model_validate_json(json.dumps(_SCENE["law"]))
