"""Errors of the package: each is a sentence for the person who can put it right."""

from __future__ import annotations

import dis
import functools
import inspect
import numbers
import os
import re
import types
import typing
from collections.abc import Callable
from collections.abc import Iterable
from collections.abc import Mapping
from collections.abc import Sequence
from contextlib import suppress
from difflib import get_close_matches
from pathlib import Path
from typing import Any
from typing import Literal
from typing import Optional
from typing import TypeVar
from typing import Union
from typing import cast
from typing import get_args
from typing import get_origin

__all__ = [
    "ArgumentError",
    "CGCError",
    "FileError",
    "MeshError",
    "ProblemError",
    "did_you_mean",
    "find_attribute",
    "is_own_sentence",
    "names_what_was_meant",
    "nearest_name",
]

F = TypeVar("F", bound=Callable[..., Any])
PACKAGE = str(Path(__file__).parent) + os.sep
RAISE = dis.opmap["RAISE_VARARGS"]
PLAIN: dict[Any, tuple[type, str]] = {
    bool: (bool, "True or False"),
    int: (numbers.Integral, "a whole number"),
    float: (numbers.Real, "a number"),
    complex: (numbers.Number, "a number"),
    str: (str, "a text"),
    bytes: (bytes, "bytes"),
    type(None): (type(None), "None"),
}
SHAPE = re.compile(r"``\(([\w\s,]+)\)``")  # as docstrings have it, with letters for any size
MAY_BE_UNKNOWN = ("nan", "unset", "none is", "not set")  # words of arrays that have numbers for some only
SHOWN = 60  # signs of a value that a sentence quotes


class CGCError(ValueError):
    """Base of all errors that a user of the package can cause and put right."""


class MeshError(CGCError):
    """The vertices and faces do not form a mesh that curvature can be measured on."""


class FileError(CGCError):
    """A file cannot be read or written."""


class ArgumentError(CGCError, TypeError):
    """An argument is of another kind than what a function takes."""


class ProblemError(CGCError):
    """A solve is refused.

    Attributes
    ----------
    problems
        The sentences of :meth:`compas_cgc.datastructures.CGCMesh.check` that refuse it.
    """

    def __init__(self, problems: Sequence[str]):
        self.problems = list(problems)
        super().__init__("; ".join(self.problems))


def find_attribute(value: object, name: str, hint: Callable[[str], str]) -> Any:
    """Refuse an attribute that a value does not have with a sentence that names what was meant; for its ``__getattr__``.

    Parameters
    ----------
    value
        What was asked.
    name
        For what.
    hint
        Returns what to write instead, or nothing.

    Raises
    ------
    AttributeError
    """
    if name.startswith("_") or hasattr(type(value), name):
        # What Python asks for by itself, and what goes wrong within a property.
        return object.__getattribute__(value, name)
    names = [each for each in dir(type(value)) if not each.startswith("_")]
    raise AttributeError(f"a {type(value).__name__} has no {name!r}{_meant(name, names, hint)}")


def names_what_was_meant(hint: Callable[[str], str] = lambda name: "") -> Callable[[F], F]:
    """Return a decorator of functions and classes, which say what was meant where a call fails for its arguments.

    Arguments are looked at once a call has failed with an error of Python or of a library: one that succeeds costs nothing, and what the
    package says by itself stands.

    Parameters
    ----------
    hint
        Returns for a name what to write instead, or nothing.
    """

    def decorated(target: F) -> F:
        if isinstance(target, type):
            made: Any = target
            made.__init__ = _explained(made.__init__, made.__name__, made.__doc__ or "", hint)
            return cast(F, made)
        return cast(F, _explained(target, target.__name__, target.__doc__ or "", hint))

    return decorated


def _explained(function: Callable[..., Any], name: str, told: str, hint: Callable[[str], str]) -> Callable[..., Any]:
    """Return a function whose errors of Python or of libraries say which argument is wrong, where one is."""
    signature = inspect.signature(function)
    own = [each for each in signature.parameters.values() if each.name not in ("cls", "self")]
    implied = len(signature.parameters) - len(own)

    @functools.wraps(function)
    def called(*args: Any, **named: Any) -> Any:
        try:
            return function(*args, **named)
        except Exception as error:
            # Who is called from outside knows its arguments by the names that the caller wrote.
            if is_own_sentence(error) and not isinstance(error, ArgumentError):
                raise
            misfit = _misfit(name, own, len(args) - implied, named, hint)
            if misfit:
                raise ArgumentError(misfit) from None
            given = {key: value for key, value in signature.bind(*args, **named).arguments.items() if key not in ("cls", "self")}
            wrong = _wrong_argument(function, given, told)
            if wrong is None:
                raise
            raise ArgumentError(f"{name}(): {wrong}") from error

    return called


