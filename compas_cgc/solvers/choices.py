"""Which methods a problem is tried with, the best first."""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType
from typing import Any
from typing import NamedTuple
from typing import Optional

import numpy as np

from ..model.goals.binding import finds_constants
from ..model.goals.binding import held_by_newton
from ..model.goals.binding import without_constants
from ..model.measures import has_free_edges
from ..model.measures import is_held_all_round
from ..model.measures import is_held_along_edges
from ..model.problem import CGCProblem
from ..model.roles import CREASE
from .determined import determining
from .polish.polisher import keeps_shape
from .polish.posed import takes_goals
from .registry import METHODS
from .registry import method_of
from .settings import Settings

__all__ = ["Choice", "choose"]


class Choice(NamedTuple):
    """A method and why."""

    method: str
    reason: str
    options: Mapping[str, Any] = MappingProxyType({})  # other than the defaults
    then: tuple[Choice, ...] = ()  # methods for the regions between the lines that were found, the best first


BENDING = Choice("bending", "it returns the surface that bends and folds least")
LAWS = Choice("bending", "no other method accepts laws other than constant K")
DRAWN = Choice("projection", "the drawing has a shape, which is kept")
HELD = Choice("projection", "the whole rim is fixed, which leaves no freedom to bend")
SOUGHT = Choice("bending", "it returns the surface that bends and folds least, and finds K for goals of the whole surface")
MEETS = Choice("bending", "it returns the surface that bends and folds least, and meets the goals")
MEASURED = Choice("projection", "the measure was given")
GOALS = Choice("projection", "it meets goals of all kinds")
FLOW = Choice("flow", "the strategies s or e of the flow are set on creases")
SMOOTH: Mapping[str, Any] = MappingProxyType({"measure": "smooth"})  # of order 1.5 beside straight fixed edges, others of order 1
RIM = Choice("newton", "the whole rim is fixed, there are no creases, and K̄ > 0", SMOOTH)
PLAIN_RIM = Choice("newton", "the whole rim is fixed, and the smooth measure does not converge")
BETWEEN = (RIM, PLAIN_RIM)
DETERMINED = "K̄ > 0 determines the surface between fixed edges and given creases and free edges"
ONE_UNKNOWN = Choice("newton", "the whole rim is fixed, and one goal determines one unknown K", SMOOTH)
# The smooth measure follows a shape of given K where it does not follow one whose K is sought.
GIVEN = Choice("newton", "the whole rim is fixed, and one goal determines one unknown K, found from surfaces of given K", then=BETWEEN)


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
    return [choice for choice in choices if "measure" in METHODS[choice.method].settings.options()] or [MEASURED]


def _choices(problem: CGCProblem) -> list[Choice]:
    if problem.laws:
        return [LAWS]
    alone = determining(problem)
    if alone is not None:
        return _choices(alone)
    if problem.goals:
        if held_by_newton(problem):
            return [ONE_UNKNOWN, GIVEN, GOALS]
        if finds_constants(problem) and not is_held_all_round(problem) and takes_goals(without_constants(problem)):
            return [*_between(problem, SOUGHT), GOALS]
        # The edges and the shape of a drawing that is kept are the projection's.
        loose = has_free_edges(problem) or len(problem.creases)
        if not loose or not takes_goals(problem) or keeps_shape(problem):
            return [GOALS]
        return [*_between(problem, MEETS), GOALS]
    strategies = np.isfinite(problem.s) | np.isfinite(problem.e)
    if (strategies & (problem.roles == CREASE)).any() and not (problem.types[problem.asked] < 0).any():
        return [FLOW, BENDING]
    if is_held_all_round(problem):
        return [RIM, PLAIN_RIM, BENDING]
    loose = has_free_edges(problem)
    if not loose and not len(problem.creases):
        return [HELD, BENDING]
    if not loose and is_held_along_edges(problem):
        return [*_between(problem, BENDING), HELD]
    return [DRAWN, BENDING] if keeps_shape(problem) else _between(problem, BENDING)


def _between(problem: CGCProblem, choice: Choice) -> list[Choice]:
    """Return a choice, first for lines between which the regions are solved, where some edges are held and K̄ > 0."""
    between = choice._replace(reason=DETERMINED, then=BETWEEN)
    return [between, choice] if is_held_along_edges(problem) else [choice]
