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
from ...errors import names_what_was_meant
from ...meshing import vertex_labels
from ...model.given import checked_number
from ...model.problem import CGCProblem
from ...model.problem import PosesProblem
from ..materials import metres_per_unit
from ..shape_operators import DEGREE
from ..shape_operators import shape_operators
from ..solved import chosen_regions
from ..solved import solved_problem
from .chebyshev import EQUAL
from .chebyshev import chebyshev_net
from .crossings import arc_lengths_of
from .crossings import bow_of
from .crossings import crossings
from .growth import MOST
from .growth import curves_through
from .growth import grown_net
from .trace import ASYMPTOTIC
from .trace import CURVATURE
from .trace import RULING
from .trace import DirectionField
from .trace import Traced
from .trace import direction_field

__all__ = ["CurveNet", "NetCurve", "curve_net", "plural", "usual_spacing"]

NAMES = {CURVATURE: "line of curvature", ASYMPTOTIC: "asymptotic curve", RULING: "ruling"}
SHARE = 1.0 / 12.0  # of a region's size, between curves
STOP = 0.5  # of the spacing, nearer than which lines of curvature do not run beside each other
FLAT = 1e-9  # K against one over the area, below which a region counts as flat
PLAIN = 0.02  # of the largest curvature of a developable region, below which it is plain there and has no rulings
DEGREES = (4, 3, 2)  # of the polynomials that a net of equal sides begins with: rougher meshes want the lower ones
PLANE = 1e-4  # curvature times size, below which a region is a plane
ROUND = 1e-3  # difference of the principal curvatures, against their mean, below which a region is a sphere


@names_what_was_meant()
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
        Sentences on regions without curves, or without a net of equal sides.

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
    notes: tuple[str, ...] = ()  # sentences on regions without curves, or without a net of equal sides

    def summary(self) -> str:
        """Return the counts, how equal the sides are and how straight rulings are, in lines."""
        lines, metres = [], metres_per_unit(self.problem.drawing.units)
        for kind in NAMES.values():
            own = [curve for curve in self.curves if curve.kind == kind]
            if own:
                length = metres * sum(curve.length for curve in own)
                text = f"{len(own)} {plural(kind) if len(own) > 1 else kind}, {length:.6g} m long together"
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


