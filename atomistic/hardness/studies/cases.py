"""A list of single closing runs, each with what it changes in a scene's settings (config/studies/hardness.yaml)."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import yaml
from pydantic import Field, ValidationError

from atomistic.errors import InputError
from atomistic.settings import AsperitySettings, HardnessSettings, Settings


class Case(Settings):
    """One run: its asperity and the settings it changes."""

    name: str = Field(pattern=r"^[A-Za-z][A-Za-z0-9]*$")
    about: str
    asperity: AsperitySettings | None = None
    changes: dict[str, Any] = Field(default={}, description="settings of `hardness`, nested")


class Study(Settings):
    """Cases, and the asperity of those that name none."""

    base: AsperitySettings
    cases: tuple[Case, ...]

    def settings_of(self, case: Case, scene: HardnessSettings) -> HardnessSettings:
        """Settings that plan exactly this run."""
        single = {"seeds": scene.seeds[:1], "energy_scales": [1.0], "asperities": [case.asperity or self.base]}
        return HardnessSettings.model_validate(_merged({**scene.model_dump(), **single}, case.changes))


def _merged(settings: Mapping[str, Any], changes: Mapping[str, Any]) -> dict[str, Any]:
    result = dict(settings)
    for key, value in changes.items():
        nested = isinstance(value, Mapping) and isinstance(result.get(key), Mapping)
        result[key] = _merged(result[key], value) if nested else value
    return result


def load_study(path: str | Path, scene: HardnessSettings) -> dict[str, tuple[Case, HardnessSettings]]:
    """Cases of a study file by name, each with its settings.

    Raises
    ------
    InputError : unreadable file, a key that does not exist, a value that is not accepted.
    """
    try:
        study = Study.model_validate(yaml.safe_load(Path(path).read_text(encoding="utf-8")))
        return {case.name: (case, study.settings_of(case, scene)) for case in study.cases}
    except (OSError, yaml.YAMLError) as error:
        raise InputError(f"{path}: cannot be read ({' '.join(str(error).split())})") from None
    except ValidationError as error:
        first = error.errors()[0]
        where = ".".join(str(part) for part in first["loc"])
        raise InputError(f"{path}: {where}: {first['msg']} (got {first['input']!r:.80})") from None
