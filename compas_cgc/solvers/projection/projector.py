"""A problem made ready to be projected again and again."""

from __future__ import annotations

from dataclasses import replace
from itertools import islice
from typing import Callable
from typing import Optional

import numpy as np
from numpy.typing import ArrayLike

from ...discrete import _kernels
from ...discrete import edge_faces
from ...discrete._memo import remembered
from ...discrete.arrays import FloatArray
from ...discrete.arrays import IntArray
from ...discrete.jacobian import CurvatureEquations
from ...discrete.space_form import EXACT
from ...discrete.space_form import SpaceFormEquations
from ...discrete.space_form import exact_equations
from ...errors import MeshError
from ...errors import ProblemError
from ...errors import Sentence
from ...errors import joined
from ...errors import names_what_was_meant
from ...errors import use_method
from ...linalg.work import until_spent
from ...model.goals.binding import bind
from ...model.goals.binding import unknown_regions
from ...model.goals.contradictions import refuse_impossible
from ...model.goals.guess import guessed
from ...model.problem import CGCProblem
from ...model.recorder import Callback
from ...model.recorder import Recorder
from ...model.result import Solution
from ...model.verdict import verdict
from ..constants import ANGLE_ROUNDING
from ..constants import LOCAL_ROUNDING
from ..constants import ROUNDINGS
from .coarse_to_fine import ways_from_coarse
from .drawing import as_meant
from .found_curvature import FoundCurvature
from .gauss_newton import FINISH
from .gauss_newton import descend
from .goal_seeking import goal_ways
from .iterate import Point
from .limits import limit
from .messages import cause
from .messages import drawn_in
from .messages import found
from .messages import laid_out_anew
from .messages import message
from .own_symmetry import colours
from .own_symmetry import kept_symmetries
from .own_symmetry import mirrors_and_own
from .own_symmetry import own_symmetries
from .settings import AUTO
from .settings import ProjectionSettings
from .starts import is_flat
from .strategies import ways
from .symmetry import Image
from .symmetry import tears_faces
from .system import System

__all__ = ["Projector", "project", "ready"]

READY = 3  # drawings whose matrices are kept; sliders and studies alternate between few

LED = "it was reached in steps, with smaller values of the goal first"
CLOSE = 0.25  # fraction of the rounding error at which these steps end; the last digits are then those of the symmetric surface


