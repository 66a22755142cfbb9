"""Angles of triangles of the sphere, the plane and the hyperbolic plane: closed forms, derivatives, limits."""

from __future__ import annotations

import numpy as np
import pytest

from compas_cgc.discrete import angle_defects
from compas_cgc.discrete import boundary_vertices
from compas_cgc.discrete import vertex_areas
from compas_cgc.discrete.jacobian import CurvatureEquations
from compas_cgc.discrete.space_form import circumradii
from compas_cgc.discrete.space_form import exact_equations
from compas_cgc.discrete.space_form import space_form_angle_sums

from ..support.shapes import icosphere
from .test_jacobian import bumpy_grid
from .test_jacobian import central_difference


def test_chords_of_a_sphere_close_on_it():
    vertices, faces = icosphere(3, radius=4.0)
    assert np.abs(space_form_angle_sums(vertices, faces, 1 / 16.0) - 2 * np.pi).max() < 1e-13


def test_arcs_are_what_chords_are_of():
    # Equilateral, six around a vertex: cos A = cos s / (1 + cos s) on the unit sphere, cosh for K = -1.
    angle = np.arange(6) * np.pi / 3
    side = 0.7
    vertices = np.vstack([np.zeros(3), side * np.column_stack([np.cos(angle), np.sin(angle), 0 * angle])])
    faces = np.array([[0, 1 + i, 1 + (i + 1) % 6] for i in range(6)])
    for K, cosine in ((1.0, np.cos(side)), (-1.0, np.cosh(side))):
        expected = 6 * np.arccos(cosine / (1 + cosine))
        assert space_form_angle_sums(vertices, faces, K, arc=True)[0] == pytest.approx(expected, abs=1e-14)
    chord = 2 * np.sin(side / 2)
    by_chords = space_form_angle_sums(vertices * chord / side, faces, 1.0)[0]
    assert by_chords == pytest.approx(space_form_angle_sums(vertices, faces, 1.0, arc=True)[0], abs=1e-14)


@pytest.mark.parametrize("arc, cell", [(False, "voronoi"), (True, "barycentric")])
def test_the_first_order_in_k_is_the_cell(arc, cell):
    vertices, faces = bumpy_grid(6, 0.45)
    inside = ~boundary_vertices(vertices, faces)
    K = 1e-6
    turned = (space_form_angle_sums(vertices, faces, K, arc) - space_form_angle_sums(vertices, faces, -K, arc)) / (2 * K)
    assert np.allclose(turned[inside], vertex_areas(vertices, faces, cell)[inside], rtol=1e-7)
    flat = 2 * np.pi - space_form_angle_sums(vertices, faces, 0.0, arc)
    assert np.allclose(flat[inside], angle_defects(vertices, faces)[inside], atol=1e-13)


@pytest.mark.parametrize("measure", ["exact", "exact-arc"])
@pytest.mark.parametrize("shear", [0.45, 1.4])
def test_the_derivative_agrees_with_differences_for_any_sign_of_k(measure, shear):
    vertices, faces = bumpy_grid(6, shear)
    vertices *= 0.3
    inside = np.flatnonzero(~boundary_vertices(vertices, faces))
    movable = np.flatnonzero(np.arange(len(vertices)) % 5 != 3)
    targets = np.linspace(-2, 1.5, len(vertices))
    targets[inside[3]] = 0.0
    equations = exact_equations(CurvatureEquations(faces, targets, inside, movable), measure)
    move = np.zeros_like(vertices)
    move[movable] = np.random.default_rng(0).normal(size=(len(movable), 3))
    expected = central_difference(equations.residual, vertices, move)
    assert np.allclose(equations.jacobian(vertices) @ move[movable].ravel(), expected, rtol=0, atol=2e-7)
    assert np.allclose(equations.jacobian(vertices, move[movable]) @ np.ones(len(movable)), expected, rtol=0, atol=2e-7)


def test_a_triangle_that_the_sphere_has_no_room_for_is_named():
    angle = np.arange(6) * np.pi / 3
    vertices = np.vstack([np.zeros(3), np.column_stack([np.cos(angle), np.sin(angle), 0 * angle])])
    faces = np.array([[0, 1 + i, 1 + (i + 1) % 6] for i in range(6)])
    assert np.allclose(circumradii(vertices, faces, 0.9), 0.9 / 3)
    fits, not_so = (exact_equations(CurvatureEquations(faces, np.full(7, K), [0], [0]), "exact") for K in (2.99, 3.01))
    assert fits.complaint(vertices) == ""
    assert not_so.complaint(vertices).startswith("the face ") and "too large" in not_so.complaint(vertices)
