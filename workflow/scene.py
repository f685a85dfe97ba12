"""A scene: the resolved settings of one run, from the documented defaults and a YAML file.

`python -m workflow.scene` rewrites config/config.yaml, which documents every key, and config/scene.schema.json; tests
fail when they drift apart.
"""

import difflib
import json
import os
import time
import types
from collections.abc import Iterable
from pathlib import Path
from typing import Annotated, Any, Literal, Union, get_args, get_origin

from annotated_types import Ge, Gt, Le, Lt, MaxLen, MinLen
from pydantic import BaseModel, Field, ValidationError, model_validator
from pydantic.fields import FieldInfo

from asperity.foreign_text import shown
from asperity.foreign_yaml import MistakenYaml, load_mapping
from atomistic.settings import ElasticSettings, HardnessSettings
from mesoscale.settings import (
    ContactSettings,
    DeviceSettings,
    FailureSettings,
    HistorySettings,
    InputsSettings,
    MeasurementsSettings,
    PadSettings,
    ResistanceSettings,
    Settings,
    TopographySettings,
    UncertaintySettings,
)
from mesoscale.topography.measurements import files_in
from workflow.checksums import CLOCK_S
from workflow.former_keys import FORMER_KEYS

ROOT = Path(__file__).resolve().parent.parent
SCENES = ROOT / "config" / "scenes"
DEFAULTS = ROOT / "config" / "config.yaml"
COMPUTED = ("hardness", "elastic", "topography")
SHOWN = 60  # characters of a value or key in a message
MOST_PARENTS = 10  # scenes that extend each other in a row


class SceneError(Exception):
    """A scene that cannot be used; the message has one line per mistake."""


class ReportSettings(Settings):
    """The page report.html (docs/report.md)."""

    studies: bool = Field(
        default=False,
        description="also run the accuracy and stability studies of all stages and show their tables",
    )


class Scene(Settings):
    """Everything a run depends on."""

    name: str = Field(
        default="reduced",
        pattern=r"^[A-Za-z0-9][A-Za-z0-9_.-]{0,99}$",
        description="name of the scene; results go to results/<name>/ (default: the file's name)",
    )
    extends: str | None = Field(
        default=None,
        description="scene whose keys this one takes where it has none of its own, by name or by path",
    )
    compute: tuple[Literal["hardness", "elastic", "topography"], ...] = Field(
        default=(),
        description="stages to run and report although no input is taken from them",
    )
    tails: tuple[Literal["law", "pad"], ...] = Field(
        default=("law", "pad"),
        min_length=1,
        description="what is made of the inputs: the law of one cell with its uncertainty, as in the paper; the pad of "
        "many cells and the switch on it",
    )
    inputs: InputsSettings = InputsSettings()
    hardness: HardnessSettings = HardnessSettings()
    elastic: ElasticSettings = ElasticSettings()
    topography: TopographySettings = TopographySettings()
    contact: ContactSettings = ContactSettings()
    pad: PadSettings = PadSettings()
    uncertainty: UncertaintySettings = UncertaintySettings()
    device: DeviceSettings = DeviceSettings()
    failure: FailureSettings = FailureSettings()
    resistance: ResistanceSettings = ResistanceSettings()
    history: HistorySettings = HistorySettings()
    measurements: MeasurementsSettings = MeasurementsSettings()
    report: ReportSettings = ReportSettings()

    def stages(self) -> set[str]:
        """The stages among hardness, elastic and topography that this scene computes."""
        return (set(self.inputs.origins()) & set(COMPUTED)) | set(self.compute)

    @property
    def cell_follows_film(self) -> bool:
        """Is the side of a cell chosen with the description of measured scans: does the scene not state it?"""
        return bool(self.topography.scans) and "length_nm" not in self.contact.model_fields_set

    @property
    def humid(self) -> bool:
        """Can liquid condense: is there a humidity as an input, or in the air?"""
        return "humidity" in self.inputs.rows() or bool(self.contact.air and self.contact.air.humidity)

    @property
    def unequal_places(self) -> bool:
        """Do the places of the film have RMS heights of their own, by topography or by `pad.rms_scatter`?"""
        return self.pad.rms_scatter is not None or self.inputs.prior_origins().get("rms") == "topography"

    @model_validator(mode="after")
    def _measurements_for_a_calibration(self) -> "Scene":
        if "calibration" in self.inputs.origins() and not self.measurements.tables:
            names = [name for name, row in self.inputs.rows().items() if row.origin == "calibration"]
            raise ValueError(
                f"inputs: {', '.join(names)} of origin calibration, but measurements.tables is empty; name the tables "
                "of measurements, or take another origin"
            )
        return self

    @model_validator(mode="after")
    def _cutoff_on_the_grid(self) -> "Scene":
        resolved = self.contact.nyquist_per_nm
        wanted = {"contact.q1_per_nm": self.contact.q1_per_nm}
        row = self.inputs.rows().get("q1")
        if row is not None and row.origin == "literature":
            wanted["inputs.q1"] = row.reaches
        for key, q1 in wanted.items():
            if q1 is not None and q1 > resolved * (1 + 1e-9):
                raise ValueError(
                    f"{key} reaches {q1:g} 1/nm: beyond what contact.pixels = {self.contact.pixels} on "
                    f"{self.contact.length_nm:g} nm resolve, {resolved:.4g} 1/nm; raise contact.pixels or lower it"
                )
        return self

    @model_validator(mode="after")
    def _metals_conduct(self) -> "Scene":
        if self.resistance.resistivities_nOhm_m is None:
            return self
        if self.device.dielectric_nm > 0:
            raise ValueError(
                f"device.dielectric_nm = {self.device.dielectric_nm:g} with resistance.resistivities_nOhm_m: no "
                "current passes a dielectric; set one to 0, or the other to null"
            )
        if self.contact.mechanics != "coupled" or self.contact.bodies:
            raise ValueError(
                f"contact.mechanics = {self.contact.mechanics}{', contact.bodies' if self.contact.bodies else ''} with "
                "resistance.resistivities_nOhm_m: stiffness gives the resistance of mechanics: coupled without bodies"
            )
        return self

    @model_validator(mode="after")
    def _one_exponent_convention(self) -> "Scene":
        if "topography" in self.inputs.origins() and self.topography.convention != self.contact.reading.convention:
            raise ValueError(
                f"topography.convention = {self.topography.convention}, contact.reading.convention = "
                f"{self.contact.reading.convention}: a Hurst exponent measured by one convention must be used by the "
                "same; make them equal"
            )
        return self


