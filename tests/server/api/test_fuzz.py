"""Requests that nobody would write, at a real server: it refuses them with a sentence and goes on.

``FUZZ_EXAMPLES=2000`` looks for new ones instead of repeating the known few.
"""

from __future__ import annotations

import base64
import copy
import http.client
import json
import os

import numpy as np
import pytest
import rhino3dm
from hypothesis import HealthCheck
from hypothesis import Phase
from hypothesis import given
from hypothesis import settings
from hypothesis import strategies as st

from compas_cgc.io.rhino.meshes import mesh_from_arrays
from compas_cgc.server.api.openapi import description

from ...support.server_process import PATIENCE
from ...support.server_process import running_server
from ...support.server_process import wait_for
from ...support.shapes import grid

FUZZ = int(os.environ.get("FUZZ_EXAMPLES", 0))
SETTINGS = settings(
    max_examples=FUZZ or 20,
    derandomize=not FUZZ,
    database=None,
    deadline=None,
    suppress_health_check=list(HealthCheck),
    phases=[Phase.generate, Phase.shrink] if FUZZ else [Phase.generate],
)
POINT = {"X": 0.0, "Y": 0.0, "Z": 0.0}
EDGE = {"From": {"X": 1.5, "Y": 0.0, "Z": 0.0}, "To": {"X": 1.5, "Y": 3.0, "Z": 0.0}}
FUNCTIONS = {
    "dome": {"Mesh": None, "K": [0.01]},
    "solve": {"Mesh": None, "Supports": [POINT], "Creases": [EDGE], "K": [0.01], "Method": ["flow"], "S": [0.8], "Tolerance": [0.1]},
    "flow": {"Mesh": None, "K": [0.01], "Steps": [3]},
    "analyse": {"Mesh": None, "Target": [0.0]},
    "mould": {"Mesh": None, "K": [0.0], "Count": [2]},
    "unroll": {"Mesh": None, "K": [0.0], "Length": [2.0]},
    "membrane": {"Mesh": None, "K": [0.01], "Pressure": [1.0]},
    "net": {"Mesh": None, "K": [-0.01], "Through": [POINT]},
    "quads": {"Mesh": None, "K": [0.01], "Spacing": [2.0]},
    "submit": {"Mesh": None, "K": [0.01, 0.02], "At": [POINT, POINT], "Delay": [1]},
    "fetch": {"Job": ["no-such-job"], "Tick": [0]},
}


OPERATIONS = [(method, path) for path, own in description()["paths"].items() for method in own if method != "parameters"]


@pytest.fixture(scope="module")
def server(tmp_path_factory):
    limits = {"blocking": 30.0, "seconds": 30.0, "reserved": 0}
    with running_server(tmp_path_factory.mktemp("fuzz") / "jobs.sqlite", workers=1, limits=limits) as running:
        yield running


def check(server, body, address="/solve"):
    """Send a body; return the status of an answer that every client can show."""
    lost = server.client.health()["replaced"]
    status, headers, content = server.ask("POST", address, body)
    assert status in (200, 202, 400, 404, 413, 422, 429, 504), content[:500]
    assert headers["Content-Type"] == "application/json" and headers["Content-Length"] == str(len(content))
    found = json.loads(content, parse_constant=lambda name: pytest.fail(f"{name} in an answer"))
    assert set(found) >= {"values", "errors", "warnings", "message"}
    assert all(isinstance(found[name], list) for name in ("values", "errors", "warnings"))
    assert (status < 300) == (found["errors"] == []) and found["message"] == (found["errors"] or [""])[0]
    if status == 504:
        # The decoder of Rhino's files cannot be asked to stop: its worker is ended and another started.
        wait_for(lambda: server.client.health()["idle"] == 1)
        lost = server.client.health()["replaced"]
    health = server.client.health()
    assert health["status"] == "ok" and health["replaced"] == lost, "a worker was lost"
    return status


# ----------------------------------------------------------------------
# Geometry that is not what it seems
# ----------------------------------------------------------------------


