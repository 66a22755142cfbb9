"""Remedies: every message carries changes of the request, whose effect is the one that it promises."""

from __future__ import annotations

from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace

import numpy as np
import pytest

from compas_cgc import CGCMesh
from compas_cgc import check
from compas_cgc import solve
from compas_cgc.errors import ProblemError
from compas_cgc.errors import joined
from compas_cgc.errors import sentence_of
from compas_cgc.model.constraints import Height
from compas_cgc.model.goals.inequalities import Above
from compas_cgc.model.goals.wholes import Rise
from compas_cgc.model.measures import inward_supports
from compas_cgc.model.roles import FIXED
from compas_cgc.server import create_app
from compas_cgc.server.api.remedies import CHANGE
from compas_cgc.server.api.remedies import TEXTS
from compas_cgc.server.api.remedies import remedies_in
from compas_cgc.server.api.remedies import remedies_of
from compas_cgc.solvers.limits import raised

from ...support.server_process import wait_for
from ...support.shapes import grid


def square(K, supports="boundary", n=8):
    mesh = CGCMesh.from_meshgrid(dx=10.0, nx=n)
    mesh.set_supports(supports)
    mesh.set_target(K)
    return mesh


def changes(found):
    return [remedy["change"] for remedy in found]


@pytest.fixture(scope="module")
def client():
    app = create_app(executor=ThreadPoolExecutor(1))
    yield app.test_client()
    app.extensions["jobs"].close()


def test_every_field_of_a_remedy_has_a_label():
    assert set(TEXTS) == set(CHANGE)


def test_more_steps_are_as_many_as_suffice():
    problem = square(0.005).to_problem()
    result = solve(problem, method="newton", settings={"steps": 1})
    assert result.status == "step_limit"
    (settings,) = [own["settings"] for own in changes(remedies_of(problem, result)) if "settings" in own]
    assert settings["steps"] > 1 and solve(problem, method="newton", settings=settings).converged


def test_k_beyond_the_boundary_is_scaled_to_what_it_carries():
    problem = square(0.05).to_problem()
    with pytest.raises(ProblemError) as caught:
        solve(problem)
    (change,) = changes(remedies_in([sentence_of(caught.value)]))
    assert change["scale"] == pytest.approx(0.95 * np.pi / 100 / 0.05, rel=5e-3)
    solve(problem.with_targets(problem.targets * change["scale"]))


def test_k_above_what_supports_carry_is_scaled_to_that():
    problem = square(0.05, "corners", 6).to_problem()
    limit = raised(problem, tolerance=0.1, solves=16, vertices=500, most=1.0)
    assert 0.0 < limit.factor < 1.0
    (change,) = changes(remedies_in([limit.message]))
    assert change["scale"] == pytest.approx(0.95 * limit.factor, rel=0.02)
    # The message of a rough surface names the factor, in the place of a half.
    rough = solve(problem)
    found = changes(remedies_of(problem, replace(rough, ending=joined([limit.message, rough.ending]))))
    assert {"scale": change["scale"]} in found and {"scale": 0.5} not in found
    assert {"scale": 0.5} in changes(remedies_of(problem, replace(rough, ending="")))
    enough = raised(square(1e-4, "corners", 6).to_problem(), tolerance=0.1, solves=16, vertices=500, most=2.0)
    assert enough.factor >= 1.0 and remedies_in([enough.message]) == []


def test_checks_name_supports_targets_and_normals():
    mesh = CGCMesh.from_meshgrid(dx=10.0, nx=4)
    assert {"supports": "boundary"} in changes(remedies_in(check(mesh)))
    mesh.set_supports("boundary")
    (K,) = [own["targets"] for own in changes(remedies_in(check(mesh))) if "targets" in own]
    mesh.set_target(K)
    assert not any(said.fatal for said in check(mesh))
    mesh.flip()
    assert {"flip": True} in changes(remedies_in(check(mesh)))


def test_a_saddle_within_a_flat_edge_becomes_a_dome():
    problem = square(-0.01).to_problem()
    assert {"scale": -1.0} in changes(remedies_in(check(problem)))
    # A part of K cannot be met either.
    found = changes(remedies_of(problem, solve(problem), check(problem)))
    assert {"scale": -1.0} in found and {"scale": 0.5} not in found
    assert solve(problem.with_targets(-problem.targets)).verdict.fair
    assert remedies_in(check(square(-0.01, "corners"))) == []


