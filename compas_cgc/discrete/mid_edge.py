"""Shape operators by the normals at the middles of edges: one discretisation of curvature and bending on any triangles."""

from __future__ import annotations

from collections.abc import Callable
from functools import cached_property
from functools import partial
from typing import NamedTuple
from typing import Optional

import numpy as np
from scipy import sparse

from ._shape_kernels import expanded
from ._taylor import FIRST
from ._taylor import SECOND
from .arrays import Faces
from .arrays import FloatArray
from .arrays import IntArray
from .arrays import Vectors
from .arrays import Vertices
from .topology import edge_faces

__all__ = ["OCCURRENCES", "TRACE", "Curvatures", "EdgeAngles", "MidEdgeMesh", "ShapeOperators", "determinants", "edge_angles"]

# Packed symmetric matrices are xx, xy, xz, yy, yz, zz: how often each entry occurs, and which are on the diagonal.
OCCURRENCES = np.array([1.0, 2.0, 2.0, 1.0, 2.0, 1.0])
TRACE = np.array([1.0, 0.0, 0.0, 1.0, 0.0, 1.0])
PACKED = np.array([[0, 1, 2], [1, 3, 4], [2, 4, 5]])


class EdgeAngles(NamedTuple):
    """The angles that turn normals about edges: one per edge, two per crease edge."""

    ends: IntArray  # (a, 2) vertices of the edge of each angle
    of_faces: IntArray  # (m, 3) angle at the edge opposite to each corner
    sign: FloatArray  # (m, 3) 1 where the edge runs along the face, -1 where it runs back
    folds: IntArray  # (c, 2) angles on the left and on the right of each crease edge


class Curvatures(NamedTuple):
    """Averages over the triangles of one region at one vertex."""

    tensors: FloatArray  # (p, 6) sums of the shape operators times the areas [L]
    areas: FloatArray  # (p,) [L^2]

    @property
    def gaussian(self) -> FloatArray:
        """Gaussian curvature (p,) [1/L^2]."""
        return determinants(self.tensors) / self.areas**2

    @property
    def mean(self) -> FloatArray:
        """Mean curvature (p,) [1/L], positive where the surface is convex to the side of its normals."""
        return np.asarray(0.5 * self.tensors @ TRACE / self.areas)


class ShapeOperators:
    """Shape operators of all triangles, with derivatives by the moves of the corners, then by the angles of the edges.

    Parameters
    ----------
    expanded
        Returns what :func:`expanded` does (m, 22, k), with k = 4 up to first derivatives, and k = 10 up to second ones, which are computed
        when they are asked for.
    sign
        ``(m, 3)`` of the angles.
    turned
        ``(m, 3)`` angles from the reference directions [rad], in the sense of each face.
    """

    def __init__(self, expanded: Callable[[int], FloatArray], sign: FloatArray, turned: FloatArray):
        self._expanded, self._sign, self._turned = expanded, sign, turned
        self._rows = self._with_angles(FIRST)
        self.areas: FloatArray = self._area[:, 0].copy()  # (m,) [L^2]
        self.tensors: FloatArray = np.einsum("mk,mke->me", self._angle[:, :, 0], self._tensor[..., 0])  # times the areas (m, 6) [L]

    def to_second_order(self) -> ShapeOperators:
        """Return the same with second derivatives."""
        if self._rows.shape[2] < SECOND:
            self._rows = self._with_angles(SECOND)
        return self

    def _with_angles(self, count: int) -> FloatArray:
        rows = self._expanded(count)
        rows[:, :3, 0] += self._turned
        return rows

    @property
    def _angle(self) -> FloatArray:
        return self._rows[:, :3]

    @property
    def _tensor(self) -> FloatArray:
        return self._rows[:, 3:-1].reshape(-1, 3, 6, self._rows.shape[2])

    @property
    def _area(self) -> FloatArray:
        return self._rows[:, -1]

    @property
    def bending(self) -> FloatArray:
        """Integral of the sum of the squared principal curvatures over each face (m,)."""
        return np.asarray(self.tensors**2 @ OCCURRENCES / self.areas)

    @property
    def angle_slopes(self) -> FloatArray:
        """Derivatives of the tensors by the angles (m, 6, 3)."""
        return np.asarray(self._sign[:, None] * self._tensor[..., 0].transpose(0, 2, 1))

    @cached_property
    def tensor_slopes(self) -> FloatArray:
        """Derivatives of the tensors (m, 6, 6)."""
        phi, B = self._angle, self._tensor
        moves = np.einsum("mk,mkex->mex", phi[:, :, 0], B[..., 1:4]) + np.einsum("mkx,mke->mex", phi[:, :, 1:4], B[..., 0])
        return np.concatenate([moves, self.angle_slopes], axis=2)

    @property
    def area_slopes(self) -> FloatArray:
        """Derivatives of the areas by the moves (m, 3)."""
        return self._area[:, 1:4]

    def second_derivatives(self, by_tensors: FloatArray, by_areas: FloatArray) -> FloatArray:
        """Return the second derivatives (m, 6, 6) of the sum of tensors times weights (m, 6), and areas times weights (m,)."""
        self.to_second_order()
        weighed = np.einsum("me,mkex->mkx", by_tensors, self._tensor)
        value, slope = weighed[..., 0], weighed[..., 1:4]
        mixed = np.einsum("mki,mkj->mij", self._angle[..., 1:4], slope)
        packed = np.einsum("mk,mkx->mx", value, self._angle[..., 4:]) + np.einsum("mk,mkx->mx", self._angle[..., 0], weighed[..., 4:])
        H = np.zeros((len(self.areas), 6, 6))
        H[:, :3, :3] = (packed + by_areas[:, None] * self._area[:, 4:])[:, PACKED] + mixed + mixed.transpose(0, 2, 1)
        H[:, 3:, :3] = self._sign[..., None] * slope
        H[:, :3, 3:] = H[:, 3:, :3].transpose(0, 2, 1)
        return H


