"""Projection against closed forms, refinement, and independent solvers."""

from __future__ import annotations

import numpy as np
import pytest
from scipy import sparse
from scipy.integrate import quad
from scipy.optimize import brentq
from scipy.optimize import minimize
from scipy.sparse.linalg import spsolve

from compas_cgc.discrete import boundary_vertices
from compas_cgc.model.problem import CGCProblem
from compas_cgc.model.roles import FIXED
from compas_cgc.model.roles import FREE
from compas_cgc.model.roles import INTERNAL
from compas_cgc.solvers.projection import ProjectionSettings
from compas_cgc.solvers.projection import Projector
from compas_cgc.solvers.projection import project
from compas_cgc.solvers.projection.metric import bending_matrix

from ..solvers.projection.test_projection import irregular_disk
from ..support import shapes


def rates(errors) -> np.ndarray:
    """Return the exponents of h when every mesh is twice as fine as the one before."""
    return np.log2(np.array(errors[:-1]) / errors[1:])


def test_a_disk_with_a_fixed_rim_becomes_a_spherical_cap():
    errors = []
    for count in (150, 600, 2400):
        solution = project(irregular_disk(count, 1.0, radius=0.6))
        assert solution.status == "converged"
        distance = np.linalg.norm(solution.vertices + [0, 0, 0.8], axis=1) - 1.0
        errors.append(np.sqrt(np.mean(distance**2)))
    assert errors[-1] < 2e-5 and rates(errors).min() > 1.6


def test_a_waisted_ring_between_circles_becomes_a_cone():
    errors = []
    for k in (1, 2, 4):
        t = np.linspace(0, 1, 8 * k + 1)
        vertices, faces = shapes.revolution(3 - 1.5 * t - 1.2 * t * (1 - t), 3 * t, 24 * k)
        problem = CGCProblem(vertices, faces, np.where(boundary_vertices(vertices, faces), FIXED, INTERNAL), 0.0)
        solution = project(problem)
        assert solution.status == "converged"
        x, y, z = solution.vertices.T
        errors.append(np.abs(np.hypot(x, y) - (3 - 0.5 * z)).max())
    assert errors[0] < 2e-4 and rates(errors).min() > 1.8


@pytest.mark.nightly
def test_a_tube_between_equal_circles_becomes_the_hyperbolic_waist():
    """The surface of revolution with K = -1 and a waist: r = a cosh s, with the height that its two rims are apart."""

    def height(a):
        return 2 * quad(lambda s: np.sqrt(1 - (a * np.sinh(s)) ** 2), 0, np.arccosh(1 / a))[0]

    waist = brentq(lambda a: height(a) - 1.0, 0.75, 0.999)
    errors = []
    for k in (1, 2, 4):
        rows, around = 8 * k + 1, 24 * k
        vertices, faces = shapes.revolution(np.ones(rows), np.linspace(0, 1, rows), around)
        problem = CGCProblem(vertices, faces, np.where(boundary_vertices(vertices, faces), FIXED, INTERNAL), -1.0)
        solution = project(problem)
        assert solution.status == "converged"
        middle = solution.vertices[4 * k * around : (4 * k + 1) * around]
        errors.append(np.abs(np.hypot(middle[:, 0], middle[:, 1]) - waist).max())
    assert errors[0] < 0.02 and rates(errors).min() > 1.8


def test_a_pseudosphere_stays_one():
    """A mesh on the exact surface of K = -1 is moved only by what the mesh is coarse."""
    moves = []
    for k in (1, 2, 4):
        t = np.linspace(0.4, 1.2, 6 * k + 1)
        vertices, faces = shapes.revolution(1 / np.cosh(t), t - np.tanh(t), 24 * k)
        roles = np.full(len(vertices), INTERNAL)
        roles[: 24 * k], roles[-24 * k :] = FIXED, FREE
        solution = project(CGCProblem(vertices, faces, roles, -1.0))
        assert solution.status == "converged"
        moves.append(np.linalg.norm(solution.vertices - vertices, axis=1).max())
    assert moves[0] < 1e-3 and rates(moves).min() > 1.6


def canopy() -> CGCProblem:
    """A shaken shallow dome on four corners."""
    vertices, faces = shapes.grid(5)
    x, y = vertices[:, 0], vertices[:, 1]
    vertices[:, 2] = 0.125 * (2 - (2 * x - 1) ** 2 - (2 * y - 1) ** 2) + 0.02 * np.sin(7 * x + 3 * y)
    roles = np.where(boundary_vertices(vertices, faces), FREE, INTERNAL)
    roles[[0, 5, 30, 35]] = FIXED
    return CGCProblem(vertices, faces, roles, 1.0)


