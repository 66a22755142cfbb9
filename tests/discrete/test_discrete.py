"""The discrete measures against closed forms, Gauss-Bonnet, libigl and numerical derivatives."""

from __future__ import annotations

import igl
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from compas_cgc.discrete import MeshError
from compas_cgc.discrete import angle_defects
from compas_cgc.discrete import boundary_vertices
from compas_cgc.discrete import edge_faces
from compas_cgc.discrete import enclosed_volume
from compas_cgc.discrete import energy
from compas_cgc.discrete import energy_gradient
from compas_cgc.discrete import face_areas
from compas_cgc.discrete import face_normals
from compas_cgc.discrete import gaussian_curvature
from compas_cgc.discrete import mean_curvature
from compas_cgc.discrete import total_mean_curvature
from compas_cgc.discrete import vertex_areas
from compas_cgc.discrete import vertex_normals
from compas_cgc.discrete.extent import diameter

from ..support import shapes


def wavy(n=8, seed=0, height=0.3):
    vertices, faces = shapes.grid(n)
    vertices[:, 2] = height / n * np.random.default_rng(seed).normal(size=len(vertices))
    return vertices, faces


CLOSED = {"sphere": (shapes.icosphere(2), 0), "torus": (shapes.torus(), 1), "double torus": (shapes.double_torus(), 2)}


@pytest.mark.parametrize("name", CLOSED)
def test_gauss_bonnet_on_closed_surfaces_of_every_genus(name):
    (vertices, faces), genus = CLOSED[name]
    assert angle_defects(vertices, faces).sum() == pytest.approx(2 * np.pi * (2 - 2 * genus), abs=1e-10)


@pytest.mark.parametrize("mesh, euler", [(wavy(), 1), (shapes.revolution([1, 1.2, 1.1], [0, 1, 2], 11), 0)])
def test_gauss_bonnet_with_boundary(mesh, euler):
    assert angle_defects(*mesh).sum() == pytest.approx(2 * np.pi * euler, abs=1e-10)


def test_octahedron_by_hand():
    vertices = np.array([[1, 0, 0], [-1, 0, 0], [0, 1, 0], [0, -1, 0], [0, 0, 1], [0, 0, -1]], float)
    faces = [[0, 2, 4], [2, 1, 4], [1, 3, 4], [3, 0, 4], [2, 0, 5], [1, 2, 5], [3, 1, 5], [0, 3, 5]]
    assert angle_defects(vertices, faces) == pytest.approx(np.full(6, 2 * np.pi / 3), abs=4e-15)
    assert enclosed_volume(vertices, faces) == pytest.approx(4 / 3, rel=1e-15)
    assert face_areas(vertices, faces) == pytest.approx(np.full(8, 3**0.5 / 2), rel=1e-15)
    fold = np.arccos(1 / 3)
    assert total_mean_curvature(vertices, faces) == pytest.approx(0.5 * 12 * 2**0.5 * fold, rel=1e-14)
    assert vertex_normals(vertices, faces) == pytest.approx(vertices, abs=1e-15)
    for kind in ("mixed", "voronoi", "barycentric"):
        assert vertex_areas(vertices, faces, kind) == pytest.approx(np.full(6, 2 / 3**0.5), rel=1e-14)


@pytest.mark.parametrize("profile", ["cylinder", "cone"])
def test_cylinder_and_cone_are_flat_to_rounding(profile):
    height = np.linspace(0, 2, 9)
    radius = np.full(9, 0.7) if profile == "cylinder" else 1.5 - 0.4 * height
    if profile == "cone":
        # A straight-edged frustum: every row shares its angles, so the faces unroll onto a plane fan.
        vertices, faces = shapes.revolution(radius, height, 40)
        radial = np.arange(len(vertices)) // 40
        angle = 2 * np.pi * (np.arange(len(vertices)) % 40) / 40
        vertices = np.column_stack([radius[radial] * np.cos(angle), radius[radial] * np.sin(angle), height[radial]])
    else:
        vertices, faces = shapes.revolution(radius, height, 40)
    inner = ~boundary_vertices(vertices, faces)
    assert np.abs(angle_defects(vertices, faces)[inner]).max() < 1e-13


def test_sphere_converges_at_second_order():
    errors = []
    for level in (2, 3, 4):
        vertices, faces = shapes.icosphere(level, radius=2.0)
        area = vertex_areas(vertices, faces)
        # The mean over the surface: pointwise the defect converges at regular vertices only.
        errors.append(abs(np.sum(gaussian_curvature(vertices, faces) * area) / area.sum() - 0.25))
        assert enclosed_volume(vertices, faces) == pytest.approx(32 / 3 * np.pi, rel=0.4 / 4**level * 4)
        assert total_mean_curvature(vertices, faces) == pytest.approx(8 * np.pi, rel=0.3 / 4**level)
        assert total_mean_curvature(vertices, faces, "cotangent") == pytest.approx(8 * np.pi, rel=2.0 / 4**level)
        assert mean_curvature(vertices, faces) == pytest.approx(np.full(len(vertices), 0.5), rel=2e-2)
    rates = np.log2(np.array(errors[:-1]) / errors[1:])
    assert rates == pytest.approx([2, 2], abs=0.1)


