"""Rule by rule what Hops and its relatives may send, and what they can read."""

from __future__ import annotations

import base64
import json
import re
import socket

import numpy as np
import pytest
import rhino3dm
from hypothesis import given
from hypothesis import strategies as st

from compas_cgc.io.rhino.meshes import mesh_from_arrays
from compas_cgc.server.hops.data_tree import format_number
from compas_cgc.server.hops.data_tree import format_text
from compas_cgc.server.hops.endpoints import endpoints

from ...support.hops_client import Hops
from ...support.hops_client import HopsError
from ...support.hops_client import get
from ...support.hops_client import write
from ...support.server_process import KEY
from ...support.server_process import PATIENCE
from ...support.server_process import wait_for
from ...support.shapes import grid

NAMES = ("dome", "solve", "flow", "analyse", "submit", "fetch")
CORNERS = [(0, 0, 0), (9, 0, 0), (0, 9, 0), (9, 9, 0)]


@pytest.fixture
def hops(server):
    return lambda name, generation=8, comma=False, **more: Hops(f"{server.url}/cgc/{name}", generation, KEY, comma, **more)


def sheet(n=8, width=9.0):
    return mesh_from_arrays(*grid(n, width))


def plain(server, name, address="/solve", **inputs):
    """Send what a script would send: values as they are, no types; return status and body."""
    values = [{"ParamName": own, "InnerTree": tree} for own, tree in inputs.items()]
    status, _, content = server.ask("POST", address, json.dumps({"pointer": f"cgc/{name}", "values": values}).encode())
    return status, json.loads(content)


def items(*values):
    return {"0": [{"data": value} for value in values]}


def error_of(body):
    """Return the output Error of an answer; raise when it is none."""
    return next(value for value in body["values"] if value["ParamName"] == "Error")["InnerTree"]["{0}"][0]["data"]


# ----------------------------------------------------------------------
# Descriptions
# ----------------------------------------------------------------------


@pytest.mark.parametrize("name", NAMES)
def test_a_description_is_the_same_however_it_is_asked_for(server, name):
    status, headers, body = server.ask("GET", f"/cgc/{name}", RhinoComputeKey=None)
    assert status == 200 and headers["Content-Type"] == "application/json" and int(headers["Content-Length"]) == len(body)
    for path in (f"/cgc/{name}/", f"/cgc/{name}?tab=1", f"/io?pointer=cgc/{name}", f"/io?pointer=/cgc/{name}"):
        assert server.ask("GET", path, RhinoComputeKey=None)[::2] == (200, body)
    assert server.ask("POST", "/io", json.dumps({"pointer": f"http://elsewhere:1/cgc/{name}"}).encode())[::2] == (200, body)
    for path in (f"/cgc/{name}", f"/cgc/{name}/", "/"):
        assert server.ask("HEAD", path, RhinoComputeKey=None)[::2] == (200, b"")
    found = json.loads(body)
    assert found["Uri"] == f"/cgc/{name}" and found["Category"] and found["Subcategory"] and found["CacheKey"] is None
    for entry in found["Inputs"] + found["Outputs"]:
        assert {"Name", "Nickname", "Description", "ParamType", "ResultType"} <= set(entry)


def test_a_path_with_a_query_leads_to_the_function_without_it(server):
    component = Hops(f"{server.url}/cgc/dome?version=2", key=KEY)
    assert component.pointer == "cgc/dome" and component.solve(Mesh=sheet(), K=0.01)[0] == 200


@pytest.mark.parametrize("path", ["/cgc/none", "/cgc/", "/cgc", "/io", "/io?pointer=cgc/none", "/cgc/dome/more", "/none"])
def test_an_unknown_path_is_answered_in_json(server, path):
    status, kind, body = get(server.url + path)
    found = json.loads(body)
    assert (status, kind) == (404, "application/json") and found["message"] == found["errors"][0]
    assert found["values"] == found["warnings"] == []


