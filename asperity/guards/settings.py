"""Settings: keys with default, meaning, accepted range and unit in one line each, and the base of
their classes.
"""

import inspect
import re
import types
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeVar, Union, get_args, get_origin

from pydantic import BaseModel, ConfigDict, Field, ValidationError
from pydantic.fields import FieldInfo

from asperity.guards.errors import InputError
from asperity.guards.foreign_text import did_you_mean
from asperity.guards.foreign_yaml import MistakenYaml, load_mapping

_BOUNDS = {"[": "ge", "(": "gt", "]": "le", ")": "lt"}  # the keywords of `pydantic.Field`
_INTERVAL = re.compile(r"([\[(])(\S+), (\S+)([\])])(?: (.+))?")
_ACCEPTED = {
    "greater_than": "above {gt:g}{unit}",
    "greater_than_equal": "{ge:g}{unit} or more",
    "less_than": "below {lt:g}{unit}",
    "less_than_equal": "{le:g}{unit} or less",
    "finite_number": "a finite number",
    "float_type": "a number",
    "float_parsing": "a number",
    "int_type": "a whole number",
    "int_parsing": "a whole number",
    "int_from_float": "a whole number",
    "bool_type": "true or false",
    "bool_parsing": "true or false",
    "string_type": "text",
    "tuple_type": "a list",
    "literal_error": "{expected}",
    "too_short": "{min_length} entries or more, not {actual_length}",
    "too_long": "{max_length} entries or fewer",
    "string_too_short": "text of {min_length} characters or more",
    "string_too_long": "text of {max_length} characters or fewer",
}
"""What is accepted instead, by pydantic's kind of mistake."""


def key(default: Any, meaning: str, accepted: str = "", **field_options: Any) -> Any:
    """A field of a class of settings.

    Parameters
    ----------
    default : its default; ``...``: it must be given.
    meaning : one thought, as the documentation shows it.
    accepted : interval and unit of a quantity, such as ``"(0, 30] nm"`` or ``"[1, inf)"``; a unit
        alone, ``"MPa"``, for a list whose entries have an interval of their own; empty: what the
        type says.
    others : further keywords of `pydantic.Field`, such as `min_length`.
    """
    unit: str | None = accepted
    if match := _INTERVAL.fullmatch(accepted):
        left, low, high, right, unit = match.groups()
        bounds = {_BOUNDS[left]: low, _BOUNDS[right]: high}
        field_options |= {
            bound: _number(end) for bound, end in bounds.items() if not end.endswith("inf")
        }
    if unit:
        field_options["json_schema_extra"] = {"unit": unit}
    return Field(default, description=meaning, **field_options)


def _number(text: str) -> int | float:
    if re.fullmatch(r"-?[0-9_]+", text):
        return int(text)
    return float(text)


class _OneLine(type(BaseModel)):
    """Calling a class of settings from Python gives one line for all its mistakes; scenes are
    explained elsewhere.
    """

    if not TYPE_CHECKING:  # type checkers read the arguments off the fields

        def __call__(cls, /, *arguments, **values):
            try:
                return super().__call__(*arguments, **values)
            except ValidationError as error:
                mistakes = "; ".join(_explained(cls, error.errors()))
                raise InputError(f"{cls.__name__}: {mistakes}") from None


def _explained(kind: type[BaseModel], errors: list[Any]) -> list[str]:
    """Mistakes, each with key, value, and what is accepted in place of it."""
    accepted: dict[str, list[str]] = {}
    for item in _innermost(errors):
        name = _name_of(kind, item)
        words = _accepted(kind, item)
        if item["type"] == "missing":
            name = f"{name} is missing"
            words = "it has no default"
        elif name:
            name = f"{name} = {_shown(item['input'])}"
        accepted.setdefault(name, []).append(words)
    lines = []
    for name, words in accepted.items():
        text = " or ".join([words[0], *(other.removeprefix("accepted is ") for other in words[1:])])
        lines.append(f"{name}: {text}" if name else text)
    return lines


def _innermost(errors: list[Any]) -> list[Any]:
    """Mistakes without those of a list whose entry is the mistake."""
    places = [item["loc"] for item in errors]
    return [
        item
        for item in errors
        if not any(
            len(item["loc"]) < len(at) and at[: len(item["loc"])] == item["loc"] for at in places
        )
    ]


