"""The exact measure of K: angle sums of triangles of the sphere, the plane or the hyperbolic plane."""

from __future__ import annotations

import math
from typing import Optional

import numpy as np
from numpy.typing import ArrayLike
from scipy import sparse

from . import _kernels
from . import _space_form
from .areas import vertex_areas
from .arrays import Faces
from .arrays import FloatArray
from .arrays import Indices
from .arrays import PerFace
from .arrays import PerVertex
from .arrays import Vectors
from .arrays import Vertices
from .arrays import mesh_arrays
from .jacobian import CurvatureEquations
from .normals import vertex_normals

__all__ = ["EXACT", "SpaceFormEquations", "circumradii", "exact_equations", "sliding_ease", "space_form_angle_sums"]

EXACT = ("exact", "exact-arc")
ACROSS = 0.5  # what a move across the surface costs, against one along it that changes the angles of a saddle as much


def space_form_angle_sums(vertices: ArrayLike, faces: ArrayLike, K: ArrayLike, arc: bool = False) -> PerVertex:
    r"""Return the sum of the angles around every vertex, of triangles in the space form of curvature K.

    With squared chords a opposite a corner and b, c next to it,

    .. math:: \tan\theta = \frac{\sqrt{D - K a b c / 4}}{(b + c - a) / 2 - K b c / 4},
              \qquad D = \tfrac14 (2 (ab + bc + ca) - a^2 - b^2 - c^2),

    which is smooth through K = 0. Where the sum is ``2 pi`` the triangles close around the vertex: on a sphere of radius
    :math:`1/\sqrt K`, a plane, or a hyperboloid in Minkowski's space.

    Parameters
    ----------
    vertices
        ``(n, 3)`` coordinates [L].
    faces
        ``(m, 3)`` vertex indices.
    K
        Gaussian curvature, one number or one for every vertex ``(n,)`` [1/L^2].
    arc
        Take edges for lengths along the space form, not for chords.

    Returns
    -------
    (n,) float64
        Sums [rad].
    """
    V, F = mesh_arrays(vertices, faces)
    own = np.ascontiguousarray(np.broadcast_to(np.asarray(K, dtype=np.float64), (len(V),)))
    return _space_form.angle_sums(V, F, own, arc)


def circumradii(vertices: ArrayLike, faces: ArrayLike, K: ArrayLike, arc: bool = False) -> PerFace:
    r"""Return ``K R²`` with R the circumradius of every face (m,), for K of one number or ``(m,)`` [1/L^2].

    From one on the sphere of radius :math:`1/\sqrt K` is too small for the triangle.
    """
    V, F = mesh_arrays(vertices, faces)
    own = np.ascontiguousarray(np.broadcast_to(np.asarray(K, dtype=np.float64), (len(F),)))
    return _space_form.room(V, F, own, arc)


class SpaceFormEquations(CurvatureEquations):
    """One equation per vertex where K is asked for: ``2 pi`` less the angles of triangles in the space form of its K̄.

    Fulfilled, they make a simply connected region and its mould of congruent triangles, one for one. Their part of first order
    in K is that of :class:`~compas_cgc.discrete.jacobian.CurvatureEquations`, with Voronoi cells for chords and a third of each
    face for arcs.
    """

    arc: bool = False

    def angle_sums(self, vertices: Vertices) -> PerVertex:
        """Return the sum of angles at every vertex (n,) of a shape (n, 3)."""
        return _space_form.angle_sums(vertices, self.faces, self._known, self.arc)

    @property
    def _known(self) -> PerVertex:
        return np.where(np.isfinite(self.targets), self.targets, 0.0)

    def measure(self, vertices: Vertices) -> tuple[FloatArray, FloatArray]:
        """Return the residuals [rad] and the mixed areas [L^2] at the rows, ``(k,)`` each, of a shape (n, 3)."""
        _, area = _kernels.angle_sums_and_areas(vertices, self.faces, _kernels.MIXED)
        return 2 * math.pi - self.angle_sums(vertices)[self.rows], area[self.rows]

    def jacobian(self, vertices: Vertices, directions: Optional[Vectors] = None, areas: bool = True) -> sparse.csr_matrix:
        """Return the derivative of the residuals, see :meth:`CurvatureEquations.jacobian`; without ``areas`` that of K̄ = 0."""
        slots, size = self.pattern.slots, self.pattern.size
        K = self._known if areas else np.zeros_like(self.targets)
        if directions is None:
            return self.pattern.block_matrix(_space_form.everywhere(vertices, self.faces, K, slots, size, self.arc))
        moves = np.zeros((len(vertices), 3))
        moves[self.columns] = directions
        return self.pattern.matrix(_space_form.along(vertices, self.faces, K, slots, size, moves, self.arc))

    def too_large(self, vertices: Vertices) -> Optional[int]:
        """Return a face that the sphere of its K̄ has no room for, the worst; None where all have."""
        corners = np.full(len(self.targets), -np.inf)
        corners[self.rows] = self.targets[self.rows]
        K = np.maximum(corners[self.faces].max(axis=1), 0.0)
        filled = _space_form.room(np.ascontiguousarray(vertices), self.faces, K, self.arc)
        filled[K == 0.0] = 0.0
        worst = int(np.argmax(filled)) if len(filled) else 0
        return worst if len(filled) and filled[worst] >= 1.0 else None

    def complaint(self, vertices: Vertices) -> str:
        """Return the sentence on a face that is too large, empty where none is."""
        face = self.too_large(vertices)
        if face is None:
            return ""
        a, b, c = self.faces[face].tolist()
        return (
            f"the face {a}-{b}-{c} is too large for a mould of its K̄, whose radius has to exceed that of the circle through its "
            "corners; refine the mesh there"
        )


def exact_equations(equations: CurvatureEquations, measure: str) -> CurvatureEquations:
    """Return the equations of an exact measure with the same targets and unknowns; those given for any other measure."""
    if measure not in EXACT:
        return equations
    exact = SpaceFormEquations.__new__(SpaceFormEquations)
    exact.__dict__.update(equations.__dict__)
    exact.arc = measure == "exact-arc"
    return exact


def sliding_ease(vertices: Vertices, faces: Faces, K: PerVertex, columns: Indices) -> sparse.csr_matrix:
    """Return the inverse of a metric of moves for which those along a surface are cheap, as far as they change its angles.

    On a saddle of curvature K with edges of length h a move across it changes angles by ``sqrt(-K) / h`` for each length, one along it by
    ``-K``: so that has the weight one, and the first ``1 / (-K h^2)``.

    Parameters
    ----------
    vertices
        ``(n, 3)`` coordinates [L].
    faces
        ``(m, 3)`` vertex indices.
    K
        ``(n,)`` size of the curvature asked for, 0 where none is [1/L^2].
    columns
        ``(c,)`` vertices that may move; along the surface those where K is asked for only.

    Returns
    -------
    csr_matrix
        ``(3c, 3c)``.
    """
    asked = K > 0.0
    K = np.where(asked, K, K[asked].mean() if asked.any() else 0.0)
    across = np.minimum(1.0, K * vertex_areas(vertices, faces) / ACROSS)[columns]
    along = np.where(asked[columns], 1.0, across)
    normals = vertex_normals(vertices, faces)[columns]
    blocks = along[:, None, None] * np.eye(3) + (across - along)[:, None, None] * normals[:, :, None] * normals[:, None, :]
    places = np.arange(len(columns) + 1)
    return sparse.bsr_matrix((blocks, places[:-1], places), shape=(3 * len(columns),) * 2).tocsr()