def _misfit(name: str, own: Sequence[inspect.Parameter], count: int, named: Iterable[str], hint: Callable[[str], str]) -> str:
    """Return what is wrong with so many arguments without a name, and those with one; nothing where they fit."""
    known = [each.name for each in own]
    plain = [each.name for each in own if each.kind is each.POSITIONAL_OR_KEYWORD]
    unknown = next((each for each in named if each not in known), None)
    if unknown is not None:
        return f"{name}() takes no {unknown!r}{_meant(unknown, known, hint)}"
    if count > len(plain):
        more = f"; write {known[len(plain)]}=... and the like" if len(known) > len(plain) else ""
        return f"{name}() takes only {', '.join(map(repr, plain))} without a name{more}"
    twice = next((each for each in plain[:count] if each in named), None)
    if twice is not None:
        return f"{name}() is given {twice!r} twice, in its place and by its name; leave one out"
    needed = [each.name for each in own if each.default is each.empty]
    lacking = next((each for each in needed if each not in named and each not in plain[:count]), None)
    return "" if lacking is None else f"{name}() lacks {lacking!r}; write {name}({', '.join(needed)})"


def _meant(name: str, names: Iterable[str], hint: Callable[[str], str]) -> str:
    """Return the end of a sentence that says what was likely meant."""
    instead = hint(name)
    return f"; {instead}" if instead else did_you_mean(name, names)


def did_you_mean(name: str, names: Iterable[str], alike: float = 0.6) -> str:
    """Return ``; did you mean 'name'?`` for the end of a sentence, nothing where no name is near.

    Parameters
    ----------
    name
        As it was written.
    names
        Those that there are.
    alike
        How much alike two names must be, from 0 to 1.
    """
    near = nearest_name(name, names, alike)
    return "" if near is None else f"; did you mean {near!r}?"


def nearest_name(name: str, names: Iterable[str], alike: float = 0.6) -> Optional[str]:
    """Return the name that is most alike to another one, None where none is as much alike as asked, from 0 to 1."""
    return next(iter(get_close_matches(name, list(names), 1, alike)), None)


def is_own_sentence(error: BaseException) -> bool:
    """Tell whether an error was raised by the package itself, whose errors are sentences, and not by Python or by a library."""
    trace = error.__traceback__
    while trace is not None and trace.tb_next is not None:
        trace = trace.tb_next
    if trace is None:
        return False
    code = trace.tb_frame.f_code
    return code.co_filename.startswith(PACKAGE) and code.co_code[trace.tb_lasti] == RAISE


def _wrong_argument(function: Callable[..., Any], given: Mapping[str, object], told: str) -> Optional[str]:
    """Return what is wrong with the arguments of a call that failed.

    Parameters
    ----------
    function
        What was called; its type hints say what it takes.
    given
        Its arguments, by name.
    told
        Its docstring, or that of its class, which says of what shape arrays are.

    Returns
    -------
    str or None
        The end of a sentence, None where nothing is seen to be wrong.
    """
    hints = _hints_of(function)
    described = {name: _described(name, told) for name in given}
    for name, value in given.items():
        if name in hints and not _fits(value, hints[name]):
            return f"{name} must be {_kind(hints[name], described[name])}, not {_shown(value)}"
    for name, value in given.items():
        fault = _wrong_numbers(value, described[name]) if name in hints and _is_array(hints[name]) and value is not None else None
        if fault:
            return f"{name} {fault}"
    return None


def _hints_of(function: Callable[..., Any]) -> dict[str, Any]:
    """Return the type hints of a function: of what is imported for type checkers only, the names of the classes."""
    with suppress(NameError, TypeError):
        return typing.get_type_hints(function)
    found: dict[str, Any] = {}
    for name, text in function.__annotations__.items():
        found[name] = text if text.isidentifier() else Any
        with suppress(NameError, TypeError, AttributeError):
            found.update(typing.get_type_hints(types.SimpleNamespace(__annotations__={name: text}), function.__globals__))
    return found


def _fits(value: object, hint: Any) -> bool:
    """Tell whether a value is of the kind that a hint names; what is not understood fits."""
    origin, inner = get_origin(hint), get_args(hint)
    if hint is None or hint is Any:
        return hint is Any or value is None
    if isinstance(hint, str):
        return any(kind.__name__ == hint for kind in type(value).__mro__)
    if hint in PLAIN:
        return isinstance(value, PLAIN[hint][0]) and (hint in (bool, complex) or not isinstance(value, bool))
    if origin is Union:
        return any(_fits(value, each) for each in _members(hint)) or (_is_array(hint) and _is_numeric(value))
    if _is_array(hint):
        return _is_numeric(value)
    if origin is Literal:
        return value in inner
    if origin is tuple and isinstance(value, Iterable):
        return not isinstance(value, (str, bytes)) and (inner[-1:] != (...,) or _each_fits(value, inner[:1]))
    if isinstance(origin, type) and issubclass(origin, Callable):  # type: ignore[arg-type]
        return callable(value)
    if isinstance(origin, type) and issubclass(origin, Iterable) and not issubclass(origin, Mapping):
        return isinstance(value, Iterable) and not isinstance(value, (str, bytes)) and _each_fits(value, inner)
    kind = origin or hint
    return _has_kind(value, kind) if isinstance(kind, type) else True


