"""Registry of methods: a value for each, which every door reads."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any
from typing import Optional

from ..errors import Sentence
from ..errors import did_you_mean
from ..errors import names_what_was_meant
from ..errors import use_method
from .flow.method import METHOD as FLOW
from .method import Method
from .newton.method import METHOD as NEWTON
from .polish.method import METHOD as BENDING
from .projection.method import METHOD as PROJECTION
from .settings import AutoSettings
from .settings import Option
from .settings import Settings

__all__ = ["METHODS", "Method", "method_names", "method_of", "options", "owners", "register", "settings_for", "settings_of"]

METHODS: dict[str, Method] = {method.name: method for method in (FLOW, NEWTON, PROJECTION, BENDING)}


@names_what_was_meant()
def register(method: Method) -> Method:
    """Register a method, so that all interfaces offer it.

    Parameters
    ----------
    method
        Of a name that is not taken.

    Returns
    -------
    Method
        The same.

    Raises
    ------
    ValueError
        If the name is taken by another.

    Examples
    --------
    >>> register(METHODS["newton"]).name  # doctest: +SKIP
    """
    if METHODS.setdefault(method.name, method) != method or method.name == "auto":
        raise ValueError(f"there is a method {method.name!r} already; take another name")
    return method


@names_what_was_meant()
def method_names() -> tuple[str, ...]:
    """Return the names of the methods that can be selected, including ``auto``.

    Returns
    -------
    tuple of str
        Names.

    Examples
    --------
    >>> method_names()
    ('auto', 'flow', 'newton', 'projection', 'bending')
    """
    return ("auto", *METHODS)


@names_what_was_meant()
def options() -> dict[str, Option]:
    """Return all options of all methods by name; of options with the same name, the one with the most choices.

    Returns
    -------
    dict
        Options by name.

    Examples
    --------
    >>> "tolerance" in options()
    True
    """
    found: dict[str, Option] = {}
    kinds: list[type[Settings]] = [AutoSettings, *(method.settings for method in METHODS.values())]
    for kind in kinds:
        for own in kind.options().values():
            shown = own.alias or own.name
            if shown not in found or len(own.choices) > len(found[shown].choices):
                found[shown] = own
    return found


def owners(name: str) -> list[str]:
    """Return the methods that have an option."""
    return [method.name for method in METHODS.values() if name in method.settings.options()]


def method_of(settings: Settings) -> str:
    """Return the method that settings are of, ``auto`` for those of any.

    Raises
    ------
    ValueError
        If they are of none.
    """
    if type(settings) is AutoSettings:
        return "auto"
    for method in METHODS.values():
        if type(settings) is method.settings:
            return method.name
    raise ValueError(f"settings must be {_kinds(METHODS)}, not {type(settings).__name__}")


@names_what_was_meant()
def settings_for(method: str = "auto", given: Optional[Mapping[str, Any]] = None, **more: Any) -> Optional[Settings]:
    """Return the settings for options given by name, in the same way for every interface.

    Parameters
    ----------
    method
        With ``auto``, options of a single method select this method. Options that all methods have do not select one.
    given, more
        Options by their names, ``delay`` for ``e``; None stands for the default.

    Returns
    -------
    Settings or None
        None if no option is given and the method is ``auto``.

    Raises
    ------
    ValueError
        If the method or an option does not exist, an option belongs to another method, or a value is out of its range.

    Examples
    --------
    >>> from compas_cgc import settings_for
    >>> type(settings_for("auto", {"s": 0.5})).__name__
    'FlowSettings'
    """
    if method not in method_names():
        raise ValueError(f"method must be one of {', '.join(method_names())}, not {method!r}")
    if given is not None and not isinstance(given, Mapping):
        raise ValueError(f"settings are options by their names, such as {{'tolerance': 1e-9}}, not {given!r:.60}")
    values = _by_own_names({**(given or {}), **more})
    if method == "auto":
        if set(values) <= set(AutoSettings.options()):
            return AutoSettings(**values) if values else None
        method = _only_owner(values)
    kind = METHODS[method].settings
    for name in values:
        if name not in kind.options():
            own = owners(name)
            text = f"{_door_name(name)} is a setting of {' and '.join(own)}, not of {method}; leave it out, or use the method {own[0]}"
            raise ValueError(Sentence(text, [use_method(own[0])]))
    return kind(**values)


def settings_of(method: Method, settings: Optional[Settings]) -> Settings:
    """Return the settings for a method that was picked: those given where they are its own or any method's, else its defaults."""
    if isinstance(settings, method.settings):
        return settings
    given = settings.to_dict() if settings else {}
    known = method.settings.options()
    return method.settings(**{name: value for name, value in given.items() if value is not None and name in known})


def _by_own_names(given: Mapping[str, Any]) -> dict[str, Any]:
    known = {own.alias: own.name for own in options().values() if own.alias}
    values = {known.get(name, name): value for name, value in given.items() if value is not None}
    unknown = sorted(name for name in values if not owners(name))
    if unknown:
        meant = did_you_mean(unknown[0], options(), 0.75) or "; there are " + ", ".join(options())
        raise ValueError(f"there is no setting {unknown[0]!r:.60}{meant}")
    return values


def _door_name(name: str) -> str:
    """Return what doors call an option, which is what their users know."""
    return next(shown for shown, own in options().items() if own.name == name)


def _only_owner(values: Mapping[str, Any]) -> str:
    able = [name for name, method in METHODS.items() if set(values) <= set(method.settings.options())]
    if len(able) > 1:
        # One that takes any problem.
        able = [name for name in able if METHODS[name].any_sign and METHODS[name].goals == "any"] or able
    if len(able) != 1:
        raise ValueError(
            f"the settings {', '.join(sorted(map(_door_name, values)))} do not belong to one method; name it, {', '.join(METHODS)}"
        )
    return able[0]


def _kinds(names: Mapping[str, object]) -> str:
    return " or ".join(METHODS[name].settings.__name__ for name in names)
