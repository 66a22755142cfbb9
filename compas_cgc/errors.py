"""Errors of the package: each is a sentence for the person who can put it right."""

from __future__ import annotations

import functools
import inspect
from collections.abc import Iterable
from collections.abc import Sequence
from difflib import get_close_matches
from typing import Any
from typing import Callable
from typing import Optional
from typing import TypeVar
from typing import cast

__all__ = ["CGCError", "FileError", "MeshError", "ProblemError", "did_you_mean", "find_attribute", "names_what_was_meant", "nearest_name"]

F = TypeVar("F", bound=Callable[..., Any])


class CGCError(ValueError):
    """Base of all errors that a user of the package can cause and put right."""


class MeshError(CGCError):
    """The vertices and faces do not form a mesh that curvature can be measured on."""


class FileError(CGCError):
    """A file cannot be read or written."""


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
    """Return a decorator of functions, which refuse arguments that do not fit with what was meant.

    Parameters
    ----------
    hint
        Returns for a name what to write instead, or nothing.
    """

    def decorated(function: F) -> F:
        own = [each for each in inspect.signature(function).parameters.values() if each.name not in ("cls", "self")]
        implied = len(inspect.signature(function).parameters) - len(own)

        @functools.wraps(function)
        def called(*args: Any, **named: Any) -> Any:
            fault = _misfit(function.__name__, own, len(args) - implied, named, hint)
            if fault:
                raise TypeError(fault)
            return function(*args, **named)

        return cast(F, called)

    return decorated


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
