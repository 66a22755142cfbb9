"""Jacobian of the curvature equations ``defect_i - K̄_i A_i = 0``."""

from __future__ import annotations

import copy
import math
from typing import Optional
from typing import TypeVar

import numpy as np
from numpy.typing import ArrayLike
from scipy import sparse

from . import _derivatives
from . import _kernels
from .arrays import Faces
from .arrays import FloatArray
from .arrays import IntArray
from .arrays import MeshError
from .arrays import PerVertex
from .arrays import Vectors
from .arrays import Vertices
from .curvature_hessian import CurvatureHessian
from .sparsity import RingPattern
from .topology import boundary_mask

__all__ = ["CurvatureEquations"]

RIGHT = 0.05  # negative cosine of an angle from which its cell stays that of an obtuse one; 3° from a right angle, where cells have a kink

Equations = TypeVar("Equations", bound="CurvatureEquations")


class CurvatureEquations:
    """One equation per vertex where K is prescribed: angle defect minus target times mixed area.

    They are not divided by the area, so that all have the same scale. The sparsity is found
    once; :meth:`jacobian` fills it in one compiled pass over the faces.

    Parameters
    ----------
    faces
        ``(m, 3)`` vertex indices, counterclockwise seen from outside.
    targets
        ``(n,)`` target Gaussian curvature of every vertex [1/L^2]; read at ``rows`` only.
    rows
        ``(k,)`` distinct vertices with an equation, none of them on an open boundary.
    columns
        ``(c,)`` distinct vertices that may move.

    Raises
    ------
    MeshError
        If a vertex with an equation lies on an open boundary or belongs to no face.

    References
    ----------
    Paper, Eq. 10. Mixed areas: Meyer, Desbrun, Schroeder, Barr, doi:10.1007/978-3-662-05105-4_2.
    """

    obtuse: IntArray = _kernels.AS_IT_IS  # (m,) corners where cells of faces are those of an obtuse angle

    def __init__(self, faces: Faces, targets: ArrayLike, rows: ArrayLike, columns: ArrayLike):
        # A copy: Numba would compile again for a read-only array.
        self.targets: PerVertex = np.array(targets, dtype=np.float64)
        n = len(self.targets)
        self.pattern = RingPattern(faces, n, rows, columns)
        self.faces, self.rows, self.columns = self.pattern.faces, self.pattern.rows, self.pattern.columns
        used = np.zeros(n, bool)
        used[self.faces.ravel()] = True
        without_ring = np.flatnonzero((boundary_mask(n, self.faces) | ~used)[self.rows])
        if len(without_ring):
            vertex = int(self.rows[without_ring[0]])
            raise MeshError(
                f"vertex {vertex} has no closed ring of faces, so its K is not defined; "
                "make it a support or a free vertex, or add a dummy ring (auxiliary faces outside the edge)"
            )

    def measure(self, vertices: Vertices) -> tuple[FloatArray, FloatArray]:
        """Return the residuals [rad] and the mixed areas [L^2] at the rows, ``(k,)`` each, of a shape (n, 3)."""
        angle, area = _kernels.angle_sums_and_areas(vertices, self.faces, _kernels.MIXED, self.obtuse)
        area = area[self.rows]
        return 2 * math.pi - angle[self.rows] - self.targets[self.rows] * area, area

    def with_cells_of(self: Equations, vertices: Vertices) -> Equations:
        """Return the equations with the kinds of mixed cells that a shape (n, 3) has, whose areas are smooth functions of the shape.

        Mixed areas of each shape's own cells have kinks where an angle passes 90 degrees. An angle a little beyond counts as right, so
        that rounding does not decide on regular meshes.
        """
        edges = vertices[self.faces[:, [2, 0, 1]]] - vertices[self.faces[:, [1, 2, 0]]]
        dots = -np.einsum("fax,fax->fa", edges[:, [1, 2, 0]], edges[:, [2, 0, 1]])
        lengths = np.linalg.norm(edges, axis=2)
        obtuse = dots < -RIGHT * lengths[:, [1, 2, 0]] * lengths[:, [2, 0, 1]]
        other = copy.copy(self)
        other.obtuse = np.where(obtuse.any(axis=1), obtuse.argmax(axis=1), _kernels.ACUTE)
        return other

    def residual(self, vertices: Vertices) -> FloatArray:
        """Return ``defect_i - K̄_i A_i`` at the rows (k,) [rad] of a shape (n, 3)."""
        return self.measure(vertices)[0]

    def jacobian(self, vertices: Vertices, directions: Optional[Vectors] = None, areas: bool = True) -> sparse.csr_matrix:
        """Return the derivative of the residuals.

        Where an angle passes 90 degrees the mixed area is continuous, but its derivative
        jumps; the one-sided derivative of the current shape is returned.

        Parameters
        ----------
        vertices
            ``(n, 3)`` coordinates [L].
        directions
            ``(c, 3)`` one direction per moving vertex. Default: all coordinates.
        areas
            False for the derivative of the defects alone.

        Returns
        -------
        csr_matrix
            ``(k, c)`` derivatives along the directions [rad/L], or ``(k, 3c)`` with the
            columns ``x0, y0, z0, x1, ...`` of the moving vertices.
        """
        slots, size = self.pattern.slots, self.pattern.size
        targets = self.targets if areas else np.zeros_like(self.targets)
        if directions is None:
            return self.pattern.block_matrix(_derivatives.everywhere(vertices, self.faces, targets, self.obtuse, slots, size))
        moves = np.zeros((len(vertices), 3))
        moves[self.columns] = directions
        return self.pattern.matrix(_derivatives.along(vertices, self.faces, targets, self.obtuse, slots, size, moves))

    def hessian(self, vertices: FloatArray, multipliers: FloatArray) -> CurvatureHessian:
        """Return the second derivative of the weighted sum of the defects.

        With Lagrange multipliers as weights, this is the constraint term of the Hessian. The mixed areas
        are left out: relative to the angles they are of the order of K times the squared edge length.

        Parameters
        ----------
        vertices
            ``(n, 3)`` coordinates [L].
        multipliers
            ``(k,)`` weights of the rows.

        Returns
        -------
        CurvatureHessian
            As products with moves.
        """
        return CurvatureHessian(vertices, self.faces, self._at_vertices(len(vertices), multipliers))

    def second_derivative(self, vertices: FloatArray, multipliers: FloatArray) -> sparse.csr_matrix:
        """Return the second derivative of the weighted sum of the residuals, that of the mixed areas included.

        Parameters
        ----------
        vertices
            ``(n, 3)`` coordinates [L].
        multipliers
            ``(k,)`` weights of the rows.

        Returns
        -------
        csr_matrix
            ``(3c, 3c)`` by the coordinates of the moving vertices [1/L^2].
        """
        pattern = RingPattern(self.faces, len(vertices), self.columns, self.columns)
        weights = self._at_vertices(len(vertices), multipliers)
        data = CurvatureHessian(vertices, self.faces, weights, self.targets).blocks(pattern.slots, pattern.size)
        return sparse.bsr_matrix((data, pattern.indices, pattern.indptr), shape=(3 * len(self.columns),) * 2).tocsr()

    def _at_vertices(self, count: int, multipliers: FloatArray) -> FloatArray:
        """Return the weights of the rows (k,) at the vertices (n,)."""
        weights = np.zeros(count)
        weights[self.rows] = multipliers
        return weights
