"""Builds over HTTP: moulds, flat patterns, forces, nets and limits of a surface, as arrays and as files, or a sentence."""

from __future__ import annotations

import io
import json
import zipfile

import numpy as np
import pytest

from compas_cgc import CGCMesh
from compas_cgc import CGCProblem
from compas_cgc import write
from compas_cgc.client import Failed
from compas_cgc.client import Refused
from compas_cgc.fabrication import curve_net
from compas_cgc.fabrication import draw_views
from compas_cgc.fabrication import membrane
from compas_cgc.fabrication import moulds
from compas_cgc.fabrication import panels
from compas_cgc.fabrication import unroll
from compas_cgc.fabrication.option_values import ALONG
from compas_cgc.fabrication.panelling import panels as divided
from compas_cgc.io import read_problem

from ...support.constant_curvature import cone
from ...support.constant_curvature import revolved_patch
from ...support.freeform import mesh_over
from ...support.freeform import nurbs_file
from ...support.server_process import KEY
from ...support.server_process import wait_for
from ...support.shapes import grid

HEADS = {
    "step": b"ISO-10303-21",
    "ifc": b"ISO-10303-21",
    **{"list.csv": b"sheet,piece", "plan.dxf": b"  0\nSECTION", "plan.svg": b"<svg ", "zip": b"PK"},
    "3dm": b"3D Geometry File Format ",
    "dxf": b"  0\nSECTION",
    "svg": (b"<svg ", b"<?xml"),
    "csv": b"p",
    "inp": b"*",
    "pdf": b"%PDF",
    "laths.csv": b"lath,",
    "laths.dxf": b"  0\nSECTION",
    "json": b"{",
}


@pytest.fixture(scope="module")
def client(server):
    return server.client


CONE, DOME, SADDLE = (cone(6, 24), 0.0), (revolved_patch(10, 0.02), 0.02), (revolved_patch(12, -0.02), -0.02)


def asked(shape):
    (vertices, faces), K = shape
    return vertices, faces, {"supports": "boundary", "targets": K}


def problem(shape):
    (vertices, faces), K = shape
    return CGCProblem(vertices, faces).with_supports("boundary").with_targets(K)


@pytest.mark.parametrize(
    "task, shape, settings, made",
    [
        ("mould", DOME, {"count": 4, "material": "timber"}, lambda own: moulds(own, divided(own, count=4), material="timber")),
        ("unroll", CONE, {"sheet": "6000x3000mm", "rulings": 0.4}, lambda own: unroll(own, (6.0, 3.0), rulings=0.4)),
        ("unroll", DOME, {"sheet": [3, 1.5], "strain": "1%"}, lambda own: unroll(own, (3.0, 1.5), strain=0.01)),
        ("membrane", DOME, {"pressure": -1.5}, lambda own: membrane(own, -1.5)),
        ("net", SADDLE, {"spacing": 1.0}, lambda own: curve_net(own, 1.0)),
        ("drawings", DOME, {"sections": "0,1,4,1", "scale": 200}, lambda own: draw_views(own, 200, sections=[(0, 1, 4, 1)])),
        ("net", SADDLE, {"through": [[0.0, 0.0, 4.0]]}, lambda own: curve_net(own, through=[[0.0, 0.0, 4.0]])),
    ],
)
def test_a_build_is_what_python_gives_as_arrays_and_as_files(client, task, shape, settings, made):
    vertices, faces, options = asked(shape)
    states = []
    told = client.build(task, vertices, faces, settings=settings, on_progress=states.append, **options)
    assert told["text"] == str(made(problem(shape))) and told["task"] == task == states[-1]["task"]
    assert set(told["formats"]) <= {"arrays", *HEADS}
    for name in told["formats"][1:]:
        assert client.result(told["id"], name).startswith(HEADS[name])
    with pytest.raises(Refused, match="its formats are arrays"):
        client.result(told["id"], "obj")


