"""Thin plates on surfaces of revolution of constant K, bent a little to neighbouring ones without stretching, in CalculiX."""

from __future__ import annotations

import re
import subprocess
from pathlib import Path
from typing import NamedTuple

import numpy as np

LAYERS = 2  # of elements through the thickness; nodes lie on five levels, of which the middle one is moved
CORNERS = ((0, 0), (1, 0), (1, 1), (0, 1))
# Components of a stress in the order of CalculiX.
AXES = ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2))


class Revolved(NamedTuple):
    """Surface with rings of radius b cos(k s) or b cosh(k s) at distance s from its waist, along the x axis."""

    K: float
    waist: float  # b

    def radius(self, s):
        k = np.sqrt(abs(self.K))
        return self.waist * (np.cos(k * s) if self.K > 0 else np.cosh(k * s))

    def slope(self, s):
        k = np.sqrt(abs(self.K))
        return self.waist * k * (-np.sin(k * s) if self.K > 0 else np.sinh(k * s))

    def place(self, s, arc):
        """Return the point at distance s from the waist, and at an arc length along the waist."""
        nodes, weights = np.polynomial.legendre.leggauss(12)
        x = 0.5 * s * (weights @ np.sqrt(1.0 - self.slope(0.5 * s * (nodes + 1.0)) ** 2))
        return np.array([x, self.radius(s) * np.sin(arc / self.waist), self.radius(s) * np.cos(arc / self.waist) - self.waist])

    def normal(self, s, arc):
        """Return the outer unit normal."""
        ahead = np.sqrt(1.0 - self.slope(s) ** 2)
        return np.array([-self.slope(s), ahead * np.sin(arc / self.waist), ahead * np.cos(arc / self.waist)])

    def curvatures(self, s):
        """Return the curvatures along the meridian and across it."""
        across = np.sqrt(1.0 - self.slope(s) ** 2) / self.radius(s)
        return np.array([self.K / across, across])


def bending_stresses(folder: Path, here: Revolved, there: Revolved, modulus, poisson, thickness, n=8, half=0.75):
    """Return the distances from the waist (e,) of the elements of a square plate, and their bending stress (e, 3, 3).

    The isometry keeps distances from the waist and arc lengths along it. All nodes of the middle level are moved; the other ones are free.
    """
    grid = np.linspace(-half, half, 2 * n + 1)
    number, points, moves = {}, [], []
    for i, s in enumerate(grid):
        for j, arc in enumerate(grid):
            for level in range(2 * LAYERS + 1):
                if (i % 2) + (j % 2) + (level % 2) > 1 and not (level == LAYERS and (i % 2) + (j % 2) < 2):
                    continue
                number[i, j, level] = len(points) + 1
                points.append(here.place(s, arc) + here.normal(s, arc) * thickness * (level / (2 * LAYERS) - 0.5))
                if level == LAYERS:
                    moves.append((len(points), there.place(s, arc) - here.place(s, arc)))
    elements, middles = [], []
    for low in range(0, 2 * LAYERS, 2):
        for i in range(0, 2 * n, 2):
            for j in range(0, 2 * n, 2):
                ends = [(i + 2 * a, j + 2 * b) for a, b in CORNERS]
                sides = [(i + 1, j), (i + 2, j + 1), (i + 1, j + 2), (i, j + 1)]
                own = [(place, level) for places in (ends, sides) for level in (low, low + 2) for place in places]
                own += [(place, low + 1) for place in ends]
                elements.append([number[(*place, level)] for place, level in own])
                middles.append(grid[i + 1])
    # CalculiX reads 20 characters of a number.
    lines = [
        "*NODE, NSET=ALL",
        *(f"{k},{x:.11e},{y:.11e},{z:.11e}" for k, (x, y, z) in enumerate(points, 1)),
        "*ELEMENT, TYPE=C3D20R, ELSET=ALL",
    ]
    for k, own in enumerate(elements, 1):
        lines += [",".join(map(str, [k, *own[:10]])) + ",", ",".join(map(str, own[10:]))]
    lines += ["*MATERIAL, NAME=PLATE", "*ELASTIC", f"{modulus:g},{poisson:g}", "*SOLID SECTION, ELSET=ALL, MATERIAL=PLATE"]
    lines += ["*STEP", "*STATIC", "*BOUNDARY"]
    lines += [f"{k},{axis},{axis},{move[axis - 1]:.11e}" for k, move in moves for axis in (1, 2, 3)]
    (folder / "plate.inp").write_text("\n".join([*lines, "*EL PRINT, ELSET=ALL", "S", "*END STEP", ""]))
    subprocess.run(["ccx", "plate"], cwd=folder, check=True, stdout=subprocess.DEVNULL, timeout=120)
    found = [line.split()[:8] for line in (folder / "plate.dat").read_text().splitlines() if re.match(r"\s+\d+\s+\d+\s", line)]
    tensors = np.empty((len(found), 3, 3))
    for component, (i, j) in enumerate(AXES):
        tensors[:, i, j] = tensors[:, j, i] = [float(row[2 + component]) for row in found]
    # Of eight points in an element, four lie on either side of its middle, at 1 / sqrt(3) of half its height.
    lower, upper = tensors.reshape(LAYERS, -1, 2, 4, 3, 3).mean(axis=3).transpose(0, 2, 1, 3, 4)[:, :, :, :, :]
    bottom = 0.5 * (lower[0] + lower[1]) - 0.5 * np.sqrt(3.0) * (lower[1] - lower[0])
    top = 0.5 * (upper[0] + upper[1]) + 0.5 * np.sqrt(3.0) * (upper[1] - upper[0])
    return np.array(middles[: len(top)]), 0.5 * (top - bottom)
