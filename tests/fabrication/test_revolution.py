"""Surfaces of revolution of constant curvature: K of their NURBS, and moulds and panels as exact surfaces."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.interpolate import BSpline
from scipy.spatial import cKDTree

from compas_cgc.errors import CGCError
from compas_cgc.fabrication.mould_patches import cap_patch
from compas_cgc.fabrication.mould_patches import cap_rim
from compas_cgc.fabrication.mould_patches import chart_of
from compas_cgc.fabrication.mould_patches import sheet_faces
from compas_cgc.fabrication.mould_surface import cap_mesh
from compas_cgc.fabrication.mould_surface import surface_for
from compas_cgc.fabrication.revolution import revolution
from compas_cgc.fabrication.revolved_mould import RevolvedMould

PARTS = (
    ("plane", 0.0, 0.0, (0.0, 2.0)),
    ("cylinder", 0.0, 3.0, (-1.0, 1.0)),
    ("cone", 0.0, 0.5, (1.0, 4.0)),
    ("sphere", 0.04, 0.0, (1.0, 7.5)),
    ("spindle", 0.04, 3.0, (-5.0, 5.0)),
    ("bulge", 0.04, 8.0, (-2.5, 2.5)),
    ("pseudosphere", -0.04, 0.0, (0.5, 4.0)),
    ("hyperboloid", -0.04, 3.0, (-5.0, 5.0)),
    ("conic", -0.04, 0.4, (0.5, 6.0)),
)


def curvatures(patch, n=40):
    """Return K on a grid of a NURBS surface, by its exact derivatives."""
    u, v = (np.linspace(knots[0], knots[-1], n + 2)[1:-1] for knots in patch.knots)

    def derivative(i, j):
        along = BSpline(patch.knots[0], patch.control, patch.degrees[0])(u, nu=i)
        return np.swapaxes(BSpline(patch.knots[1], np.swapaxes(along, 0, 1), patch.degrees[1])(v, nu=j), 0, 1)

    d = {(i, j): derivative(i, j) for i in range(3) for j in range(3 - i)}
    w = {order: own[..., 3:] for order, own in d.items()}
    p = d[0, 0][..., :3] / w[0, 0]
    pu, pv = ((d[o][..., :3] - w[o] * p) / w[0, 0] for o in ((1, 0), (0, 1)))
    puu = (d[2, 0][..., :3] - 2 * w[1, 0] * pu - w[2, 0] * p) / w[0, 0]
    pvv = (d[0, 2][..., :3] - 2 * w[0, 1] * pv - w[0, 2] * p) / w[0, 0]
    puv = (d[1, 1][..., :3] - w[1, 0] * pv - w[0, 1] * pu - w[1, 1] * p) / w[0, 0]
    normal = np.cross(pu, pv)
    e, f, g = ((own * normal).sum(axis=-1) for own in (puu, puv, pvv))
    return (e * g - f * f) / (normal**2).sum(axis=-1) ** 2


@pytest.mark.parametrize(("kind", "K", "size", "ends"), PARTS, ids=[part[0] for part in PARTS])
def test_each_type_has_its_curvature(kind, K, size, ends):
    patch = revolution(kind, K, size).patch(ends, (-1.0, 2.0), 1e-7)
    exact = kind in ("plane", "cylinder", "cone", "sphere")
    assert np.abs(curvatures(patch) - K).max() < (1e-12 if exact else 1e-4)
    assert (patch.degrees[0] == 5) != exact


@pytest.mark.parametrize(("kind", "K", "size", "ends"), PARTS, ids=[part[0] for part in PARTS])
def test_meridians_are_within_a_micrometre_of_the_solution_of_their_equation(kind, K, size, ends):
    own = revolution(kind, K, size)

    def rates(s, y):
        return [y[1], -K * y[0], np.sqrt(max(1.0 - y[1] ** 2, 0.0))]

    start = [own.radii(np.array(ends[:1]))[0], own.slopes(np.array(ends[:1]))[0], 0.0]
    exact = solve_ivp(rates, ends, start, rtol=1e-12, atol=1e-13, dense_output=True).sol
    patch = own.patch(ends, (-1.0, 2.0), 1e-6)
    u = np.linspace(patch.knots[0][0], patch.knots[0][-1], 301)
    points = patch.at(u, np.array([0.0, 1.0]))
    r, z = np.hypot(points[..., 0], points[..., 1]), points[..., 2]
    # The parameters of exact conics are not arc lengths, so the nearest points are sought by Newton's method.
    s = np.repeat(np.linspace(*ends, 301)[:, None], 2, axis=1)
    for _ in range(20):
        y = exact(s.ravel()).reshape(3, *s.shape)
        rise = np.sqrt(np.maximum(1.0 - y[1] ** 2, 0.0))
        s = np.clip(s + (r - y[0]) * y[1] + (z - y[2]) * rise, *ends)
    y = exact(s.ravel()).reshape(3, *s.shape)
    assert np.hypot(r - y[0], z - y[2]).max() <= 1e-6, "metres"


def test_pseudosphere_agrees_with_its_closed_form():
    own = revolution("pseudosphere", -0.25)
    s = np.linspace(0.2, 5.0, 30)
    closed = 2.0 * (np.arccosh(np.exp(s / 2)) - np.sqrt(1.0 - np.exp(-s)))
    assert np.allclose(own.heights(s), closed - closed[0], atol=1e-9)


def test_invalid_surfaces_are_refused():
    for kind, K, size, text in (
        ("torus", 1.0, 1.0, "no surface of revolution"),
        ("sphere", -1.0, 0.0, "needs K > 0"),
        ("spindle", 1.0, 2.0, "is a bulge"),
        ("cone", 0.0, 1.5, "between 0 and 1"),
        ("hyperboloid", -1.0, -2.0, "must be positive"),
    ):
        with pytest.raises(CGCError, match=text):
            revolution(kind, K, size)
    with pytest.raises(CGCError, match="does not extend"):
        revolution("bulge", 1.0, 2.0).patch((-1.0, 1.0), (0.0, 1.0), 1e-6)


@pytest.mark.parametrize("K", [0.04, 0.0, -0.04])
def test_caps_of_moulds_are_exact(K):
    surface = surface_for(K, 1.5)
    chart = chart_of(surface)
    vertices, _ = cap_mesh(surface, 1.5)
    assert np.abs(chart.at(chart.of(vertices)) - vertices).max() < 1e-13
    for patch in (cap_patch(surface, 1.5), chart.patch(chart.of(vertices))):
        grid = patch.at(*(np.linspace(knots[0], knots[-1], 60) for knots in patch.knots)).reshape(-1, 3)
        # Metres: spheres are exact, pseudospheres within 1e-3 mm.
        assert np.abs(chart.at(chart.of(grid)) - grid).max() < (1e-13 if K >= 0.0 else 1e-6)
        assert np.abs(curvatures(patch) - K).max() < 1e-4
    if K > 0.0:
        centre = np.array([0.0, 0.0, -5.0])
        grid = cap_patch(surface, 1.5).at(*(np.linspace(knots[0], knots[-1], 60) for knots in cap_patch(surface, 1.5).knots))
        assert np.abs(np.linalg.norm(grid - centre, axis=-1) / 5.0 - 1.0).max() < 1e-9


@pytest.mark.parametrize(
    "surface",
    [surface_for(0.04, 1.5), surface_for(0.0, 1.5), surface_for(-0.04, 1.5), RevolvedMould(0.04, 3.0), RevolvedMould(-0.04, 3.0)],
    ids=["sphere", "plane", "pseudosphere", "spindle", "hyperboloid"],
)
def test_faces_of_sheets_lie_half_a_thickness_beside_the_mould(surface):
    """Every point of a face is that far from the point of the mould with the same parameters, along the normals of both there."""
    middle = cap_patch(surface, 1.5)
    assert sheet_faces(surface, 1.5, 0.2) == {"lower": -0.1, "upper": 0.1}
    u, v = (np.linspace(knots[0], knots[-1], 40)[1:-1] for knots in middle.knots)
    step = 1e-5
    along, across = (middle.at(u + step, v) - middle.at(u - step, v), middle.at(u, v + step) - middle.at(u, v - step))
    normals = np.cross(along, across)
    normals = normals / np.linalg.norm(normals, axis=-1, keepdims=True)
    upright = normals * np.sign(normals[..., 2:])
    for offset in (-0.1, 0.1):
        face = cap_patch(surface, 1.5, offset)
        # Pseudospheres are splines, which are refined until they are within 1e-8 of the radius of curvature.
        assert np.abs(face.at(u, v) - middle.at(u, v) - offset * upright).max() < 1e-6
        rim = cap_rim(surface, 1.5, offset)
        nearest = cKDTree(cap_rim(surface, 1.5)).query(rim)[0]
        assert np.abs(nearest - 0.1).max() < 1e-9


def test_sheets_thicker_than_a_radius_of_curvature_have_one_face():
    sizes = sheet_faces(RevolvedMould(-0.04, 0.5), 0.1, 1.2)
    assert list(sizes) == ["upper"] and sheet_faces(surface_for(0.04, 1.5), 1.5, 12.0) == {"upper": 6.0}
