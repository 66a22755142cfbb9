"""The functions for Grasshopper, asked as Hops of all generations and McNeel's own clients ask."""

from __future__ import annotations

import base64
import json
import re
import time

import numpy as np
import pytest
import rhino3dm

from compas_cgc.discrete import gaussian_curvature
from compas_cgc.io.rhino.meshes import mesh_from_arrays
from compas_cgc.model.measures import measured_curvature
from compas_cgc.model.problem import CGCProblem
from compas_cgc.server.hops.data_tree import format_number
from compas_cgc.server.hops.data_tree import format_text

from ...support.hops_client import Hops
from ...support.hops_client import HopsError
from ...support.hops_client import get
from ...support.server_process import KEY
from ...support.server_process import wait_for
from ...support.shapes import grid

GENERATIONS = (7, 8, 2026)


@pytest.fixture
def hops(server):
    return lambda name, generation=8, comma=False: Hops(f"{server.url}/cgc/{name}", generation, KEY, comma)


def sheet(n=8, width=9.0):
    return mesh_from_arrays(*grid(n, width))


def arrays(mesh):
    vertices = np.array([(p.X, p.Y, p.Z) for p in mesh.Vertices.ToPoint3dArray()])
    return vertices, np.array(list(mesh.Faces))[:, :3]


def line(*points):
    return rhino3dm.PolylineCurve([rhino3dm.Point3d(*map(float, p)) for p in points])


@pytest.mark.parametrize("generation", GENERATIONS)
@pytest.mark.parametrize("comma", [False, True])
def test_a_dome_in_every_generation_and_culture(hops, generation, comma):
    status, outputs, errors, warnings = hops("dome", generation, comma).solve(Mesh=sheet(), K=0.0125)
    assert (status, errors, warnings) == (200, [], [])
    vertices, faces = arrays(outputs["Mesh"][0])
    inner = (np.abs(vertices[:, :2] - 4.5) < 4.4).all(axis=1)
    solved = CGCProblem(vertices, faces).with_supports("boundary").with_targets(0.0125)
    assert np.allclose(measured_curvature(solved)[inner], 0.0125) and vertices[inner, 2].min() > 0
    assert 0 <= outputs["Error"][0] < 1e-6 and "converged" in outputs["Info"][0]


@pytest.mark.parametrize("generation", GENERATIONS)
def test_the_functions_are_described(server, generation):
    status, kind, body = get(server.url + "/")
    listed = json.loads(body)
    assert isinstance(listed, list) and {entry["Uri"] for entry in listed} == {
        f"/cgc/{name}"
        for name in (
            "dome",
            "solve",
            "goals",
            "flow",
            "analyse",
            "mould",
            "unroll",
            "membrane",
            "net",
            "quads",
            "rationalise",
            "submit",
            "fetch",
        )
    }
    for entry in listed:
        component = Hops(server.url + entry["Uri"], generation)
        assert component.description == entry == Hops(server.url + entry["Uri"] + "/", generation).description
        assert "xmlns" in entry["Icon"] and "svg" in entry["Icon"]
        assert entry == json.loads(get(f"{server.url}/io?pointer={entry['Uri'].strip('/')}")[2])
    assert Hops(server.url + "/cgc/dome", generation).access("Mesh") == "item"
    # No optional inputs where Rhino 7 has to do without.
    for name in ("dome", "flow", "analyse", "fetch"):
        assert all(entry["AtLeast"] == 1 for entry in Hops(f"{server.url}/cgc/{name}", 7).description["Inputs"])


@pytest.mark.parametrize("generation", GENERATIONS)
@pytest.mark.parametrize(
    ("path", "sentence"),
    [("/cgc/nothing", "no function 'cgc/nothing'"), ("/gcg/dome", "nothing at this address"), ("/solve", "GET requests")],
)
def test_a_mistyped_path_is_said_on_the_component(server, generation, path, sentence):
    with pytest.raises(HopsError, match=sentence):
        Hops(server.url + path, generation)
    told = json.loads(get(server.url + path)[2])
    assert all(told[name] == [] for name in ("Inputs", "Outputs", "InputNames", "OutputNames")) and sentence in told["errors"][0]


