"""Moulds as exact surfaces, and outlines on them."""

from __future__ import annotations

import math
from typing import NamedTuple
from typing import Optional

import numpy as np
from scipy.interpolate import CubicSpline

from ..discrete.arrays import FloatArray
from ..discrete.arrays import Vertices
from ..discrete.nurbs import NurbsPatch
from ..errors import CGCError
from .mould_surface import MouldSurface
from .revolution import Revolution
from .revolution import cosine_and_sine
from .revolution import revolution
from .revolved_mould import RevolvedMould

__all__ = ["ACCURACY", "Chart", "cap_patch", "cap_rim", "chart_of", "sheet_faces"]

ACCURACY = 1e-8  # deviation of the meridians of pseudospheres relative to the radius of curvature
MAX_ANGLE = 1.4  # largest distance of a point from the pole of a sphere in its chart [rad]
RIM_POINTS = 256
MARGIN = 1e-3  # of a patch beyond the points on it, relative to their extent


class Chart(NamedTuple):
    """Coordinates on a mould around its pole: along the meridian of a surface of revolution, and about its axis."""

    K: float
    origin: FloatArray  # (3,) of the axis, where the height of the meridian is 0 [L]
    axes: FloatArray  # (3, 3) rows: two directions across the axis and along it
    depth: float  # of the pole of a pseudosphere
    revolved: Optional[RevolvedMould] = None  # the mould, if its pole lies on an equator or throat

    def of(self, points: Vertices) -> FloatArray:
        """Return the coordinates (k, 2) of points near the mould (k, 3)."""
        if self.K == 0.0:
            return points[:, :2]
        x, y, z = ((points - self.origin) @ self.axes.T).T
        if self.revolved is not None:
            return np.column_stack([self.revolved.arc_lengths(z), np.arctan2(y, x)])
        around, root = np.arctan2(y, x), math.sqrt(abs(self.K))
        along = np.arctan2(z, np.hypot(x, y)) if self.K > 0.0 else -np.log(root * np.hypot(x, y))
        return np.column_stack([along / root, around])

    @property
    def revolution(self) -> Revolution:
        """The surface of revolution of a mould that is not a plane."""
        if self.revolved is not None:
            return self.revolved.revolution
        return revolution("sphere" if self.K > 0.0 else "pseudosphere", self.K)

    def at(self, places: FloatArray, offset: float = 0.0) -> Vertices:
        """Return the points (k, 3) at coordinates (k, 2), or at a distance above them along the normals [L]."""
        if self.K == 0.0:
            return np.column_stack([places, np.full(len(places), offset)])
        s, around = places.T
        root = math.sqrt(abs(self.K))
        if self.revolved is not None:
            r, z = self.revolved.revolution.radii(s), self.revolved.revolution.heights_at(s)
        elif self.K > 0.0:
            r, z = np.cos(root * s) / root, np.sin(root * s) / root
        else:
            r = np.exp(-root * s) / root
            z = (np.arccosh(np.exp(root * s)) - np.sqrt(1.0 - np.exp(-2.0 * root * s))) / root
        if offset:
            slope = self.revolution.slopes(s)
            r, z = r + offset * np.sqrt(1.0 - slope**2), z - offset * slope
        return np.column_stack([r * np.cos(around), r * np.sin(around), z]) @ self.axes + self.origin

    def patch(self, places: FloatArray, offset: float = 0.0) -> NurbsPatch:
        """Return the part of the mould around coordinates (k, 2), or of the surface at a distance above it along the normals [L]."""
        low, high = places.min(axis=0), places.max(axis=0)
        low, high = low - MARGIN * (high - low), high + MARGIN * (high - low)
        if self.K == 0.0:
            x, y = np.meshgrid([low[0], high[0]], [low[1], high[1]], indexing="ij")
            knots = [np.repeat([first, last], 2) for first, last in zip(low, high)]
            return NurbsPatch(np.stack([x, y, np.full((2, 2), offset), np.ones((2, 2))], axis=-1), (knots[0], knots[1]), (1, 1))
        root = math.sqrt(abs(self.K))
        if self.revolved is None and self.K < 0.0:
            low[0] = max(low[0], 0.5 * places[:, 0].min())
        own = self.revolution
        made = own.patch((float(low[0]), float(high[0])), (float(low[1]), float(high[1])), ACCURACY / root, offset)
        first = self.at(np.array([[low[0], 0.0]]))[0] - own.radii(low[:1])[0] * self.axes[0]
        return made.placed(first, self.axes)

    def curve(self, points: Vertices, count: int) -> Vertices:
        """Return the points of a smooth curve on the mould through points (k, 3), `count` per span."""
        places = self.of(points)
        along = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(points, axis=0), axis=1))])
        t = np.interp(np.arange(count * (len(points) - 1) + 1) / count, np.arange(len(points)), along)
        if len(points) == 2:
            return self.at(places[0] + (t / along[-1])[:, None] * (places[1] - places[0]))
        return self.at(CubicSpline(along, places)(t))