@names_what_was_meant()
class Projector:
    """Solver for a mesh with roles and constraints; quantities that do not depend on the targets are computed once.

    Parameters
    ----------
    problem
        Vertices, faces, roles, targets and constraints. The vertices are the drawing.
    settings
        Parameters.
    symmetric
        Whether the symmetries that the drawing has of itself are kept besides the mirrors that are asked for.

    Raises
    ------
    MeshError
        If the mesh has no faces, or is not an oriented manifold.
    ProblemError
        If a constraint cannot be.

    Examples
    --------
    >>> angle = np.arange(6) * np.pi / 3
    >>> vertices = np.vstack([[0, 0, 0], np.column_stack([np.cos(angle), np.sin(angle), 0 * angle])])
    >>> faces = [[0, 1 + i, 1 + (i + 1) % 6] for i in range(6)]
    >>> projector = Projector(CGCProblem(vertices, faces, roles=[0, 1, 1, 1, 1, 1, 1], targets=0.5))
    >>> cap = projector.solve()
    >>> lower = projector.solve(0.4, vertices=cap.vertices)
    >>> cap.status, lower.status, bool(lower.vertices[0, 2] < cap.vertices[0, 2])
    ('converged', 'converged', True)
    """

    def __init__(self, problem: CGCProblem, *, settings: Optional[ProjectionSettings] = None, symmetric: bool = False):
        if not len(problem.faces):
            raise MeshError("the mesh has no faces")
        self.settings = settings or ProjectionSettings()
        if self.settings.measure in EXACT and unknown_regions(problem):
            text = f"the method projection cannot find an unknown K in the measure {self.settings.measure}; use the method auto"
            raise ProblemError([Sentence(text, [use_method("auto")])])
        self.problem = guessed(problem)
        drawn, self._frame = self.problem.local()
        self._local = as_meant(drawn)
        own = mirrors_and_own(self._local) if symmetric else []
        # A sheet that supports carry along leans, and moves aside: edges stay over the lines of the drawing itself.
        self._system = System(self._local, self.settings, bind(drawn, problem.goals), own=own)
        refuse_impossible(self.problem)
        self._edges = edge_faces(problem.faces)
        self._symmetries: tuple[bytes, list[Image]] = b"", []
        self._kept: tuple[bytes, Optional[System]] = b"", None

    @property
    def flat(self) -> bool:
        """Whether the drawing is flat where much of the curvature is asked for."""
        equations = self._system.equations(self._local.targets)
        return is_flat(self._system, equations, self._system.at(self._local.vertices, equations))

    def solve(self, targets: Optional[ArrayLike] = None, vertices: Optional[ArrayLike] = None, *, callback: Callback = None) -> Solution:
        """Return the fairest surface with the curvature asked for.

        Parameters
        ----------
        targets
            K̄ [1/L^2], one number or ``(n,)``. Default: those of the problem.
        vertices
            ``(n, 3)`` shape to go on from, such as the last result [L]; what is fixed has
            to be where it is in the problem. Default: the vertices of the problem, and starts of our own.
        callback
            Called with a :class:`~compas_cgc.model.result.SolveState` after every step. To cancel,
            return True or raise ``StopIteration``.

        Returns
        -------
        Solution
            With the best shape that was reached. ``step_length`` in its history is the part
            of the full step that was taken.

        Raises
        ------
        ProblemError
            If a vertex where K is asked for has no target.
        """
        system, settings, scale2 = self._system, self.settings, self._frame.scale**2
        local = self.posed(targets, vertices)
        equations = system.equations(local.targets)
        asked = exact_equations(equations, settings.measure)
        energy = _energy_meter(local, self._edges)
        goal = settings.tolerance * local.target_scale
        drawn, start = system.at(local.vertices, equations), system.at(local.vertices, asked)
        best, used, layout = start, equations, False
        on, drawn_on = system, start.vertices  # the system of the best, and the last shape on the triangles that were drawn
        measure = "defect" if settings.measure == AUTO else settings.measure
        metered = system
        status, recorder = "stalled", Recorder(settings.steps, callback, self._frame, self.to_model)
        if start.fulfils(goal, 0.0 * system.floor):
            status = "converged"
        elif not len(system.columns):
            status = "infeasible"
        warm = vertices is not None
        if system.goals.whole or isinstance(equations, FoundCurvature):
            steps = goal_ways(system, equations, drawn, settings, warm)
        elif warm:
            steps = ways(system, equations, drawn, settings, True)
        else:
            steps = ways_from_coarse(local, system, equations, drawn, settings)
        for taken in until_spent(steps) if status == "stalled" else ():
            mesh = taken.system or system
            here = mesh.at(taken.vertices, taken.equations or asked)
            if here.badness < best.badness:
                best, on, layout = here, mesh, taken.equations is not None
            used = taken.equations or equations
            if mesh is system:
                drawn_on = here.vertices
            elif mesh is not metered:
                energy, metered = _energy_meter(replace(local, faces=mesh.faces), edge_faces(mesh.faces)), mesh
            recorder.record(energy(here.vertices), here.error_norm, here.max_error, taken.length, taken.trials)
            if taken.settled and here.fulfils(goal, system.floor):
                status, best, on = "converged", here, mesh
                measure = "smooth" if settings.measure == AUTO and taken.equations is not None else measure
            elif len(recorder) == settings.steps:
                status = "step_limit"
            if recorder.cancelled(here.vertices) and status == "stalled":
                status = "cancelled"
            if status != "stalled":
                break
        if on is not system:
            system, asked = on, exact_equations(on.equations(local.targets), settings.measure)
        if status == "stalled" and best.fulfils(goal, ROUNDINGS * system.rounding(best, asked)):
            status = "converged"
            measure = "smooth" if settings.measure == AUTO and layout else measure
        if status == "converged" and len(recorder) and measure == "defect" and not warm:
            best = self._symmetric(best, local, goal)
        why = cause(best, system, local.targets) if status in ("stalled", "infeasible") else ""
        if isinstance(asked, SpaceFormEquations) and status != "cancelled" and asked.too_large(best.vertices) is not None:
            status, why = "infeasible", asked.complaint(best.vertices)
        max_error = best.max_error / scale2
        sentence = message(status, len(recorder), max_error, start.max_error / scale2, goal / scale2, why, measure)
        faces = None if system is self._system else system.faces
        if faces is not None:
            sentence += "; " + laid_out_anew(
                self.problem.faces, faces, float(np.linalg.norm(best.vertices - drawn_on, axis=1).max()) * self._frame.scale
            )
        returned, axes = self.to_model(best.vertices), system.fairness.plan_axes
        if status == "converged" and axes is not None:
            sentence = joined(filter(None, [sentence, drawn_in(self.problem, axes, returned)]))
        targets = self._found(best, used, local.targets)
        if targets is not None:
            regions = unknown_regions(self.problem)
            own = [float(targets[self.problem.region_vertices(region)][0]) for region in regions]
            sentence += "; " + found(own, regions, len(system.goals.equations) + len(system.goals.places) + len(system.goals.sides))
        return Solution(
            returned,
            status,
            sentence,
            len(recorder),
            recorder.seconds,
            max_error,
            recorder.history,
            measure=measure,
            targets=targets,
            faces=faces,
        )

    def _symmetric(self, reached: Point, local: CGCProblem, goal: float) -> Point:
        """Return a surface with the symmetries that it nearly has, if the drawing has them; else the surface itself."""
        kept = kept_symmetries(reached.vertices, self._system.size, self._own_symmetries(replace(self._local, targets=local.targets)))
        if kept is None:
            return reached
        system = self._keeping(kept)
        equations = system.equations(local.targets)
        best = system.at(system.settled(system.places.symmetric(reached.vertices)), equations)
        polishing = until_spent(islice(descend(system, equations, best, patience=FINISH), FINISH))
        while not best.fulfils(goal, CLOSE * system.floor):
            taken = next(polishing, None)
            if taken is None:
                break
            best = min(best, system.at(taken.vertices, equations), key=lambda point: point.badness)
        # Compared as they are returned: rounding in the model's coordinates is part of them.
        told = [self._system.at(self._frame.to_local(self.to_model(one.vertices)), equations).residual for one in (best, reached)]
        left, had = (float(np.abs(residual).max(initial=0.0)) for residual in told)
        return best if best.fulfils(goal, system.floor) and left <= max(had, ANGLE_ROUNDING) else reached

    def _own_symmetries(self, drawn: CGCProblem) -> list[Image]:
        """Return the symmetries of the drawing with some targets, the last ones again where these are equal at the same vertices."""
        key, (name, symmetries) = colours(drawn).tobytes(), self._symmetries
        if name != key:
            symmetries = own_symmetries(drawn, self._system.goals)
            self._symmetries = key, symmetries
        return symmetries

    def _keeping(self, symmetries: list[Image]) -> System:
        """Return the system that keeps some symmetries, the last one again where they are the same."""
        key = b"".join(image.to.tobytes() for image in symmetries)
        name, system = self._kept
        if system is None or name != key:
            system = System(self._local, self.settings, self._system.goals, own=symmetries)
            self._kept = key, system
        return system

    def _found(self, point: Point, equations: CurvatureEquations, guess: FloatArray) -> Optional[FloatArray]:
        """Return the targets with those that were found (n,) [1/L^2], None where all were given."""
        if not isinstance(equations, FoundCurvature):
            return None
        own = equations.rows[equations.group >= 0]
        targets = self.problem.targets.copy()
        # What the smooth measure adds to the targets for the layout of the mesh is no part of K.
        reached = (equations.targets_of(point.vertices) - equations.targets + guess) / self._frame.scale**2
        for region in unknown_regions(self.problem):
            within = self.problem.region_vertices(region)
            rows = own[within[own]]
            # A sheet that nothing asks to curve is flat, but for rounding.
            K = float(reached[rows[0]]) if len(rows) else np.nan
            targets[within] = 0.0 if abs(K) * self._frame.scale**2 < LOCAL_ROUNDING else K
        return targets

    def posed(self, targets: Optional[ArrayLike] = None, vertices: Optional[ArrayLike] = None) -> CGCProblem:
        """Return the problem in the local frame with other targets and another shape, both as in the model."""
        local, rows, columns = self._local, self._system.rows, self._system.columns
        if targets is not None:
            local = replace(local, targets=np.asarray(targets, dtype=np.float64) * self._frame.scale**2)
        lost = rows[~np.isfinite(local.targets[rows])]
        if len(lost):
            raise ProblemError([f"vertex {lost[0]} has no target; give its region a K̄"])
        if vertices is not None:
            shape = np.asarray(vertices, dtype=np.float64)
            if shape.shape != local.vertices.shape:
                raise ValueError(f"vertices must have the shape {local.vertices.shape}, not {shape.shape}")
            moved = local.vertices.copy()
            moved[columns] = self._frame.to_local(shape[columns])
            local = replace(local, vertices=moved)
        return local

    def to_model(self, vertices: FloatArray) -> FloatArray:
        """Return a shape (n, 3) of the local frame in the model."""
        # What may not move is handed back bit for bit, without the way through the frame.
        result = self.problem.vertices.copy()
        columns = self._system.columns
        result[columns] = self._frame.to_model(vertices[columns])
        return result