def load_scene(name_or_path: str) -> Scene:
    """Read and validate a scene by name (config/scenes/<name>.yaml) or by the path of a YAML file.

    Raises
    ------
    SceneError : the scene is missing, unreadable or has a mistake; one line per mistake, each naming file,
        key, value and what is accepted.
    """
    path, *parents = _lineage(str(name_or_path))
    content: dict[str, Any] = {}
    for file in reversed([path, *parents]):
        stated = _content_of(file)
        content = _merged(content, stated) | {"name": stated.get("name", file.stem)}
    if str(content["name"]) in _shipped() and path.resolve().parent != SCENES:
        raise SceneError(
            f"{path}: name = {content['name']}: the name of a shipped scene, whose results it would take; "
            "choose another (key `name`, or the name of the file)"
        )
    try:
        # JSON mode: strict types, yet a YAML list may fill a tuple
        return Scene.model_validate_json(json.dumps(content), strict=True)
    except ValidationError as error:
        lines = [_explain(path, item) for item in error.errors()]
        raise SceneError("\n".join(dict.fromkeys(lines))) from None


def _content_of(path: Path) -> dict[str, Any]:
    """The keys of a scene's own file."""
    if not str(path).isprintable():
        raise SceneError(f"{shown(str(path))}: characters that do not print; rename the file or its folder")
    try:
        return load_mapping(path, "scene")
    except MistakenYaml as error:
        raise SceneError(f"{path}: {error}") from None


def _lineage(name_or_path: str) -> list[Path]:
    """The file of a scene, that of the scene it extends, and so on.

    Raises
    ------
    SceneError : one of them is missing or unreadable, or extends itself.
    """
    files = [find_scene(name_or_path)]
    while parent := _content_of(files[-1]).get("extends"):
        child = files[-1]
        if not isinstance(parent, str):
            raise SceneError(f"{child}: extends = {_cut(json.dumps(parent))}: accepted is the name or path of a scene")
        beside = child.parent / parent
        try:
            files.append(beside if Path(parent).suffix and os.path.isfile(beside) else find_scene(parent))
        except SceneError as error:
            raise SceneError(f"{child}: extends: {error}") from None
        if files[-1].resolve() in [file.resolve() for file in files[:-1]]:
            raise SceneError(f"{child}: extends = {_cut(parent)}: this scene extends itself; name another or delete it")
        if len(files) > MOST_PARENTS:
            raise SceneError(f"{child}: extends = {_cut(parent)}: more than {MOST_PARENTS} scenes extend each other")
    return files


def _merged(parent: dict[str, Any], child: dict[str, Any]) -> dict[str, Any]:
    """The keys of a scene over those of the scene it extends; lists and the rows of `inputs` are replaced whole."""
    merged = dict(parent)
    for key, value in child.items():
        former = parent.get(key)
        if isinstance(former, dict) and isinstance(value, dict) and "origin" not in former:
            value = _merged(former, value)
        merged[key] = value
    return merged


