"""Every method against surfaces that are known, at rates that are known, and against another solver."""

from __future__ import annotations

import numpy as np
import pytest
from scipy import optimize

from compas_cgc import CGCProblem
from compas_cgc import FlowSettings
from compas_cgc import NewtonSettings
from compas_cgc.discrete.jacobian import CurvatureEquations
from compas_cgc.model.roles import FIXED
from compas_cgc.model.roles import FREE
from compas_cgc.model.roles import INTERNAL
from compas_cgc.paper.examples.plan import hexagonal_disk
from compas_cgc.solvers.registry import METHODS
from compas_cgc.solvers.running import run_method

from ..support import shapes


def flat_disk(rings, radius):
    faces, ring, place = hexagonal_disk(rings)
    angle = 2 * np.pi * place / np.maximum(1, 6 * ring)
    r = radius * ring / rings
    vertices = np.column_stack([r * np.cos(angle), r * np.sin(angle), np.zeros(len(r))])
    return CGCProblem(vertices, faces, np.where(ring == rings, FIXED, INTERNAL), 1.0)


@pytest.mark.parametrize("method", ["flow", "newton", "projection"])
def test_a_cap_over_a_circle_is_part_of_the_unit_sphere_with_an_error_like_h_squared(method):
    settings = FlowSettings(finish=True) if method == "flow" else None
    errors = []
    for rings in (4, 8, 16):
        problem = flat_disk(rings, 0.6)
        solution = run_method(METHODS[method], problem, settings=settings)
        assert solution.status == "converged", solution.message
        centre = np.array([0, 0, -0.8])
        errors.append(np.abs(np.linalg.norm(solution.vertices - centre, axis=1) - 1).max())
    rates = np.log2(np.array(errors[:-1]) / errors[1:])
    assert errors[-1] < 2e-3
    assert rates.min() > 1.6, f"distances from the sphere {errors}"


@pytest.mark.parametrize("method", ["newton", "projection"])
def test_a_dented_cone_becomes_straight_again(method):
    """Rows of vertices above each other: on the straight frustum every defect is zero to rounding."""
    rows, around = 9, 24
    t, j = (x.ravel() for x in np.meshgrid(np.linspace(0, 1, rows), np.arange(around), indexing="ij"))
    angle = 2 * np.pi * j / around

    def at(radius):
        return np.column_stack([radius * np.cos(angle), radius * np.sin(angle), 2.0 * t])

    _, faces = shapes.revolution(np.ones(rows), np.arange(rows), around)
    straight = 2.0 - t
    roles = np.where((t == 0) | (t == 1), FIXED, INTERNAL)
    problem = CGCProblem(at(straight - 0.1 * t * (1 - t)), faces, roles, 0.0)
    solution = run_method(METHODS[method], problem, settings=NewtonSettings(start="given") if method == "newton" else None)
    assert solution.status == "converged" and solution.max_error < 1e-12, solution.message
    radius = np.linalg.norm(solution.vertices[:, :2], axis=1)
    height = solution.vertices[:, 2]
    assert np.abs(radius - (2.0 - height / 2.0)).max() < 1e-7


def test_a_band_of_the_pseudosphere_is_found_from_a_dented_one():
    """K = -1 between a fixed rim and a free one: what comes out stays near the pseudosphere, nearer on finer meshes."""
    distances = []
    for n in (8, 16):
        u = np.linspace(0.5, 1.3, n)
        vertices, faces = shapes.revolution(1 / np.cosh(u), u - np.tanh(u), 6 * n)
        row = np.repeat(np.arange(n), 6 * n)
        wave = 0.01 * np.sin(np.pi * row / (n - 1))
        dented = vertices * np.column_stack([1 + wave, 1 + wave, np.ones(len(wave))])
        roles = np.where(row == 0, FIXED, np.where(row == n - 1, FREE, INTERNAL))
        solution = run_method(METHODS["projection"], CGCProblem(dented, faces, roles, -1.0))
        assert solution.status == "converged" and solution.max_error < 1e-11, solution.message
        distances.append(np.abs(solution.vertices - vertices).max())
    assert distances[0] < 0.05 and distances[1] < 0.05


def test_scipys_least_squares_finds_the_same_dome():
    """An independent solver, moving vertices up and down instead of along their normals."""
    vertices, faces = shapes.grid(10, 1.0)
    rim = (np.minimum(vertices[:, 0], vertices[:, 1]) == 0) | (np.maximum(vertices[:, 0], vertices[:, 1]) == 1)
    problem = CGCProblem(vertices, faces, np.where(rim, FIXED, INTERNAL), 1.0)
    inner = np.flatnonzero(problem.asked)
    equations = CurvatureEquations(faces, problem.targets, inner, inner)
    up = np.tile([0.0, 0.0, 1.0], (len(inner), 1))
    x, y = vertices[inner, :2].T

    def shape(z):
        moved = vertices.copy()
        moved[inner, 2] = z
        return moved

    start = 0.3 * np.sqrt(x * (1 - x) * y * (1 - y))
    options = dict(xtol=1e-15, ftol=1e-15, gtol=1e-15)
    found = optimize.least_squares(
        lambda z: equations.residual(shape(z)), start, lambda z: equations.jacobian(shape(z), up).toarray(), **options
    )
    assert np.abs(found.fun).max() < 1e-12
    ours = run_method(METHODS["newton"], problem)
    assert ours.vertices[:, 2].max() == pytest.approx(found.x.max(), rel=2e-3)
    # The same equations, so that solution is one for us too.
    assert run_method(METHODS["newton"], CGCProblem(shape(found.x), faces, problem.roles, 1.0)).iterations <= 1
