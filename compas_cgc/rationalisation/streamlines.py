"""Seams at an even spacing: two families of lines of curvature, or of geodesics."""

from __future__ import annotations

from collections.abc import Iterator
from collections.abc import Sequence
from typing import NamedTuple
from typing import Optional

import numpy as np
from scipy.ndimage import gaussian_filter
from scipy.ndimage import map_coordinates
from scipy.spatial import cKDTree

from ..discrete.arrays import FloatArray
from ..discrete.arrays import Mask
from ..errors import MeshError
from .curve_panels import Lengths
from .curve_panels import parameter_rim
from .rims import within_rims
from .spline_surface import SplineSurface

__all__ = ["even_lines"]

STEPS = 10  # of a line along one spacing
NEAREST, TAKEN = 0.5, 0.8  # of the spacing: where a line ends beside another of its family, and where one begins
ALONG_RIM = 0.35  # of the spacing, within which a line that runs along the rim is cut
SLANT = 0.8  # cosine of the angle to the rim from which a line runs along it
SHORTEST = 1.5  # of the spacing, below which a line is left out
UMBILIC = 1e-3  # squared difference of principal curvatures, against the largest curvature, up to which lines go straight on
SMOOTHING = 1.0  # of the spacing, over which crosses of principal directions are averaged
ACROSS = 2.0  # of the spacing, by which lines across each other count as apart, over the square root of two
MAX_LINES = 1000
GRID, GRID_STEPS, MAX_GRID = 32, 4, 400  # steps along a parameter at least, along a spacing, and at most


class _Line(NamedTuple):
    uv: FloatArray  # (k, 2) parameters
    points: FloatArray  # (k, 3) [L]
    placed: FloatArray  # (k, 12) points and directions, see _Tracer._placed
    cut: tuple[bool, bool]  # whether it ends beside another line rather than beyond the rim


def even_lines(surface: SplineSurface, kind: str, spacing: float, rims: Sequence[FloatArray] = ()) -> list[FloatArray]:
    """Return the parameters (k, 2) along crossing lines, those that are parallel about as far apart as a spacing.

    A line begins one spacing beside another or across it, and ends beyond the rim, or at the line that it crosses last before it
    comes nearer to a parallel one than half a spacing. Lines of curvature go straight on where the principal curvatures are nearly equal.

    Parameters
    ----------
    surface
        The surface.
    kind
        ``"curvature"`` or ``"geodesics"``.
    spacing
        Distance between neighbours aimed at [L].
    rims
        ``(k, 2)`` parameters around the surface and its holes; none where these are the sides of the parameters.

    Raises
    ------
    MeshError
        If the mesher is not installed, or there is no room for a line.

    References
    ----------
    Jobard, Lefer, *Creating evenly-spaced streamlines of arbitrary density*, 1997, doi:10.1007/978-3-7091-6876-9_5.
    """
    tracer = _Tracer(surface, _CrossField(surface, spacing, rims) if kind == "curvature" else None, spacing, rims)
    start = tracer.middle()
    first = tracer.ahead(start, surface.tangents(start)[1])[0]
    second = np.cross(surface.normals(start), first)
    # Lines of a field cover it from any of them; geodesics are two families.
    lines = [line for direction in ([first] if kind == "curvature" else [first, second]) for line in tracer.lines(start, direction)]
    found = _ended(lines, Lengths.of(surface, rims))
    if not found:
        raise MeshError(f"the design has no room for lines {spacing:.3g} apart; choose narrower panels")
    return found


