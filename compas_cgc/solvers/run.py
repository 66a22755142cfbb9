"""One call from a mesh to a surface of piecewise constant Gaussian curvature."""

from __future__ import annotations

from collections.abc import Callable
from collections.abc import Iterable
from collections.abc import Mapping
from dataclasses import replace
from typing import Any
from typing import Optional
from typing import Union

import numpy as np

from ..datastructures import CGCMesh
from ..datastructures import SolveResult
from ..datastructures.construction import ON_THE_MESH
from ..discrete._memo import remembering
from ..errors import names_what_was_meant
from ..model.checks import check
from ..model.checks import refuse
from ..model.constraint_data import as_goals
from ..model.constraints import Constraint
from ..model.goals.binding import unknown_constants
from ..model.goals.binding import with_level_edges_held
from ..model.goals.guess import drawn_constant
from ..model.goals.wholes import Unknown
from ..model.goals.wholes import is_of_whole
from ..model.problem import CGCProblem
from ..model.problem import Laws
from ..model.problem import PosesProblem
from ..model.problem import Targets
from ..model.problem import problem_of
from ..model.recorder import Callback
from ..model.recorder import refuse_no_callback
from ..model.recorder import show_arrived
from ..model.result import Solution
from ..model.result import SolveState
from ..model.roles import DUMMY
from ..model.tolerances import NEGLIGIBLE
from .continued import solved_on
from .half_sphere import with_half_a_sphere
from .registry import METHODS
from .registry import method_of
from .registry import options
from .registry import settings_for
from .running import run_method
from .selection import run_auto
from .settings import Settings

__all__ = ["chosen_settings", "solve"]


def _instead(name: str) -> str:
    """Return what to write in the place of an argument that a solve does not take."""
    if name in options():
        return f"it is a setting: solve(mesh, settings={{{name!r}: ...}})"
    if name in ON_THE_MESH:
        return f"set it on the mesh before the solve: mesh.{ON_THE_MESH[name]}"
    if name in ("rise", "height", "volume", "clearance"):
        return f"it is a goal: solve(mesh, goals=[compas_cgc.{name.capitalize()}(...)])"
    # tol, tolerances, max_steps: a part of a name is no misspelling of it. Symbols of the paper are parts of any word.
    meant = next((each for each in options() if min(len(name), len(each)) > 2 and (name in each or each in name)), None)
    return f"give settings in a dict: solve(mesh, settings={{{meant!r}: ...}})" if meant else ""


@names_what_was_meant(_instead)
@remembering()
def solve(
    problem: Union[CGCProblem, PosesProblem],
    *,
    method: str = "auto",
    settings: Union[Settings, Mapping[str, Any], None] = None,
    targets: Optional[Targets] = None,
    laws: Optional[Laws] = None,
    goals: Iterable[Union[Constraint, Mapping[str, Any]]] = (),
    unknown: Union[str, Iterable[int]] = (),
    callback: Callback = None,
) -> SolveResult:
    """Return the surface whose Gaussian curvature is the target in every region.

    Parameters
    ----------
    problem
        A mesh or problem with supports, creases, targets and goals; it is not changed. If it is a result, or the problem or mesh of a
        result with other targets, the solve starts from the surface of this result.
    method
        ``"auto"`` (default)
            Selects one of the other methods from the problem and the settings, reports the
            choice, and tries the next method if one stalls.
        ``"flow"``
            The paper's filtered Gaussian curvature flow with its strategies for creases,
            for K̄ >= 0, refined by Newton's method.
        ``"newton"``
            One unknown per vertex along its normal; for K̄ > 0 over fixed edges, or from
            an initial guess near the target; creases are fixed. The fastest method on large meshes.
        ``"projection"``
            The surface that bends least, with K from angle defects, for K̄ of any sign, with
            creases, goals, and free edges that may leave their drawn lines.
        ``"bending"``
            The surface that bends and folds least, with K from mid-edge normals (accurate to second
            order), for K̄ of any sign, with free edges over their drawn lines and goals for heights.
    settings
        :class:`FlowSettings`, :class:`NewtonSettings` or :class:`ProjectionSettings`, or options
        by name. With ``"auto"``, settings of one method select this method.
    targets
        K̄ other than those of the problem: a number for all, one per vertex, or a number by region [1/L^2].
    laws
        Laws other than those of the problem: one for all regions, or by region, as values such as ``ConstantMeanCurvature(0.1)`` or
        texts such as ``"H = 0.1"``.
    goals
        Requirements besides K, in addition to those of the problem: values such as ``Rise(4)`` and ``Height([12], 3)``, or their
        plain data such as ``{"kind": "rise", "rise": 4}``. Vertices are counted in the order of the mesh.
    unknown
        Numbers of regions whose K is determined by the solve; ``"all"`` for all regions. May be omitted if the mesh is one region
        without a target and has a goal such as ``Rise(4)``. The problem of the result contains the K that was found.
    callback
        Called with a :class:`~compas_cgc.model.result.SolveState` after every step; return
        True or raise ``StopIteration`` to cancel.

    Returns
    -------
    SolveResult
        The result, with a copy of the mesh. A solve that does not converge also returns a result.

    Raises
    ------
    ProblemError
        If :func:`compas_cgc.check` finds a problem that is fatal; the message contains its sentences.
    ValueError
        If the method does not exist, or does not support the settings or goals.

    Examples
    --------
    >>> mesh = CGCMesh.from_meshgrid(dx=9, nx=9)
    >>> mesh.set_supports("boundary")
    >>> mesh.set_target(0.01)
    >>> result = solve(mesh)
    >>> result.status, result.method
    ('converged', 'newton')
    """
    chosen = chosen_settings(method, settings)
    posed = problem_of(problem, "is solved")
    refuse_no_callback(callback)
    regions = _unknown_regions(unknown)
    found = [Unknown(regions)] if len(regions) else []
    posed = posed if targets is None else posed.with_targets(targets)
    posed = posed if laws is None else posed.with_laws(laws)
    posed = posed.with_goals([*as_goals(goals), *found])
    posed = _found_for_goals(posed)
    own = method if chosen is None else method_of(chosen)
    _check_laws(own, posed, chosen)
    _check_constraints(own, posed)
    drawn = posed.drawn if own in ("auto", "bending", "projection") else None
    surface, posed = posed, posed if drawn is None else drawn
    diagnostics = check(posed)
    refuse(diagnostics)
    if own == "auto" or not METHODS[own].has_dummies:
        # Faces outside a fixed rim would hide that the rim is fixed.
        posed = posed.without_dummies()
    of_real = callback and _RealOnly(callback, posed.roles != DUMMY)
    held = with_level_edges_held(posed)
    solution = solved_on(surface, held, own, chosen, of_real) if drawn is not None else None
    if solution is None:
        solution = _run(method, held, chosen, of_real)
    solution = _allowed(posed, solution)
    mesh = problem if isinstance(problem, CGCMesh) and targets is None and laws is None else None
    return SolveResult.from_solution(posed, solution, chosen, mesh, diagnostics)


