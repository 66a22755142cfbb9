"""Nets of curves on surfaces with laws other than constant K."""

from __future__ import annotations

import numpy as np
import pytest

from compas_cgc import CGCError
from compas_cgc.fabrication import curve_net
from compas_cgc.model.problem import CGCProblem
from compas_cgc.solvers import solve

from ..support.exact_surfaces import catenoid
from ..support.exact_surfaces import unduloid


def _solved(surface, n: int = 24):
    V, F, _ = surface.patch(n)
    return solve(CGCProblem(V, F).with_supports("boundary").with_laws({0: surface.law}))


def _tangents(net, point):
    """Return the tangents (2, 3) of the curve of each family at a point of both."""
    found = []
    for family in (0, 1):
        (curve,) = [own for own in net.curves if own.family == family]
        k = int(np.argmin(np.linalg.norm(curve.points - point, axis=1)))
        tangent = curve.points[min(k + 1, len(curve.points) - 1)] - curve.points[max(k - 1, 0)]
        found.append(tangent / np.linalg.norm(tangent))
    return np.array(found)


def test_on_a_minimal_surface_asymptotic_curves_bisect_lines_of_curvature():
    result = _solved(catenoid())
    inside = result.vertices[result.problem.movable]
    for point in inside[len(inside) // 3 :: len(inside) // 5]:
        lines, asymptotic = (_tangents(curve_net(result, through=[point], kind=kind), point) for kind in ("curvature", "asymptotic"))
        between = np.degrees(np.arccos(np.abs(lines @ asymptotic.T)))
        assert np.abs(between - 45.0).max() < 1.5
        assert abs(asymptotic[0] @ asymptotic[1]) < np.sin(np.radians(2.0))


def test_the_net_of_constant_mean_curvature_has_lines_of_curvature_at_right_angles():
    result = _solved(unduloid())
    net = curve_net(result)
    assert {curve.kind for curve in net.curves} == {"line of curvature"} and len(net.nodes) > 20
    V = result.vertices
    point = V[len(V) // 2]
    one, other = _tangents(curve_net(result, through=[point]), point)
    assert abs(one @ other) < 0.02
    with pytest.raises(CGCError, match="kind must be curvature or asymptotic"):
        curve_net(result, kind="square")
