"""The exact measure of K: angle sums of triangles of the sphere, the plane or the hyperbolic plane."""

from __future__ import annotations

import math
from typing import Optional

import numpy as np
from numpy.typing import ArrayLike
from scipy import sparse

from ..errors import FINER
from ..errors import Sentence
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
# cost of a normal move relative to a tangential one with the same change of angles on a saddle; moves in the surface stay invisible
NORMAL_COST = 0.5


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
        Whether edges are arcs of the space form instead of chords.

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

    If it is one or more, the triangle is too large for the sphere of radius :math:`1/\sqrt K`.
    """
    V, F = mesh_arrays(vertices, faces)
    own = np.ascontiguousarray(np.broadcast_to(np.asarray(K, dtype=np.float64), (len(F),)))
    return _space_form.room(V, F, own, arc)


class SpaceFormEquations(CurvatureEquations):
    """One equation per vertex where K is prescribed: ``2 pi`` minus the angles of triangles in the space form of its K̄.

    Where they hold, the triangles of a simply connected region are congruent to those of its mould. To first order in K they
    are the equations of :class:`~compas_cgc.discrete.jacobian.CurvatureEquations`, with Voronoi cells for chords and a third of each
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
        """Return the face that exceeds the sphere of its K̄ most; None if all fit."""
        corners = np.full(len(self.targets), -np.inf)
        corners[self.rows] = self.targets[self.rows]
        K = np.maximum(corners[self.faces].max(axis=1), 0.0)
        filled = _space_form.room(np.ascontiguousarray(vertices), self.faces, K, self.arc)
        filled[K == 0.0] = 0.0
        worst = int(np.argmax(filled)) if len(filled) else 0
        return worst if len(filled) and filled[worst] >= 1.0 else None

    def complaint(self, vertices: Vertices) -> str:
        """Return a message about the face that is too large, empty if all fit."""
        face = self.too_large(vertices)
        if face is None:
            return ""
        a, b, c = self.faces[face].tolist()
        text = (
            f"the face {a}-{b}-{c} is too large for a mould of its K̄: the radius of its circumcircle is not smaller than that of the "
            "mould; refine the mesh there"
        )
        return Sentence(text, [FINER])


def exact_equations(equations: CurvatureEquations, measure: str) -> CurvatureEquations:
    """Return the equations of an exact measure with the same targets and unknowns; for any other measure, the given equations."""
    if measure not in EXACT:
        return equations
    exact = SpaceFormEquations.__new__(SpaceFormEquations)
    exact.__dict__.update(equations.__dict__)
    exact.arc = measure == "exact-arc"
    return exact


def sliding_ease(vertices: Vertices, faces: Faces, K: PerVertex, columns: Indices) -> sparse.csr_matrix:
    """Return the inverse of a metric of moves in which tangential moves are cheap, in proportion to their effect on angles.

    On a saddle of curvature K with edges of length h a normal move changes angles by ``sqrt(-K) / h`` per unit of length, a
    tangential one by ``-K``: their weights are ``1 / (-K h^2)`` and one.

    Parameters
    ----------
    vertices
        ``(n, 3)`` coordinates [L].
    faces
        ``(m, 3)`` vertex indices.
    K
        ``(n,)`` absolute value of the prescribed curvature, 0 where there is none [1/L^2].
    columns
        ``(c,)`` vertices that may move; tangential moves are cheap only where K is prescribed.

    Returns
    -------
    csr_matrix
        ``(3c, 3c)``.
    """
    asked = K > 0.0
    K = np.where(asked, K, K[asked].mean() if asked.any() else 0.0)
    across = np.minimum(1.0, K * vertex_areas(vertices, faces) / NORMAL_COST)[columns]
    along = np.where(asked[columns], 1.0, across)
    normals = vertex_normals(vertices, faces)[columns]
    blocks = along[:, None, None] * np.eye(3) + (across - along)[:, None, None] * normals[:, :, None] * normals[:, None, :]
    places = np.arange(len(columns) + 1)
    return sparse.bsr_matrix((blocks, places[:-1], places), shape=(3 * len(columns),) * 2).tocsr()