def _found_for_goals(problem: CGCProblem) -> CGCProblem:
    """Return a problem whose K is to be found where a goal of the whole surface is all that says how high its one region shall be."""
    goals = problem.goals
    if problem.laws or any(isinstance(goal, Unknown) for goal in goals) or not any(is_of_whole(goal) for goal in goals):
        return problem
    known = not np.isnan(problem.targets[problem.asked]).all() or problem.regions()[problem.real_faces].any()
    return problem if known else problem.with_goals([Unknown()])


def _allowed(problem: CGCProblem, solution: Solution) -> Solution:
    """Return a solution that is not converged where an unknown K was found that its goal does not allow."""
    if solution.targets is None or solution.status != "converged":
        return solution
    found = problem.with_targets(solution.targets)
    for constant in unknown_constants(problem):
        for region in constant.regions:
            K = drawn_constant(found, region)
            drawn, goal = drawn_constant(problem, region), constant.goal
            if goal.sign is None and goal.bounds is None and np.isfinite(drawn) and drawn:
                goal = replace(goal, sign=int(np.sign(drawn)))
            slack = NEGLIGIBLE * abs(K)
            if region not in problem.laws and not goal.least - slack <= K <= goal.largest + slack:
                said = f"the other goals require K = {K:.6g} in region {region}, but it must be {goal.words}; change one of them"
                return solution._replace(status="infeasible", message=f"infeasible: {said}", verdict=None)
    return solution


def _unknown_regions(unknown: object) -> Union[str, list[int]]:
    """Return the regions whose K is to be found; one alone counts as a list of one."""
    if isinstance(unknown, bool) or not isinstance(unknown, (str, int, np.integer, Iterable)):
        raise ValueError(f"unknown must be numbers of regions, or 'all', not {unknown!r}")
    if isinstance(unknown, str):
        return unknown
    return [int(unknown)] if isinstance(unknown, (int, np.integer)) else [int(region) for region in unknown]


def chosen_settings(method: str, settings: Union[Settings, Mapping[str, Any], None]) -> Optional[Settings]:
    """Return settings, of the method that was asked for."""
    if settings is None or isinstance(settings, Mapping):
        made = settings_for(method, settings)
        return made if settings else None
    own = method_of(settings)
    if own != "auto" and method not in ("auto", own):
        raise ValueError(f"the method {method!r} takes {METHODS[method].settings.__name__}, not {type(settings).__name__}")
    if own == "auto" and method != "auto":
        return settings_for(method, settings.to_dict())
    return settings


def _check_laws(method: str, problem: CGCProblem, settings: Optional[Settings]) -> None:
    if not problem.laws:
        return
    measure = "auto" if settings is None else settings.to_dict().get("measure", "auto")
    if measure != "auto":
        raise ValueError(f"the measure {measure!r} supports constant K only; with other laws, use 'auto'")
    if method != "auto" and not METHODS[method].any_law:
        able = " or ".join(repr(own.name) for own in METHODS.values() if own.any_law)
        raise ValueError(f"only the method {able} accepts laws other than constant K; use it, or 'auto' without settings of another method")


def _check_constraints(method: str, problem: CGCProblem) -> None:
    if method != "auto" and not METHODS[method].takes(problem.goals):
        able = " or ".join(repr(own.name) for own in METHODS.values() if own.takes(problem.goals))
        raise ValueError(f"only the method {able} supports constraints; use it, or 'auto' without settings of another method")


def _run(method: str, problem: CGCProblem, settings: Optional[Settings], callback: Callback) -> Solution:
    if method == "auto":
        return run_auto(problem, settings=settings, callback=callback)
    return with_half_a_sphere(problem, run_method(METHODS[method], problem, settings=settings, callback=callback))


class _RealOnly:
    """A callback with the dummies taken out of what it sees."""

    def __init__(self, callback: Callable[[SolveState], object], real: np.ndarray):
        self.callback, self.real = callback, real

    def __call__(self, state: SolveState) -> object:
        return self.callback(state._replace(vertices=state.vertices[self.real]))

    def arrived(self, vertices: np.ndarray) -> None:
        show_arrived(self.callback, vertices[self.real])
