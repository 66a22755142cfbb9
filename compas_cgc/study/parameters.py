"""Parameters: the quantities of a drawing that a study can vary, by their kind in the file."""

from __future__ import annotations

from collections.abc import Callable
from collections.abc import Mapping
from dataclasses import dataclass
from dataclasses import replace
from typing import Any
from typing import Union

import numpy as np

from ..discrete.arrays import Indices
from ..errors import CGCError
from ..model.constraint_data import constraint_of
from ..model.problem import CGCProblem
from .morph import moved_along
from .morph import straight_on
from .sampling import Values
from .sampling import values_of

__all__ = ["KINDS", "OF_DESIGNS", "OF_DRAWINGS", "Parameter", "parameter_of"]

Change = Callable[[CGCProblem, Any], CGCProblem]

# Goals, with the field of their number.
GOALS = {
    "rise": "rise",
    "height": "height",
    "volume": "volume",
    "area": "area",
    "length": "length",
    "above": "height",
    "below": "height",
    "clearance": "height",
    "near plane": "distance",
}
STRATEGIES = ("s", "e")
SHAPES = ("supports", "move")  # kinds that change the drawing itself, before targets and goals are set
OF_DRAWINGS = ("K", *STRATEGIES, *SHAPES, *GOALS)
OF_DESIGNS = ("moulds", "panel", "within", "seams")  # options of rationalise, for freeform designs
KINDS = (*OF_DRAWINGS, *OF_DESIGNS)
_WORDS = ("supports", "seams")  # kinds whose values are words or lists
_OF_VALUES = ("values", "from", "to", "count", "scale", "kind")
_OF_KIND = {
    "K": ("region",),
    "s": ("crease",),
    "e": ("crease",),
    "supports": (),
    "move": ("crease", "vertices", "direction"),
    **dict.fromkeys(OF_DESIGNS, ()),
}


@dataclass(frozen=True)
class Parameter:
    """A parameter of a study."""

    name: str
    kind: str  # one of KINDS
    values: Values
    more: Mapping[str, Any]  # region, crease, vertices, direction or place

    @property
    def is_shape(self) -> bool:
        """Whether it changes the drawing itself."""
        return self.kind in SHAPES

    def change(self, drawing: CGCProblem) -> Change:
        """Return a function that sets a value of the parameter in a problem; shared data are computed once here.

        Raises
        ------
        CGCError
            If a region, crease or vertex does not exist in the drawing.
        """
        try:
            return self._change(drawing)
        except (ValueError, TypeError) as error:
            raise CGCError(f"the parameter {self.name}: {error}") from None

    def _change(self, drawing: CGCProblem) -> Change:
        if self.kind == "K":
            region = self.more.get("region")
            within = np.ones(len(drawing.vertices), bool) if region is None else drawing.region_vertices(region)
            return lambda problem, K: replace(problem, targets=np.where(within, K, problem.targets))
        if self.kind in STRATEGIES:
            along = np.zeros(len(drawing.vertices), bool)
            along[_crease(drawing, self.more.get("crease"))] = True
            return lambda problem, value: replace(problem, **{self.kind: np.where(along, value, getattr(problem, self.kind))})
        if self.kind == "supports":
            return lambda problem, supports: problem.with_supports(supports)
        if self.kind == "move":
            crease = self.more.get("crease")
            moving = drawing.positions(self.more.get("vertices", ())) if crease is None else straight_on(drawing, int(crease))
            moved = moved_along(drawing, moving, np.array(self.more["direction"], dtype=np.float64), crease is not None)
            return lambda problem, distance: moved(distance)
        more = dict(self.more)
        if isinstance(more.get("where"), str):
            places = dict(drawing.drawing.places)
            if more["where"] not in places:
                known = f"the places are {', '.join(places)}" if places else "the drawing has no named places"
                raise CGCError(f"there is no place {more['where']!r} in the drawing; {known}")
            more["where"] = places[more["where"]]
        number = GOALS[self.kind]
        return lambda problem, value: problem.with_goals([constraint_of({**more, "kind": self.kind, number: value})])


def parameter_of(name: str, given: object) -> Parameter:
    """Return the parameter described by a table of the study; a list gives its values.

    Raises
    ------
    CGCError
        If the table is invalid; the message lists the valid entries.
    """
    table: Mapping[str, Any] = given if isinstance(given, Mapping) else {"values": given}
    kind = table.get("kind", name)
    if kind not in KINDS:
        raise CGCError(f"the kind of the parameter {name} is unknown; set kind to one of {', '.join(KINDS)}")
    more = {key: value for key, value in table.items() if key not in _OF_VALUES}
    unknown = [key for key in more if key not in _OF_KIND[kind]] if kind in _OF_KIND else []
    if unknown:
        known = ", ".join((*_OF_KIND[kind], *_OF_VALUES))
        raise CGCError(f"the parameter {name}: unknown key {unknown[0]!r} for the kind {kind}; the keys are {known}")
    values = values_of(name, table, words=kind in _WORDS)
    if kind == "move":
        more["direction"] = _direction(name, more.get("direction"))
        if ("crease" in more) is ("vertices" in more):
            raise CGCError(f"the parameter {name}: give either the number of a crease or a list of vertices to move")
    if kind in GOALS:
        if kind == "height":
            more.setdefault("vertices", "crown")
        _tried(name, {**more, "kind": kind, GOALS[kind]: values.all()[0]})
    return Parameter(name, kind, values, more)


def _tried(name: str, data: dict[str, Any]) -> None:
    if isinstance(data.get("where"), str):
        return  # a place of the drawing, checked later
    try:
        constraint_of(data)
    except (ValueError, TypeError) as error:
        raise CGCError(f"the parameter {name}: {error}") from None


def _direction(name: str, given: object) -> list[float]:
    vector: Union[list, np.ndarray] = np.asarray(given, dtype=object)
    try:
        numbers = [float(value) for value in vector]
    except (TypeError, ValueError):
        numbers = []
    if len(numbers) != 3 or not np.isfinite(numbers).all() or not any(numbers):
        raise CGCError(f"the parameter {name}: direction must be three numbers such as [0, 1, 0], not {given!r}")
    return numbers


def _crease(problem: CGCProblem, number: Any) -> Indices:
    paths = problem.crease_paths()
    if number is None:
        return np.unique([v for path in paths for v in path]).astype(np.int64)
    if not 0 <= int(number) < len(paths):
        raise CGCError(f"there is no crease {number}; the drawing has {len(paths)} creases, counted from 0")
    return np.array(paths[int(number)], dtype=np.int64)