def test_rhino_7_gets_along_without_optional_inputs(hops):
    for name, inputs in (("dome", {"K": 0.01}), ("flow", {"K": 0.01}), ("analyse", {})):
        assert hops(name, 7).solve(Mesh=sheet(), **inputs)[0] == 200
    with pytest.raises(HopsError, match="Supports failed to collect data"):
        hops("solve", 7).solve(Mesh=sheet(), K=[0.01])
    crease = rhino3dm.LineCurve(rhino3dm.Point3d(4.5, 0, 0), rhino3dm.Point3d(4.5, 9, 0))
    given = {"Mesh": sheet(), "K": [0.01, 0.02], "At": [(2, 4, 0), (7, 4, 0)], "Supports": CORNERS, "Creases": [crease]}
    assert hops("solve", 7).solve(**given, Method="projection")[0] == 200


# ----------------------------------------------------------------------
# Trees and items
# ----------------------------------------------------------------------


def two_regions(**more):
    crease = rhino3dm.PolylineCurve([rhino3dm.Point3d(4.5, 0, 0), rhino3dm.Point3d(4.5, 9, 0)])
    return {"Mesh": sheet(), "Creases": [crease], "K": [0.01, 0.02], "At": [(2, 4, 0), (7, 4, 0)], "Method": "projection", **more}


def grafted(tree, *paths):
    return {path: [item] for path, item in zip(paths, next(iter(tree.values())))}


@pytest.mark.parametrize(
    "paths", [("{0;0}", "{0;1}"), ("{0;2}", "{0;10}"), ("2", "10"), ("{ 0 ; 3 }", "{1}"), ("{0;1}", "{0;1;0}"), ("{0;5}", "{1;0}")]
)
@pytest.mark.parametrize("name", ["K", "At"])
def test_a_list_in_several_branches_is_read_in_the_order_of_their_paths(hops, name, paths):
    component = hops("solve")
    body = component.request(**two_regions())
    _, expected, _, _ = component.post(json.dumps(body).encode())
    # One of the two lists only, or both would be out of order together; what is written first is not what comes first.
    value = next(value for value in body["values"] if value["ParamName"] == name)
    value["InnerTree"] = dict(reversed(grafted(value["InnerTree"], *paths).items()))
    status, outputs, errors, _ = component.post(json.dumps(body).encode())
    assert (status, errors) == (200, []) and "region 0: 64 triangles, K̄ 0.01" in outputs["Info"][0]
    assert outputs["Mesh"][0].Encode() == expected["Mesh"][0].Encode()


def test_an_item_is_the_first_of_the_first_branch(server):
    mesh = sheet().Encode()
    status, body = plain(server, "dome", Mesh=items(mesh), K=items(0.01))
    expected = error_of(body)
    several = {"{1}": [{"data": 0.05}], "{0;7}": [{"data": 0.01}, {"data": 0.03}]}
    status, body = plain(server, "dome", Mesh={"{3;1;4}": [{"data": mesh}]}, K=several)
    assert status == 200 and error_of(body) == expected


def test_defaults_are_those_of_the_descriptions():
    inputs = [own for one in endpoints().values() for own in one.inputs if "Defaults to " in own.text]
    assert len(inputs) > 40
    for own in inputs:
        (stated,) = re.findall(r"Defaults to ([\w.+-]*\w)", own.text)
        kept = str(own.default).lower() if isinstance(own.default, (bool, str)) else f"{own.default:g}"
        assert stated.lower() == (kept or "none"), own.name


@pytest.mark.parametrize("tree", [{}, {"{0}": []}, None, {"{0}": [], "{1}": []}, {"{0}": [{"data": None}]}])
def test_an_empty_tree_is_an_input_without_value(server, tree):
    mesh = items(sheet().Encode())
    status, body = plain(server, "dome", Mesh=mesh, K=tree)
    assert status == 422 and body["errors"] == ["input 'K' is empty; connect a number to it"]
    # The default, though it is nought, and the whole edge for no supports.
    assert plain(server, "analyse", Mesh=mesh, Target=tree)[0] == 200
    assert plain(server, "solve", Mesh=mesh, K=items(0.01), Supports=tree, Creases=tree, At=tree, S=tree, Delay=tree, Method=tree)[0] == 200


