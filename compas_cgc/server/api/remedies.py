"""Remedies that messages name, as changes of a request, so that a page can offer each as a button."""

from __future__ import annotations

import re
from collections.abc import Iterable
from collections.abc import Iterator
from typing import Callable
from typing import NamedTuple
from typing import Optional

import numpy as np

from ...datastructures import SolveResult
from ...meshing import boundary_loops
from ...model.problem import CGCProblem
from ...model.roles import FIXED

__all__ = ["NAMED", "REMEDIES", "Remedy", "named", "remedies_of"]

MORE_STEPS = 5  # factor of the number of steps
MARGIN = 0.95  # of the largest feasible K, which is found within 5 %
HALF = 0.5  # factor of K where no feasible K is known
FINER, COARSER = 0.7, 1.4  # factors of the edge length
GOALS = {
    "rise": "rise",
    "volume": "volume",
    "area": "area",
    "length of a path": "length",
    "lowest height": "above",
    "highest height": "below",
    "clearance": "clearance",
    "edge in plan": "edge in plan",
    "level edge": "level",
}  # kind of a goal by its name in messages
CHANGE = {
    "settings": {"type": "object", "description": "further settings of the method"},
    "method": {"type": "string"},
    "supports": {"enum": ["boundary"]},
    "release": {"type": "array", "items": {"type": "integer", "minimum": 0}, "description": "supported vertices to release"},
    "targets": {"type": "number", "description": "K, where one region has a target [1/L^2]"},
    "scale": {"type": "number", "description": "factor of all targets"},
    "limit": {"const": True, "description": "search for the largest feasible K, and use a little less"},
    "unknown": {"const": "all"},
    "without": {"type": "string", "description": "kind of a goal to remove"},
    "flip": {"const": True, "description": "reverse all faces"},
    "edge_length": {"type": "number", "description": "edge length of a new mesh [L]"},
    "edge_scale": {"type": "number", "description": "factor of the edge length of a new mesh"},
}
REMEDIES = {
    "type": "array",
    "description": "remedies that the messages name, the most specific first",
    "items": {
        "type": "object",
        "required": ["text", "change"],
        "properties": {"text": {"type": "string"}, "change": {"type": "object", "properties": CHANGE}},
    },
}


class Remedy(NamedTuple):
    """A change of a request."""

    text: str
    change: dict  # one field of CHANGE, with its value


def _steps(found: re.Match) -> Remedy:
    steps = MORE_STEPS * int(found[1])
    return Remedy(f"Allow {steps} steps", {"settings": {"steps": steps}})


def _method(found: re.Match) -> Remedy:
    return Remedy(f"Use the method {found[1]}", {"method": found[1]})


def _carried(found: re.Match) -> Optional[Remedy]:
    """Return the remedy for the largest K that the supports carry, None where the targets are below it."""
    factor = float(found["carried"]) / float(found["asked"]) if found["carried"] else float(found["factor"])
    return _scaled(MARGIN * factor) if factor < 1.0 else None


def _overload(found: re.Match) -> Remedy:
    return _scaled(MARGIN * float(found[2]) / float(found[1]))


def _scaled(factor: float) -> Remedy:
    return Remedy(f"Reduce K to {100.0 * factor:.2g} %", {"scale": float(f"{factor:.3g}")})


def _halved(_: re.Match) -> Remedy:
    return Remedy("Halve K", {"scale": HALF})


def _target(found: re.Match) -> Remedy:
    return Remedy(f"Set K = {found[1]}", {"targets": float(found[1])})


def _release(found: re.Match) -> Remedy:
    return Remedy(f"Free vertex {found[1]}", {"release": [int(found[1])]})


def _edge(found: re.Match) -> Remedy:
    return Remedy(f"Use an edge length of {found[1]}", {"edge_length": float(found[1])})


def _always(text: str, **change: object) -> Callable[[re.Match], Remedy]:
    return lambda _: Remedy(text, change)


