"""Moulds with one principal curvature larger than the other: spindles, bulges and hyperboloids about their equator or throat."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from ..discrete.arrays import FloatArray
from ..discrete.arrays import Vertices
from .revolution import Revolution

__all__ = ["RevolvedMould", "closest_sizes", "size_range"]

MAX_SLOPE = 0.95  # of the radius along the meridian at the edge of a cap; at 1 the surface ends with unbounded curvature
SIZES = np.geomspace(0.05, 20.0, 4001)  # of radii that are compared, relative to the radius of curvature
NEWTON_STEPS = 12
REFINED = 0.3  # logarithm of the factor on a radius within which it is refined


class RevolvedMould(NamedTuple):
    """A surface of revolution of constant K other than 0, with the pole on its equator (K > 0) or throat (K < 0).

    The pole lies at the origin, the axis of revolution runs along x and the normal at the pole along z. There the principal curvatures
    are ``1 / size`` along y and ``K size`` along x, and stationary along the meridian.
    """

    K: float  # [1/L^2]
    size: float  # radius of the equator or throat [L]

    @property
    def revolution(self) -> Revolution:
        """Meridian of the surface, whose arc length is 0 at the pole."""
        return Revolution(self.K, self.size, 0.0)

    @property
    def kind(self) -> str:
        """Type of the surface: sphere, spindle, bulge or hyperboloid."""
        return self.revolution.kind

    @property
    def isotropic(self) -> bool:
        """Whether panels fit alike after every rotation about the pole."""
        return False

    def coordinates(self, points: FloatArray) -> FloatArray:
        """Return the arc lengths along meridians and the angles about the axis of points (n, 3) of the space form (n, 2) [L, rad]."""
        root = math.sqrt(abs(self.K))
        along, beside = root * points[:, 1], root * points[:, 2]
        if self.K > 0.0:
            return np.column_stack([np.arcsin(np.clip(along, -1.0, 1.0)), np.arctan2(beside, points[:, 0]) / self.size]) / root
        return np.column_stack([np.arcsinh(along), np.arctanh(beside / points[:, 0]) / self.size]) / root

    def places(self, points: FloatArray) -> Vertices:
        """Return points (n, 3) of the space form as coordinates in space (n, 3) [L]."""
        s, angle = self.coordinates(points).T
        radii = self.revolution.radii(s)
        return np.column_stack([self.revolution.heights_at(s), radii * np.sin(angle), radii * np.cos(angle) - self.size])

    def second_forms(self, corners: FloatArray, first: FloatArray) -> FloatArray:
        """Return the second fundamental forms at the corners of triangles, as :meth:`Surface.second_forms` does (m, 3, 2, 2) [L]."""
        points = corners.reshape(-1, 3)
        s, angle = self.coordinates(points).T
        slope = self.revolution.slopes(s)
        with np.errstate(invalid="ignore"):  # beyond the edge of the surface
            upright = np.sqrt(1.0 - slope**2)
        bend = upright / self.revolution.radii(s)
        around = np.column_stack([np.zeros(len(s)), np.cos(angle), -np.sin(angle)])
        up = np.column_stack([upright, slope * np.sin(angle), slope * np.cos(angle)])
        places = self.places(points).reshape(-1, 3, 3)
        edges = (places[:, 1:] - places[:, :1])[:, None]
        along, across = (np.einsum("fcek,fck->fce", np.repeat(edges, 3, axis=1), way.reshape(-1, 3, 3)) for way in (around, up))
        bend = bend.reshape(-1, 3)[:, :, None, None]
        return bend * along[..., :, None] * along[..., None, :] + self.K / bend * across[..., :, None] * across[..., None, :]

    def arc_lengths(self, heights: FloatArray) -> FloatArray:
        """Return the arc lengths along the meridian at heights along the axis (n,) [L]."""
        s = np.array(heights, dtype=np.float64)
        for _ in range(NEWTON_STEPS):
            slope = np.clip(self.revolution.slopes(s), -MAX_SLOPE, MAX_SLOPE)
            s -= (self.revolution.heights_at(s) - heights) / np.sqrt(1.0 - slope**2)
        return s


def closest_sizes(K: float, radius: float, principal: Sequence[FloatArray]) -> list[float]:
    """Return the radii of the equators or throats on which panels bend least, by their mean principal curvatures, the best first.

    For K > 0 there are two: a spindle and a bulge can have the same principal curvatures at their poles.

    Parameters
    ----------
    K
        Gaussian curvature of the moulds [1/L^2].
    radius
        Geodesic radius of the cap that a mould must hold [L].
    principal
        Mean principal curvatures of every panel, the larger first (2,) [1/L].
    """
    root = math.sqrt(abs(K))
    low, high = _limits(K, radius)
    sizes = SIZES[(SIZES >= low) & (SIZES <= high)]
    if not len(sizes):
        return []
    own = np.sort(np.column_stack([root / sizes, K / root * sizes]), axis=1)[:, ::-1]
    misses = np.square(own[:, None] - np.array(principal)).sum(axis=(1, 2))
    sides = (sizes <= 1.0, sizes >= 1.0) if K > 0.0 else (np.ones(len(sizes), bool),)
    best = [np.flatnonzero(side)[np.argmin(misses[side])] for side in sides if side.any()]
    return [float(sizes[k]) / root for k in sorted(best, key=lambda k: misses[k])]


def size_range(K: float, radius: float, size: float) -> tuple[float, float]:
    """Return the logarithms of the factors on a radius between which it is refined, so that a mould holds a cap of a geodesic radius."""
    low, high = _limits(K, radius)
    unit = size * math.sqrt(abs(K))
    return max(-REFINED, math.log(low / unit)), min(REFINED, math.log(high / unit))


def _limits(K: float, radius: float) -> tuple[float, float]:
    """Return the least and the largest radius of moulds that hold a cap of a geodesic radius [L], relative to the radius of curvature."""
    reach = math.sqrt(abs(K)) * radius
    return reach / math.pi, MAX_SLOPE / (math.sin(min(reach, 0.5 * math.pi)) if K > 0.0 else math.sinh(reach))
