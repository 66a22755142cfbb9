"""Suggestions for unknown names."""

from __future__ import annotations

from collections.abc import Callable
from collections.abc import Iterable
from difflib import get_close_matches
from typing import Any
from typing import Optional

__all__ = ["did_you_mean", "find_attribute", "meant", "nearest_name"]


def find_attribute(value: object, name: str, hint: Callable[[str], str]) -> Any:
    """Raise an error with a suggestion for an attribute that does not exist; for use in ``__getattr__``.

    Parameters
    ----------
    value
        The object.
    name
        Name of the attribute.
    hint
        Returns a hint for an unknown name, or an empty string.

    Returns
    -------
    object
        The attribute, for special names that Python itself requests.

    Raises
    ------
    AttributeError

    Examples
    --------
    >>> find_attribute(1.5, "reel", lambda name: "")
    Traceback (most recent call last):
    ...
    AttributeError: a float has no attribute 'reel'; did you mean 'real'?
    """
    if name.startswith("_") or hasattr(type(value), name):
        # Special names that Python itself requests, and errors raised within a property.
        return object.__getattribute__(value, name)
    names = [each for each in dir(type(value)) if not each.startswith("_")]
    raise AttributeError(f"a {type(value).__name__} has no attribute {name!r}{meant(name, names, hint)}")


def meant(name: str, names: Iterable[str], hint: Callable[[str], str]) -> str:
    """Return the hint for an unknown name, or else the most similar name, as the end of a message."""
    instead = hint(name)
    return f"; {instead}" if instead else did_you_mean(name, names)


def did_you_mean(name: str, names: Iterable[str], alike: float = 0.6) -> str:
    """Return ``; did you mean 'name'?`` as the end of a message, empty if no name is similar.

    Parameters
    ----------
    name
        The unknown name.
    names
        The existing names.
    alike
        Smallest similarity of the two names, from 0 to 1.

    Returns
    -------
    str

    Examples
    --------
    >>> did_you_mean("targts", ["targets", "supports"])
    "; did you mean 'targets'?"
    """
    near = nearest_name(name, names, alike)
    return "" if near is None else f"; did you mean {near!r}?"


def nearest_name(name: str, names: Iterable[str], alike: float = 0.6) -> Optional[str]:
    """Return the name that is most similar to an unknown name.

    Parameters
    ----------
    name
        The unknown name; a unique beginning of a name is enough.
    names
        The existing names.
    alike
        Smallest similarity of the two names, from 0 to 1.

    Returns
    -------
    str or None
        None if no name is similar enough.

    Examples
    --------
    >>> nearest_name("sup", ["targets", "supports"])
    'supports'
    """
    known = list(names)
    begun = [each for each in known if len(name) > 2 and each.startswith(name)]
    return begun[0] if len(begun) == 1 else next(iter(get_close_matches(name, known, 1, alike)), None)
