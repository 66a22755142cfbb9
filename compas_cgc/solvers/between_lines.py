"""Roofs with held edges and K > 0: creases and free edges from a mesh of even triangles, then the one surface between them."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from itertools import chain
from typing import Optional

import numpy as np
from scipy.interpolate import CubicSpline

from ..discrete import edge_faces
from ..discrete import face_areas
from ..discrete.arrays import FloatArray
from ..discrete.arrays import Indices
from ..errors import joined
from ..meshing.coarse_plan import cut_at_turns
from ..meshing.creases import crease_paths
from ..model.divided import line_edges
from ..model.divided import with_short_lines
from ..model.goals.binding import equations_for_constants
from ..model.goals.binding import held_by_newton
from ..model.goals.binding import unknown_constants
from ..model.goals.binding import unknown_regions
from ..model.goals.guess import drawn_constant
from ..model.goals.inequalities import Bound
from ..model.measures import has_drifted
from ..model.measures import has_free_edges
from ..model.measures import is_held_all_round
from ..model.measures import measured_curvature
from ..model.measures import with_free_edges_held
from ..model.problem import CGCProblem
from ..model.recorder import Callback
from ..model.result import History
from ..model.result import Solution
from ..model.roles import FIXED
from .choices import Choice
from .coarse import Coarse
from .coarse import laid_out_anew
from .constants import CONVERGED
from .constants import EVEN_VERTICES
from .constants import LARGEST_FACTOR
from .determined import missed_goal
from .drawn_side import is_drawn_below
from .polish.derivatives import moves_by_constants
from .polish.polisher import polish
from .polish.settings import PolishSettings
from .registry import METHODS
from .registry import settings_of
from .running import judged
from .running import run_method
from .settings import Settings

__all__ = ["between_lines", "moves_of_lines"]

# points of a line per edge of the even triangles; vertices of the triangles are chosen among them, and a sixteenth is invisible
PLACES = 16
CORRECTIONS = 6  # corrections of K for goals [steps]; each leaves about a hundredth of the residual, so six reach the rounding level
# successive fractions of the fold length and of K̄; one search at full K̄, and one by continuation from stiffer creases with less K̄
WAYS = ((1.0, 1.0),), ((0.3, 0.5), (1.0, 0.8), (1.0, 1.0))


def between_lines(problem: CGCProblem, choice: Choice, settings: Optional[Settings], callback: Callback) -> Optional[Solution]:
    """Return the fair surface between the creases and free edges of the surface of least bending and folding, None if there is none.

    Towards a straight fixed edge one principal curvature is unbounded where K̄ > 0, and with it the bending energy. The lines are therefore
    found on a mesh of even triangles that does not depend on the given one, so that they rise alike on every mesh. The regions between them
    are solved on the given mesh. Unknown K that goals determine are those for which this surface meets them; they are found here over a
    rim that is held all round, too. If the callback cancels, the surface reached so far is returned.

    Parameters
    ----------
    problem
        With held edges, creases or free edges, and K̄ > 0.
    choice
        Whose methods solve the regions between the lines.
    settings
        Settings of the solve.
    callback
        Called after every step.
    """
    # Bounds that are met change nothing. Other goals need unknown K: creases that are pulled at single vertices snap between shapes.
    needed = [goal for goal in problem.goals if not isinstance(goal, Bound)] if unknown_constants(problem) else []
    asked = problem.with_goals(needed, add=False)
    lines = _lines_of(asked, settings, callback)
    if lines is None or lines.status == "cancelled":
        return lines
    if needed:
        between = _with_goals_met(asked, lines, choice, settings, callback)
    else:
        between = _between(lines, asked, choice, settings, callback)
    return between if between is None or between.status == "cancelled" or missed_goal(problem, between) is None else None


def _with_goals_met(
    asked: CGCProblem, lines: Solution, choice: Choice, settings: Optional[Settings], callback: Callback
) -> Optional[Solution]:
    """Return the surface between the lines of its K whose K meets goals, from lines near them; the nearest if no K meets them.

    On the even triangles lines snap by a little where K grows, so that some heights are left out. These are met between the nearest lines.

    References
    ----------
    Broyden, doi:10.1090/S0025-5718-1965-0198670-6.
    """
    equations, unknown = equations_for_constants(asked), unknown_constants(asked)
    guess = lines.with_found(asked).with_goals([], add=False)
    by_log: list[FloatArray] = []
    if not held_by_newton(asked):
        moves = moves_of_lines(guess, unknown_regions(asked), settings)
        if moves is None:
            return None
        by_log = [np.sum([drawn_constant(guess, region) * moves[region] for region in constant.regions], axis=0) for constant in unknown]
    tried: list[tuple[float, CGCProblem, Solution, Solution]] = []
    slopes, change, before = np.zeros((len(equations), len(unknown))), np.zeros(len(unknown)), np.zeros(len(equations))
    for correction in range(2 * CORRECTIONS):
        if correction == CORRECTIONS:
            _, guess, lines, nearest = min(tried, key=lambda one: one[0])
            if missed_goal(asked, nearest) is None:
                break
        elif correction < CORRECTIONS:
            own = _lines_of(guess, settings, callback)
            if own is None or own.status == "cancelled":
                return own
            lines = own
        solution = _between(lines._replace(targets=guess.targets), guess, choice, settings, callback)
        if solution is None or solution.status == "cancelled" or missed_goal(asked, solution, CONVERGED) is None:
            return solution
        missing = np.array([equation.value(solution.vertices) - equation.wanted for equation in equations])
        distance = float(np.linalg.norm(missing))
        if correction > CORRECTIONS and distance >= float(np.linalg.norm(before)):
            break  # heights of the lines themselves do not depend on K between them
        tried.append((distance, guess, lines, solution))
        if correction % CORRECTIONS:
            slopes += np.outer(missing - before - slopes @ change, change) / float(change @ change)
        elif by_log:
            slopes = np.array([[float((own.gradient(solution.vertices) * move).sum()) for move in by_log] for own in equations])
        else:
            # Rise and volume of a shallow dome go with the root of K.
            slopes = np.array([[0.5 * own.wanted] for own in equations])
        change, before = -np.linalg.pinv(slopes) @ missing, missing
        if not change.any():
            break
        change *= min(1.0, LARGEST_FACTOR / float(np.abs(change).max()))
        factors = [math.exp(log) for log, constant in zip(change.tolist(), unknown) for _ in constant.regions]
        regions = [region for constant in unknown for region in constant.regions]
        guess = guess.with_targets({region: factor * drawn_constant(guess, region) for region, factor in zip(regions, factors)})
    return min(tried, key=lambda one: one[0])[3]


def moves_of_lines(drawn: CGCProblem, regions: Sequence[int], settings: Optional[Settings] = None) -> Optional[dict[int, FloatArray]]:
    """Return the moves (n, 3) of creases and free edges, and of the surface on which they are found, per unit of K by region [L^3].

    Parameters
    ----------
    drawn
        The drawing, with K given.
    regions
        Their numbers.
    settings
        Settings of the solve.

    Returns
    -------
    dict or None
        By region; None where :func:`between_lines` finds no lines.
    """
    posed = drawn.with_goals([], add=False)
    even = _on_even_triangles(posed)
    posed = posed if even is None else even.problem
    found = _bent(posed, settings, None)
    if found.status != "converged":
        return None
    within = [[region] for region in range(drawn.number_of_regions())] if even is None else even.regions
    parts = {region: within[region] for region in regions}
    moves = moves_by_constants(posed, _settings(settings), found.vertices, chain.from_iterable(parts.values()))
    here, result = found if even is None else even.carried(found), {}
    for region, own in parts.items():
        ahead = found._replace(vertices=found.vertices + np.sum([moves[part] for part in own], axis=0))
        result[region] = (ahead if even is None else even.carried(ahead)).vertices - here.vertices
    return result


def _settings(settings: Optional[Settings]) -> PolishSettings:
    return settings_of(METHODS["bending"], settings)  # type: ignore[return-value]


def _bent(posed: CGCProblem, settings: Optional[Settings], callback: Callback) -> Solution:
    """Return the surface of least bending and folding; without goals, the one with less energy of two ways.

    On the way to full K single vertices of lines may snap through. Fewer of them do so where K is less and creases are stiffer at first.
    """
    if posed.goals:
        return run_method(METHODS["bending"], posed, settings=settings, callback=callback)
    given, ends = _settings(settings), []
    for way in WAYS:
        last: Optional[Solution] = None
        for folds, part in way:
            own = replace(given, fold_length=folds * given.fold_length)
            start = None if last is None else last.vertices
            last = polish(posed.with_targets(part * posed.targets), settings=own, start=start, callback=callback)
            if last.status == "cancelled":
                return last
            if last.status != "converged":
                break
        ends += [last] if last is not None else []
    return min(ends, key=lambda one: one.branches[0].energy if one.branches else math.inf)


def _lines_of(problem: CGCProblem, settings: Optional[Settings], callback: Callback) -> Optional[Solution]:
    """Return the surface of least bending and folding, on even triangles, at the vertices of the drawing; None if there is none.

    Over a rim that is held all round there are no lines, and it is the drawing with the K of angle defects.
    """
    if is_held_all_round(problem):
        return Solution(problem.vertices, "converged", "", 0, 0.0, 0.0, History.from_rows([]))
    if held_by_newton(problem):
        found = run_method(METHODS["newton"], problem, settings=settings, callback=callback)
        return found._replace(vertices=problem.vertices) if found.status in ("converged", "cancelled") else None
    even = _on_even_triangles(problem)
    if even is None and has_free_edges(problem):
        return None
    # A drawing without a plan bends on its own mesh.
    bent = _bent(problem, settings, callback) if even is None else _bent(even.problem, settings, even.shown(callback))
    if bent.status not in ("converged", "cancelled"):
        return None
    return bent if even is None else even.carried(bent)


def _between(
    solution: Solution, problem: CGCProblem, choice: Choice, settings: Optional[Settings], callback: Callback
) -> Optional[Solution]:
    """Return the fair surface with the K, the creases and the free edges of a solution, or what is there when cancelled; else None."""
    posed = solution.with_found(problem).with_goals([], add=False)
    held = with_free_edges_held(posed.with_vertices(solution.vertices))
    held = held.with_opposite_normals() if is_drawn_below(held) else held
    found: Optional[Solution] = None
    for then in choice.then:
        own = judged(run_method(METHODS[then.method], held, settings=settings, options=then.options, callback=callback), posed, callback)
        if own.status == "cancelled":
            return own
        if not own.is_fair:
            continue
        settled = not has_drifted(posed, measured_curvature(posed.with_vertices(own.vertices), own.measure))
        found = own if settled or found is None else found
        if settled:
            break
    if found is None:
        return None
    lines = " and ".join(["creases"] * bool(len(problem.creases)) + ["free edges"] * has_free_edges(problem))
    message = joined([found.message, f"{lines} are those of the surface that bends and folds least"]) if lines else found.message
    return found._replace(message=message, targets=solution.targets)


class _Even:
    """A problem on even triangles that do not depend on those of the drawing, and the interpolation back to the drawing."""

    def __init__(self, drawn: CGCProblem, fine: CGCProblem, even: Coarse):
        self.problem = even.problem
        self._count, self._fine, self._even = len(drawn.vertices), fine, even

    @property
    def regions(self) -> list[list[int]]:
        """Regions of the even triangles within each region of the drawing."""
        return self._even.regions

    def shown(self, callback: Callback) -> Callback:
        """Return a callback that gets the surfaces of the even triangles on the mesh of the drawing."""
        if callback is None:
            return None
        return lambda state: callback(state._replace(vertices=self._even.carried(state.vertices, anew=True)[: self._count]))

    def carried(self, solution: Solution) -> Solution:
        """Return a solution on the even triangles, interpolated on the mesh of the drawing; along lines by splines."""
        own = len(self._even.kept)
        vertices, plan = self._even.carried(solution.vertices, anew=True), self._even.flat
        moved = np.full(vertices.shape, np.nan)
        moved[self._even.kept] = solution.vertices[:own] - plan[self._even.kept]
        for path in _lines(self._fine, plan):
            vertices[path] = plan[path] + _along(plan[path], moved[path])
        vertices[~self._fine.movable] = self._fine.vertices[~self._fine.movable]
        targets = None if solution.targets is None else self._even.carried_targets(solution.targets)[: self._count]
        return solution._replace(vertices=vertices[: self._count], targets=targets, verdict=None, branches=())


def _on_even_triangles(problem: CGCProblem) -> Optional[_Even]:
    """Return a problem on even triangles; None where the drawing has no plan, or lines too close for so few triangles."""
    if not problem.real_faces.all():
        return None
    step = math.sqrt(float(face_areas(problem.vertices, problem.faces).sum()) / EVEN_VERTICES)
    edges = problem.vertices[line_edges(problem)]
    if float(np.linalg.norm(edges[:, 1] - edges[:, 0], axis=1).sum()) > EVEN_VERTICES * step:
        return None
    fine = with_short_lines(problem, step / PLACES)
    even = laid_out_anew(fine, EVEN_VERTICES, symmetric=True)
    return None if even is None else _Even(problem, fine, even)


def _lines(problem: CGCProblem, plan: FloatArray) -> list[Indices]:
    """Return the paths along creases and free edges, cut at junctions, sharp turns and supports."""
    edges = edge_faces(problem.faces)
    rim = edges[edges[:, 3] < 0, :2]
    held = problem.roles == FIXED
    # Creases may run along the rim.
    loose = np.unique(np.sort(np.vstack([problem.creases, rim[~held[rim].all(axis=1)]]), axis=1), axis=0)
    return [part for path in crease_paths(map(tuple, loose.tolist())) for part in cut_at_turns(plan, np.array(path), held)]


def _along(points: FloatArray, moved: FloatArray) -> FloatArray:
    """Return the moves (k, 3) along a path (k, 3) by a spline through those of some of its points, which are not NaN."""
    length = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(points, axis=0), axis=1))])
    known = np.isfinite(moved[:, 0])
    closed = len(points) > 2 and bool((points[0] == points[-1]).all())
    return np.asarray(CubicSpline(length[known], moved[known], bc_type="periodic" if closed else "not-a-knot")(length))
