"""Panels: division of regions into groups of faces along a grid in plan, lines of curvature or curves."""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable
from collections.abc import Sequence
from typing import NamedTuple
from typing import Optional
from typing import Union

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
from ..model.given import refuse_other_units
from ..model.problem import CGCProblem
from ..model.problem import PosesProblem
from ..model.problem import problem_of
from .curves import CurveNet
from .figures import metres
from .grid_lines import Division
from .grid_lines import GridLines
from .grid_lines import Widths
from .grid_lines import checked_widths
from .grid_lines import grid_lines
from .joints import Joints
from .joints import curve_joints
from .joints import grid_joints
from .layout import among
from .option_values import ALONG
from .panel_seams import seam_lengths

__all__ = ["Panel", "grid_panels", "panels"]

MOVES = (0.05, 0.1, 0.15, 0.2)  # of a strip, by which grid lines are moved to lengthen short seams
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
    columns: Optional[Widths] = None,
    rows: Optional[Widths] = None,
    curves: Union[Sequence[ArrayLike], CurveNet, None] = None,
    along: str = "plan",
    shortest: float = 100.0,
) -> list[Panel]:
    """Divide every region into panels.

    Joints cut through faces, and continue across the creases between regions that share a whole side. The mesh of the panels has the
    vertices of `mesh` first and new ones on its edges and in its faces, so that the surface does not change. A joint that passes a
    vertex within 1 % of an edge length goes through it, and a grid line along a row of edges follows them.

    Parameters
    ----------
    mesh
        A result, mesh or problem.
    size
        Approximate width of the panels; every region gets a whole number of them [L].
    count
        Alternative: approximate number of panels per region.
    columns, rows
        Alternative: widths of the panels along the first and the second direction, one number or several, of which the last one is
        repeated [L]. The first direction is the one nearest to x.
    curves
        Alternative: joints as paths of vertex indices, as curves of points ``(k, 3)`` [L], or along the curves of a net, see
        :func:`curve_net`.
    along
        ``"plan"``: grid along the sides of regions with four corners, else along the axes of the plan. ``"curvature"``: grid along
        lines of curvature.
    shortest
        Length of seams below which grid lines are moved, if possible [mm].

    Returns
    -------
    list of Panel
        Panels in the order of the regions.

    Raises
    ------
    CGCError
        If not exactly one of `size`, `count`, `curves`, and `columns` or `rows` is given, or its value is invalid.

    Examples
    --------
    >>> import compas_cgc
    >>> divided = panels(compas_cgc.read(compas_cgc.get("facade.3dm")), 4.0)
    >>> len(divided), divided[0].name
    (6, '0-1')
    """
    widths = columns if columns is not None else rows
    if sum(given is not None for given in (size, count, curves, widths)) != 1:
        raise CGCError("give exactly one of size, count, curves, and columns or rows to divide the regions")
    if along not in ALONG:
        raise CGCError(f"along must be one of {', '.join(ALONG)}, not {along!r}")
    if size is not None and not 0.0 < checked_number(size, "the size of panels") < math.inf:
        raise CGCError(f"the size of panels must be a positive length, not {size!r}")
    if count is not None and not checked_number(count, "the count of panels") >= 1:
        raise CGCError(f"the count of panels per region must be at least 1, not {count!r}")
    problem = problem_of(mesh, "or the result of a solve is built from").without_dummies()
    extent = float(np.linalg.norm(np.ptp(problem.vertices, axis=0)))
    if size is not None:
        refuse_other_units("the size of panels", size, extent, problem.drawing.units)
    for name, given in (("the width of columns", columns), ("the width of rows", rows)):
        if given is not None:
            refuse_other_units(name, min(checked_widths(given)), extent, problem.drawing.units)
    if curves is None:
        return grid_panels(problem, Division(size, count, columns, rows, along=along), shortest)
    joints = curve_joints(problem, [curve.points for curve in curves.curves] if isinstance(curves, CurveNet) else curves)
    return _named(_divided(joints, problem.regions()), len(problem.faces))


def grid_panels(problem: CGCProblem, division: Division, shortest: float) -> list[Panel]:
    """Return panels between the lines of a grid, which are moved where seams are shorter than a length [mm]."""
    label, areas = problem.regions(), face_areas(problem.vertices, problem.faces)
    least = 1e-3 * checked_number(shortest, "shortest") / metres(problem.drawing.units)
    grid = grid_lines(problem, label, division)
    divided = _with_long_seams(grid, lambda own: _divided(grid_joints(problem, label, areas, own), label), least)
    return _named(divided, len(label))


def _named(divided: _Divided, faces: int) -> list[Panel]:
    """Return the panels of a division of a mesh with a number of faces."""
    joints, part, piece = divided
    own = joints.mesh
    cut = own if len(own.faces) > faces else None
    found: list[Panel] = []
    for region in range(int(part.max(initial=-1)) + 1):
        inside = np.flatnonzero(part == region)
        number = _numbered(piece[inside], joints.cell[inside])
        count_of = int(number.max(initial=-1)) + 1
        digits = len(str(count_of))
        found += [Panel(f"{region}-{k + 1:0{digits}}", region, inside[number == k], cut) for k in range(count_of)]
    return found


class _Divided(NamedTuple):
    """A mesh cut along joints, with the pieces between them."""

    joints: Joints
    part: IntArray  # (m',) region of every face
    piece: IntArray  # (m',)


def _divided(joints: Joints, label: IntArray) -> _Divided:
    own = joints.mesh
    part = label[own.parent]
    piece = _grouped(own.faces, part, joints.cell, joints.edges, len(own.vertices))
    return _Divided(joints, part, _without_crumbs(own.vertices, own.faces, part, piece, joints.share))


def _with_long_seams(grid: GridLines, divide: Callable[[GridLines], _Divided], least: float) -> _Divided:
    """Return the division by a grid whose lines are moved until no seam is shorter than a length [L], if possible.

    Lines move in pairs that keep the symmetry of the grid, and single lines only if that is not enough.
    """
    best = divide(grid)
    shortfall = _shortfall(best, least)
    for paired, share in itertools.product((True, False), MOVES):
        for k, i, sign in itertools.product(range(len(grid.lines)), range(max(map(len, grid.lines))), (1.0, -1.0)):
            if shortfall == 0.0:
                return best
            count = len(grid.lines[k])
            if i >= (count // 2 if paired else count):
                continue
            lines = grid.lines[k].copy()
            lines[i] += sign * share / (count + 1)
            if paired:
                lines[-1 - i] -= sign * share / (count + 1)
            moved = grid._replace(lines=[*grid.lines[:k], lines, *grid.lines[k + 1 :]])
            found = divide(moved)
            if _shortfall(found, least) < shortfall:
                best, shortfall, grid = found, _shortfall(found, least), moved
    return best


def _shortfall(divided: _Divided, least: float) -> float:
    """Return the sum of the relative shortfalls of the seams that are shorter than a length [L]."""
    lengths = seam_lengths(divided.joints.mesh.vertices, divided.joints.mesh.faces, divided.piece)[1]
    return float(np.maximum(1.0 - lengths / least, 0.0).sum()) if least > 0.0 else 0.0


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