def test_what_is_missing_takes_its_default_and_what_is_unknown_is_passed_over(server, hops):
    status, body = plain(server, "flow", mesh=items(sheet().Encode()), K=items(0.01), Colour=items("red"))
    assert status == 200 and "in 10 steps" in body["values"][1]["InnerTree"]["{0}"][0]["data"]
    component = hops("dome")
    sent = component.request(Mesh=sheet(), K=0.01)
    expected = component.post(json.dumps(sent).encode())[1]["Error"]
    bare = {"pointer": sent["pointer"], "values": sent["values"]}
    more = {**sent, "recursionlevel": 3, "data": [1], "errors": None, "id": {"a": [None]}, "modelunits": None, "absolutetolerance": "fine"}
    more["values"] = [
        {**value, "extra": 1, "InnerTree": {p: [{**i, "id": 7} for i in b] for p, b in value["InnerTree"].items()}}
        for value in sent["values"]
    ]
    for body in (bare, more):
        status, outputs, errors, _ = component.post(json.dumps(body).encode())
        assert (status, errors, outputs["Error"]) == (200, [], expected)


def test_items_that_are_not_used_are_told_of(server):
    mesh = sheet().Encode()
    for name, inputs in (("dome", {"K": items(0.01, 0.02)}), ("submit", {"K": items(0.01), "Method": items("auto", "flow")})):
        alone = {own: {"0": tree["0"][:1]} for own, tree in inputs.items()}
        assert plain(server, name, Mesh=items(mesh), **alone)[1]["warnings"] == []
        status, body = plain(server, name, Mesh=items(mesh), **inputs)
        (several,) = (own for own, tree in inputs.items() if len(tree["0"]) == 2)
        assert status == 200 and len(body["warnings"]) == 1
        assert body["warnings"][0].startswith(f"input '{several}' takes one item but has 2; only the first was used")


def test_an_empty_item_in_a_list_is_no_item_to_leave_out(server):
    status, body = plain(server, "solve", Mesh=items(sheet().Encode()), K=items(0.01, None), At=items(None, {"X": 1, "Y": 1, "Z": 0}))
    assert status == 422 and "input 'K' has 1 empty items" in body["errors"][0]


@pytest.mark.parametrize("steps", ["3", 3, 3.0, "3.0", "3E0", " 3 "])
def test_a_whole_number_may_be_written_as_a_fraction(server, steps):
    status, body = plain(server, "flow", Mesh=items(sheet().Encode()), K=items(0.01), Steps=items(steps))
    assert status == 200 and "in 3 steps" in body["values"][1]["InnerTree"]["{0}"][0]["data"]


@pytest.mark.parametrize(
    "name, input, data, part",
    [
        ("flow", "Steps", "3.5", "input 'Steps' must be an integer"),
        ("flow", "Steps", True, "input 'Steps' must be an integer"),
        ("flow", "Steps", "true", "input 'Steps' must be an integer"),
        ("flow", "Steps", 0, "input 'Steps' must be between 1 and 10000"),
        ("flow", "Steps", 1e300, "input 'Steps' must be an integer"),
        ("flow", "Steps", {"X": 1}, "input 'Steps' must be an integer"),
        ("flow", "K", "0,25", "input 'K' cannot be read as a number"),
        ("flow", "K", "1" + 400 * "0", "input 'K' cannot be read as a number"),
        ("flow", "K", 10**299, "input 'K' must be a finite number"),
        ("flow", "K", "Infinity", "input 'K' must be a finite number"),
        ("flow", "K", -1e10, "input 'K' must be between"),
        ("flow", "K", "[0.01]", "input 'K' must be a number"),
        ("flow", "K", '"0.01"', "input 'K' must be a number"),
        ("solve", "At", {"X": 1, "Y": 2}, "X, Y and Z"),
        ("solve", "At", "[1, 2, 3]", "X, Y and Z"),
        ("solve", "At", {"X": 1, "Y": 2, "Z": "3"}, "z of a point of input 'At' must be a number"),
        ("solve", "Method", 5, "'method' must be one of"),
        ("solve", "Method", '"\\ud800"', "input 'Method' holds half of a surrogate pair"),
        ("fetch", "Job", '"\\udfff"', "input 'Job' holds half of a surrogate pair"),
        ("solve", "Creases", 5, "input 'Creases' must be a curve"),
        ("solve", "Creases", {"From": 1, "To": 2}, "line without end points"),
        ("solve", "Creases", {"From": {"X": 0, "Y": 0, "Z": 0}, "To": {"X": 1, "Y": "a", "Z": 0}}, "line without end points"),
        ("solve", "Creases", {"From": {"X": 1e300, "Y": 0, "Z": 0}, "To": {"X": 1, "Y": 0, "Z": 0}}, "without finite points"),
        ("solve", "S", 1.5, "input 'S' must be between 0 and 1"),
    ],
)
def test_wrong_data_is_refused_by_the_name_of_its_input(server, name, input, data, part):
    inputs = {"Mesh": items(sheet().Encode()), "K": items(0.01), "Job": items("some-job"), input: items(data)}
    status, body = plain(server, name, **inputs)
    assert status == 422 and part in body["errors"][0] and body["message"] == body["errors"][0]


