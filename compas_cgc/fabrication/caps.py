"""Smallest cap of a space form around points, the size of a mould."""

from __future__ import annotations

import math
from itertools import combinations
from typing import NamedTuple
from typing import Optional

import numpy as np

from ..discrete.arrays import FloatArray
from . import space_form

__all__ = ["Cap", "smallest_cap"]

MAX_EXCHANGES = 200  # far more than needed in practice
SLACK = 1e-12  # relative tolerance of the radius for a point inside


class Cap(NamedTuple):
    """A geodesic disk of a space form."""

    centre: FloatArray  # (3,) point of the space form
    radius: float  # along the surface [L]


def smallest_cap(points: FloatArray, K: float) -> Cap:
    """Return the smallest cap of the space form of curvature K around points (n, 3).

    The cap is determined by two or three points. The farthest point outside replaces one of them until no point is outside
    (simplex method for LP-type problems).

    References
    ----------
    Sharir and Welzl, doi:10.1007/3-540-55210-3_213.
    """
    middle = space_form.midpoint(points, K)
    first = _farthest(points, middle, K)
    basis = [first, _farthest(points, points[first], K)]
    best = _around(points, basis, K)
    for _ in range(MAX_EXCHANGES):
        outside = _farthest(points, best.centre, K)
        if _distance(points[outside], best.centre, K) <= (1.0 + SLACK) * best.radius or outside in basis:
            break
        trial = [*basis, outside]
        caps = [(_around(points, list(few), K), few) for size in (2, 3) for few in combinations(trial, size) if outside in few]
        fits = [(cap, few) for cap, few in caps if _holds(points[trial], cap, K)]
        if not fits:
            break
        best, few = min(fits, key=lambda one: one[0].radius)
        basis = list(few)
    return best


def _around(points: FloatArray, few: list[int], K: float) -> Cap:
    """Return the smallest cap through two or three points, with infinite radius if there is none."""
    corners = points[few]
    if len(few) == 2:
        centre: Optional[FloatArray] = space_form.midpoint(corners, K)
    else:
        centre = _circumcentre(corners, K)
    if centre is None:
        return Cap(corners[0], math.inf)
    return Cap(centre, max(_distance(corner, centre, K) for corner in corners))


def _circumcentre(corners: FloatArray, K: float) -> Optional[FloatArray]:
    lifted = np.column_stack([space_form.heights(corners), corners[:, 1:]])
    normal = np.cross(lifted[1] - lifted[0], lifted[2] - lifted[0])
    square = normal[0] ** 2 + K * (normal[1] ** 2 + normal[2] ** 2)
    if not square > 0.0:
        return None
    return normal / math.copysign(math.sqrt(square), normal[0])


def _distance(one: FloatArray, other: FloatArray, K: float) -> float:
    return float(space_form.geodesics(space_form.chords(one[None], other[None], K), K)[0])


def _farthest(points: FloatArray, centre: FloatArray, K: float) -> int:
    return int(np.argmax(space_form.chords(points, centre[None], K)))


def _holds(points: FloatArray, cap: Cap, K: float) -> bool:
    return bool((space_form.geodesics(space_form.chords(points, cap.centre[None], K), K) <= (1.0 + 1e-9) * cap.radius).all())
