"""A problem made ready to be projected again and again."""

from __future__ import annotations

import time
from collections.abc import Sequence
from dataclasses import replace
from typing import Callable
from typing import Optional

import numpy as np
from numpy.typing import ArrayLike

from ...discrete import edge_faces
from ...discrete.arrays import FloatArray
from ...errors import MeshError
from ...errors import ProblemError
from ...model.constraints import Constraint
from ...model.problem import CGCProblem
from ...model.result import History
from ...model.result import Solution
from ...model.result import SolveState
from ...model.result import stops
from .energy import energy_meter
from .messages import cause
from .messages import message
from .settings import ProjectionSettings
from .strategies import ways
from .system import System

__all__ = ["Projector"]


class Projector:
    """A mesh with roles and constraints, for which all that does not change is computed once.

    Parameters
    ----------
    problem
        Vertices, faces, roles and targets. The vertices are the drawing.
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
    >>> angle = np.arange(6) * np.pi / 3
    >>> vertices = np.vstack([[0, 0, 0], np.column_stack([np.cos(angle), np.sin(angle), 0 * angle])])
    >>> faces = [[0, 1 + i, 1 + (i + 1) % 6] for i in range(6)]
    >>> projector = Projector(CGCProblem(vertices, faces, roles=[0, 1, 1, 1, 1, 1, 1], targets=0.5))
    >>> cap = projector.solve()
    >>> lower = projector.solve(0.4, vertices=cap.vertices)
    >>> cap.status, lower.status, bool(lower.vertices[0, 2] < cap.vertices[0, 2])
    ('converged', 'converged', True)
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
        started = time.perf_counter()
        system, settings, scale2 = self._system, self.settings, self._frame.scale**2
        local = self._posed(targets, vertices)
        equations = system.equations(local.targets)
        energy = energy_meter(local, self._edges)
        goal = settings.tolerance * local.target_scale
        start = best = system.at(local.vertices, equations)
        status, rows = "stalled", []
        if start.fulfils(goal, 0.0 * system.floor):
            status = "converged"
        elif not len(system.columns):
            status = "infeasible"
        for taken in ways(system, equations, start, settings, vertices is not None) if status == "stalled" else ():
            here = system.at(taken.vertices, taken.equations or equations)
            best = min(best, here, key=lambda point: point.badness)
            errors = (here.error_norm / scale2, here.max_error / scale2)
            rows.append((energy(here.vertices) * self._frame.scale, *errors, taken.length, taken.trials, True))
            if taken.settled and here.fulfils(goal, system.floor):
                status, best = "converged", here
            elif len(rows) == settings.steps:
                status = "step_limit"
            if callback is not None:
                state = SolveState(len(rows), settings.steps, *rows[-1][:5], time.perf_counter() - started, self._to_model(here.vertices))
                if stops(callback, state) and status == "stalled":
                    status = "cancelled"
            if status != "stalled":
                break
        if status == "stalled" and best.fulfils(goal, system.rounding(best, equations)):
            status = "converged"
        why = cause(best, system, local.targets) if status in ("stalled", "infeasible") else ""
        max_error = best.max_error / scale2
        return Solution(
            self._to_model(best.vertices),
            status,
            message(status, len(rows), max_error, start.max_error / scale2, goal / scale2, why, settings.measure),
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

    def _to_model(self, vertices: FloatArray) -> FloatArray:
        # What may not move is handed back bit for bit, without the way through the frame.
        result = self.problem.vertices.copy()
        columns = self._system.columns
        result[columns] = self._frame.to_model(vertices[columns])
        return result
