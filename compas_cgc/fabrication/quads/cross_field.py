"""Smooth cross fields along the lines of curvature of a region, and their singularities."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy import sparse

from ...discrete import boundary_vertices
from ...discrete import edge_faces
from ...discrete.arrays import Faces
from ...discrete.arrays import FloatArray
from ...discrete.arrays import IntArray
from ...discrete.arrays import Vertices
from ...linalg import factorise

__all__ = ["CrossField", "cross_field"]

PLAN_WEIGHT = 1e-3  # of the alignment with the axes of the plan, which splits a multiple singularity into simple ones
QUARTER = 0.5 * np.pi


class CrossField(NamedTuple):
    """Crosses of two perpendicular directions in the faces of a region."""

    axes: FloatArray  # (m, 2, 3) orthonormal axes of the faces, counterclockwise
    edges: IntArray  # (e, 4) inner edges: start, end, left and right face
    turns: FloatArray  # (e,) angle of the edge in the right face less that in the left face [rad]
    angles: FloatArray  # (m,) angle of a direction of the cross from the first axis [rad]
    indices: IntArray  # (n,) index of the cross field in quarters of a turn, 0 where it is regular; 0 on the rim


def cross_field(vertices: Vertices, faces: Faces, operators: FloatArray, square: float, length: float, rim_weight: float) -> CrossField:
    r"""Return the smoothest crosses that follow distinct principal directions and, where these are alike, their surroundings.

    A cross at the angle :math:`\theta` is the complex number :math:`z = e^{4 i \theta}`. The field minimises

    .. math:: \int |\nabla z|^2 + \frac{w}{\ell^2} |z - z_0|^2, \qquad w = \min(d^2 / k^2, 1),

    where :math:`z_0` are the principal directions and :math:`d` half the difference of the principal curvatures.
    Umbilic points have w = 0, so that the field there is harmonic, with simple zeros.

    Parameters
    ----------
    vertices, faces
        Triangles of a region.
    operators
        (n, 3, 3) shape operators [1/L].
    square
        Square of the typical curvature k of the region, such as K > 0 [1/L²].
    length
        Length over which directions are smoothed [L].
    rim_weight
        Weight of the alignment with the rim, against that with distinct principal directions.

    References
    ----------
    Knöppel, Crane, Pinkall, Schröder, *Globally optimal direction fields*, 2013, doi:10.1145/2461912.2462005.
    """
    a, b, c = vertices[faces].transpose(1, 0, 2)
    x = (b - a) / np.linalg.norm(b - a, axis=1, keepdims=True)
    normal = np.cross(b - a, c - a)
    area = 0.5 * np.linalg.norm(normal, axis=1)
    y = np.cross(normal / (2.0 * area)[:, None], x)
    axes = np.stack([x, y], axis=1)
    edges = edge_faces(faces)
    inner, rim = edges[edges[:, 3] >= 0], edges[edges[:, 3] < 0]
    turns = _angle(axes, vertices, inner, 3) - _angle(axes, vertices, inner, 2)

    S = operators[faces].mean(axis=1)
    p, q, r = (np.einsum("fi,fij,fj->f", one, S, other) for one, other in ((x, x), (x, y), (y, y)))
    half = 0.5 * (p - r) + 1j * q
    apart = np.abs(half) ** 2
    weight = area * np.minimum(apart / square, 1.0) / length**2
    aim = weight * np.where(apart > 0.0, half**2 / np.maximum(apart, np.finfo(float).tiny), 0.0)

    ahead = np.linalg.norm(vertices[rim[:, 1]] - vertices[rim[:, 0]], axis=1) * rim_weight / length
    np.add.at(weight, rim[:, 2], ahead)
    np.add.at(aim, rim[:, 2], ahead * np.exp(4j * _angle(axes, vertices, rim, 2)))

    plan = PLAN_WEIGHT * area / length**2
    weight, aim = weight + plan, aim + plan * np.exp(4j * np.arctan2(axes[:, 1, 0], axes[:, 0, 0]))

    # Stiffness between faces: edge length over the distance of the centres.
    centres = vertices[faces].mean(axis=1)
    left, right = inner[:, 2], inner[:, 3]
    stiff = np.linalg.norm(vertices[inner[:, 1]] - vertices[inner[:, 0]], axis=1) / np.linalg.norm(centres[left] - centres[right], axis=1)
    carried = np.exp(4j * turns)
    m = len(faces)
    couple = sparse.csr_matrix((np.r_[-stiff * carried, -stiff * carried.conj()], (np.r_[right, left], np.r_[left, right])), shape=(m, m))
    diagonal = np.bincount(left, stiff, m) + np.bincount(right, stiff, m) + weight
    z = _solved(couple + sparse.diags(diagonal), aim)
    angles = np.angle(z) / 4.0
    return CrossField(axes, inner, turns, angles, _indices(vertices, faces, inner, turns, angles))


def _angle(axes: FloatArray, vertices: Vertices, edges: IntArray, column: int) -> FloatArray:
    """Return the angles of edges (e,) from the first axis of the face in a column of the edges [rad]."""
    along = vertices[edges[:, 1]] - vertices[edges[:, 0]]
    own = np.einsum("eki,ei->ek", axes[edges[:, column]], along)
    return np.arctan2(own[:, 1], own[:, 0])


def _solved(matrix: sparse.csr_matrix, right: NDArray[np.complex128]) -> NDArray[np.complex128]:
    """Return the solution (m,) of a Hermitian system by a real one of twice the size."""
    real, imaginary = matrix.real, matrix.imag
    whole = sparse.bmat([[real, -imaginary], [imaginary, real]], format="csr")
    found = factorise(whole, symmetric=True).solve(np.r_[right.real, right.imag])
    return found[: len(right)] + 1j * found[len(right) :]


def _indices(vertices: Vertices, faces: Faces, inner: IntArray, turns: FloatArray, angles: FloatArray) -> IntArray:
    """Return the index of the field at every vertex (n,) in quarters of a turn; 0 on the rim."""
    n = len(vertices)
    left, right = inner[:, 2], inner[:, 3]
    # Angle by which the field turns against parallel transport from left to right, to the nearest direction.
    step = angles[right] - angles[left] - turns
    step -= QUARTER * np.round(step / QUARTER)
    # The right face follows the left one clockwise around the start of the edge and counterclockwise around its end.
    total = np.bincount(inner[:, 1], step, n) - np.bincount(inner[:, 0], step, n)
    corners = vertices[faces]
    ahead, back = np.roll(corners, -1, axis=1) - corners, np.roll(corners, 1, axis=1) - corners
    inside = np.arctan2(np.linalg.norm(np.cross(ahead, back), axis=2), (ahead * back).sum(axis=2))
    defect = 2.0 * np.pi - np.bincount(faces.ravel(), inside.ravel(), n)
    rim = boundary_vertices(vertices, faces)
    return np.where(rim, 0, np.round((total + defect) / QUARTER)).astype(np.int64)