def test_texts_are_taken_as_they_were_meant(server, hops):
    # A name of a job that looks like a number, as Hops and as a script write it.
    vertices, faces = grid(4)
    for id in ("12345678", "true-or-false", "null-null"):
        server.client.submit(vertices, faces, id=id, supports="boundary", targets=0.5)
        wait_for(lambda id=id: server.client.poll(id)["state"] == "succeeded")
        for data in (id, json.dumps(id), *([12345678] if id.isdecimal() else [])):
            assert plain(server, "fetch", Job=items(data))[0] == 200
    for method in ("flow", '"flow"'):
        status, body = plain(server, "solve", Mesh=items(sheet().Encode()), K=items(0.005), Method=items(method), S=items(0.8))
        assert status == 200, body["message"]


# ----------------------------------------------------------------------
# Geometry
# ----------------------------------------------------------------------


def on_an_arc():
    """Return a mesh whose middle row of vertices lies on an arc, and the arc."""
    vertices, faces = grid(8, 9.0)
    radius = (4.5**2 + 1.0) / 2.0
    x = 5.5 - radius + np.sqrt(radius**2 - (vertices[:, 1] - 4.5) ** 2)
    vertices[:, 0] += (x - 4.5) * np.sin(np.pi * vertices[:, 0] / 9.0)
    ends = (rhino3dm.Point3d(*p) for p in ((4.5, 0, 0), (5.5, 4.5, 0), (4.5, 9, 0)))
    return mesh_from_arrays(vertices, faces), rhino3dm.Arc(*ends)


def test_a_crease_may_be_a_curve_of_any_class(hops, server):
    a, b, c = (rhino3dm.Point3d(4.5, y, 0.0) for y in (0.0, 4.5, 9.0))
    polycurve = rhino3dm.PolyCurve()
    polycurve.Append(rhino3dm.Line(a, b))
    polycurve.Append(rhino3dm.Line(b, c))
    straight = [rhino3dm.LineCurve(a, c), rhino3dm.PolylineCurve([a, b, c]), rhino3dm.LineCurve(a, c).ToNurbsCurve(), polycurve]
    mesh, arc = on_an_arc()
    curved = rhino3dm.PolyCurve()
    curved.Append(arc)
    round = [curved.SegmentCurve(0), arc.ToNurbsCurve(), curved]
    for curves, inputs in ((straight, two_regions()), (round, two_regions(Mesh=mesh))):
        met = []
        for curve in curves:
            status, outputs, errors, _ = hops("solve").solve(**{**inputs, "Creases": [curve]})
            assert (status, errors) == (200, []) and outputs["Info"][0].count("region ") == 2, type(curve).__name__
            met.append(outputs["Mesh"][0].Encode())
        assert all(one == met[0] for one in met)
    ends = {"From": {"X": 4.5, "Y": 0, "Z": 0}, "To": {"X": 4.5, "Y": 9, "Z": 0}, "Direction": {}}
    for data in (ends, json.dumps(ends)):
        points = items({"X": 2, "Y": 4, "Z": 0}, {"X": 7, "Y": 4, "Z": 0})
        found = plain(
            server, "solve", Mesh=items(sheet().Encode()), K=items(0.01, 0.02), At=points, Creases=items(data), Method=items("flow")
        )
        assert found[0] == 200 and found[1]["values"][1]["InnerTree"]["{0}"][0]["data"].count("region ") == 2
    assert {type(curve).__name__ for curve in straight + round} == {"LineCurve", "PolylineCurve", "NurbsCurve", "PolyCurve", "ArcCurve"}


