"""Curve nets: two families of curves at one spacing, or the rulings of a developable surface."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from dataclasses import field as dataclass_field
from typing import NamedTuple
from typing import Optional
from typing import Union

import numpy as np
from numpy.typing import ArrayLike

from ...discrete.arrays import FloatArray
from ...discrete.arrays import IntArray
from ...discrete.arrays import Vectors
from ...discrete.extent import diameter
from ...errors import CGCError
from ...errors import names_what_was_meant
from ...meshing import vertex_labels
from ...model.given import checked_number
from ...model.given import refuse_other_units
from ...model.problem import CGCProblem
from ...model.problem import PosesProblem
from ..figures import two_digits
from ..materials import metres_per_unit
from ..option_values import NET_KINDS
from ..shape_operators import DEGREE
from ..shape_operators import shape_operators
from ..solved import chosen_regions
from ..solved import solved_problem
from .chebyshev import LENGTH_TOLERANCE
from .chebyshev import ChebyshevNet
from .chebyshev import chebyshev_net
from .crossings import arc_lengths_of
from .crossings import bow_of
from .crossings import crossings
from .growth import MAX_CURVES
from .growth import curves_through
from .growth import grown_net
from .k_surface import KSurface
from .trace import ASYMPTOTIC
from .trace import CURVATURE
from .trace import RULING
from .trace import DirectionField
from .trace import Traced
from .trace import direction_field

__all__ = ["CurveNet", "NetCurve", "curve_net", "plural", "region_size"]

KINDS = dict(zip(NET_KINDS, (CURVATURE, ASYMPTOTIC)))
NAMES = {CURVATURE: "line of curvature", ASYMPTOTIC: "asymptotic curve", RULING: "ruling"}
LETTERS = {CURVATURE: "C", ASYMPTOTIC: "L", RULING: "R"}  # first letters of the names of curves; asymptotic curves carry laths
DEFAULT_SPACING = 1.0 / 12.0  # relative to the size of a region
DEFAULT_STOP = 0.5  # least distance of parallel lines of curvature relative to the spacing
FLAT_CURVATURE = 1e-9  # K times area below which a region counts as K = 0
PLANAR_RATIO = 0.02  # curvature relative to the largest below which a developable region is planar, without rulings
DEGREES = (4, 3, 2)  # degrees of the fitted polynomials tried for a net of equal sides; rough meshes need lower ones
PLANE_CURVATURE = 1e-4  # curvature times size below which a region is a plane
UMBILIC_RATIO = 1e-3  # difference of the principal curvatures over their mean below which a region is a sphere


@names_what_was_meant()
def plural(kind: str) -> str:
    """Return the plural of the name of a kind of curves.

    Parameters
    ----------
    kind
        Name such as ``"ruling"``.

    Returns
    -------
    str
        Plural.

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
        Number of the region.
    kind
        Line of curvature, asymptotic curve or ruling.
    family
        0 or 1.
    points
        (k, 3) points [L].
    faces
        (k-1,) face of every segment.
    length
        Length [L].
    straightness
        Largest distance from the chord, relative to the chord.

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
    straightness: float  # largest distance from the chord, relative to the chord


