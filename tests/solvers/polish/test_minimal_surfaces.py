"""Minimal surfaces: areas of Schwarz's and Scherk's patches, the branch of least area, and soap films over random curves."""

from __future__ import annotations

import numpy as np
import pytest
from scipy import sparse
from scipy.integrate import dblquad
from scipy.optimize import brentq
from scipy.sparse.linalg import splu

from compas_cgc.discrete import boundary_vertices
from compas_cgc.discrete import face_areas
from compas_cgc.discrete import vertex_normals
from compas_cgc.discrete.corners import corner_angles
from compas_cgc.model.problem import CGCProblem
from compas_cgc.solvers.polish.polisher import polish

from ...support.exact_surfaces import unit_square
from ...support.shapes import revolution

# Areas per cubic cell of Schwarz's P and D surfaces: 24 and 6 of these patches make a cell of edge 4 and 2.
AREA_P, AREA_D = 2.34510288, 1.91889236


def _between(corners):
    """Return the hyperbolic paraboloid (n, 3) over the unit square through four corners."""
    a, b, c, d = np.array(corners, dtype=np.float64)

    def at(uv):
        u, v = uv.T[:, :, None]
        return (1 - u) * (1 - v) * a + u * (1 - v) * b + u * v * c + (1 - u) * v * d

    return at


def _scherk(uv):
    """Return Scherk's first surface exp(z) cos x = cos y over a square of width 2, flat inside."""
    x, y = 2 * uv.T - 1
    rim = np.abs(2 * uv - 1).max(axis=1) > 1 - 1e-9
    return np.column_stack([x, y, np.where(rim, np.log(np.cos(y) / np.cos(x)), 0.0)])


PATCHES = {
    "Schwarz D": (_between([(0, 0, 0), (1, 0, 1), (1, 1, 0), (0, 1, 1)]), AREA_D * 2**2 / 6),
    "Schwarz P": (_between([(1, 1, 1), (2, 0, 1), (3, 1, 1), (2, 1, 0)]), AREA_P * 4**2 / 24),
    "Scherk": (_scherk, dblquad(lambda x, y: np.sqrt(1 + np.tan(x) ** 2 + np.tan(y) ** 2), -1, 1, -1, 1)[0]),
}


def _extrapolated(sizes, areas) -> float:
    """Return the limit of areas on three meshes whose error is a polynomial in the square of the edge length."""
    squares = 1.0 / np.array(sizes) ** 2
    return float(np.linalg.solve(np.column_stack([squares**0, squares, squares**2]), areas)[0])


@pytest.mark.parametrize("irregular", [False, pytest.param(True, marks=pytest.mark.nightly)], ids=["regular", "irregular"])
@pytest.mark.parametrize("name", PATCHES)
def test_known_areas(name, irregular):
    drawn, known = PATCHES[name]
    sizes, areas = (8, 16, 32), []
    for n in sizes:
        uv, faces = unit_square(n, irregular)
        solution = polish(CGCProblem(drawn(uv), faces).with_supports("boundary").with_laws("minimal"))
        assert solution.status == "converged"
        areas.append(float(face_areas(solution.vertices, faces).sum()))
    assert _extrapolated(sizes, areas) == pytest.approx(known, rel=1e-4)


@pytest.mark.parametrize("depth", [0.0, 0.75])
def test_between_two_rings_the_catenoid_of_less_area_is_found(depth):
    z = np.linspace(-0.5, 0.5, 13)
    V, F = revolution(1 - depth * (1 - 4 * z**2), z, 36)
    solution = polish(CGCProblem(V, F).with_supports("boundary").with_laws("minimal"))
    assert solution.status == "converged"
    # Of the two catenoids through both rings the one with the wider neck is stable.
    neck = brentq(lambda c: c * np.cosh(0.5 / c) - 1, 0.55, 0.99)
    assert np.hypot(*solution.vertices[:, :2].T).min() == pytest.approx(neck, abs=2e-3)


