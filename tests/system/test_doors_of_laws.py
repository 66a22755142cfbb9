"""A rise that is met by the constant of a law leads to the same surface through every door."""

from __future__ import annotations

import json

import numpy as np
import pytest
import rhino3dm

from compas_cgc import CGCProblem
from compas_cgc import Rise
from compas_cgc import solve
from compas_cgc.cli.main import main
from compas_cgc.io import read
from compas_cgc.io.rhino import read_3dm
from compas_cgc.io.rhino import write_problem
from compas_cgc.io.rhino import write_result
from compas_cgc.io.rhino.meshes import mesh_from_arrays
from compas_cgc.model.goals.wholes import Unknown
from compas_cgc.model.problem import Drawing
from compas_cgc.server.hops.endpoints import endpoint
from compas_cgc.server.hops.functions import run_function
from compas_cgc.server.limits import Limits

from ..support.exact_surfaces import unduloid
from ..support.gh_stand_ins import place
from ..support.gh_stand_ins import rhino  # noqa: F401
from ..support.hops_client import write
from ..support.shapes import grid

N, WIDTH, RISE = 9, 15.0, 3.2
CREASES = [[(N + 1) * i + k for i in range(N + 1)] for k in (N // 3, 2 * N // 3)]
GOALS = [Rise(RISE), Unknown([1])]


def _plan() -> CGCProblem:
    return _bare().with_targets(0.005).with_targets(0.0, region=2).with_laws({1: "H = 0.05"})


@pytest.fixture(scope="module")
def expected():
    result = solve(_plan().with_goals(GOALS))
    assert result.converged and result.verdict.fair, result.message
    assert result.vertices[:, 2].max() == pytest.approx(RISE, abs=1e-9)
    return result


def _is_that(expected, vertices, law) -> bool:
    """Check the surface and the law found."""
    assert law.constant == pytest.approx(expected.problem.laws[1].constant, rel=1e-6)
    return bool(np.abs(np.asarray(vertices) - expected.vertices).max() < 1e-6)


def _bare() -> CGCProblem:
    """Return the plan without laws."""
    return CGCProblem(*grid(N, WIDTH), drawing=Drawing("roof", "Meters", 1e-3)).with_supports("corners").with_creases(CREASES)


def _written(tmp_path):
    """Write the plan without laws."""
    write_problem(tmp_path / "plan.3dm", _bare())
    return tmp_path / "plan.3dm"


def test_command_line(expected, tmp_path, capsys):
    plan, out = _written(tmp_path), tmp_path / "roof.json"
    laws = ["--target", "0.005", "--target", "2=0", "--law", "1=H = 0.05", "--rise", str(RISE), "--unknown", "1"]
    assert main(["solve", str(plan), "-o", str(out), *laws]) == 0
    assert "was found for region 1" in capsys.readouterr().out
    found = read(out).to_problem()
    assert _is_that(expected, found.vertices, found.laws[1])


def test_drawing_in_rhino(expected, tmp_path):
    write_problem(tmp_path / "roof.3dm", _plan().with_goals(GOALS))
    drawn = read_3dm(tmp_path / "roof.3dm").checked()
    assert str(drawn.laws[1]) == "H = 0.05" and list(drawn.goals) == GOALS
    result = solve(drawn)
    order = np.lexsort(drawn.vertices.T[:2].round(6)), np.lexsort(_plan().vertices.T[:2].round(6))
    assert np.abs(result.vertices[order[0]] - expected.vertices[order[1]]).max() < 1e-6
    write_result(tmp_path / "solved.3dm", result)
    again = read_3dm(tmp_path / "solved.3dm", result=True).checked()
    assert again.laws[1].constant == pytest.approx(expected.problem.laws[1].constant, rel=1e-6)


@pytest.mark.parametrize("place_of_text", ["dot", "user text"])
def test_a_law_drawn_by_hand(expected, tmp_path, place_of_text):
    file = rhino3dm.File3dm.Read(str(_written(tmp_path)))
    layers = {own.FullPath: own.Index for own in file.Layers}
    attributes = rhino3dm.ObjectAttributes()
    attributes.LayerIndex = layers.get("CGC::Targets") or file.Layers.Add(_layer("Targets", file))
    dots = [(2.0, "0.005"), (7.5, "H = 0.05"), (13.0, "0")]
    for y, text in dots:
        own = rhino3dm.ObjectAttributes()
        own.LayerIndex = attributes.LayerIndex
        if place_of_text == "user text":
            own.SetUserString(*(("law", text) if "H" in text else ("K", text)))
            file.Objects.AddPoint(rhino3dm.Point3d(7.5, y, 0.0), own)
        else:
            file.Objects.AddTextDot(text, rhino3dm.Point3d(7.5, y, 0.0), own)
    file.Write(str(tmp_path / "drawn.3dm"), 8)
    out = tmp_path / "roof.json"
    assert main(["solve", str(tmp_path / "drawn.3dm"), "-o", str(out), "--rise", str(RISE), "--unknown", "1", "-q"]) == 0
    found = read(out).to_problem()
    assert found.laws[1].constant == pytest.approx(expected.problem.laws[1].constant, rel=1e-6)


def _layer(name, file):
    layer = rhino3dm.Layer()
    layer.Name = name
    parent = [own for own in file.Layers if own.FullPath == "CGC"]
    if parent:
        layer.ParentLayerId = parent[0].Id
    return layer


def test_http(expected, server):
    plan = _plan()
    body = {
        "vertices": plan.vertices.tolist(),
        "faces": plan.faces.tolist(),
        "supports": "corners",
        "creases": CREASES,
        "targets": {"0": 0.005, "2": 0.0},
        "laws": {"1": "H = 0.05"},
        "goals": [{"kind": "rise", "rise": RISE}],
        "unknown": [1],
    }
    result = server.client.solve(body.pop("vertices"), body.pop("faces"), **body)
    assert np.abs(np.array(result["vertices"]) - expected.vertices).max() < 1e-6
    assert f"H = {expected.problem.laws[1].constant:.4g}" in json.dumps(result)


def test_hops(expected):
    plan = _plan()
    lines = [rhino3dm.PolylineCurve([rhino3dm.Point3d(*plan.vertices[v]) for v in crease]) for crease in CREASES]
    given = {
        "Mesh": mesh_from_arrays(plan.vertices, plan.faces),
        "Supports": plan.vertices[plan.supports].tolist(),
        "Creases": lines,
        "K": [0.005, 0.0],
        "At": [(7.5, 2.0, 0.0), (7.5, 13.0, 0.0)],
        "Law": "1=H = 0.05",
        "Goals": [f"rise = {RISE}"],
        "Unknown": [1],
    }
    values = []
    for own in endpoint("cgc/goals").inputs:
        items = given.get(own.name, [])
        items = items if isinstance(items, list) else [items]
        data = [{"data": item} if own.kind == "Text" else write(item, own.kind, 8) for item in items]
        values.append({"ParamName": own.name, "InnerTree": {"{0}": data} if data else {}})
    reply = run_function("cgc/goals", values, {"modelunits": "Meters", "absolutetolerance": 1e-3}, Limits())
    assert reply.status == 200, reply.errors
    assert f"H = {expected.problem.laws[1].constant:.6g} was found" in json.dumps(reply.values)


@pytest.mark.usefixtures("rhino")
def test_grasshopper(expected):
    target = place("Target").run(cgc_mesh=_bare(), K=[0.005, None, 0.0], region=[0, 1, 2], law=[None, "H = 0.05", None])
    goals = place("Goals").run(rise=RISE, unknown=[1])["goals"]
    placed = place("Solve")
    out = placed.settle(cgc_mesh=target["cgc_mesh"], goals=goals, run=True)
    assert not placed.said("Error"), placed.said("Error")
    problem = out["cgc_mesh"].to_problem()
    assert _is_that(expected, problem.vertices, problem.laws[1])


def test_nets_and_quads_of_laws_from_the_command_line(tmp_path, capsys):
    surface = unduloid()
    V, F, _ = surface.patch(16)
    result = solve(CGCProblem(V, F).with_supports("boundary").with_laws({0: surface.law}))
    rows = [f"v {x} {y} {z}" for x, y, z in result.vertices] + [f"f {a + 1} {b + 1} {c + 1}" for a, b, c in F]
    (tmp_path / "tube.obj").write_text("\n".join(rows) + "\n")
    given = [str(tmp_path / "tube.obj"), "--law", str(surface.law), "-o"]
    assert main(["net", *given, str(tmp_path / "net.json"), "--kind", "curvature"]) == 0
    assert "lines of curvature" in capsys.readouterr().out
    assert main(["net", *given, str(tmp_path / "net.json"), "--kind", "square"]) == 2
    assert "kind must be curvature or asymptotic" in capsys.readouterr().err
    assert main(["quads", *given, str(tmp_path / "quads.json")]) == 0
    assert "squares inside regions of constant H: widths differ by" in capsys.readouterr().out