class MidEdgeMesh:
    r"""Triangles with an angle per edge, two per crease edge, and a direction per vertex along which it moves.

    The angle turns the unit normal at the middle of the edge about the edge, from a reference direction. Within a triangle the
    normal is linear between those of its edges, as in Morley's plate element. So with the angle :math:`\varphi_i` from the
    triangle's normal to that of an edge of length :math:`l_i`, and the unit vector :math:`m_i` across the edge,

    .. math:: A_f S_f = \sum_i l_i \varphi_i \, m_i m_i^T, \qquad
              S_v = \frac{\sum_f A_f S_f}{\sum_f A_f}, \qquad K_v = \tfrac12 ((\operatorname{tr} S_v)^2 - S_v : S_v),

    with the sums over the triangles of one region at one vertex: a pair. On creases the two sides have angles of their own,
    whose difference is the fold.

    Parameters
    ----------
    faces
        ``(m, 3)`` vertex indices of an oriented manifold.
    creases
        ``(c, 2)`` edges that may fold.
    regions
        ``(m,)`` numbers of the regions of the faces.
    directions
        ``(n, 3)`` of the vertices, to the side of the normals.
    references
        ``(a, 3)`` of the angles, to the side of the normals. Default: the sum of the directions at both ends of the edge.

    References
    ----------
    Grinspun, Gingold, Reisman, Zorin, *Computing discrete shape operators on general meshes*, doi:10.1111/j.1467-8659.2006.00974.x.
    Morley, *The triangular equilibrium element in the solution of plate bending problems*, doi:10.1017/S0001925900004546.
    """

    def __init__(
        self, faces: Faces, creases: IntArray, regions: IntArray, directions: Vectors, references: Optional[Vectors] = None
    ):  # fmt: skip
        self.faces, self.directions = np.ascontiguousarray(faces), np.ascontiguousarray(directions)
        self.angles = edge_angles(self.faces, creases)
        self.references = directions[self.angles.ends].sum(axis=1) if references is None else references
        count, m, n = int(regions.max(initial=0)) + 1, len(faces), len(directions)
        keys, places = np.unique(faces * count + regions[:, None], return_inverse=True)
        self.pair_of: IntArray = places.reshape(faces.shape)  # (m, 3) of each corner
        self.pairs: IntArray = np.column_stack([keys // count, keys % count])  # (p, 2) vertex and region
        entries = np.ones(3 * m), (self.pair_of.ravel(), np.repeat(np.arange(m), 3))
        self.incidence = sparse.csr_matrix(entries, shape=(len(keys), m))
        self.unknowns = n + len(self.angles.ends)  # moves of vertices, then angles
        self.columns: IntArray = np.column_stack([faces, n + self.angles.of_faces])  # (m, 6) the unknowns of each face

    def at(self, vertices: Vertices, angles: FloatArray) -> ShapeOperators:
        """Return the shape operators for vertices (n, 3) [L] and angles (a,) [rad]."""
        own = self.angles

        parts = partial(expanded, vertices, self.faces, self.directions, self.references, own.of_faces)
        return ShapeOperators(parts, own.sign, own.sign * angles[own.of_faces])

    def averages(self, operators: ShapeOperators) -> Curvatures:
        """Return the averages over every pair."""
        return Curvatures(self.incidence @ operators.tensors, self.incidence @ operators.areas)


def determinants(tensors: FloatArray) -> FloatArray:
    """Return the second invariants of packed symmetric matrices (k, 6), which in a plane are their determinants (k,)."""
    return np.asarray(0.5 * ((tensors @ TRACE) ** 2 - tensors**2 @ OCCURRENCES))


def edge_angles(faces: Faces, creases: IntArray) -> EdgeAngles:
    """Return the angles of a mesh.

    Parameters
    ----------
    faces
        ``(m, 3)`` vertex indices of an oriented manifold.
    creases
        ``(c, 2)`` edges that may fold, in any direction.
    """
    edges = edge_faces(faces)
    n = int(faces.max(initial=0)) + 1
    keys = np.sort(edges[:, :2], axis=1) @ [n, 1]
    order = np.argsort(keys)
    start, stop = faces[:, [1, 2, 0]], faces[:, [2, 0, 1]]
    own = order[np.searchsorted(keys[order], np.minimum(start, stop) * n + np.maximum(start, stop))]
    ahead = edges[own, 0] == start
    folded = (edges[:, 3] >= 0) & np.isin(keys, np.sort(np.reshape(creases, (-1, 2)), axis=1) @ [n, 1])
    second = np.full(len(edges), -1)
    second[folded] = len(edges) + np.arange(int(folded.sum()))
    return EdgeAngles(
        ends=np.vstack([edges[:, :2], edges[folded, :2]]),
        of_faces=np.where(~ahead & folded[own], second[own], own),
        sign=np.where(ahead, 1.0, -1.0),
        folds=np.column_stack([np.flatnonzero(folded), second[folded]]),
    )
