"""Nets: two families of curves at one spacing, or the rulings of a developable surface."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple
from typing import Optional
from typing import Union

import numpy as np
from numpy.typing import ArrayLike

from ...discrete.arrays import FloatArray
from ...discrete.arrays import IntArray
from ...discrete.arrays import Vectors
from ...errors import CGCError
from ...meshing import vertex_labels
from ...model.problem import CGCProblem
from ...model.problem import PosesProblem
from ..patchwork import pairs_of_equal
from ..shape_operators import shape_operators
from ..solved import solved_problem
from .trace import ASYMPTOTIC
from .trace import CURVATURE
from .trace import RULING
from .trace import DirectionField
from .trace import Traced
from .trace import direction_field
from .trace import trace

__all__ = ["CurveNet", "NetCurve", "curve_net", "plural"]

NAMES = {CURVATURE: "line of curvature", ASYMPTOTIC: "asymptotic curve", RULING: "ruling"}
FLAT = 1e-9  # K against one over the area, below which a region counts as flat
PLANE = 1e-4  # curvature times size, below which a region is a plane
SHORT = 0.05  # of the spacing: curves shorter than this are left out
CROWDED = 0.5  # of the spacing: curves do not come nearer to each other than this
GAP = 0.5  # more than the spacing between two crossings, from which on a curve goes between
ROUND = 1e-3  # difference of the principal curvatures, against their mean, below which a region is a sphere
MOST = 2000  # curves of a region


def plural(kind: str) -> str:
    """Return the name of several curves of a kind.

    Parameters
    ----------
    kind
        Such as ``"ruling"``.

    Returns
    -------
    str
        The name of several.

    Examples
    --------
    >>> plural("ruling")
    'rulings'
    """
    return kind.replace("line ", "lines ") if kind.startswith("line ") else f"{kind}s"


class NetCurve(NamedTuple):
    """A curve to build along.

    Parameters
    ----------
    region
        That it runs in.
    kind
        Line of curvature, asymptotic curve or ruling.
    family
        0 or 1.
    points
        (k, 3) [L].
    faces
        (k-1,) face of every segment.
    length
        [L].
    straightness
        Largest distance from its chord, against the chord.

    Examples
    --------
    >>> import compas_cgc
    >>> from compas_cgc.fabrication import curve_net
    >>> curve = curve_net(compas_cgc.solve(compas_cgc.read(compas_cgc.get("canopy.3dm"))), 2.5).curves[0]
    >>> curve.kind, curve.points.shape[1]
    ('asymptotic curve', 3)
    """

    region: int
    kind: str  # line of curvature, asymptotic curve or ruling
    family: int  # 0 or 1
    points: Vectors  # (k, 3) [L]
    faces: IntArray  # (k-1,) face of every segment
    length: float  # [L]
    straightness: float  # largest distance from its chord, against the chord


@dataclass(frozen=True, eq=False)
class CurveNet:
    """Curves of all regions, and the net that two families make.

    Parameters
    ----------
    problem
        The surface.
    spacing
        Distance asked for [L]; None where points are given.
    curves
        All curves, by region and family.
    nodes
        (k, 3) where curves of two families cross [L].
    sides
        (s, 2) nodes that follow each other along a curve.
    lengths
        (s,) of the sides, along the curve [L].
    notes
        Sentences on regions without curves.

    Examples
    --------
    >>> import compas_cgc
    >>> from compas_cgc.fabrication import curve_net
    >>> net = curve_net(compas_cgc.solve(compas_cgc.read(compas_cgc.get("canopy.3dm"))), 2.5)
    >>> len(net.nodes) > 0
    True
    """

    problem: CGCProblem
    spacing: Optional[float]
    curves: list[NetCurve]
    nodes: Vectors  # (k, 3) where curves of two families cross [L]
    sides: IntArray  # (s, 2) nodes that follow each other along a curve
    lengths: FloatArray  # (s,) of the sides, along the curve [L]
    notes: tuple[str, ...] = ()  # sentences on regions without curves

    def summary(self) -> str:
        """Return the counts, how equal the sides are and how straight rulings are, in lines."""
        lines = []
        for kind in NAMES.values():
            own = [curve for curve in self.curves if curve.kind == kind]
            if own:
                text = f"{len(own)} {plural(kind) if len(own) > 1 else kind}, {sum(curve.length for curve in own):.6g} long together"
                if kind == NAMES[RULING]:
                    bow = np.array([curve.straightness for curve in own])
                    text += f", off their chords by {100 * np.median(bow):.2g} % (median), {100 * bow.max():.2g} % at most"
                lines.append(text)
        # Others cross at one spacing along the first two only.
        if len(self.lengths) and self.spacing and all(curve.kind == NAMES[ASYMPTOTIC] for curve in self.curves):
            low, high = self.lengths.min() / self.spacing, self.lengths.max() / self.spacing
            lines.append(f"{len(self.nodes)} nodes, {len(self.sides)} sides of {low:.4f} to {high:.4f} of the spacing {self.spacing:g}")
        return "\n".join([*lines, *self.notes])

    __str__ = summary


def curve_net(
    surface: PosesProblem,
    spacing: Optional[float] = None,
    *,
    through: Union[str, ArrayLike, None] = None,
    regions: Optional[Sequence[int]] = None,
    rough: bool = False,
) -> CurveNet:
    """Trace the curves that a surface is built along: lines of curvature where K > 0, asymptotic curves where K < 0, rulings where K = 0.

    Asymptotic curves of a surface of constant K < 0 at one spacing cross each other at that spacing (a Chebyshev net), and
    twist by ``sqrt(-K)`` for each length: straight laths, all alike.

    Parameters
    ----------
    surface
        A problem, a mesh, or what has ``to_problem()``, of one target K for each region.
    spacing
        Distance between curves along those that they cross [L]. Default: a twelfth of a region's size. Not used with
        points.
    through
        Points (k, 3) [L] to trace curves of both families through, or ``"supports"``. Default: a net from the middle of
        each region.
    regions
        Which to take. Default: all.
    rough
        Whether a rough surface (see :class:`compas_cgc.analysis.Verdict`) is taken as it is.

    Returns
    -------
    CurveNet

    Raises
    ------
    CGCError
        If the surface is rough, a region has no one target K or no direction of the kind, or the spacing is not positive.

    Examples
    --------
    >>> import compas_cgc
    >>> print(curve_net(compas_cgc.solve(compas_cgc.read(compas_cgc.get("canopy.3dm"))), 2.5).curves[0].kind)
    asymptotic curve
    """
    problem = solved_problem(surface, rough)
    if spacing is not None and not (np.isfinite(spacing) and spacing > 0):
        raise CGCError(f"the spacing must be more than 0, not {spacing:g}")
    targets, label = problem.region_targets(), problem.regions()
    chosen = range(len(targets)) if regions is None else sorted(set(regions))
    if len(targets) == 0 or any(not 0 <= region < len(targets) for region in chosen):
        raise CGCError(f"there is no such region; the mesh has {len(targets)}")
    curves: list[NetCurve] = []
    nodes, sides, lengths = [np.zeros((0, 3))], [np.zeros((0, 2), np.int64)], [np.zeros(0)]
    points = _points(problem, through)
    step = spacing
    empty: list[str] = []
    for region in chosen:
        own = np.flatnonzero(label == region)
        kind = _kind(problem, region, targets[region], own)
        field = _field(problem, region, own)
        size = float(np.linalg.norm(np.ptp(problem.vertices[problem.faces[own]].reshape(-1, 3), axis=0)))
        step = spacing or size / 12.0
        if _is_flat(field, size) or (kind == CURVATURE and _is_round(field)):
            traced: list[list[Traced]] = [[], []]
        elif points is None:
            traced = _grown(field, kind, step, size)
        else:
            traced = _through(field, kind, points, _supports_of(problem, region, through))
        if not any(traced):
            empty.append(f"region {region} has no {NAMES[kind]} to trace{_why(field, kind, size)}")
            continue
        first = sum(map(len, nodes))
        places, pairs, along = _crossings(field, traced)
        nodes.append(places)
        sides.append(pairs + first)
        lengths.append(along)
        curves += [_curve(region, kind, family, curve, own) for family in (0, 1) for curve in traced[family]]
    if not curves:
        raise CGCError("; ".join(empty))
    one = spacing or (step if len(chosen) == 1 else None)
    return CurveNet(problem, one, curves, np.vstack(nodes), np.vstack(sides), np.concatenate(lengths), tuple(empty))


def _kind(problem: CGCProblem, region: int, target: Optional[float], own: IntArray) -> int:
    if target is None:
        raise CGCError(f"region {region} has no one target K, by which curves are chosen; set it and solve first")
    corners = problem.vertices[problem.faces[own]]
    area = 0.5 * np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1).sum()
    if abs(target) * area < FLAT:
        return RULING
    return CURVATURE if target > 0 else ASYMPTOTIC


def _field(problem: CGCProblem, region: int, own: IntArray) -> DirectionField:
    S = shape_operators(problem.vertices, problem.faces[own]).operators
    if not np.isfinite(S[problem.faces[own]]).all():
        raise CGCError(f"region {region} has too few faces to tell its curvatures by; mesh it more finely")
    # Elsewhere nobody looks.
    return direction_field(problem.vertices, problem.faces[own], np.where(np.isfinite(S), S, 0.0))


def _is_flat(field: DirectionField, size: float) -> bool:
    return float(np.abs(field.operators[np.unique(field.faces)]).max()) * size < PLANE


def _why(field: DirectionField, kind: int, size: float) -> str:
    if _is_flat(field, size):
        return ": it is a plane, on which any line will do"
    if kind == CURVATURE and _is_round(field):
        return ": it is a sphere, on which any line will do"
    return "; is it solved, and does a point lie on it?"


def _is_round(field: DirectionField) -> bool:
    S = field.operators[np.unique(field.faces)]
    mean = np.trace(S, axis1=1, axis2=2)
    spread = np.sqrt(np.maximum(2.0 * np.einsum("fij,fij->f", S, S) - mean**2, 0.0))
    return bool(np.median(spread / np.maximum(np.abs(mean), np.finfo(float).tiny)) < ROUND)


def _points(problem: CGCProblem, through: Union[str, ArrayLike, None]) -> Optional[Vectors]:
    if through is None:
        return None
    if isinstance(through, str):
        if through != "supports":
            raise CGCError(f"curves go through points or 'supports', not {through!r}")
        if not len(problem.supports):
            raise CGCError("there are no supports to trace curves from; fix vertices, or give points")
        return problem.vertices[problem.supports]
    points = np.asarray(through, dtype=np.float64)
    if points.ndim != 2 or points.shape[1] != 3 or not len(points) or not np.isfinite(points).all():
        raise CGCError(f"points must be finite and of the shape (k, 3), not {points.shape}")
    return points


def _supports_of(problem: CGCProblem, region: int, through: object) -> Optional[IntArray]:
    """Return the supports in a region where curves start at these, None where they go through points."""
    if not isinstance(through, str):
        return None
    label = problem.regions()
    inside = vertex_labels(len(problem.vertices), problem.faces[label == region], label[label == region]) == region
    return problem.supports[inside[problem.supports]]


# ----------------------------------------------------------------------
# Which curves
# ----------------------------------------------------------------------


def _through(field: DirectionField, kind: int, points: Vectors, supports: Optional[IntArray]) -> list[list[Traced]]:
    """Trace curves through points, or from supports: from a place just inside of them."""
    if supports is not None:
        points = field.vertices[supports]
    centres = field.vertices[field.faces].mean(axis=1)
    used = field.vertices[np.unique(field.faces)]
    traced: list[list[Traced]] = [[], []]
    for point in points:
        near = int(np.argmin(np.linalg.norm(centres - point, axis=1)))
        edge = np.linalg.norm(field.vertices[field.faces[near, 0]] - field.vertices[field.faces[near, 1]])
        if np.linalg.norm(used - point, axis=1).min() > 2.0 * edge:
            continue  # A point of another region.
        face, place = _nearest(field, point)
        for family in (0,) if kind == RULING else (0, 1):
            curve = trace(field, kind, family, face, place)
            if len(curve.points) > 1:
                traced[family].append(curve)
    return traced


def _nearest(field: DirectionField, point: Vectors) -> tuple[int, Vectors]:
    """Return the face nearest to a point, and the place in it, off its edges."""
    corners = field.vertices[field.faces]
    middle = corners.mean(axis=1)
    near = np.argsort(np.linalg.norm(middle - point, axis=1))[:24]
    best = (np.inf, int(near[0]), middle[near[0]])
    for face in near.tolist():
        a, b, c = corners[face]
        system = np.column_stack([b - a, c - a])
        s, t = np.linalg.lstsq(system, point - a, rcond=None)[0]
        weights = np.clip([1.0 - s - t, s, t], 1e-3, None)
        place = weights / weights.sum() @ corners[face]
        away = float(np.linalg.norm(place - point))
        if away < best[0]:
            best = (away, face, place)
    return best[1], best[2]


class _Growth:
    """A net that grows: its curves by family, and where along each it is crossed."""

    def __init__(self, field: DirectionField):
        self.field = field
        self.curves: list[list[Traced]] = [[], []]
        self.crossed: list[list[list[float]]] = [[], []]  # arc lengths, by family and curve

    def add(self, family: int, curve: Traced) -> list[tuple[int, int]]:
        """Add a curve, and return it and those that it crosses by family and number."""
        number = len(self.curves[family])
        touched = [(family, number)]
        own: list[float] = []
        for i, other in enumerate(self.curves[1 - family]):
            meetings = _meetings(self.field, curve, other)
            own += [s for s, _ in meetings]
            self.crossed[1 - family][i] += [t for _, t in meetings]
            if meetings:
                touched.append((1 - family, i))
        self.curves[family].append(curve)
        self.crossed[family].append(own)
        return touched

    def uncrowded(self, family: int, new: Traced, place: Vectors, spacing: float) -> Traced:
        """Return the part of a new curve around its mark up to where it comes near to one that is there, or nothing of it."""
        if len(new.points) < 2:
            return new
        at = _arc_lengths(new)
        mark = float(at[np.argmin(np.linalg.norm(new.points - place, axis=1))])
        low, high = -np.inf, np.inf
        for curve, there in zip(self.curves[1 - family], self.crossed[1 - family]):
            for s, own in _meetings(self.field, curve, new) if there else ():
                if min(abs(s - t) for t in there) < CROWDED * spacing:
                    if abs(own - mark) < 0.1 * spacing:
                        return Traced(new.points[:1], new.faces[:0])
                    low, high = (max(low, own), high) if own < mark else (low, min(high, own))
        kept = np.flatnonzero((at > low) & (at < high))
        return Traced(new.points[kept], new.faces[kept[:-1]])


def _grown(field: DirectionField, kind: int, spacing: float, size: float) -> list[list[Traced]]:
    """Trace a net: two curves through the middle, and from marks along every curve those that it is yet to be crossed by."""
    centres = field.vertices[field.faces].mean(axis=1)
    face = _first_face(field, kind, centres, size)
    growth = _Growth(field)
    # Rulings are marked off along the first curve across them.
    for family in (0, 1):
        curve = trace(field, kind, family, face, centres[face])
        if len(curve.points) < 2:
            return [[], []]
        growth.add(family, curve)
    waiting = [(1, 0)] if kind == RULING else [(0, 0), (1, 0)]
    tried = set()
    while waiting and sum(map(len, growth.curves)) < MOST:
        family, number = waiting.pop(0)
        curve = growth.curves[family][number]
        for mark in _open_marks(curve, growth.crossed[family][number], spacing, kind == CURVATURE):
            key = (family, number, round(mark / spacing, 3))
            if key in tried:
                continue
            tried.add(key)
            start, place = _place(curve, _arc_lengths(curve), mark)
            new = growth.uncrowded(1 - family, trace(field, kind, 1 - family, start, place), place, spacing)
            if _long(new, spacing):
                touched = growth.add(1 - family, new)
                waiting += [] if kind == RULING else [each for each in touched if each not in waiting]
    return [growth.curves[0], []] if kind == RULING else growth.curves


def _first_face(field: DirectionField, kind: int, centres: Vectors, size: float) -> int:
    """Return the face to begin at: in the middle; for lines of curvature that of the half around it with the clearest directions."""
    away = np.linalg.norm(centres - centres.mean(axis=0), axis=1)
    if kind != CURVATURE:
        return int(np.argmin(away))
    S = field.operators[field.faces].mean(axis=1)
    trace_, square = np.trace(S, axis1=1, axis2=2), np.einsum("fij,fij->f", S, S)
    spread = np.maximum(2.0 * square - trace_**2, 0.0)
    return int(np.argmax(np.where(away <= max(0.25 * size, away.min()), spread, -1.0)))


def _long(curve: Traced, spacing: float) -> bool:
    return len(curve.points) > 1 and float(np.linalg.norm(np.diff(curve.points, axis=0), axis=1).sum()) > SHORT * spacing


def _open_marks(curve: Traced, crossed: list[float], spacing: float, between: bool) -> list[float]:
    """Return the multiples of the spacing beyond the outermost crossings of a curve, and in gaps where these are wanted."""
    if not crossed:
        return []
    length = float(_arc_lengths(curve)[-1])
    crossed = sorted(crossed)
    marks = [*np.arange(crossed[-1] + spacing, length, spacing).tolist(), *np.arange(crossed[0] - spacing, 0.0, -spacing).tolist()]
    for s, t in zip(crossed[:-1], crossed[1:]) if between else ():
        count = int((t - s) / spacing + 1.0 - GAP)
        marks += [s + (t - s) * k / (count + 1) for k in range(1, count + 1)]
    return marks


def _arc_lengths(curve: Traced) -> FloatArray:
    return np.r_[0.0, np.cumsum(np.linalg.norm(np.diff(curve.points, axis=0), axis=1))]


def _place(curve: Traced, at: FloatArray, mark: float) -> tuple[int, Vectors]:
    k = int(np.clip(np.searchsorted(at, mark) - 1, 0, len(curve.faces) - 1))
    share = (mark - at[k]) / max(at[k + 1] - at[k], np.finfo(float).tiny)
    return int(curve.faces[k]), (1.0 - share) * curve.points[k] + share * curve.points[k + 1]


# ----------------------------------------------------------------------
# Where they cross
# ----------------------------------------------------------------------


def _meetings(field: DirectionField, one: Traced, other: Traced) -> list[tuple[float, float]]:
    """Return the arc lengths of both curves where they cross."""
    common, first, second = pairs_of_equal(one.faces, other.faces)
    if not len(common):
        return []
    origin, axes = field.vertices[field.faces[common, 0]], field.axes[common]

    def flat(points: Vectors) -> FloatArray:
        return np.einsum("kij,kj->ki", axes, points - origin)

    a, b = flat(one.points[first]), flat(one.points[first + 1])
    c, d = flat(other.points[second]), flat(other.points[second + 1])
    u, v, w = b - a, d - c, c - a
    across = u[:, 0] * v[:, 1] - u[:, 1] * v[:, 0]
    safe = np.where(across == 0.0, 1.0, across)
    s = (w[:, 0] * v[:, 1] - w[:, 1] * v[:, 0]) / safe
    t = (w[:, 0] * u[:, 1] - w[:, 1] * u[:, 0]) / safe
    slack = 1e-9
    met = (across != 0.0) & (s >= -slack) & (s <= 1.0 + slack) & (t >= -slack) & (t <= 1.0 + slack)
    at, there = _arc_lengths(one), _arc_lengths(other)
    found: list[tuple[float, float]] = []
    for k in np.flatnonzero(met).tolist():
        i, j = first[k], second[k]
        place = (float(at[i] + s[k] * (at[i + 1] - at[i])), float(there[j] + t[k] * (there[j + 1] - there[j])))
        # On an edge two pairs of segments meet in one place.
        if not any(abs(place[0] - old[0]) < 1e-6 * at[-1] for old in found):
            found.append(place)
    return found


def _crossings(field: DirectionField, traced: list[list[Traced]]) -> tuple[Vectors, IntArray, FloatArray]:
    """Return the nodes of a net (k, 3), the sides between them (s, 2), and their lengths along the curves (s,)."""
    nodes: list[Vectors] = []
    on_first: dict[int, list[tuple[float, int]]] = {}
    on_second: dict[int, list[tuple[float, int]]] = {}
    for i, one in enumerate(traced[0]):
        for j, other in enumerate(traced[1]):
            for s, t in _meetings(field, one, other):
                number = len(nodes)
                nodes.append(_place(one, _arc_lengths(one), s)[1])
                on_first.setdefault(i, []).append((s, number))
                on_second.setdefault(j, []).append((t, number))
    sides, lengths = [], []
    for marks in [*on_first.values(), *on_second.values()]:
        marks.sort()
        for (s, a), (t, b) in zip(marks[:-1], marks[1:]):
            sides.append((a, b))
            lengths.append(t - s)
    return np.array(nodes).reshape(-1, 3), np.array(sides, dtype=np.int64).reshape(-1, 2), np.array(lengths)


def _curve(region: int, kind: int, family: int, curve: Traced, own: IntArray) -> NetCurve:
    chord = curve.points[-1] - curve.points[0]
    span = float(np.linalg.norm(chord))
    away = curve.points - curve.points[0]
    off = np.linalg.norm(away - np.outer(away @ chord, chord) / max(span**2, np.finfo(float).tiny), axis=1).max()
    length = float(_arc_lengths(curve)[-1])
    return NetCurve(region, NAMES[kind], family, curve.points, own[curve.faces], length, float(off) / max(span, np.finfo(float).tiny))