NUMBER = r"(-?\d+(?:\.\d+)?(?:e[+-]?\d+)?)"
METHODS = "(auto|flow|newton|projection|bending)"
# What a message says, and the remedy that it names. Each is found in the package: tests/server/api/test_remedies.py
NAMED: tuple[tuple[str, Callable[[re.Match], Optional[Remedy]]], ...] = (
    (r"not converged in (\d+) steps?:.*allow more steps", _steps),
    (rf"use (?:the )?method '?{METHODS}", _method),
    (r"use another method there", _always("Use the method auto", method="auto")),
    (r"these supports carry \S+ (?:up|down) to (?P<carried>\S+?)(?P<factor>) .*; (?P<asked>\S+) is asked", _carried),
    (r"carry (?P<factor>\S+) times the targets(?P<carried>)", _carried),
    (r"the target (\S+) is more than this boundary can carry: no surface over its plane has K̄ above (\S+); lower", _overload),
    # Half may suffice where no feasible K is known; a search finds the largest one.
    (r"a smaller K̄|a smaller curvature|choose a K̄ nearer|choose another K̄|for less of", _halved),
    (rf"or set K = {NUMBER} there", _target),
    (rf"has K = {NUMBER}; ask for about that", _target),
    (rf"; K = {NUMBER} gives this mesh a gentle curvature", _target),
    (r"let K be found \(unknown\)", _always("Let K be found", unknown="all")),
    (r'supports "?boundary"? fixes the whole boundary|set_supports\(.boundary.\)', _always("Support the whole edge", supports="boundary")),
    (r"support at vertex (\d+)\D.*free that vertex", _release),
    (rf"use a (?:longer|shorter) edge, such as {NUMBER}", _edge),
    (r"flip the faces", _always("Flip the faces", flip=True)),
    (r"refine the mesh", _always("Mesh finer", edge_scale=FINER)),
    (r"mesh the drawing anew with fewer, even triangles|increase the edge length", _always("Mesh coarser", edge_scale=COARSER)),
)
REMOVE = re.compile(r"take one of them away|take that away|or take it away|remove (?:one of them|the goal)")


def named(messages: Iterable[str]) -> list[dict]:
    """Return the remedies that messages name, as JSON data: the label of a button, and the change of the request."""
    return [own._asdict() for own in _once(remedy for message in messages for remedy in _named(str(message)))]


def remedies_of(problem: CGCProblem, result: SolveResult, messages: Iterable[str] = ()) -> list[dict]:
    """Return the remedies for a solve without a fair surface: those that its messages name, then the usual ones.

    Parameters
    ----------
    problem
        The problem as posed.
    result
        What the solve returned.
    messages
        Further messages, such as those of the check.
    """
    sentences = [result.ending, *result.verdict.reasons, *messages]
    found = [remedy for message in sentences for remedy in _named(str(message))]
    known = any(own.change.get("scale", HALF) != HALF for own in found)
    return [own._asdict() for own in _once([*found, *_usual(problem, known)])]


def _named(message: str) -> Iterator[Remedy]:
    for pattern, make in NAMED:
        found = re.search(pattern, message)
        remedy = make(found) if found else None
        if remedy is not None:
            yield remedy
    if REMOVE.search(message):
        for name, kind in GOALS.items():
            if re.search(rf"\bthe {name}\b", message):
                yield Remedy(f"Remove the {name}", {"without": kind})


def _usual(problem: CGCProblem, known: bool) -> Iterator[Remedy]:
    """Yield what often helps; `known` is whether a message names how much smaller K must be."""
    targets = problem.targets[problem.asked]
    if np.isfinite(targets).all() and targets.any() and not known:
        yield Remedy("Set the largest feasible K", {"limit": True})
        yield Remedy("Halve K", {"scale": HALF})
    edge = np.concatenate([np.empty(0, np.int64), *boundary_loops(problem.faces)])
    if (problem.roles[edge] != FIXED).any():
        yield Remedy("Support the whole edge", {"supports": "boundary"})
    yield Remedy("Mesh finer", {"edge_scale": FINER})


def _once(remedies: Iterable[Remedy]) -> list[Remedy]:
    """Return remedies without later ones that change the same field; several goals can be removed."""
    seen: dict[tuple, Remedy] = {}
    for own in remedies:
        ((field, value),) = own.change.items()
        seen.setdefault((field, value) if field == "without" else (field,), own)
    return list(seen.values())