def _each_fits(values: Iterable[object], inner: tuple[Any, ...]) -> bool:
    """Tell the same of the first of some values; an iterator is not used up for it."""
    if len(inner) != 1 or not hasattr(values, "__len__"):
        return True
    return all(_fits(value, inner[0]) for value, _ in zip(values, range(5)))


def _has_kind(value: object, kind: type) -> bool:
    if getattr(kind, "_is_protocol", False):
        wanted = [name for name in (*vars(kind), *getattr(kind, "__annotations__", {})) if not name.startswith("_")]
        return not isinstance(value, type) and all(hasattr(value, name) for name in wanted)
    return isinstance(value, kind)


def _members(hint: Any) -> list[Any]:
    """Return what a union is of, without the many kinds that ``ArrayLike`` stands for."""
    inner = list(get_args(hint))
    if not any("_SupportsArray" in repr(each) for each in inner):
        return inner
    return [
        each for each in inner if each not in PLAIN or each is type(None) if not re.search("_Supports|_NestedSequence|Buffer", repr(each))
    ]


def _is_array(hint: Any) -> bool:
    parts = get_args(hint) if get_origin(hint) is Union else (hint,)
    return any("ndarray" in repr(each) or "_SupportsArray" in repr(each) for each in parts)


def _is_numeric(value: object) -> bool:
    import numpy as np

    try:
        return value is not None and np.asarray(value).dtype.kind in "iufb"
    except (TypeError, ValueError):
        return False


def _wrong_numbers(value: object, description: str) -> Optional[str]:
    """Return what is wrong with an array, None where nothing is seen to be."""
    import numpy as np

    array = np.asarray(value)
    if array.dtype.kind not in "iufb":
        return None
    shape = SHAPE.search(description)
    sizes = [each.strip() for each in shape[1].split(",") if each.strip()] if shape else []
    if shape and (array.ndim != len(sizes) or any(size.isdigit() and int(size) != own for size, own in zip(sizes, array.shape))):
        return f"must have the shape {shape[0].strip('`')}, not {array.shape}"
    if not array.size:
        return "must not be empty"
    if array.dtype.kind == "f" and not np.isfinite(array).all() and not any(word in description.lower() for word in MAY_BE_UNKNOWN):
        return "must be finite numbers"
    return None


def _described(name: str, told: str) -> str:
    """Return what a docstring says of a parameter."""
    found = re.search(rf"^ *{re.escape(name)}(?: *:.*)?\n((?: {{8}}.*\n?)+)", told, re.MULTILINE)
    return " ".join(found[1].split()) if found else ""


def _kind(hint: Any, description: str) -> str:
    """Return what a hint is called in a sentence."""
    if get_origin(hint) is Union:
        own = _members(hint)
        words = [_kind(each, description) for each in own]
        if _is_array(hint) and not any(map(_is_array, own)):
            words.insert(0, _numbers(description))
        return " or ".join(dict.fromkeys(words))
    if isinstance(hint, str):
        return _with_article(hint)
    if hint in PLAIN:
        return PLAIN[hint][1]
    if _is_array(hint):
        return _numbers(description)
    origin, inner = get_origin(hint), get_args(hint)
    if origin is Literal:
        return f"one of {', '.join(map(repr, inner))}"
    kind: Any = origin or hint
    if not isinstance(kind, type):
        return "something else"
    if issubclass(kind, Callable):  # type: ignore[arg-type]
        return "a function"
    if issubclass(kind, Mapping):
        return "a dictionary"
    if kind.__name__ == "PathLike":
        return "a path"
    if kind.__module__ in ("builtins", "collections.abc") and issubclass(kind, Iterable):
        return f"a list of {_plural(_kind(inner[0], description))}" if inner and not isinstance(inner[0], TypeVar) else "a list"
    if kind.__name__ == "PosesProblem":
        return "a CGCMesh or a CGCProblem"
    return _with_article(kind.__name__)


def _with_article(name: str) -> str:
    return f"{'an' if name[0] in 'AEIOU' else 'a'} {name}"


def _numbers(description: str) -> str:
    shape = SHAPE.search(description)
    return f"numbers of the shape {shape[0].strip('`')}" if shape else "numbers"


def _plural(kind: str) -> str:
    article, _, name = kind.partition(" ")
    return f"{name}s" if article in ("a", "an") and " or " not in kind else kind


def _shown(value: object) -> str:
    text = repr(value) if not hasattr(value, "shape") else f"an array of {getattr(value, 'dtype', 'numbers')}"
    return text if len(text) <= SHOWN else f"{text[:SHOWN]}…"
