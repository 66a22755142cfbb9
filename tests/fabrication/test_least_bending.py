"""Moulds of least bending among the surfaces of revolution of one K."""

from __future__ import annotations

import numpy as np
import pytest

from compas_cgc import CGCProblem
from compas_cgc.fabrication import moulds
from compas_cgc.fabrication import panels
from compas_cgc.fabrication import space_form
from compas_cgc.fabrication.mould_patches import chart_of
from compas_cgc.fabrication.mould_surface import Surface
from compas_cgc.fabrication.revolved_mould import RevolvedMould

from ..support.constant_curvature import revolved_patch
from ..support.shapes import grid


@pytest.mark.parametrize(("K", "size"), [(0.01, 6.0), (0.01, 10.0), (0.01, 16.0), (-0.01, 5.0), (-0.01, 20.0)])
def test_moulds_about_an_equator_or_throat_are_isometric_to_the_space_form(K, size):
    mould = RevolvedMould(K, size)
    rng = np.random.default_rng(0)
    flat = rng.uniform(-1.5, 1.5, (60, 2))
    points, step = space_form.on_form(flat, K), 1e-5
    for way in np.eye(2):
        beside = space_form.on_form(flat + step * way, K)
        apart = space_form.geodesics(space_form.chords(points, beside, K), K)
        assert np.linalg.norm(mould.places(beside) - mould.places(points), axis=1) == pytest.approx(apart, rel=1e-9)
    # The second form of small triangles is that of the places: twice the height of the third corner over the tangent plane.
    pole = space_form.on_form(np.array([[[0.0, 0.0], [0.01, 0.0], [0.0, 0.01]]]).reshape(-1, 2), K)
    form = mould.second_forms(pole[None], None)[0, 0] / 1e-4
    assert form == pytest.approx(np.diag([K * size, 1.0 / size]), rel=1e-4, abs=1e-6)
    if size == 10.0:
        assert np.allclose(mould.places(points), Surface(K).places(points), atol=1e-12)
    chart = chart_of(mould)
    assert np.abs(chart.at(chart.of(mould.places(points))) - mould.places(points)).max() < 1e-12 * size


@pytest.mark.parametrize("K", [0.02, -0.02])
def test_panels_of_a_surface_of_revolution_hardly_bend_on_the_mould_of_least_bending(K):
    problem = CGCProblem(*revolved_patch(16, K, 6.0, 5.0, 1.0)).with_targets(K)
    own = panels(problem, count=1)
    usual = moulds(problem, own, rough=True)
    least = moulds(problem, own, least_bending=True, rough=True)
    assert usual.moulds[0].kind == ("sphere" if K > 0.0 else "pseudosphere") and usual.moulds[0].size is None
    assert least.moulds[0].kind == ("spindle" if K > 0.0 else "hyperboloid")
    assert least.moulds[0].size == pytest.approx(5.0, rel=0.03)
    assert least.stress_95 < 0.15 * usual.stress_95 and least.panels[0].rigid < 0.1 * usual.panels[0].rigid
    assert f"{1e3 * least.moulds[0].size:.0f} mm at its {'equator' if K > 0.0 else 'throat'}" in str(least)
    # Congruence does not depend on the mould.
    assert least.panels[0].gap == usual.panels[0].gap


def test_least_bending_keeps_the_sphere_for_a_sphere_and_the_plane_for_flat_panels():
    sphere = CGCProblem(*revolved_patch(12, 0.01, 6.0, 10.0, 0.6)).with_targets(0.01)
    assert moulds(sphere, panels(sphere, count=1), least_bending=True, rough=True).stress_95 < 1.0
    flat = CGCProblem(*grid(4)).with_targets(0.0)
    assert moulds(flat, panels(flat, count=1), least_bending=True, rough=True).moulds[0].kind == "plane"
