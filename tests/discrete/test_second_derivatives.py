"""The exact second derivatives of angle defects."""

from __future__ import annotations

import numpy as np

from compas_cgc.discrete import boundary_vertices
from compas_cgc.discrete.curvature_hessian import CurvatureHessian
from compas_cgc.discrete.jacobian import CurvatureEquations

from ..support import shapes


def problem():
    vertices, faces = shapes.grid(6)
    rng = np.random.default_rng(2)
    vertices = vertices + 0.03 * rng.normal(size=vertices.shape)
    rows = np.flatnonzero(~boundary_vertices(vertices, faces))
    equations = CurvatureEquations(faces, np.zeros(len(vertices)), rows, np.arange(len(vertices)))
    return vertices, equations, rng.normal(size=len(rows)), rng.normal(size=vertices.shape), rng.normal(size=vertices.shape)


def test_they_are_the_derivative_of_the_first():
    vertices, equations, weights, move, _ = problem()
    h = 1e-5
    ahead, back = (equations.jacobian(vertices + s * h * move).T @ weights for s in (1, -1))
    difference = ((ahead - back) / (2 * h)).reshape(-1, 3)
    exact = equations.hessian(vertices, weights).along(move)
    assert np.abs(exact - difference).max() < 1e-7 * np.abs(exact).max()


def test_they_are_symmetric_and_blind_to_translations():
    vertices, equations, weights, one, other = problem()
    there, back = (np.sum(a * equations.hessian(vertices, weights).along(b)) for a, b in ((one, other), (other, one)))
    assert abs(there - back) < 1e-10 * abs(there)
    assert np.abs(equations.hessian(vertices, weights).along(np.ones_like(vertices))).max() < 1e-9


def test_the_matrix_is_the_derivative_of_the_first_with_areas_and_obtuse_faces():
    vertices, equations, weights, move, _ = problem()
    equations.targets = np.linspace(-3.0, 5.0, len(vertices))
    matrix = equations.second_derivative(vertices, weights)
    h = 1e-6
    ahead, back = (equations.jacobian(vertices + s * h * move).T @ weights for s in (1, -1))
    difference = (ahead - back) / (2 * h)
    assert np.abs(matrix @ move.ravel() - difference).max() < 1e-7 * np.abs(difference).max()
    assert np.abs(matrix - matrix.T).max() < 1e-12 * np.abs(matrix).max()


def test_products_and_matrix_say_the_same_and_faces_without_area_say_nothing():
    vertices, equations, weights, move, _ = problem()
    sound = equations.hessian(vertices, weights).along(move)
    assert np.abs(equations.second_derivative(vertices, weights) @ move.ravel() - sound.ravel()).max() < 1e-12 * np.abs(sound).max()
    doubled = np.vstack([equations.faces, [[8, 9, 9], [16, 9, 16]]])
    weighed = np.zeros(len(vertices))
    weighed[equations.rows] = weights
    assert np.array_equal(CurvatureHessian(vertices, doubled, weighed).along(move), sound)
