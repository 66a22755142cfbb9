"""Chebyshev nets: asymptotic curves of a surface of K < 0 with equal distances between crossings."""

from __future__ import annotations

from typing import NamedTuple
from typing import Optional

import numpy as np
from scipy import sparse
from scipy.sparse.csgraph import breadth_first_order

from ...discrete.arrays import FloatArray
from ...discrete.arrays import IntArray
from ...discrete.arrays import PerVertex
from ...linalg import factorise
from ..seams import opens_to_disks
from .crossings import is_long
from .k_surface import KSurface
from .k_surface import fit_k_surface
from .trace import EDGE_MARGIN
from .trace import DirectionField
from .trace import Traced

__all__ = ["LENGTH_TOLERANCE", "ChebyshevNet", "chebyshev_net"]

LENGTH_TOLERANCE = 0.03  # relative error of lengths in a face; a side of a net crosses several faces
MAX_DEVIATION = 2e-3  # of the mesh from the nearest surface of constant K, relative to its size, up to which it is used
ROUNDS = 8  # largest number of rounds of correcting directions by lengths

Pair = tuple[FloatArray, FloatArray]  # one array per family


class ChebyshevNet(NamedTuple):
    """Both families of asymptotic curves at one spacing."""

    error: float  # largest relative error of lengths in a face
    lines: list[list[Traced]]
    surface: Optional[KSurface]  # nearest surface of constant K; None if the fit failed


def chebyshev_net(field: DirectionField, spacing: float, K: float) -> Optional[ChebyshevNet]:
    r"""Return the largest length error in a face and both families of asymptotic curves at a spacing, with two curves through the centre.

    On a surface of constant K < 0 the asymptotic curves are coordinate lines u, v with arc length as parameter. The coordinates
    minimise

    .. math:: \min_{u, v} \int (\partial_1 u - 1)^2 + (\partial_2 u)^2 + (\partial_2 v - 1)^2 + (\partial_1 v)^2,

    with derivatives along the two asymptotic directions. This spreads discretisation errors over the surface, while they would
    accumulate from curve to curve in tracing. Lengths on a mesh are more accurate than directions, so the directions are
    recomputed from the coordinate lines until the sides are equal. The surface of constant K nearest to the mesh then gives the final
    coordinates.

    Parameters
    ----------
    field
        Direction field of a region.
    spacing
        Distance between curves along those that they cross [L].
    K
        Negative Gaussian curvature of the surface [1/L²].

    Returns
    -------
    ChebyshevNet or None
        None if the region has a hole, if it lacks asymptotic directions in most faces, or if these have a singularity.

    References
    ----------
    Chebyshev 1878; Eisenhart, *A treatise on the differential geometry of curves and surfaces* (1909), section 120.
    """
    directions = _combed(field, K) if opens_to_disks(field.faces) else None
    if directions is None:
        return None
    directions, values, off = _coordinates(field, directions)
    for _ in range(ROUNDS):
        if off < LENGTH_TOLERANCE:
            break
        directions, values, off = _coordinates(field, directions)
    surface = _nearest(field, directions, values, K)
    if surface is not None:
        used = np.unique(field.faces)
        values = np.full_like(values[0], np.nan), np.full_like(values[1], np.nan)
        values[1][used], values[0][used] = surface.at.T
    return ChebyshevNet(off, [_lines(field, each, spacing) for each in values], surface)


def _nearest(field: DirectionField, directions: Pair, values: Pair, K: float) -> Optional[KSurface]:
    """Return the surface of constant K nearest to the vertices, None if it is too far from them."""
    used, corners = np.unique(field.faces, return_inverse=True)
    corners = corners.reshape(-1, 3)
    points, at = field.vertices[used], np.column_stack([values[1][used], values[0][used]])
    first, second = (np.einsum("fk,fki->fi", each, field.axes) for each in directions)
    cosines = np.einsum("fi,fi->f", first, second) / (np.linalg.norm(first, axis=1) * np.linalg.norm(second, axis=1))
    angles = np.bincount(corners.ravel(), np.repeat(np.arccos(np.clip(cosines, -1.0, 1.0)), 3)) / np.bincount(corners.ravel())
    centre = int(np.argmin((at**2).sum(axis=1)))
    face = int(np.argmax((corners == centre).any(axis=1)))
    tangent = first[face] / np.linalg.norm(first[face])
    normal = np.cross(*field.axes[face])
    # The second family is to the left of the first.
    normal *= np.sign(np.cross(tangent, second[face]) @ normal)
    found = fit_k_surface(points, at, angles, np.array([tangent, np.cross(normal, tangent), normal]), K, points[centre])
    size = float(np.linalg.norm(np.ptp(points, axis=0)))
    return found if found is not None and found.off.max() < MAX_DEVIATION * size else None


def _coordinates(field: DirectionField, directions: Pair) -> tuple[Pair, Pair, float]:
    """Return the directions (m, 2) of both coordinate lines, the coordinates (n,) [L], and the largest length error in a face."""
    first, second = directions
    u, v = _coordinate(field, second, first), _coordinate(field, first, second)
    along = _along(field, u, first), _along(field, v, second)
    return along, (u, v), max(float(np.abs(_derivatives(field, d) @ c - 1.0).max()) for d, c in zip(along, (v, u)))


