"""Reentrant corners of supported boundaries, which a smooth surface of K > 0 cannot pass."""

from __future__ import annotations

from typing import NamedTuple
from typing import Optional

import numpy as np

from ..discrete import edge_faces
from ..discrete.arrays import Edges
from ..discrete.arrays import FloatArray
from ..discrete.arrays import IntArray
from ..discrete.plan import cross
from ..errors import Remedy
from ..errors import Sentence
from .laws import types_of
from .problem import CGCProblem
from .roles import FIXED
from .tolerances import DRAWING_ACCURACY

__all__ = ["dividing_creases", "inward_edges"]

# smallest turn to the right, with the surface on the left [rad]; polylines through drawn curves turn by less on straight parts
MIN_TURN = np.radians(2.0)
# smallest turn of a corner between straight parts [rad]; a circle of 18 edges turns by as much at each vertex
MIN_CORNER = np.radians(20.0)
MAX_BEND = np.radians(1.0)  # largest bend within these parts [rad]; drawn lines are straighter
MAX_CORNERS = 64  # sharpest vertices of a region that are checked; bounds the time on edges that turn inwards everywhere
# directions of lines through a vertex, as weights of the two sides that meet there; the bisector first, then quarters
DIRECTIONS = (0.5, 0.25, 0.75)


_Crease = list[list[float]]  # both ends in plan [L]


class _Line(NamedTuple):
    """A straight line in plan through a supported boundary vertex, up to the next supported edges on both sides."""

    vertex: int
    turn: float  # [rad]
    ends: FloatArray  # (2, 3) [L]
    over: float  # height of the vertex over the straight line between the ends [L]


def inward_edges(problem: CGCProblem) -> list[Sentence]:
    """Return a sentence for every region of K > 0 that cannot be smooth at a reentrant corner of its supported boundary.

    The remedy is a crease from every such corner, straight on along one of its sides, so that no region has the corner any more.

    Such a surface is either convex over every line in its plan or concave over every line. A line through a reentrant corner, or
    along a hole, meets supported edges at three points. The middle one must lie higher than the others on all such lines of a
    region, or lower on all of them.
    """
    found = (_of_region(problem, region) for region in range(int(problem.regions().max(initial=-1)) + 1))
    return [said for said in found if said is not None]


def dividing_creases(problem: CGCProblem) -> list[Remedy]:
    """Return the remedy that divides the regions of K > 0 at the reentrant corners of their supported boundaries, if there are any.

    Many of them have no fair surface although those that :func:`inward_edges` names are excluded for certain.
    """
    convex = [region for region, K in enumerate(problem.region_targets()) if K is not None and types_of(np.array(K)) > 0]
    regions = problem.regions()
    return _as_remedies([line for region in convex for line in _dividing(problem, problem.faces[regions == region])])


def _as_remedies(lines: list[_Crease]) -> list[Remedy]:
    return [Remedy("creases", lines)] if lines else []


def _of_region(problem: CGCProblem, region: int) -> Optional[Sentence]:
    faces = problem.faces[problem.regions() == region]
    asked = problem.asked & problem.region_vertices(region)
    if not asked.any() or not (problem.types[asked] > 0).all():
        return None
    size = float(np.linalg.norm(np.ptp(problem.vertices, axis=0)))
    lines = _lines(problem, faces)
    level = next((line for line in lines if abs(line.over) <= DRAWING_ACCURACY * size), None)
    digits = 2 - int(np.floor(np.log10(size))) if size > 0.0 else 0
    over = max(lines, key=lambda line: line.over, default=None)
    under = min(lines, key=lambda line: line.over, default=None)
    mend = Sentence("draw a crease to that corner, round it and free it there, or move it", _as_remedies(_dividing(problem, faces)))
    if level is not None:
        turn, (one, other) = np.degrees(level.turn), (_place(end, digits) for end in level.ends)
        return Sentence(
            f"the supported boundary has a reentrant corner of {turn:.0f} degrees {_at(problem, level.vertex, digits)}, on a straight line "
            f"with the supported edges at {one} and {other}, and a smooth surface of K > 0 is never straight; {{}}"
        ).format(mend)
    if over is None or under is None or not over.over > 0.0 > under.over:
        corner = _straight_corner(problem, faces)
        if corner is None:
            return None
        return Sentence(
            f"the supported boundary has a reentrant corner {_at(problem, corner, digits)} between straight parts, and beyond it a smooth "
            f"surface of K > 0 would have to lie both below and above their plane; {{}}"
        ).format(mend)
    dome, bowl = (_at(problem, line.vertex, digits) for line in (over, under))
    return Sentence(
        f"region {region} has K > 0 and so bulges to one side only, but its supported boundary has a reentrant corner {dome}, "
        f"{over.over:.3g} above the straight line between supported edges (a dome), and one {bowl}, {-under.over:.3g} below it (a bowl); "
        "{}"
    ).format(mend)


