"""Gaussian curvature flow (Eq. 22) with filter, creases and line search."""

from __future__ import annotations

import math
from typing import Optional

import numpy as np

from ...discrete import face_areas
from ...discrete import mean_curvature
from ...discrete.arrays import FloatArray
from ...discrete.evaluation import Measure
from ...discrete.evaluation import Measurement
from ...errors import HALVED
from ...errors import Sentence
from ...errors import allow_more_steps
from ...errors import names_what_was_meant
from ...errors import use_method
from ...linalg.work import count
from ...linalg.work import rights
from ...model.frame import Frame
from ...model.problem import CGCProblem
from ...model.recorder import Callback
from ...model.recorder import Recorder
from ...model.result import Solution
from ...model.roles import CREASE
from ..allowance import FLOW_STEP
from ..constants import RUNAWAY
from ..half_sphere import rounder_than_half_a_sphere
from .filter import GradientFilter
from .linesearch import armijo_line_search
from .settings import FlowSettings

__all__ = ["flow"]

ASTRAY = 2.0  # final error over the initial one, above which a run has diverged; a slow run ends below its initial error
# error over the initial one or the target, above which a run has diverged; torn meshes have triangles without area and unbounded K
EXPLOSION = 1e3


@names_what_was_meant()
def flow(problem: CGCProblem, *, settings: Optional[FlowSettings] = None, callback: Callback = None) -> Solution:
    """Move the vertices along their normals until K is the target wherever it is asked for.

    Per step: the gradient ``(K_i - K̄_i) n_i`` (Eq. 20) is averaged over the internal
    vertices within the filter's radius (Eq. 26), scaled by ``s`` (Eq. 27) or held back
    for ``e`` steps on the creases, and taken (Eq. 22, where Eq. 21 has μ = 1) with the
    step length that the line search finds (Eq. 28, Eq. 29).

    Parameters
    ----------
    problem
        Vertices, faces, roles and targets. Vertices on free edges must be carried by
        dummy faces.
    settings
        Parameters; lengths in model units. Default: scaled from the mesh.
    callback
        Called with a :class:`SolveState` after every step. To cancel, return True or
        raise ``StopIteration``.

    Returns
    -------
    Solution
        With the last shape; after a divergence, with the best shape that was reached.

    References
    ----------
    Paper, Sections 3 and 4.

    Examples
    --------
    >>> import compas_cgc
    >>> plan = compas_cgc.read(compas_cgc.get("cushion.3dm")).to_problem()
    >>> flow(plan).status
    'converged'
    """
    local, frame = problem.local()
    settings = settings or FlowSettings()
    mu0, radius = _local_lengths(settings, local, frame)
    asked = local.asked
    rows = np.flatnonzero(local.movable)
    creases = np.flatnonzero(local.roles == CREASE)
    s = np.where(np.isnan(local.s), settings.crease_factor, local.s)[creases, None]
    e = np.where(np.isnan(local.e), settings.e, local.e)[creases]

    def to_model(vertices: FloatArray) -> FloatArray:
        return _to_model(problem, local, frame, vertices)

    recorder = Recorder(settings.steps, callback, frame, to_model, length_power=3)
    measure = Measure(local.vertices, local.faces, local.face_targets(), settings.energy)
    smooth = GradientFilter(
        np.flatnonzero(asked),
        rows,
        local.faces,
        radius=radius,
        power=settings.filter_power,
        refilter=settings.refilter,
    )
    vertices = local.vertices.copy()
    here = measure(vertices)
    error, norm = _errors(here, local)
    bound = _curvature_bound(local, settings.zeta, error)
    goal = settings.tolerance * local.target_scale
    limit = EXPLOSION * max(error, local.target_scale)
    diagonal = float(np.linalg.norm(np.ptp(vertices, axis=0)))

    start_error = best_error = error
    best = vertices
    status, step = "step_limit", 0
    if settings.tolerance > 0 and error <= goal:
        status = "converged"
    while status == "step_limit" and step < settings.steps:
        step += 1
        count(rights(FLOW_STEP, 3 * len(vertices)))
        gradient = np.where(asked, here.curvature - local.targets, 0.0)[:, None] * here.normal
        direction = -smooth(vertices, gradient)
        direction[creases] *= s * (step > e)[:, None]
        weight = here.area if settings.slope == "area" else 1.0
        slope = float(np.sum(weight * np.einsum("ij,ij->i", gradient, direction)))
        taken = armijo_line_search(
            measure,
            vertices,
            direction,
            here.energy,
            slope,
            bound,
            mu0=mu0,
            tau=settings.tau,
            xi=settings.xi,
            q=settings.q,
        )
        vertices, here = taken.vertices, taken.measurement
        error, norm = _errors(here, local)
        if error < best_error:
            best_error, best = error, vertices
        recorder.record(here.energy, norm, error, taken.length, taken.trials, taken.accepted)
        if not (math.isfinite(error) and error < limit and float(np.abs(vertices - local.vertices).max()) < RUNAWAY * diagonal):
            status, vertices, error = "diverged", best, best_error
        elif settings.tolerance > 0 and error <= goal:
            status = "converged"
        if status != "diverged" and recorder.cancelled(vertices) and status == "step_limit":
            status = "cancelled"
    if status == "step_limit" and error > ASTRAY * start_error:
        status, vertices, error = "diverged", best, best_error
    max_error = error / frame.scale**2
    message = _message(status, step, max_error, goal / frame.scale**2, problem, radius)
    return Solution(to_model(vertices), status, message, step, recorder.seconds, max_error, recorder.history)