@names_what_was_meant()
def curve_net(
    surface: PosesProblem,
    spacing: Optional[float] = None,
    *,
    through: Union[str, ArrayLike, None] = None,
    regions: Optional[Sequence[int]] = None,
    stop: float = STOP,
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
    stop
        Stop distance, as a part of the spacing: where lines of curvature run together, as towards corners, they end so near to each other.
        0 lets them go on.
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
    if spacing is not None and not (np.isfinite(checked_number(spacing, "spacing")) and spacing > 0):
        raise CGCError(f"the spacing must be more than 0, not {spacing:g}")
    targets, label = problem.region_targets(), problem.regions()
    if not 0.0 <= checked_number(stop, "stop") < 1.0:
        raise CGCError(f"the stop distance is a part of the spacing, from 0 to less than 1, not {stop:g}")
    chosen = chosen_regions(problem, regions)
    curves: list[NetCurve] = []
    nodes, sides, lengths = [np.zeros((0, 3))], [np.zeros((0, 2), np.int64)], [np.zeros(0)]
    points = _points(problem, through)
    step = spacing
    notes: list[str] = []
    for region in chosen:
        own = np.flatnonzero(label == region)
        K = targets[region]
        if K is None:
            raise CGCError(f"region {region} has no one target K, by which curves are chosen; set it and solve first")
        kind = _kind(problem, K, own)
        field = _field(problem, region, own, kind == RULING)
        size = _size(problem, own)
        step = spacing or size * SHARE
        check_spacing(size, step, region)
        equal: Optional[list[list[Traced]]] = None
        if _is_flat(field, size) or (kind == CURVATURE and _is_round(field)):
            traced: list[list[Traced]] = [[], []]
        elif points is None:
            if kind == ASYMPTOTIC:
                equal = _equal_net(problem, region, own, step, K)
            traced = grown_net(field, kind, step, size, stop) if equal is None else equal
        else:
            traced = curves_through(field, kind, points, _supports_of(problem, region, through))
        if not any(traced):
            notes.append(f"region {region} has no {NAMES[kind]} to trace{_why(field, kind, size)}")
            continue
        if kind == ASYMPTOTIC and points is None and equal is None:
            notes.append(
                f"region {region} has no net of equal sides, as around a hole or a point where more than two asymptotic curves meet: "
                "its curves are traced one by one"
            )
        first = sum(map(len, nodes))
        places, pairs, along = crossings(field, traced)
        nodes.append(places)
        sides.append(pairs + first)
        lengths.append(along)
        curves += [_curve(region, kind, family, curve, own) for family in (0, 1) for curve in traced[family]]
    if not curves:
        raise CGCError("; ".join(notes))
    one = None if points is not None else spacing or (step if len(chosen) == 1 else None)
    return CurveNet(problem, one, curves, np.vstack(nodes), np.vstack(sides), np.concatenate(lengths), tuple(notes))


def usual_spacing(problem: CGCProblem, region: int) -> float:
    """Return the distance between the curves of a region where none is asked for: a twelfth of its size [L]."""
    return _size(problem, np.flatnonzero(problem.regions() == region)) * SHARE


def check_spacing(size: float, spacing: float, region: int) -> None:
    """Refuse a spacing [L] at which thousands of curves would come of a region of a size [L].

    Raises
    ------
    CGCError
        With a spacing that will do.
    """
    if size > MOST * spacing:
        raise CGCError(
            f"more than {MOST} curves {spacing:g} apart would come of region {region}; give a spacing of {size / MOST:.2g} or more"
        )


def _size(problem: CGCProblem, faces: IntArray) -> float:
    """Return the diagonal of the box around some faces [L]."""
    return float(np.linalg.norm(np.ptp(problem.vertices[problem.faces[faces]].reshape(-1, 3), axis=0)))


def _kind(problem: CGCProblem, target: float, own: IntArray) -> int:
    corners = problem.vertices[problem.faces[own]]
    area = 0.5 * np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1).sum()
    if abs(target) * area < FLAT:
        return RULING
    return CURVATURE if target > 0 else ASYMPTOTIC


def _equal_net(problem: CGCProblem, region: int, own: IntArray, spacing: float, K: float) -> Optional[list[list[Traced]]]:
    """Return the net of equal sides of a region of K < 0, or None where it has no coordinates for one."""
    best: Optional[tuple[float, list[list[Traced]]]] = None
    for degree in DEGREES:
        found = chebyshev_net(_field(problem, region, own, False, degree), spacing, K)
        if found is not None and (best is None or found[0] < best[0]):
            best = found
        if best is not None and best[0] < EQUAL:
            break
    return None if best is None else best[1]


def _field(problem: CGCProblem, region: int, own: IntArray, ruled: bool, degree: int = DEGREE) -> DirectionField:
    S = shape_operators(problem.vertices, problem.faces[own], degree).operators
    if not np.isfinite(S[problem.faces[own]]).all():
        raise CGCError(f"region {region} has too few faces to tell its curvatures by; mesh it more finely")
    # Elsewhere nobody looks.
    S = np.where(np.isfinite(S), S, 0.0)
    if ruled:
        size = np.linalg.norm(S, axis=(1, 2))
        S[size < PLAIN * size.max()] = 0.0
    return direction_field(problem.vertices, problem.faces[own], S)


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


def _curve(region: int, kind: int, family: int, curve: Traced, own: IntArray) -> NetCurve:
    return NetCurve(region, NAMES[kind], family, curve.points, own[curve.faces], float(arc_lengths_of(curve)[-1]), bow_of(curve.points))
