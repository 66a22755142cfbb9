"""Which methods a problem is tried with, the best first."""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType
from typing import Any
from typing import NamedTuple
from typing import Optional

import numpy as np

from ..model.goals.binding import held_by_newton
from ..model.problem import CGCProblem
from ..model.roles import CREASE
from .registry import METHODS
from .registry import method_of
from .rising import is_held_all_round
from .settings import Settings
from .smoothed import is_drawn

__all__ = ["Choice", "choose", "is_due", "is_last_resort"]


class Choice(NamedTuple):
    """A method and why."""

    method: str
    reason: str
    second: bool = False  # a second chance, for a problem whose surface so far is rough
    options: Mapping[str, Any] = MappingProxyType({})  # other than the defaults
    # Or "domed", from a dome without folds; "supports", from the plate over them; "anew", on a mesh laid out anew; "edges", turned;
    # "meant", from the drawing with its waves taken out; or "smoothed" or "turned", from what was found so far.
    start: str = "drawn"


FLOW_STEPS = 400
# What it has not reached by then it does not reach, and meshes of some size would take their time.
FLOW = Choice("flow", "the paper's flow reaches K̄ >= 0 from afar", False, MappingProxyType({"steps": FLOW_STEPS}))
FREED = MappingProxyType({"keep": "nothing", "retry": False})
ANEW = Choice(
    "projection", "on a mesh laid out anew first it is fairer", True, MappingProxyType({"keep": "shape", "nearness": 0.5}), start="anew"
)
SMOOTHED = Choice("projection", "from what was found, smoothed, it is fairer", True, MappingProxyType({"keep": "shape"}), "smoothed")
OTHERS = [
    Choice("projection", "free of the drawing it is fairer", True, FREED),
    Choice("projection", "nearer to the drawing it is fairer", True, MappingProxyType({"keep": "shape", "retry": False}), "meant"),
    Choice("projection", "bulging to the other side it is fairer", True, MappingProxyType({"keep": "shape"}), "turned"),
]
SUPPORTED = Choice("projection", "from its supports alone it is fairer", True, MappingProxyType({"keep": "plan"}), "supports")
SECOND = [SUPPORTED, ANEW, SMOOTHED, *OTHERS]
EDGES = Choice("projection", "with edges turned it is fairer", True, MappingProxyType({"keep": "shape"}), "edges")
EDGES_FREE = Choice(
    "projection",
    "with edges turned, free of the drawing, it is fairer",
    True,
    FREED,
    "edges",
)
BENDING = Choice("bending", "it bends and folds least, with the curvature prescribed up to creases and free edges")
SMOOTH = MappingProxyType({"measure": "smooth"})  # towards a straight rim K is bounded, but one principal curvature is not
DOMED = Choice("projection", "it finds the fairest surface, with creases, on from a dome without them", start="domed")
LOST = Choice("projection", "from its drawing, smoothed, it arrives", True, MappingProxyType({"keep": "shape", "retry": False}), "meant")
STALLED = Choice("projection", "from where it stalled, smoothed, it arrives", True, MappingProxyType({"keep": "shape"}), "smoothed")


def choose(problem: CGCProblem, settings: Optional[Settings] = None) -> list[Choice]:
    """Return the methods to try, the best first.

    Parameters
    ----------
    problem
        Vertices, faces, roles, targets and constraints.
    settings
        Settings of a method choose that method.
    """
    if settings is not None and method_of(settings) != "auto":
        return [Choice(method_of(settings), f"its settings were given ({type(settings).__name__})")]
    choices = _choices(problem)
    if settings is None or settings.to_dict()["measure"] == "auto":
        return choices
    return [choice for choice in choices if "measure" in METHODS[choice.method].settings.options()]


def _choices(problem: CGCProblem) -> list[Choice]:
    targets = problem.targets[problem.asked]
    if held_by_newton(problem):
        return [
            Choice("newton", "the whole edge is fixed, and one goal is asked for one unknown K"),
            Choice("projection", "it moves vertices sideways too"),
        ]
    if problem.goals:
        return [Choice("projection", "it alone holds constraints"), *SECOND]
    if (targets < 0).any():
        first = Choice("projection", "it moves vertices sideways too")
        # What is drawn knows its shape, and edges turned as it asks keep that; a plan is better laid out anew.
        second = [EDGES, LOST, STALLED, ANEW] if is_drawn(problem) else [ANEW, EDGES, STALLED]
        return [BENDING, first, *second, SMOOTHED, EDGES_FREE, *OTHERS]
    strategies = np.isfinite(problem.s) | np.isfinite(problem.e)
    if (strategies & (problem.roles == CREASE)).any():
        return [Choice("flow", "s or e are set on creases, strategies of the flow"), Choice("projection", "it needs no strategy")]
    if is_held_all_round(problem):
        return [
            Choice("newton", "the whole edge is fixed, there are no creases, and K̄ > 0"),
            Choice("projection", "it moves vertices sideways too"),
            FLOW,
        ]
    fairest = Choice("projection", "it finds the fairest surface, with free edges and creases, for any K̄")
    lost = [LOST] if is_drawn(problem) else []
    return [DOMED if is_held_all_round(problem, folded=True) else BENDING, fairest, *lost, STALLED, *SECOND, FLOW]


def is_due(choice: Choice, rough: bool) -> bool:
    """Return whether a choice is for what has come out so far: something rough, or nothing."""
    return not rough if choice in (LOST, STALLED) else choice.start in ("anew", "edges") or choice.second is rough


def is_last_resort(choice: Choice) -> bool:
    """Return whether a choice is for problems that the ordinary methods have not solved."""
    return choice is FLOW or choice is STALLED or choice.second