def _dividing(problem: CGCProblem, faces: IntArray) -> list[_Crease]:
    """Return lines in plan that divide a region, from every sharp reentrant corner of its supported boundary.

    A line continues one of the two sides there, the one that makes it shorter, up to the boundary.
    """
    V, held = problem.vertices, problem.roles == FIXED
    rim = _rim(V, faces)
    at = _turning(V, held, rim, sides=1)
    if at is None:
        return []
    lines: list[_Crease] = []
    for k in np.flatnonzero(at.turn > MIN_CORNER).tolist():
        corner = V[at.middle[k], :2]
        ways = at.behind[k], -at.ahead[k]
        ends = [end for end in (_met(V, rim, np.ones(len(V), bool), int(at.middle[k]), way) for way in ways) if end is not None]
        if not ends:
            continue
        line = [corner.tolist(), min(ends, key=lambda end: float(np.linalg.norm(end[:2] - corner)))[:2].tolist()]
        # Two corners that face each other have one line.
        if not any(np.allclose(line[::-1], other) for other in lines):
            lines.append(line)
    return lines


def _at(problem: CGCProblem, vertex: int, digits: int) -> str:
    return f"at vertex {problem.names.vertices[vertex]} {_place(problem.vertices[vertex], digits)}"


def _place(point: FloatArray, digits: int) -> str:
    x, y = (round(number, digits) + 0.0 for number in point[:2].tolist())
    return f"({x:g}, {y:g})"


def _rim(V: FloatArray, faces: IntArray) -> Edges:
    """Return the boundary edges of a region with the surface to their left in plan (e, 2), empty if the plan overlaps itself."""
    edges = edge_faces(faces)
    rim: Edges = edges[edges[:, 3] < 0, :2]
    corners = V[faces][:, :, :2]
    up = cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    if not (up > 0.0).all() and not (up < 0.0).all():
        return rim[:0]
    return rim if up[0] > 0.0 else rim[:, ::-1]


def _straight_corner(problem: CGCProblem, faces: IntArray) -> Optional[int]:
    """Return the supported vertex of the sharpest reentrant corner between parts that are straight in space.

    A surface of K > 0 lies to one side of the plane of two straight boundary parts along them, and to the other side beyond a
    reentrant corner.
    """
    V, held = problem.vertices, problem.roles == FIXED
    rim = _rim(V, faces)
    after, before = dict(rim.tolist()), dict(rim[:, ::-1].tolist())
    if len(after) < len(rim):
        return None
    rows = np.array([(before[before[v]], before[v], v, after[v], after[after[v]]) for v in after], dtype=np.int64).reshape(-1, 5)
    rows = rows[held[rows].all(axis=1) & ~np.isin(rows[:, 2], problem.creases)]
    sides = np.diff(V[rows], axis=1)
    turn = -np.arctan2(cross(sides[:, 1, :2], sides[:, 2, :2]), np.einsum("ki,ki->k", sides[:, 1, :2], sides[:, 2, :2]))
    bends = np.linalg.norm(np.cross(sides[:, ::2], sides[:, 1::2]), axis=2)
    straight = bends < MAX_BEND * np.linalg.norm(sides[:, ::2], axis=2) * np.linalg.norm(sides[:, 1::2], axis=2)
    turn = np.where(straight.all(axis=1), turn, 0.0)
    return int(rows[np.argmax(turn), 2]) if turn.max(initial=0.0) > MIN_CORNER else None


