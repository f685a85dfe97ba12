"""What a key of a scene accepts, in words: for messages, for config/config.yaml and for the
documentation.
"""

import types
from collections.abc import Iterable
from typing import Annotated, Any, Literal, Union, get_args, get_origin

from annotated_types import Ge, Gt, Le, Lt, MaxLen, MinLen
from pydantic import BaseModel
from pydantic.fields import FieldInfo

from workflow.scene.definition import Scene


def accepted_values(field: FieldInfo) -> str:
    """What a settings field accepts, in words: type, choices, range, unit."""
    annotation = _strip_optional(field.annotation)
    words = _type_words(annotation)
    extra = field.json_schema_extra
    unit = extra.get("unit") if isinstance(extra, dict) else None
    if unit:
        words += f" in {unit}"
    if bounds := _bounds(field.metadata):
        if get_origin(annotation) in (tuple, list):
            words += ";"  # bounds of a list stand apart from those of its entries
        words += f" {bounds}"
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
        if inner is tuple or get_origin(inner) is tuple:
            return "a value and its standard error, as in 72 +- 2"
        bounds = _bounds(item for extra in extras for item in extra.metadata)
        return f"{_type_words(inner)} {bounds}"
    if origin is Literal:
        return "one of " + ", ".join(str(choice) for choice in get_args(annotation))
    if origin in (tuple, list):
        return "a list; each entry " + _type_words(get_args(annotation)[0])
    if origin in (Union, types.UnionType):
        return " or ".join(_type_words(member) for member in get_args(annotation))
    names = {
        int: "an integer",
        float: "a number",
        str: "text",
        bool: "true or false",
        type(None): "null",
    }
    return names.get(annotation, "a mapping")


def _strip_optional(annotation: Any) -> Any:
    if get_origin(annotation) in (Union, types.UnionType):
        members = [member for member in get_args(annotation) if member is not type(None)]
        if len(members) == 1:
            return members[0]
    return annotation


def _as_model(annotation: Any) -> type[BaseModel] | None:
    annotation = _strip_optional(annotation)
    if isinstance(annotation, type) and issubclass(annotation, BaseModel):
        return annotation
    return None


def _model_of_entries(annotation: Any) -> type[BaseModel] | None:
    """The model of each entry of a list; none where entries are plain values."""
    annotation = _strip_optional(annotation)
    is_list = get_origin(annotation) in (tuple, list)
    return _as_model(get_args(annotation)[0]) if is_list else None


def field_at(location: tuple[Any, ...]) -> FieldInfo | None:
    """The deepest settings field on the way to `location`."""
    return _field_and_model(location)[0]


def model_at(location: tuple[Any, ...]) -> type[BaseModel] | None:
    """The model whose keys stand at `location`; none where a plain value stands."""
    return _field_and_model(location)[1]


def _field_and_model(
    location: tuple[Any, ...],
) -> tuple[FieldInfo | None, type[BaseModel] | None]:
    """The deepest field on the way, and the model that follows it."""
    model: type[BaseModel] | None = Scene
    field = None
    for step in location:
        if isinstance(step, int) and field is not None:
            model = _model_of_entries(field.annotation)
            continue
        if model is None or step not in model.model_fields:
            return field, model
        field = model.model_fields[step]
        model = _as_model(field.annotation)
    return field, model
