"""Methods and their options as JSON, derived from the registry on every request."""

from __future__ import annotations

import math

from ...solvers.registry import METHODS
from ...solvers.registry import options
from ...solvers.settings import AutoSettings
from ...solvers.settings import Option
from ...solvers.settings import Settings

__all__ = ["methods", "option_schema", "settings_schema"]

AUTO = "Chooses one of the other methods from the problem and the settings, reports the choice, and tries the next when one stalls."
TYPES = {int: "integer", float: "number", bool: "boolean", str: "string"}
BOUNDS = {"minimum": "low", "maximum": "high", "exclusiveMinimum": "above", "exclusiveMaximum": "below"}


def methods() -> list[dict]:
    """Return every method with its description and options, ``auto`` first."""
    own = [_described(method.name, method.text, method.settings) for method in METHODS.values()]
    return [_described("auto", AUTO, AutoSettings), *own]


def _described(name: str, text: str, settings: type[Settings]) -> dict:
    return {"name": name, "text": text, "options": [{"name": own.name, **option_schema(own)} for own in settings.options().values()]}


def option_schema(option: Option) -> dict:
    """Return the JSON schema of an option; null selects the default."""
    schema: dict = {"type": [TYPES[option.kind], "null"], "description": option.text}
    if option.choices:
        schema["enum"] = [*option.choices, None]
    schema.update({name: getattr(option, own) for name, own in BOUNDS.items() if getattr(option, own) is not None})
    if option.default is not None and not (isinstance(option.default, float) and math.isinf(option.default)):
        schema["default"] = option.default
    return schema


def settings_schema() -> dict:
    """Return the JSON schema of the settings: every option of every method, under each of its names."""
    found = {name: option_schema(own) for alias, own in options().items() for name in dict.fromkeys((own.name, alias))}
    return {"type": ["object", "null"], "additionalProperties": False, "properties": found}
