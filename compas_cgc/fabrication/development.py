"""Development: a region laid onto the sphere, the plane or the hyperbolic plane of its curvature, face by face."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import NamedTuple
from typing import Optional
from typing import Union

import numpy as np
from numpy.typing import ArrayLike
from scipy import sparse
from scipy.sparse.csgraph import connected_components

from ..discrete import edge_faces
from ..discrete import mesh_arrays
from ..discrete.arrays import Edges
from ..discrete.arrays import Faces
from ..discrete.arrays import FloatArray
from ..discrete.arrays import Indices
from ..discrete.arrays import Vertices
from ..discrete.space_form import circumradii
from ..errors import CGCError
from ..errors import names_what_was_meant
from ..meshing import boundary_loops
from ..model.problem import CGCProblem
from ..model.problem import PosesProblem
from ..model.problem import problem_of
from . import space_form
from .layout import among
from .layout import cut_open
from .layout import lay
from .option_values import whole
from .seams import along_paths
from .seams import opens_to_disks
from .seams import seam_edges
from .solved import chosen_regions

__all__ = ["Development", "Seam", "check_disk", "develop", "lay_out"]

Seam = Union[None, str, Sequence[int], Sequence[Sequence[int]]]


class Development(NamedTuple):
    """Faces laid onto the surface of constant curvature K, congruent to those of the mesh where that is exact.

    Parameters
    ----------
    K
        [1/L^2].
    points
        (p, 3) places as points of the space form, see compas_cgc.fabrication.space_form.
    faces
        (m, 3) places of the corners of every face.
    vertices
        (p,) vertex of the mesh at every place; those on a seam have several.
    own_faces
        (m,) faces of the mesh.
    seam
        (e, 2) edges of the mesh along which it is open.
    gap
        Largest distance between the places that the faces around a vertex give to it [L].
    edge_error
        Largest difference between an edge and its chord on the mould, against the edge.

    Examples
    --------
    >>> import compas_cgc
    >>> from compas_cgc.fabrication import develop
    >>> laid = develop(compas_cgc.solve(compas_cgc.read(compas_cgc.get("vault.3dm"))))
    >>> laid.K, laid.gap < 1e-9
    (0.0, True)
    """

    K: float  # [1/L^2]
    points: FloatArray  # (p, 3) places as points of the space form, see compas_cgc.fabrication.space_form
    faces: Faces  # (m, 3) places of the corners of every face
    vertices: Indices  # (p,) vertex of the mesh at every place; those on a seam have several
    own_faces: Indices  # (m,) faces of the mesh
    seam: Edges  # (e, 2) edges of the mesh along which it is open
    gap: float  # largest distance between the places that the faces around a vertex give to it [L]
    edge_error: float  # largest difference between an edge and its chord on the mould, against the edge

    @property
    def places(self) -> Vertices:
        """Coordinates (p, 3) with the pole at the origin: on a sphere z is the height below its top, in the plane zero [L].

        For K < 0 they lie on the hyperboloid in Minkowski's space, where the square of z counts negative.
        """
        return space_form.places(self.points, self.K)

    @property
    def radius(self) -> float:
        """Radius of the mould, infinite for K = 0 [L]."""
        return 1.0 / math.sqrt(abs(self.K)) if self.K else math.inf

    def turned(self, motion: FloatArray) -> Development:
        """Return the same after a rigid motion (3, 3) of the space form."""
        return self._replace(points=space_form.turned(self.points, motion))


@names_what_was_meant()
def develop(
    mesh: PosesProblem, region: Union[int, ArrayLike] = 0, seam: Seam = None, *, K: Optional[float] = None, arc: bool = False
) -> Development:
    """Lay a region onto the mould of its curvature: sphere, plane or hyperbolic plane.

    Each face is laid beside its neighbour by a rigid motion, so rounding does not add up. Around every vertex the
    faces close where the mesh was solved with ``measure="exact"``; elsewhere the gap says by how much they do not.

    Parameters
    ----------
    mesh
        A result, mesh or problem.
    region
        Its number, or faces of the mesh by their positions.
    seam
        Where to cut a region that has a hole: a path of vertices by their positions, several, or ``"auto"`` for the shortest.
    K
        Gaussian curvature [1/L^2]. Default: the target of the region.
    arc
        Take edges for lengths along the mould (``measure="exact-arc"``), not for chords.

    Returns
    -------
    Development
        With the pole in the middle of the region.

    Raises
    ------
    CGCError
        If there is no such region, it has no single K, a seam is missing or does not open it, or a face is too large for the mould.

    References
    ----------
    Minding's theorem. Jiang et al., *Using isometries for computational design and fabrication*, doi:10.1145/3450626.3459839.

    Examples
    --------
    >>> import compas_cgc
    >>> laid = develop(compas_cgc.solve(compas_cgc.read(compas_cgc.get("vault.3dm"))), 0)
    >>> laid.points.shape, laid.edge_error < 1e-9
    ((221, 3), True)
    """
    problem = problem_of(mesh, "or the result of a solve is built from").without_dummies()
    chosen, name, target = _faces_of(problem, region)
    K = target if K is None else K
    if K is None:
        raise CGCError(f"{name} has no single K̄; give it one, or name the K to lay it out with")
    return lay_out(problem.vertices, problem.faces, float(K), seam, faces_of=chosen, arc=arc, name=name)


def _faces_of(problem: CGCProblem, region: Union[int, ArrayLike]) -> tuple[Indices, str, Optional[float]]:
    """Return the faces of a region, its name, and its target."""
    targets = problem.region_targets()
    label = problem.regions()
    if np.ndim(region) == 0:
        (number,) = chosen_regions(problem, [whole(region, "a region")])
        return np.flatnonzero(label == number), f"region {number}", targets[number]
    chosen = np.asarray(region, dtype=np.int64)
    if not len(chosen) or chosen.min() < 0 or chosen.max() >= len(label):
        raise CGCError(f"faces to lay out must be some of the {len(label)} of the mesh, by their positions")
    own = {targets[number] for number in np.unique(label[chosen]).tolist()}
    return chosen, "the piece", own.pop() if len(own) == 1 else None


@names_what_was_meant()
def lay_out(
    vertices: ArrayLike,
    faces: ArrayLike,
    K: float,
    seam: Seam = None,
    *,
    faces_of: Optional[Indices] = None,
    arc: bool = False,
    name: str = "the mesh",
) -> Development:
    """Lay faces onto the surface of constant curvature K, see :func:`develop`.

    Parameters
    ----------
    vertices
        ``(n, 3)`` coordinates [L].
    faces
        ``(m, 3)`` vertex indices, anticlockwise seen from outside.
    K
        Gaussian curvature [1/L^2].
    seam
        Path of vertices, several, or ``"auto"``.
    faces_of
        Which of the faces. Default: all.
    arc
        Take edges for lengths along the mould.
    name
        What errors call these faces.

    Returns
    -------
    Development
        The faces in space, and how well they close.

    Examples
    --------
    >>> square = np.array([[0.0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]])
    >>> lay_out(square, np.array([[0, 1, 2], [0, 2, 3]]), 0.01).K
    0.01
    """
    V, F = mesh_arrays(vertices, faces)
    if not math.isfinite(K):
        raise CGCError(f"K must be a number to lay {name} out with, not {K!r}")
    own = np.arange(len(F)) if faces_of is None else faces_of
    part = np.ascontiguousarray(F[own])
    if not len(part):
        raise CGCError(f"{name} has no faces")
    filled = circumradii(V, part, K, arc) if K > 0.0 else np.zeros(len(part))
    if (filled >= 1.0).any():
        a, b, c = part[np.argmax(filled)].tolist()
        raise CGCError(f"the face {a}-{b}-{c} is too large for a mould of K = {K:.4g}; refine the mesh there")
    edges = _edges_of(V, part, seam)
    joined = _joined(part, edges, name)
    laid = lay(V, part, joined, K, arc)
    points = space_form.turned(laid.points, space_form.to_pole(space_form.midpoint(laid.points, K), K))
    return Development(K, points, laid.faces, laid.origin, own, edges, laid.gap, laid.edge_error)


def _edges_of(vertices: Vertices, faces: Faces, seam: Seam) -> Edges:
    """Return the edges (e, 2) of a seam."""
    if isinstance(seam, str):
        if seam != "auto":
            raise CGCError(f"seam must be a path of vertices or 'auto', not {seam!r}")
        return seam_edges(vertices, faces, np.zeros(len(vertices), bool))
    return np.empty((0, 2), np.int64) if seam is None else along_paths(faces, seam)


def check_disk(faces: Faces, name: str) -> None:
    """Refuse faces (m, 3) that are not one piece without holes.

    Raises
    ------
    CGCError
        With what would help.
    """
    _joined(faces, np.empty((0, 2), np.int64), name, "divide it into smaller panels, or by a joint from one edge to the other")


def _joined(faces: Faces, seam: Edges, name: str, mend: str = "a path of vertices from one edge to the other, or seam='auto'") -> Edges:
    """Return the edges (e, 4) of faces (m, 3) that a seam leaves closed.

    Raises
    ------
    CGCError
        If what it opens is not one piece without holes.
    """
    edges = edge_faces(faces)
    joined = edges[(edges[:, 3] >= 0) & ~among(edges[:, :2], seam, int(faces.max()) + 1)]
    graph = sparse.coo_matrix((np.ones(len(joined), np.int8), (joined[:, 2], joined[:, 3])), shape=(len(faces),) * 2)
    if connected_components(graph, directed=False)[0] > 1:
        raise CGCError(f"{name} is in several pieces; lay each of them out by itself, or give another seam")
    if not opens_to_disks(cut_open(faces, joined)[0]):
        raise CGCError(_not_a_disk(name, faces, seam, mend))
    return joined


def _not_a_disk(name: str, faces: Faces, seam: Edges, mend: str) -> str:
    loops = len(boundary_loops(faces))
    if len(seam):
        return f"the seam does not open {name} to one piece without holes; lead it from edge to edge, or give seam='auto'"
    if loops == 0:
        return f"{name} is closed; give a seam to open it along, a path of vertices"
    if loops == 1:
        return f"{name} has a handle; give a seam that opens it"
    return f"{name} has a hole, so it needs a seam: {mend}"
