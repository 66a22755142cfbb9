"""A problem is asked for more by methods that return a new one; what is wrong is refused in a sentence."""

from __future__ import annotations

import numpy as np
import pytest

from compas_cgc import CGCMesh
from compas_cgc import CGCProblem
from compas_cgc import Height
from compas_cgc import MeshError
from compas_cgc import ProblemError
from compas_cgc.model.problem import Names
from compas_cgc.model.roles import CREASE
from compas_cgc.model.roles import FIXED
from compas_cgc.model.roles import FREE

from ..support import shapes

N = 6


def plan() -> CGCProblem:
    return CGCProblem(*shapes.grid(N))


def row(k: int) -> list:
    return [k * (N + 1) + j for j in range(N + 1)]


def test_a_new_problem_knows_its_edges_and_nothing_more():
    problem = plan()
    assert set(np.unique(problem.roles)) == {0, FREE} and (problem.roles == FREE).sum() == 4 * N
    assert np.isnan(problem.targets).all() and problem.goals == () and len(problem.creases) == 0
    assert problem.names.vertices.tolist() == list(range((N + 1) ** 2))


def test_it_is_asked_for_the_same_as_a_mesh():
    mesh = CGCMesh.from_problem(plan())
    mesh.set_supports("corners")
    mesh.set_creases([row(2), row(4)])
    mesh.set_target(0.01)
    mesh.set_target(0.02, region=1)
    mesh.set_goals([Height([0], 1.0)])
    by_mesh = mesh.to_problem()
    problem = plan().with_supports("corners").with_creases([row(2), row(4)]).with_targets(0.01).with_targets({1: 0.02})
    problem = problem.with_goals([{"kind": "height", "vertices": [0], "height": 1.0}])
    for name in ("vertices", "faces", "roles", "creases"):
        assert np.array_equal(getattr(problem, name), getattr(by_mesh, name)), name
    assert np.array_equal(problem.targets[problem.asked], by_mesh.targets[by_mesh.asked])
    assert problem.goals == by_mesh.goals == (Height([0], 1.0),)
    assert problem.region_targets() == by_mesh.region_targets() == [0.01, 0.02, 0.01]


def test_there_and_back_as_a_mesh_nothing_is_lost():
    problem = plan().with_creases([row(3)]).with_supports("boundary").with_targets(0.01).with_goals([Height([10], 0.5)])
    back = CGCMesh.from_problem(problem).to_problem()
    for name in ("vertices", "faces", "roles", "targets", "s", "e", "creases"):
        assert np.array_equal(getattr(problem, name), getattr(back, name), equal_nan=name in ("targets", "s", "e")), name
    assert back.goals == problem.goals


def test_supports_and_creases_replace_what_was_there_unless_they_are_added():
    problem = plan().with_supports([0]).with_supports([3])
    assert problem.supports.tolist() == [3]
    assert problem.with_supports([0], add=True).supports.tolist() == [0, 3]
    creased = plan().with_creases([row(2)]).with_creases([row(4)])
    assert creased.roles[row(2)].tolist().count(CREASE) == 0
    assert len(creased.with_creases([row(2)], add=True).crease_paths()) == 2


def test_creases_may_be_paths_where_a_problem_is_made():
    vertices, faces = shapes.grid(N)
    by_path = CGCProblem(vertices, faces, creases=[row(3)])
    by_edges = CGCProblem(vertices, faces, creases=np.column_stack([row(3)[:-1], row(3)[1:]]))
    assert np.array_equal(by_path.creases, by_edges.creases)
    assert (by_path.roles[row(3)] == CREASE).all()


def test_the_user_s_names_are_the_ones_that_count():
    vertices, faces = shapes.grid(N)
    names = Names(100 + 2 * np.arange(len(vertices)), np.arange(len(faces)))
    problem = CGCProblem(vertices, faces, names=names).with_supports([100, 104]).with_creases([[102, 102 + 2 * (N + 1)]])
    assert problem.supports.tolist() == [0, 2] and problem.creases.tolist() == [[1, N + 2]]
    with pytest.raises(ValueError, match="there is no vertex 7 in the mesh"):
        problem.with_supports([7])
    with pytest.raises(ValueError, match="there are no vertices 7, 9 in the mesh"):
        problem.with_supports([7, 100, 9])
    with pytest.raises(ValueError, match="the crease from vertex 100 to 108 does not follow an edge"):
        problem.with_creases([[100, 108]])