def _made(vertices: FloatArray, faces: IntArray, roles: IntArray, creases: IntArray, settings: ProjectionSettings) -> Projector:
    """Return the projector of a drawing that asks for nothing but K, which is varied on one mesh more than anything else."""
    return Projector(CGCProblem(vertices, faces, roles, creases=creases), settings=settings)


def _of_mirrors(problem: CGCProblem, settings: Optional[ProjectionSettings], callback: Callback) -> Solution:
    """Return the solution under mirrors that take faces to none: K is asked twice over, and with the drawing's other symmetries once.

    A drawing with a shape keeps these; out of a flat one a saddle may break them, so there they come second.
    """
    plain, symmetric = Projector(problem, settings=settings), Projector(problem, settings=settings, symmetric=True)
    first, second = (plain, symmetric) if plain.flat else (symmetric, plain)
    solution = first.solve(callback=callback)
    if solution.status != "stalled":
        return solution
    other = second.solve(callback=callback)
    return other if other.status != "stalled" else min(solution, other, key=lambda one: one.max_error)


_ready = remembered(_made, recent=READY)


def ready(problem: CGCProblem, settings: Optional[ProjectionSettings] = None) -> Projector:
    """Return the projector of a problem without constraints, the last one again where only targets are others."""
    return _ready(problem.vertices, problem.faces, problem.roles, problem.creases, settings or ProjectionSettings())