def meshes():
    """Return meshes good and bad by name, as Rhino writes them."""
    vertices, faces = grid(3, 3.0)
    found = {"sheet": mesh_from_arrays(vertices, faces)}
    found["triangle"] = mesh_from_arrays(np.eye(3), np.array([[0, 1, 2]]))
    found["flat"] = mesh_from_arrays(vertices * [1, 0, 0], faces)
    found["point"] = mesh_from_arrays(vertices * 0.0, faces)
    found["far"] = mesh_from_arrays(vertices + 1e11, faces)
    found["tiny"] = mesh_from_arrays(vertices * 1e-150, faces)
    found["fan"] = mesh_from_arrays(vertices, np.array([[0, 1, k] for k in range(2, 16)]))
    found["twice"] = mesh_from_arrays(vertices, np.concatenate([faces, faces]))
    found["corner twice"] = mesh_from_arrays(vertices, np.concatenate([faces, [[0, 0, 1]]]))
    found["two"] = mesh_from_arrays(np.concatenate([vertices, vertices + 9.0]), np.concatenate([faces, faces + len(vertices)]))
    for name, value in (("nan", np.nan), ("infinite", np.inf), ("huge", 1e300), ("single", 3e38)):
        found[name] = mesh_from_arrays(np.where(vertices == 1.0, value, vertices), faces)
    found["empty"], found["no faces"] = rhino3dm.Mesh(), rhino3dm.Mesh()
    found["no faces"].Vertices.Add(0, 0, 0)
    found = {name: mesh.Encode() for name, mesh in found.items()}
    content = base64.b64decode(found["sheet"]["data"])
    first = bytes([0, 4, 5, 5, 0, 5, 1, 1])
    assert content.count(first) == 1
    found["beyond"] = {**found["sheet"], "data": base64.b64encode(content.replace(first, bytes([0, 200, 5, 5, 0, 5, 1, 1]))).decode()}
    return found


def others():
    """Return things that are no meshes."""
    a, b = rhino3dm.Point3d(0, 0, 0), rhino3dm.Point3d(3, 3, 0)
    cloud = rhino3dm.PointCloud()
    cloud.Add(a)
    brep = rhino3dm.Brep.CreateFromSphere(rhino3dm.Sphere(a, 1.0))
    return [
        brep,
        cloud,
        rhino3dm.SubD(),
        rhino3dm.LineCurve(a, b),
        rhino3dm.LineCurve(a, b).ToNurbsCurve(),
        rhino3dm.PolyCurve(),
        rhino3dm.Point(a),
    ]


MESHES = meshes()
GEOMETRY = [*MESHES.values(), *(thing.Encode() for thing in others())]


@st.composite
def damaged(draw):
    """Draw geometry with some of its bytes changed, cut or doubled."""
    encoded = dict(draw(st.sampled_from(GEOMETRY)))
    content = bytearray(base64.b64decode(encoded["data"]))
    for _ in range(draw(st.integers(1, 4))):
        at = draw(st.integers(0, len(content) - 1))
        content[at] = draw(st.sampled_from([0, 1, 127, 128, 255]) | st.integers(0, 255))
    cut = draw(st.integers(0, len(content)) | st.just(len(content)))
    encoded["data"] = base64.b64encode(content[:cut] + (content if draw(st.booleans()) else b"")).decode()
    return encoded


JUNK = st.one_of(
    st.none(),
    st.booleans(),
    st.integers(),
    st.sampled_from([10**299, -(10**18), 2**31, 2**63, 1e308, -1e308, 5e-324, -0.0, 1e12]),
    st.floats(allow_nan=False),
    st.text(max_size=20),
    st.sampled_from(
        [
            "NaN",
            "-Infinity",
            "1e999",
            "1" + 5000 * "0",
            "\ud800",
            '"\\udfff"',
            "[" * 3000,
            '{"a":',
            "{}",
            "\0",
            "0,25",
            "http://127.0.0.1:1/",
        ]
    ),
    st.sampled_from([[], {}, [[]], [[[[1]]]], {"X": 1}, {"data": None}, {"{0}": [{"data": 1}]}, [{"data": [1]}]]),
    st.sampled_from(GEOMETRY),
    damaged(),
)