def test_what_is_drawn_is_the_surface(client):
    vertices, faces, options = asked(CONE)
    told = client.build("unroll", vertices, faces, settings={"sheet": "6.0x3.0"}, **options)
    place = told["in_place"]
    V, F = np.array(place["vertices"]), np.array(place["triangles"])
    assert np.linalg.norm(np.cross(V[F[:, 1]] - V[F[:, 0]], V[F[:, 2]] - V[F[:, 0]]), axis=1).sum() / 2 == pytest.approx(told["area"])
    assert {line["layer"] for line in told["lines"]} >= {"CUT", "SHEET"} and len(told["pieces"]) == 1 + max(place["piece"])
    length, width = told["sheet"]
    for piece in told["pieces"]:
        (low, high) = (own(np.array(piece["outlines"][0]), axis=0) for own in (np.min, np.max))
        assert (low >= -1e-9).all() and (high <= [length + 1e-9, width + 1e-9]).all()
    vertices, faces, options = asked(DOME)
    told = client.build("mould", vertices, faces, settings={"size": 2.5}, **options)
    assert len(told["panels"]) == len(panels(problem(DOME), 2.5)) and {"rigid", "stress", "outlines", "on_mould"} <= set(told["panels"][0])
    told = client.build("membrane", vertices, faces, settings={"pressure": 2.0}, **options)
    state = membrane(problem(DOME), 2.0)
    assert np.allclose(told["face_forces"], state.forces) and len(told["N1"]) == len(vertices)
    assert np.shape(told["crosses"]["lines"])[0::3] == (2, 3) and set(told["line_loads"]["kind"]) == {"support"}


def test_sheets_have_margins_allowances_and_files_of_their_own(client):
    pytest.importorskip("shapely")
    vertices, faces, options = asked(CONE)
    given = {"sheet": [6, 3], "spacing": 0, "margin": 0.02, "allowance": 0.03, "per_sheet": True}
    told = client.build("unroll", vertices, faces, settings=given, **options)
    made = unroll(problem(CONE), (6.0, 3.0), spacing=0.0, margin=0.02, allowance=0.03)
    assert told["text"] == str(made) and "dxf" not in told["formats"]
    assert sum(line["layer"] == "CUT" for line in told["lines"]) == len(made.pieces)
    with zipfile.ZipFile(io.BytesIO(client.result(told["id"], "zip"))) as archive:
        assert len(archive.namelist()) == made.sheets + 2
    with pytest.raises(Refused, match="one per sheet; request the format zip"):
        client.result(told["id"], "dxf")


def test_a_panel_that_is_kept_whole_is_refused_on_a_smaller_sheet(client):
    vertices, faces, options = asked(CONE)
    with pytest.raises((Failed, Refused), match="more than a sheet of 3000 x 1500 mm; use larger sheets"):
        client.build("unroll", vertices, faces, settings={"sheet": [3, 1.5], "whole": True}, **options)


def test_the_result_of_a_job_a_file_and_a_compas_mesh_are_taken(client, server, tmp_path):
    vertices, faces = grid(8)
    solved = client.solve(vertices, faces, supports="boundary", targets=0.3, method="newton", settings={"measure": "exact"})
    by_job = client.build("mould", job=solved["id"], settings={"count": 4})
    surface = CGCProblem(np.array(solved["vertices"]), np.array(solved["faces"])).with_supports("boundary").with_targets(0.3)
    by_arrays = client.build("mould", surface.vertices, surface.faces, supports="boundary", targets=0.3, settings={"count": 4})
    assert by_job["panels"] == by_arrays["panels"] and max(own["edge_error"] for own in by_job["panels"]) < 1e-11
    write(tmp_path / "solved.3dm", surface)
    id = client.submit_file((tmp_path / "solved.3dm").read_bytes(), "3dm", task="mould", settings={"count": 4})
    wait_for(lambda: client.poll(id, wait=20)["state"] == "succeeded")
    assert client.result(id)["text"] == by_job["text"]
    mesh = json.loads(CGCMesh.from_problem(surface).to_jsonstring())
    body = json.dumps({"task": "mould", "mesh": mesh, "settings": {"count": 4}}).encode()
    status, _, content = server.ask("POST", "/api/v1/jobs", body, RhinoComputeKey=KEY)
    assert status == 202
    wait_for(lambda: client.poll(json.loads(content)["id"], wait=20)["state"] == "succeeded")
    assert client.result(json.loads(content)["id"])["text"] == by_job["text"]