def test_pseudosphere_converges_to_minus_one():
    errors = []
    for n in (20, 40, 80):
        u = np.linspace(0.4, 1.4, n)
        vertices, faces = shapes.revolution(1 / np.cosh(u), u - np.tanh(u), 4 * n)
        inner = ~boundary_vertices(vertices, faces)
        assert np.abs(gaussian_curvature(vertices, faces)[inner] + 1).max() < 0.4 / n
        errors.append(abs(angle_defects(vertices, faces)[inner].sum() / vertex_areas(vertices, faces)[inner].sum() + 1))
    assert np.log2(np.array(errors[:-1]) / errors[1:]) == pytest.approx([2, 2], abs=0.3)


def test_mean_curvature_is_positive_on_convex_surfaces_only():
    vertices, faces = shapes.icosphere(2)
    assert (mean_curvature(vertices, faces) > 0).all()
    assert (mean_curvature(vertices, np.asarray(faces)[:, ::-1]) < 0).all()
    assert total_mean_curvature(vertices, np.asarray(faces)[:, ::-1]) < 0


def acute(seed):
    vertices, faces = shapes.icosphere(2)
    rng = np.random.default_rng(seed)
    return vertices * (1 + 0.2 * rng.random(3)) * (1 + 0.002 * rng.normal(size=(len(vertices), 1))), faces


@pytest.mark.parametrize("seed", range(3))
def test_agrees_with_libigl_on_acute_meshes(seed):
    vertices, faces = acute(seed)
    area = igl.massmatrix(vertices, faces, igl.MASSMATRIX_TYPE_VORONOI).diagonal()
    K = igl.gaussian_curvature(vertices, faces) / area
    assert np.abs(gaussian_curvature(vertices, faces) / K - 1).max() < 1e-12
    assert vertex_areas(vertices, faces, "barycentric") == pytest.approx(
        igl.massmatrix(vertices, faces, igl.MASSMATRIX_TYPE_BARYCENTRIC).diagonal(), rel=1e-13
    )


def test_mixed_areas_agree_with_libigl_on_obtuse_meshes_too():
    vertices, faces = wavy(12, seed=3, height=1.5)
    area = igl.massmatrix(vertices, faces, igl.MASSMATRIX_TYPE_VORONOI).diagonal()
    assert vertex_areas(vertices, faces) == pytest.approx(area, rel=1e-12)
    assert face_normals(vertices, faces) == pytest.approx(igl.per_face_normals(vertices, faces, np.zeros(3)), abs=1e-13)


@pytest.mark.parametrize("kind", ["mixed", "voronoi", "barycentric"])
def test_cells_of_every_kind_add_up_to_the_area(kind):
    vertices, faces = wavy(10, seed=1, height=2.0)
    area = vertex_areas(vertices, faces, kind)
    assert area.sum() == pytest.approx(face_areas(vertices, faces).sum(), rel=1e-13)
    if kind != "voronoi":
        assert (area > 0).all()


def numerical_gradient(function, vertices, step=1e-6):
    gradient = np.zeros_like(vertices)
    for at in np.ndindex(*vertices.shape):
        ahead, behind = vertices.copy(), vertices.copy()
        ahead[at] += step
        behind[at] -= step
        gradient[at] = (function(ahead) - function(behind)) / (2 * step)
    return gradient


@pytest.mark.parametrize("regions", [1, 2, 5])
def test_gradient_of_the_energy_is_exact_at_every_vertex(regions):
    vertices, faces = wavy(6, seed=regions, height=0.8)
    targets = np.random.default_rng(regions).normal(size=regions)[np.arange(len(faces)) % regions]
    gradient = energy_gradient(vertices, faces, targets)
    expected = numerical_gradient(lambda v: energy(v, faces, targets), vertices)
    assert np.abs(gradient - expected).max() < 1e-6 * max(1.0, np.abs(expected).max())


def test_gradient_of_the_energy_on_a_closed_surface_is_schlaeflis():
    vertices, faces = shapes.icosphere(1)
    vertices = vertices * [1.0, 0.8, 1.3]
    gradient = energy_gradient(vertices, faces, 0.7)
    expected = numerical_gradient(lambda v: energy(v, faces, 0.7), vertices)
    assert np.abs(gradient - expected).max() < 1e-7