def _random_curve(seed: int, spatial: bool):
    """Return Coons's patch over a random closed curve with four corners: a graph over the unit square, or a curve in space."""
    rng = np.random.default_rng(seed)
    while True:
        at = _coons(rng, spatial)
        uv, faces = unit_square(16, False)
        # Curves that make triangles into needles are no test of the solver.
        if np.degrees(corner_angles(at(uv), faces).min()) > 10.0:
            return at


def _coons(rng, spatial: bool):
    corners = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0.0]]) + rng.normal(0, 0.12, (4, 3)) * [1, 1, 2]
    waves = rng.normal(0, 1, (4, 3, 3)) * np.array([0.10, 0.03, 0.01])[:, None] * ([1, 1, 1.5] if spatial else [0, 0, 2.0])
    if not spatial:
        corners[:, :2] = [[0, 0], [1, 0], [1, 1], [0, 1]]

    def side(k, t):
        straight = (1 - t)[:, None] * corners[k] + t[:, None] * corners[(k + 1) % 4]
        return straight + sum(np.sin(np.pi * (j + 1) * t)[:, None] * waves[k, j] for j in range(3))

    def at(uv):
        u, v = uv.T
        along = (1 - v)[:, None] * side(0, u) + v[:, None] * side(2, 1 - u)
        across = (1 - u)[:, None] * side(3, 1 - v) + u[:, None] * side(1, v)
        return along + across - _between(corners)(uv)

    return at


def _least_area(V, F, directions=None, steps=300):
    """Return the vertices of least area of the triangles, moving along directions or freely, by a fixed point of cotangent weights."""
    free, W, n = ~boundary_vertices(V, F), V.copy(), len(V)
    for _ in range(steps):
        rows, columns, values = [], [], []
        for k in range(3):
            i, j, o = F[:, (k + 1) % 3], F[:, (k + 2) % 3], F[:, k]
            a, b = W[i] - W[o], W[j] - W[o]
            cot = 0.5 * np.einsum("ij,ij->i", a, b) / np.linalg.norm(np.cross(a, b), axis=1)
            rows += [i, j, i, j]
            columns += [j, i, i, j]
            values += [-cot, -cot, cot, cot]
        L = sparse.csr_matrix((np.concatenate(values), (np.concatenate(rows), np.concatenate(columns))), (n, n))
        if directions is None:
            W[free] = splu(L[free][:, free].tocsc()).solve(-(L[free][:, ~free] @ W[~free]))
            continue
        along = sum(sparse.diags(d) @ L @ sparse.diags(d) for d in directions.T).tocsr()[free][:, free]
        step = splu(along.tocsc()).solve(-np.einsum("nx,nx->n", directions, L @ W)[free])
        W[free] += step[:, None] * directions[free]
        if np.abs(step).max() < 1e-9:
            break
    return W


@pytest.mark.nightly
@pytest.mark.timeout(600)
@pytest.mark.parametrize("seed", range(20))
def test_a_soap_film_over_a_random_curve_has_the_least_area(seed):
    sizes, ours, theirs = (16, 32, 64), [], []
    for n in sizes:
        uv, F = unit_square(n, False)
        V = _random_curve(seed, seed % 2 == 1)(uv)
        solution = polish(CGCProblem(V, F).with_supports("boundary").with_laws("minimal"))
        assert solution.status == "converged"
        ours.append(float(face_areas(solution.vertices, F).sum()))
        near = _least_area(V, F, steps=10) if seed % 2 == 1 else V
        least = _least_area(near, F, vertex_normals(near, F) if seed % 2 == 1 else np.tile([0.0, 0.0, 1.0], (len(V), 1)))
        theirs.append(float(face_areas(least, F).sum()))
    assert _extrapolated(sizes, ours) == pytest.approx(_extrapolated(sizes, theirs), rel=1e-5)