@pytest.mark.parametrize("archive", [60, 70, 80, "60", "70", "80"])
def test_archives_of_all_versions_of_rhino_are_read(server, archive):
    encoded = {**sheet().Encode(), "archive3dm": archive}
    if isinstance(archive, str):
        encoded = {name: str(value) for name, value in encoded.items()}
    for data in (encoded, json.dumps(encoded)):
        assert plain(server, "dome", Mesh=items(data), K=items(0.01))[0] == 200


def test_other_things_than_meshes_are_named(server):
    box = rhino3dm.Brep.CreateFromSphere(rhino3dm.Sphere(rhino3dm.Point3d(0, 0, 0), 1.0))
    line = rhino3dm.LineCurve(rhino3dm.Point3d(0, 0, 0), rhino3dm.Point3d(1, 0, 0))
    for thing in (box, rhino3dm.SubD(), line, rhino3dm.Point(rhino3dm.Point3d(0, 0, 0))):
        status, body = plain(server, "dome", Mesh=items(thing.Encode()), K=items(0.01))
        assert status == 422 and f"input 'Mesh' is a {type(thing).__name__}, not a mesh; convert it with Mesh" in body["errors"][0]
    status, body = plain(server, "solve", Mesh=items(sheet().Encode()), K=items(0.01), Creases=items(sheet().Encode()))
    assert status == 422 and "input 'Creases' is a Mesh, not a curve" in body["errors"][0]


def test_units_and_tolerance_of_the_document_are_used_and_told(hops):
    vertices, faces = grid(8, 9.0)
    torn = vertices[faces].reshape(-1, 3) + np.random.default_rng(1).uniform(-2e-3, 2e-3, (3 * len(faces), 3))
    mesh = mesh_from_arrays(torn, np.arange(len(torn)).reshape(-1, 3))
    status, outputs, _, _ = hops("dome").solve(Mesh=mesh, K=0.01, tolerance=0.02, units="Feet")
    assert status == 200 and re.search(r"303 vertices were welded to others within [\d.]+ ft", outputs["Info"][0])
    for tolerance in (1e-6, 0.0):
        assert hops("dome").solve(Mesh=mesh, K=0.01, tolerance=tolerance)[0] == 422


# ----------------------------------------------------------------------
# The envelope
# ----------------------------------------------------------------------


def test_a_pointer_is_taken_apart_and_never_followed(server):
    with socket.create_server(("127.0.0.1", 0)) as trap:
        trap.settimeout(0.3)
        elsewhere = f"http://127.0.0.1:{trap.getsockname()[1]}"
        values = [{"ParamName": "Mesh", "InnerTree": items(sheet().Encode())}, {"ParamName": "K", "InnerTree": items(0.01)}]
        for pointer, expected in (
            (f"{elsewhere}/cgc/dome", 200),
            (f"{elsewhere}/cgc/dome/?a=b#c", 200),
            ("/CGC/Dome/", 200),
            (f"{elsewhere}/definition.gh", 404),
            ("file:///etc/passwd", 404),
            ("http://[broken/cgc/dome", 404),
            ("../../etc/passwd", 404),
            ("", 404),
            (5, 404),
            ({"a": 1}, 404),
        ):
            for field in ("pointer", "algo"):
                if field == "algo" and not isinstance(pointer, str):
                    continue
                named = (
                    {"pointer": pointer} if field == "pointer" else {"pointer": None, "algo": base64.b64encode(pointer.encode()).decode()}
                )
                status, _, content = server.ask("POST", "/solve", json.dumps({**named, "values": values}).encode())
                assert status == expected, (named, content[:200])
        with pytest.raises(socket.timeout):
            trap.accept()
    for algo in ("not base64", "Y2djL3NvbHZ", base64.b64encode(b"\xff\xfe").decode(), base64.b64encode(5000 * b"A").decode(), None, 5):
        assert server.ask("POST", "/solve", json.dumps({"pointer": None, "algo": algo, "values": values}).encode())[0] == 404


