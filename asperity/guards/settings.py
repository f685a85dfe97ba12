"""Settings: keys with default, meaning, accepted range and unit in one line each, and the base of
their classes.
"""

import inspect
import re
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeVar

from pydantic import BaseModel, ConfigDict, Field, ValidationError
from pydantic.fields import FieldInfo

from asperity.guards.errors import InputError
from asperity.guards.foreign_text import did_you_mean
from asperity.guards.foreign_yaml import MistakenYaml, load_mapping

_BOUNDS = {"[": "ge", "(": "gt", "]": "le", ")": "lt"}  # the keywords of `pydantic.Field`
_INTERVAL = re.compile(r"([\[(])(\S+), (\S+)([\])])(?: (.+))?")


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
                mistakes = [
                    f"{'.'.join(map(str, item['loc'])) or 'settings'} = {_shown(item['input'])}: "
                    f"{_suggestion(cls, item) or item['msg']}"
                    for item in error.errors()
                ]
                raise InputError(f"{cls.__name__}: {'; '.join(mistakes)}") from None


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
        first = error.errors()[0]
        where = " ".join(".".join(map(str, first["loc"])).split())
        message = first["msg"].removeprefix("Value error, ")
        if where:
            message = f"{where}: {message}"
        if first["type"] not in ("missing", "value_error"):
            message = f"{message} (got {first['input']!r:.80})"
        raise InputError(f"{path}: {message}") from None
