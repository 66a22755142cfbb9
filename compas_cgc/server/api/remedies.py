"""Remedies of messages as changes of a request, so that a page can offer each as a button."""

from __future__ import annotations

from collections.abc import Iterable
from collections.abc import Iterator
from typing import Any
from typing import Callable

import numpy as np

from ...datastructures import SolveResult
from ...errors import FINER
from ...errors import HALF
from ...errors import HALVED
from ...errors import Remedy
from ...model.inward_edges import dividing_creases
from ...model.measures import has_free_edges
from ...model.measures import inward_supports
from ...model.problem import CGCProblem
from ...solvers.reasons import contradiction

__all__ = ["CHANGE", "REMEDIES", "TEXTS", "remedies_in", "remedies_of"]

GOALS = {
    "length": "length of a path",
    "above": "lowest height",
    "below": "highest height",
    "level": "level edge",
    "surface": "position on a surface",
    "within": "outline to stay within",
    "near plane": "distance from a plane",
    "unknown": "unknown K",
}  # name of a goal by its kind, where these differ
CHANGE = {
    "settings": {"type": "object", "description": "further settings of the method"},
    "method": {"type": "string"},
    "supports": {"enum": ["boundary"]},
    "release": {"type": "array", "items": {"type": "integer", "minimum": 0}, "description": "supported vertices to release"},
    "targets": {"type": "number", "description": "K, where one region has a target [1/L^2]"},
    "scale": {"type": "number", "description": "factor of all targets"},
    "unknown": {"const": "all"},
    "without": {"type": "string", "description": "kind of a goal to remove"},
    "creases": {
        "type": "array",
        "items": {"type": "array", "items": {"type": "array", "items": {"type": "number"}, "minItems": 2, "maxItems": 2}, "minItems": 2},
        "description": "lines in plan along which the surface may fold, of a new mesh [L]",
    },
    # An enumeration, as generators of clients write no valid code for a constant that is true.
    "flip": {"type": "boolean", "enum": [True], "description": "reverse all faces"},
    "edge_length": {"type": "number", "description": "edge length of a new mesh [L]"},
    "edge_scale": {"type": "number", "description": "factor of the edge length of a new mesh"},
}
REMEDIES = {
    "type": "array",
    "description": "remedies of the messages, the most specific first",
    "items": {
        "type": "object",
        "required": ["text", "change"],
        "properties": {"text": {"type": "string"}, "change": {"type": "object", "properties": CHANGE}},
    },
}


TEXTS: dict[str, Callable[[Any], str]] = {
    "settings": lambda settings: f"Allow {settings['steps']} steps",
    "method": "Use the method {}".format,
    "supports": lambda _: "Support the whole edge",
    "release": lambda vertices: f"Free {'vertex' if len(vertices) == 1 else 'vertices'} {', '.join(map(str, vertices))}",
    "targets": "Set K = {:g}".format,
    "scale": lambda factor: {HALF: "Halve K", -1.0: "Reverse the sign of K"}.get(factor, f"Reduce K to {100.0 * factor:.2g} %"),
    "unknown": lambda _: "Let K be found",
    "without": lambda kind: f"Remove the {GOALS.get(kind, kind)}",
    "creases": lambda lines: "Draw a crease from the inward corner" if len(lines) == 1 else "Draw creases from the inward corners",
    "flip": lambda _: "Flip the faces",
    "edge_length": "Use an edge length of {:g}".format,
    "edge_scale": lambda factor: "Mesh finer" if factor < 1.0 else "Mesh coarser",
}  # label of the button by the field of CHANGE


def remedies_in(messages: Iterable[str]) -> list[dict]:
    """Return the remedies of messages, as JSON data: the label of a button, and the change of the request."""
    return _as_data(own for message in messages for own in getattr(message, "remedies", ()))


def remedies_of(problem: CGCProblem, result: SolveResult, messages: Iterable[str] = ()) -> list[dict]:
    """Return the remedies for a solve without a fair surface, those of its certain causes first.

    A smaller K is proposed where no message names a cause: for such surfaces, the solve has searched what the supports carry.

    Parameters
    ----------
    problem
        The problem as posed.
    result
        What the solve returned.
    messages
        Further messages, such as those of the check.
    """
    found = [own for message in (result.ending, *result.verdict.reasons, *messages) for own in getattr(message, "remedies", ())]
    causes = list(_corners(problem))
    others = [own for own in found if own != HALVED]
    targets = problem.targets[problem.asked]
    if not causes and not contradiction(problem) and not any(field in ("scale", "targets") for field, _ in others):
        others = [*found, *([HALVED] if np.isfinite(targets).all() and targets.any() else [])]
    freed = sorted({vertex for field, value in [*found, *causes] if field == "release" for vertex in value})
    return _as_data([*([Remedy("release", freed)] if freed else []), *causes, *others, *_usual(problem)])


def _corners(problem: CGCProblem) -> Iterator[Remedy]:
    """Yield the remedies for inward corners, which a surface of K > 0 can rarely pass, of any size of K."""
    if (problem.types[problem.asked] > 0).all() and (inward := inward_supports(problem)):
        yield Remedy("release", inward)
    yield from dividing_creases(problem.without_dummies())


def _usual(problem: CGCProblem) -> Iterator[Remedy]:
    """Yield what often helps."""
    if has_free_edges(problem):
        yield Remedy("supports", "boundary")
    yield FINER


def _as_data(remedies: Iterable[Remedy]) -> list[dict]:
    """Return remedies as JSON data without later ones that change the same field; several goals can be removed."""
    seen: dict[object, dict] = {}
    for field, value in remedies:
        key = (field, value) if field == "without" else field
        seen.setdefault(key, {"text": TEXTS[field](value), "change": {field: value}})
    return list(seen.values())
