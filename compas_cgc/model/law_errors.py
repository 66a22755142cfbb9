"""Residuals of the laws of regions on a given surface, by mid-edge normals."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ..discrete.arrays import FloatArray
from ..discrete.arrays import IntArray
from ..discrete.measured_curvature import measured_curvature
from .laws import Law
from .measures import read_inwards
from .problem import CGCProblem

__all__ = ["LawErrors", "law_errors"]

FLAT = 1e-3  # smallest reference curvature times the size of the surface; the sagitta of such an arc, 1/8,000 of its length, is invisible


class LawErrors(NamedTuple):
    """Residuals of the law of one region at the internal vertices where mid-edge normals read curvature."""

    region: int
    law: Law
    vertices: IntArray  # (k,)
    residuals: FloatArray  # (k,) in the units of the law
    relative: FloatArray  # (k,) against that of a sphere with the typical curvature of the region, prescribed or actual


def law_errors(problem: CGCProblem) -> list[LawErrors]:
    """Return the residuals of all laws other than constant K; none if there are no such laws.

    Parameters
    ----------
    problem
        A surface without dummies, with its laws.
    """
    if not problem.laws:
        return []
    V, F = problem.vertices, problem.faces
    found = measured_curvature(V, F, problem.creases, problem.regions())
    size, read = float(np.linalg.norm(np.ptp(V, axis=0))), read_inwards(problem)
    errors = []
    for region, law in problem.laws.items():
        own = (found.pairs[:, 1] == region) & read[found.pairs[:, 0]] & np.isfinite(found.mean)
        H, K = found.mean[own], found.gaussian[own]
        residuals = law.residual(H, K)
        by_H, by_K = law.first_derivatives(H, K)
        asked = max(abs(float(part)) for part in law.shape())
        typical = max(float(np.sqrt(np.mean(np.maximum(2.0 * H**2 - K, 0.0)))) if len(H) else 0.0, asked, FLAT / size)
        relative = np.abs(residuals) / (np.abs(by_H) * typical + np.abs(by_K) * typical**2)
        errors.append(LawErrors(region, law, found.pairs[own, 0], residuals, relative))
    return errors