def _local_lengths(settings: FlowSettings, local: CGCProblem, frame: Frame) -> tuple[float, float]:
    """Return μ0 and the filter's radius in the local frame, taken from the mesh where the settings leave them open."""
    area = float(face_areas(local.vertices, local.faces[local.real_faces]).sum())
    if settings.filter_radius is None:
        ends = local.vertices[local.faces]
        edge = float(np.linalg.norm(ends - np.roll(ends, 1, axis=1), axis=2).mean())
        radius = min(max(math.sqrt(area) / 3, 3 * edge), 8 * edge)
    else:
        radius = settings.filter_radius / frame.scale
    if settings.mu0 is None:
        H = np.abs(mean_curvature(local.vertices, local.faces)[local.asked])
        start = float(np.nan_to_num(H).max(initial=0.0))
        kappa = max(math.sqrt(local.target_scale), start)
        length = radius or math.sqrt(area / max(1, len(local.faces)))
        mu0 = 0.2 * length**2 / kappa
    else:
        mu0 = settings.mu0 / frame.scale**3
    return mu0, radius


def _errors(here: Measurement, problem: CGCProblem) -> tuple[float, float]:
    """Return the largest |K - K̄| and the norm κ of Eq. 30 over the vertices where K is asked."""
    error = (here.curvature - problem.targets)[problem.asked]
    return float(np.abs(error).max(initial=0.0)), float(np.linalg.norm(error))


def _curvature_bound(problem: CGCProblem, zeta: float, start_error: float) -> FloatArray:
    """Return the right side of Eq. 29 (n,): infinite where no K is asked.

    ``K <= ζ K̄`` cannot hold for K̄ <= 0, so there the margin ``(ζ - 1) K̄`` is replaced
    by an absolute one.
    """
    K = problem.targets
    scale = max(problem.target_scale, start_error)
    margin = (zeta - 1.0) * np.where(K > 0, K, scale)
    return np.where(problem.asked, K + margin, np.inf)


def _to_model(problem: CGCProblem, local: CGCProblem, frame: Frame, vertices: FloatArray) -> FloatArray:
    # Vertices that did not move keep their exact coordinates, without the rounding of the frame.
    moved = (vertices != local.vertices).any(axis=1)
    return np.where(moved[:, None], frame.to_model(vertices), problem.vertices)


def _message(status: str, step: int, error: float, goal: float, problem: CGCProblem, radius: float) -> str:
    reached = f"largest |K - K̄| {error:.3g}"
    if status == "converged":
        return f"converged in {step} steps: {reached}"
    if status == "cancelled":
        return f"cancelled after {step} steps: {reached}"
    if status == "step_limit":
        if goal == 0:
            return f"stopped after the prescribed {step} steps: {reached}"
        text = f"not converged in {step} steps: {reached}, but the tolerance is {goal:.3g}; raise filter_radius"
        return allow_more_steps(text, step)
    if radius == 0:
        return f"diverged at step {step} without a filter: short waves grow; set filter_radius to a few edge lengths"
    remedies, sphere = [HALVED], rounder_than_half_a_sphere(problem)
    cause = (
        f"the target is too large for the boundary: {sphere}"
        if sphere
        else (
            "the target may be too large for the boundary (try a smaller K̄, or creases from concave corners), "
            "or the steps too long (try a smaller mu0 or a larger q)"
        )
    )
    if (problem.types[problem.asked] < 0).any():
        cause, remedies = "the flow is unstable where K̄ < 0; use another method there", [use_method("auto")]
    return Sentence(f"diverged at step {step}: {cause}; the best shape before that is returned, {reached}", remedies)