def test_targets_of_vertices_leave_those_that_are_no_numbers_alone():
    problem = plan().with_targets(0.01)
    some = np.full((N + 1) ** 2, np.nan)
    some[10] = 0.05
    assert problem.with_targets(some).targets[[9, 10]].tolist() == [0.01, 0.05]


def test_one_region_is_all_that_changes():
    problem = plan().with_creases([row(3)]).with_targets(0.01).with_targets(0.02, region=1)
    assert problem.region_targets() == [0.01, 0.02]
    with pytest.raises(ValueError, match="there is no region 2; the mesh has regions 0 to 1"):
        problem.with_targets(0.02, region=2)


def test_constraints_follow_the_vertices_when_dummies_go():
    mesh = CGCMesh.from_problem(plan().with_supports("corners").with_targets(0.01))
    ring = mesh.add_dummy_ring()
    mesh.set_goals([Height([10, len(mesh.vertex) - 1], 0.5)])
    real = mesh.to_problem().without_dummies()
    assert len(ring) and real.goals == (Height([10], 0.5),)


def test_turning_over_and_moving_leave_the_rest():
    problem = plan().with_supports("boundary").with_targets(0.01)
    assert np.array_equal(problem.flipped().flipped().faces, problem.faces)
    moved = problem.with_vertices(problem.vertices + 1.0)
    assert np.array_equal(moved.roles, problem.roles) and (moved.roles == FIXED).any()


VERTICES, FACES = shapes.grid(N)
WRONG = {
    "too few roles": (lambda: CGCProblem(VERTICES, FACES, [0, 1]), r"roles must be one per vertex \(49\), not an array of shape \(2,\)"),
    "no such role": (lambda: CGCProblem(VERTICES, FACES, np.full(49, 9)), "the role of vertex 0 must be one of internal, fixed"),
    "a role misspelt": (lambda: CGCProblem(VERTICES, FACES, ["fixd"] * 49), "the role of vertex 0 must be one of .* not .*fixd"),
    "too many targets": (lambda: CGCProblem(VERTICES, FACES, targets=np.ones(50)), "targets must be one number or one number per vertex"),
    "too few delays": (lambda: CGCProblem(VERTICES, FACES, e=[1.0, 2.0]), "e must be one number or one number per vertex"),
    "a crease to nowhere": (
        lambda: CGCProblem(VERTICES, FACES, creases=[[0, 49]]),
        "a crease names vertex 49, but the mesh has vertices 0 to 48",
    ),
    "too few names": (lambda: CGCProblem(VERTICES, FACES, names=Names([1], [2])), "names must be 49 keys of vertices and 72 of faces"),
    "other vertices": (lambda: plan().with_vertices(VERTICES[:-1]), r"vertices must have the shape \(49, 3\), not \(48, 3\)"),
}


@pytest.mark.parametrize("case", WRONG)
def test_what_is_wrong_is_refused_in_a_sentence(case):
    make, words = WRONG[case]
    with pytest.raises(ValueError, match=words):
        make()


def test_a_constraint_on_no_vertex_and_a_face_on_none_are_refused_too():
    with pytest.raises(ProblemError, match="names vertex 99, but the mesh has vertices 0 to 48"):
        plan().with_goals([Height([99], 1.0)])
    with pytest.raises(ProblemError, match="names vertex 99"):
        CGCMesh.from_problem(plan()).set_goals([Height([99], 1.0)])
    with pytest.raises(MeshError, match="face 0 names a vertex that does not exist"):
        CGCProblem(VERTICES, [[0, 1, 99]])


def test_roles_may_be_named():
    names = ["fixed", *["internal"] * 48]
    assert CGCProblem(VERTICES, FACES, names).supports.tolist() == [0]


def test_problems_are_compared_by_identity_and_can_be_kept_in_sets():
    problem = plan()
    assert problem == problem and problem != plan() and len({problem, plan()}) == 2