def test_energy_gradient_is_curvature_error_times_area_along_the_normal():
    vertices, faces = shapes.icosphere(4, radius=2.0)
    gradient = energy_gradient(vertices, faces, 0.1)
    expected = ((0.25 - 0.1) * vertex_areas(vertices, faces))[:, None] * vertex_normals(vertices, faces)
    assert np.linalg.norm(gradient - expected) < 0.02 * np.linalg.norm(expected)


def test_the_diameter_of_a_rectangle_is_its_diagonal_however_it_is_turned():
    x, y = np.meshgrid(np.linspace(0.0, 4.0, 9), np.linspace(0.0, 3.0, 7))
    points = np.column_stack([x.ravel(), y.ravel(), np.zeros(x.size)])
    for turn in Rotation.random(5, random_state=1).as_matrix():
        assert diameter(points @ turn.T + [7.0, -2.0, 1.0]) == pytest.approx(5.0, rel=1e-14)


def test_volume_of_a_closed_mesh_does_not_depend_on_the_origin():
    vertices, faces = shapes.torus()
    assert enclosed_volume(vertices + [3, -7, 11], faces) == pytest.approx(enclosed_volume(vertices, faces), rel=1e-12)


@given(seed=st.integers(0, 1000), scale=st.floats(1e-3, 1e4), shift=st.floats(-10, 10))
def test_measures_do_not_depend_on_place_size_or_numbering(seed, scale, shift):
    rng = np.random.default_rng(seed)
    vertices, faces = wavy(6, seed)
    order = rng.permutation(len(vertices))
    place = np.argsort(order)
    turned = Rotation.random(random_state=rng).apply(vertices) * scale + shift * scale
    K = gaussian_curvature(vertices, faces)
    L = gaussian_curvature(turned[order], rng.permutation(place[faces]))[place]
    assert np.array_equal(np.isnan(K), np.isnan(L))
    assert np.nanmax(np.abs(L * scale**2 - K)) < 1e-9 * np.nanmax(np.abs(K))
    assert total_mean_curvature(turned, faces) == pytest.approx(scale * total_mean_curvature(vertices, faces), rel=1e-9, abs=1e-9 * scale)


@given(seed=st.integers(0, 200))
def test_boundary_without_sorting_is_the_boundary_of_the_edges(seed):
    rng = np.random.default_rng(seed)
    vertices, faces = shapes.delaunay_disk(60, seed)
    faces = faces[rng.random(len(faces)) > 0.1]
    edges = edge_faces(faces)
    expected = np.zeros(len(vertices), bool)
    expected[edges[edges[:, 3] < 0, :2]] = True
    assert np.array_equal(boundary_vertices(vertices, faces), expected)


def test_curvature_is_nan_where_it_is_not_defined():
    vertices, faces = wavy()
    vertices = np.vstack([vertices, [[9, 9, 9]]])
    K = gaussian_curvature(vertices, faces)
    assert np.isnan(K[boundary_vertices(vertices, faces)]).all() and np.isnan(K[-1])
    assert np.isfinite(K[~boundary_vertices(vertices, faces)][:-1]).all()
    assert angle_defects(vertices, faces)[-1] == 0


def test_same_input_same_bits():
    vertices, faces = wavy(20)
    assert np.array_equal(gaussian_curvature(vertices, faces), gaussian_curvature(vertices.copy(), faces.copy()), equal_nan=True)


BAD = [
    ([[0, 0], [1, 0], [0, 1]], [[0, 1, 2]], r"shape \(n, 3\)"),
    ([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 3]], "face 0 names a vertex that does not exist"),
    ([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2, 2]], "triangulate"),
    ([[0, 0, 0], [1, 0, 0], [0, np.nan, 0]], [[0, 1, 2]], "vertex 2 has a coordinate"),
    ([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0.0, 1.0, 2.5]], "integers"),
    ([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2], [0, 1]], "arrays of numbers"),
]


@pytest.mark.parametrize("vertices, faces, words", BAD)
def test_bad_arrays_are_refused_in_words(vertices, faces, words):
    with pytest.raises(MeshError, match=words):
        gaussian_curvature(vertices, faces)


def test_unknown_kinds_are_refused_in_words():
    with pytest.raises(ValueError, match="mixed, voronoi, barycentric"):
        vertex_areas(*wavy(), kind="area")
    with pytest.raises(ValueError, match="steiner"):
        total_mean_curvature(*wavy(), kind="x")


def test_edges_of_a_non_manifold_mesh_are_refused():
    with pytest.raises(MeshError, match="not an oriented manifold"):
        edge_faces([[0, 1, 2], [0, 1, 3], [1, 0, 4]])
