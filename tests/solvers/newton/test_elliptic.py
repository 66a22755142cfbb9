"""The parts of Newton's start: the bounded operator, its derivative, the membrane, and what is refused."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from compas_cgc.discrete import boundary_vertices
from compas_cgc.meshing.existence import overload
from compas_cgc.model.problem import CGCProblem
from compas_cgc.model.roles import CREASE
from compas_cgc.model.roles import FIXED
from compas_cgc.model.roles import INTERNAL
from compas_cgc.solvers.newton.elliptic import elliptic_steps
from compas_cgc.solvers.newton.elliptic import policy
from compas_cgc.solvers.newton.membrane import membrane
from compas_cgc.solvers.newton.system import System

from ...support import shapes

BOUND = 7.0
curvatures = st.floats(-30, 30)


def at(k1, k2):
    """Return the policy at principal curvatures k1 >= k2."""
    k1, k2 = max(k1, k2), min(k1, k2)
    return policy(np.array([(k1 + k2) / 2]), np.array([k1 * k2]), BOUND, np.array([1.0])), k1, k2


def smallest(k1, k2):
    """Return the minimum over 1/Λ <= a <= Λ of ½ (a k1 + k2 / a), by trying many."""
    a = np.exp(np.linspace(-math.log(BOUND), math.log(BOUND), 20_001))
    return float((0.5 * (a * k1 + k2 / a)).min())


@given(curvatures, curvatures)
def test_the_operator_is_the_smallest_of_its_policies(k1, k2):
    now, k1, k2 = at(k1, k2)
    if k1 + k2 > 0.01 and k1 - k2 > 0.01:
        assert now.value[0] == pytest.approx(smallest(k1, k2), rel=1e-4, abs=1e-4)


@given(st.floats(0.01, 30), st.floats(1.0, BOUND**2))
def test_on_convex_surfaces_it_is_the_root_of_K(k2, ratio):
    now, k1, k2 = at(k2 * ratio * 0.999, k2)
    assert now.value[0] == pytest.approx(math.sqrt(k1 * k2))
    assert now.of_laplacian[0] == 0.0


@given(curvatures, curvatures)
def test_its_derivative_is_elliptic(k1, k2):
    """Defects change by k2 ∂k1 + k1 ∂k2 and the Laplacian by ∂k1 + ∂k2; both parts of the sum must be positive."""
    now, k1, k2 = at(k1, k2)
    by_k1 = now.of_defect[0] * k2 + now.of_laplacian[0]
    by_k2 = now.of_defect[0] * k1 + now.of_laplacian[0]
    assert by_k1 > 0 and by_k2 > 0
    assert 1 / BOUND**2 - 1e-6 <= by_k1 / by_k2 <= BOUND**2 + 1e-6


@given(st.floats(0.1, 30), st.floats(-30, 30))
def test_its_derivative_is_that_of_its_value(k1, k2):
    now, k1, k2 = at(k1, k2)
    kink = abs(k2 * BOUND**2 - k1) < 0.1 or k1 - k2 < 0.1 or k1 + k2 < 0.1
    if not kink:
        h = 1e-6
        by_k1 = (at(k1 + h, k2)[0].value[0] - at(k1 - h, k2)[0].value[0]) / (2 * h)
        by_k2 = (at(k1, k2 + h)[0].value[0] - at(k1, k2 - h)[0].value[0]) / (2 * h)
        assert now.of_defect[0] * k2 + now.of_laplacian[0] == pytest.approx(by_k1, rel=1e-4, abs=1e-6)
        assert now.of_defect[0] * k1 + now.of_laplacian[0] == pytest.approx(by_k2, rel=1e-4, abs=1e-6)


def overload_of(system):
    problem = system.problem
    return overload(problem.vertices, problem.faces, problem.targets, problem.asked)


def system_of(mesh, target=1.0, roles=None):
    vertices, faces = mesh
    if roles is None:
        roles = np.where(boundary_vertices(vertices, faces), FIXED, INTERNAL)
    return System(CGCProblem(vertices, faces, roles, target), "superlu")


@pytest.mark.parametrize("n", [10, 40])
def test_the_elliptic_steps_make_a_flat_square_convex_in_a_few(n):
    system = system_of(shapes.grid(n))
    steps = list(elliptic_steps(system, system.measure(system.problem.vertices), 5.0))
    assert 3 <= len(steps) <= 8
    last = steps[-1].shape
    assert (last.mean > 0).all()
    assert np.median(np.abs(last.curvature - 1)) < 0.05


def test_the_first_step_from_flat_is_a_poisson_dome():
    system = system_of(shapes.delaunay_disk(2000))
    first = next(elliptic_steps(system, system.measure(system.problem.vertices), 5.0)).shape
    x, y, z = first.vertices.T
    assert np.abs(z - 0.5 * (1 - x**2 - y**2)).max() < 0.01


# ----------------------------------------------------------------------
# The membrane
# ----------------------------------------------------------------------


def test_a_membrane_in_a_plane_frame_is_plane_and_keeps_the_plan():
    vertices, faces = shapes.grid(10)
    noisy = vertices.copy()
    inner = ~boundary_vertices(vertices, faces)
    noisy[inner, 2] += np.random.default_rng(1).normal(size=inner.sum()) * 0.05
    assert np.abs(membrane(system_of((noisy, faces))) - vertices).max() < 1e-12


def test_a_membrane_over_a_folded_plan_has_no_folds():
    vertices, faces = shapes.delaunay_disk(200)
    inner = np.flatnonzero(~boundary_vertices(vertices, faces))
    folded = vertices.copy()
    folded[inner, :2] = np.random.default_rng(2).uniform(-0.5, 0.5, (len(inner), 2))
    flat = membrane(system_of((folded, faces)))
    u, v = flat[faces[:, 1]] - flat[faces[:, 0]], flat[faces[:, 2]] - flat[faces[:, 0]]
    assert (np.cross(u, v)[:, 2] > 0).all()


# ----------------------------------------------------------------------
# What is refused
# ----------------------------------------------------------------------


def test_over_a_disk_the_limit_is_that_of_the_half_sphere():
    vertices, faces = shapes.delaunay_disk(3000)
    assert overload_of(system_of((vertices, faces), 0.99)) is None
    found = overload_of(system_of((vertices, faces), 1.15))
    assert found is not None
    assert math.pi / found.area == pytest.approx(1.0, rel=0.1)
    assert math.pi / found.area >= 1.0


def test_the_limit_holds_per_region():
    """Two halves with a held crease between them carry more together than one whole."""
    vertices, faces = shapes.grid(20)
    edge = boundary_vertices(vertices, faces)
    assert overload_of(system_of((vertices, faces), 4.5)) is not None
    roles = np.where(edge, FIXED, np.where(np.abs(vertices[:, 0] - 0.5) < 1e-9, CREASE, INTERNAL))
    assert overload_of(system_of((vertices, faces), 4.5, roles)) is None
    targets = np.where(vertices[:, 0] < 0.5, 1.0, 9.0)
    found = overload_of(system_of((vertices, faces), targets, roles))
    assert found is not None
    assert found.curvature == pytest.approx(9.0)
    assert found.area == pytest.approx(0.5, rel=0.15)


def test_where_there_is_doubt_nothing_is_refused():
    vertices, faces = shapes.grid(20)
    x, y, _ = vertices.T
    edge = boundary_vertices(vertices, faces)
    arched = np.column_stack([x, y, 0.2 * x * (1 - x)])
    assert overload_of(system_of((arched, faces), 50.0)) is None
    oculus = np.hypot(x - 0.5, y - 0.5) < 0.2
    assert overload_of(system_of((vertices, faces), 50.0, np.where(edge | oculus, FIXED, INTERNAL))) is None
    crease_inside = (np.abs(y - 0.5) < 1e-9) & (np.abs(x - 0.5) < 0.2)
    assert overload_of(system_of((vertices, faces), 50.0, np.where(edge, FIXED, np.where(crease_inside, CREASE, INTERNAL)))) is None
    assert overload_of(system_of((vertices, faces), np.where(x < 0.5, 50.0, 0.0))) is None
    corner = (x > 0.5) & (y > 0.5)
    assert overload_of(system_of((vertices, faces), 50.0, np.where(edge | corner, FIXED, INTERNAL))) is None
    ball = shapes.icosphere(2)
    assert overload_of(system_of(ball, 50.0, np.zeros(len(ball[0]), int))) is None