def test_the_surface_is_nearly_the_nearest_of_all():
    """The exact optimum, by sequential quadratic programming, costs hardly less."""
    projector = Projector(canopy(), settings=ProjectionSettings(keep="shape"))
    system, local, frame = projector._system, projector._local, projector._frame
    metric = sparse.kron(system.fairness.plan, sparse.eye(3)).tocsr()
    equations = system.equations(local.targets)
    start = local.vertices[system.columns].ravel()

    def shape(x):
        vertices = local.vertices.copy()
        vertices[system.columns] = x.reshape(-1, 3)
        return vertices

    def cost(x):
        return 0.5 * (x - start) @ (metric @ (x - start))

    best = minimize(
        cost,
        start,
        jac=lambda x: metric @ (x - start),
        constraints={
            "type": "eq",
            "fun": lambda x: equations.residual(shape(x)),
            "jac": lambda x: equations.jacobian(shape(x)).toarray(),
        },
        method="SLSQP",
        options={"maxiter": 200, "ftol": 1e-9},
    )
    assert best.success and np.abs(equations.residual(shape(best.x))).max() < 1e-8
    ours = frame.to_local(projector.solve().vertices)[system.columns].ravel()
    assert best.fun * (1 - 1e-6) <= cost(ours) < 1.15 * best.fun


@pytest.mark.parametrize("target", [1.0, 0.0, -1.0], ids=["elliptic", "parabolic", "hyperbolic"])
def test_a_step_is_the_solution_of_the_kkt_system(target):
    t = np.linspace(0, 1, 13)
    vertices, faces = shapes.revolution(1 + 0.5 * t, -0.6 * t**2, 40)
    roles = np.full(len(vertices), INTERNAL)
    roles[:40], roles[-40:] = FIXED, FREE
    projector = Projector(CGCProblem(vertices, faces, roles, target), settings=ProjectionSettings(keep="shape"))
    system, local = projector._system, projector._local
    equations = system.equations(local.targets)
    point = system.at(local.vertices, equations)
    J, metric = equations.jacobian(local.vertices), sparse.kron(system.fairness.plan, sparse.eye(3))
    kkt = (
        sparse.block_array([[metric, J.T], [J, None]]).tocsc()
        if hasattr(sparse, "block_array")
        else sparse.bmat([[metric, J.T], [J, None]]).tocsc()
    )
    exact = spsolve(kkt, np.concatenate([np.zeros(J.shape[1]), -point.residual]))[: J.shape[1]].reshape(-1, 3)
    step, _ = system.step(point, equations, 1e-11, None)
    assert np.allclose(step[system.columns], exact, rtol=0, atol=1e-8 * np.abs(exact).max())
    assert not step[np.setdiff1d(np.arange(len(step)), system.columns)].any()


def test_linear_moves_bend_nothing_and_creases_fold_for_less():
    vertices, faces = shapes.grid(8, 2.0)
    x, y, _ = vertices.T
    creases = x == 1.0
    bending = bending_matrix(vertices, faces, creases, 0.25)
    assert abs(bending - bending.T).max() == 0
    linear, fold, bend = 1 + 2 * x - 3 * y, np.abs(x - 1.0), x**2
    assert abs(linear @ bending @ linear) < 1e-9
    assert bend @ bending @ bend > 1
    stiff = bending_matrix(vertices, faces, np.zeros(len(vertices), bool), 1.0)
    across, wide = 0.25, 0.15 * 4.0 / (2.0 + 2.0)  # of the triangles beside the crease, and of a strip as soft as a crease of stiffness 1/2
    part = 0.25 * across / (0.25 * across + 0.75 * wide)
    assert fold @ bending @ fold == pytest.approx(part * (fold @ stiff @ fold))


@pytest.mark.parametrize(("stiffness", "limit"), [(0.1, 1 / 9), (0.5, 1.0), (0.8, 4.0)])
def test_a_fold_costs_the_same_on_finer_and_finer_meshes(stiffness, limit):
    """As a spring along the crease does: 3 s / (1 - s) times the square of its angle for a width of the sheet."""
    side, wide, costs = 2.0, 0.15, []
    for n in (16, 64, 128):
        vertices, faces = shapes.grid(n, side)
        fold = np.abs(vertices[:, 0] - 1.0) / 2.0  # the slope jumps by one
        costs.append(fold @ bending_matrix(vertices, faces, vertices[:, 0] == 1.0, stiffness) @ fold)
    spring = 3 * side * limit / wide
    assert 1 / np.array(costs) - 1 / spring == pytest.approx(side / np.array([16, 64, 128]) / (3 * side))
    free = bending_matrix(vertices, faces, vertices[:, 0] == 1.0, 0.0)
    assert fold @ free @ fold < 1e-9


def test_a_free_edge_turns_freely():
    """A quadratic bends evenly up to the free edges: its bending forces vanish inside."""
    vertices, faces = shapes.grid(10, 1.0)
    bending = bending_matrix(vertices, faces, np.zeros(len(vertices), bool), 1.0)
    force = bending @ (vertices[:, 0] ** 2)
    i, j = np.divmod(np.arange(len(vertices)), 11)
    deep = (np.minimum(i, j) > 1) & (np.maximum(i, j) < 9)
    assert np.abs(force[deep]).max() < 1e-9 < np.abs(force).max()
