"""Placeholders in the sources of the components, such as ``{{version}}``, and their values."""

from __future__ import annotations

import math
import re
from typing import Any

from ..._version import __version__
from ...errors import FileError
from ...fabrication import MATERIALS
from ...io.formats import listed
from ...model.result import STATUSES
from ...solvers import Option
from ...solvers.registry import METHODS
from ...solvers.registry import method_names
from ...solvers.registry import options
from ...solvers.registry import owners

__all__ = ["filled", "option_text", "placeholders"]

PLACEHOLDER = re.compile(r"\{\{([\w.]+)\}\}")
DEFAULT = re.compile(r" None: (.+?)\.(?= |$)")


def placeholders() -> dict[str, str]:
    """Return the text for every placeholder."""
    return {
        "version": __version__,
        "methods": listed(map(repr, method_names())),
        "materials": listed(MATERIALS),
        "statuses": ", ".join(STATUSES),
        "suffixes": listed(),
        **{f"options.{name}": option_text(own) for name, own in options().items()},
    }


def filled(source: Any) -> Any:
    """Return a string, or nested lists and dictionaries of strings, with all placeholders replaced.

    Raises
    ------
    FileError
        If a placeholder is unknown.
    """
    if isinstance(source, dict):
        return {key: filled(value) for key, value in source.items()}
    if isinstance(source, list):
        return [filled(value) for value in source]
    return PLACEHOLDER.sub(_text_of, source) if isinstance(source, str) else source


def option_text(option: Option) -> str:
    """Return the tooltip of an option: description, methods and default."""
    text = DEFAULT.sub("", option.text).strip()
    own = owners(option.name)
    whose = "" if len(own) == len(METHODS) else f" For the method {' and '.join(own)}."
    return f"{text}{whose} Defaults to {_default(option)}."


def _default(option: Option) -> str:
    if option.default is None:
        said = DEFAULT.search(option.text)
        return said.group(1) if said else "the default of the method"
    if isinstance(option.default, float):
        return "infinite" if math.isinf(option.default) else f"{option.default:g}"
    return str(option.default)


def _text_of(match: re.Match[str]) -> str:
    texts = placeholders()
    if match.group(1) not in texts:
        raise FileError(f"unknown placeholder {match.group(0)}; the placeholders are {', '.join(texts)}")
    return texts[match.group(1)]
