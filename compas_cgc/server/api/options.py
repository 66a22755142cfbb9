"""Options of a request: checked before the job is queued, applied to the problem in the worker."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Any
from typing import Optional

import numpy as np

from ...errors import joined
from ...errors import sentence_of
from ...meshing.boundary import SUPPORT_NAMES
from ...meshing.checks import listed
from ...model.constraint_data import as_goals
from ...model.constraints import check_indices
from ...model.goals.wholes import Unknown
from ...model.laws import as_law
from ...model.problem import CGCProblem
from ...model.problem import Targets
from ...model.roles import DUMMY
from ...model.roles import ROLES
from ...solvers.registry import METHODS
from ...solvers.registry import method_names
from ...solvers.registry import method_of
from ...solvers.registry import settings_for
from ...solvers.settings import Settings
from ..errors import Unprocessable
from ..limits import Limits
from .decoding import are_numbers
from .decoding import number
from .decoding import whole
from .units import UNITS

__all__ = ["OPTIONS", "USER_ROLES", "apply_options", "check_options", "check_targets", "read_targets", "settings_of"]

OPTIONS = (
    *("supports", "creases", "targets", "laws", "goals", "unknown", "method", "settings"),
    *("flip", "live", "name", "unit", "id"),
)
USER_ROLES = tuple(role for i, role in enumerate(ROLES) if i != DUMMY)


def check_options(options: Mapping[str, Any], count: Optional[int], limits: Limits) -> None:
    """Check the options for a mesh of `count` vertices (None: not known yet).

    Raises
    ------
    Unprocessable
        If an option is invalid.
    """
    if not isinstance(options.get("name", ""), str):
        raise Unprocessable("'name' must be a string")
    if options.get("unit", "") not in tuple(UNITS):
        raise Unprocessable(f"'unit' must be one of {', '.join(filter(None, UNITS))}")
    for name in ("flip", "live"):
        if not isinstance(options.get(name, False), bool):
            raise Unprocessable(f"'{name}' must be true or false")
    settings = settings_of(options, limits)
    _check_supports(options, count)
    _check_creases(options.get("creases"), count)
    check_targets(options.get("targets"), count)
    _check_laws(options.get("laws"))
    method = options.get("method", "auto") if settings is None else method_of(settings)
    _check_goals(options.get("goals"), method, count)
    _check_unknown(options.get("unknown"))


def apply_options(problem: CGCProblem, options: Mapping[str, Any]) -> CGCProblem:
    """Return a problem with checked options applied to it.

    Raises
    ------
    ValueError
        If a crease does not follow edges, or a vertex or region does not exist.
    """
    if options.get("name"):
        problem = replace(problem, drawing=problem.drawing._replace(name=options["name"]))
    if options.get("unit"):
        problem = replace(problem, drawing=problem.drawing._replace(units=UNITS[options["unit"]]))
    if options.get("flip"):
        problem = problem.flipped()
    if options.get("creases") is not None:
        problem = problem.with_creases(options["creases"])
    if options.get("roles") is not None:
        problem = problem.with_supports(_fixed(options["roles"], problem))
    elif options.get("supports") is not None:
        problem = problem.with_supports(options["supports"])
    if options.get("targets") is not None:
        problem = problem.with_targets(read_targets(options["targets"]))
    if options.get("laws"):
        laws = options["laws"]
        problem = problem.with_laws({int(region): law for region, law in laws.items()} if isinstance(laws, Mapping) else laws)
    unknown = options.get("unknown")
    found = [Unknown(unknown)] if unknown else []
    return problem.with_goals([*(options.get("goals") or ()), *found])


def settings_of(options: Mapping[str, Any], limits: Limits) -> Optional[Settings]:
    """Return the settings in options, None if there are none.

    Raises
    ------
    Unprocessable
        If a method or setting is unknown, or a value is out of range.
    """
    method, value = options.get("method", "auto"), options.get("settings")
    if method not in method_names():
        raise Unprocessable(f"'method' must be one of {', '.join(method_names())}")
    if value is not None and not isinstance(value, Mapping):
        raise Unprocessable("'settings' must be an object that maps names of settings to values")
    given = {name: _plain(entry, f"the setting {name:.40}") for name, entry in (value or {}).items()}
    try:
        settings = settings_for(method, given) if given else None
    except ValueError as error:
        raise Unprocessable(joined(["settings", sentence_of(error)], ": ")) from None
    steps = getattr(settings, "steps", None)
    if steps is not None and steps > limits.steps:
        raise Unprocessable(f"the setting steps is {steps}, but the server allows at most {limits.steps} steps")
    return settings


def _plain(value: object, what: str) -> object:
    """Return a number, string or boolean; integral floats such as 3.0 become integers."""
    if value is None or isinstance(value, (bool, str)):
        return value
    if not isinstance(value, (int, float)):
        raise Unprocessable(f"{what} must be a number, a string, true or false")
    number(value, what)
    return int(value) if isinstance(value, float) and value.is_integer() else value


def _check_supports(options: Mapping[str, Any], count: Optional[int]) -> None:
    supports, roles = options.get("supports"), options.get("roles")
    if roles is not None:
        _check_roles(roles, count, options)
    elif isinstance(supports, str):
        if supports not in SUPPORT_NAMES:
            raise Unprocessable('\'supports\' must be a list of vertices, "boundary", "outline" or "corners"')
    elif supports is not None:
        _check_vertices(supports, count, "'supports'")


def _check_roles(roles: object, count: Optional[int], options: Mapping[str, Any]) -> None:
    if options.get("supports") is not None:
        raise Unprocessable("give 'roles' or 'supports', not both")
    if not isinstance(roles, list) or (count is not None and len(roles) != count):
        raise Unprocessable(f"'roles' must be a list of one role per vertex ({count} vertices)")
    wrong = next((i for i, role in enumerate(roles) if role not in USER_ROLES), None)
    if wrong is not None:
        raise Unprocessable(f"the role of vertex {wrong} must be {', '.join(USER_ROLES[:-1])} or {USER_ROLES[-1]}")
    if "crease" in roles and not options.get("creases"):
        raise Unprocessable("'roles' has crease vertices; also give the folding edges as 'creases', paths of vertices")


def _check_creases(creases: object, count: Optional[int]) -> None:
    if creases is None:
        return
    if not isinstance(creases, list):
        raise Unprocessable("'creases' must be a list of paths, each a list of vertices along edges")
    for i, path in enumerate(creases):
        _check_vertices(path, count, f"crease {i}")


def _check_vertices(value: object, count: Optional[int], what: str) -> None:
    if not isinstance(value, list):
        raise Unprocessable(f"{what} must be a list of vertices")
    place = next((v for v in value if isinstance(v, list)), None)
    if place is not None:
        raise Unprocessable(f"{what} must be indices of 'vertices', counted from 0, not coordinates such as {place!s:.60}")
    vertices = [whole(v, f"every vertex of {what}") for v in value]
    wrong = [v for v in vertices if v < 0 or (count is not None and v >= count)]
    if wrong:
        one = len(wrong) == 1
        there = "" if count is None else f"; there are {count} vertices, counted from 0"
        named = f"{'vertex' if one else 'vertices'} {listed(wrong)}, which {'does' if one else 'do'} not exist"
        raise Unprocessable(f"{what} refers to {named}{there}")


def check_targets(value: object, count: Optional[int]) -> None:
    """Check targets for a mesh of `count` vertices (None: not known yet).

    Raises
    ------
    Unprocessable
        If the target of a vertex or region is invalid.
    """
    if isinstance(value, list):
        if count is not None and len(value) != count:
            raise Unprocessable(f"'targets' has {len(value)} numbers for {count} vertices; give one number per vertex, or one for all")
        if are_numbers(value):
            return
        for i, K in enumerate(value):
            if K is not None:
                number(K, f"the target of vertex {i}")
    elif isinstance(value, dict):
        if not all(key.isdecimal() and len(key) < 7 for key in value):
            raise Unprocessable('\'targets\' by region must have region numbers as keys, such as {"0": 0.01, "1": 0.04}')
        for key, K in value.items():
            number(K, f"the target of region {key}")
    elif value is not None:
        number(value, "'targets' for all vertices")


def _check_laws(value: object) -> None:
    by_region = value if isinstance(value, dict) else {} if value is None else {"0": value}
    if not all(key.isdecimal() and len(key) < 7 for key in by_region):
        raise Unprocessable('\'laws\' by region must have region numbers as keys, such as {"0": "minimal", "1": "H = 0.1"}')
    for law in by_region.values():
        if not isinstance(law, str):
            raise Unprocessable("'laws' must be a text such as \"H = 0.1\" for all regions, or an object of texts by region")
        try:
            as_law(law)
        except ValueError as error:
            raise Unprocessable(f"laws: {error}") from None


def _check_goals(value: object, method: str, count: Optional[int]) -> None:
    if not value:
        return
    if not isinstance(value, list):
        raise Unprocessable("'goals' must be a list of objects with a 'kind'")
    try:
        goals = as_goals(value)
        check_indices(goals, 2**31 if count is None else count)
    except OverflowError:
        raise Unprocessable("a constraint refers to a vertex that does not exist") from None
    except ValueError as error:
        raise Unprocessable(sentence_of(error)) from None
    # The number of goals is checked with the mesh.
    if method != "auto" and not METHODS[method].takes(goals):
        able = " or ".join(own.name for own in METHODS.values() if own.takes(goals))
        raise Unprocessable(f"only the method {able} supports constraints; use it, or auto")


def _check_unknown(value: object) -> None:
    if value is None or value == "all":
        return
    if not isinstance(value, list):
        raise Unprocessable("'unknown' must be a list of the regions whose K is unknown, or \"all\"")
    for region in value:
        if whole(region, "every region of 'unknown'") < 0:
            raise Unprocessable(f"'unknown' refers to region {region}, which does not exist")


def _fixed(roles: list[str], problem: CGCProblem) -> list[int]:
    """Return the vertices whose role is fixed, by the user's names."""
    if len(roles) != len(problem.vertices):
        raise ValueError(f"'roles' must be a list of one role per vertex ({len(problem.vertices)} vertices)")
    return problem.names.vertices[np.array(roles) == "fixed"].tolist()


def read_targets(value: Any) -> Targets:
    """Return the targets in the form of a problem: one number, one per vertex (n,), or a dictionary by region [1/L^2]."""
    if isinstance(value, list):
        return np.array([np.nan if K is None else K for K in value], dtype=np.float64)
    return {int(region): K for region, K in value.items()} if isinstance(value, dict) else value
