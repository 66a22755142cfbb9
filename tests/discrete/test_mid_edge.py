"""Shape operators by mid-edge normals: exact derivatives, closed forms, order of convergence, invariance."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.spatial import Delaunay

from compas_cgc.discrete.measured_curvature import measured_curvature
from compas_cgc.discrete.mid_edge import MidEdgeMesh

NO_CREASES = np.zeros((0, 2), int)


def _plan(n: int, jitter: float):
    """Return a triangulated unit square with a line of vertices at x = 1/2: regular, or irregular Delaunay."""
    i, j = np.divmod(np.arange((n + 1) ** 2), n + 1)
    xy = np.column_stack([i, j]) / n
    if not jitter:
        a = (np.arange(n)[:, None] * (n + 1) + np.arange(n)).ravel()
        return xy, np.vstack([np.column_stack([a, a + n + 1, a + n + 2]), np.column_stack([a, a + n + 2, a + 1])])
    inside = (i > 0) & (i < n) & (j > 0) & (j < n) & (2 * i != n)
    xy[inside] += jitter / n * np.random.default_rng(n).uniform(-1, 1, (inside.sum(), 2))
    F = Delaunay(xy).simplices.astype(np.int64)
    d, e = xy[F[:, 1]] - xy[F[:, 0]], xy[F[:, 2]] - xy[F[:, 0]]
    area = d[:, 0] * e[:, 1] - d[:, 1] * e[:, 0]
    F[area < 0] = F[area < 0][:, ::-1]
    return xy, F[np.abs(area) > 1e-9 / n**2]


def _creases(xy, F):
    edges = np.unique(np.sort(np.vstack([F[:, [0, 1]], F[:, [1, 2]], F[:, [2, 0]]]), axis=1), axis=0)
    return edges[(np.abs(xy[edges][:, :, 0] - 0.5) < 1e-9).all(axis=1)], (xy[F].mean(axis=1)[:, 0] > 0.5).astype(int)


def _sphere(x, y):
    x, y = x - 0.5, y - 0.5
    return np.sqrt(1.0 - x**2 - y**2), np.ones_like(x)


def _saddle(x, y):
    zx, zy = 1.2 * x + 0.4 * y, -1.6 * y + 0.4 * x
    return 0.6 * x**2 - 0.8 * y**2 + 0.4 * x * y, (-1.2 * 1.6 - 0.16) / (1 + zx**2 + zy**2) ** 2


def _torus(x, y):
    around = np.hypot(x - 0.2, y + 1.7)
    z = np.sqrt(1.0 - (around - 2.0) ** 2)
    return z, (around - 2.0) / around


@pytest.fixture
def mesh():
    xy, F = _plan(6, 0.3)
    rng = np.random.default_rng(1)
    V = np.column_stack([xy, 0.3 * np.sin(2 * xy[:, 0] + xy[:, 1])])
    creases, regions = _creases(xy, F)
    directions = 0.2 * rng.standard_normal(V.shape) + [0, 0, 1]
    own = MidEdgeMesh(F, creases, regions, directions)
    return own, V, 0.1 * rng.standard_normal(len(own.angles.ends)), rng


def _moved(own, V, angles, step):
    return own.at(V + step[: len(V), None] * own.directions, angles + step[len(V) :])


def test_first_derivatives_are_exact(mesh):
    own, V, angles, rng = mesh
    move, h = rng.standard_normal(own.unknowns), 1e-5
    there, back, here = _moved(own, V, angles, h * move), _moved(own, V, angles, -h * move), own.at(V, angles)
    change = np.einsum("mek,mk->me", here.tensor_slopes, move[own.columns])
    assert np.allclose((there.tensors - back.tensors) / (2 * h), change, atol=1e-6)
    assert np.allclose((there.areas - back.areas) / (2 * h), np.einsum("mk,mk->m", here.area_slopes, move[own.columns[:, :3]]), atol=1e-8)


def test_second_derivatives_are_exact(mesh):
    own, V, angles, rng = mesh
    move, h, m = rng.standard_normal(own.unknowns), 1e-5, len(own.faces)
    by_tensors, by_areas = rng.standard_normal((m, 6)), rng.standard_normal(m)

    def slopes(step):
        there = _moved(own, V, angles, step)
        found = np.einsum("me,mek->mk", by_tensors, there.tensor_slopes)
        found[:, :3] += by_areas[:, None] * there.area_slopes
        return found

    H = own.at(V, angles).second_derivatives(by_tensors, by_areas)
    change = (slopes(h * move) - slopes(-h * move)) / (2 * h)
    assert np.abs(change - np.einsum("mkl,ml->mk", H, move[own.columns])).max() < 1e-6 * np.abs(change).max()


def test_a_crease_edge_has_an_angle_on_each_side(mesh):
    own, V, angles, _ = mesh
    left, right = own.angles.folds.T
    assert len(left) == 6 and (own.angles.ends[left] == own.angles.ends[right]).all()
    moved = angles.copy()
    moved[left] += 0.1
    changed = np.abs(own.at(V, moved).tensors - own.at(V, angles).tensors).max(axis=1) > 1e-12
    assert changed.sum() == 6  # one triangle per edge, where an edge that does not fold turns the normals of two


def test_a_bent_strip_has_the_bending_of_a_cylinder():
    angle = np.linspace(0.0, 1.0, 41)
    t, y = np.meshgrid(angle, np.linspace(0, 1, 41), indexing="ij")
    V = np.column_stack([2 * np.sin(t.ravel()), y.ravel(), 2 * np.cos(t.ravel())])
    F = _plan(40, 0.0)[1]
    found = measured_curvature(V, F, NO_CREASES, np.zeros(len(F), int))
    # Area 2, curvature 1/2; convex to the side of its normals.
    assert found.bending.sum() == pytest.approx(2 * 0.5**2, rel=1e-3)
    assert np.allclose(found.mean, 0.25, rtol=1e-3) and np.abs(found.gaussian).max() < 1e-3


@pytest.mark.parametrize("jitter", [0.0, 0.3], ids=["regular", "delaunay"])
@pytest.mark.parametrize("surface", [_sphere, _saddle, _torus], ids=["sphere", "saddle", "torus"])
def test_measured_curvature_is_of_second_order_up_to_creases_and_free_edges(surface, jitter):
    errors = []
    for n in (16, 32, 64):
        xy, F = _plan(n, jitter)
        V = np.column_stack([xy, surface(*xy.T)[0]])
        creases, regions = _creases(xy, F)
        found = measured_curvature(V, F, creases, regions)
        own = MidEdgeMesh(F, creases, regions, np.zeros(V.shape))
        area = np.linalg.norm(np.cross(V[F[:, 1]] - V[F[:, 0]], V[F[:, 2]] - V[F[:, 0]]), axis=1)
        centroid = own.incidence @ (area[:, None] * xy[F].mean(axis=1)) / (own.incidence @ area)[:, None]
        error = np.abs(found.gaussian - surface(*centroid.T)[1])
        x, y = np.abs(xy[found.pairs[:, 0]] - 0.5).T
        corner = (np.minimum(x, 0.5 - x) < 1e-9) & (y > 0.5 - 1e-9)
        inside = (x > 1.5 / n) & (np.maximum(x, y) < 0.5 - 1.5 / n)
        edge = ~inside & ~corner
        errors.append([np.sqrt(np.mean(error[inside] ** 2)), np.sqrt(np.mean(error[edge] ** 2))])
    # Over two refinements, as irregular meshes of two sizes are no refinements of each other.
    order = 0.5 * np.log2(np.divide(errors[0], errors[2]))
    assert order[0] > 1.8 and order[1] > 1.5
    assert max(errors[2]) < 4e-3


def test_measured_curvature_does_not_depend_on_place_size_and_numbering():
    xy, F = _plan(8, 0.3)
    V = np.column_stack([xy, _saddle(*xy.T)[0]])
    creases, regions = _creases(xy, F)
    plain = measured_curvature(V, F, creases, regions)
    rng = np.random.default_rng(2)
    turn, order = np.linalg.qr(rng.standard_normal((3, 3)))[0], rng.permutation(len(V))
    turn *= np.sign(np.linalg.det(turn))
    moved = np.empty_like(V)
    moved[order] = 1000 * V @ turn + [5, -3, 2]
    faces = rng.permutation(len(F))
    found = measured_curvature(moved, np.roll(order[F], 1, axis=1)[faces], order[creases][:, ::-1], regions[faces])
    place = {tuple(pair): k for k, pair in enumerate(found.pairs.tolist())}
    at = [place[order[v], r] for v, r in plain.pairs.tolist()]
    assert np.abs(1e6 * found.gaussian[at] - plain.gaussian).max() < 1e-9
    assert np.abs(1e3 * found.mean[at] - plain.mean).max() < 1e-9


def test_a_triangle_without_area_is_left_out():
    xy, F = _plan(8, 0.0)
    V = np.column_stack([xy, _sphere(*xy.T)[0]])
    middle = 0.5 * (V[40] + V[41])
    # The edge between vertices 40 and 41 is split by a vertex in the straight line of both, on one side only.
    torn = np.vstack([V, middle])
    edge = np.flatnonzero((np.isin(F, [40, 41])).sum(axis=1) == 2)[0]
    own = F[edge]
    third = own[~np.isin(own, [40, 41])][0]
    a, b = own[(np.flatnonzero(own == third)[0] + 1) % 3], own[(np.flatnonzero(own == third)[0] + 2) % 3]
    faces = np.vstack([np.delete(F, edge, axis=0), [third, a, 81], [third, 81, b], [a, b, 81]])
    found = measured_curvature(torn, faces, NO_CREASES, np.zeros(len(faces), int))
    without = measured_curvature(torn, faces[:-1], NO_CREASES, np.zeros(len(faces) - 1, int))
    assert np.array_equal(found.gaussian, without.gaussian) and np.isfinite(found.gaussian).all()
    assert np.median(np.abs(found.gaussian - 1.0)) < 0.02