@names_what_was_meant()
def project(problem: CGCProblem, *, settings: Optional[ProjectionSettings] = None, callback: Callback = None) -> Solution:
    r"""Return the fairest surface with the curvature asked for.

    Unknown are the three coordinates of every vertex that may move; there is an equation
    :math:`r_i = \text{defect}_i - \bar K_i A_i = 0` at every internal vertex, and none on
    creases and free edges. Of the many solutions it is one that bends least, and keeps to the
    drawing as far as the settings say,

    .. math:: \min \tfrac12\, x^T B x + \tfrac12\, |x - x_0|^2 \quad \text{subject to} \quad r(x) = 0,

    with B the bending energy of the shape and the distance weighed apart in plan and height. The
    way there is sequential quadratic programming from starts of its own or the one given, then Newton's
    method with the second derivatives of the equations, then least-norm steps to rounding. K may
    have any sign; no dummy mesh is needed.

    Parameters
    ----------
    problem
        Vertices, faces, roles, targets and constraints. The vertices are the drawing, of which the settings say what is kept.
    settings
        Parameters.
    callback
        Called with a :class:`~compas_cgc.model.result.SolveState` after every step. To cancel,
        return True or raise ``StopIteration``.

    Returns
    -------
    Solution
        With the best shape that was reached.

    Raises
    ------
    ProblemError
        If a constraint cannot be.

    References
    ----------
    Tang, Sun, Gomes, Wallner, Pottmann, *Form-finding with polyhedral meshes made simple*,
    doi:10.1145/2601097.2601213. Bergou, Wardetzky, Harmon, Zorin, Grinspun, *A quadratic bending model for
    inextensible surfaces*, doi:10.2312/SGP/SGP06/227-230.

    Examples
    --------
    >>> import compas_cgc
    >>> plan = compas_cgc.read(compas_cgc.get("canopy.3dm")).to_problem()
    >>> project(plan).status
    'converged'
    """
    if tears_faces(problem):
        solution = _of_mirrors(problem, settings, callback)
    elif problem.goals:
        solution = Projector(problem, settings=settings).solve(callback=callback)
    else:
        solution = ready(problem, settings).solve(problem.targets, callback=callback)
    if solution.status not in ("stalled", "converged") or not bind(problem).whole:
        return solution
    if solution.status == "converged" and verdict(solution.with_found(problem).with_vertices(solution.vertices), problem.vertices).fair:
        return solution
    had = limit(problem, solution, lambda other, start: Projector(other, settings=settings).solve(None, start, callback=callback))
    if had is not None and had.solution is not None:
        return had.solution._replace(message=joined([had.solution.message, LED]))
    if had is None or solution.status == "converged":
        return solution
    return solution._replace(status="infeasible", message=joined(["infeasible", solution.message[7:], "; ", had.words], ""))


def _energy_meter(problem: CGCProblem, edges: IntArray) -> Callable[[FloatArray], float]:
    """Return the Steiner energy Φ as a function of the vertices (n, 3).

    As :func:`compas_cgc.discrete.energy`, with the edges (e, 4) found beforehand.
    """
    faces, weight = problem.faces, problem.face_targets()

    def energy(vertices: FloatArray) -> float:
        crosses = _kernels.cross_vectors(vertices, faces)
        return float(_kernels.total_fold(vertices, crosses, edges) - _kernels.pyramids(vertices, faces, weight))

    return energy