def test_two_regions_with_a_crease_and_free_edges(hops):
    crease = line((4.5, 0, 0), (4.5, 9, 0))
    inputs = {"Mesh": sheet(), "Creases": [crease], "K": [0.01, 0.02], "At": [(2, 4, 0), (7, 4, 0)]}
    status, outputs, errors, _ = hops("solve").solve(**inputs, Supports=[(0, 0, 0), (9, 0, 0), (0, 9, 0), (9, 9, 0)], Method="projection")
    assert (status, errors) == (200, [])
    vertices, faces = arrays(outputs["Mesh"][0])
    plan, _ = grid(8, 9.0)
    inner = (np.abs(plan[:, :2] - 4.5) < 4.4).all(axis=1)
    K = gaussian_curvature(vertices, faces)
    left, right = (np.abs(K - asked)[inner & side].max() for asked, side in ((0.01, plan[:, 0] < 4), (0.02, plan[:, 0] > 5)))
    assert outputs["Error"] == [pytest.approx(max(left, right), rel=1e-6)] and outputs["Error"][0] < 1e-9
    told = outputs["Info"][0].splitlines()
    left_lines = r"free edges left their drawn lines by up to [\d.]+ in plan"
    ending = re.fullmatch(rf"converged in \d+ steps: largest \|K - K̄\| (\S+); {left_lines} \(\d+\.\d\d s\)", told[1])
    assert float(ending.group(1)) < 1e-14
    assert (
        told[0].startswith("fair: heights from ")
        and told[0].endswith(" K from 0.01 to 0.02 in 2 regions as prescribed, supported at 4 of 81 vertices")
        and told[2:]
        == [
            "the mesh has 81 vertices and 128 triangles in 1 piece, 9 x 9 x 0 m",
            "4 vertices are supports",
            "1 curve is a crease",
            f"region 0: 64 triangles, K̄ 0.01, largest |K - K̄| {left:.3g}",
            f"region 1: 64 triangles, K̄ 0.02, largest |K - K̄| {right:.3g}",
        ]
    )


def test_the_strategies_of_the_flow_are_passed_on(hops):
    crease = line((4.5, 0, 0), (4.5, 9, 0))
    highest = []
    for s in (0.9, 0.2):
        status, outputs, _, _ = hops("solve").solve(Mesh=sheet(), Creases=[crease], K=[0.005], Method="flow", S=s)
        assert status == 200
        highest.append(max(p.Z for p in outputs["Mesh"][0].Vertices.ToPoint3dArray()))
    assert highest[1] < 0.95 * highest[0], "creases that follow less keep the surface lower"


def test_an_unwelded_quad_mesh_in_millimetres_far_away_is_taken(hops):
    mesh = rhino3dm.Mesh()
    for i in range(8):
        for j in range(8):
            corners = [(i, j), (i + 1, j), (i + 1, j + 1), (i, j + 1)]
            first = len(mesh.Vertices)
            for x, y in corners:
                mesh.Vertices.AddPoint3d(1e6 + 1000.0 * x, 2e6 + 1000.0 * y, 0.0)
            mesh.Faces.AddFace(first, first + 1, first + 2, first + 3)
    component = hops("dome")
    body = component.request(Mesh=mesh, K=1e-8)
    body.update(modelunits="Millimeters", absolutetolerance=0.01)
    status, outputs, errors, _ = component.post(json.dumps(body).encode())
    assert (status, errors) == (200, []) and "welded" in outputs["Info"][0] and "split into triangles" in outputs["Info"][0]
    assert len(outputs["Mesh"][0].Vertices) == 81


