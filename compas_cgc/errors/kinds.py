"""Checks of values against type hints, and names of types in messages."""

from __future__ import annotations

import builtins
import numbers
import re
import typing
from collections.abc import Callable
from collections.abc import Iterable
from collections.abc import Mapping
from collections.abc import Sized
from contextlib import suppress
from typing import Any
from typing import Literal
from typing import TypeVar
from typing import Union
from typing import get_args
from typing import get_origin

__all__ = ["SHAPE", "fits", "hints_of", "is_array", "kind_of"]

PLAIN: dict[Any, tuple[type, str]] = {
    bool: (bool, "True or False"),
    int: (numbers.Integral, "a whole number"),
    float: (numbers.Real, "a number"),
    complex: (numbers.Number, "a number"),
    str: (str, "a string"),
    bytes: (bytes, "bytes"),
    type(None): (type(None), "None"),
}
SHAPE = re.compile(r"``\(([\w\s,]+)\)``")  # shape in a docstring, with letters for arbitrary sizes


class _Unseen:
    """Base of placeholders for classes that are imported for type checkers only."""


class _Names(dict[str, Any]):
    """Namespace in which type hints are evaluated."""

    def __missing__(self, name: str) -> Any:
        return getattr(builtins, name, None) or type(name, (_Unseen,), {})


def hints_of(function: Callable[..., Any]) -> dict[str, Any]:
    """Return the type hints of a function, with placeholders for classes that are imported for type checkers only."""
    with suppress(NameError, TypeError):
        return typing.get_type_hints(function)
    names = _Names(function.__globals__)
    return {name: eval(text, {}, names) if isinstance(text, str) else text for name, text in function.__annotations__.items()}


def fits(value: object, hint: Any) -> bool:
    """Check whether a value matches a type hint; hints that are not understood match any value."""
    origin, inner = get_origin(hint), get_args(hint)
    if hint is None or hint is Any:
        return hint is Any or value is None
    if isinstance(hint, type) and issubclass(hint, _Unseen):
        return any(kind.__name__ == hint.__name__ for kind in type(value).__mro__)
    if hint in PLAIN:
        return isinstance(value, PLAIN[hint][0]) and (hint in (bool, complex) or not isinstance(value, bool))
    if origin is Union:
        return any(fits(value, each) for each in _members(hint)) or (is_array(hint) and _is_numeric(value))
    if is_array(hint):
        return _is_numeric(value)
    if origin is Literal:
        return value in inner
    if origin is tuple and isinstance(value, Iterable):
        return not isinstance(value, (str, bytes)) and (_each_fits(value, inner[:1]) if inner[-1:] == (...,) else _is_row(value, inner))
    if isinstance(origin, type) and issubclass(origin, Callable):  # type: ignore[arg-type]
        return callable(value)
    if isinstance(origin, type) and issubclass(origin, Iterable) and not issubclass(origin, Mapping):
        return isinstance(value, Iterable) and not isinstance(value, (str, bytes)) and _each_fits(value, inner)
    kind = origin or hint
    return _has_kind(value, kind) if isinstance(kind, type) else True


def _each_fits(values: Iterable[object], inner: tuple[Any, ...]) -> bool:
    """Check the first values of a container; iterators are not consumed."""
    if len(inner) != 1 or not hasattr(values, "__len__"):
        return True
    return all(fits(value, inner[0]) for value, _ in zip(values, range(5)))


def _is_row(values: Iterable[object], inner: tuple[Any, ...]) -> bool:
    """Check whether values match the length and types of a tuple."""
    return not isinstance(values, Sized) or len(values) == len(inner) and all(fits(value, each) for value, each in zip(values, inner))


def _has_kind(value: object, kind: type) -> bool:
    if getattr(kind, "_is_protocol", False):
        wanted = [name for name in (*vars(kind), *getattr(kind, "__annotations__", {})) if not name.startswith("_")]
        return not isinstance(value, type) and all(hasattr(value, name) for name in wanted)
    return isinstance(value, kind)


def _members(hint: Any) -> list[Any]:
    """Return the members of a union, without those that ``ArrayLike`` expands to."""
    inner = list(get_args(hint))
    if not any("_SupportsArray" in repr(each) for each in inner):
        return inner
    return [
        each for each in inner if each not in PLAIN or each is type(None) if not re.search("_Supports|_NestedSequence|Buffer", repr(each))
    ]


def is_array(hint: Any) -> bool:
    parts = get_args(hint) if get_origin(hint) is Union else (hint,)
    return any("ndarray" in repr(each) or "_SupportsArray" in repr(each) for each in parts)


def _is_numeric(value: object) -> bool:
    import numpy as np

    try:
        return value is not None and np.asarray(value).dtype.kind in "iufb"
    except (TypeError, ValueError):
        return False


def kind_of(hint: Any, description: str) -> str:
    """Return the name of a type hint for a message."""
    if get_origin(hint) is Union:
        own = _members(hint)
        words = [kind_of(each, description) for each in own]
        if is_array(hint) and not any(map(is_array, own)):
            words.insert(0, _numbers(description))
        return " or ".join(dict.fromkeys(words))
    if hint in PLAIN:
        return PLAIN[hint][1]
    if is_array(hint):
        return _numbers(description)
    origin, inner = get_origin(hint), get_args(hint)
    if origin is Literal:
        return f"one of {', '.join(map(repr, inner))}"
    kind: Any = origin or hint
    if not isinstance(kind, type):
        return "another type"
    if issubclass(kind, Callable):  # type: ignore[arg-type]
        return "a function"
    if issubclass(kind, Mapping):
        return "a dictionary"
    if kind.__name__ == "PathLike":
        return "a path"
    if kind.__module__ in ("builtins", "collections.abc") and issubclass(kind, Iterable):
        return f"a list of {_plural(kind_of(inner[0], description))}" if inner and not isinstance(inner[0], TypeVar) else "a list"
    if kind.__name__ == "PosesProblem":
        return "a CGCMesh or a CGCProblem"
    return _with_article(kind.__name__)


def _with_article(name: str) -> str:
    return f"{'an' if name[0] in 'AEIOU' else 'a'} {name}"


def _numbers(description: str) -> str:
    shape = SHAPE.search(description)
    return f"numbers of shape {shape[0].strip('`')}" if shape else "numbers"


def _plural(kind: str) -> str:
    article, _, name = kind.partition(" ")
    return f"{name}s" if article in ("a", "an") and " or " not in kind else kind