def _accepted(kind: type[BaseModel], item: Any) -> str:
    """What is accepted in place of a value."""
    if suggestion := _suggestion(kind, item):
        return suggestion
    if item["type"] in _ACCEPTED:
        words = _ACCEPTED[item["type"]].format(**item.get("ctx", {}), unit=_unit_of(kind, item))
        return f"accepted is {words}"
    return item["msg"].removeprefix("Value error, ")


def _name_of(kind: type[BaseModel], item: Any) -> str:
    """The key of a mistake; of a value with a choice of types without the type that was tried.

    Pydantic names such types in brackets: ``tuple[...]``.
    """
    place = item["loc"]
    field = kind.model_fields.get(str(place[0])) if place else None
    if field is not None and len(place) == 2 and _has_a_choice(field.annotation):
        place = place[:1]
    return " ".join(".".join(str(part) for part in place if "[" not in str(part)).split())


def _has_a_choice(annotation: Any) -> bool:
    """Whether a value may be of several types, None apart."""
    if get_origin(annotation) not in (Union, types.UnionType):
        return False
    return len([member for member in get_args(annotation) if member is not type(None)]) > 1


def _unit_of(kind: type[BaseModel], item: Any) -> str:
    """The unit of a key of the settings themselves, behind a blank; empty without one."""
    place = item["loc"]
    field = kind.model_fields.get(str(place[0])) if len(place) == 1 else None
    extra = field.json_schema_extra if field else None
    unit = extra.get("unit") if isinstance(extra, dict) else None
    return f" {unit}" if unit else ""


def _suggestion(kind: type[BaseModel], error: Any) -> str:
    """What an unknown key of the settings themselves may have meant; empty for other mistakes."""
    if error["type"] != "extra_forbidden" or len(error["loc"]) > 1:
        return ""
    known = kind.model_fields
    return f"unknown key{did_you_mean(str(error['loc'][0]), known)} (accepted: {', '.join(known)})"


def _shown(value: Any) -> str:
    text = " ".join(repr(value).split())
    if len(text) <= 60:
        return text
    return text[:57] + "..."


class Settings(BaseModel, metaclass=_OneLine):
    """Base of all settings: unknown keys, infinities and NaN are refused; instances are frozen."""

    model_config = ConfigDict(extra="forbid", frozen=True, allow_inf_nan=False)
    if TYPE_CHECKING:  # of frozen models, which checkers do not see

        def __hash__(self) -> int: ...

    @classmethod
    def __pydantic_init_subclass__(cls, **kwargs: Any) -> None:
        """Add the keys with unit and default to the docstring, where `help()` shows them."""
        super().__pydantic_init_subclass__(**kwargs)
        lines = []
        for name, field in cls.model_fields.items():
            extra = field.json_schema_extra
            unit = extra.get("unit") if isinstance(extra, dict) else None
            head = f"{name} : {_default(field)}"
            if unit is not None:
                head = f"{head}, {unit}"
            lines.append(head)
            lines.append(f"    {field.description or ''}".rstrip())
        if lines:
            cls.__doc__ = "\n".join(
                [inspect.cleandoc(cls.__doc__ or ""), "", "Parameters", "----------", *lines]
            )


def _default(field: FieldInfo) -> str:
    """What counts where a key is not given, in words."""
    if field.is_required():
        return "required"
    value = field.get_default(call_default_factory=True)
    if isinstance(value, BaseModel):
        return f"default {type(value).__name__}"
    return f"default {_shown(value)}"


Content = TypeVar("Content", bound=Settings)


def load_settings(kind: type[Content], path: Path, what: str, example: str) -> Content:
    """A data file as settings.

    Parameters
    ----------
    what : what the file is, for messages: material, potential.
    example : a file to look at.

    Raises
    ------
    InputError : unreadable or malformed file, unknown key, missing or non-physical value.
    """
    try:
        return kind.model_validate(load_mapping(path, what))
    except MistakenYaml as error:
        raise InputError(f"{path}: {error}; see {example}") from None
    except ValidationError as error:
        raise InputError(f"{path}: {_explained(kind, error.errors())[0]}") from None