def test_any_path_any_case_and_numbers_as_numbers(hops):
    component = hops("dome")
    _, expected, _, _ = component.solve(Mesh=sheet(), K=0.01)
    for path in ("0", "{0;0}", "{0;3;1}", "0;1"):
        status, outputs, errors, _ = component.solve(path, Mesh=sheet(), K=0.01)
        assert (status, errors, outputs["Error"]) == (200, [], expected["Error"])
    body = component.request(Mesh=sheet(), K=0.01)
    body["values"][0]["InnerTree"]["{0}"][0] = {"data": sheet().Encode()}
    body["values"][1]["InnerTree"]["{0}"][0] = {"data": 0.01}
    for whole, address, kind in (
        (body, "/grasshopper", "text/plain"),
        ([body], "/cgc/solve", ""),
        ({**body, "pointer": "/cgc/dome"}, "/a/b/solve", "x"),
    ):
        assert component.post(json.dumps(whole).encode(), address, kind)[1]["Error"] == expected["Error"]
    named = {**body, "pointer": None, "algo": base64.b64encode(b"cgc/dome").decode()}
    assert component.post(json.dumps(named).encode())[0] == 200
    assert component.post(json.dumps({**body, "pointer": "http://elsewhere:5000/cgc/dome"}).encode())[0] == 200


def test_the_flow_moves_step_by_step(hops):
    component, mesh, errors = hops("flow"), sheet(), []
    for _ in range(4):
        status, outputs, _, warnings = component.solve(Mesh=mesh, K=0.01, Steps=25)
        assert (status, warnings) == (200, [])
        mesh = outputs["Mesh"][0]
        errors += outputs["Error"]
    assert errors == sorted(errors, reverse=True) and errors[-1] < 0.5 * errors[0]


@pytest.mark.parametrize("comma", [False, True])
def test_an_analysis_gives_a_number_per_vertex(hops, comma):
    vertices, faces = grid(12, 2.0)
    x, y = (vertices[:, :2] - 1.0).T
    vertices[:, 2] = np.sqrt(9.0 - x**2 - y**2)
    status, outputs, errors, _ = hops("analyse", comma=comma).solve(Mesh=mesh_from_arrays(vertices, faces), Target=1 / 9)
    assert (status, errors) == (200, [])
    K, H = np.array(outputs["K"]), np.array(outputs["H"])
    inner = (np.abs(np.column_stack([x, y])) < 0.6).all(axis=1)
    assert len(K) == len(H) == 169 and np.allclose(K[inner], 1 / 9, rtol=0.02) and np.allclose(np.abs(H[inner]), 1 / 3, rtol=0.02)
    assert len(outputs["Mesh"][0].VertexColors) == 169 and "region" in outputs["Info"][0]


def test_a_law_replaces_the_curvature_of_its_region(hops):
    status, outputs, errors, _ = hops("solve").solve(Mesh=sheet(), K=[0.02], Law="H = 0.1")
    assert (status, errors) == (200, []) and "H = 0.1" in outputs["Info"][0]
    one = arrays(outputs["Mesh"][0])[0]
    _, outputs, _, _ = hops("solve").solve(Mesh=sheet(), K=[0.02], Law="0=H = 0.1;")
    assert np.abs(arrays(outputs["Mesh"][0])[0] - one).max() < 1e-9
    _, _, errors, _ = hops("solve").solve(Mesh=sheet(), K=[0.02], Law="H + ")
    assert "is not a law; write minimal" in str(errors)
    _, _, errors, _ = hops("solve").solve(Mesh=sheet(), K=[0.02], Law="7=minimal")
    assert "region 7" in str(errors)