class _Tracer:
    """Traces lines of a field, each with the distances it keeps."""

    def __init__(self, surface: SplineSurface, field: Optional[_CrossField], spacing: float, rims: Sequence[FloatArray]):
        self.surface, self._field, self.spacing, self.rims = surface, field, spacing, rims
        self.step = spacing / STEPS
        rings = list(rims) or [parameter_rim(surface)]
        fine = [_divided(np.concatenate([ring, ring[:1]]), 2000) for ring in rings]
        points = [surface.at(ring) for ring in fine]
        self._rim = cKDTree(np.concatenate([own[:-1] for own in points]))
        steps = np.concatenate([np.diff(own, axis=0) for own in points])
        self._along_rim = steps / np.maximum(np.linalg.norm(steps, axis=1), 1e-300)[:, None]

    def inside(self, uv: FloatArray) -> Mask:
        """Return which parameters (k, 2) lie within the rims."""
        low, high = self.surface.domain.T
        return ((uv >= low) & (uv <= high)).all(axis=1) & within_rims(uv, self.rims)

    def middle(self) -> FloatArray:
        """Return the parameters (1, 2) of the place inside that is farthest from the rim."""
        values = [np.linspace(low, high, GRID + 1)[1:-1] for low, high in self.surface.domain.tolist()]
        uv = np.stack(np.meshgrid(*values, indexing="ij"), axis=-1).reshape(-1, 2)
        uv = uv[self.inside(uv)]
        return uv[np.argmax(self._rim.query(self.surface.at(uv))[0])][None]

    def lines(self, start: FloatArray, direction: FloatArray) -> list[_Line]:
        """Return lines beside each other, and those of a field across each other, from one through a place (1, 2) in a direction (1, 3)."""
        lines: list[_Line] = []
        fronts = [(start, direction)]
        while fronts and len(lines) < MAX_LINES:
            for line in self._accepted(*fronts.pop(0), lines):
                lines.append(line)
                fronts.append(self._beside(line))
        return lines

    def _accepted(self, uv: FloatArray, direction: FloatArray, lines: list[_Line]) -> list[_Line]:
        """Return the lines through places (k, 2) that have room beside parallel ones."""
        if lines and len(uv):
            own = self._placed(self.surface.at(uv), direction)
            free = cKDTree(np.concatenate([line.placed for line in lines])).query(own)[0] >= TAKEN * self.spacing
            uv, direction = uv[free], direction[free]
        found: list[_Line] = []
        for places, at in self._traced(uv, direction) if len(uv) else ():
            points = self.surface.at(places)
            placed = self._placed(points, np.gradient(points, axis=0))
            before = [line.placed for line in (*lines, *found)]
            away = cKDTree(np.concatenate(before)).query(placed)[0] if before else np.full(len(placed), np.inf)
            line = self._trimmed(places, points, placed, away, at) if away[at] >= TAKEN * self.spacing else None
            found += [] if line is None else [line]
        return found

    def _placed(self, points: FloatArray, along: FloatArray) -> FloatArray:
        """Return points in a space (k, 12) where only parallel lines of a field are near to each other, and all of one family."""
        unit = along / np.maximum(np.linalg.norm(along, axis=1), 1e-300)[:, None]
        directions = np.einsum("ki,kj->kij", unit, unit).reshape(-1, 9)
        return np.column_stack([points, (0.0 if self._field is None else ACROSS) * self.spacing * directions])

    def _trimmed(self, uv: FloatArray, points: FloatArray, placed: FloatArray, away: FloatArray, at: int) -> Optional[_Line]:
        """Return the part of a line around a place that keeps its distances, if it is long enough."""
        gap, nearest = self._rim.query(points)
        tangents = np.gradient(points, axis=0)
        tangents /= np.maximum(np.linalg.norm(tangents, axis=1), 1e-300)[:, None]
        slant = np.abs((tangents * self._along_rim[nearest]).sum(axis=1))
        bad = (away < NEAREST * self.spacing) | ((gap < ALONG_RIM * self.spacing) & (slant > SLANT))
        if bad[at]:
            return None
        first = int(np.flatnonzero(bad[:at]).max(initial=-1)) + 1
        last = at + int(np.argmax(bad[at:])) if bad[at:].any() else len(points)
        if last - first < SHORTEST * STEPS:
            return None
        return _Line(uv[first:last], points[first:last], placed[first:last], (first > 0, last < len(points)))

    def _beside(self, line: _Line) -> tuple[FloatArray, FloatArray]:
        """Return places (k, 2) one spacing to both sides of a line, and for a field on it, and directions (k, 3) along or across it."""
        at = np.arange(STEPS // 2, len(line.uv), STEPS // 2)
        at = at[np.argsort(np.abs(at - len(line.uv) // 2), kind="stable")]
        along = np.gradient(line.points, axis=0)[at]
        side = np.cross(self.surface.normals(line.uv[at]), along)
        side *= self.spacing / np.maximum(np.linalg.norm(side, axis=1), 1e-300)[:, None]
        beside = [self.surface.foot(line.points[at] + sign * side, line.uv[at]) for sign in (1.0, -1.0)]
        uv, along = np.concatenate(beside), np.concatenate([along, along])
        if self._field is not None:
            # Geodesics across this one would go in all directions.
            uv, along = np.concatenate([uv, line.uv[at]]), np.concatenate([along, side])
        inside = self.inside(uv)
        uv, along = uv[inside], along[inside]
        return uv, self.ahead(uv, along)[0] if len(uv) else along

    def _traced(self, uv: FloatArray, direction: FloatArray) -> Iterator[tuple[FloatArray, int]]:
        """Yield parameters (k, 2) along the line through each place, to beyond the rim at both ends, and the position of the place."""
        halves = [self._traced_one_way(uv, sign * direction) for sign in (-1.0, 1.0)]
        for back, ahead in zip(*halves):
            yield np.concatenate([back[::-1], ahead[1:]]), len(back) - 1

    def _traced_one_way(self, uv: FloatArray, direction: FloatArray) -> list[FloatArray]:
        """Return parameters (k, 2) along the lines from places (p, 2) in directions (p, 3), by the midpoint rule."""
        lines = [[place] for place in uv]
        active = np.arange(len(uv))
        most = int(8.0 * self.surface.size / self.step)
        for _ in range(most):
            _, rates = self.ahead(uv, direction)
            direction, rates = self.ahead(uv + 0.5 * self.step * rates, direction)
            uv = uv + self.step * rates
            for k, place in zip(active.tolist(), uv):
                lines[k].append(place)
            on = self.inside(uv)
            if not on.any():
                break
            active, uv, direction = active[on], uv[on], direction[on]
        return [np.array(line) for line in lines]

    def ahead(self, uv: FloatArray, direction: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return the unit directions (k, 3) of lines that come in directions (k, 3), and the rates of parameters (k, 2) along them."""
        _, u, v = self.surface.tangents(uv)
        a, b, c = (u * u).sum(axis=1), (u * v).sum(axis=1), (v * v).sum(axis=1)
        normal = np.cross(u, v)
        x = u / np.sqrt(np.maximum(a, 1e-300))[:, None]
        y = np.cross(normal / np.maximum(np.linalg.norm(normal, axis=1), 1e-300)[:, None], x)
        angle = np.arctan2((direction * y).sum(axis=1), (direction * x).sum(axis=1))
        if self._field is not None:
            angle = self._field.nearest(uv, angle)
        along = np.cos(angle)[:, None] * x + np.sin(angle)[:, None] * y
        p, q = (along * u).sum(axis=1), (along * v).sum(axis=1)
        determinant = np.maximum(a * c - b * b, 1e-12 * a * c + 1e-300)
        return along, np.column_stack([c * p - b * q, a * q - b * p]) / determinant[:, None]


class _CrossField:
    """The principal directions of a surface, smoothed as crosses: unit complex numbers to the fourth power of the angle.

    References
    ----------
    Palacios, Zhang, *Rotational symmetry field design on surfaces*, 2007, doi:10.1145/1276377.1276446.
    """

    def __init__(self, surface: SplineSurface, width: float, rims: Sequence[FloatArray]):
        plane = Lengths.of(surface, rims)
        spans = [float(own[-1]) for own in plane.lengths]
        counts = [int(np.clip(GRID_STEPS * span / width, GRID, MAX_GRID)) for span in spans]
        self._axes = [np.linspace(low, high, count + 1) for (low, high), count in zip(surface.domain.tolist(), counts)]
        uv = np.stack(np.meshgrid(*self._axes, indexing="ij"), axis=-1)
        curvatures, angles = surface.principal(uv.reshape(-1, 2))
        apart = np.where(within_rims(uv, rims).ravel(), curvatures[:, 0] - curvatures[:, 1], 0.0) ** 2
        real, imaginary = ((apart * f(4.0 * angles)).reshape(uv.shape[:2]) for f in (np.cos, np.sin))
        sigmas = [SMOOTHING * width * count / span for span, count in zip(spans, counts)]
        modes = ["wrap" if closes else "nearest" for closes in surface.closed]
        self._crosses = gaussian_filter(real, sigmas, mode=modes) + 1j * gaussian_filter(imaginary, sigmas, mode=modes)
        self._level = UMBILIC * float(np.quantile(np.abs(curvatures), 0.95)) ** 2

    def nearest(self, uv: FloatArray, angles: FloatArray) -> FloatArray:
        """Return the angles (k,) of the crosses at parameters (k, 2) nearest to given ones, which stay where there is hardly a cross."""
        places = [np.clip((uv[:, k] - own[0]) / (own[1] - own[0]), 0.0, len(own) - 1) for k, own in enumerate(self._axes)]
        own = map_coordinates(self._crosses.real, places, order=1) + 1j * map_coordinates(self._crosses.imag, places, order=1)
        off = np.angle(own * np.exp(-4j * angles)) / 4.0
        return angles + off * np.abs(own) / (np.abs(own) + self._level)


def _ended(lines: list[_Line], plane: Lengths) -> list[FloatArray]:
    """Return lines (k, 2), those that are cut up to their last crossing with others."""
    try:
        import shapely
        from shapely.ops import substring
    except ImportError:
        raise MeshError("seams along lines on a surface need shapely; install it: pip install 'compas_cgc[mesher]'") from None
    curves = [shapely.LineString(plane.to_plane(line.uv)) for line in lines]
    found = []
    for k, (line, curve) in enumerate(zip(lines, curves)):
        across = shapely.MultiLineString(curves[:k] + curves[k + 1 :])
        crossings = shapely.get_coordinates(shapely.intersection(curve, across)) if any(line.cut) else np.empty((0, 2))
        if len(crossings) < sum(line.cut):
            continue
        places = np.sort(shapely.line_locate_point(curve, shapely.points(crossings)))
        first = places[0] if line.cut[0] else 0.0
        last = places[-1] if line.cut[1] else curve.length
        part = shapely.get_coordinates(substring(curve, first, last))
        if len(part) > 1:
            found.append(plane.to_parameters(part))
    return found


def _divided(ring: FloatArray, count: int) -> FloatArray:
    """Return about so many points along a polyline (k, 2)."""
    parts = max(1, count // (len(ring) - 1))
    places = np.arange((len(ring) - 1) * parts + 1) / parts
    return np.column_stack([np.interp(places, np.arange(len(ring)), ring[:, k]) for k in range(2)])