def test_a_support_at_an_inward_corner_is_freed():
    mesh = CGCMesh.from_outline([[0, 0], [10, 0], [10, 5], [5, 5], [5, 9], [0, 9]], edge_length=1.2)
    mesh.set_supports("corners")
    mesh.set_target(0.02)
    problem = mesh.to_problem()
    (inner,) = np.flatnonzero((np.abs(problem.vertices[:, :2] - 5.0) < 1e-9).all(axis=1)).tolist()
    assert problem.roles[inner] == FIXED
    began = solve(problem, method="newton", settings={"steps": 1})
    (change,) = [own for own in changes(remedies_of(problem, began)) if "release" in own]
    assert change == {"release": [inner]}
    freed = problem.with_supports([vertex for vertex in np.flatnonzero(problem.roles == FIXED).tolist() if vertex != inner])
    assert solve(freed).verdict.fair and inward_supports(freed) == []
    assert not any("release" in own for own in changes(remedies_of(problem.with_targets(-0.02), began)))


def test_columns_level_with_the_corners_are_freed():
    columns = [[4.0, 3.0], [8.0, 4.0]]
    mesh = CGCMesh.from_outline([[0, 0], [12, 0], [12, 7], [0, 7]], edge_length=1.0, points=columns)
    mesh.set_supports("corners")
    mesh.set_target(0.002)
    problem = mesh.to_problem()
    places = [int(np.argmin(np.linalg.norm(problem.vertices[:, :2] - column, axis=1))) for column in columns]
    corners = problem.supports.tolist()
    problem = problem.with_supports([*corners, *places])
    change, *others = changes(remedies_of(problem, solve(problem)))
    assert change == {"release": sorted(places)} and {"scale": 0.5} not in others
    assert solve(problem.with_supports(corners)).verdict.fair


@pytest.mark.parametrize("free", [None, pytest.param(9.0, marks=pytest.mark.nightly)], ids=["held all round", "one side free"])
def test_walls_that_meet_at_an_inward_corner_get_a_crease_from_it(free):
    outline = [[0, 0], [14, 0], [14, 5], [6, 5], [6, 11], [0, 11]]

    def posed(creases=()):
        mesh = CGCMesh.from_outline(outline, creases=[[[*point, 0.0] for point in line] for line in creases], edge_length=1.0)
        problem = mesh.to_problem().with_supports("boundary")
        x, y, _ = problem.vertices.T
        # The side from the inward corner on is free, if one is.
        held = [v for v in problem.supports.tolist() if free is None or not (y[v] == 5.0 and 6.0 < x[v] < 14.0)]
        return problem.with_supports(held).with_targets(0.004)

    problem = posed()
    result = solve(problem)
    assert not (result.converged and result.verdict.fair)
    change, *others = changes(remedies_of(problem, result, check(problem)))
    assert {"scale": 0.5} not in others
    ((start, end),) = change["creases"]
    assert start == pytest.approx([6.0, 5.0]) and end == pytest.approx([6.0, 0.0])
    mended = solve(posed(change["creases"]))
    assert mended.converged and mended.verdict.fair
    # A saddle may have inward corners.
    assert not any("creases" in own for own in changes(remedies_of(problem.with_targets(-0.004), result)))


def test_goals_that_contradict_supports_are_freed_or_removed():
    mesh = square(0.005, "boundary", 4)
    mesh.set_goals([Height([0], 1.0)])
    with pytest.raises(ProblemError) as caught:
        solve(mesh)
    assert {"release": [0]} in changes(remedies_in([sentence_of(caught.value)]))
    mesh.set_goals([Rise(3.0), Rise(5.0)])
    assert changes(remedies_in(check(mesh))) == [{"without": "rise"}]
    mesh.set_goals([Above(5.0), Rise(3.0)])
    assert {"without": "above"} in changes(remedies_in(check(mesh))) and {"without": "rise"} in changes(remedies_in(check(mesh)))


def ended(client, body):
    """Return the status of a job at its end."""
    id = client.post("/api/v1/jobs", json=body).json["id"]
    return wait_for(lambda: (own := client.get(f"/api/v1/jobs/{id}?wait=20").json)["state"] in ("succeeded", "failed") and own)


def test_jobs_and_refusals_carry_their_remedies(client):
    vertices, faces = grid(4)
    body = {"vertices": vertices.tolist(), "faces": faces.tolist(), "supports": "boundary", "targets": 50.0}
    status = ended(client, body)
    assert status["state"] == "failed" and "scale" in status["remedies"][0]["change"]
    few = ended(client, {**body, "targets": 0.2, "method": "newton", "settings": {"steps": 1}})
    report = client.get(f"/api/v1/jobs/{few['id']}/result?format=arrays").json["report"]
    assert "settings" in report["remedies"][0]["change"]
    fair = ended(client, {**body, "targets": 0.2})
    assert "remedies" not in client.get(f"/api/v1/jobs/{fair['id']}/result?format=arrays").json["report"] and fair["remedies"] == []
    outline = [[0, 0], [10, 0], [10, 10], [0, 10]]
    refused = client.post("/api/v1/drawings", json={"outline": outline, "edge_length": 30.0})
    assert refused.status_code == 422
    (length,) = [own["edge_length"] for own in changes(refused.json["remedies"])]
    assert client.post("/api/v1/drawings", json={"outline": outline, "edge_length": length}).status_code == 200
