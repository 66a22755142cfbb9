"""A problem made ready to be projected again and again."""

from __future__ import annotations

import time
from collections.abc import Iterator
from collections.abc import Sequence
from dataclasses import replace
from typing import Callable
from typing import Optional

import numpy as np
from numpy.typing import ArrayLike

from ..discrete import edge_faces
from ..discrete.arrays import FloatArray
from ..discrete.jacobian import CurvatureEquations
from ..errors import MeshError
from ..errors import ProblemError
from ..problem import CGCProblem
from ..result import History
from ..result import Solution
from ..result import SolveState
from .constraints import Constraint
from .descent import Taken
from .descent import descend
from .descent import in_stages
from .energy import energy_meter
from .messages import cause
from .messages import enclosed_negative
from .messages import message
from .seed import flat_vertices
from .seed import seeded
from .settings import ProjectionSettings
from .system import Point
from .system import System

__all__ = ["Projector"]

FLAT_SHARE = 0.1  # part of the curvature asked for in flat places above which a seed is needed
IMPATIENT = 0.5  # what a few steps must make of the merit where the problem is over-determined
LESS, MORE = 0.5, 2.5  # smoothness of the second and third way, against the one asked for
ON = 1e-12  # distance from a constraint, in the local frame, that is rounding


class Projector:
    """A mesh with roles and constraints, for which all that does not change is computed once.

    Parameters
    ----------
    problem
        Vertices, faces, roles and targets. The vertices are the shape to stay near to.
    settings
        Parameters.
    constraints
        What is asked of vertices besides K; lengths in model units.

    Raises
    ------
    MeshError
        If the mesh has no faces, or is not an oriented manifold.
    ProblemError
        If a constraint cannot be.

    Examples
    --------
    >>> from compas_cgc.examples import *  # doctest: +SKIP
    """

    def __init__(self, problem: CGCProblem, settings: Optional[ProjectionSettings] = None, constraints: Sequence[Constraint] = ()):
        if not len(problem.faces):
            raise MeshError("the mesh has no faces")
        self.problem = problem
        self.settings = settings or ProjectionSettings()
        self._local, self._frame = problem.local()
        self._system = System(self._local, self.settings, [constraint.local(self._frame) for constraint in constraints])
        self._edges = edge_faces(problem.faces)

    def solve(
        self,
        targets: Optional[ArrayLike] = None,
        vertices: Optional[ArrayLike] = None,
        callback: Optional[Callable[[SolveState], object]] = None,
    ) -> Solution:
        """Move the vertices by the least that gives them the curvature asked for.

        Parameters
        ----------
        targets
            K̄ [1/L^2], one number or ``(n,)``. Default: those of the problem.
        vertices
            ``(n, 3)`` shape to set out from, such as the last result [L]; what is fixed has
            to be where it is in the problem. Default: the vertices of the problem.
        callback
            Called with a :class:`~compas_cgc.result.SolveState` after every step. To cancel,
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
        started = time.perf_counter()
        system, settings, scale2 = self._system, self.settings, self._frame.scale**2
        local = self._posed(targets, vertices)
        equations = system.equations(local.targets)
        energy = energy_meter(local, self._edges)
        goal = settings.tolerance * local.target_scale
        start = best = system.at(local.vertices, equations)
        status, rows = "stalled", []
        if _fulfilled(start, goal, 0.0):
            status = "converged"
        elif not len(system.columns):
            status = "infeasible"
        for taken in self._steps(local, equations, start) if status == "stalled" else ():
            here = system.at(taken.vertices, equations)
            best = min(best, here, key=_badness)
            errors = (here.error_norm / scale2, here.max_error / scale2)
            rows.append((energy(here.vertices) * self._frame.scale, *errors, taken.length, taken.trials, True))
            if _fulfilled(here, goal, system.floor):
                status, best = "converged", here
            elif len(rows) == settings.steps:
                status = "step_limit"
            if callback is not None:
                state = SolveState(len(rows), settings.steps, *rows[-1][:5], time.perf_counter() - started, self._to_model(here.vertices))
                if _stops(callback, state) and status == "stalled":
                    status = "cancelled"
            if status != "stalled":
                break
        if status == "stalled" and _fulfilled(best, goal, system.rounding(best, equations)):
            status = "converged"
        why = cause(best, system, local.targets) if status in ("stalled", "infeasible") else ""
        max_error = best.max_error / scale2
        return Solution(
            self._to_model(best.vertices),
            status,
            message(status, len(rows), max_error, start.max_error / scale2, goal / scale2, why),
            len(rows),
            time.perf_counter() - started,
            max_error,
            History.from_rows(rows),
        )

    def _posed(self, targets: Optional[ArrayLike], vertices: Optional[ArrayLike]) -> CGCProblem:
        """Return the local problem with other targets and another shape."""
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

    def _steps(self, local: CGCProblem, equations: CurvatureEquations, start: Point) -> Iterator[Taken]:
        """Take steps straight to the targets and, should that stall, in other ways from the start again."""
        system = self._system
        if self.settings.seed_height > 0:
            start = self._seeded(local, equations, start)
        start = system.at(system.settled(start.vertices), equations)
        if enclosed_negative(system, local.targets):
            # Over-determined: to insist on it would crumple the surface.
            yield from descend(system, equations, start, IMPATIENT)
            return
        yield from descend(system, equations, start)
        if self.settings.retry:
            yield from descend(system.smoother(LESS), equations, start)
            yield from in_stages(system.smoother(MORE), local.targets, start.vertices)

    def _seeded(self, local: CGCProblem, equations: CurvatureEquations, start: Point) -> Point:
        system, rows = self._system, self._system.rows
        wanted, targets = np.zeros(len(local.vertices)), local.targets[rows]
        wanted[rows] = targets * start.areas
        flat = flat_vertices(local.vertices, system.faces, wanted)
        if not np.abs(wanted[flat]).sum() > FLAT_SHARE * np.abs(wanted).sum():
            return start

        def defects(vertices: FloatArray) -> FloatArray:
            residual, areas = equations.measure(vertices)
            result = np.zeros(len(vertices))
            result[rows] = residual + targets * areas
            return result

        wanted = np.where(flat, wanted, 0.0)
        shape = seeded(local.vertices, system.faces, system.columns, system.stiffness, wanted, defects, self.settings.seed_height)
        return system.at(shape, equations)

    def _to_model(self, vertices: FloatArray) -> FloatArray:
        # What may not move is handed back bit for bit, without the way through the frame.
        result = self.problem.vertices.copy()
        columns = self._system.columns
        result[columns] = self._frame.to_model(vertices[columns])
        return result


def _fulfilled(point: Point, goal: float, floor: FloatArray | float) -> bool:
    """Return whether everything is reached, to the goal of |K - K̄| or to the floor of the residuals."""
    reached = np.abs(point.residual) <= np.maximum(goal * point.areas, floor)
    return bool(reached.all()) and bool((point.gap <= ON).all())


def _badness(point: Point) -> tuple[bool, float]:
    return bool((point.gap > ON).any()), point.error_norm


def _stops(callback: Callable[[SolveState], object], state: SolveState) -> bool:
    try:
        return callback(state) is True
    except StopIteration:
        return True
