"""The surface of least bending and folding energy with the curvature prescribed, by mid-edge normals."""

from __future__ import annotations

import math
from typing import Optional

import numpy as np

from ...discrete import energy
from ...discrete import face_areas
from ...discrete.arrays import FloatArray
from ...errors import ProblemError
from ...errors import names_what_was_meant
from ...model.measures import MID_EDGE
from ...model.problem import CGCProblem
from ...model.recorder import Callback
from ...model.recorder import Recorder
from ...model.result import Solution
from ...model.roles import DUMMY
from .lagrangian import Lagrangian
from .lagrangian import State
from .optimiser import steps
from .posed import posed
from .settings import PolishSettings
from .starts import is_drawn
from .starts import starts

__all__ = ["polish"]

ROUNDING = 64.0  # roundings of a coordinate, times the curvature, that residuals are at least
WAVES = 0.1  # length against the square root of the area: shorter waves of a drawing that is kept are smoothed
EPS = float(np.finfo(float).eps)


@names_what_was_meant()
def polish(problem: CGCProblem, *, settings: Optional[PolishSettings] = None, callback: Callback = None) -> Solution:
    r"""Return the surface that bends and folds least among those with the curvature prescribed.

    .. math:: \min \int |II|^2 \, dA + \frac1\ell \int \vartheta^2 \, ds \quad \text{subject to} \quad K = \bar K
              \text{ in every region, up to its creases and free edges,}

    by mid-edge normals: one move per vertex along a fixed direction, one angle per edge and two per crease edge.

    Parameters
    ----------
    problem
        Vertices, faces, roles, creases and targets. Vertices on free edges stay over their drawn lines.
    settings
        Parameters.
    callback
        Called with a :class:`~compas_cgc.model.result.SolveState` after every step. To cancel,
        return True or raise ``StopIteration``.

    Returns
    -------
    Solution
        With the best surface that was found. ``step_length`` in its history is the part of the full step that was taken.

    Raises
    ------
    ProblemError
        If a vertex where K is prescribed has no target.

    Examples
    --------
    >>> import compas_cgc
    >>> plan = compas_cgc.read(compas_cgc.get("canopy.3dm")).to_problem()
    >>> polish(plan).status
    'converged'
    """
    settings = settings or PolishSettings()
    without = np.flatnonzero(problem.asked & ~np.isfinite(problem.targets))
    if len(without):
        raise ProblemError([f"vertex {int(without[0])} has no target; set the K̄ of its region"])
    local, frame = problem.without_dummies().local()
    size = math.sqrt(float(face_areas(local.vertices, local.faces).sum()))
    lagrangian, moved = posed(local, settings.fold_length), np.flatnonzero(problem.roles != DUMMY)[local.movable]
    if settings.keep == "shape" or (settings.keep == "auto" and is_drawn(lagrangian)):
        lagrangian = lagrangian.keeping(WAVES * size)

    def to_model(vertices: FloatArray) -> FloatArray:
        result = problem.vertices.copy()
        result[moved] = frame.to_model(vertices[local.movable])
        return result

    recorder = Recorder(settings.steps, callback, frame, to_model)
    goal, weights, points = settings.tolerance * local.target_scale, local.face_targets(), _places(lagrangian)
    centre = local.vertices.mean(axis=0)
    best: Optional[State] = None
    status = "stalled"
    for start in starts(lagrangian):
        best = start if best is None else best
        for step in steps(lagrangian, start, points, size, local.target_scale):
            here, V = step.state, lagrangian.vertices(step.state.unknowns)
            error = _error(lagrangian, here)
            recorder.record(energy(V - centre, local.faces, weights), error, error, step.length, step.trials)
            best = min(best, here, key=lambda state: _error(lagrangian, state))
            if step.settled and (np.abs(here.residuals) <= np.maximum(goal * lagrangian.cells, _rounding(lagrangian, here))).all():
                status, best = "converged", here
            elif len(recorder) == settings.steps:
                status = "step_limit"
            if recorder.cancelled(V) and status == "stalled":
                status = "cancelled"
            if status != "stalled":
                break
        if status != "stalled":
            break
    assert best is not None
    error = _error(lagrangian, best) / frame.scale**2
    return Solution(
        to_model(lagrangian.vertices(best.unknowns)),
        status,
        _message(status, len(recorder), error, goal / frame.scale**2),
        len(recorder),
        recorder.seconds,
        error,
        recorder.history,
        measure=MID_EDGE,
    )


def _error(lagrangian: Lagrangian, state: State) -> float:
    """Return the largest |K - K̄|."""
    return float(np.abs(state.residuals / lagrangian.cells).max(initial=0.0))


def _rounding(lagrangian: Lagrangian, state: State) -> FloatArray:
    """Return what residuals (r,) are by the rounding of coordinates at unit size."""
    averages = lagrangian.mesh.averages(state.operators)
    curvature = np.sqrt((averages.tensors**2).sum(axis=1)) / averages.areas
    return np.asarray(ROUNDING * EPS * curvature[lagrangian.rows])


def _places(lagrangian: Lagrangian) -> FloatArray:
    """Return the places (q + r, 3) of unknowns and equations on the drawing."""
    V, mesh = lagrangian.drawing, lagrangian.mesh
    unknowns = np.vstack([V, V[mesh.angles.ends].mean(axis=1)])
    return np.vstack([unknowns[lagrangian.free], V[mesh.pairs[lagrangian.rows, 0]]])


def _message(status: str, steps: int, error: float, goal: float) -> str:
    reached = f"largest |K - K̄| {error:.3g} by mid-edge normals"
    if status == "converged":
        return f"converged in {steps} steps: {reached}"
    if status == "cancelled":
        return f"cancelled after {steps} steps: {reached}"
    if status == "step_limit":
        return f"not converged in {steps} steps: {reached}, goal {goal:.3g}; allow more steps"
    return f"stalled: no surface with this curvature was found over these supports; choose a smaller |K̄|, or free an edge; {reached}"
