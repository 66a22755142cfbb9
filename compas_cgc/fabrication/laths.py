"""Laths along asymptotic curves: straight upright strips with stations of nodes, angles, slots, stress and splices."""

from __future__ import annotations

import math
from typing import NamedTuple
from typing import Optional
from typing import Union

import numpy as np
from scipy.interpolate import CubicSpline

from ..discrete import face_normals
from ..discrete.arrays import FloatArray
from ..discrete.arrays import IntArray
from ..errors import CGCError
from ..meshing import boundary_loops
from ..model.given import checked_number
from .curves import CurveNet
from .curves.net import NetCurve
from .front_view import front_view
from .legend import outside_is_above
from .materials import Material
from .materials import material_named
from .materials import metres_per_unit
from .picture_key import Key
from .picture_key import key_of

__all__ = ["Lath", "LathSchedule", "lath_schedule"]

ON_CURVE = 1e-6  # distance of a node from a curve, relative to the size of the net, up to which it lies on it
LEVEL_TOLERANCE = 0.25  # of the shortest side, up to which a node lies on a coordinate line
MIN_KNOTS, POINTS_PER_KNOT = 5, 4  # of the splines through curves


class Lath(NamedTuple):
    """One straight strip, which stands upright on the surface."""

    number: int  # from 1
    region: int
    family: int  # 0 or 1; families have opposite twist
    length: float  # [L]
    nodes: IntArray  # (k,) nodes of the net along it
    stations: FloatArray  # (k,) distance of the nodes from its start [L]
    across: IntArray  # (k,) number of the lath that it crosses there
    angles: FloatArray  # (k,) angle between the two laths, seen from outside, from family 0 to family 1 [rad]
    bending: FloatArray  # (k,) curvature about its weak axis (geodesic curvature), positive to the left [1/L]
    twist: float  # geodesic torsion, positive for a right-handed screw [rad/L]
    stress: float  # largest sum of bending stress and stress of the outer fibres by twisting [Pa]
    shear: float  # shear stress by twisting [Pa]
    splices: tuple[float, ...]  # distances from its start at which stock lengths meet [L]
    points: FloatArray  # (k, 3) positions of its nodes [L]
    path: FloatArray  # (p, 3) the curve, from station 0 [L]


class LathSchedule(NamedTuple):
    """Laths of a net and their section."""

    laths: list[Lath]
    width: float  # upright side of the section [mm]
    thickness: float  # [mm]
    material: Material
    unit: float  # length of the model unit [m]
    stock: float  # length of the stock, 0 if unlimited [L]
    above: Optional[bool]  # whether the outside, to which normals point, is above everywhere (True) or below (False), else None
    key: Key  # unit, north and K of the drawing
    edges: list[FloatArray]  # edges of the surface, closed (k, 3) [L]
    view: FloatArray  # (3, 3) axes of the plan or elevation: to the right, upwards, and to the viewer


