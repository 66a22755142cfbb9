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


def cone(rows: int, around: int, bottom: float = 3.0, top: float = 1.5, height: float = 3.0):
    """Return a frustum whose quads are flat, so that it unrolls exactly, normals outwards."""
    k, j = (x.ravel() for x in np.meshgrid(np.arange(rows), np.arange(around), indexing="ij"))
    t, turn = k / (rows - 1), 2 * np.pi * j / around
    r = bottom + (top - bottom) * t
    vertices = np.column_stack([r * np.cos(turn), r * np.sin(turn), height * t])
    row = np.arange(rows - 1)[:, None] * around
    a, b = (row + np.arange(around)).ravel(), (row + (np.arange(around) + 1) % around).ravel()
    return vertices, np.column_stack([a, b, a + around, b, b + around, a + around]).reshape(-1, 3)
