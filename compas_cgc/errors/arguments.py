"""Readable errors for wrong arguments, derived after a call has failed."""

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
NAN_WORDS = ("nan", "unset", "none is", "not set")  # words in descriptions of arrays that may hold NaN
MAX_QUOTED = 60  # characters of a value that a message quotes


def names_what_was_meant(hint: Callable[[str], str] = lambda name: "") -> Callable[[F], F]:
    """Return a decorator of functions and classes that names the wrong argument when a call fails.

    Arguments are checked only after a call has failed with an error of Python or of a library, so successful calls cost nothing. Errors
    raised by the package itself are passed on.

    Parameters
    ----------
    hint
        Returns a hint for an unknown name, or an empty string.

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


def _explained(function: Callable[..., Any], name: str, docstring: str, hint: Callable[[str], str]) -> Callable[..., Any]:
    """Return a function that replaces errors of Python and libraries by one that names the wrong argument."""
    signature = inspect.signature(function)
    own = [each for each in signature.parameters.values() if each.name not in ("cls", "self")]
    implied = len(signature.parameters) - len(own)

    @functools.wraps(function)
    def called(*args: Any, **named: Any) -> Any:
        try:
            return function(*args, **named)
        except Exception as error:
            # An ArgumentError from an inner function names the inner arguments: derive it again for this call.
            if is_own_sentence(error) and not isinstance(error, ArgumentError):
                raise
            misfit = _misfit(name, own, len(args) - implied, named, hint)
            if misfit:
                raise ArgumentError(misfit) from None
            given = {key: value for key, value in signature.bind(*args, **named).arguments.items() if key not in ("cls", "self")}
            wrong = _wrong_argument(function, given, docstring)
            if wrong is None:
                raise
            raise ArgumentError(f"{name}(): {wrong}") from error

    return called


def _misfit(name: str, own: Sequence[inspect.Parameter], count: int, named: Iterable[str], hint: Callable[[str], str]) -> str:
    """Return the error in the number of positional arguments or the names of the others, empty if there is none."""
    known = [each.name for each in own]
    plain = [each.name for each in own if each.kind is each.POSITIONAL_OR_KEYWORD]
    unknown = next((each for each in named if each not in known), None)
    if unknown is not None:
        return f"{name}() has no argument {unknown!r}{meant(unknown, known, hint)}"
    if count > len(plain):
        more = f"; pass the others by name, such as {known[len(plain)]}=..." if len(known) > len(plain) else ""
        return f"{name}() accepts only {', '.join(map(repr, plain))} as positional arguments{more}"
    twice = next((each for each in plain[:count] if each in named), None)
    if twice is not None:
        return f"{name}() received {twice!r} twice, by position and by name; leave one out"
    needed = [each.name for each in own if each.default is each.empty]
    missing = next((each for each in needed if each not in named and each not in plain[:count]), None)
    return "" if missing is None else f"{name}() requires the argument {missing!r}; write {name}({', '.join(needed)})"


def is_own_sentence(error: BaseException) -> bool:
    """Check whether an error was raised by the package itself, not by Python or a library.

    Parameters
    ----------
    error
        The caught error.

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


def _wrong_argument(function: Callable[..., Any], given: Mapping[str, object], docstring: str) -> Optional[str]:
    """Return the error in the arguments of a failed call.

    Parameters
    ----------
    function
        The called function, with type hints.
    given
        Its arguments, by name.
    docstring
        Docstring of the function or its class, which states the shapes of arrays.

    Returns
    -------
    str or None
        The end of a message, None if no error is found.
    """
    hints = hints_of(function)
    described = {name: _described(name, docstring) for name in given}
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
    """Return the error in the shape or values of an array, None if there is none."""
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
    if array.dtype.kind == "f" and not np.isfinite(array).all() and not any(word in description.lower() for word in NAN_WORDS):
        return "must hold finite numbers only"
    return None


def _other_count(name: str, value: object, description: str, known: dict[str, tuple[int, str]]) -> Optional[str]:
    """Return the error if the length of an array differs from earlier ones; `known` maps size letters to lengths."""
    import numpy as np

    shape = SHAPE.search(description)
    for letter, own in zip(shape[1].split(",") if shape else (), np.asarray(value).shape):
        count, first = known.setdefault(letter.strip(), (own, name))
        if letter.strip().isalpha() and own != count:
            return f"must have {count} rows, as many as {first}, not {own}"
    return None


def _described(name: str, docstring: str) -> str:
    """Return the description of a parameter in a docstring."""
    found = re.search(rf"^ *{re.escape(name)}(?: *:.*)?\n((?: {{8}}.*\n?)+)", docstring, re.MULTILINE)
    return " ".join(found[1].split()) if found else ""


def _shown(value: object) -> str:
    text = repr(value) if not hasattr(value, "shape") else f"an array of {getattr(value, 'dtype', 'numbers')}"
    return text if len(text) <= MAX_QUOTED else f"{text[:MAX_QUOTED]}…"
