"""Whether a surface is one that somebody would build: fair or rough, with numbers and reasons."""

from __future__ import annotations

from dataclasses import asdict
from dataclasses import dataclass
from typing import Optional

import numpy as np

from ..discrete import edge_faces
from ..discrete import face_areas
from ..discrete import face_normals
from ..discrete.arrays import FloatArray
from ..discrete.arrays import IntArray
from ..discrete.local_fits import LocalFits
from ..discrete.local_fits import local_fits
from ..model.problem import CGCProblem
from ..model.roles import CREASE
from ..model.roles import DUMMY

__all__ = ["Verdict", "verdict"]

MEDIAN, MOST = 0.05, 0.3  # errors of the fits, against the targets, of a fair surface: the median, and that of all but 5 %
FAINT = 0.1  # target, against the largest, below which errors are held against that
SHARP = 3.0  # fold, against the one that curvature and edges call for, that is too sharp
SLIGHT = np.radians(3.0)  # fold that nobody sees
CREASED = 0.02  # part of the edges that may fold too sharply
NEEDLE = 3.0  # smallest angle of a triangle [degree], if it was twice that
LOST = 0.6  # part of the area that has to be left


@dataclass(frozen=True)
class Verdict:
    """How fair a surface is; lists no reasons where it is."""

    fair: bool
    reasons: list[str]  # one sentence each
    fit_median: Optional[float]  # |K - K̄| / |K̄| of polynomials fitted to the surface, the median; None without any
    fit_most: Optional[float]  # the same, of all but 5 % of the vertices
    sharpest_fold: float  # between two faces, creases apart [degree]
    folds_too_sharp: float  # part of the inner edges that fold more than curvature and edge length call for
    smallest_angle: float  # of a triangle [degree]
    area_kept: Optional[float]  # area against that of the input, None without one

    def __str__(self) -> str:
        return "fair" if self.fair else "rough: " + "; ".join(self.reasons)

    def to_dict(self) -> dict:
        """Return plain data, ready for JSON."""
        return {"verdict": "fair" if self.fair else "rough", **asdict(self)}


def verdict(problem: CGCProblem, before: Optional[FloatArray] = None) -> Verdict:
    """Judge the vertices of a problem, whatever its angle defects say.

    Polynomials fitted to two rings must have the curvature asked for, edges must fold no more than the
    curvature and their length call for, and triangles must not be drawn out or lost.

    Parameters
    ----------
    problem
        Vertices, faces, roles, targets and creases.
    before
        ``(n, 3)`` where its vertices were before [L].
    """
    if before is not None:
        problem, before = problem.without_dummies(), before[problem.roles != DUMMY]
    else:
        problem = problem.without_dummies()
    V, F = problem.vertices, problem.faces
    fits = local_fits(V, F, problem.asked, problem.asked)
    median, most = _errors(problem, fits)
    fold, called = _folds(problem, fits)
    too_sharp = float(np.mean((fold > SHARP * called) & (fold > SLIGHT))) if len(fold) else 0.0
    sharpest = float(np.degrees(fold.max(initial=0.0)))
    angle = _smallest_angle(V, F)
    kept = None if before is None else float(face_areas(V, F).sum() / face_areas(before, F).sum())
    reasons = []
    if median is not None and most is not None and (median > MEDIAN or most > MOST):
        reasons.append(f"polynomials fitted to it are {100 * median:.2g} % off the curvature asked for, and up to {100 * most:.2g} %")
    if too_sharp > CREASED:
        reasons.append(f"{100 * too_sharp:.2g} % of its edges fold more sharply than its curvature calls for, up to {sharpest:.0f} degrees")
    if before is not None and angle < NEEDLE and 2 * angle < _smallest_angle(before, F):
        reasons.append(f"triangles are drawn out to needles of {angle:.2g} degrees")
    if kept is not None and kept < LOST:
        reasons.append(f"it has {100 * kept:.0f} % of the area of the input")
    return Verdict(not reasons, reasons, median, most, sharpest, too_sharp, angle, kept)


def _errors(problem: CGCProblem, fits: LocalFits) -> tuple[Optional[float], Optional[float]]:
    """Return the median and the 95th percentile of the relative error of the fits' K."""
    fitted = np.isfinite(fits.gaussian)
    if not fitted.any():
        return None, None
    targets = problem.targets[fitted]
    scale = np.maximum(np.abs(targets), max(FAINT * float(np.abs(targets).max()), _least(problem)))
    median, most = np.percentile(np.abs(fits.gaussian[fitted] - targets) / scale, [50, 95]).tolist()
    return median, most


def _least(problem: CGCProblem) -> float:
    """Return the curvature that is small for a mesh, whatever is asked: one over its area, where nothing is."""
    return 0.0 if problem.targets[problem.asked].any() else 1.0 / float(face_areas(problem.vertices, problem.faces).sum())


def _folds(problem: CGCProblem, fits: LocalFits) -> tuple[FloatArray, FloatArray]:
    """Return the angle at every inner edge off the creases, and the one that a smooth surface would have there [rad].

    Over an edge a smooth mesh turns by its normal curvature times two thirds of the two faces' area over the edge's
    length; the larger principal curvature bounds it.
    """
    V, F = problem.vertices, problem.faces
    edges = _off_creases(problem)
    u, v, left, right = edges.T
    normals, areas = face_normals(V, F), face_areas(V, F)
    cross = np.cross(normals[left], normals[right])
    fold = np.arctan2(np.sqrt(np.einsum("ij,ij->i", cross, cross)), np.einsum("ij,ij->i", normals[left], normals[right]))
    principal = np.abs(fits.mean) + np.sqrt(np.maximum(fits.mean**2 - fits.gaussian, 0.0))
    known = np.isfinite(principal[u]) | np.isfinite(principal[v])
    curvature = np.fmax(principal[u], principal[v])
    length = np.sqrt(np.einsum("ij,ij->i", V[v] - V[u], V[v] - V[u]))
    called = curvature * 2.0 * (areas[left] + areas[right]) / (3.0 * np.maximum(length, np.finfo(float).tiny))
    return fold[known], called[known]


def _off_creases(problem: CGCProblem) -> IntArray:
    edges = edge_faces(problem.faces)
    edges = edges[edges[:, 3] >= 0]
    n = len(problem.vertices)
    code, creases = np.sort(edges[:, :2], axis=1) @ [n, 1], np.sort(problem.creases, axis=1) @ [n, 1]
    on_crease = (problem.roles[edges[:, 0]] == CREASE) & (problem.roles[edges[:, 1]] == CREASE)
    return edges[~(np.isin(code, creases) | on_crease)]


def _smallest_angle(V: FloatArray, F: IntArray) -> float:
    corners = V[F]
    ahead, back = np.roll(corners, -1, axis=1) - corners, np.roll(corners, 1, axis=1) - corners
    cross = np.cross(ahead, back)
    angles = np.arctan2(np.sqrt(np.einsum("ijk,ijk->ij", cross, cross)), np.einsum("ijk,ijk->ij", ahead, back))
    return float(np.degrees(angles.min(initial=np.pi)))