def test_limits_tell_a_slider_where_to_end(client):
    vertices, faces = grid(6)
    told = client.build("limits", vertices, faces, supports="boundary", targets=1.0, settings={"tolerance": 0.1})
    assert told["status"] == "found" and told["target"] > 0 and "over these supports, fair surfaces were found for" in told["text"]


def test_a_design_becomes_panels_on_few_moulds(client):
    vertices, quads = mesh_over(lambda x, y: 1.0 - 0.03 * (x - 4.0) ** 2 - 0.04 * (y - 2.0) ** 2, 8.0, 4.0, 0.5)
    found = client.build("rationalise", vertices, np.array(quads), settings={"panel": 2.0, "moulds": 2, "edges": 3})
    assert found["status"] == "kept" and found["moulds"] == 2 and found["panels"] == 8
    assert np.abs(found["distances"]).max() == pytest.approx(found["distance"]["max"])
    assert len(found["panel_of_face"]) == len(found["faces"]) and found["formats"] == ["arrays", "3dm"]
    with pytest.raises((Failed, Refused), match="panel"):
        client.build("rationalise", vertices, np.array(quads), settings={"panel": -2.0})


@pytest.mark.parametrize(
    ("settings", "sentence"),
    [
        ({"costs": {"flat": [0, 100]}}, "costs must be given for flat, sphere, saddle"),
        ({"costs": {"flat": [0, 100], "sphere": [1, 2, 3], "saddle": [0, 1]}}, "the costs of sphere must be a list of 2 numbers"),
        ({"costs": {"flat": [0, 100], "sphere": [1, 2], "saddle": [-1, 1]}}, "costs of saddle must be two numbers from 0 up"),
        ({"weights": [[0, 0, 1]] * 5}, "every row of 'weights' must be a list of 5 numbers"),
        ({"weights": [[0, 0, 0, 1, 1]] * 1001}, "'weights' has 1001 rows; give at most 1000"),
    ],
)
def test_wrong_costs_and_weights_are_refused_before_a_job_starts(client, settings, sentence):
    vertices, quads = mesh_over(bowl, 8.0, 4.0, 0.5)
    with pytest.raises(Refused, match=sentence):
        client.build("rationalise", vertices, np.array(quads), settings=settings)


def test_seams_moulds_and_locked_panels_of_a_design_are_given(client):
    def height(x, y):
        return 1.0 - 0.03 * (x - 4.0) ** 2 - 0.04 * (y - 2.0) ** 2

    vertices, quads = mesh_over(height, 8.0, 4.0, 0.5)
    seam = [[x, 0.3 * x, height(x, 0.3 * x)] for x in np.linspace(0.0, 8.0, 33)]
    given = {"seams": [seam], "panel": 2.0, "edges": 4, "radii": [4.0, None], "locked": {"0": 1}}
    found = client.build("rationalise", vertices, np.array(quads), settings=given)
    assert found["panels"] == 2 and found["curvatures"][found["classes"][0]] == 0.0
    on_seam = np.array(found["vertices"])[np.unique(found["seams"])]
    assert np.abs(on_seam[:, 1] - 0.3 * on_seam[:, 0]).max() < 0.02
    with pytest.raises((Failed, Refused), match="give one of them"):
        client.build("rationalise", vertices, np.array(quads), settings={"radii": [4.0], "moulds": 2})


def bowl(x, y):
    return 1.0 - 0.03 * (x - 4.0) ** 2 - 0.04 * (y - 2.0) ** 2


def build_of_file(client, path, **options):
    """Submit a file as a design, and return its result once it is there, with its id."""
    id = client.submit_file(path.read_bytes(), path.suffix[1:], task="rationalise", **options)
    wait_for(lambda: client.poll(id, wait=20)["state"] == "succeeded")
    return {**client.result(id), "id": id}


