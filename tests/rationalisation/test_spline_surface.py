"""Spline surfaces against closed forms."""

from __future__ import annotations

import json

import numpy as np

from compas_cgc.rationalisation.chart import chart_of
from compas_cgc.rationalisation.chart import fitted_surface
from compas_cgc.rationalisation.design import given_design
from compas_cgc.rationalisation.design_data import design_from_dict
from compas_cgc.rationalisation.design_data import design_to_dict

from ..support.freeform import mesh_over
from ..support.freeform import nurbs_file
from ..support.freeform import quarter_torus

UV = np.random.default_rng(1).uniform([0.05, 0.05], [0.95, 3.95], (40, 2))


def test_points_and_curvature_of_a_rational_torus_are_those_of_the_formula():
    torus = quarter_torus(8.0, 2.0)
    points = torus.at(UV)
    ring = np.linalg.norm(points[:, :2], axis=1)
    assert np.allclose(np.hypot(ring - 8.0, points[:, 2]), 2.0, atol=1e-12)
    cosine = (ring - 8.0) / 2.0
    assert np.allclose(torus.gaussian(UV), cosine / (2.0 * ring), atol=1e-12)
    assert torus.closed == (False, True)


def test_tangents_are_differences_of_points():
    torus, step = quarter_torus(), 1e-6
    _, u, v = torus.tangents(UV)
    for axis, tangent in enumerate((u, v)):
        by = step * np.eye(2)[axis]
        assert np.allclose((torus.at(UV + by) - torus.at(UV - by)) / (2 * step), tangent, atol=1e-7)


def test_the_foot_of_a_point_on_a_normal_is_where_the_normal_starts():
    torus = quarter_torus()
    away = torus.at(UV) + 0.3 * torus.normals(UV)
    assert np.allclose(torus.foot(away, UV + 0.03), UV, atol=1e-9)


def test_points_that_have_arrived_take_no_further_steps(monkeypatch):
    torus, counts = quarter_torus(), []
    tangents = type(torus).tangents
    monkeypatch.setattr(type(torus), "tangents", lambda own, uv: (counts.append(len(uv)), tangents(own, uv))[1])
    found = torus.foot(torus.at(UV), np.vstack([UV[:1] + 0.03, UV[1:]]))
    assert np.allclose(found, UV, atol=1e-9)
    assert counts[0] == len(UV) and set(counts[2:]) == {1}


def test_a_fit_reaches_its_tolerance_and_keeps_the_plan():
    vertices, faces = mesh_over(lambda x, y: 0.5 * np.sin(0.5 * x) * np.cos(0.4 * y), 10.0, 8.0, 0.25)
    triangles = np.array(faces)[:, :3]
    fitted = fitted_surface(chart_of(vertices, triangles).to_local(vertices)[:, :2], vertices, 1e-3)
    assert fitted.deviation <= 1e-3
    plan = np.random.default_rng(2).uniform([0, 0], [10, 8], (50, 2))
    points = fitted.surface.at(plan)
    assert np.allclose(points[:, :2], plan, atol=1e-12)
    assert np.abs(points[:, 2] - 0.5 * np.sin(0.5 * plan[:, 0]) * np.cos(0.4 * plan[:, 1])).max() < 3e-3


def test_designs_survive_json(tmp_path):
    """A study keeps its design as JSON: every number, the supports, the units, and a mesh with its polygons."""
    nurbs_file(tmp_path / "roof.3dm", lambda x, y: 2.0 - 0.03 * (x - 6.0) ** 2 - 0.05 * (y - 4.0) ** 2, 12.0, 8.0)
    mesh = ([[0.0, 0.0, 0.0], [1.0, 0.0, 0.1], [1.0, 1.0, 0.3], [0.0, 1.0, 0.1], [2.0, 0.5, 0.0]], [[0, 1, 2, 3], [1, 4, 2]])
    for given in (given_design(str(tmp_path / "roof.3dm")), given_design(mesh)):
        again = design_from_dict(json.loads(json.dumps(design_to_dict(given))))
        assert design_to_dict(again) == design_to_dict(given)
        assert again.drawing == given.drawing and again.vertices.shape == given.vertices.shape
        if given.surface is not None:
            assert again.drawing.units == "Meters" and np.array_equal(again.surface.control, given.surface.control)
            assert np.array_equal(again.surface.at(again.surface.domain.T), given.surface.at(given.surface.domain.T))
