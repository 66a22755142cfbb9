"""Freeform designs: roofs of 40 x 25 m and 6 m height with three soft or seven sharp bumps, and small ones for quick tests."""

from __future__ import annotations

from pathlib import Path
from typing import Callable

import numpy as np

from compas_cgc.rationalisation import SplineSurface

Heights = Callable[[np.ndarray, np.ndarray], np.ndarray]

LENGTH, WIDTH, HEIGHT = 40.0, 25.0, 6.0


def bumpy(kind: str, seed: int) -> Heights:
    """Return the heights of a vault with three soft or seven sharp bumps, some of them hollows."""
    rng = np.random.default_rng(seed)
    count = {"soft": 3, "sharp": 7}[kind]
    centres = rng.uniform([5.0, 5.0], [35.0, 20.0], (count, 2))
    widths = rng.uniform(6.0, 8.0, count) if kind == "soft" else rng.uniform(4.0, 5.0, count)
    sizes = rng.uniform(1.0, 2.0, count) * (1.0 if kind == "soft" else 0.45) * np.where(rng.random(count) < 0.3, -1.0, 1.0)

    def heights(x: np.ndarray, y: np.ndarray) -> np.ndarray:
        vault = 2.7 * (1.0 - ((x - 20.0) / 20.0) ** 2) + 1.8 * (1.0 - ((y - 12.5) / 12.5) ** 2)
        bumps = zip(centres, widths, sizes)
        return vault + sum(size * np.exp(-((x - a) ** 2 + (y - b) ** 2) / (2.0 * width**2)) for (a, b), width, size in bumps)

    grid = heights(*np.meshgrid(np.linspace(0.0, LENGTH, 201), np.linspace(0.0, WIDTH, 126), indexing="ij"))
    low, factor = grid.min(), HEIGHT / np.ptp(grid)
    return lambda x, y: factor * (heights(x, y) - low)


def mesh_over(heights: Heights, length: float = LENGTH, width: float = WIDTH, edge: float = 0.5) -> tuple[np.ndarray, list[list[int]]]:
    """Return the vertices (n, 3) and quads of a surface over a rectangle."""
    nx, ny = round(length / edge), round(width / edge)
    x, y = (each.ravel() for each in np.meshgrid(np.linspace(0, length, nx + 1), np.linspace(0, width, ny + 1), indexing="ij"))
    corner = [i * (ny + 1) + j for i in range(nx) for j in range(ny)]
    return np.column_stack([x, y, heights(x, y)]), [[a, a + ny + 1, a + ny + 2, a + 1] for a in corner]


def quarter_torus(major: float = 8.0, minor: float = 2.0) -> SplineSurface:
    """Return a quarter of a torus: rational, with one parameter closed."""
    corner = np.sqrt(0.5)
    circle = np.array(
        [[1, 0, 1], [1, 1, corner], [0, 1, 1], [-1, 1, corner], [-1, 0, 1], [-1, -1, corner], [0, -1, 1], [1, -1, corner], [1, 0, 1]]
    )
    arc = np.array([[1, 0, 1], [1, 1, corner], [0, 1, 1]])
    control = np.empty((3, 9, 4))
    for i, (x, y, w) in enumerate(arc):
        for j, (p, q, v) in enumerate(circle):
            radius = major + minor * p
            control[i, j] = np.array([radius * x, radius * y, minor * q, 1.0]) * w * v
    full = np.array([0, 0, 0, 1, 1, 2, 2, 3, 3, 4, 4, 4], dtype=float)
    return SplineSurface(control, (np.array([0.0, 0, 0, 1, 1, 1]), full), (2, 2))


def nurbs_file(path: Path, heights: Heights, length: float, width: float) -> None:
    """Write a smooth surface over a rectangle, as a NURBS surface of a .3dm file in metres whose control points have these heights."""
    import rhino3dm

    surface = rhino3dm.NurbsSurface.Create(3, False, 4, 4, 7, 6)
    for knots, count in ((surface.KnotsU, 7), (surface.KnotsV, 6)):
        knots.CreateUniformKnots(1.0)
        assert len(knots) == count + 2
    for i, x in enumerate(np.linspace(0.0, length, 7)):
        for j, y in enumerate(np.linspace(0.0, width, 6)):
            surface.Points[i, j] = rhino3dm.Point4d(x, y, heights(x, y), 1.0)
    model = rhino3dm.File3dm()
    model.Settings.ModelUnitSystem = rhino3dm.UnitSystem.Meters
    model.Objects.AddSurface(surface)
    model.Write(str(path), 7)
