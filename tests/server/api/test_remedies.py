"""Remedies: what messages name becomes a change of the request, whose effect is the one that the message promises."""

from __future__ import annotations

import re
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import compas_cgc
from compas_cgc import CGCMesh
from compas_cgc import check
from compas_cgc import solve
from compas_cgc.errors import ProblemError
from compas_cgc.model.constraints import Height
from compas_cgc.server import create_app
from compas_cgc.server.api.remedies import NAMED
from compas_cgc.server.api.remedies import named
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


def fixed_words(pattern):
    """Return the longest fixed part of every alternative of a pattern."""
    escaped = pattern.replace(r"\(", "<").replace(r"\)", ">")
    while re.search(r"\([^()]*\)\??", escaped):
        escaped = re.sub(r"\([^()]*\)\??", "~", escaped)
    for alternative in escaped.split("|"):
        parts = re.split(r"~|\.\*|\\[dSD][+*]?|.\?|\.", alternative)
        yield max(parts, key=len).replace("<", "(").replace(">", ")").strip()


def test_every_phrase_is_one_of_the_package():
    """A phrase that no message has any more would be a button that never appears."""
    package = Path(compas_cgc.__file__).parent
    own = package / "server" / "api" / "remedies.py"
    text = "\n".join(path.read_text(encoding="utf-8") for path in package.rglob("*.py") if path != own)
    joined = re.sub(r'"\s*\n\s*f?"', "", text)
    phrases = [words for pattern, _ in NAMED for words in fixed_words(pattern)]
    assert min(map(len, phrases)) > 5
    assert [words for words in phrases if words not in joined] == []


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
    (change,) = changes(named([str(caught.value)]))
    assert change["scale"] == pytest.approx(0.95 * np.pi / 100 / 0.05, rel=5e-3)
    solve(problem.with_targets(problem.targets * change["scale"]))


def test_k_above_what_supports_carry_is_scaled_to_that():
    problem = square(0.05, "corners", 6).to_problem()
    limit = raised(problem, tolerance=0.1, solves=16, vertices=500, most=1.0)
    assert 0.0 < limit.factor < 1.0
    (change,) = changes(named([limit.message]))
    assert change["scale"] == pytest.approx(0.95 * limit.factor, rel=0.02)
    # The message of a rough surface names the factor, so that nothing else is searched for.
    rough = solve(problem)
    found = changes(remedies_of(problem, replace(rough, ending=f"{limit.message}; {rough.ending}")))
    assert {"scale": change["scale"]} in found and {"limit": True} not in found
    assert {"limit": True} in changes(remedies_of(problem, replace(rough, ending="")))
    enough = raised(square(1e-4, "corners", 6).to_problem(), tolerance=0.1, solves=16, vertices=500, most=2.0)
    assert enough.factor >= 1.0 and named([enough.message]) == []


def test_checks_name_supports_targets_and_normals():
    mesh = CGCMesh.from_meshgrid(dx=10.0, nx=4)
    assert {"supports": "boundary"} in changes(named(check(mesh)))
    mesh.set_supports("boundary")
    (K,) = [own["targets"] for own in changes(named(check(mesh))) if "targets" in own]
    mesh.set_target(K)
    assert not any(said.fatal for said in check(mesh))
    mesh.flip()
    assert {"flip": True} in changes(named(check(mesh)))


def test_goals_that_contradict_supports_are_freed_or_removed():
    mesh = square(0.005, "boundary", 4)
    mesh.set_goals([Height([0], 1.0)])
    with pytest.raises(ProblemError) as caught:
        solve(mesh)
    assert {"release": [0]} in changes(named([str(caught.value)]))
    both = "the rise 3 and the clearance 5 cannot be met together here; take one of them away, or ask for another value of one"
    assert changes(named([both])) == [{"without": "rise"}, {"without": "clearance"}]


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
