"""Fitted polynomials as operators: consistent on irregular meshes, and differentiable."""

from __future__ import annotations

import numpy as np
from scipy.spatial import Delaunay

from compas_cgc.discrete import boundary_vertices
from compas_cgc.discrete import vertex_areas
from compas_cgc.discrete import vertex_normals
from compas_cgc.discrete.fit_operators import fit_operators


def _saddle(ripple: float = 0.0):
    rng = np.random.default_rng(3)
    xy = rng.uniform(-1, 1, (260, 2))
    F = Delaunay(xy).simplices.astype(np.int64)
    d, e = xy[F[:, 1]] - xy[F[:, 0]], xy[F[:, 2]] - xy[F[:, 0]]
    turned = d[:, 0] * e[:, 1] - d[:, 1] * e[:, 0] < 0
    F[turned] = F[turned][:, ::-1]
    x, y = xy.T
    V = np.column_stack([x, y, 0.3 * x * x - 0.4 * y * y + 0.05 * x**3 + ripple * rng.standard_normal(len(xy))])
    asked = ~boundary_vertices(V, F)
    return V, F, asked


def _operators(V, F, asked):
    rows = np.flatnonzero(asked)
    return fit_operators(V, F, rows, asked, vertex_areas(V, F)[rows])


def test_a_smooth_surface_has_no_waves_on_an_irregular_mesh_and_its_own_curvature():
    V, F, asked = _saddle()
    fits, rough = _operators(V, F, asked), _operators(*_saddle(0.03))
    waves = np.einsum("nx,nx->", V, fits.waves @ V)
    rippled = _saddle(0.03)[0]
    assert waves < 0.01 * np.einsum("nx,nx->", rippled, rough.waves @ rippled)
    x, y = V[asked, :2].T
    gaussian = (0.6 + 0.3 * x) * -0.8 / (1 + (0.6 * x + 0.15 * x * x) ** 2 + (0.8 * y) ** 2) ** 2
    away = np.abs(V[asked, :2]).max(axis=1) < 0.7
    assert np.median(np.abs(fits.gaussian - gaussian)[away]) < 0.01


def test_the_derivatives_of_the_curvature_are_those_of_moves_along_the_normals():
    V, F, asked = _saddle()
    fits = _operators(V, F, asked)
    move = 1e-6 * np.sin(2 * V[:, 0] + V[:, 1])
    moved = _operators(V + move[:, None] * vertex_normals(V, F), F, asked)
    change, told = moved.gaussian - fits.gaussian, fits.jacobian @ move
    away = np.abs(V[asked, :2]).max(axis=1) < 0.7
    # The frames turn with the surface, which the derivatives leave to the next round.
    assert np.linalg.norm((change - told)[away]) < 0.05 * np.linalg.norm(change[away])