# ----------------------------------------------------------------------
# Requests
# ----------------------------------------------------------------------


def request(name, mesh):
    inputs = {**FUNCTIONS[name], **({"Mesh": [mesh]} if "Mesh" in FUNCTIONS[name] else {})}
    values = [{"ParamName": own, "InnerTree": {"{0}": [{"type": "any", "data": value} for value in data]}} for own, data in inputs.items()]
    return {"pointer": f"cgc/{name}", "modelunits": "Meters", "absolutetolerance": 0.01, "cachesolve": False, "values": values}


def places(value, path=()):
    """Return the paths to everything inside of a value."""
    inner = value.items() if isinstance(value, dict) else enumerate(value) if isinstance(value, list) else ()
    return [path, *(found for key, item in inner for found in places(item, (*path, key)))]


def changed(value, path, change):
    """Return a value with what is at a path changed; None drops it."""
    if not path:
        return change(value)
    value = copy.copy(value)
    new = changed(value[path[0]], path[1:], change)
    if new is DROP:
        del value[path[0]]
    else:
        value[path[0]] = new
    return value


DROP = object()


@st.composite
def mutated(draw, name):
    """Draw a request of a function with some of it dropped, replaced, repeated, wrapped or cut."""
    body = request(name, draw(st.sampled_from(GEOMETRY) | st.just(MESHES["sheet"]) | damaged()))
    for _ in range(draw(st.integers(0, 3))):
        path = draw(st.sampled_from([path for path in places(body) if path] or [()]))
        junk = draw(JUNK)
        change = draw(
            st.sampled_from(
                [
                    lambda old: DROP,
                    lambda old, junk=junk: junk,
                    lambda old, junk=junk: [old, junk],
                    lambda old, junk=junk: {"data": old, "X": junk},
                    lambda old: json.dumps(old),
                    lambda old: old[: len(old) // 2] if isinstance(old, (str, list)) else -old if isinstance(old, (int, float)) else old,
                    lambda old: 300 * old if isinstance(old, list) else old,
                ]
            )
        )
        if path:
            body = changed(body, path, change)
    return body


def encoded(body):
    """Return a body as bytes, with what JSON has no word for as Python writes it."""
    return json.dumps(body).encode()


@pytest.mark.parametrize("name", FUNCTIONS)
def test_hops_requests_changed_at_random_never_make_the_server_fail(server, name):
    @SETTINGS
    @given(mutated(name))
    def run(body):
        check(server, encoded(body))

    run()
    good = request(name, MESHES["sheet"])
    # A flat sheet has neither forces nor curves of another K, nor lines of curvature.
    assert check(server, encoded(good)) == {"fetch": 404, "membrane": 422, "net": 422, "quads": 422}.get(name, 200)


@pytest.mark.parametrize("mesh", MESHES)
def test_bad_meshes_are_refused_by_every_function(server, mesh):
    for name in ("dome", "solve", "flow", "analyse"):
        status = check(server, encoded(request(name, MESHES[mesh])))
        assert mesh not in ("nan", "infinite", "huge", "single", "beyond", "empty", "no faces") or status == 422
        assert mesh != "sheet" or status == 200


@pytest.mark.parametrize(
    "name, input, data, expected",
    [
        ("solve", "Supports", {"X": 0.5, "Y": 0.0, "Z": 0.0}, 422),
        ("solve", "Creases", 0, 413),
        ("submit", "At", POINT, 413),
        ("submit", "K", "0.01", 413),
        ("dome", "K", 0.01, 200),
        ("fetch", "Job", "a-job-of-mine", 404),
    ],
)
def test_a_hundred_thousand_items_are_refused_at_once(server, name, input, data, expected):
    many = 100_000
    body = request(name, MESHES["sheet"])
    value = next(value for value in body["values"] if value["ParamName"] == input)
    several = {f"{{{k}}}": [{"data": data}] for k in range(many)} if input in ("Creases", "Job") else {"{0}": [{"data": data}] * many}
    value["InnerTree"] = several
    assert check(server, encoded(body)) == expected


@SETTINGS
@given(st.binary(max_size=300) | st.text(max_size=300).map(lambda text: text.encode("utf-8", "surrogatepass")) | JUNK.map(encoded))
def test_bodies_of_any_bytes_are_answered(server, body):
    for address in ("/solve", "/grasshopper"):
        assert check(server, body, address) in (400, 404, 413)


# ----------------------------------------------------------------------
# The job API, by its description
# ----------------------------------------------------------------------


@pytest.fixture(scope="module")
def schema(server):
    """The description that the server gives of itself, able to make requests of it."""
    return pytest.importorskip("schemathesis").openapi.from_url(server.url + "/openapi.json")


@pytest.fixture(scope="module")
def ids(server):
    """Names of jobs in every state."""
    vertices, faces = grid(6)
    asked = {"supports": "boundary", "targets": 0.5}
    for id in ("succeeded", "cancelled", "to-delete"):
        server.client.submit(vertices, faces, id=id, **asked)
        server.client.cancel(id) if id == "cancelled" else None
    server.client.submit(vertices, faces, id="failed-one", supports="boundary", targets=1e6)
    over = ("succeeded", "failed", "cancelled")
    wait_for(lambda: all(status["state"] in over for status in server.client.jobs()))
    return ["succeeded", "cancelled", "failed-one", "nobody-has-this", "a b/../%2e", "\0", "\u00e9" * 50, ".."]


def running(server):
    """Start a job that goes on."""
    vertices, faces = grid(12)
    settings = {"steps": 100000, "tolerance": 0.0}
    return server.client.submit(vertices, faces, supports="boundary", targets=0.5, method="flow", settings=settings, live=True)


@pytest.mark.parametrize("method, path", OPERATIONS)
def test_the_server_does_what_its_description_says(server, schema, ids, method, path):
    from schemathesis import GenerationMode
    from schemathesis.checks import not_a_server_error
    from schemathesis.specs.openapi.checks import content_type_conformance
    from schemathesis.specs.openapi.checks import response_schema_conformance
    from schemathesis.specs.openapi.checks import status_code_conformance

    operation = schema[path][method.upper()]
    cases = operation.as_strategy(generation_mode=GenerationMode.POSITIVE) | operation.as_strategy(generation_mode=GenerationMode.NEGATIVE)
    names = st.sampled_from(["paraboloid", *ids]) if "{name}" in path else st.sampled_from(ids)

    @SETTINGS
    @given(cases, st.booleans(), names)
    def run(case, known, id):
        for name in case.path_parameters or {} if known else {}:
            case.path_parameters[name] = id
        # No operation takes a header, and what is no header at all never reaches the application.
        (case.headers or {}).clear()
        if isinstance((case.query or {}).get("wait"), (int, float)):
            case.query["wait"] = min(case.query["wait"], 0.05)
        checks = [not_a_server_error, content_type_conformance, status_code_conformance, response_schema_conformance]
        case.call_and_validate(checks=checks, timeout=PATIENCE)

    run()
    assert server.client.health()["status"] == "ok" and server.client.health()["replaced"] == 0


def test_events_of_a_running_job_are_as_described(server):
    from jsonschema import Draft202012Validator

    served = json.loads(server.ask("GET", "/openapi.json")[2])
    validator = Draft202012Validator({**served["components"]["schemas"]["Job"], "components": served["components"]})
    id = running(server)
    connection = http.client.HTTPConnection(server.address, timeout=PATIENCE)
    connection.request("GET", f"/api/v1/jobs/{id}/events")
    answer = connection.getresponse()
    assert (
        answer.status == 200
        and answer.headers.get_content_type() in served["paths"]["/api/v1/jobs/{id}/events"]["get"]["responses"]["200"]["content"]
    )
    for _ in range(5):
        assert answer.readline() in (b"event: progress\n",)
        status = json.loads(answer.readline().removeprefix(b"data: "))
        validator.validate(status)
        validator.validate(server.client.poll(id))
        assert answer.readline() == b"\n"
    connection.close()
    server.client.delete(id)
