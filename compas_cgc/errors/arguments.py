"""Wrong arguments: looked for once a call has failed, and named in a sentence."""

from __future__ import annotations

import dis
import functools
import inspect
import os
import re
from collections.abc import Callable
from collections.abc import Iterable
from collections.abc import Mapping
from collections.abc import Sequence
from pathlib import Path
from typing import Any
from typing import Optional
from typing import TypeVar
from typing import cast

from .classes import ArgumentError
from .kinds import SHAPE
from .kinds import fits
from .kinds import hints_of
from .kinds import is_array
from .kinds import kind_of
from .names import meant

__all__ = ["is_own_sentence", "names_what_was_meant"]

F = TypeVar("F", bound=Callable[..., Any])
PACKAGE = str(Path(__file__).parents[1]) + os.sep
RAISE = dis.opmap["RAISE_VARARGS"]
MAY_BE_UNKNOWN = ("nan", "unset", "none is", "not set")  # words of arrays that have numbers for some only
SHOWN = 60  # signs of a value that a sentence quotes


def names_what_was_meant(hint: Callable[[str], str] = lambda name: "") -> Callable[[F], F]:
    """Return a decorator of functions and classes, which say what was meant where a call fails for its arguments.

    Arguments are looked at once a call has failed with an error of Python or of a library: one that succeeds costs nothing, and what the
    package says by itself stands.

    Parameters
    ----------
    hint
        Returns for a name what to write instead, or nothing.

    Returns
    -------
    callable

    Examples
    --------
    >>> @names_what_was_meant()
    ... def area(side: float) -> float:
    ...     return side**2
    >>> area("2")
    Traceback (most recent call last):
    ...
    compas_cgc.errors.classes.ArgumentError: area(): side must be a number, not '2'
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
        return f"{name}() takes no {unknown!r}{meant(unknown, known, hint)}"
    if count > len(plain):
        more = f"; write {known[len(plain)]}=... and the like" if len(known) > len(plain) else ""
        return f"{name}() takes only {', '.join(map(repr, plain))} without a name{more}"
    twice = next((each for each in plain[:count] if each in named), None)
    if twice is not None:
        return f"{name}() is given {twice!r} twice, in its place and by its name; leave one out"
    needed = [each.name for each in own if each.default is each.empty]
    lacking = next((each for each in needed if each not in named and each not in plain[:count]), None)
    return "" if lacking is None else f"{name}() lacks {lacking!r}; write {name}({', '.join(needed)})"


def is_own_sentence(error: BaseException) -> bool:
    """Tell whether an error was raised by the package itself, whose errors are sentences, and not by Python or by a library.

    Parameters
    ----------
    error
        That was caught.

    Returns
    -------
    bool

    Examples
    --------
    >>> is_own_sentence(ValueError("somebody else's"))
    False
    """
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
    hints = hints_of(function)
    described = {name: _described(name, told) for name in given}
    for name, value in given.items():
        if name in hints and not fits(value, hints[name]):
            return f"{name} must be {kind_of(hints[name], described[name])}, not {_shown(value)}"
    known: dict[str, tuple[int, str]] = {}
    for name, value in given.items():
        if name in hints and is_array(hints[name]) and value is not None:
            fault = _wrong_numbers(value, described[name]) or _other_count(name, value, described[name], known)
            if fault:
                return f"{name} {fault}"
    return None


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


def _other_count(name: str, value: object, description: str, known: dict[str, tuple[int, str]]) -> Optional[str]:
    """Return what is wrong where an array is for more or fewer vertices or faces than those before; these are `known` by their letters."""
    import numpy as np

    shape = SHAPE.search(description)
    for letter, own in zip(shape[1].split(",") if shape else (), np.asarray(value).shape):
        count, first = known.setdefault(letter.strip(), (own, name))
        if letter.strip().isalpha() and own != count:
            return f"must have {count} rows, as many as {first}, not {own}"
    return None


def _described(name: str, told: str) -> str:
    """Return what a docstring says of a parameter."""
    found = re.search(rf"^ *{re.escape(name)}(?: *:.*)?\n((?: {{8}}.*\n?)+)", told, re.MULTILINE)
    return " ".join(found[1].split()) if found else ""


def _shown(value: object) -> str:
    text = repr(value) if not hasattr(value, "shape") else f"an array of {getattr(value, 'dtype', 'numbers')}"
    return text if len(text) <= SHOWN else f"{text[:SHOWN]}…"
