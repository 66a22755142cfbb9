"""What is asked of a mesh, read from JSON."""

from __future__ import annotations

from dataclasses import dataclass
from dataclasses import fields
from typing import TYPE_CHECKING
from typing import Optional
from typing import Union

import numpy as np

from ..errors import Unprocessable
from ..limits import Limits
from .decoding import number
from .decoding import whole

if TYPE_CHECKING:
    from ...model.checks import Names
    from ...model.problem import CGCProblem
    from ...solvers.projection import Constraint
    from ...solvers.registry import Settings

__all__ = ["OPTIONS", "Asked", "read_asked"]

OPTIONS = ("supports", "creases", "targets", "constraints", "method", "settings", "flip", "live", "name", "id")


@dataclass(frozen=True)
class Asked:
    """What is asked, apart from the mesh; None where nothing is said.

    Parameters
    ----------
    supports
        Vertices, ``"boundary"`` or ``"corners"``.
    creases
        Paths of vertices.
    targets
        A number, a number or None per vertex, or a number per region (by its number) [1/L^2].
    constraints
        What is asked besides K; vertices are counted from 0 in the order of the mesh.
    method
        A method of :func:`compas_cgc.solve`.
    settings
        Its settings by name.
    flip
        Whether to turn the mesh over.
    live
        Whether the moving surface is reported.
    """

    supports: Union[str, list[int], None] = None
    creases: Optional[list[list[int]]] = None
    targets: Union[float, list[Optional[float]], dict[int, float], None] = None
    constraints: tuple[Constraint, ...] = ()
    method: str = "auto"
    settings: Optional[dict] = None
    flip: bool = False
    live: bool = False

    def put_on(self, problem: CGCProblem, names: Names) -> CGCProblem:
        """Return a problem with all this asked of it.

        Raises
        ------
        ValueError
            If a crease does not follow edges, or there is no such vertex or region.
        """
        from ...model import posing

        if self.flip:
            problem = posing.flip(problem)
        if self.creases is not None:
            problem = posing.set_creases(problem, [_positions(path, names) for path in self.creases])
        if self.supports is not None:
            supports = self.supports if isinstance(self.supports, str) else _positions(self.supports, names)
            problem = posing.set_supports(problem, supports)
        if isinstance(self.targets, dict):
            for region, K in self.targets.items():
                problem = posing.set_target(problem, K, region)
        elif isinstance(self.targets, list):
            given = np.array([np.nan if K is None else K for K in self.targets], dtype=np.float64)
            problem = posing.set_target(problem, np.where(np.isnan(given), problem.targets, given))
        elif self.targets is not None:
            problem = posing.set_target(problem, self.targets)
        return problem

    def method_settings(self) -> Optional[Settings]:
        """Return the settings of the method, None where nothing is said."""
        return _settings(self.method, self.settings or {})


def _positions(keys: list[int], names: Names) -> list[int]:
    order = np.argsort(names.vertices, kind="stable")
    at = np.minimum(np.searchsorted(names.vertices, keys, sorter=order), len(order) - 1)
    found = order[at]
    lost = np.flatnonzero(names.vertices[found] != keys)
    if len(lost):
        raise ValueError(f"there is no vertex {keys[lost[0]]} in the mesh")
    return found.tolist()


def read_asked(value: dict, count: Optional[int], limits: Limits) -> Asked:
    """Return what is asked of a mesh of `count` vertices (None: not known yet).

    Raises
    ------
    Unprocessable
        With a sentence that names the field.
    """
    from ...solvers.registry import METHODS

    method = value.get("method", "auto")
    if method not in ("auto", *METHODS):
        raise Unprocessable(f"'method' must be one of auto, {', '.join(METHODS)}")
    creases = value.get("creases")
    if creases is not None:
        if not isinstance(creases, list):
            raise Unprocessable("'creases' must be a list of paths, each a list of vertices along edges")
        creases = [_indices(path, count, f"crease {i}") for i, path in enumerate(creases)]
    for name in ("flip", "live"):
        if not isinstance(value.get(name, False), bool):
            raise Unprocessable(f"'{name}' must be true or false")
    return Asked(
        _supports(value, count),
        creases,
        _targets(value.get("targets"), count),
        _constraints(value.get("constraints"), method, count),
        method,
        _checked_settings(method, value.get("settings"), limits),
        value.get("flip", False),
        value.get("live", False),
    )


def _supports(value: dict, count: Optional[int]) -> Union[str, list[int], None]:
    supports, roles = value.get("supports"), value.get("roles")
    if roles is not None:
        return _supports_of_roles(roles, count, value)
    if isinstance(supports, str):
        if supports not in ("boundary", "corners"):
            raise Unprocessable('\'supports\' must be a list of vertices, "boundary" or "corners"')
        return supports
    return None if supports is None else _indices(supports, count, "'supports'")


