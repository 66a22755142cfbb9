"""Held roofs that fold: creases from even triangles of a given number, and the one surface that rim and K determine between them."""

from __future__ import annotations

from functools import partial
from typing import Optional

import numpy as np
from scipy.interpolate import CubicSpline

from ..discrete.arrays import FloatArray
from ..errors import joined
from ..model.goals.binding import unknown_constants
from ..model.goals.inequalities import Bound
from ..model.problem import CGCProblem
from ..model.divided import quartered
from ..model.recorder import Callback
from ..model.result import Solution
from .choices import Choice
from .coarse import Coarse
from .coarse import laid_out_anew
from .determined import missed_goal
from .determined import with_missed_added
from .drawn_side import is_drawn_below
from .polish.polisher import polish
from .registry import METHODS
from .registry import settings_of
from .running import judged
from .running import run_method
from .settings import Settings

__all__ = ["between_lines"]

EVEN = 600  # vertices of the even triangles on which creases are found
FINENESS = 64  # vertices, for one of these, of the mesh from whose edges theirs are taken, so that they are evenly spaced
CORRECTIONS = 8  # of goals; every one leaves about a tenth of what was missed
ROUNDED = 1e-10  # what goals are missed by, against their numbers or the size, that is rounding


def between_lines(problem: CGCProblem, choice: Choice, settings: Optional[Settings], callback: Callback) -> Optional[Solution]:
    """Return the fair surface between the creases of one that bends and folds least, or what is there when cancelled; else None.

    Creases are found by the method of a choice on even triangles of a given number, so that they rise alike on every mesh: towards a
    straight fixed edge one principal curvature is unbounded where K̄ > 0, and bending energy with it. The regions between them are
    solved on the mesh itself. Goals that determine unknown K are asked for with what they miss there added, until they are met
    (deferred correction).

    Parameters
    ----------
    problem
        With a rim that is held all round, creases, and K̄ > 0.
    choice
        How creases are found, and then the regions.
    settings
        That all methods have.
    callback
        Called after every step.
    """
    # Goals that are met anyway change nothing. Others need unknown K: creases pulled at a few vertices snap from shape to shape.
    needed = [goal for goal in problem.goals if not isinstance(goal, Bound)] if unknown_constants(problem) else []
    asked = problem.with_goals(needed, add=False)
    even = _creased(asked)
    # Without a plan the mesh itself has to do.
    posed, shown = (asked, callback) if even is None else (even.problem, even.shown(callback))
    best: Optional[Solution] = None
    for _ in range(CORRECTIONS):
        found = _bent(posed, choice, settings, shown)
        found = found if even is None else even.carried(found)
        if found.status == "cancelled":
            return found
        between = None if found.status != "converged" else _between(found, problem, choice, settings, callback)
        if between is None or between.status == "cancelled":
            return between
        # A last correction where goals are met leaves rounding.
        corrected = None
        if missed_goal(asked, between, ROUNDED) is not None and best is None:
            corrected = with_missed_added(posed, asked, between.vertices)
        if missed_goal(asked, between) is None:
            best = between
        if corrected is None:
            break
        posed = corrected
    return best if best is not None and missed_goal(problem, best) is None else None


def _bent(posed: CGCProblem, choice: Choice, settings: Optional[Settings], callback: Callback) -> Solution:
    """Return the surface that bends and folds least: without goals, of two ways the one that ends with less energy.

    On a long way folds may snap through at single vertices. Half of K̄ is on the second way.
    """
    run = partial(run_method, METHODS[choice.method], settings=settings, options=choice.options, callback=callback)
    straight = run(posed)
    if posed.goals or straight.status != "converged":
        return straight
    half = run(posed.with_targets(0.5 * posed.targets))
    if half.status != "converged":
        return half if half.status == "cancelled" else straight
    own = settings_of(METHODS[choice.method], settings)
    other = polish(posed, settings=own, start=half.vertices, callback=callback)  # type: ignore[arg-type]
    if other.status != "converged":
        return other if other.status == "cancelled" else straight
    return min(straight, other, key=lambda one: one.branches[0].energy)


def _between(
    solution: Solution, problem: CGCProblem, choice: Choice, settings: Optional[Settings], callback: Callback
) -> Optional[Solution]:
    """Return the fair surface with the K and the creases of a solution, or what is there when cancelled; else None."""
    posed = solution.with_found(problem).with_goals([], add=False)
    found = posed.with_vertices(solution.vertices)
    found = found.with_opposite_normals() if is_drawn_below(found) else found
    for then in choice.then:
        own = judged(run_method(METHODS[then.method], found, settings=settings, options=then.options, callback=callback), posed, callback)
        if own.is_fair:
            message = joined([own.message, "between the creases of a surface that bends and folds least"], " ")
            return own._replace(message=message, targets=solution.targets)
        if own.status == "cancelled":
            return own
    return None


class _Creased:
    """A problem on even triangles that do not depend on those of the drawing, and the way back along its creases.

    Towards a straight fixed edge one principal curvature is unbounded where K̄ > 0, and bending energy with it: on ever finer meshes
    creases that bend and fold least would rise without end. On even triangles of a given number they rise alike for every mesh.
    """

    def __init__(self, problem: CGCProblem, fine: CGCProblem, even: Coarse):
        self.problem = even.problem
        self._drawn, self._fine, self._even = problem, fine, even

    def shown(self, callback: Callback) -> Callback:
        """Return what shows the surfaces of the even triangles on the mesh itself."""
        if callback is None:
            return None
        count = len(self._drawn.vertices)
        return lambda state: callback(state._replace(vertices=self._even.carried(state.vertices, anew=True)[:count]))

    def carried(self, solution: Solution) -> Solution:
        """Return a solution on the even triangles as one on the mesh itself: along creases it is that of splines."""
        count, own = len(self._drawn.vertices), len(self._even.kept)
        vertices, plan = self._even.carried(solution.vertices, anew=True), self._even.flat
        moved = np.full(vertices.shape, np.nan)
        moved[self._even.kept] = solution.vertices[:own] - plan[self._even.kept]
        for path in self._fine.crease_paths():
            vertices[path] = plan[path] + _along(plan[path], moved[path])
        vertices[~self._fine.movable] = self._fine.vertices[~self._fine.movable]
        targets = None if solution.targets is None else self._even.carried_targets(solution.targets)[:count]
        return solution._replace(vertices=vertices[:count], targets=targets, verdict=None, branches=())


def _creased(problem: CGCProblem) -> Optional[_Creased]:
    """Return a problem on even triangles; None where the drawing has no plan, or lines too close for so few triangles."""
    fine = problem
    while len(fine.vertices) < FINENESS * EVEN:
        fine = quartered(fine)
    even = laid_out_anew(fine, EVEN)
    return None if even is None else _Creased(problem, fine, even)


def _along(points: FloatArray, moved: FloatArray) -> FloatArray:
    """Return the moves (k, 3) along a path (k, 3) by a spline through those of some of its points, which are not NaN."""
    length = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(points, axis=0), axis=1))])
    known = np.isfinite(moved[:, 0])
    closed = len(points) > 2 and bool((points[0] == points[-1]).all())
    return np.asarray(CubicSpline(length[known], moved[known], bc_type="periodic" if closed else "not-a-knot")(length))