def _combed(field: DirectionField, K: float) -> Optional[Pair]:
    """Return consistently oriented asymptotic directions of both families in the axes of every face (m, 2), None if impossible."""
    S = field.operators[field.faces].mean(axis=1)
    x, y = field.axes.transpose(1, 0, 2)
    a, b, c = (np.einsum("fi,fij,fj->f", p, S, q) for p, q in ((x, x), (x, y), (y, y)))
    half, difference = 0.5 * (a + c), 0.5 * (a - c)
    if not np.median(half**2 - np.hypot(difference, b) ** 2) < 0.0:
        return None
    # Fits at free edges are inaccurate, some even have K > 0; the known K replaces theirs.
    largest, aside = 0.5 * np.arctan2(b, difference), 0.5 * np.arccos(-half / np.sqrt(half**2 - K))
    mate = field.mate.ravel()
    side = np.flatnonzero(mate >= 0)
    face, beyond = side // 3, mate[side] // 3
    graph = sparse.coo_matrix((np.ones(len(face), np.int8), (face, beyond)), shape=(len(S), len(S))).tocsr()
    order, before = breadth_first_order(graph, 0)
    found = []
    for angle in (largest + aside, largest - aside):
        flat = np.column_stack([np.cos(angle), np.sin(angle)])
        space = np.einsum("fk,fki->fi", flat, field.axes)
        same = np.where(np.einsum("fi,fi->f", space, space[np.maximum(before, 0)]) < 0.0, -1.0, 1.0)
        sign = np.ones(len(S))
        for each in order[1:].tolist():
            sign[each] = same[each] * sign[before[each]]
        space = sign[:, None] * space
        if np.einsum("fi,fi->f", space[face], space[beyond]).min(initial=1.0) <= 0.0:
            return None
        found.append(sign[:, None] * flat)
    return found[0], found[1]


def _along(field: DirectionField, values: PerVertex, directions: FloatArray) -> FloatArray:
    """Return the directions (m, 2) of the level lines of a coordinate (n,), oriented like `directions` (m, 2)."""
    x, y = (_derivatives(field, np.broadcast_to(axis, directions.shape)) @ values for axis in np.eye(2))
    lines = np.column_stack([-y, x]) * np.sign(x * directions[:, 1] - y * directions[:, 0])[:, None]
    return lines / np.maximum(np.hypot(x, y), np.finfo(float).tiny)[:, None]


def _derivatives(field: DirectionField, directions: FloatArray) -> sparse.csr_matrix:
    """Return the matrix from values at vertices to their derivatives along directions (m, 2) in every face (m, n)."""
    corners = field.vertices[field.faces]
    ahead = np.einsum("fki,fji->fkj", corners[:, 1:] - corners[:, :1], field.axes)
    share = np.linalg.solve(ahead.transpose(0, 2, 1), directions[:, :, None])[:, :, 0]
    weights = np.column_stack([-share.sum(axis=1), share])
    m = len(field.faces)
    return sparse.csr_matrix((weights.ravel(), field.faces.ravel(), np.arange(0, 3 * m + 1, 3)), shape=(m, len(field.vertices)))


def _coordinate(field: DirectionField, along: FloatArray, across: FloatArray) -> PerVertex:
    """Return the coordinate (n,) [L] with unit derivative along one direction and zero along the other; 0 at the centre."""
    corners = field.vertices[field.faces]
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    area = 0.5 * np.linalg.norm(normals, axis=1)
    centres = corners.mean(axis=1)
    middle = field.faces[np.argmin(np.linalg.norm(centres - centres.mean(axis=0), axis=1))]
    grown, still = _derivatives(field, along), _derivatives(field, across)
    matrix = (grown.T @ sparse.diags(area) @ grown + still.T @ sparse.diags(area) @ still).tocsr()
    # The solution is unique up to a constant.
    used = np.setdiff1d(np.unique(field.faces), middle[:1])
    values = np.zeros(len(field.vertices))
    values[used] = factorise(matrix[used][:, used], symmetric=True, points=field.vertices[used]).solve((grown.T @ area)[used])
    return values - values[middle].mean()


def _lines(field: DirectionField, values: PerVertex, spacing: float) -> list[Traced]:
    """Return the level lines of a coordinate (n,) at multiples of the spacing."""
    corners = values[field.faces]
    levels = range(int(np.ceil(corners.min() / spacing)), int(np.floor(corners.max() / spacing)) + 1)
    return [line for level in levels for line in _level(field, values - level * spacing) if is_long(line, spacing)]


def _level(field: DirectionField, values: PerVertex) -> list[Traced]:
    """Return the zero level lines of values (n,), from boundary to boundary."""
    above = values[field.faces] >= 0.0
    ahead = np.roll(above, -1, axis=1)
    into, out = np.argmax(~above & ahead, axis=1), np.argmax(above & ~ahead, axis=1)
    crossed = np.flatnonzero((above != ahead).any(axis=1))
    beyond = field.mate[crossed, out[crossed]]
    following = np.full(len(field.faces), -1)
    following[crossed] = np.where(beyond >= 0, beyond // 3, -1)
    lines = []
    for face in crossed[field.mate[crossed, into[crossed]] < 0].tolist():
        faces = []
        while face >= 0:
            faces.append(face)
            face = int(following[face])
        own = np.array(faces)
        points = (_zeros(field, values, own, into[own]), _zeros(field, values, own[-1:], out[own[-1:]]))
        lines.append(Traced(np.vstack(points), own))
    return lines


def _zeros(field: DirectionField, values: PerVertex, faces: IntArray, sides: IntArray) -> FloatArray:
    """Return the zeros (k, 3) of values (n,) on sides of faces."""
    start, end = field.faces[faces, sides], field.faces[faces, (sides + 1) % 3]
    share = np.clip(values[start] / (values[start] - values[end]), EDGE_MARGIN, 1.0 - EDGE_MARGIN)[:, None]
    return (1.0 - share) * field.vertices[start] + share * field.vertices[end]
