"""Development of a region onto the sphere, plane or hyperbolic plane of its curvature, face by face."""

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
from ..errors import FINER
from ..errors import CGCError
from ..errors import Sentence
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
    """Faces laid out on the surface of constant curvature K; congruent to those of a mesh solved with the measure exact.

    Parameters
    ----------
    K
        Gaussian curvature [1/L^2].
    points
        (p, 3) points of the space form, see compas_cgc.fabrication.space_form.
    faces
        (m, 3) indices of points at the corners of every face.
    vertices
        (p,) mesh vertex of every point; a vertex on a seam has several points.
    own_faces
        (m,) faces of the mesh.
    seam
        (e, 2) mesh edges along which the layout is open.
    gap
        Largest distance between the positions of a vertex in different faces [L].
    edge_error
        Largest relative difference between an edge and its chord on the mould.

    Examples
    --------
    >>> import compas_cgc
    >>> from compas_cgc.fabrication import develop
    >>> laid = develop(compas_cgc.solve(compas_cgc.read(compas_cgc.get("vault.3dm")), settings={"measure": "exact"}))
    >>> laid.K, laid.gap < 1e-9
    (0.0, True)
    """

    K: float  # [1/L^2]
    points: FloatArray  # (p, 3) points of the space form, see compas_cgc.fabrication.space_form
    faces: Faces  # (m, 3) indices of points at the corners of every face
    vertices: Indices  # (p,) mesh vertex of every point; a vertex on a seam has several points
    own_faces: Indices  # (m,) faces of the mesh
    seam: Edges  # (e, 2) mesh edges along which the layout is open
    gap: float  # largest distance between the positions of a vertex in different faces [L]
    edge_error: float  # largest relative difference between an edge and its chord on the mould

    @property
    def places(self) -> Vertices:
        """Coordinates (p, 3) with the pole at the origin; z is the height below the top of a sphere, zero in the plane [L].

        For K < 0 the points lie on the hyperboloid in Minkowski space, in which the square of z counts negative.
        """
        return space_form.places(self.points, self.K)

    @property
    def radius(self) -> float:
        """Radius of the mould, infinite for K = 0 [L]."""
        return 1.0 / math.sqrt(abs(self.K)) if self.K else math.inf

    def turned(self, motion: FloatArray) -> Development:
        """Return the development after a rigid motion (3, 3) of the space form."""
        return self._replace(points=space_form.turned(self.points, motion))


@names_what_was_meant()
def develop(
    mesh: PosesProblem, region: Union[int, ArrayLike] = 0, seam: Seam = None, *, K: Optional[float] = None, arc: bool = False
) -> Development:
    """Develop a region onto the sphere, plane or hyperbolic plane of its curvature.

    A rigid motion lays each face beside its neighbour. Around every vertex the faces close if the mesh was solved with
    ``measure="exact"``; otherwise `gap` is the closing error.

    Parameters
    ----------
    mesh
        A result, mesh or problem.
    region
        Number of the region, or indices of mesh faces.
    seam
        Cut of a region with a hole: one or more paths of vertex indices, or ``"auto"`` for the shortest.
    K
        Gaussian curvature [1/L^2]. Default: the target of the region.
    arc
        Whether edges are arc lengths on the mould (``measure="exact-arc"``) instead of chords.

    Returns
    -------
    Development
        Development with the pole at the centre of the region.

    Raises
    ------
    CGCError
        If the region does not exist or has no single K, a seam is missing or insufficient, or a face is too large for the mould.

    References
    ----------
    Minding's theorem. Jiang et al., *Using isometries for computational design and fabrication*, doi:10.1145/3450626.3459839.

    Examples
    --------
    >>> import compas_cgc
    >>> laid = develop(compas_cgc.solve(compas_cgc.read(compas_cgc.get("vault.3dm")), settings={"measure": "exact"}), 0)
    >>> laid.points.shape, laid.edge_error < 1e-9
    ((221, 3), True)
    """
    problem = problem_of(mesh, "or the result of a solve is built from").without_dummies()
    chosen, name, target = _faces_of(problem, region)
    K = target if K is None else K
    if K is None:
        raise CGCError(f"{name} has no single target K̄; set one, or give the K to develop it with")
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
        raise CGCError(f"faces must be indices from 0 to {len(label) - 1} of the mesh")
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
    """Lay out faces on the surface of constant curvature K, see :func:`develop`.

    Parameters
    ----------
    vertices
        ``(n, 3)`` coordinates [L].
    faces
        ``(m, 3)`` vertex indices, counterclockwise seen from outside.
    K
        Gaussian curvature [1/L^2].
    seam
        One or more paths of vertices, or ``"auto"``.
    faces_of
        Indices of the faces to lay out. Default: all.
    arc
        Whether edges are arc lengths on the mould.
    name
        Name of the faces in error messages.

    Returns
    -------
    Development
        The layout and its closing error.

    Examples
    --------
    >>> square = np.array([[0.0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]])
    >>> lay_out(square, np.array([[0, 1, 2], [0, 2, 3]]), 0.01).K
    0.01
    """
    V, F = mesh_arrays(vertices, faces)
    if not math.isfinite(K):
        raise CGCError(f"K must be a finite number to lay out {name}, not {K!r}")
    own = np.arange(len(F)) if faces_of is None else faces_of
    part = np.ascontiguousarray(F[own])
    if not len(part):
        raise CGCError(f"{name} has no faces; give faces to lay out")
    filled = circumradii(V, part, K, arc) if K > 0.0 else np.zeros(len(part))
    if (filled >= 1.0).any():
        a, b, c = part[np.argmax(filled)].tolist()
        raise CGCError(Sentence(f"face {a}-{b}-{c} is too large for a mould of K = {K:.4g}; refine the mesh there", [FINER]))
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
        With a remedy.
    """
    _joined(faces, np.empty((0, 2), np.int64), name, "divide it into smaller panels, or by a joint from boundary to boundary")


def _joined(faces: Faces, seam: Edges, name: str, mend: str = "a path of vertices from boundary to boundary, or seam='auto'") -> Edges:
    """Return the edges (e, 4) of faces (m, 3) that stay joined, all but those of the seam.

    Raises
    ------
    CGCError
        If the result is not one piece without holes.
    """
    edges = edge_faces(faces)
    joined = edges[(edges[:, 3] >= 0) & ~among(edges[:, :2], seam, int(faces.max()) + 1)]
    graph = sparse.coo_matrix((np.ones(len(joined), np.int8), (joined[:, 2], joined[:, 3])), shape=(len(faces),) * 2)
    if connected_components(graph, directed=False)[0] > 1:
        raise CGCError(f"{name} consists of several pieces; lay out each separately, or give another seam")
    if not opens_to_disks(cut_open(faces, joined)[0]):
        raise CGCError(_not_a_disk(name, faces, seam, mend))
    return joined


def _not_a_disk(name: str, faces: Faces, seam: Edges, mend: str) -> str:
    loops = len(boundary_loops(faces))
    if len(seam):
        return f"the seam does not open {name} to one piece without holes; run it from boundary to boundary, or use seam='auto'"
    if loops == 0:
        return f"{name} is closed; give a seam to open it: a path of vertices, or 'auto'"
    if loops == 1:
        return f"{name} has a handle; give a seam that cuts the handle"
    return f"{name} has a hole and needs a seam: {mend}"