def test_a_dome_is_solved_exactly_and_laid_onto_its_sphere(hops):
    status, outputs, errors, _ = hops("solve").solve(Mesh=sheet(), K=[0.02], Measure="exact", Method="newton")
    assert (status, errors) == (200, []) and "in the exact measure" in outputs["Info"][0]
    status, outputs, errors, _ = hops("mould").solve(Mesh=outputs["Mesh"][0], K=[0.02], Count=4, Material="steel", Thickness=3.0)
    assert (status, errors) == (200, [])
    assert len(outputs["Panels"]) == len(outputs["OnMoulds"]) == len(outputs["Names"]) == len(outputs["Misses"]) == 4
    assert len(outputs["Moulds"]) == 1 and outputs["Mould"] == [0] * 4 and "3 mm of steel" in outputs["Info"][0]
    for panel, laid in zip(outputs["Panels"], outputs["OnMoulds"]):
        (V, F), (W, _) = arrays(panel), arrays(laid)
        assert np.abs(np.linalg.norm(W + [0, 0, 50**0.5], axis=1) - 50**0.5).max() < 1e-9
        for a, b in ((0, 1), (1, 2), (2, 0)):
            here, there = (np.linalg.norm(P[F[:, a]] - P[F[:, b]], axis=1) for P in (W, V))
            assert np.allclose(here, there, rtol=1e-9)


def test_submit_and_fetch(server, hops):
    # Jobs on both workers keep the job in the queue until they are cancelled.
    endless = {"supports": "boundary", "targets": 0.5, "method": "flow", "settings": {"steps": 100000, "tolerance": 0.0}}
    before = [server.client.submit(*grid(20), **endless) for _ in range(2)]
    wait_for(lambda: all(server.client.poll(id)["state"] == "running" for id in before))
    _, outputs, errors, _ = hops("submit").solve(Mesh=sheet(20), K=[0.01], Method="flow")
    (job,) = outputs["Job"]
    assert errors == []
    fetch = hops("fetch", comma=True)
    status, outputs, errors, _ = fetch.solve(Job=job, Tick=0)
    for tick in range(1, 10**6):
        assert status == 202 and outputs["Mesh"] == [] and outputs["Done"] == [False] and 0 <= outputs["Progress"][0] <= 1
        for id in before:
            server.client.cancel(id)
        time.sleep(0.02)
        status, outputs, errors, warnings = fetch.solve(Job=job, Tick=tick)
        if status == 200:
            break
    assert outputs["Done"] == [True] and outputs["Progress"] == [1.0]
    assert outputs["Mesh"][0].IsValid and errors == [] and warnings == []
    status, _, errors, _ = fetch.solve(Job="nobody-has-this", Tick=0)
    assert status == 404 and "no job" in errors[0]


def damaged():
    encoded = sheet().Encode()
    return {**encoded, "data": "A" + encoded["data"][1:-40]}


@pytest.mark.parametrize(
    "name, data, part",
    [
        ("Mesh", "nonsense", "input 'Mesh'"),
        ("Mesh", [1, 2], "input 'Mesh'"),
        ("Mesh", {"version": 10000}, "input 'Mesh' cannot be decoded"),
        ("Mesh", damaged(), "input 'Mesh'"),
        ("Mesh", line((0, 0, 0), (1, 0, 0)).Encode(), "not a mesh"),
        ("Mesh", rhino3dm.Mesh().Encode(), "without vertices or faces"),
        ("Mesh", mesh_from_arrays(np.eye(3), np.array([[0, 1, 2]])).Encode(), "no internal vertex"),
        ("K", "NaN", "finite"),
        ("K", "one", "input 'K' cannot be read"),
        ("K", "1e999", "finite"),
        ("K", True, "must be a number"),
        ("K", {}, "must be a number"),
        ("K", 5.0, "too large for this boundary"),
        ("K", None, "input 'K' is empty"),
    ],
)
def test_wrong_inputs_are_named_in_the_balloon(hops, name, data, part):
    component = hops("dome")
    body = component.request(Mesh=sheet(), K=0.01)
    entry = next(value for value in body["values"] if value["ParamName"] == name)
    entry["InnerTree"] = {} if data is None else {"{0}": [{"data": data}]}
    status, outputs, errors, _ = component.post(json.dumps(body).encode())
    assert status == 422 and outputs == {} and part in errors[0]