def find_scene(name_or_path: str) -> Path:
    """The file of a scene that is given by name or by path.

    Raises
    ------
    SceneError : there is none.
    """
    path = Path(name_or_path)
    word = _cut(name_or_path)
    if path.suffix in {".yaml", ".yml"} or len(path.parts) > 1:
        if not os.path.isfile(path):  # unlike Path.is_file, False for a name that is too long
            raise SceneError(f"scene={word}: no such file; give the path of a YAML file or a scene's name")
        return path
    known = _shipped()
    if name_or_path not in known:
        raise SceneError(f"scene={word}: unknown scene; accepted: {', '.join(known)}, or the path of a YAML file")
    return known[name_or_path]


def _shipped() -> dict[str, Path]:
    return {file.stem: file for file in sorted(SCENES.glob("*.yaml"))}


def locate(scene: str, key: str, names: Iterable[str]) -> list[str]:
    """Paths of files that a scene names: as seen from here, else beside the scene.

    Parameters
    ----------
    scene : name or path of the scene
    key : under which it names them

    Raises
    ------
    SceneError : a file is missing or dated in the future, or its path has braces or characters that do not print; one
        line per file.
    """
    files, mistakes = [], []
    beside = _folders_of(scene)
    for name in names:
        places = [name, *(os.path.normpath(folder / name) for folder in beside)]
        path = next((place for place in places if os.path.isfile(place)), None)
        if path is None:
            mistakes.append(f"{scene}: {key} = {_cut(name)}: no such file here or beside the scene; correct the path")
        elif not path.isprintable():
            mistakes.append(f"{scene}: {key} = {shown(path)}: characters that do not print; rename the file")
        elif set(path) & set("{}"):
            mistakes.append(f"{scene}: {key} = {_cut(path)}: braces mean wildcards to Snakemake; rename the file")
        elif os.path.getmtime(path) > time.time() + CLOCK_S:
            mistakes.append(
                f"{scene}: {key} = {_cut(path)}: dated in the future, so that every result of it would seem older; set "
                "its date (touch) or the clock"
            )
        else:
            files.append(path)
    if mistakes:
        raise SceneError("\n".join(mistakes))
    return files


def files_of(scene: str, names: Iterable[str]) -> list[str]:
    """The names that a scene gives, a folder (as seen from here, else beside the scene) replaced by its files.

    Parameters
    ----------
    scene : name or path of the scene
    """
    files: list[str] = []
    for name in names:
        places = [Path(name), *(folder / name for folder in _folders_of(scene))]
        folder = next((place for place in places if os.path.isdir(place)), None)
        files += [name] if folder is None else files_in(folder)
    return files


def _folders_of(scene: str) -> list[Path]:
    """Folders of the files of a scene, which is given by name or by path, and of those that it extends."""
    return [file.parent for file in _lineage(scene)]


def _cut(text: str) -> str:
    text = " ".join(text.split())
    return text if len(text) <= SHOWN else text[: SHOWN - 3] + "..."


def _explain(path: Path, error: Any) -> str:
    """One line for one pydantic error."""
    location = tuple(part for part in error["loc"] if part != "__root__")
    key = ".".join(_cut(str(part)) for part in location)
    if (former := ".".join(part for part in map(str, error["loc"]) if not part.isdigit())) in FORMER_KEYS:
        return f"{path}: {key}: {FORMER_KEYS[former]}"
    if error["type"] == "extra_forbidden":
        owner = _model_at(location[:-1])
        known = list(owner.model_fields) if owner else []
        close = difflib.get_close_matches(str(location[-1]), known, n=1)
        hint = f"; did you mean {close[0]}?" if close else ""
        return f"{path}: {key}: unknown key{hint} (accepted: {', '.join(known)})"
    field = _field_at(location)
    accepted = accepted_values(field) if field else error["msg"]
    value = _cut(json.dumps(error["input"], ensure_ascii=False, default=str))
    if error["type"] == "json_invalid":
        return f"{path}: holds text that is no Unicode (half of a surrogate pair); write the character itself"
    if error["type"] == "value_error":
        return f"{path}: {key + ': ' if key else ''}{error['msg'].removeprefix('Value error, ')}"
    return f"{path}: {key} = {value}: accepted is {accepted}"


def _strip_optional(annotation: Any) -> Any:
    if get_origin(annotation) in (Union, types.UnionType):
        members = [member for member in get_args(annotation) if member is not type(None)]
        if len(members) == 1:
            return members[0]
    return annotation