class _Turning(NamedTuple):
    """Supported vertices of a boundary beside supported ones, with the surface to the left."""

    middle: IntArray  # (k,) the vertices
    behind: FloatArray  # (k, 2) way from the vertex before [L]
    ahead: FloatArray  # (k, 2) way to the vertex after [L]
    turn: FloatArray  # (k,) turn to the right [rad]


def _turning(V: FloatArray, held: np.ndarray, rim: Edges, sides: int = 2) -> Optional[_Turning]:
    """Return the supported vertices of a boundary with one or two supported neighbours; None if the boundary touches itself."""
    after, before = dict(rim.tolist()), dict(rim[:, ::-1].tolist())
    middle = [v for v in after if held[v] and v in before and int(held[before[v]]) + int(held[after[v]]) >= sides]
    if not len(middle) or len(after) < len(rim):
        return None
    behind = V[middle, :2] - V[[before[v] for v in middle], :2]
    ahead = V[[after[v] for v in middle], :2] - V[middle, :2]
    turn = -np.arctan2(cross(behind, ahead), np.einsum("ij,ij->i", behind, ahead))
    return _Turning(np.array(middle, dtype=np.int64), behind, ahead, turn)


def _lines(problem: CGCProblem, faces: IntArray) -> list[_Line]:
    """Return the lines through the reentrant corners of the supported boundary of a region."""
    V, held = problem.vertices, problem.roles == FIXED
    rim = _rim(V, faces)
    at = _turning(V, held, rim)
    if at is None:
        return []
    middle, behind, ahead, turn = at
    sharpest = np.argsort(-turn, kind="stable")[:MAX_CORNERS]
    found = []
    for k in sharpest[turn[sharpest] > MIN_TURN].tolist():
        one, other = behind[k] / np.linalg.norm(behind[k]), ahead[k] / np.linalg.norm(ahead[k])
        for share in DIRECTIONS:
            along = (1.0 - share) * one + share * other
            ends = [_met(V, rim, held, int(middle[k]), sign * along) for sign in (-1.0, 1.0)]
            if ends[0] is None or ends[1] is None:
                continue
            back, forth = (float(np.linalg.norm(end[:2] - V[middle[k], :2])) for end in ends if end is not None)
            between = (forth * ends[0][2] + back * ends[1][2]) / (back + forth)
            found.append(_Line(int(middle[k]), float(turn[k]), np.array(ends), float(V[middle[k], 2] - between)))
    return found


def _met(V: FloatArray, rim: Edges, held: np.ndarray, vertex: int, along: FloatArray) -> Optional[FloatArray]:
    """Return where a ray in plan from a vertex meets the boundary (3,), None if the boundary is not supported there."""
    own = rim[(rim != vertex).all(axis=1)]
    start, side = V[own[:, 0], :2] - V[vertex, :2], V[own[:, 1], :2] - V[own[:, 0], :2]
    across = cross(np.broadcast_to(along, side.shape), side)
    with np.errstate(divide="ignore", invalid="ignore"):
        far, part = cross(start, side) / across, cross(start, np.broadcast_to(along, start.shape)) / across
    far = np.where((across != 0.0) & (part >= 0.0) & (part <= 1.0) & (far > 0.0), far, np.inf)
    first = int(np.argmin(far)) if len(far) else 0
    if not len(far) or not np.isfinite(far[first]) or not held[own[first]].all():
        return None
    return np.asarray(V[own[first, 0]] + part[first] * (V[own[first, 1]] - V[own[first, 0]]))