def test_a_file_is_read_as_the_design_that_it_is(client, tmp_path):
    """A smooth surface is not meshed before, an .stl is taken here only, and an .obj keeps its supports."""
    nurbs_file(tmp_path / "roof.3dm", bowl, 8.0, 4.0)
    settings = {"panel": 2.0, "moulds": 2, "edges": 3}
    smooth = build_of_file(client, tmp_path / "roof.3dm", settings=settings, name="Hall")
    assert smooth["fit_deviation"] == 0.0 and smooth["units"] == "Meters" and smooth["panels"] == 8 and len(smooth["supports"]) == 4
    (tmp_path / "panels.3dm").write_bytes(client.result(smooth["id"], "3dm"))
    read = read_problem(tmp_path / "panels.3dm").checked()
    assert np.array_equal(read.vertices, smooth["vertices"]) and read.regions().max() == 7, "its file is that roof again"
    vertices, quads = mesh_over(bowl, 8.0, 4.0, 0.25)
    faces = [triangle for a, b, c, d in quads for triangle in ((a, b, c), (a, c, d))]
    for suffix, held in ((".stl", 4), (".obj", 3)):
        write(tmp_path / f"roof{suffix}", CGCProblem(vertices, faces).with_supports([0, 16, len(vertices) - 1]))
        meshed = build_of_file(client, tmp_path / f"roof{suffix}", settings=settings, unit="mm")
        assert 0.0 < meshed["fit_deviation"] < 1e-3 and meshed["units"] == "Millimeters" and len(meshed["supports"]) == held
        assert meshed["panels"] == 8 and meshed["distance"]["max"] < 0.05


def test_files_of_designs_are_refused_where_they_are_none(client, tmp_path):
    nurbs_file(tmp_path / "roof.3dm", bowl, 8.0, 4.0)
    body = (tmp_path / "roof.3dm").read_bytes()
    with pytest.raises(Refused, match="the task unroll takes files of the kinds 3dm and obj, not stl"):
        client.submit_file(b"solid", "stl", task="unroll")
    with pytest.raises(Refused, match="'supports' is no option of a file for the task rationalise"):
        client.submit_file(body, "3dm", task="rationalise", supports="boundary")
    id = client.submit_file(b"no file", "step", task="rationalise")
    wait_for(lambda: client.poll(id, wait=20)["state"] == "failed")
    assert "STEP" in client.poll(id)["message"] and "/" not in client.poll(id)["message"]


def test_the_list_of_tasks_is_the_table(client):
    found = {own["name"]: own for own in client.tasks()}
    assert set(found) == {"mould", "unroll", "membrane", "net", "quads", "drawings", "limits", "rationalise"}
    along = next(own for own in found["mould"]["options"] if own["name"] == "along")
    assert along["enum"] == list(ALONG) and found["unroll"]["formats"] == [
        *("arrays", "dxf", "svg", "csv", "3dm", "list.csv", "plan.dxf", "plan.svg", "zip")
    ]


@pytest.mark.parametrize(
    "body, sentence",
    [
        ({"task": "paint"}, "'task' must be one of solve, mould, unroll, membrane, net, quads, drawings, limits, rationalise"),
        ({"task": "rationalise", "settings": {"seams": "x"}}, "'seams' must be one of grid, curvature, geodesics, levels, faces"),
        ({"task": "rationalise", "settings": {"seams": [[[0, 0, 0]]]}}, "or curves of two points (x, y, z) or more"),
        ({"task": "rationalise", "settings": {"radii": ["x"]}}, "every radius of 'radii' must be a number"),
        ({"task": "rationalise", "settings": {"locked": [3]}}, "'locked' must be an object of panels and their moulds"),
        ({"task": "rationalise", "settings": {"mould": 3}}, "there is no option 'mould'"),
        ({"task": ["net"]}, "'task' must be one of"),
        ({"task": "unroll", "settings": {"sheet": "large"}}, "'sheet' must be LENGTHxWIDTH"),
        ({"task": "unroll", "settings": {"strain": "much"}}, "'strain' must be a number"),
        ({"task": "unroll", "settings": {"colour": 1}}, "there is no option 'colour'; options are sheet, strain"),
        ({"task": "unroll", "settings": 3}, "'settings' must be an object"),
        ({"task": "unroll", "settings": {"seams": [[1, "a"]]}}, "'seams' must be the numbers of vertices"),
        ({"task": "net", "settings": {"through": [[1, 2]]}}, "'through' must be X,Y,Z"),
        ({"task": "net", "settings": {"regions": [0.5]}}, "every region of 'regions' must be a whole number"),
        ({"task": "mould", "settings": {"rough": 1}}, "'rough' must be true or false"),
        ({"task": "membrane", "method": "flow"}, "'method' is an option of a solve, but the task is membrane"),
        ({"task": "limits", "settings": {"tolerance": 2}}, "'tolerance' must be between 0 and 1"),
        ({"task": "net", "job": 7}, "'job' must be the id of a job"),
        ({"job": "some-job-id"}, "'job' is for tasks on a solved surface"),
    ],
)
def test_wrong_orders_are_refused_before_they_are_queued(server, body, sentence):
    vertices, faces = grid(2)
    mesh = {} if "job" in body else {"vertices": vertices.tolist(), "faces": faces.tolist()}
    status, _, content = server.ask("POST", "/api/v1/jobs", json.dumps({**mesh, **body}).encode(), RhinoComputeKey=KEY)
    assert status == 422 and sentence in json.loads(content)["message"]


