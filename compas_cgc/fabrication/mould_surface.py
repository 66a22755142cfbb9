"""Moulds in space: sphere, plane or pseudosphere."""

from __future__ import annotations

import math
from typing import NamedTuple
from typing import Union

import numpy as np

from ..discrete.arrays import Faces
from ..discrete.arrays import FloatArray
from ..discrete.arrays import Vertices
from ..errors import CGCError
from . import space_form
from .revolution import cosine_and_sine
from .revolved_mould import RevolvedMould

__all__ = ["MouldSurface", "Surface", "cap_mesh", "surface_for"]

RIM_MARGIN = 1.001  # factor on the distance from the rim of a pseudosphere, where curvature is unbounded
RINGS, AROUND = 16, 64  # resolution of the mesh of a mould


class Surface(NamedTuple):
    """A surface of constant curvature in space, with the pole at the origin and its normal along z."""

    K: float  # [1/L^2]
    depth: float = 1.0  # depth of the pole below the rim of the pseudosphere, the y of the upper half plane; unused for K >= 0

    @property
    def kind(self) -> str:
        """Type of the surface: sphere, pseudosphere or plane."""
        return "sphere" if self.K > 0.0 else "pseudosphere" if self.K < 0.0 else "plane"

    @property
    def isotropic(self) -> bool:
        """Whether panels fit alike after every rotation about the pole."""
        return self.K >= 0.0

    def places(self, points: FloatArray) -> Vertices:
        """Return points (n, 3) of the space form as coordinates in space (n, 3) [L]."""
        if self.K >= 0.0:
            return space_form.places(points, self.K)
        radius = 1.0 / math.sqrt(-self.K)
        x, y = self._half_plane(points)
        here = _pseudosphere(x, y)
        pole = _pseudosphere(np.zeros(1), np.array([self.depth]))[0]
        return radius * (here - pole) @ self.axes

    @property
    def axes(self) -> FloatArray:
        """Axes of the pseudosphere at its pole as columns: along the meridian, along the parallel and outwards (3, 3)."""
        slope = math.sqrt(1.0 - 1.0 / self.depth**2)
        down = np.array([-1.0 / self.depth, 0.0, slope])
        along = np.array([0.0, -1.0, 0.0])
        return np.array([down, along, np.cross(down, along)]).T

    def principal(self, points: FloatArray) -> FloatArray:
        """Return the principal curvatures at points (n, 3), the larger first (n, 2) [1/L]; positive if convex towards +z."""
        root = math.sqrt(abs(self.K))
        if self.K >= 0.0:
            return np.full((len(points), 2), root)
        bend = np.sqrt(self._half_plane(points)[1] ** 2 - 1.0)
        return root * np.sort(np.column_stack([bend, -1.0 / bend]), axis=1)[:, ::-1]

    def second_forms(self, corners: FloatArray, first: FloatArray) -> FloatArray:
        """Return the second fundamental forms at the corners of triangles, on the two edges from their first corner (m, 3, 2, 2) [L].

        They are positive where the surface is convex.

        Parameters
        ----------
        corners
            (m, 3, 3) points of the space form.
        first
            (m, 2, 2) scalar products of the edges [L^2].
        """
        if self.K >= 0.0:
            return np.repeat(math.sqrt(self.K) * first[:, None], 3, axis=1)
        points = corners.reshape(-1, 3)
        x, y = self._half_plane(points)
        bend, none = np.sqrt(y**2 - 1.0), np.zeros(len(x))
        around = np.column_stack([-np.sin(x), np.cos(x), none]) @ self.axes
        up = np.column_stack([-np.cos(x) / y, -np.sin(x) / y, np.sqrt(1.0 - 1.0 / y**2)]) @ self.axes
        places = self.places(points).reshape(-1, 3, 3)
        edges = (places[:, 1:] - places[:, :1])[:, None]
        along, across = (np.einsum("fcek,fck->fce", np.repeat(edges, 3, axis=1), way.reshape(-1, 3, 3)) for way in (around, up))
        bend = math.sqrt(-self.K) * bend.reshape(-1, 3)[:, :, None, None]
        return bend * along[..., :, None] * along[..., None, :] + self.K / bend * across[..., :, None] * across[..., None, :]

    def _half_plane(self, points: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return coordinates of points in the upper half plane, in which the pseudosphere is ``y >= 1``; y is NaN beyond its edge."""
        root = math.sqrt(-self.K)
        below = points[:, 0] - root * points[:, 1]
        y = self.depth / below
        return -self.depth * root * points[:, 2] / below, np.where(y >= 1.0, y, np.nan)


MouldSurface = Union[Surface, RevolvedMould]


def surface_for(K: float, radius: float) -> Surface:
    """Return the mould that holds a cap of a given radius [L] about its pole.

    Raises
    ------
    CGCError
        If the cap is too large for the sphere or pseudosphere.
    """
    if K >= 0.0:
        if K > 0.0 and radius * math.sqrt(K) > math.pi:
            raise CGCError(f"a panel of radius {radius:.4g} is larger than the whole sphere of K = {K:.4g}; use smaller panels")
        return Surface(K)
    reach = radius * math.sqrt(-K)
    # The pole lies where the principal curvatures are opposite, or deeper if the rim is too near.
    depth = max(math.sqrt(2.0), RIM_MARGIN * math.exp(min(reach, 50.0)))
    if depth * math.sinh(min(reach, 50.0)) > math.pi:
        raise CGCError(f"a panel of radius {radius:.4g} is too large for a pseudosphere of K = {K:.4g}; use smaller panels")
    return Surface(K, depth)


def cap_mesh(surface: MouldSurface, radius: float) -> tuple[Vertices, Faces]:
    """Return the mesh of a cap about the pole of a mould: vertices (n, 3) [L] and faces (m, 3)."""
    ring, k = np.divmod(np.arange(RINGS * AROUND), AROUND)
    distance, angle = radius * (ring + 1) / RINGS, 2 * np.pi * k / AROUND
    up, out = cosine_and_sine(surface.K, distance)
    points = np.vstack([[1.0, 0.0, 0.0], np.column_stack([up, out * np.cos(angle), out * np.sin(angle)])])
    i = np.arange(AROUND)
    fan = np.column_stack([np.zeros(AROUND, np.int64), 1 + i, 1 + (i + 1) % AROUND])
    a = 1 + np.arange((RINGS - 1) * AROUND)
    b = np.where((a - 1) % AROUND == AROUND - 1, a - AROUND + 1, a + 1)
    bands = np.vstack([np.column_stack([a, a + AROUND, b + AROUND]), np.column_stack([a, b + AROUND, b])])
    return surface.places(points), np.vstack([fan, bands])


def _pseudosphere(x: FloatArray, y: FloatArray) -> FloatArray:
    """Return the points (n, 3) of the unit pseudosphere for coordinates in the upper half plane."""
    height = np.arccosh(y) - np.sqrt(1.0 - 1.0 / y**2)
    return np.column_stack([np.cos(x) / y, np.sin(x) / y, height])
