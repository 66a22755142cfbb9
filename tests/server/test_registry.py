"""A method that is registered while the server runs is found wherever the server tells of methods, and solves."""

from __future__ import annotations

import json
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass

import numpy as np
import pytest

from compas_cgc.model.constraint_data import KINDS
from compas_cgc.model.result import History
from compas_cgc.model.result import Solution
from compas_cgc.server import Limits
from compas_cgc.server import create_app
from compas_cgc.solvers import METHODS
from compas_cgc.solvers import Method
from compas_cgc.solvers import Settings
from compas_cgc.solvers import method_names
from compas_cgc.solvers import options
from compas_cgc.solvers import register
from compas_cgc.solvers.settings import option

from ..support.server_process import wait_for
from ..support.shapes import grid


@dataclass(frozen=True)
class LiftSettings(Settings):
    """Settings of a method that lifts everything."""

    steps: int = option(1, "Most steps.", int, low=1)
    tolerance: float = option(1e-6, "Tolerance.", float, low=0)
    lift: float = option(2.0, "How far to lift. Not a word more is shown.", float, above=0, high=10)


def lift(problem, settings, callback):
    vertices = problem.vertices + np.where(problem.movable, settings.lift, 0.0)[:, None] * [0.0, 0.0, 1.0]
    return Solution(vertices, "converged", "lifted", 1, 0.0, 0.0, History.from_rows([]))


@pytest.fixture
def toy():
    method = register(Method("toy", "Lifts everything.", LiftSettings, lift))
    yield method
    del METHODS["toy"]


@pytest.fixture
def client():
    app = create_app(executor=ThreadPoolExecutor(1), limits=Limits(steps=5000))
    yield app.test_client()
    app.extensions["jobs"].close()


def request_schema(client):
    return client.get("/openapi.json").json["components"]["schemas"]["Request"]["properties"]


def solved(client, **more):
    """Return the result of a job."""
    vertices, faces = grid(6)
    value = {"vertices": vertices.tolist(), "faces": faces.tolist(), "supports": "boundary", "targets": 0.5, **more}
    answer = client.post("/api/v1/jobs", data=json.dumps(value))
    assert answer.status_code == 202, answer.json
    id = answer.json["id"]
    over = ("succeeded", "failed", "cancelled")
    status = wait_for(lambda: (found := client.get(f"/api/v1/jobs/{id}?wait=25").json)["state"] in over and found)
    assert status["state"] == "succeeded", status
    return client.get(f"/api/v1/jobs/{id}/result").json


def test_a_method_registered_later_is_found_in_every_description(client, toy):
    schema = request_schema(client)
    assert schema["method"]["enum"] == ["auto", "flow", "newton", "projection", "bending", "toy"]
    lift = schema["settings"]["properties"]["lift"]
    assert (lift["exclusiveMinimum"], lift["maximum"], lift["default"], lift["type"]) == (0, 10, 2.0, ["number", "null"])
    listed = client.get("/api/v1/methods").json["methods"][-1]
    assert (listed["name"], listed["text"], [own["name"] for own in listed["options"]]) == (
        "toy",
        "Lifts everything.",
        ["steps", "tolerance", "lift"],
    )
    for uri in ("/cgc/solve", "/cgc/goals", "/cgc/submit"):
        method = next(own for own in client.get(uri).json["Inputs"] if own["Name"] == "Method")
        assert "bending or toy" in method["Description"]


def test_a_method_registered_later_solves(client, toy):
    result = solved(client, method="toy", settings={"lift": 3})
    assert result["method"] == "toy" and np.max(result["vertices"], axis=0)[2] == 3.0
    assert solved(client, settings={"lift": 4.0})["method"] == "toy"
    answer = client.post("/api/v1/jobs", data=json.dumps({"vertices": [[0, 0, 0]] * 3, "faces": [[0, 1, 2]], "settings": {"lift": 11}}))
    assert answer.status_code == 422 and "lift must be" in answer.json["message"]


def test_what_is_described_is_what_is_registered(client):
    schema = request_schema(client)
    assert schema["method"]["enum"] == list(method_names())
    assert set(options()) | {"e"} == set(schema["settings"]["properties"])
    assert all(own["description"] for own in schema["settings"]["properties"].values())
    assert schema["goals"]["items"]["properties"]["kind"]["enum"] == list(KINDS)
    listed = client.get("/api/v1/methods").json["methods"]
    assert [own["name"] for own in listed] == list(method_names()) and all(own["text"] for own in listed)
    assert client.get("/api/v1/methods").status_code == 200


def test_the_inputs_of_hops_are_those_of_saved_definitions(client):
    inputs = {own["Name"]: own for own in client.get("/cgc/solve").json["Inputs"]}
    assert list(inputs) == ["Mesh", "Supports", "Creases", "K", "At", "Method", "S", "Delay", "Tolerance", "Measure", "Law"]
    assert [inputs[name]["Default"] for name in ("Method", "S", "Delay", "Tolerance", "Measure")] == ["auto", 0.8, 0, 0.0, "auto"]
    assert all(inputs[name]["AtLeast"] == inputs[name]["AtMost"] == 1 for name in ("Method", "S", "Delay", "Tolerance"))
    assert (inputs["S"]["Minimum"], inputs["S"]["Maximum"], inputs["Delay"]["Minimum"]) == (0, 1, 0)
    assert [inputs[name]["ParamType"] for name in ("S", "Delay", "Tolerance")] == ["Number", "Integer", "Number"]