@pytest.mark.parametrize(
    "task, shape, settings, sentence",
    [
        ("membrane", DOME, {}, "membrane forces need a load"),
        ("membrane", CONE, {"pressure": 1.0}, "has K = 0"),
        ("unroll", CONE, {"seams": [[0, 1]]}, "none of the given seams opens"),
        ("unroll", CONE, {"sheet": "1e"}, "LENGTHxWIDTH"),
        ("unroll", CONE, {"sheet": [0.001, 0.001]}, "use larger sheets"),
        ("net", SADDLE, {"regions": [4]}, "there is no region 4"),
        ("mould", DOME, {"material": "cheese"}, "there is no material 'cheese'"),
        ("mould", CONE, {"count": 1}, "hole"),
        ("limits", CONE, {}, "a target other than zero"),
    ],
)
def test_what_cannot_be_built_fails_with_a_sentence_and_no_result(client, task, shape, settings, sentence):
    vertices, faces, options = asked(shape)
    with pytest.raises((Failed, Refused), match=sentence):
        client.build(task, vertices, faces, settings=settings, **options)


def test_a_rough_surface_is_refused_for_every_task(client):
    (vertices, faces), K = DOME
    rough = vertices + 0.2 * np.random.default_rng(2).standard_normal(vertices.shape)
    for task, settings in (("mould", {}), ("unroll", {}), ("membrane", {"pressure": 1.0}), ("net", {})):
        with pytest.raises(Failed, match="rough"):
            client.build(task, rough, faces, settings=settings, supports="boundary", targets=K)


def test_jobs_without_such_a_result_say_so(client, server):
    vertices, faces, options = asked(SADDLE)
    net = client.build("net", vertices, faces, settings={"spacing": 1.0}, **options)["id"]
    with pytest.raises(Refused, match="has no solved surface") as error:
        client.build("net", job=net)
    assert error.value.status == 422
    for method, path in (("GET", f"/api/v1/jobs/{net}/moulds?count=1"), ("POST", f"/api/v1/jobs/{net}/result?format=3dm")):
        status, _, content = server.ask(method, path, b"x" if method == "POST" else None, RhinoComputeKey=KEY)
        assert status == 422 and "has no solved surface" in json.loads(content)["message"]
    with pytest.raises(Refused, match="there is no job"):
        client.build("net", job="nobody-has-this")
    solve = client.solve(*grid(3), supports="boundary", targets=0.1)["id"]
    with pytest.raises(Refused, match="a solve has no result in the format dxf"):
        client.result(solve, "dxf")


def test_a_build_is_cancelled(client):
    vertices, faces = revolved_patch(60, -0.02)
    id = client.submit_build("net", vertices, faces, supports="boundary", targets=-0.02, settings={"spacing": 0.02})
    wait_for(lambda: client.poll(id)["stage"] in ("read", "build"))
    assert client.cancel(id)["id"] == id
    status = wait_for(lambda: (found := client.poll(id, wait=20))["state"] != "running" and found)
    assert status["state"] == "cancelled" and not status["has_result"] and status["task"] == "net"