def _as_model(annotation: Any) -> type[BaseModel] | None:
    annotation = _strip_optional(annotation)
    return annotation if isinstance(annotation, type) and issubclass(annotation, BaseModel) else None


def _field_at(location: tuple[Any, ...]) -> FieldInfo | None:
    """The deepest settings field on the way to `location`."""
    model: type[BaseModel] | None = Scene
    field = None
    for part in location:
        if model is None or part not in model.model_fields:
            return field
        field = model.model_fields[part]
        model = _as_model(field.annotation)
    return field


def _model_at(location: tuple[Any, ...]) -> type[BaseModel] | None:
    if not location:
        return Scene
    field = _field_at(location)
    return _as_model(field.annotation) if field else None


def accepted_values(field: FieldInfo) -> str:
    """What a settings field accepts, in words: type, choices, range, unit."""
    annotation = _strip_optional(field.annotation)
    words = _type_words(annotation)
    extra = field.json_schema_extra
    unit = extra.get("unit") if isinstance(extra, dict) else None
    if unit:
        words += f" in {unit}"
    if bounds := _bounds(field.metadata):
        # bounds of a list stand apart from those of its entries
        words += f"{';' if get_origin(annotation) in (tuple, list) else ''} {bounds}"
    if annotation is str:
        words = words.replace(" entries", " characters")
    if annotation is not field.annotation:
        words += ", or null"
    return words


def _bounds(metadata: Iterable[Any]) -> str:
    bounds = []
    for item in metadata:
        for kind, sign in ((Ge, ">="), (Gt, ">"), (Le, "<="), (Lt, "<")):
            if isinstance(item, kind):
                bounds.append(f"{sign} {getattr(item, kind.__name__.lower()):g}")
        if isinstance(item, MinLen):
            bounds.append(f"at least {item.min_length} entries")
        if isinstance(item, MaxLen):
            bounds.append(f"at most {item.max_length} entries")
        if pattern := getattr(item, "pattern", None):
            bounds.append(f"of the form {pattern}")
    return ", ".join(bounds)


def _type_words(annotation: Any) -> str:
    origin = get_origin(annotation)
    if origin is Annotated:
        inner, *extras = get_args(annotation)
        return f"{_type_words(inner)} {_bounds(item for extra in extras for item in extra.metadata)}"
    if origin is Literal:
        return "one of " + ", ".join(str(choice) for choice in get_args(annotation))
    if origin in (tuple, list):
        return "a list; each entry " + _type_words(get_args(annotation)[0])
    if origin in (Union, types.UnionType):
        return " or ".join(_type_words(member) for member in get_args(annotation))
    names = {int: "an integer", float: "a number", str: "text", bool: "true or false", type(None): "null"}
    return names.get(annotation, "a mapping")


def value_in_json(model: BaseModel, name: str) -> str:
    """The value of a field as a scene may state it: JSON is valid YAML."""
    return json.dumps(json.loads(model.model_dump_json(include={name}))[name], ensure_ascii=False)


def documented_defaults() -> str:
    """The text of config/config.yaml: every key with its description, what it accepts and its default."""
    head = (
        "# Every key of a scene, with its default (scene `reduced`). A scene in config/scenes/, or a file of\n"
        "# your own, states only what differs. Generated by `python -m workflow.scene` from the settings\n"
        "# classes in atomistic/settings/, mesoscale/settings/ and workflow/scene.py: edit those.\n"
    )
    return head + "\n".join(_document(Scene(), 0, set())) + "\n"


def _document(model: BaseModel, depth: int, explained: set[type[BaseModel]]) -> list[str]:
    """Lines of YAML for `model`; the keys of a class are explained where it stands first."""
    indent = "  " * depth
    lines = []
    known = type(model) in explained
    explained.add(type(model))
    for name, field in type(model).model_fields.items():
        value = getattr(model, name)
        if isinstance(value, BaseModel):
            if depth == 0:
                lines.append("")
            if not known:
                lines.append(f"{indent}# {field.description or (type(value).__doc__ or '').strip().splitlines()[0]}")
            body = _document(value, depth + 1, explained)
            lines += [f"{indent}{name}:" if body else f"{indent}{name}: {{}}", *body]
            continue
        if not known:
            lines.append(f"{indent}# {field.description} ({accepted_values(field)})")
        lines.append(f"{indent}{name}: {value_in_json(model, name)}")
    return lines


if __name__ == "__main__":
    from workflow.scene_schema import SCHEMA, scene_schema

    DEFAULTS.write_text(documented_defaults(), encoding="utf-8")
    SCHEMA.write_text(scene_schema(), encoding="utf-8")
