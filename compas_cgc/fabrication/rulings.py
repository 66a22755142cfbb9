"""Rulings of unrolled pieces: their lines on the sheets and their straightness."""

from __future__ import annotations

from typing import NamedTuple
from typing import Optional

import numpy as np

from ..discrete.arrays import FloatArray
from ..errors import CGCError
from ..model.problem import CGCProblem
from .curves import CurveNet
from .curves import curve_net
from .curves.net import DEFAULT_SPACING
from .curves.net import check_spacing
from .curves.net import region_size
from .patchwork import Patchwork
from .patchwork import pairs_of_equal
from .patchwork import weights_in
from .shape_operators import shape_operators

__all__ = ["MAX_BOW", "Ruling", "Straightness", "rulings_of"]

MAX_BOW = 0.02  # bow over chord up to which a curve is drawn as a ruling


class Ruling(NamedTuple):
    """A ruling on a piece."""

    piece: int
    points: FloatArray  # (k, 2) points on the sheet [L]
    bending: float  # curvature across its middle, positive if the piece bends away from its outside [1/L]


class Straightness(NamedTuple):
    """Bow of the rulings of a region, relative to their chords."""

    median: float
    largest: float


def rulings_of(
    problem: CGCProblem, patchwork: Patchwork, regions: list[int], spacing: Optional[float], widest: float
) -> tuple[list[Ruling], dict[int, Straightness]]:
    """Return the rulings of unrolled regions, and their straightness by region.

    A flat region has neither, and one whose rulings are mostly not straight has no rulings.

    The default spacing is that of a net, but at most `widest` [L].
    """
    rulings: list[Ruling] = []
    straightness = {}
    for region in regions:
        size = region_size(problem, region)
        if spacing is not None and size > 0.0:
            check_spacing(size, spacing, region)
        try:
            net = curve_net(problem, spacing or min(widest, size * DEFAULT_SPACING), regions=[region], rough=True)
        except CGCError:
            continue  # Flat, or too coarse for curvatures.
        off = np.array([curve.straightness for curve in net.curves])
        straightness[region] = Straightness(float(np.median(off)), float(off.max()))
        if straightness[region].median > MAX_BOW:
            continue  # It is folded instead of rolled.
        operators = shape_operators(problem.vertices, problem.faces[problem.regions() == region]).operators
        rulings += _on_pieces(patchwork, net, np.trace(operators, axis1=1, axis2=2))
    return rulings, straightness


def _on_pieces(own: Patchwork, net: CurveNet, bending: FloatArray) -> list[Ruling]:
    """Return the straight curves on the sheets, cut at the boundaries of pieces.

    Parameters
    ----------
    own, net
        The pieces and the curves.
    bending
        (n,) sum of the principal curvatures at mesh vertices, which is the curvature across rulings [1/L].
    """
    curves = [curve for curve in net.curves if curve.straightness <= MAX_BOW]
    if not curves:
        return []
    start = np.vstack([curve.points[:-1] for curve in curves])
    end = np.vstack([curve.points[1:] for curve in curves])
    number = np.repeat(np.arange(len(curves)), [len(curve.faces) for curve in curves])
    _, segment, face = pairs_of_equal(np.concatenate([curve.faces for curve in curves]), own.parent)
    corners = own.space[own.faces[face]]
    a, b = weights_in(corners, start[segment]), weights_in(corners, end[segment])
    low, high = _clipped(a, b)
    kept = high - low > 1e-9
    segment, face, a, b, low, high = segment[kept], face[kept], a[kept], b[kept], low[kept], high[kept]
    order = np.lexsort((low, segment))
    segment, face = segment[order], face[order]
    begin, finish = (((1 - t)[:, None] * a + t[:, None] * b)[order] for t in (low, high))
    middle = np.einsum("kc,kcj->kj", 0.5 * (begin + finish), own.space[own.faces[face]])
    whole = net.problem.faces[own.parent[face]]
    across = np.einsum("kc,kc->k", weights_in(net.problem.vertices[whole], middle), bending[whole])
    places = [np.einsum("kc,kcj->kj", weights, own.plane[face]) for weights in (begin, finish)]
    piece = own.piece[face]
    broken = np.ones(len(face), bool)
    near = np.linalg.norm(places[0][1:] - places[1][:-1], axis=1) < 1e-9 * own.size()
    broken[1:] = (number[segment[1:]] != number[segment[:-1]]) | (piece[1:] != piece[:-1]) | ~near
    rulings = []
    for part in np.split(np.arange(len(face)), np.flatnonzero(broken)[1:]):
        if len(part):
            points = np.vstack([places[0][part], places[1][part[-1:]]])
            rulings.append(Ruling(int(piece[part[0]]), points, float(across[part[len(part) // 2]])))
    return rulings


def _clipped(a: FloatArray, b: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return the parameter intervals of segments from weights a to b (k, 3) within their triangles."""
    slope = b - a
    with np.errstate(divide="ignore", invalid="ignore"):
        at = -a / slope
    enter = np.where(slope > 0, at, np.where((slope == 0) & (a < 0), np.inf, 0.0))
    leave = np.where(slope < 0, at, 1.0)
    return np.clip(enter.max(axis=1), 0.0, None), np.clip(leave.min(axis=1), None, 1.0)
