r"""Policy iteration on a bounded Monge-Ampère operator: steps that lead from any shape to the convex one.

For a convex surface ``√K`` is the smallest of ``½ (a k₁ + k₂ / a)`` over all a > 0, with
``k₁ >= k₂`` the principal curvatures. With a held between ``1/Λ`` and ``Λ`` the same
minimum,

.. math:: F_Λ = \min_{1/Λ \le a \le Λ} \tfrac12 (a k_1 + k_2 / a),

is defined on every surface, concave, and uniformly elliptic; it is ``√K`` where
``k₁ <= Λ² k₂`` and ``½ (k₁ / Λ + Λ k₂)`` elsewhere. Newton's method on ``F_Λ = √K̄`` (each
step holds every a and solves the linear equation that is left) needs no damping. Where
the surface is flat its step is the one of Benamou, Froese and Oberman, ``-Δδ = 2 √K̄``.
Λ grows as the shape comes near: on good meshes four steps at 100 vertices, ten at a million.

The derivative of ``F_Λ`` is put together from rows that are known: those of the angle
defects, ``k₂ ∂k₁ + k₁ ∂k₂``, and of the cotangent matrix, ``∂k₁ + ∂k₂``.

References
----------
Benamou, Froese, Oberman, doi:10.1051/m2an/2010017; Bokanowski, Maroso, Zidani, doi:10.1137/08073041X.
"""

from __future__ import annotations

from collections.abc import Generator
from typing import NamedTuple

import numpy as np
from scipy import sparse

from ...discrete.arrays import FloatArray
from ...discrete.laplacian import cotangent_stiffness
from ...discrete.smoothed_normals import smooth_normals
from ..constants import PATIENCE
from .system import Shape
from .system import Step
from .system import System

__all__ = ["Policy", "elliptic_steps", "policy"]

# error of F_Λ relative to √K̄ from which Newton's method takes over; K is then off by a tenth, far less than WITHIN_REACH
NEAR_ENOUGH = 0.05
TIGHTEN = 0.1  # error relative to √K̄ from which Λ is raised; smaller errors than that of Λ itself bring nothing
GROWTH = 3.0  # factor on Λ; a larger one costs more steps for each Λ, a smaller one more values of Λ
LARGEST = 1e6  # largest Λ; principal curvatures differ by less than a factor of 1e12 on every shape
FEW = 3e-3  # fraction of vertices that may lack √K when Newton's method takes over; at corners of a rim no shape has it
SMOOTHING = 5  # averages of the normals that give directions of moves; removes kinks of the normals at the rim
LOOSE = 0.3  # relative residual of the linear systems of large meshes; a step of policy iteration leaves a few tenths of the error anyway
NOISE = 1e-3  # curvature relative to √K̄ below which a vertex is flat; principal directions of less are noise


class Policy(NamedTuple):
    """F_Λ at every vertex, and the weights that make its derivative."""

    value: FloatArray  # (k,) F_Λ [1/L]
    of_defect: FloatArray  # (k,) weight of the derivative of the defect [L]
    of_laplacian: FloatArray  # (k,) weight of the cotangent matrix


def policy(mean: FloatArray, curvature: FloatArray, bound: float, unit: FloatArray) -> Policy:
    """Return F_Λ and its derivative.

    Parameters
    ----------
    mean
        ``(k,)`` mean curvature H [1/L].
    curvature
        ``(k,)`` Gaussian curvature K [1/L^2].
    bound
        Λ.
    unit
        ``(k,)`` curvature that others are large or small against [1/L].
    """
    half = np.sqrt(np.maximum(mean**2 - curvature, 0.0))
    k1, k2 = mean + half, mean - half
    flat = mean < NOISE * unit
    free = ~flat & (curvature > 0) & (k2 * bound**2 >= k1)
    # Flat, bent the wrong way, or without principal directions to speak of: a = 1.
    even = flat | (~free & (half < NOISE * unit))
    root = np.sqrt(np.where(free, curvature, 1.0))
    weight = np.where(free, 0.5 / root, 0.25 * (bound - 1.0 / bound) / np.where(half > 0, half, 1.0))
    value = np.where(free, root, np.where(even, mean, 0.5 * (k1 / bound + k2 * bound)))
    of_laplacian = np.where(free, 0.0, np.where(even, 0.5, 0.5 / bound - weight * k2))
    return Policy(value, np.where(even, 0.0, weight), of_laplacian)


def elliptic_steps(system: System, shape: Shape, bound: float) -> Generator[Step, None, bool]:
    """Yield the steps of the iteration until a shape is near enough for Newton's method, and return True.

    Return False when it does not come nearer.

    Parameters
    ----------
    system
        The problem; targets below zero count as zero.
    shape
        The first shape.
    bound
        Λ.

    Raises
    ------
    SingularMatrixError
        If a part of the mesh is held nowhere.
    """
    faces = system.problem.faces
    goal = np.sqrt(np.maximum(system.targets, 0.0))
    unit = np.where(goal > 0, goal, np.sqrt(system.scale))
    best, waited = np.inf, 0
    while True:
        now, error = _policy_and_error(shape, goal, bound, unit)
        if _is_exact(now, goal):
            if error <= NEAR_ENOUGH:
                system.factorised = False
                return True
        elif error <= TIGHTEN and bound < LARGEST:
            bound, best = bound * GROWTH, np.inf
            now, error = _policy_and_error(shape, goal, bound, unit)
        best, waited = (error, 0) if error < best else (best, waited + 1)
        if waited > PATIENCE or not np.isfinite(error):
            return False
        directions = smooth_normals(shape.vertices, faces, SMOOTHING)[system.asked]
        matrix = _derivative(system, shape, now, directions)
        lengths = system.solving_nearly(matrix, LOOSE)(shape.area * (goal - now.value))
        shape = system.moved(shape, lengths, directions)
        yield Step(shape, 1.0, 1)


def _policy_and_error(shape: Shape, goal: FloatArray, bound: float, unit: FloatArray) -> tuple[Policy, float]:
    """Return the policy of a shape and the mean error of F_Λ, against the unit."""
    now = policy(shape.mean, shape.curvature, bound, unit)
    return now, float(np.sqrt(np.average(((goal - now.value) / unit) ** 2, weights=shape.area)))


def _is_exact(now: Policy, goal: FloatArray) -> bool:
    """Return whether F_Λ is √K nearly everywhere where K̄ > 0."""
    bounded = (now.of_laplacian != 0) & (goal > 0)
    return bool(np.count_nonzero(bounded) <= FEW * len(goal))


def _derivative(system: System, shape: Shape, now: Policy, directions: FloatArray) -> sparse.csr_matrix:
    """Return the derivative of the integral of F_Λ over each cell, by the moves (k, k)."""
    pattern = system.equations.pattern
    # The areas change at lower order than the defects; without them the operator stays elliptic.
    defects = system.equations.jacobian(shape.vertices, directions, areas=False)
    laplacian = cotangent_stiffness(shape.vertices, pattern)
    across = np.einsum("ij,ij->i", shape.normal, directions)
    count = np.diff(pattern.indptr)
    data = np.repeat(now.of_defect, count) * defects.data
    data += np.repeat(now.of_laplacian, count) * laplacian.data * across[pattern.indices]
    return pattern.matrix(data)