@pytest.mark.parametrize("body", [b"", b"{", b"[]", b"[{},{}]", b"null", b'"cgc/dome"', b"[[{}]]", b"\xff\xfe{}", b'{"pointer": NaN}'])
def test_what_is_no_request_is_answered_so_that_hops_can_show_it(hops, server, body):
    component = hops("dome")
    for address in ("/solve", "/grasshopper", "/cgc/solve"):
        status, outputs, errors, _ = component.post(body, address)
        assert status == 400 and outputs == {} and errors[0]


def test_a_request_with_a_byte_order_mark_a_list_around_it_and_any_type_is_read(hops):
    component = hops("dome")
    body = json.dumps(component.request(Mesh=sheet(), K=0.01))
    for content, kind in (
        (b"\xef\xbb\xbf" + body.encode(), "text/plain;charset=UTF-8"),
        (f"[{body}]".encode(), "application/x-www-form-urlencoded"),
    ):
        assert component.post(content, "/grasshopper", kind)[0] == 200
        assert component.post(content, kind=kind, **{"Accept-Encoding": "gzip, deflate, br"})[0] == 200


def test_a_client_that_asks_before_it_sends_is_told_to_go_on(server, hops):
    body = json.dumps(hops("dome").request(Mesh=sheet(), K=0.01)).encode()
    host, port = server.address.split(":")
    head = f"POST /solve HTTP/1.1\r\nHost: {server.address}\r\nRhinoComputeKey: {KEY}\r\n"
    head += f"Content-Length: {len(body)}\r\nExpect: 100-continue\r\n\r\n"
    with socket.create_connection((host, int(port)), PATIENCE) as connection:
        connection.sendall(head.encode())
        assert connection.recv(1000).startswith(b"HTTP/1.1 100 ")
        connection.sendall(body)
        assert connection.recv(1000).startswith(b"HTTP/1.1 200 ")


def test_an_answer_has_an_entry_for_every_output_and_no_decimal_point(hops):
    inputs = {"K": 0.0123, "Target": 0.1, "Steps": 3}
    for name in ("dome", "flow", "analyse", "solve", "submit"):
        component = hops(name, comma=True)
        own = {entry["Name"]: inputs[entry["Name"]] for entry in component.description["Inputs"] if entry["Name"] in inputs}
        own["K"] = [own["K"]] if name in ("solve", "submit") else own.get("K")
        status, outputs, _, _ = component.solve(Mesh=sheet(), **{key: value for key, value in own.items() if value is not None})
        assert status == 200 and list(outputs) == component.description["OutputNames"]
        for value in json.loads(component.content)["values"]:
            for item in value["InnerTree"].get("{0}", []):
                assert isinstance(item["data"], str)
                assert item["type"] != "System.Double" or re.fullmatch(r"-?\d+(E-?\d+)?", item["data"])


def test_a_job_that_runs_is_never_kept_by_the_memory_of_the_client(server, hops):
    submit, fetch = hops("submit", memory=True), hops("fetch", memory=True)
    # Far from its targets and without strategy it takes all of its steps.
    _, outputs, _, _ = submit.solve(Mesh=sheet(60), K=[0.02], Method="flow", S=0.79, Tolerance=1e-12)
    (job,) = outputs["Job"]
    wait_for(lambda: server.client.poll(job)["iteration"] > 0)
    for _ in range(2):
        status, outputs, errors, warnings = fetch.solve(Job=job)
        assert (status, errors, warnings) == (202, [], []) and list(outputs) == fetch.description["OutputNames"]
        assert outputs["Mesh"] == [] and outputs["Done"] == [False] and 0.0 <= outputs["Progress"][0] < 1.0
        assert re.match(r"running, step \d+, largest error ", outputs["Info"][0])
    server.client.cancel(job)
    wait_for(lambda: server.client.poll(job)["state"] == "cancelled")
    status, outputs, errors, _ = fetch.solve(Job=job)
    assert status == 422 and outputs == {} and errors[0].startswith("the job was cancelled")
    server.client.delete(job)
    assert fetch.solve(Job=job)[0] == 404


