"""Panels: division of regions into groups of faces along a grid in plan, lines of curvature or curves."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import NamedTuple
from typing import Optional

import numpy as np
from numpy.typing import ArrayLike
from scipy import sparse
from scipy.sparse.csgraph import connected_components

from ..discrete import edge_faces
from ..discrete import face_areas
from ..discrete.arrays import Edges
from ..discrete.arrays import Faces
from ..discrete.arrays import FloatArray
from ..discrete.arrays import Indices
from ..discrete.arrays import IntArray
from ..discrete.arrays import Vertices
from ..errors import CGCError
from ..errors import names_what_was_meant
from ..meshing.level_cuts import CutMesh
from ..model.given import checked_number
from ..model.problem import PosesProblem
from ..model.problem import problem_of
from .joints import curve_joints
from .joints import grid_joints
from .layout import among
from .option_values import ALONG

__all__ = ["Panel", "panels"]

MIN_CELL_SHARE = 0.2  # area relative to a grid cell below which a panel is merged with a neighbour


class Panel(NamedTuple):
    """A group of faces of one region.

    Parameters
    ----------
    name
        Region and number, such as 3-07.
    region
        Number of the region.
    faces
        (f,) face indices in `cut` if joints cut through faces, else in the mesh.
    cut
        Mesh cut along the joints; None if these follow its edges.

    Examples
    --------
    >>> Panel("A1", 0, np.array([0, 1])).name
    'A1'
    """

    name: str  # region and number, such as 3-07
    region: int
    faces: Indices  # (f,) face indices in `cut` if joints cut through faces, else in the mesh
    cut: Optional[CutMesh] = None  # mesh cut along the joints; None if these follow its edges


def _instead(name: str) -> str:
    """Return what to write instead of an argument that `panels` does not take."""
    if name in ("length", "width", "edge_length"):
        return "write size=..."
    return "give it to moulds(surface, panels, ...)" if name in ("material", "thickness", "tolerance") else ""


@names_what_was_meant(_instead)
def panels(
    mesh: PosesProblem,
    size: Optional[float] = None,
    *,
    count: Optional[int] = None,
    curves: Optional[Sequence[ArrayLike]] = None,
    along: str = "plan",
) -> list[Panel]:
    """Divide every region into panels.

    Joints cut through faces. The mesh of the panels has the vertices of `mesh` first and new ones on its edges and in its faces, so
    that the surface does not change. A joint that passes a vertex within 1 % of an edge length goes through it, and a grid line
    along a row of edges follows them.

    Parameters
    ----------
    mesh
        A result, mesh or problem.
    size
        Approximate width of the panels; every region gets a whole number of them [L].
    count
        Alternative: approximate number of panels per region.
    curves
        Alternative: joints as paths of vertex indices or as curves of points ``(k, 3)`` [L].
    along
        ``"plan"``: grid along the sides of regions with four corners, else along the axes of the plan. ``"curvature"``: grid along
        lines of curvature.

    Returns
    -------
    list of Panel
        Panels in the order of the regions.

    Raises
    ------
    CGCError
        If not exactly one of `size`, `count` and `curves` is given, or its value is invalid.

    Examples
    --------
    >>> import compas_cgc
    >>> divided = panels(compas_cgc.read(compas_cgc.get("facade.3dm")), 4.0)
    >>> len(divided), divided[0].name
    (6, '0-1')
    """
    if sum(given is not None for given in (size, count, curves)) != 1:
        raise CGCError("give exactly one of size, count and curves to divide the regions")
    if along not in ALONG:
        raise CGCError(f"along must be one of {', '.join(ALONG)}, not {along!r}")
    if size is not None and not 0.0 < checked_number(size, "the size of panels") < math.inf:
        raise CGCError(f"the size of panels must be a positive length, not {size!r}")
    if count is not None and not checked_number(count, "the count of panels") >= 1:
        raise CGCError(f"the count of panels per region must be at least 1, not {count!r}")
    problem = problem_of(mesh, "or the result of a solve is built from").without_dummies()
    label = problem.regions()
    if curves is not None:
        joints = curve_joints(problem, curves)
    else:
        joints = grid_joints(problem, label, face_areas(problem.vertices, problem.faces), size, count, along)
    own = joints.mesh
    part = label[own.parent]
    piece = _grouped(own.faces, part, joints.cell, joints.edges, len(own.vertices))
    piece = _without_crumbs(own.vertices, own.faces, part, piece, joints.share)
    cut = own if len(own.faces) > len(label) else None
    found: list[Panel] = []
    for region in range(int(label.max(initial=-1)) + 1):
        inside = np.flatnonzero(part == region)
        number = _numbered(piece[inside], joints.cell[inside])
        count_of = int(number.max(initial=-1)) + 1
        digits = len(str(count_of))
        found += [Panel(f"{region}-{k + 1:0{digits}}", region, inside[number == k], cut) for k in range(count_of)]
    return found


def _grouped(faces: Faces, part: IntArray, cell: IntArray, blocked: Edges, n: int) -> IntArray:
    """Return the piece of every face (m,): connected faces of one part and cell, without crossing blocked edges."""
    edges = edge_faces(faces)
    edges = edges[edges[:, 3] >= 0]
    left, right = edges[:, 2:].T
    joined = (part[left] == part[right]) & (cell[left] == cell[right]) & ~among(edges[:, :2], blocked, n)
    graph = sparse.csr_matrix((np.ones(np.count_nonzero(joined)), (left[joined], right[joined])), shape=(len(faces),) * 2)
    return connected_components(graph, directed=False)[1].astype(np.int64)


def _without_crumbs(vertices: Vertices, faces: Faces, part: IntArray, piece: IntArray, share: FloatArray) -> IntArray:
    """Merge every piece much smaller than a cell with the neighbour of its part with the longest common joint."""
    areas = face_areas(vertices, faces)
    edges = edge_faces(faces)
    edges = edges[(edges[:, 3] >= 0)]
    edges = edges[(part[edges[:, 2]] == part[edges[:, 3]]) & (piece[edges[:, 2]] != piece[edges[:, 3]])]
    length = np.linalg.norm(vertices[edges[:, 0]] - vertices[edges[:, 1]], axis=1)
    own = piece.copy()
    few = MIN_CELL_SHARE * share[part[np.unique(piece, return_index=True)[1]]]
    left_out: set[int] = set()
    while True:
        area = np.bincount(own, areas, len(few))
        crumbs = [k for k in np.flatnonzero((area > 0.0) & (area < few)).tolist() if k not in left_out]
        if not crumbs:
            return own
        crumb = min(crumbs, key=lambda k: float(area[k]))
        one, other = own[edges[:, 2]], own[edges[:, 3]]
        beside = np.bincount(np.where(one == crumb, other, one), length * ((one == crumb) ^ (other == crumb)), len(few))
        if not beside.any():
            left_out.add(crumb)
            continue
        own[own == crumb] = int(np.argmax(beside))


def _numbered(piece: IntArray, cell: IntArray) -> IntArray:
    """Return pieces (m,) renumbered from 0 in the order of their first cells."""
    numbers, first, inverse = np.unique(piece, return_index=True, return_inverse=True)
    rank = np.empty(len(numbers), np.int64)
    rank[np.lexsort((first, cell[first]))] = np.arange(len(numbers))
    return rank[inverse.ravel()]
