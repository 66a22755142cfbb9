"""Panels between curves on a surface, within any rim and around holes."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from scipy.spatial import cKDTree

from ..discrete import boundary_vertices
from ..discrete import edge_faces
from ..discrete.arrays import FloatArray
from ..discrete.arrays import IntArray
from ..errors import MeshError
from ..meshing import face_regions
from ..meshing import path_edges
from ..meshing.outline import mesh_from_outline
from ..meshing.weld import clean_faces
from ..meshing.weld import weld
from .panelling import Panelling
from .rims import mean_steps
from .rims import within_rims
from .spline_surface import SplineSurface

__all__ = ["Lengths", "curve_panels", "parameter_rim", "refuse_distorted"]

SAMPLES = 64  # divisions of the domain along which lengths are measured
POINT = 1e-4  # of an edge, within which points are one
MAX_STRETCH = 4.0  # of lengths on the surface and in the plane in which it is meshed, for all but a hundredth of it
MAX_AREA_RATIO = 2.0  # of areas on the surface and in the plane
NODE = 0.2  # of an edge, within which crossings with a side are one
JOINED = 1e-2  # of an edge, within which points on both sides of a closed surface are one


class Lengths(NamedTuple):
    """A plane in which distances are about those on a surface: mean lengths along its parameters."""

    parameters: tuple[FloatArray, FloatArray]
    lengths: tuple[FloatArray, FloatArray]  # [L]

    @classmethod
    def of(cls, surface: SplineSurface, rims: Sequence[FloatArray] = ()) -> Lengths:
        """Measure a surface along lines of constant parameter, within its rims."""
        values = [np.linspace(low, high, SAMPLES + 1) for low, high in surface.domain.tolist()]
        uv = np.stack(np.meshgrid(*values, indexing="ij"), axis=-1)
        points, inside = surface.at(uv.reshape(-1, 2)).reshape(SAMPLES + 1, SAMPLES + 1, 3), within_rims(uv, rims)
        steps = [mean_steps(points, inside, axis) for axis in range(2)]
        first, second = (np.concatenate([[0.0], np.cumsum(step)]) for step in steps)
        return cls((values[0], values[1]), (first, second))

    def to_plane(self, uv: FloatArray) -> FloatArray:
        """Return points of the plane (k, 2) at parameters (k, 2) [L]."""
        return np.column_stack([_extrapolated(uv[:, k], self.parameters[k], self.lengths[k]) for k in range(2)])

    def to_parameters(self, plane: FloatArray) -> FloatArray:
        """Return the parameters (k, 2) of points of the plane (k, 2) [L]."""
        return np.column_stack([_extrapolated(plane[:, k], self.lengths[k], self.parameters[k]) for k in range(2)])


def refuse_distorted(surface: SplineSurface, rims: Sequence[FloatArray]) -> None:
    """Refuse a surface that is far from a plane with its mean lengths, within its rims.

    A mesh that is made in this plane would have edges of very different lengths, or far more of them than the surface needs.

    Raises
    ------
    MeshError
        With the smallest and largest length.
    """
    plane = Lengths.of(surface, rims)
    middle = [0.5 * (own[1:] + own[:-1]) for own in plane.parameters]
    uv = np.stack(np.meshgrid(*middle, indexing="ij"), axis=-1).reshape(-1, 2)
    rates = [np.diff(own) / np.maximum(np.diff(lengths), 1e-300) for own, lengths in zip(plane.parameters, plane.lengths)]
    inside = within_rims(uv, rims)
    _, u, v = surface.tangents(uv[inside])
    u_rate, v_rate = (rate.ravel()[inside] for rate in np.meshgrid(*rates, indexing="ij"))
    stretches = np.linalg.svd(np.stack([u * u_rate[:, None], v * v_rate[:, None]], axis=-1), compute_uv=False)
    if len(stretches):
        shortest, longest = np.quantile(stretches[:, 1], 0.01), np.quantile(stretches[:, 0], 0.99)
        area = float(stretches.prod(axis=1).mean())
        if shortest * MAX_STRETCH >= 1.0 and longest <= MAX_STRETCH and 1.0 / MAX_AREA_RATIO <= area <= MAX_AREA_RATIO:
            return
        reason = f"edges would have {shortest:.2g} to {longest:.2g} times the length aimed at"
    else:
        reason = "its rims enclose no area"
    raise MeshError(
        f"the design is too far from flat for seams along curves or around holes: {reason}; use a grid of seams, "
        "or divide the design into parts that are nearer to flat"
    )


def parameter_rim(surface: SplineSurface) -> FloatArray:
    """Return the rim of the domain of a surface (4, 2)."""
    (u0, u1), (v0, v1) = surface.domain
    return np.array([[u0, v0], [u1, v0], [u1, v1], [u0, v1]])


def curve_panels(surface: SplineSurface, rims: Sequence[FloatArray], seams: Sequence[FloatArray], edge_length: float) -> Panelling:
    """Return a mesh within rims whose edges follow seams; the parts between seams are the panels.

    Vertices lie on the surface, those of a seam on the seam.

    Parameters
    ----------
    surface
        The surface.
    rims
        ``(k, 2)`` parameters around the surface, then around its holes.
    seams
        ``(k, 2)`` parameters along seams, which may leave the rim and cross.
    edge_length
        Length of edges aimed at [L].

    Raises
    ------
    MeshError
        If curves bound no area, graze each other or the rim, or the mesher is not installed.
    """
    plane = Lengths.of(surface, rims)

    def flat(line: FloatArray) -> FloatArray:
        points = plane.to_plane(line)
        return np.column_stack([points, np.zeros(len(points))])

    order = sorted(range(len(rims)), key=lambda k: -abs(_area(plane.to_plane(rims[k]))))
    outline, *holes = (flat(rims[k]) for k in order)
    lines = [flat(seam) for seam in seams]
    closed = [axis for axis in range(2) if surface.closed[axis]]
    joints = np.concatenate([np.empty((0, 3)), *(_joints(outline, lines, axis, edge_length) for axis in closed)])
    made = mesh_from_outline(outline, holes, lines, edge_length, POINT * edge_length, joints)
    points, faces = made.vertices[:, :2], made.faces
    for axis in closed:
        points, faces = _matched(points, faces, axis, NODE * edge_length)
    uv = np.clip(plane.to_parameters(points), surface.domain[:, 0], surface.domain[:, 1])
    if not len(faces):
        raise MeshError("the boundary curves of the design enclose no area; check the outline of the design")
    joined = weld(surface.at(uv), faces, JOINED * edge_length if any(surface.closed) else 0.0)
    clean = clean_faces(joined.faces)
    first = np.full(len(joined.vertices), len(uv))
    np.minimum.at(first, joined.index, np.arange(len(uv)))
    creases = joined.index[np.array(path_edges(made.creases), dtype=np.int64).reshape(-1, 2)]
    panels = face_regions(clean.faces, creases[creases[:, 0] != creases[:, 1]])
    rim = boundary_vertices(joined.vertices, clean.faces)
    sides = edge_faces(clean.faces)
    opened = uv[first][sides[sides[:, 3] < 0, :2]]
    reach = POINT * np.ptp(surface.domain, axis=1)
    on_side = (np.abs(opened[..., None] - surface.domain).min(axis=3) <= reach).all(axis=1)
    if on_side[:, list(surface.closed)].any():
        raise MeshError(
            "the design is closed, and its seams do not match along the line where its two sides are joined; use a grid of seams"
        )
    return Panelling(joined.vertices, clean.faces, panels, uv[first], np.column_stack([rim, rim]))


def _joints(outline: FloatArray, lines: Sequence[FloatArray], axis: int, edge_length: float) -> FloatArray:
    """Return points (k, 3) at the same places of both sides where a surface closes, an edge apart and at the crossings of lines.

    Parameters
    ----------
    outline
        ``(k, 3)`` outline in the plane [L].
    lines
        ``(k, 3)`` seams in the plane [L].
    axis
        The coordinate that closes.
    edge_length
        Length of edges aimed at [L].
    """
    import shapely

    low, high = outline[:, axis].min(), outline[:, axis].max()
    ends = np.roll(outline, -1, axis=0)
    reach = POINT * edge_length
    on_low = (np.abs(outline[:, axis] - low) <= reach) & (np.abs(ends[:, axis] - low) <= reach)
    found = []
    for begin, end in zip(outline[on_low, 1 - axis].tolist(), ends[on_low, 1 - axis].tolist()):
        stops = [begin, end]
        for side in (low, high):
            corners = np.empty((2, 2))
            corners[:, axis], corners[:, 1 - axis] = side, (begin, end)
            crossings = shapely.intersection(shapely.LineString(corners), shapely.MultiLineString([line[:, :2] for line in lines]))
            stops += shapely.get_coordinates(crossings)[:, 1 - axis].tolist()
        every = np.sort(stops)
        apart = every[np.append(True, np.diff(every) > NODE * edge_length)]
        places = np.concatenate(
            [np.linspace(a, b, max(1, round((b - a) / edge_length)), endpoint=False) for a, b in zip(apart[:-1], apart[1:])]
        )[1:]
        for side in (low, high):
            points = np.zeros((len(places), 3))
            points[:, axis], points[:, 1 - axis] = side, places
            found.append(points)
    return np.concatenate(found or [np.empty((0, 3))])


def _matched(points: FloatArray, faces: IntArray, axis: int, reach: float) -> tuple[FloatArray, IntArray]:
    """Return a mesh (n, 2), (m, 3) whose vertices on both sides of a coordinate that closes have the same places.

    Vertices of the second side that are nearer than ``reach`` to one of the first move to it; others split edges.
    """
    points, low, high = points.copy(), points[:, axis].min(), points[:, axis].max()
    tolerance = POINT * (high - low)
    first, second = (np.flatnonzero(np.abs(points[:, axis] - side) <= tolerance) for side in (low, high))
    if not len(first) or not len(second):
        return points, faces
    gaps, nearest = cKDTree(points[first, 1 - axis, None]).query(points[second, 1 - axis, None])
    near = gaps <= reach
    points[second[near], 1 - axis] = points[first[nearest[near]], 1 - axis]
    for own, other, side in ((first, second, low), (second, first, high)):
        places = points[other, 1 - axis]
        lone = places[cKDTree(points[own, 1 - axis, None]).query(places[:, None])[0] > reach]
        points, faces = _split(points, faces, own, axis, side, np.sort(lone))
    return points, faces


def _split(points: FloatArray, faces: IntArray, own: IntArray, axis: int, side: float, places: FloatArray) -> tuple[FloatArray, IntArray]:
    """Return a mesh (n, 2), (m, 3) whose edges between given vertices on one side are split at places (k,) along it."""
    on = np.zeros(len(points), bool)
    on[own] = True
    added, kept, fans = [points], np.ones(len(faces), bool), []
    count = len(points)
    for f, face in enumerate(faces.tolist()):
        for a, b, c in (face, face[1:] + face[:1], face[2:] + face[:2]):
            if not (on[a] and on[b]):
                continue
            start, end = points[a, 1 - axis], points[b, 1 - axis]
            between = places[(places > min(start, end)) & (places < max(start, end))]
            if len(between):
                new = np.empty((len(between), 2))
                new[:, axis], new[:, 1 - axis] = side, between if start < end else between[::-1]
                chain = [a, *range(count, count + len(between)), b]
                fans += [[p, q, c] for p, q in zip(chain[:-1], chain[1:])]
                count, kept[f] = count + len(between), False
                added.append(new)
    return np.concatenate(added), np.concatenate([faces[kept], np.array(fans, dtype=np.int64).reshape(-1, 3)])


def _extrapolated(x: FloatArray, known: FloatArray, values: FloatArray) -> FloatArray:
    """Return values between known places, and beyond them at the mean rate."""
    rate = (values[-1] - values[0]) / (known[-1] - known[0])
    return np.interp(x, known, values) + rate * (x - np.clip(x, known[0], known[-1]))


def _area(ring: FloatArray) -> float:
    x, y = ring.T
    return 0.5 * float(x @ np.roll(y, -1) - y @ np.roll(x, -1))
