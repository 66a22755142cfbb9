"""Names that are near to one that there is not."""

from __future__ import annotations

from collections.abc import Callable
from collections.abc import Iterable
from difflib import get_close_matches
from typing import Any
from typing import Optional

__all__ = ["did_you_mean", "find_attribute", "meant", "nearest_name"]


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

    Returns
    -------
    object
        The attribute, where Python asks for one by itself.

    Raises
    ------
    AttributeError

    Examples
    --------
    >>> find_attribute(1.5, "reel", lambda name: "")
    Traceback (most recent call last):
    ...
    AttributeError: a float has no 'reel'; did you mean 'real'?
    """
    if name.startswith("_") or hasattr(type(value), name):
        # What Python asks for by itself, and what goes wrong within a property.
        return object.__getattribute__(value, name)
    names = [each for each in dir(type(value)) if not each.startswith("_")]
    raise AttributeError(f"a {type(value).__name__} has no {name!r}{meant(name, names, hint)}")


def meant(name: str, names: Iterable[str], hint: Callable[[str], str]) -> str:
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
    """Return the name that is most alike to another one.

    Parameters
    ----------
    name
        As it was written; the beginning of one name alone is enough.
    names
        Those that there are.
    alike
        How much alike two names must be, from 0 to 1.

    Returns
    -------
    str or None
        None where none is as much alike.

    Examples
    --------
    >>> nearest_name("sup", ["targets", "supports"])
    'supports'
    """
    known = list(names)
    begun = [each for each in known if len(name) > 2 and each.startswith(name)]
    return begun[0] if len(begun) == 1 else next(iter(get_close_matches(name, known, 1, alike)), None)
