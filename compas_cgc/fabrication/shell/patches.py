"""Four-sided spline patches of regions, whose sides coincide with those of their neighbours."""

from __future__ import annotations

from typing import NamedTuple
from typing import Optional

import numpy as np
from scipy.interpolate import BSpline
from scipy.interpolate import make_interp_spline

from ...discrete.arrays import FloatArray
from ...discrete.nurbs import NurbsPatch
from ...errors import MeshError
from ...model.problem import CGCProblem
from .fit import AWAY
from .fit import AWAY_FROM
from .fit import MAX_CURVATURE_ERROR
from .fit import Fit
from .fit import distances
from .fit import reference
from .heights import DEGREE
from .heights import SECOND_ORDERS
from .heights import HeightSpace

__all__ = ["Patch", "Patches", "curvature_errors", "patches", "region_patches", "side_points"]

SPANS_PER_EDGE = (4, 8, 16)  # spans along a side per mesh edge of the longest side, tried in this order
SAMPLES = 40  # points in each direction at which K is measured
MAX_ADDED_ERROR = 0.005  # error of K, 95th percentile, that patches may add to that of the fitted surfaces without refinement


class Patch(NamedTuple):
    """A tensor-product spline surface of the degree of the heights."""

    control: FloatArray  # (a, b, 3) [L]
    knots_u: FloatArray  # (a + DEGREE + 1,)
    knots_v: FloatArray
    sides: bool  # whether the sides of the patch are those of the region; otherwise the patch extends beyond it

    @property
    def nurbs(self) -> NurbsPatch:
        """The patch with weights of 1."""
        control = np.concatenate([self.control, np.ones((*self.control.shape[:2], 1))], axis=-1)
        return NurbsPatch(control, (self.knots_u, self.knots_v), (DEGREE, DEGREE))


class Patches(NamedTuple):
    """Patches of all regions with their measured accuracy."""

    patches: list[Patch]
    sides: list[FloatArray]  # (n, 3) points on every edge of the regions, in the frame of the fit
    percentiles: FloatArray  # (3,) 50th, 95th and 100th percentile of the error of K away from singular vertices, relative to the target


def region_patches(problem: CGCProblem, fit: Fit) -> Patches:
    """Return the patches of a fit, refined until they have its K.

    Raises
    ------
    MeshError
        If the finest patches do not have the K of the regions.
    """
    made = _measured(problem, fit, SPANS_PER_EDGE[0])
    for spans in SPANS_PER_EDGE[1:]:
        if made.percentiles[1] <= fit.percentiles()[1] + MAX_ADDED_ERROR:
            break
        made = _measured(problem, fit, spans)
    error = float(made.percentiles[1])
    if error > MAX_CURVATURE_ERROR:
        raise MeshError(
            f"no NURBS surfaces of the regions were written, because their K differs from its target by {100 * error:.3g} % "
            f"(95th percentile {AWAY_FROM}); refine the mesh, or write .step"
        )
    return made


def _measured(problem: CGCProblem, fit: Fit, spans: int) -> Patches:
    made = patches(fit, spans)
    errors = curvature_errors(problem, fit, made)
    return Patches(made, side_points(fit, spans), np.percentile(errors, [50, 95, 100]) if len(errors) else np.zeros(3))


def curvature_errors(problem: CGCProblem, fit: Fit, made: list[Patch]) -> FloatArray:
    """Return the error of K of patches on a grid, away from singular vertices, relative to the targets (k,).

    Patches that extend beyond their region are measured at the faces of the region.
    """
    singular = fit.centre + fit.scale * fit.singular
    edge = np.linalg.norm(problem.vertices[problem.faces[:, 0]] - problem.vertices[problem.faces[:, 1]], axis=1).mean()
    found = [np.empty(0)]
    label = problem.regions()[fit.away]
    for region, (patch, target) in enumerate(zip(made, problem.region_targets())):
        if target is None:
            continue
        if not patch.sides:
            found.append(fit.errors[fit.away[label == region]])
            continue
        places = np.linspace(patch.knots_u[0], patch.knots_u[-1], 2 + SAMPLES)[1:-1]
        point, u, v, uu, uv, vv = (_derivative(patch, places, order) for order in ((0, 0), *SECOND_ORDERS))
        normal = np.cross(u, v)
        e, f, g = ((second * normal).sum(axis=-1) for second in (uu, uv, vv))
        K = (e * g - f * f) / np.maximum((normal**2).sum(axis=-1), 1e-300) ** 2
        used = problem.vertices[np.unique(problem.faces[problem.regions() == region])]
        error = np.abs(K - target) / reference(target, used, fit.scale)
        found.append(error[distances(point, singular) > AWAY * edge])
    return np.concatenate(found)


def _derivative(patch: Patch, places: FloatArray, order: tuple[int, int]) -> FloatArray:
    """Return points, or derivatives of an order, on a grid of parameters (k, k, 3)."""
    along = BSpline(patch.knots_u, patch.control, DEGREE)(places, nu=order[0])
    across: FloatArray = BSpline(patch.knots_v, np.swapaxes(along, 0, 1), DEGREE)(places, nu=order[1])
    return np.swapaxes(across, 0, 1)