def test_the_progress_of_a_job_may_have_no_number(server, hops, monkeypatch):
    """What is no finite number comes as null from the worker."""
    from compas_cgc.server.hops import routes
    from compas_cgc.server.jobs.store import Job

    job = Job("a-job-id", "running", 0.0, 0.0, None, 1, "", "", "", {"step": 2, "steps": 10, "max_error": None}, None, None)
    monkeypatch.setattr(routes, "jobs", lambda: type("Jobs", (), {"get": lambda self, id: job})())
    reply = routes._fetch([{"ParamName": "Job", "InnerTree": items("a-job-id")}])
    assert reply.status == 202 and reply.values[3]["InnerTree"]["{0}"][0]["data"] == "running, step 2"


# ----------------------------------------------------------------------
# Texts and numbers on the wire
# ----------------------------------------------------------------------


def reader(generation, comma=False):
    component = Hops.__new__(Hops)
    component.generation, component.comma = generation, comma
    return component


@given(st.floats(allow_nan=False, allow_infinity=False))
def test_every_number_is_read_in_every_culture(value):
    item = {"type": "System.Double", "data": format_number(value)}
    assert [reader(8, comma).read(item) for comma in (False, True)] == [value, value]


@given(
    st.text()
    | st.sampled_from(["12.50", " 7 ", "true", "null", "-1e5", "NaN", "Infinity", "[1]", "{}", '{"a": 1}', "a\nb", "é\u2028", '5 "m"'])
)
def test_every_text_is_shown_as_it_is(text):
    # Quotes at the ends are trimmed by Hops, and objects with backslashes unescaped: no text of the server has either.
    if text.strip('"') == text and not (text.strip().startswith("{") and "\\" in text):
        item = {"type": "System.String", "data": format_text(text)}
        assert [reader(generation).read(item) for generation in (7, 8, 2026)] == [text, text, text]


@pytest.mark.parametrize(
    "spoil, part",
    [
        (lambda body: body["values"].pop(), "outputs have changed"),
        (lambda body: body["values"].append(body["values"][0]), "outputs have changed"),
        (lambda body: body.update(warnings=None), "warnings is no list"),
        (lambda body: body.update(errors=["Traceback (most recent call last)"]), "not for the eyes"),
        (lambda body: body["values"][2]["InnerTree"]["{0}"][0].update(data={"a": 1}), "cannot be read"),
        (lambda body: body["values"][2]["InnerTree"]["{0}"][0].update(data="NaN"), "poisons"),
        (lambda body: body["values"][2]["InnerTree"]["{0}"][0].update(type="System.Int32"), "unknown type"),
        (lambda body: body["values"][0].update(InnerTree=None), "null"),
        (lambda body: body["values"][0].update(InnerTree={"0": []}), "no path"),
        (lambda body: body.pop("message"), "message"),
    ],
)
def test_the_stand_in_raises_where_hops_would_fail(hops, spoil, part):
    component = hops("dome")
    component.solve(Mesh=sheet(), K=0.01)
    body = json.loads(component.content)
    component._schema(json.dumps(body).encode(), 200)
    spoil(body)
    with pytest.raises(HopsError, match=part):
        component._schema(json.dumps(body).encode(), 200)


def test_the_stand_in_reads_numbers_as_hops_does():
    point = {"type": "System.Double", "data": "0.25"}
    assert (reader(8).read(point), reader(8, comma=True).read(point)) == (0.25, 25.0)
    assert reader(8).shown('"line1\\nline2"') == "line1\\nline2" and reader(2026).shown('"line1\\nline2"') == "line1\nline2"
    assert [reader(2026).shown(text) for text in ("true", "null", "12.50")] == ["True", "", "12.5"]
    for kind, data in (("System.Int32", "3.0"), ("System.Boolean", "yes"), ("System.Decimal", "1")):
        with pytest.raises(HopsError):
            reader(8).read({"type": kind, "data": data})
    for entry, part in (
        ({"ParamType": "Number", "Default": "-0.25", "AtMost": 1}, "scalar of its type"),
        ({"ParamType": "Number", "Default": 1.0, "AtLeast": 0}, "input of lists"),
        ({"ParamType": "Value List"}, "unknown type"),
    ):
        component = reader(8)
        component.description = {
            "Description": "d",
            "InputNames": ["A"],
            "OutputNames": [],
            "Inputs": [{"Name": "A", **entry}],
            "Outputs": [],
        }
        with pytest.raises(HopsError, match=part):
            component._check()
    assert write(1e-07, "Number") == {"type": "System.Double", "data": "1E-07"}
