"""Base of all settings of the mesoscale stages."""

import difflib
from typing import TYPE_CHECKING, Any

from pydantic import BaseModel, ConfigDict, ValidationError

from mesoscale.errors import InputError


class _OneLine(type(BaseModel)):
    """Calling a class of settings from Python gives one line for all its mistakes; scenes are explained elsewhere."""

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
    close = difflib.get_close_matches(str(error["loc"][0]), kind.model_fields, n=1)
    return f"unknown key{f'; did you mean {close[0]}?' if close else ''} (accepted: {', '.join(kind.model_fields)})"


def _shown(value: Any) -> str:
    text = " ".join(repr(value).split())
    return text if len(text) <= 60 else text[:57] + "..."


class Settings(BaseModel, metaclass=_OneLine):
    """Base of all settings: unknown keys, infinities and NaN are refused; instances are frozen."""

    model_config = ConfigDict(extra="forbid", frozen=True, allow_inf_nan=False)

    @classmethod
    def __pydantic_init_subclass__(cls, **kwargs: Any) -> None:
        """Add the keys with unit and default to the docstring, where `help()` shows them."""
        super().__pydantic_init_subclass__(**kwargs)
        lines = []
        for name, field in cls.model_fields.items():
            extra = field.json_schema_extra
            unit = extra.get("unit") if isinstance(extra, dict) else None
            value = field.get_default(call_default_factory=True)
            default = type(value).__name__ if isinstance(value, BaseModel) else _shown(value)
            head = f"{name} : {'required' if field.is_required() else f'default {default}'}"
            lines += [head if unit is None else f"{head}, {unit}", f"    {field.description or ''}".rstrip()]
        if lines:
            cls.__doc__ = "\n".join([(cls.__doc__ or "").strip(), "", "Parameters", "----------", *lines])
