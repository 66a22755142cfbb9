"""Parametric surfaces of rhino3dm: points, normals, kinks, and the parameters of points."""

from __future__ import annotations

from collections.abc import Iterator
from collections.abc import Sequence
from typing import Any
from typing import Optional

import numpy as np
from scipy.optimize import brentq

from ...discrete.arrays import FloatArray
from ...meshing.kinks import sharp_parameters
from ...meshing.polyline import arc_lengths
from ...meshing.polyline import nearest_on_polyline

__all__ = ["ParametricSurface"]

SNAP = 1e-3  # distance within which vertices snap to a kink, relative to the parameter range
GRID = 16  # divisions of a surface for the initial guess of the parameters of a point
MAX_STEPS = 30  # of Newton's method for the parameters
SIDE_DIVISIONS = 512  # of a side of a domain, for the parameters of points along it
SOUTH, EAST, NORTH, WEST = range(4)


class ParametricSurface:
    """A parametric surface with points, normals and parameters of points."""

    def __init__(self, surface: Any):
        self._surface = surface
        self.domain = np.array([[surface.Domain(k).T0, surface.Domain(k).T1] for k in range(2)])
        self._grid: Optional[tuple[FloatArray, FloatArray]] = None
        self._sides = self._natural_sides()
        self.kinks = sharp_parameters(self.at, self.domain, [surface.GetSpanVector(k) for k in range(2)])

    def snapped_to_kinks(self, loops: Sequence[FloatArray], points: Sequence[FloatArray]) -> tuple[list[FloatArray], Sequence[FloatArray]]:
        """Return loops (k, 2) with points close to a kink moved onto it."""
        snapped = [loop.copy() for loop in loops]
        for axis, value in self.kinks:
            for loop in snapped:
                near = np.abs(loop[:, axis] - value) <= SNAP * np.ptp(self.domain[axis])
                loop[near, axis] = value
        return snapped, points

    def at(self, parameters: FloatArray) -> FloatArray:
        """Return the points (k, 3) at parameters (k, 2), which are clipped to the domain."""
        inside = np.clip(parameters, self.domain[:, 0], self.domain[:, 1])
        return np.array([(p.X, p.Y, p.Z) for p in map(self._surface.PointAt, *inside.T.tolist())]).reshape(-1, 3)

    def normal(self, parameters: FloatArray) -> FloatArray:
        """Return the normal (3,) at parameters (2,)."""
        normal = self._surface.NormalAt(*map(float, parameters))
        return np.array([normal.X, normal.Y, normal.Z])

    def crossings(self, line: FloatArray, reach: float) -> list[float]:
        """Return the lengths [L] along an edge (k, 3) at which it crosses the kinks."""
        if not self.kinks:
            return []
        length = arc_lengths(line)
        uv = self.pulled_back(line, reach)
        return [t for axis, value in self.kinks for t in self._meets(line, length, uv, axis, value)]

    def _meets(self, line: FloatArray, length: FloatArray, uv: FloatArray, axis: int, value: float) -> Iterator[float]:
        off = uv[:, axis] - value
        crossed = (off[:-1] < 0) != (off[1:] < 0)
        # An edge along a kink does not cross it.
        crossed &= np.maximum(np.abs(off[:-1]), np.abs(off[1:])) > SNAP * np.ptp(self.domain[axis])
        for i in np.flatnonzero(crossed).tolist():

            def beyond(t: float, i: int = i) -> float:
                share = (t - length[i]) / (length[i + 1] - length[i])
                start = uv[i] + share * (uv[i + 1] - uv[i])
                return float(self._newton(line[i] + share * (line[i + 1] - line[i]), start)[axis]) - value

            low, high = length[i : i + 2].tolist()
            first, last = beyond(low), beyond(high)
            if first * last < 0:
                yield float(brentq(beyond, low, high, xtol=1e-12 * float(length[-1])))
            else:
                yield low if abs(first) < abs(last) else high

    def pulled_back(self, line: FloatArray, reach: float) -> FloatArray:
        """Return the parameters (k, 2) of points along an edge; edges along a side of the domain are mapped onto it."""
        for which, (values, points) in enumerate(self._sides):
            length = arc_lengths(points)
            if length[-1] <= reach:
                continue
            gap, t = nearest_on_polyline(line, points)
            # The polyline of a strongly curved side deviates from it.
            sagitta = 0.5 * np.linalg.norm(points[2:] + points[:-2] - 2 * points[1:-1], axis=1).max()
            if gap.max() > max(reach, sagitta):
                continue
            if np.linalg.norm(points[0] - points[-1]) <= 1e-6 * length[-1]:
                t = np.unwrap(t, period=length[-1])
            rising = t[len(t) // 2] > t[0] if len(t) > 2 else t[-1] > t[0]
            # Loops run anticlockwise, so the direction distinguishes the two sides of a seam.
            if rising != (which in (SOUTH, EAST)):
                continue
            t = t - length[-1] * np.floor((0.5 * (t.min() + t.max())) / length[-1])
            axis = 0 if which in (SOUTH, NORTH) else 1
            uv = np.empty((len(line), 2))
            uv[:, axis] = np.interp(t, length, values)
            uv[:, 1 - axis] = self.domain[1 - axis, 0 if which in (SOUTH, WEST) else 1]
            return uv
        return self._walked(line)

    def _natural_sides(self) -> list[tuple[FloatArray, FloatArray]]:
        """Return the parameters (k,) and points (k, 3) along the sides of the domain: south, east, north, west."""
        sides = []
        for which in (SOUTH, EAST, NORTH, WEST):
            axis = 0 if which in (SOUTH, NORTH) else 1
            values = np.linspace(self.domain[axis, 0], self.domain[axis, 1], SIDE_DIVISIONS + 1)
            uv = np.empty((SIDE_DIVISIONS + 1, 2))
            uv[:, axis], uv[:, 1 - axis] = values, self.domain[1 - axis, 0 if which in (SOUTH, WEST) else 1]
            sides.append((values, self.at(uv)))
        return sides

    def _walked(self, line: FloatArray) -> FloatArray:
        """Return the parameters (k, 2) of points along a curve; each starts from the previous one, from the middle to both ends."""
        uv = np.empty((len(line), 2))
        middle = len(line) // 2
        uv[middle] = self._nearest(line[middle])
        for way in (1, -1):
            step = np.zeros(2)
            for i in range(middle + way, len(line) if way > 0 else -1, way):
                tried = [self._newton(line[i], uv[i - way] + own) for own in (step, np.zeros(2))]
                gaps = [float(np.linalg.norm(self.at(one[None])[0] - line[i])) for one in tried]
                uv[i] = tried[int(np.argmin(gaps))] if gaps[1] < 0.5 * gaps[0] else tried[0]
                step = uv[i] - uv[i - way]
        return uv

    def _nearest(self, point: FloatArray) -> FloatArray:
        if self._grid is None:
            axes = [np.linspace(low, high, GRID + 1) for low, high in self.domain]
            uv = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, 2)
            self._grid = uv, self.at(uv)
        uv, places = self._grid
        starts = uv[np.argsort(np.linalg.norm(places - point, axis=1), kind="stable")[:4]]
        found = [self._newton(point, start) for start in starts]
        return found[int(np.argmin([np.linalg.norm(self.at(one[None])[0] - point) for one in found]))]

    def _newton(self, point: FloatArray, start: FloatArray) -> FloatArray:
        """Return the parameters (2,) of the nearest surface point, by Gauss-Newton with finite differences."""
        low, high = self.domain.T
        h = 1e-6 * (high - low)
        here = np.clip(start, low, high)
        for _ in range(MAX_STEPS):
            around = np.clip(here + np.array([[0, 0], [h[0], 0], [-h[0], 0], [0, h[1]], [0, -h[1]]]), low, high)
            spots = self.at(around)
            off = point - spots[0]
            steps = (around[1] - around[2])[0], (around[3] - around[4])[1]
            tangents = np.column_stack([(spots[1] - spots[2]) / steps[0], (spots[3] - spots[4]) / steps[1]])
            scaled = np.linalg.lstsq(tangents * (high - low), off, rcond=1e-8)[0]
            move = scaled / max(1.0, np.abs(scaled).max() / 0.2) * (high - low)
            before = np.linalg.norm(off)
            for share in (1.0, 0.5, 0.25, 0.1):
                new = np.clip(here + share * move, low, high)
                if np.linalg.norm(point - self.at(new[None])[0]) < before:
                    break
            else:
                break
            moved, here = np.abs(new - here), new
            if (moved <= 1e-10 * (high - low)).all():
                break
        return here
