"""Surfaces of revolution of constant Gaussian curvature, as functions and as NURBS."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from scipy.interpolate import make_interp_spline

from ..discrete.arrays import FloatArray
from ..discrete.nurbs import NurbsPatch
from ..errors import CGCError

__all__ = ["KINDS", "Revolution", "cosine_and_sine", "revolution"]

EQUAL = 1e-12  # relative difference below which two radii or slopes count as equal
MAX_SPANS = 4096
QUADRATURE = np.polynomial.legendre.leggauss(16)
FINE_QUADRATURE = np.polynomial.legendre.leggauss(32)  # over a whole meridian


class Revolution(NamedTuple):
    """A surface of revolution about z: its radius satisfies ``r'' = -K r`` along the arc length of the meridian.

    Examples
    --------
    >>> Revolution(1.0, 0.8, 0.0).kind, Revolution(-1.0, 1.0, -1.0).kind
    ('spindle', 'pseudosphere')

    References
    ----------
    do Carmo, *Differential Geometry of Curves and Surfaces*, section 3-3, exercise 7.
    """

    K: float  # [1/L^2]
    start: float  # radius where the arc length is 0 [L]
    slope: float  # derivative of the radius there

    @property
    def kind(self) -> str:
        """Type of the surface, one of :data:`KINDS`."""
        unit = self.start * math.sqrt(abs(self.K))
        if self.K == 0.0:
            return "plane" if abs(self.slope) >= 1.0 - EQUAL else "cylinder" if self.slope == 0.0 else "cone"
        if self.K > 0.0:
            total = math.hypot(unit, self.slope)
            return "sphere" if abs(total - 1.0) <= EQUAL else "spindle" if total < 1.0 else "bulge"
        first = self.slope**2 - unit**2
        return "pseudosphere" if abs(first) <= EQUAL * unit**2 else "conic" if first > 0.0 else "hyperboloid"

    def radii(self, s: FloatArray) -> FloatArray:
        """Return the distances from the axis at arc lengths (n,) [L]."""
        c, d = cosine_and_sine(self.K, s)
        return self.start * c + self.slope * d

    def slopes(self, s: FloatArray) -> FloatArray:
        """Return the derivatives of the radii by the arc length (n,), from -1 to 1 on the surface."""
        c, d = cosine_and_sine(self.K, s)
        return self.slope * c - self.K * self.start * d

    def heights(self, s: FloatArray) -> FloatArray:
        """Return the heights along the axis at increasing arc lengths (n,), 0 at the first [L]."""
        x, w = QUADRATURE
        half = 0.5 * np.diff(s)
        places = 0.5 * (s[:-1] + s[1:])[:, None] + half[:, None] * x
        upright = self._uprights(places.ravel()).reshape(places.shape)
        return np.concatenate([[0.0], np.cumsum(half * (upright @ w))])

    def heights_at(self, s: FloatArray) -> FloatArray:
        """Return the heights along the axis at arc lengths (n,), 0 at arc length 0 [L]; NaN where the surface has ended."""
        x, w = FINE_QUADRATURE
        with np.errstate(invalid="ignore"):
            upright = np.sqrt(1.0 - self.slopes((0.5 * s[:, None] * (1.0 + x)).ravel()) ** 2).reshape(len(s), len(x))
        return 0.5 * s * (upright @ w)

    def patch(self, ends: tuple[float, float], angles: tuple[float, float], tolerance: float, offset: float = 0.0) -> NurbsPatch:
        """Return the part of the surface between two arc lengths and two angles; its first end lies at height 0.

        Planes, cylinders, cones and spheres are exact. At a constant distance from the surface lies a surface of revolution, too.

        Parameters
        ----------
        ends
            Arc lengths, increasing [L].
        angles
            Angles about the axis, increasing [rad].
        tolerance
            Largest deviation of the meridian [L].
        offset
            Distance of the returned surface along the normals, which point away from the axis or, where the surface is level, down along
            it [L].

        Raises
        ------
        CGCError
            If the surface does not extend to these arc lengths, or the offset reaches a centre of curvature.
        """
        s = np.linspace(*ends, 65)
        size = max(abs(self.start), ends[1] - ends[0])
        if (np.abs(self.slopes(s)) > 1.0 + EQUAL).any() or (self.radii(s) < -EQUAL * size).any():
            raise CGCError(f"a {self.kind} of K = {self.K:.4g} does not extend from {ends[0]:.4g} to {ends[1]:.4g} along its meridian")
        if offset and not self._may_be_offset(s, offset):
            raise CGCError(f"the radii of curvature of a {self.kind} of K = {self.K:.4g} are smaller than the offset of {abs(offset):.4g}")
        meridian, knots, degree = self._meridian(ends, tolerance, offset)
        circle, around = _circle(*angles)
        r, z, w = meridian.T
        x, y, v = circle.T
        control = np.stack([r[:, None] * x, r[:, None] * y, z[:, None] * v, w[:, None] * v], axis=-1)
        return NurbsPatch(control, (knots, around), (degree, 2))

    def _uprights(self, s: FloatArray) -> FloatArray:
        """Return the derivatives of the heights by the arc length (n,)."""
        return np.sqrt(np.maximum(1.0 - self.slopes(s) ** 2, 0.0))

    def _may_be_offset(self, s: FloatArray, offset: float) -> bool:
        """Check whether an offset keeps clear of the centres of curvature at arc lengths (n,)."""
        r, upright = self.radii(s), self._uprights(s)
        # The principal curvatures are upright / r along parallels and K r / upright along meridians; on a plane all are 0.
        return bool(((r + offset * upright >= 0.0) & (upright + offset * self.K * r >= 0.0)).all())

    def points(self, s: FloatArray, offset: float = 0.0) -> FloatArray:
        """Return the radii and heights (n, 2) at increasing arc lengths, or at a distance along the normals from there [L]."""
        return np.column_stack([self.radii(s) + offset * self._uprights(s), self.heights(s) - offset * self.slopes(s)])

    def _meridian(self, ends: tuple[float, float], tolerance: float, offset: float) -> tuple[FloatArray, FloatArray, int]:
        """Return the control points (k, 3) of a meridian as ``(w r, w z, w)``, its knots and its degree."""
        if self.K == 0.0:
            return np.column_stack([self.points(np.array(ends), offset), np.ones(2)]), np.array([0.0, 0.0, 1.0, 1.0]), 1
        if self.kind == "sphere":
            root = math.sqrt(self.K)
            latitude = [root * s - math.atan2(self.slope, root * self.start) for s in ends]
            control, knots = _circle(*latitude)
            first, radius = control[0, 1] / root, 1.0 / root + offset
            control = control * [radius, radius, 1.0]
            control[:, 1] -= first * control[:, 2]
            return control, knots, 2
        spans = 8
        while True:
            t = np.linspace(*ends, 2 * spans + 1)
            points = self.points(t, offset)
            spline = make_interp_spline(t[::2], points[::2], k=5)
            if np.abs(spline(t) - points).max() <= tolerance:
                return np.column_stack([spline.c, np.ones(len(spline.c))]), spline.t, 5
            if spans >= MAX_SPANS:
                raise CGCError(f"a {self.kind} of K = {self.K:.4g} has unbounded curvature at its rim; use a part farther from it")
            spans *= 2


def cosine_and_sine(K: float, s: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return the solutions of ``f'' = -K f`` at arc lengths (n,): with value 1 and slope 0, and with value 0 and slope 1, at 0."""
    root = math.sqrt(abs(K))
    if K == 0.0:
        return np.ones_like(s), np.asarray(s, float)
    return (np.cos(root * s), np.sin(root * s) / root) if K > 0.0 else (np.cosh(root * s), np.sinh(root * s) / root)