@dataclass(frozen=True, eq=False)
class CurveNet:
    """Curves of all regions, and the net of their crossings.

    Parameters
    ----------
    problem
        The surface.
    spacing
        Prescribed spacing [L]; None if points were given.
    curves
        All curves, by region and family.
    nodes
        (k, 3) crossings of the two families [L].
    sides
        (s, 2) consecutive nodes along curves.
    lengths
        (s,) lengths of the sides along the curves [L].
    notes
        Sentences on regions without curves or without a net of equal sides.
    surfaces
        Surface of constant K nearest to the mesh, on which the nodes lie, by region.

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
    nodes: Vectors  # (k, 3) crossings of the two families [L]
    sides: IntArray  # (s, 2) consecutive nodes along curves
    lengths: FloatArray  # (s,) lengths of the sides along the curves [L]
    notes: tuple[str, ...] = ()  # sentences on regions without curves or without a net of equal sides
    surfaces: dict[int, KSurface] = dataclass_field(default_factory=dict)  # nearest surface of constant K, by region

    @property
    def labels(self) -> list[str]:
        """Names of the curves: L1, L2, ... for asymptotic curves and their laths, C1, ... for lines of curvature, R1, ... for rulings."""
        letters = {name: LETTERS[kind] for kind, name in NAMES.items()}
        counts = dict.fromkeys(letters.values(), 0)
        found = []
        for curve in self.curves:
            counts[letters[curve.kind]] += 1
            found.append(f"{letters[curve.kind]}{counts[letters[curve.kind]]}")
        return found

    def summary(self) -> str:
        """Return lines of text with counts, lengths of sides and straightness of rulings."""
        lines, metres = [], metres_per_unit(self.problem.drawing.units)
        for kind in NAMES.values():
            own = [curve for curve in self.curves if curve.kind == kind]
            if own:
                length = metres * sum(curve.length for curve in own)
                text = f"{len(own)} {plural(kind) if len(own) > 1 else kind}, total length {length:.6g} m"
                if kind == NAMES[RULING]:
                    bow = np.array([curve.straightness for curve in own])
                    text += f", deviating from their chords by {100 * np.median(bow):.2g} % (median), {100 * bow.max():.2g} % at most"
                lines.append(text)
        # Other nets have the spacing along their first two curves only.
        if len(self.lengths) and self.spacing and all(curve.kind == NAMES[ASYMPTOTIC] for curve in self.curves):
            low, high = self.lengths.min() / self.spacing, self.lengths.max() / self.spacing
            lines.append(f"{len(self.nodes)} nodes, {len(self.sides)} sides of {low:.4f} to {high:.4f} times the spacing {self.spacing:g}")
        for region, surface in self.surfaces.items():
            middle, most = (f"{two_digits(1e3 * metres * value)} mm" for value in (float(np.median(surface.off)), float(surface.off.max())))
            lines.append(
                f"region {region}: nodes lie on the surface of constant K nearest to the mesh, whose vertices deviate from it by {middle} "
                f"(median), {most} at most"
            )
        return "\n".join([*lines, *self.notes])

    __str__ = summary


@names_what_was_meant()
def curve_net(
    surface: PosesProblem,
    spacing: Optional[float] = None,
    *,
    through: Union[str, ArrayLike, None] = None,
    regions: Optional[Sequence[int]] = None,
    kind: Optional[str] = None,
    stop: float = DEFAULT_STOP,
    rough: bool = False,
) -> CurveNet:
    """Trace lines of curvature where K > 0, asymptotic curves where K < 0, and rulings where K = 0.

    Asymptotic curves of a surface of constant K < 0 form a net with equal sides (Chebyshev net), and twist by ``sqrt(-K)`` per unit
    length: they can be built from identical straight laths. In regions with another law lines of curvature are traced; on a minimal
    surface they cross the asymptotic curves at 45°.

    Parameters
    ----------
    surface
        Solved result, mesh or problem with one target K or another law per region.
    spacing
        Distance between curves along those that they cross [L]. Default: 1/12 of the size of the region. Ignored with
        `through`.
    through
        ``(k, 3)`` points [L] to trace curves of both families through, or ``"supports"``. Default: a net from the centre of
        each region.
    regions
        Numbers of regions. Default: all.
    kind
        ``"curvature"`` or ``"asymptotic"`` for all of these regions. Default: by their targets and laws.
    stop
        Stop distance relative to the spacing: lines of curvature end where they come nearer to each other, as towards corners.
        0 disables it.
    rough
        Whether to accept a surface with the verdict rough, see :class:`compas_cgc.analysis.Verdict`.

    Returns
    -------
    CurveNet

    Raises
    ------
    CGCError
        If the surface is rough, a region has several targets, no curves exist, or the spacing is not positive.

    Examples
    --------
    >>> import compas_cgc
    >>> print(curve_net(compas_cgc.solve(compas_cgc.read(compas_cgc.get("canopy.3dm"))), 2.5).curves[0].kind)
    asymptotic curve
    """
    problem = solved_problem(surface, rough)
    if spacing is not None and not (np.isfinite(checked_number(spacing, "spacing")) and spacing > 0):
        raise CGCError(f"the spacing must be larger than 0, not {spacing:g}")
    if kind is not None and kind not in KINDS:
        raise CGCError(f"kind must be {' or '.join(KINDS)}, not {kind!r}")
    targets, label = problem.region_targets(), problem.regions()
    if not 0.0 <= checked_number(stop, "stop") < 1.0:
        raise CGCError(f"the stop distance, relative to the spacing, must be at least 0 and less than 1, not {stop:g}")
    chosen = chosen_regions(problem, regions)
    curves: list[NetCurve] = []
    nodes, sides, lengths = [np.zeros((0, 3))], [np.zeros((0, 2), np.int64)], [np.zeros(0)]
    points = _points(problem, through)
    step = spacing
    notes: list[str] = []
    surfaces: dict[int, KSurface] = {}
    for region in chosen:
        own = np.flatnonzero(label == region)
        K = targets[region]
        if K is None and region not in problem.laws:
            raise CGCError(f"region {region} has no single target K, which determines the kind of curves; set one and solve first")
        traced_kind = KINDS[kind] if kind else CURVATURE if K is None else _kind(problem, K, own)
        field = _field(problem, region, own, traced_kind == RULING)
        size = region_size(problem, region)
        step = spacing or size * DEFAULT_SPACING
        refuse_other_units("the spacing", step, size, problem.drawing.units)
        check_spacing(size, step, region)
        equal: Optional[ChebyshevNet] = None
        if _is_flat(field, size) or (traced_kind == CURVATURE and _is_round(field)):
            traced: list[list[Traced]] = [[], []]
        elif points is None:
            if traced_kind == ASYMPTOTIC and K is not None and K < 0.0:
                equal = _equal_net(problem, region, own, step, K)
            traced = grown_net(field, traced_kind, step, size, stop) if equal is None else equal.lines
        else:
            traced = curves_through(field, traced_kind, points, _supports_of(problem, region, through))
        if not any(traced):
            notes.append(f"region {region} has no {plural(NAMES[traced_kind])}{_why(field, traced_kind, size)}")
            continue
        if traced_kind == ASYMPTOTIC and K is not None and K < 0.0 and points is None and equal is None:
            notes.append(
                f"region {region} has no net of equal sides, because of a hole or a point where more than two asymptotic curves meet; "
                "its curves are traced one by one"
            )
        first = sum(map(len, nodes))
        places, pairs, along = crossings(field, traced)
        if equal is not None and equal.surface is not None:
            surfaces[region] = equal.surface
            at = step * np.round(equal.surface.feet(places) / step)
            places, along = equal.surface.values(at), np.abs(at[pairs[:, 0]] - at[pairs[:, 1]]).max(axis=1)
        nodes.append(places)
        sides.append(pairs + first)
        lengths.append(along)
        curves += [_curve(region, traced_kind, family, curve, own) for family in (0, 1) for curve in traced[family]]
    if not curves:
        raise CGCError("; ".join(notes))
    one = None if points is not None else spacing or (step if len(chosen) == 1 else None)
    return CurveNet(problem, one, curves, np.vstack(nodes), np.vstack(sides), np.concatenate(lengths), tuple(notes), surfaces)


def region_size(problem: CGCProblem, region: int) -> float:
    """Return the largest distance between vertices of a region [L]."""
    return diameter(problem.vertices[np.unique(problem.faces[problem.regions() == region])])


def check_spacing(size: float, spacing: float, region: int) -> None:
    """Refuse a spacing that would give a region more than MAX_CURVES curves.

    Raises
    ------
    CGCError
        With a spacing that is large enough.
    """
    if size > MAX_CURVES * spacing:
        raise CGCError(
            f"a spacing of {spacing:g} would give region {region} more than {MAX_CURVES} curves; use {size / MAX_CURVES:.2g} or more"
        )


def _kind(problem: CGCProblem, target: float, own: IntArray) -> int:
    corners = problem.vertices[problem.faces[own]]
    area = 0.5 * np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1).sum()
    if abs(target) * area < FLAT_CURVATURE:
        return RULING
    return CURVATURE if target > 0 else ASYMPTOTIC


def _equal_net(problem: CGCProblem, region: int, own: IntArray, spacing: float, K: float) -> Optional[ChebyshevNet]:
    """Return the net of equal sides of a region of K < 0, None if there is none."""
    best: Optional[ChebyshevNet] = None
    for degree in DEGREES:
        found = chebyshev_net(_field(problem, region, own, False, degree), spacing, K)
        if found is not None and (best is None or found.error < best.error):
            best = found
        if best is not None and (best.error < LENGTH_TOLERANCE or best.surface is not None):
            break
    return best


def _field(problem: CGCProblem, region: int, own: IntArray, ruled: bool, degree: int = DEGREE) -> DirectionField:
    S = shape_operators(problem.vertices, problem.faces[own], degree).operators
    if not np.isfinite(S[problem.faces[own]]).all():
        raise CGCError(f"region {region} has too few faces to compute curvatures; refine its mesh")
    S = np.where(np.isfinite(S), S, 0.0)
    if ruled:
        size = np.linalg.norm(S, axis=(1, 2))
        S[size < PLANAR_RATIO * size.max()] = 0.0
    return direction_field(problem.vertices, problem.faces[own], S)


def _is_flat(field: DirectionField, size: float) -> bool:
    return float(np.abs(field.operators[np.unique(field.faces)]).max()) * size < PLANE_CURVATURE


def _why(field: DirectionField, kind: int, size: float) -> str:
    if _is_flat(field, size):
        return ": it is a plane, so any straight line can be used"
    if kind == CURVATURE and _is_round(field):
        return ": it is a sphere, so any curve can be used"
    S = field.operators[np.unique(field.faces)]
    squares = np.einsum("fij,fij->f", S, S)
    if kind == ASYMPTOTIC and np.median(np.trace(S, axis1=1, axis2=2) ** 2 - (1.0 - PLANAR_RATIO) * squares) > 0.0:
        return ": these need K < 0"
    return "; check that it is solved and that the points lie on it"


def _is_round(field: DirectionField) -> bool:
    S = field.operators[np.unique(field.faces)]
    mean = np.trace(S, axis1=1, axis2=2)
    spread = np.sqrt(np.maximum(2.0 * np.einsum("fij,fij->f", S, S) - mean**2, 0.0))
    return bool(np.median(spread / np.maximum(np.abs(mean), np.finfo(float).tiny)) < UMBILIC_RATIO)


def _points(problem: CGCProblem, through: Union[str, ArrayLike, None]) -> Optional[Vectors]:
    if through is None:
        return None
    if isinstance(through, str):
        if through != "supports":
            raise CGCError(f"through must be points or 'supports', not {through!r}")
        if not len(problem.supports):
            raise CGCError("the surface has no supports to trace curves from; fix vertices, or give points")
        return problem.vertices[problem.supports]
    points = np.asarray(through, dtype=np.float64)
    if points.ndim != 2 or points.shape[1] != 3 or not len(points) or not np.isfinite(points).all():
        raise CGCError(f"points must be finite with shape (k, 3), not {points.shape}")
    return points


def _supports_of(problem: CGCProblem, region: int, through: object) -> Optional[IntArray]:
    """Return the supports in a region if curves start at supports, else None."""
    if not isinstance(through, str):
        return None
    label = problem.regions()
    inside = vertex_labels(len(problem.vertices), problem.faces[label == region], label[label == region]) == region
    return problem.supports[inside[problem.supports]]


def _curve(region: int, kind: int, family: int, curve: Traced, own: IntArray) -> NetCurve:
    return NetCurve(region, NAMES[kind], family, curve.points, own[curve.faces], float(arc_lengths_of(curve)[-1]), bow_of(curve.points))