def _supports_of_roles(roles: object, count: Optional[int], value: dict) -> list[int]:
    if value.get("supports") is not None:
        raise Unprocessable("give 'roles' or 'supports', not both")
    if not isinstance(roles, list) or (count is not None and len(roles) != count):
        raise Unprocessable(f"'roles' must be a list of one role per vertex ({count})")
    wrong = next((i for i, role in enumerate(roles) if role not in ("internal", "fixed", "crease", "free")), None)
    if wrong is not None:
        raise Unprocessable(f"the role of vertex {wrong} must be internal, fixed, crease or free")
    if "crease" in roles and not value.get("creases"):
        raise Unprocessable("'roles' has crease vertices; say which edges fold as 'creases', paths of vertices")
    return [i for i, role in enumerate(roles) if role == "fixed"]


def _indices(value: object, count: Optional[int], what: str) -> list[int]:
    if not isinstance(value, list):
        raise Unprocessable(f"{what} must be a list of vertices")
    indices = [whole(v, f"every vertex of {what}") for v in value]
    wrong = [v for v in indices if v < 0 or (count is not None and v >= count)]
    if wrong:
        raise Unprocessable(f"{what} names vertex {wrong[0]}, which does not exist")
    return indices


def _targets(value: object, count: Optional[int]) -> Union[float, list[Optional[float]], dict[int, float], None]:
    if value is None:
        return None
    if isinstance(value, list):
        if count is not None and len(value) != count:
            raise Unprocessable(f"'targets' has {len(value)} numbers for {count} vertices; give one each, or one number for all")
        return [None if K is None else number(K, f"the target of vertex {i}") for i, K in enumerate(value)]
    if isinstance(value, dict):
        if not all(key.isdecimal() and len(key) < 7 for key in value):
            raise Unprocessable('\'targets\' by region must be named by the numbers of the regions, such as {"0": 0.01, "1": 0.04}')
        return {int(key): number(K, f"the target of region {key}") for key, K in value.items()}
    return number(value, "'targets'")


def _constraints(value: object, method: str, count: Optional[int]) -> tuple[Constraint, ...]:
    if not value:
        return ()
    from ...model.constraint_data import constraint_of
    from ...model.constraints import indices

    if not isinstance(value, list):
        raise Unprocessable("'constraints' must be a list of objects with a 'kind'")
    if method not in ("auto", "projection"):
        raise Unprocessable("only the method projection holds constraints; use it, or auto")
    try:
        constraints = tuple(constraint_of(item) for item in value)
        if count is not None:
            for constraint in constraints:
                indices(getattr(constraint, "vertices", ()), count)
    except OverflowError:
        raise Unprocessable("a constraint names a vertex that does not exist") from None
    except ValueError as error:
        raise Unprocessable(str(error)) from None
    return constraints


def _checked_settings(method: str, value: object, limits: Limits) -> dict:
    value = {} if value is None else value
    if not isinstance(value, dict):
        raise Unprocessable("'settings' must be an object of settings by name")
    for name, entry in value.items():
        if isinstance(entry, (int, float)) and not isinstance(entry, bool):
            number(entry, f"the setting {name:.40}")
        elif not (entry is None or isinstance(entry, (bool, str))):
            raise Unprocessable(f"the setting {name:.40} must be a number, a text, true or false")
    value = {name: whole(entry, f"the setting {name}") if name in ("steps", "q", "e") else entry for name, entry in value.items()}
    settings = _settings(method, value)
    if settings is not None and settings.steps > limits.steps:
        raise Unprocessable(f"the setting steps is {settings.steps}, the server takes at most {limits.steps} steps")
    return value


def _settings(method: str, value: dict) -> Optional[Settings]:
    """Return the settings of a method; with ``auto`` those of the only method that has all of them."""
    from ...solvers.registry import SETTINGS

    if not value:
        return None
    names = {kind: [field.name for field in fields(SETTINGS[kind])] for kind in (SETTINGS if method == "auto" else [method])}
    unknown = sorted(name for name in value if not any(name in known for known in names.values()))
    if unknown:
        known = ", ".join(dict.fromkeys(name for own in names.values() for name in own))
        raise Unprocessable(f"there is no setting {unknown[0]!r:.60}; there are {known}")
    kinds = [kind for kind, own in names.items() if set(value) <= set(own)]
    if len(kinds) != 1:
        raise Unprocessable(f"the settings {', '.join(sorted(value))} do not belong to one method; name it with 'method'")
    try:
        return SETTINGS[kinds[0]](**value)
    except (TypeError, ValueError) as error:
        raise Unprocessable(f"settings: {error}") from None