def _circle(first: float, last: float) -> tuple[FloatArray, FloatArray]:
    """Return the control points (k, 3) of an arc of the unit circle as ``(w x, w y, w)``, and its knots in radians."""
    count = max(1, math.ceil((last - first) / (0.5 * math.pi) - EQUAL))
    corners = np.linspace(first, last, 2 * count + 1)
    weights = np.ones(len(corners))
    weights[1::2] = math.cos(0.5 * (last - first) / count)
    # The middle control point of an arc lies at radius 1 / w, so that w times it lies on the unit circle.
    return np.column_stack([np.cos(corners), np.sin(corners), weights]), np.concatenate([[first], np.repeat(corners[::2], 2), [last]])


def _of_slope(K: float, size: float) -> Revolution:
    return Revolution(K, 0.0, size)


# Start of each type for K and its size: the radius at its equator or throat [L], or the sine of half the angle of its tip.
KINDS = {
    "plane": lambda K, size: Revolution(0.0, 0.0, 1.0),
    "cylinder": lambda K, size: Revolution(0.0, size, 0.0),
    "cone": _of_slope,
    "sphere": lambda K, size: Revolution(K, 1.0 / math.sqrt(K), 0.0),
    "spindle": lambda K, size: Revolution(K, size, 0.0),
    "bulge": lambda K, size: Revolution(K, size, 0.0),
    "pseudosphere": lambda K, size: Revolution(K, 1.0 / math.sqrt(-K), -1.0),
    "hyperboloid": lambda K, size: Revolution(K, size, 0.0),
    "conic": _of_slope,
}
_SIGNS = {"plane": 0, "cylinder": 0, "cone": 0, "sphere": 1, "spindle": 1, "bulge": 1}


def revolution(kind: str, K: float = 0.0, size: float = 0.0) -> Revolution:
    """Return a surface of revolution of constant curvature.

    Parameters
    ----------
    kind
        One of :data:`KINDS`.
    K
        Gaussian curvature [1/L^2].
    size
        Radius at the equator of a spindle or bulge, at the throat of a hyperboloid, or of a cylinder [L]; sine of half the angle at the
        tip of a cone or conic surface. Planes, spheres and pseudospheres need none.

    Raises
    ------
    CGCError
        If the type has no surface with this K and size.

    Examples
    --------
    >>> revolution("bulge", 0.01, 12.0).radii(np.array([0.0])).tolist()
    [12.0]
    """
    if kind not in KINDS:
        raise CGCError(f"there is no surface of revolution {kind!r:.40}; types are {', '.join(KINDS)}")
    sign = _SIGNS.get(kind, -1)
    if not math.isfinite(K) or (K > 0.0) - (K < 0.0) != sign:
        raise CGCError(f"a {kind} needs K {('< 0', '= 0', '> 0')[sign + 1]}, not {K:.4g}")
    if kind in ("cone", "conic") and not 0.0 < size < 1.0:
        raise CGCError(f"the sine of half the angle at the tip of a {kind} must be between 0 and 1, not {size:.4g}")
    if kind in ("cylinder", "spindle", "bulge", "hyperboloid") and not 0.0 < size < math.inf:
        raise CGCError(f"the radius of a {kind} must be positive, not {size:.4g}")
    own = KINDS[kind](K, size)
    if own.kind != kind:
        raise CGCError(f"with K = {K:.4g} and radius {size:.4g} the surface is a {own.kind}, not a {kind}: the limit is 1/√K")
    return own