def side_points(fit: Fit, spans: int) -> list[FloatArray]:
    """Return points (n, 3) on every edge of the regions, at the same parameters for all, with common ends, in the frame of the fit."""
    ends: dict[int, list[FloatArray]] = {}
    for edge, curve in zip(fit.edges, fit.curves):
        for vertex, point in zip(edge.path[[0, -1]].tolist(), curve[[0, -1]]):
            ends.setdefault(vertex, []).append(point)
    places = _greville(_knots(fit, spans))
    sides = []
    for edge, curve in zip(fit.edges, fit.curves):
        piece = fit.pieces[edge.regions[0]]
        points = piece.lifted(piece.local(make_interp_spline(np.linspace(0.0, 1.0, len(curve)), curve, k=3)(places))[:, :2])
        points[0], points[-1] = (np.mean(ends[vertex], axis=0) for vertex in edge.path[[0, -1]].tolist())
        sides.append(points)
    return sides


def patches(fit: Fit, spans: int) -> list[Patch]:
    """Return one patch per region: between the four edges of a region, or over a rectangle for regions of other shapes.

    Parameters
    ----------
    fit
        The fitted surfaces.
    spans
        Number of spans along a side per mesh edge of the longest side.
    """
    sides, knots = side_points(fit, spans), _knots(fit, spans)
    return [_between(fit, number, sides, knots) or _over(fit, number) for number in range(len(fit.pieces))]


def _knots(fit: Fit, spans: int) -> FloatArray:
    """Return uniform knots from 0 to 1, the same for all patches."""
    number = spans * max(len(edge.path) - 1 for edge in fit.edges)
    return HeightSpace.over(np.zeros(2), np.ones(2), 1.0 / number).knots[0]


def _greville(knots: FloatArray) -> FloatArray:
    """Return the Greville abscissae of the basis functions."""
    return np.convolve(knots[1:-1], np.full(DEGREE, 1.0 / DEGREE), "valid").clip(0.0, 1.0)


def _between(fit: Fit, number: int, sides: list[FloatArray], knots: FloatArray) -> Optional[Patch]:
    """Return the patch between the four edges of a region, None if it has other edges or crosses itself in the plane."""
    own = [k for k, edge in enumerate(fit.edges) if number in edge.regions]
    corners = {vertex for k in own for vertex in fit.edges[k].path[[0, -1]].tolist()}
    if len(own) != 4 or len(corners) != 4:
        return None
    loop, here = [], int(fit.edges[own[0]].path[0])
    for _ in range(4):
        k = next((k for k in own if here in fit.edges[k].path[[0, -1]]), None)
        if k is None:
            return None
        own.remove(k)
        forward = here == fit.edges[k].path[0]
        loop.append(sides[k] if forward else sides[k][::-1])
        here = int(fit.edges[k].path[-1 if forward else 0])
    south, east, north, west = loop[0], loop[1], loop[2][::-1], loop[3][::-1]
    piece = fit.pieces[number]
    s, e, n, w = (piece.local(side)[:, :2] for side in (south, east, north, west))
    t = _greville(knots)
    u, v = t[:, None, None], t[None, :, None]
    plan = (1 - v) * s[:, None] + v * n[:, None] + (1 - u) * w[None] + u * e[None]
    plan = plan - ((1 - u) * (1 - v) * s[0] + u * (1 - v) * s[-1] + (1 - u) * v * n[0] + u * v * n[-1])
    du, dv = np.diff(plan, axis=0)[:, :-1], np.diff(plan, axis=1)[:-1]
    turn = du[..., 0] * dv[..., 1] - du[..., 1] * dv[..., 0]
    if not ((turn > 0.0).all() or (turn < 0.0).all()):
        return None
    points = piece.lifted(plan.reshape(-1, 2)).reshape(len(t), len(t), 3)
    points[:, 0], points[:, -1], points[0], points[-1] = south, north, west, east
    control = make_interp_spline(t, points, k=DEGREE, t=knots, axis=0).c
    control = make_interp_spline(t, np.swapaxes(control, 0, 1), k=DEGREE, t=knots, axis=0).c.swapaxes(0, 1)
    return Patch(fit.centre + fit.scale * control, knots, knots, True)


def _over(fit: Fit, number: int) -> Patch:
    """Return the surface of a region over its rectangle."""
    piece = fit.pieces[number]
    a, b = piece.space.shape
    u, v = (np.convolve(own[1:-1], np.full(DEGREE, 1.0 / DEGREE), "valid") for own in piece.space.knots)
    grid = np.stack([*np.meshgrid(u, v, indexing="ij"), piece.coefficients.reshape(a, b)], axis=-1).reshape(-1, 3)
    return Patch(fit.centre + fit.scale * (grid @ piece.axes).reshape(a, b, 3), *piece.space.knots, False)
