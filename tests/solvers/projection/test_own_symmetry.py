"""A drawing's own symmetry is found, and kept to rounding without being asked for."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from compas_cgc.discrete import boundary_vertices
from compas_cgc.model.constraints import Height
from compas_cgc.model.constraints import Mirror
from compas_cgc.model.constraints import OnPlane
from compas_cgc.model.goals.binding import bind
from compas_cgc.model.goals.inequalities import Clearance
from compas_cgc.model.goals.wholes import Rise
from compas_cgc.model.goals.wholes import Unknown
from compas_cgc.model.problem import CGCProblem
from compas_cgc.model.roles import FIXED
from compas_cgc.model.roles import FREE
from compas_cgc.model.roles import INTERNAL
from compas_cgc.solvers import reasons
from compas_cgc.solvers.projection import Projector
from compas_cgc.solvers.projection import project
from compas_cgc.solvers.projection.own_symmetry import own_symmetries
from compas_cgc.solvers.projection.symmetry import tears_faces

from ...support import shapes

N = 12
I, J = np.divmod(np.arange((N + 1) ** 2), N + 1)


def roof(target: float = 0.005, eightfold: bool = False) -> CGCProblem:
    """A square of 10 m on its corners; its diagonals run one way, or as symmetric as the square."""
    vertices, faces = shapes.grid(N, 10.0)
    if eightfold:
        quad = np.flatnonzero((I < N) & (J < N))
        a, b, c, d = quad, quad + N + 1, quad + N + 2, quad + 1
        turned = (I[quad] < N / 2) ^ (J[quad] < N / 2)
        even, odd = ([a, b, c], [a, c, d]), ([a, b, d], [b, c, d])
        faces = np.vstack([np.column_stack(k)[~turned] for k in even] + [np.column_stack(k)[turned] for k in odd])
    roles = np.where(boundary_vertices(vertices, faces), FREE, INTERNAL)
    roles[np.isin(I, (0, N)) & np.isin(J, (0, N))] = FIXED
    return CGCProblem(vertices, faces, roles, target)


def symmetries(problem: CGCProblem):
    local, _ = problem.local()
    return own_symmetries(local, bind(local))


def gaps(problem: CGCProblem, vertices: np.ndarray) -> list:
    local, frame = problem.local()
    x = frame.to_local(vertices)
    return [float(np.abs(x @ image.turn.T + image.shift - x[image.to]).max()) for image in own_symmetries(local, bind(local))]


def test_a_square_has_four_or_eight():
    assert len(symmetries(roof())) == 4 and len(symmetries(roof(eightfold=True))) == 8
    vertices, faces = shapes.delaunay_disk(200)
    rim = boundary_vertices(vertices, faces)
    assert len(symmetries(CGCProblem(vertices, faces, np.where(rim, FIXED, INTERNAL), 0.1))) == 1


def test_a_turned_and_moved_drawing_has_the_same():
    axis = np.array([1.0, 2.0, 3.0]) / np.sqrt(14)
    cross = np.cross(np.eye(3), axis)
    turn = np.eye(3) + np.sin(0.7) * cross + (1 - np.cos(0.7)) * cross @ cross
    problem = roof(eightfold=True)
    assert len(symmetries(problem.with_vertices(1e3 * problem.vertices @ turn.T + [1e4, 0, 5e3]))) == 8


@pytest.mark.parametrize(
    "change, left",
    [
        (lambda p: replace(p, roles=np.where((I == 0) & (J == N), FREE, p.roles)), 2),
        (lambda p: p.with_targets(np.where((I == 3) & (J == 6), 0.02, np.nan)), 2),
        (lambda p: p.with_goals([Height([5], 0.5)]), 1),
        (lambda p: p.with_goals([OnPlane(np.flatnonzero((I == 0) & (J > 0) & (J < N)), (0, 0, 0), (1, 0, 0))]), 2),
        (lambda p: p.with_goals([Clearance((4, -1, 6, 2), 0.5)]), 2),
        (lambda p: p.with_goals([Rise(2.0), Unknown()]), 8),
        (lambda p: p.with_creases([np.flatnonzero(I == 4).tolist()]), 2),
        (lambda p: p.with_vertices(p.vertices + 0.01 * (I == 3)[:, None] * (J == 2)[:, None]), 1),
    ],
    ids=["support", "target", "height", "plane", "gate", "rise", "crease", "vertex"],
)
def test_what_is_asked_counts(change, left):
    assert len(symmetries(change(roof(eightfold=True)))) == left


@pytest.mark.parametrize("target", [0.005, 0.02])
def test_a_dome_is_symmetric_to_rounding(target):
    for problem in (roof(target, eightfold=True), roof(target).with_goals([Rise(2.0), Unknown()])):
        solution = project(problem)
        assert solution.status == "converged" and solution.max_error < 1e-12
        assert max(gaps(problem, solution.vertices)) < 1e-13


def test_a_nearly_symmetric_surface_becomes_symmetric_and_meets_its_targets():
    problem = roof(eightfold=True)
    projector = Projector(problem)
    local = projector.posed(None, project(problem).vertices)
    noise = 1e-4 * np.random.default_rng(0).normal(size=local.vertices.shape) * local.asked[:, None]
    near = projector._system.at(local.vertices + noise, projector._system.equations(local.targets))
    found = projector._symmetric(near, local, 0.0)
    assert near.max_error > 1e-3 and found.max_error < 1e-11
    assert max(gaps(problem, projector.to_model(found.vertices))) < 1e-13


def test_a_saddle_keeps_what_it_has_and_is_not_flattened():
    problem = roof(-0.01, eightfold=True)
    solution = project(problem)
    assert solution.status == "converged" and np.ptp(solution.vertices[:, 2]) > 0.5
    lost = np.array(gaps(problem, solution.vertices)) > 1e-3
    kept = np.array(gaps(problem, solution.vertices)) < 1e-13
    assert (lost | kept).all() and kept.sum() == 4, "up along one diagonal, down along the other"


def test_a_mirrored_vault_does_not_stall():
    problem = roof(0.0, eightfold=True)
    x, y, _ = problem.vertices.T / 10
    arches = np.column_stack([10 * x, 10 * y, 12 * y * (1 - y) * (1 - 2.4 * x * (1 - x))])
    roles = np.where(np.isin(I, (0, N)), FIXED, np.where(np.isin(J, (0, N)), FREE, INTERNAL))
    vault = replace(problem.with_vertices(arches), roles=roles)
    alone = project(vault)
    mirrored = project(vault.with_goals([Mirror((5, 5, 0), (1, 0, 0))]))
    assert alone.status == mirrored.status == "converged"
    assert mirrored.iterations <= alone.iterations + 5
    assert max(gaps(vault, alone.vertices)) < 1e-12


def test_faces_that_are_not_mirrored_are_blamed():
    problem = roof(0.0)
    x, y, _ = problem.vertices.T / 10
    arches = np.column_stack([10 * x, 10 * y, 12 * y * (1 - y) * (1 - 2.4 * x * (1 - x))])
    roles = np.where(np.isin(I, (0, N)), FIXED, np.where(np.isin(J, (0, N)), FREE, INTERNAL))
    solution = project(replace(problem.with_vertices(arches), roles=roles, goals=(Mirror((5, 5, 0), (1, 0, 0)),)))
    assert solution.status == "converged" or "the vertices are mirror images of each other, but the faces are not" in solution.message


def twisted_vault(n: int, target: float) -> CGCProblem:
    """A vault on arches over an even mesh, whose diagonals all run one way: turning by half a turn keeps them, mirroring does not."""
    vertices, faces = shapes.grid(n, 10.0)
    y, across = vertices[:, 1] / 10, np.isin(np.divmod(np.arange((n + 1) ** 2), n + 1), (0, n))
    vertices[:, 2] = 12 * y * (1 - y)
    return CGCProblem(vertices, faces, np.where(across[0], FIXED, np.where(across[1], FREE, INTERNAL)), target)


@pytest.mark.parametrize("n, target", [(12, -0.02), (20, 0.005), (20, -0.005)])
def test_two_mirrors_over_diagonals_that_run_one_way_ask_for_k_once(n, target):
    problem = twisted_vault(n, target).with_goals([Mirror((5, 5, 0), (1, 0, 0)), Mirror((5, 5, 0), (0, 1, 0))])
    solution = project(problem)
    assert solution.status == "converged" and solution.iterations < 100, solution.message
    for axis in (0, 1):
        own = np.arange((n + 1) ** 2).reshape(n + 1, n + 1)
        image = np.flip(own, axis).ravel()
        flip = np.where(np.arange(3) == axis, -1.0, 1.0)
        assert np.abs((solution.vertices[image] - [5, 5, 0]) * flip - (solution.vertices - [5, 5, 0])).max() < 1e-12


@pytest.mark.parametrize("n, sag", [(16, 0.02), (16, 0.6), (20, 1.0)])
def test_a_mirrored_vault_that_was_drawn_sagging_is_a_cylinder(n, sag):
    """Straight lines span it, whichever way the diagonals run."""
    problem = twisted_vault(n, 0.0).with_goals([Mirror((5, 5, 0), (1, 0, 0)), Mirror((5, 5, 0), (0, 1, 0))])
    arches = problem.vertices
    drawn = arches * np.column_stack([np.ones((len(arches), 2)), 1.0 - sag * np.sin(np.pi * arches[:, 0] / 10)])
    solution = project(problem.with_vertices(drawn))
    assert solution.status == "converged" and solution.iterations < 50, solution.message
    assert np.abs(solution.vertices[:, 2] - 12 * solution.vertices[:, 1] / 10 * (1 - solution.vertices[:, 1] / 10)).max() < 0.05


def test_one_mirror_over_such_diagonals_is_helped_by_the_half_turn_that_keeps_them():
    problem = twisted_vault(20, -0.005).with_goals([Mirror((5, 5, 0), (0, 1, 0))])
    solution = project(problem)
    assert solution.status == "converged" and solution.max_error < 1e-12, solution.message


def test_a_stall_for_faces_that_are_not_mirrored_blames_the_mesh_alone(monkeypatch):
    """What the supports carry is not searched for then."""
    monkeypatch.setattr(reasons, "raised", None)
    problem = twisted_vault(12, -0.02).with_goals([Mirror((5, 5, 0), (0, 1, 0))])
    assert reasons.why_not_found(problem, "stalled", False) == ""
    assert not tears_faces(twisted_vault(12, 0.0)) and tears_faces(problem)
