"""Tracing of curves along directions of curvature, from face to face."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from ..._compiled import kernel
from ...discrete.arrays import Faces
from ...discrete.arrays import FloatArray
from ...discrete.arrays import IntArray
from ...discrete.arrays import Vectors
from ...discrete.arrays import Vertices
from ..patchwork import mates

__all__ = ["ASYMPTOTIC", "CURVATURE", "RULING", "DirectionField", "Traced", "direction_field", "trace"]

CURVATURE, ASYMPTOTIC, RULING = range(3)
EDGE_MARGIN = 1e-6  # least distance of a curve from the ends of an edge, relative to the edge
CLOSING_DISTANCE = 0.5  # a line of curvature that passes its start within this many edge lengths ends there
MIN_RUN = 6.0  # edge lengths that it must run before closing
MAX_PASSES = 4  # passes through a face after which a curve counts as an endless spiral


class DirectionField(NamedTuple):
    """A region with its shape operators, prepared for tracing."""

    vertices: Vertices  # (n, 3) [L]
    faces: Faces  # (m, 3) of one region
    mate: IntArray  # (m, 3) opposite half-edge of every side, as 3 x face + corner, or -1
    axes: FloatArray  # (m, 2, 3) orthonormal axes of every face, counterclockwise
    operators: FloatArray  # (n, 3, 3) shape operators [1/L]


class Traced(NamedTuple):
    """A curve on a mesh."""

    points: Vectors  # (k, 3) [L]
    faces: IntArray  # (k-1,) face of every segment


def direction_field(vertices: Vertices, faces: Faces, operators: FloatArray) -> DirectionField:
    """Return a region prepared for tracing."""
    a, b, c = vertices[faces].transpose(1, 0, 2)
    x = (b - a) / np.linalg.norm(b - a, axis=1, keepdims=True)
    normal = np.cross(b - a, c - a)
    normal = normal / np.linalg.norm(normal, axis=1, keepdims=True)
    return DirectionField(vertices, faces, mates(faces), np.stack([x, np.cross(normal, x)], axis=1), operators)


def trace(field: DirectionField, kind: int, family: int, face: int, point: Vectors, most: int = 100_000) -> Traced:
    """Return the curve through a point in a face, traced in both directions.

    Parameters
    ----------
    field
        Direction field of the region.
    kind, family
        ``CURVATURE``: family 0 along the larger principal curvature at the point, 1 along the smaller; ``ASYMPTOTIC``: 0
        and 1 along the directions of zero normal curvature to either side of the larger one; ``RULING``: 0 along the principal
        curvature nearest to 0, 1 along the other.
    face, point
        Start.
    most
        Largest number of points per direction.

    Returns
    -------
    Traced
        Fewer than two points if there is no such direction; a line of curvature that returns to its start is closed.
    """
    corners = field.vertices[field.faces[face]]
    edge = float(np.linalg.norm(np.roll(corners, -1, axis=0) - corners, axis=1).max()) if kind == CURVATURE else 0.0
    halves = []
    for sign in (1.0, -1.0):
        start = np.asarray(point, dtype=np.float64)
        points, faces, count, closed = _half(*field, kind, family, face, start, sign, most, edge)
        if closed:
            return _closed(field, points[:count], np.r_[faces[: count - 1], face])
        halves.append((points[:count], faces[: max(count - 1, 0)]))
    (ahead, over), (back, under) = halves
    if np.linalg.norm(ahead[-1] - ahead[0]) == 0.0 and len(back) < 2:
        return Traced(ahead[:1], over[:0])
    return Traced(np.vstack([back[:0:-1], ahead]), np.r_[under[::-1], over])


def _closed(field: DirectionField, points: Vectors, faces: IntArray) -> Traced:
    """Return a closed curve from one that has returned to its first face; the closing error is spread along it.

    Points move along the edges that they lie on, so that every segment stays in its face.
    """
    before, after = field.faces[faces[:-1]], field.faces[faces[1:]]
    shared = (before[:, :, None] == after[:, None]).any(axis=2)
    # The corner of the first face that the second does not share.
    odd = np.argmin(shared, axis=1)
    rows = np.arange(len(before))
    start, end = (field.vertices[before[rows, (odd + k) % 3]] for k in (1, 2))
    along = np.diff(np.vstack([points, points[:1]]), axis=0)[:-1]
    aside = np.cross(np.cross(field.axes[faces[:-1], 0], field.axes[faces[:-1], 1]), along)
    aside /= np.linalg.norm(aside, axis=1, keepdims=True)
    missed = float((points[0] - points[-1]) @ aside[-1])
    edges = end - start
    share = np.einsum("ij,ij->i", points[1:] - start, edges) / np.einsum("ij,ij->i", edges, edges)
    share += missed * np.linspace(0.0, 1.0, len(points))[1:] / np.einsum("ij,ij->i", edges, aside)
    share = np.clip(share, EDGE_MARGIN, 1.0 - EDGE_MARGIN)[:, None]
    return Traced(np.vstack([points[:1], (1.0 - share) * start + share * end, points[:1]]), faces)


@kernel(inner=True)
def _direction(a: float, b: float, c: float, kind: int, family: int, x: float, y: float) -> tuple[float, float]:
    """Return the direction of a kind for the form [[a, b], [b, c]], oriented like (x, y); (0, 0) if there is none.

    For a first direction (x, y) is (0, 0), and the family decides.
    """
    half, difference = 0.5 * (a + c), 0.5 * (a - c)
    spread = math.hypot(difference, b)
    largest = 0.5 * math.atan2(b, difference)
    first = x == 0.0 and y == 0.0
    if kind == ASYMPTOTIC:
        if spread == 0.0 or abs(half) > spread:
            return 0.0, 0.0
        angle = largest + (0.5 if family == 0 else -0.5) * math.acos(-half / spread)
    elif kind == RULING:
        if spread == 0.0:
            return 0.0, 0.0
        # If the mean is positive, the smaller curvature is nearest to 0.
        angle = largest + (0.5 * math.pi if (half > 0.0) == (family == 0) else 0.0)
    else:
        if spread <= 1e-9 * abs(half) or spread == 0.0:
            return x, y
        angle = largest + (0.0 if family == 0 else 0.5 * math.pi)
        if not first and abs(math.cos(angle) * x + math.sin(angle) * y) < abs(-math.sin(angle) * x + math.cos(angle) * y):
            angle += 0.5 * math.pi
    u, v = math.cos(angle), math.sin(angle)
    if u * x + v * y < 0.0:
        return -u, -v
    return u, v


@kernel(inner=True)
def _field_at(
    corners: FloatArray, forms: FloatArray, u: float, v: float, kind: int, family: int, x: float, y: float
) -> tuple[float, float]:
    """Return the direction at (u, v) in a face with corners (3, 2) and forms (3, 3) at these."""
    x0, y0 = corners[0]
    x1, y1 = corners[1, 0] - x0, corners[1, 1] - y0
    x2, y2 = corners[2, 0] - x0, corners[2, 1] - y0
    area = x1 * y2 - y1 * x2
    s = ((u - x0) * y2 - (v - y0) * x2) / area
    t = (x1 * (v - y0) - y1 * (u - x0)) / area
    r = 1.0 - s - t
    a = r * forms[0, 0] + s * forms[1, 0] + t * forms[2, 0]
    b = r * forms[0, 1] + s * forms[1, 1] + t * forms[2, 1]
    c = r * forms[0, 2] + s * forms[1, 2] + t * forms[2, 2]
    return _direction(a, b, c, kind, family, x, y)


@kernel(inner=True)
def _exit(corners: FloatArray, u: float, v: float, x: float, y: float, entry: int) -> tuple[int, float, float]:
    """Return the side through which a ray leaves a face (-1 for none), the length to it, and the position on the side."""
    best, far, share = -1, np.inf, 0.0
    for c in range(3):
        if c == entry:
            continue
        px, py = corners[c]
        ex, ey = corners[(c + 1) % 3, 0] - px, corners[(c + 1) % 3, 1] - py
        # Faces are counterclockwise: a ray leaves through a side that it crosses from left to right.
        across = x * ey - y * ex
        if across <= 0.0:
            continue
        length = ((px - u) * ey - (py - v) * ex) / across
        if length < far:
            best, far = c, max(length, 0.0)
            share = ((u + far * x - px) * ex + (v + far * y - py) * ey) / (ex * ex + ey * ey)
    return best, far, share


@kernel()
def _half(
    V: Vertices,
    F: Faces,
    mate: IntArray,
    axes: FloatArray,
    S: FloatArray,
    kind: int,
    family: int,
    face: int,
    point: FloatArray,
    sign: float,
    most: int,
    edge: float,
) -> tuple[FloatArray, IntArray, int, bool]:
    points, faces = np.empty((most, 3)), np.empty(most, np.int64)
    passed = np.zeros(F.shape[0], np.int8)
    corners, forms = np.empty((3, 2)), np.empty((3, 3))
    points[0] = point
    count, f, entry = 1, face, -1
    run, last, closed, d = 0.0, np.inf, False, np.zeros(3)
    while count < most and passed[f] < MAX_PASSES:
        if run > MIN_RUN * edge > 0.0:
            now = float(np.linalg.norm(points[count - 1] - point))
            closed = f == face and now < edge
            if closed or (last < CLOSING_DISTANCE * edge and now > last):
                break
            last = now
        passed[f] += 1
        e1, e2 = axes[f, 0], axes[f, 1]
        origin = V[F[f, 0]]
        for c in range(3):
            i = F[f, c]
            delta = V[i] - origin
            corners[c, 0], corners[c, 1] = np.dot(delta, e1), np.dot(delta, e2)
            forms[c, 0] = np.dot(e1, S[i] @ e1)
            forms[c, 1] = np.dot(e1, S[i] @ e2)
            forms[c, 2] = np.dot(e2, S[i] @ e2)
        delta = points[count - 1] - origin
        u, v = np.dot(delta, e1), np.dot(delta, e2)
        bx, by = np.dot(d, e1), np.dot(d, e2)
        x, y = _field_at(corners, forms, u, v, kind, family, bx, by)
        if not (x * x + y * y > 0.0):
            break
        if count == 1:
            x, y = sign * x, sign * y
        side, far, share = _exit(corners, u, v, x, y, entry)
        if side < 0:
            # The field leads back across the entry side: continue straight on.
            length = math.hypot(bx, by)
            if length == 0.0:
                break
            x, y = bx / length, by / length
            side, far, share = _exit(corners, u, v, x, y, entry)
            if side < 0:
                break
        # Midpoint rule, second order.
        mx, my = _field_at(corners, forms, u + 0.5 * far * x, v + 0.5 * far * y, kind, family, x, y)
        if mx * mx + my * my > 0.0:
            again, reach, part = _exit(corners, u, v, mx, my, entry)
            if again >= 0:
                x, y, side, far, share = mx, my, again, reach, part
        share = min(max(share, EDGE_MARGIN), 1.0 - EDGE_MARGIN)
        start, end = V[F[f, side]], V[F[f, (side + 1) % 3]]
        points[count] = (1.0 - share) * start + share * end
        faces[count - 1] = f
        count += 1
        run += far
        d = x * e1 + y * e2
        other = mate[f, side]
        if other < 0:
            break
        f, entry = other // 3, other % 3
    return points, faces, count, closed