def lath_schedule(
    net: CurveNet, width: float = 80.0, thickness: float = 8.0, *, material: Union[str, Material] = "timber", stock: float = 0.0
) -> LathSchedule:
    """Return the schedule of straight laths along the asymptotic curves of a net.

    An asymptotic curve has no normal curvature, so that a strip upright on the surface stays straight when it is laid flat. Its torsion is
    ``sqrt(-K)`` in one family and ``-sqrt(-K)`` in the other (Beltrami and Enneper).

    Parameters
    ----------
    net
        Result of :func:`compas_cgc.fabrication.curve_net`.
    width, thickness
        Section of the laths [mm].
    material
        A name of :data:`~compas_cgc.fabrication.MATERIALS`, or a material.
    stock
        Length of the stock [L]; longer laths get splices in the middle between two nodes. 0: unlimited.

    Raises
    ------
    CGCError
        If the net has no asymptotic curves, a side is not positive, or the stock is shorter than a side of the net.

    References
    ----------
    Schling, Hitrec, Barthel, *Designing grid structures using asymptotic curve networks*, doi:10.1007/978-981-10-6611-5_12.
    """
    curves = [curve for curve in net.curves if curve.kind == "asymptotic curve"]
    if not curves:
        raise CGCError("the net has no asymptotic curves; laths need a region of K < 0")
    for what, value in (("width", width), ("thickness", thickness)):
        if not 0.0 < checked_number(value, what) < math.inf:
            raise CGCError(f"the {what} of laths must be a positive number [mm], not {value!r}")
    if not 0.0 <= checked_number(stock, "stock") < math.inf:
        raise CGCError(f"the stock length must be at least 0, not {stock!r}")
    stuff, unit = material_named(material), metres_per_unit(net.problem.drawing.units)
    size = float(np.linalg.norm(np.ptp(net.problem.vertices, axis=0)))
    feet = {region: surface.feet(net.nodes) for region, surface in net.surfaces.items()}
    found = [_followed(net, curve, feet.get(curve.region), ON_CURVE * size) for curve in curves]
    crossing = np.full((len(net.nodes), 2), -1)
    for k, (curve, own) in enumerate(zip(curves, found)):
        crossing[own.nodes, curve.family] = k
    directions = np.full((len(net.nodes), 2, 3), np.nan)
    normals = np.zeros((len(net.nodes), 3))
    own_normals = face_normals(net.problem.vertices, net.problem.faces)
    for curve, own in zip(curves, found):
        directions[own.nodes, curve.family] = own.tangents
        at = np.r_[0.0, np.cumsum(np.linalg.norm(np.diff(curve.points, axis=0), axis=1))]
        segment = np.clip(np.searchsorted(at, own.stations) - 1, 0, len(curve.faces) - 1)
        normals[own.nodes] += own_normals[curve.faces[segment]]
    side = np.einsum("ni,ni->n", np.cross(directions[:, 0], directions[:, 1]), normals)
    angles = np.arctan2(
        np.sign(side) * np.linalg.norm(np.cross(directions[:, 0], directions[:, 1]), axis=1),
        (directions[:, 0] * directions[:, 1]).sum(axis=1),
    )
    targets = net.problem.region_targets()
    laths = []
    for k, (curve, (nodes, stations, length, tangent, bends)) in enumerate(zip(curves, found)):
        K = targets[curve.region] or 0.0
        # The curvature vector of an asymptotic curve lies in the tangent plane.
        left = np.cross(normals[nodes], tangent)
        bending = np.einsum("ki,ki->k", bends, left / np.maximum(np.linalg.norm(left, axis=1, keepdims=True), np.finfo(float).tiny))
        twist = _handedness(angles[nodes], curve.family) * math.sqrt(-K)
        stress, shear = _stress(stuff, 1e-3 * width, 1e-3 * thickness, np.abs(bending).max(initial=0.0) / unit, abs(twist) / unit)
        splices = _splices(length, stations, stock) if stock else ()
        across = crossing[nodes, 1 - curve.family] + 1
        laths.append(
            Lath(
                k + 1,
                curve.region,
                curve.family,
                length,
                nodes,
                stations,
                across,
                angles[nodes],
                bending,
                twist,
                stress,
                shear,
                splices,
                net.nodes[nodes],
                curve.points,
            )
        )
    edges = [net.problem.vertices[loop] for loop in boundary_loops(net.problem.faces)]
    above, view = outside_is_above(own_normals), front_view(net.problem)
    return LathSchedule(laths, float(width), float(thickness), stuff, unit, float(stock), above, key_of(net.problem), edges, view)


class _Followed(NamedTuple):
    """Nodes along a curve."""

    nodes: IntArray  # (k,)
    stations: FloatArray  # (k,) [L]
    length: float  # of the curve [L]
    tangents: FloatArray  # (k, 3) unit
    bends: FloatArray  # (k, 3) curvature vectors [1/L]


