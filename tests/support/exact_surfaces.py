"""Patches of surfaces with a known law in closed form, on regular and irregular triangles, and distances from them."""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from scipy.integrate import solve_ivp
from scipy.interpolate import CubicSpline
from scipy.spatial import Delaunay

from compas_cgc.model.laws import ConstantMeanCurvature
from compas_cgc.model.laws import Law
from compas_cgc.model.laws import LinearWeingarten
from compas_cgc.model.laws import Minimal

from .shapes import grid


class Surface(NamedTuple):
    """A parametrised surface ``point(u, v)`` over a rectangle, and its law for normals along ``X_u x X_v``."""

    point: Callable[[np.ndarray, np.ndarray], np.ndarray]
    low: tuple[float, float]
    high: tuple[float, float]
    law: Law

    def at(self, uv: np.ndarray) -> np.ndarray:
        return np.column_stack(self.point(uv[:, 0], uv[:, 1]))

    def patch(self, n: int, irregular: bool = False) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Return vertices on the surface, faces and parameters, with n squares along both sides or as many irregular triangles."""
        uv, faces = unit_square(n, irregular)
        uv = self.low + uv * np.subtract(self.high, self.low)
        return self.at(uv), faces, uv

    def distances(self, points: np.ndarray, uv: np.ndarray) -> np.ndarray:
        """Return the distances of points (n, 3) from the surface, by Gauss-Newton from parameters nearby (n, 2)."""
        uv, step = uv.copy(), 1e-5
        for _ in range(20):
            off = points - self.at(uv)
            slopes = np.stack([(self.at(uv + d) - self.at(uv - d)) / (2 * step) for d in step * np.eye(2)], axis=2)
            uv = uv + np.einsum("nij,nj->ni", np.linalg.pinv(slopes), off)
        return np.linalg.norm(points - self.at(uv), axis=1)


def unit_square(n: int, irregular: bool) -> tuple[np.ndarray, np.ndarray]:
    """Return points (k, 2) of the unit square and faces (m, 3)."""
    points, faces = grid(n)
    uv = points[:, :2]
    if not irregular:
        return uv, faces
    inside = np.abs(uv - 0.5).max(axis=1) < 0.5 - 1e-9
    uv[inside] += 0.3 / n * np.random.default_rng(n).uniform(-1, 1, (int(inside.sum()), 2))
    faces = Delaunay(uv).simplices.astype(np.int64)
    a, b = uv[faces[:, 1]] - uv[faces[:, 0]], uv[faces[:, 2]] - uv[faces[:, 0]]
    area = a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]
    faces[area < 0] = faces[area < 0][:, ::-1]
    return uv, faces[np.abs(area) > 1e-9 / n**2]


def revolved(profile: Callable[[np.ndarray], tuple[np.ndarray, np.ndarray]], low, high, law: Law) -> Surface:
    """Return the surface of revolution about the z axis of a profile (radius, height) of u, with the angle v."""

    def point(u, v):
        r, z = profile(u)
        return r * np.cos(v), r * np.sin(v), z

    return Surface(point, low, high, law)


def catenoid() -> Surface:
    return revolved(lambda u: (np.cosh(u), u), (-0.8, 0.0), (0.9, 1.2), Minimal())


def helicoid() -> Surface:
    return Surface(lambda u, v: (u * np.cos(v), u * np.sin(v), 0.7 * v), (0.2, 0.0), (1.2, 1.4), Minimal())


def enneper() -> Surface:
    return Surface(lambda u, v: (u - u**3 / 3 + u * v**2, v - v**3 / 3 + v * u**2, u**2 - v**2), (-0.5, -0.5), (0.5, 0.6), Minimal())


def sphere(radius: float = 1.3) -> Surface:
    # Spherical coordinates about the y axis, so that the patch has no pole; normals outwards.
    def point(u, v):
        return radius * np.sin(u) * np.cos(v), radius * np.sin(v), radius * np.cos(u) * np.cos(v)

    return Surface(point, (-0.6, -0.5), (0.7, 0.6), ConstantMeanCurvature(1.0 / radius))


def cylinder(radius: float = 0.9) -> Surface:
    law = ConstantMeanCurvature(0.5 / radius)
    return Surface(lambda u, v: (radius * np.sin(u), v, radius * np.cos(u)), (-0.7, 0.0), (0.8, 1.2), law)


def delaunay(radius: float, neck: float, high: float) -> Surface:
    """Return a patch of the surface of revolution with 2 H = 1 whose profile starts at a neck or bulge with this radius.

    By arc length s, with the angle p of the tangent against the radius: r' = cos p, z' = sin p and the normal (sin p, -cos p) outwards,
    ``2 H = p' + sin p / r``. `neck` is the tangent's angle at the start.
    """

    def slopes(_, y):
        r, _, p = y
        return [np.cos(p), np.sin(p), 1.0 - np.sin(p) / r]

    found = [
        solve_ivp(slopes, (0.0, end), [radius, 0.0, neck], rtol=1e-12, atol=1e-13, dense_output=True).sol
        for end in (high + 0.5, -high - 0.5)
    ]

    def profile(s):
        r, z, _ = np.where(s >= 0, found[0](np.maximum(s, 0)), found[1](np.minimum(s, 0)))
        return r, z

    # X_u x X_v points inwards for the angle v: it runs backwards.
    def point(u, v):
        r, z = profile(u)
        return r * np.cos(-v), r * np.sin(-v), z

    return Surface(point, (-0.4 * high, 0.0), (high, 1.0), ConstantMeanCurvature(0.5))


def unduloid() -> Surface:
    # r sin p - r² / 2 is constant and positive: at radius .6 with a vertical tangent, .6 - .18 > 0.
    return delaunay(0.6, np.pi / 2, 0.9)


def nodoid() -> Surface:
    # At the bulge of radius 2.5, 2.5 - 3.125 < 0.
    return delaunay(2.5, np.pi / 2, 0.9)


def parallel_of_pseudosphere(distance: float = 0.25) -> Surface:
    """Return a patch of a surface parallel to the pseudosphere, bounded by asymptotic lines of that.

    By u and v the pseudosphere is (sech t cos a, sech t sin a, t - tanh t) with t = u + v, a = u - v: its asymptotic lines are those of
    constant u and v. For normals n with principal curvatures k along -n'', points X + distance n have curvatures k / (1 + distance k).
    """

    def point(u, v):
        t, a = u + v, u - v
        X = np.stack([np.cos(a) / np.cosh(t), np.sin(a) / np.cosh(t), t - np.tanh(t)])
        N = np.stack([np.tanh(t) * np.cos(a), np.tanh(t) * np.sin(a), 1 / np.cosh(t)])
        return tuple(X + distance * N)

    return Surface(point, (0.35, 0.35), (0.85, 0.85), LinearWeingarten(-2.0 * distance, 1.0 + distance**2, -1.0))


def strip_of_parallel_pseudosphere(distance: float = 0.25) -> Surface:
    """Return a patch of the same surface, bounded by lines of curvature t = u + v and a = u - v, which are nowhere characteristic."""

    def point(t, a):
        X = np.stack([np.cos(a) / np.cosh(t), np.sin(a) / np.cosh(t), t - np.tanh(t)])
        N = np.stack([np.tanh(t) * np.cos(a), np.tanh(t) * np.sin(a), 1 / np.cosh(t)])
        return tuple(X + distance * N)

    # X_t x X_a points opposite to X_u x X_v.
    return Surface(point, (0.7, -0.5), (1.7, 0.5), LinearWeingarten(2.0 * distance, 1.0 + distance**2, -1.0))


def parallel_of_spindle(distance: float = 0.3, radius: float = 1.4) -> Surface:
    """Return a patch of a surface parallel to the surface of revolution r = radius cos s of K = 1, by arc length s."""
    fine = np.linspace(-0.7, 0.7, 100_001)
    slope = np.sqrt(1.0 - (radius * np.sin(fine)) ** 2)
    heights = CubicSpline(fine, slope).antiderivative()

    def profile(s):
        # The normal outwards is (z', -r').
        return radius * np.cos(s) + distance * np.sqrt(1 - (radius * np.sin(s)) ** 2), heights(s) + distance * radius * np.sin(s)

    def point(u, v):
        r, z = profile(u)
        return r * np.cos(-v), r * np.sin(-v), z

    # 1 = K of the first surface = K' / (1 - 2 d H' + d² K').
    return Surface(point, (-0.4, 0.0), (0.5, 0.8), LinearWeingarten(2.0 * distance, 1.0 - distance**2, 1.0))


SURFACES = {
    "catenoid": catenoid,
    "helicoid": helicoid,
    "Enneper": enneper,
    "sphere": sphere,
    "cylinder": cylinder,
    "unduloid": unduloid,
    "nodoid": nodoid,
    "parallel of a spindle": parallel_of_spindle,
}