def test_wrong_requests_are_answered_so_that_hops_can_show_it(hops, server):
    component = hops("dome")
    for body, expected in (
        (b"{", 400),
        (b"[]", 400),
        (b"5", 400),
        (b"{}", 404),
        (b'{"pointer": "cgc/none"}', 404),
        (b'{"pointer": "cgc/dome"}', 422),
    ):
        status, _, errors, _ = component.post(body)
        assert status == expected and errors[0]
    for values in (5, [5], [{"ParamName": "Mesh", "InnerTree": []}], [{"ParamName": "Mesh", "InnerTree": {"x": []}}]):
        status, _, errors, _ = component.post(json.dumps({"pointer": "cgc/dome", "values": values}).encode())
        assert status == 422 and errors[0]
    component.key = None
    status, _, errors, _ = component.post(b"{}")
    assert status == 401 and "Preferences" in errors[0]
    solve = hops("solve")
    for inputs, part in (
        ({"K": [0.1, 0.2]}, "'K' has 2 numbers"),
        ({"K": [0.1], "At": [(0, 0, 0), (1, 1, 1)]}, "'At' has 2 points"),
        ({"K": [0.1], "Method": "magic"}, "'method' must be one of"),
        ({"K": [0.1], "Supports": [(50, 50, 0)]}, "input 'Supports'"),
        ({"K": [0.1], "Creases": [line((50, 50, 0), (60, 50, 0))]}, "input 'Creases'"),
    ):
        status, _, errors, _ = solve.solve(Mesh=sheet(), **inputs)
        assert status == 422 and part in errors[0]


def test_a_client_that_hangs_up_stops_its_solve(server, hops):
    import socket

    component = hops("flow")
    body = json.dumps(component.request(Mesh=sheet(90), K=0.01, Steps=10000)).encode()
    host, port = server.url.split("//")[1].split(":")
    with socket.create_connection((host, int(port))) as connection:
        head = f"POST /solve HTTP/1.1\r\nHost: {host}:{port}\r\nRhinoComputeKey: {KEY}\r\nContent-Length: {len(body)}\r\n\r\n"
        connection.sendall(head.encode() + body)
        wait_for(lambda: server.client.health()["busy"] == 1)
    wait_for(lambda: server.client.health()["busy"] == 0, what="it would take many minutes to its end")


def test_the_client_of_mcneel_runs(server):
    compute = pytest.importorskip("compute_rhino3d")
    from compute_rhino3d import Grasshopper
    from compute_rhino3d import Util

    assert compute
    Util.url, Util.apiKey = server.url + "/", KEY
    trees = [Grasshopper.DataTree("Mesh"), Grasshopper.DataTree("K")]
    trees[0].Append([0], [json.dumps(sheet().Encode())])
    trees[1].Append([0], [0.01])
    answer = Grasshopper.EvaluateDefinition(f"{server.url}/cgc/dome", trees)
    values = {value["ParamName"]: value["InnerTree"]["{0}"][0]["data"] for value in answer["values"]}
    assert float(values["Error"]) < 1e-6 and rhino3dm.CommonObject.Decode(json.loads(values["Mesh"])).IsValid


def test_numbers_have_no_decimal_point_and_come_back():
    values = [0.25, -2.512345678901234, 1e-07, 1e22, 3.0, -0.0, 0.1, 123456.789, 5e-324, 1.7976931348623157e308, 1200.0, -7.0]
    assert [format_number(value) for value in values[:6]] == ["25E-2", "-2512345678901234E-15", "1E-7", "1E22", "3", "0"]
    assert format_number(np.float64(0.25)) == "25E-2"
    for value in [*values, *np.random.default_rng(1).normal(size=300), *10.0 ** np.arange(-300, 300, 7)]:
        text = format_number(value)
        assert "." not in text and "," not in text and float(text) == value


def test_texts_that_look_like_numbers_are_quoted():
    assert [format_text(text) for text in ("12.50", "true", "null", "hello", "a\nb")] == ['"12.50"', '"true"', '"null"', "hello", "a\nb"]