def _followed(net: CurveNet, curve: NetCurve, at: Optional[FloatArray], near: float) -> _Followed:
    """Return the nodes along a curve: by their coordinates (n, 2) on the surface of constant K, or else along the polyline."""
    surface = net.surfaces.get(curve.region)
    if surface is None or at is None:
        nodes, stations = _along(curve.points, net.nodes, near)
        return _Followed(nodes, stations, curve.length, *_tangents(curve.points, stations))
    ends = surface.feet(curve.points[[0, -1]])
    own, other = curve.family, 1 - curve.family
    # Nodes of other regions do not lie on this surface.
    on = np.linalg.norm(surface.values(at) - net.nodes, axis=1) < near
    on &= np.abs(at[:, other] - ends[:, other].mean()) < LEVEL_TOLERANCE * net.lengths.min()
    way = float(np.sign(ends[1, own] - ends[0, own]))
    nodes = np.flatnonzero(on)
    nodes = nodes[np.argsort(way * at[nodes, own], kind="stable")]
    first, second = (surface.values(at[nodes], *((order, 0) if own == 0 else (0, order))) for order in (1, 2))
    stations = way * (at[nodes, own] - ends[0, own])
    tangents = way * first / np.linalg.norm(first, axis=1, keepdims=True)
    return _Followed(nodes, stations, float(abs(ends[1, own] - ends[0, own])), tangents, second)


def _along(points: FloatArray, nodes: FloatArray, near: float) -> tuple[IntArray, FloatArray]:
    """Return the nodes that lie on a polyline (k, 3) and their arc lengths, in order."""
    start, step = points[:-1], np.diff(points, axis=0)
    length = np.linalg.norm(step, axis=1)
    away = nodes[:, None] - start
    share = np.clip(np.einsum("nki,ki->nk", away, step) / np.maximum(length**2, np.finfo(float).tiny), 0.0, 1.0)
    off = np.linalg.norm(away - share[..., None] * step, axis=2)
    best = np.argmin(off, axis=1)
    chosen = np.flatnonzero(off[np.arange(len(nodes)), best] <= near)
    stations = (np.r_[0.0, np.cumsum(length)][best] + share[np.arange(len(nodes)), best] * length[best])[chosen]
    order = np.argsort(stations, kind="stable")
    return chosen[order].astype(np.int64), stations[order]


def _tangents(points: FloatArray, stations: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return unit tangents and curvature vectors of a polyline at some stations (k, 3), by a cubic spline along all of it.

    The knots of the spline are a few mesh edges apart, so that the corners of the polyline do not matter.
    """
    at = np.r_[0.0, np.cumsum(np.linalg.norm(np.diff(points, axis=0), axis=1))]
    knots = np.linspace(0.0, at[-1], max(MIN_KNOTS, len(points) // POINTS_PER_KNOT))
    spline = CubicSpline(knots, np.column_stack([np.interp(knots, at, coordinate) for coordinate in points.T]))
    slope = spline(stations, 1)
    return slope / np.linalg.norm(slope, axis=1, keepdims=True), spline(stations, 2)


def _handedness(angles: FloatArray, family: int) -> float:
    """Return the sign of the twist of a family."""
    turned = np.sign(np.median(angles)) if len(angles) else 1.0
    return float(turned * (1.0 if family == 0 else -1.0))


def _stress(material: Material, width: float, thickness: float, bending: float, twist: float) -> tuple[float, float]:
    """Return the normal stress of bending and of the fibres stretched by twisting, and the shear stress of a thin strip [Pa]."""
    shear_modulus = material.modulus / (2.0 * (1.0 + material.poisson))
    stretched = material.modulus * twist**2 * width**2 / 12.0
    return material.modulus * (0.5 * thickness * bending) + stretched, shear_modulus * thickness * twist


def _splices(length: float, stations: FloatArray, stock: float) -> tuple[float, ...]:
    """Return positions of splices, each in the middle between two nodes and as far along the stock as possible."""
    middles = 0.5 * (stations[1:] + stations[:-1])
    found, start = [], 0.0
    while length - start > stock:
        possible = middles[(middles > start) & (middles - start <= stock)]
        if not len(possible):
            raise CGCError(f"no splice (middle between two nodes) lies within a stock length of {stock:g} model units; use longer stock")
        start = float(possible[-1])
        found.append(start)
    return tuple(found)