def chart_of(surface: MouldSurface) -> Chart:
    """Return the chart of a mould, whose axis does not pass through the pole."""
    across = np.array([[0.0, 0.0, 1.0], [0.0, 1.0, 0.0], [-1.0, 0.0, 0.0]])
    if isinstance(surface, RevolvedMould):
        return Chart(surface.K, np.array([0.0, 0.0, -surface.size]), across, 1.0, surface)
    if surface.K == 0.0:
        return Chart(0.0, np.zeros(3), np.eye(3), 1.0)
    root = math.sqrt(abs(surface.K))
    if surface.K > 0.0:
        return Chart(surface.K, np.array([0.0, 0.0, -1.0 / root]), across, 1.0)
    own = Chart(surface.K, np.zeros(3), surface.axes, surface.depth)
    return own._replace(origin=-own.at(np.array([[math.log(surface.depth) / root, 0.0]]))[0])


def cap_patch(surface: MouldSurface, radius: float, offset: float = 0.0) -> NurbsPatch:
    """Return the cap of a mould about its pole: the cap itself for planes and spheres, a rectangle around it for other moulds.

    Parameters
    ----------
    surface
        The mould, with its pole at the origin.
    radius
        Geodesic radius of the cap [L].
    offset
        Distance of the returned surface above the mould, along its normals [L].

    Raises
    ------
    CGCError
        If the offset reaches a centre of curvature.
    """
    full = (0.0, 2.0 * math.pi)
    turned = np.diag([1.0, 1.0, -1.0])
    if surface.K == 0.0:
        # The normal of the meridian at the pole points down.
        return Revolution(0.0, 0.0, 1.0).patch((0.0, radius), full, 1.0, -offset)
    if surface.K > 0.0 and surface.isotropic:
        # The meridian begins at the pole.
        return Revolution(surface.K, 0.0, 1.0).patch((0.0, radius), full, 1.0, offset).placed(np.zeros(3), turned)
    chart = chart_of(surface)
    return chart.patch(chart.of(cap_rim(surface, radius)), offset)


def cap_rim(surface: MouldSurface, radius: float, offset: float = 0.0) -> Vertices:
    """Return the closed rim of a cap, or of the surface at a distance above it (k, 3), first point repeated [L]."""
    angle = np.linspace(0.0, 2.0 * math.pi, RIM_POINTS + 1)
    up, out = cosine_and_sine(surface.K, np.full(len(angle), radius))
    rim = surface.places(np.column_stack([up, out * np.cos(angle), out * np.sin(angle)]))
    if not offset:
        return rim
    chart = chart_of(surface)
    return chart.at(chart.of(rim), offset)


def sheet_faces(surface: MouldSurface, radius: float, thickness: float) -> dict[str, float]:
    """Return the offsets from a mould, which is the middle of its sheets, of their lower and upper face, where there is one [L].

    A sheet that is thicker than twice a radius of curvature has no face on the inner side.
    """
    found = {}
    for side, offset in (("lower", -0.5 * thickness), ("upper", 0.5 * thickness)):
        try:
            cap_patch(surface, radius, offset)
        except CGCError:
            continue
        found[side] = offset
    return found
