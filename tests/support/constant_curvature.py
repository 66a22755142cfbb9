"""Patches of surfaces of constant K in closed form."""

from __future__ import annotations

import numpy as np
from scipy.integrate import cumulative_trapezoid

from .shapes import grid


def revolved_patch(n: int, K: float, length: float = 8.0, radius: float = 4.0, angle: float = 1.08):
    """Return n by n squares on a surface of revolution about the x axis, of constant K and no sphere (Minding's), normals up."""
    a = np.sqrt(abs(K))
    s = np.linspace(-length / 2, length / 2, n + 1)
    fine = np.linspace(-length / 2, length / 2, 20_001)
    r = radius * (np.cos(a * s) if K > 0 else np.cosh(a * s))
    slope = -radius * a * np.sin(a * fine) if K > 0 else radius * a * np.sinh(a * fine)
    x = np.interp(s, fine, cumulative_trapezoid(np.sqrt(1 - slope**2), fine, initial=0))
    x -= 0.5 * x[-1]
    turn = np.linspace(-angle / 2, angle / 2, n + 1)
    i, j = np.divmod(np.arange((n + 1) ** 2), n + 1)
    return np.column_stack([x[i], r[i] * np.sin(turn[j]), r[i] * np.cos(turn[j])]), grid(n)[1]


def rectangle(length: float, width: float, K: float, n: int = 16, radius: float = 4.0):
    """Return a panel of a surface of revolution of constant K, `n` squares across its width, about its middle parallel, a geodesic."""
    a, rows = np.sqrt(abs(K)), round(n * max(1.0, length / width))
    y = np.linspace(-width / 2, width / 2, n + 1)
    fine = np.linspace(-width / 2, width / 2, 20_001)
    r = radius * (np.cos(a * y) if K > 0 else np.cosh(a * y))
    slope = -radius * a * np.sin(a * fine) if K > 0 else radius * a * np.sinh(a * fine)
    height = np.interp(y, fine, cumulative_trapezoid(np.sqrt(1 - slope**2), fine, initial=0))
    turn = np.linspace(-length / 2, length / 2, rows + 1) / radius
    i, j = np.divmod(np.arange((rows + 1) * (n + 1)), n + 1)
    corner = (np.arange(rows)[:, None] * (n + 1) + np.arange(n)).ravel()
    faces = np.vstack([np.column_stack([corner, corner + n + 1, corner + n + 2]), np.column_stack([corner, corner + n + 2, corner + 1])])
    return np.column_stack([r[j] * np.cos(turn[i]), r[j] * np.sin(turn[i]), height[j]]), faces


def cone(rows: int, around: int, bottom: float = 3.0, top: float = 1.5, height: float = 3.0):
    """Return a frustum whose quads are flat, so that it unrolls exactly, normals outwards."""
    k, j = (x.ravel() for x in np.meshgrid(np.arange(rows), np.arange(around), indexing="ij"))
    t, turn = k / (rows - 1), 2 * np.pi * j / around
    r = bottom + (top - bottom) * t
    vertices = np.column_stack([r * np.cos(turn), r * np.sin(turn), height * t])
    row = np.arange(rows - 1)[:, None] * around
    a, b = (row + np.arange(around)).ravel(), (row + (np.arange(around) + 1) % around).ravel()
    return vertices, np.column_stack([a, b, a + around, b, b + around, a + around]).reshape(-1, 3)
