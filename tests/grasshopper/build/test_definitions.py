"""The example definitions: laid out to be read, written to the rules, and run from sliders to meshes."""

from __future__ import annotations

import sys
import types
import xml.etree.ElementTree as ElementTree
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import rhino3dm

from compas_cgc import solve
from compas_cgc.errors import FileError
from compas_cgc.grasshopper.build.archive import chunk
from compas_cgc.grasshopper.build.archive import definition_problems
from compas_cgc.grasshopper.build.archive import item
from compas_cgc.grasshopper.build.archive import read_archive
from compas_cgc.grasshopper.build.archive import write_archive
from compas_cgc.grasshopper.build.definition import EXAMPLES
from compas_cgc.grasshopper.build.definition import definition_archive
from compas_cgc.grasshopper.build.definition import definition_svg
from compas_cgc.grasshopper.build.definition.layout import layout
from compas_cgc.grasshopper.build.definition.nodes import Definition
from compas_cgc.grasshopper.build.definition.nodes import Group
from compas_cgc.grasshopper.build.definition.nodes import Hops
from compas_cgc.grasshopper.build.definition.nodes import Panel
from compas_cgc.grasshopper.build.definition.nodes import Script
from compas_cgc.grasshopper.build.definition.nodes import Slider
from compas_cgc.io import read_mesh
from compas_cgc.model.measures import measured_curvature

from ...support.gh_evaluator import Canvas
from ...support.gh_stand_ins import BUNDLES
from ...support.gh_stand_ins import Point3d
from ...support.gh_stand_ins import PolylineCurve
from ...support.gh_stand_ins import rhino  # noqa: F401
from ...support.gh_stand_ins import rhino_mesh
from ...support.gh_stand_ins import square
from ...support.tiers import push_only

ROOT = Path(__file__).parents[3]

each = pytest.mark.parametrize("definition", EXAMPLES, ids=[definition.name for definition in EXAMPLES])
BY_NAME = {definition.name: definition for definition in EXAMPLES}


@each
def test_both_forms_hold_the_same_and_keep_the_rules(definition, tmp_path):
    root = definition_archive(definition, BUNDLES)
    for suffix in ("gh", "ghx"):
        write_archive(tmp_path / f"a.{suffix}", root)
        back = read_archive(tmp_path / f"a.{suffix}")
        assert back == root and definition_problems(back) == []
        assert write_archive(tmp_path / f"b.{suffix}", definition_archive(definition, BUNDLES)) is None
        assert (tmp_path / f"a.{suffix}").read_bytes() == (tmp_path / f"b.{suffix}").read_bytes()


def test_a_placed_component_has_the_keys_that_rhino_writes():
    root = definition_archive(BY_NAME["nine_regions"], BUNDLES)
    objects = root.child("Definition").child("DefinitionObjects").children("Object")
    scripts = [part for part in objects if part.child("Container").child("Script")]
    assert len(scripts) == 8
    for part in scripts:
        container = part.child("Container")
        assert {entry.name for entry in part.items} == {"GUID", "Name"}, "as Rhino 8.32 and 8.33 save it"
        assert part.get("Name") == container.get("Name")
        assert [child.name for child in container.chunks] == ["Attributes", "ParameterData", "Script"]
        for parameter in container.child("ParameterData").chunks:
            assert [child.name for child in parameter.chunks] == ["Attributes", "ConverterData"]
            assert {entry.name for entry in parameter.child("Attributes").items} == {"Bounds", "Pivot"}


@each
def test_nothing_covers_anything_and_wires_run_to_the_right(definition):
    boxes = layout(definition, BUNDLES)
    keys = sorted(boxes)
    for i, a in enumerate(keys):
        for b in keys[i + 1 :]:
            assert not covers(boxes[a], boxes[b]), f"{a} covers {b}"
    for node in definition.nodes:
        if isinstance(node, Group):
            members = [boxes[key] for key in node.members]
            low = [min(box[k] for box in members) for k in (0, 1)]
            high = [max(box[k] + box[k + 2] for box in members) for k in (0, 1)]
            ground = type(members[0])(*low, high[0] - low[0], high[1] - low[1])
            for key in set(keys) - set(node.members):
                assert not covers(ground, boxes[key]), f"the group {node.key} covers {key}"
        for wire in wires_of(node):
            start, end = boxes[wire.partition(".")[0]], boxes[node.key]
            assert start.x + start.width < end.x, f"the wire from {wire} to {node.key} runs backwards"


def covers(a, b):
    return a.x < b.x + b.width and b.x < a.x + a.width and a.y < b.y + b.height and b.y < a.y + a.height


def wires_of(node):
    if isinstance(node, (Script, Hops)):
        return [wire for wires in node.wires.values() for wire in ([wires] if isinstance(wires, str) else wires)]
    return [node.source] if isinstance(node, Panel) and node.source else []


@each
def test_the_picture_shows_every_object_and_wire(definition):
    root = definition_archive(definition, BUNDLES)
    svg = definition_svg(root)
    drawn = ElementTree.fromstring(svg)
    names = [text.text for text in drawn.iter("{http://www.w3.org/2000/svg}text")]
    for node in definition.nodes:
        if isinstance(node, (Script, Slider)):
            assert (BUNDLES[node.bundle].nickname if isinstance(node, Script) else node.name) in names
    wires = [path for path in drawn.iter("{http://www.w3.org/2000/svg}path") if path.get("class") == "w"]
    assert len(wires) == sum(len(wires_of(node)) for node in definition.nodes) > 3
    assert svg == definition_svg(definition_archive(definition, BUNDLES))


# ----------------------------------------------------------------------
# Running them
# ----------------------------------------------------------------------


@pytest.fixture
def canvas(rhino, tmp_path):  # noqa: F811
    def open_definition(name):
        write_archive(tmp_path / f"{name}.gh", definition_archive(BY_NAME[name], BUNDLES))
        return Canvas(read_archive(tmp_path / f"{name}.gh"))

    return open_definition


@each
def test_an_opened_definition_waits_without_complaint(definition, canvas):
    opened = canvas(definition.name)
    opened.settle()
    assert opened.balloons("Error") == []
    if definition.rhino >= 8:
        waits = [placed.component.Message for placed in opened.scripts.values() if placed.component.Message == "set run to true"]
        assert waits or definition.name == "own_mesh"


def test_a_mesh_inside_the_definition_is_solved_without_a_document(canvas):
    opened = canvas("mesh_inside")
    opened.set["run"] = [True]
    values = opened.settle()
    assert opened.panel(values, "status") == ["converged"] and not opened.balloons("Error")
    mesh = opened.out(values, "Solve", "mesh")[0]
    assert len(mesh.Vertices) == 13 * 9 and len(mesh.VertexColors) == 13 * 9 and max(p.Z for p in mesh.Vertices) > 1.5
    opened.set["mesh as .obj"] = ["v 0 0 0\nv 1 0 zero\nf 1 2 2"]
    values = opened.settle()
    assert any("the text, line 2: 'v 1 0 zero' cannot be read" in said for said in opened.balloons("Error"))


def test_the_first_dome_follows_its_slider(canvas):
    opened = canvas("first_dome")
    opened.set["run"] = [True]
    heights = []
    for K in (0.5, 1.0):
        opened.set["curvature K"] = [K]
        values = opened.settle()
        assert opened.panel(values, "status") == ["converged"] and not opened.balloons("Error") + opened.balloons("Warning")
        reached = [value for value in opened.out(values, "Analyse", "K") if value is not None]
        # Whole lists come out without their gaps, so these are the vertices inside.
        assert reached == pytest.approx([K] * len(reached), rel=1e-4) and len(reached) >= 64
        heights.append(max(p.Z for p in opened.out(values, "Solve", "mesh")[0].Vertices))
        assert len(opened.panel(values, "legend")) == 7 and "max error" in opened.panel(values, "report")[0]
    assert 0 < heights[0] < heights[1]
    opened.set["reset"] = [True]
    assert opened.out(opened.settle(), "Solve", "mesh") == []


def test_nine_regions_with_more_curvature_in_the_centre(canvas):
    opened = canvas("nine_regions")
    opened.set["run"] = [True]
    values = opened.settle()
    assert opened.panel(values, "status") == ["converged"]
    targets = opened.panel(values, "targets by region")
    assert targets == [1.0] * 4 + [4.0] + [1.0] * 4
    assert len(opened.out(values, "Regions", "regions")) == 9 and len(opened.out(values, "Regions", "creases")) == 12
    errors = opened.panel(values, "largest error by step")
    assert len(errors) == len(opened.out(values, "History", "step")) and errors[-1] < errors[0]


def test_panels_are_laid_onto_a_mould_for_each_curvature(canvas):
    opened = canvas("moulds")
    opened.set["run"] = [True]
    values = opened.settle()
    assert opened.panel(values, "status") == ["converged"] and opened.balloons("Error") == []
    assert len(opened.panel(values, "panels")) == 36 and len(opened.panel(values, "deviation without bending [mm]")) == 36
    assert len(opened.out(values, "Mould", "moulds")) == 2 and "36 panels on 2 moulds" in "".join(opened.panel(values, "report"))
    opened.set["panels per region"] = [1]
    assert len(opened.panel(opened.settle(), "panels")) == 9


def test_a_roof_becomes_pieces_on_sheets_and_a_file(canvas, tmp_path):
    opened = canvas("flat_patterns")
    path = tmp_path / "patterns.dxf"
    opened.set.update({"run": [True], "file": [str(path)], "write": [True]})
    values = opened.settle()
    assert opened.panel(values, "status") == ["converged"] and opened.balloons("Error") == []
    labels = opened.panel(values, "pieces")
    assert len(labels) == len(opened.out(values, "Unroll", "pieces")) == len(opened.out(values, "Unroll", "outlines")) > 50
    assert f"{len(labels)} pieces" in "".join(opened.panel(values, "report")) and path.read_text(encoding="utf-8").startswith("  0")


def test_forces_follow_their_load(canvas):
    opened = canvas("forces")
    opened.set["run"] = [True]
    found = []
    for pressure in (1.0, 2.0):
        opened.set["pressure"] = [pressure]
        values = opened.settle()
        assert opened.panel(values, "status") == ["converged"] and opened.balloons("Error") == []
        found.append(np.array(opened.panel(values, "line loads")))
    assert np.allclose(found[1], 2 * found[0]) and "equilibrium" in "".join(opened.panel(values, "report"))


def test_laths_at_a_spacing_and_lines_of_curvature(canvas):
    opened = canvas("laths")
    opened.set["run"] = [True]
    values = opened.settle()
    assert opened.panel(values, "status") == ["converged"] and opened.balloons("Error") == []
    assert "asymptotic curves" in "".join(opened.panel(values, "report"))
    assert np.median(opened.panel(values, "lengths between nodes")) == pytest.approx(1.0, rel=0.02)
    opened.set["curvature K"] = [0.05]
    assert "lines of curvature" in "".join(opened.panel(opened.settle(), "report"))


def test_two_strategies_give_two_surfaces_side_by_side(canvas):
    opened = canvas("two_strategies")
    opened.set["run"] = [True]
    values = opened.settle()
    assert [opened.out(values, "Solve", "status", n) for n in (0, 1)] == [["converged"], ["converged"]]
    first, second = (np.array(opened.out(values, "Analyse", "mesh", n)[0].Vertices) for n in (0, 1))
    assert second[:, 0].min() > first[:, 0].max(), "side by side"
    assert np.abs(second - [2, 0, 0] - first).max() > 1e-3, "not the same surface"


def test_a_mesh_of_ones_own(canvas):
    opened = canvas("own_mesh")
    corners = [Point3d(x, y, 0.0) for x in (0.0, 9.0) for y in (0.0, 9.0)]
    opened.set.update({"Mesh": [square()], "supports": corners, "run": [True]})
    values = opened.settle()
    assert opened.out(values, "Solve", "status") == ["converged"] and len(opened.out(values, "Regions", "supports")) == 4
    assert opened.panel(values, "problems") == []


def test_a_freeform_roof_gets_panels_from_few_moulds(canvas):
    opened = canvas("rationalise")
    opened.set["run"] = [True]
    values = opened.settle()
    assert not opened.balloons("Error") and "24 panels on 3 moulds" in "".join(opened.panel(values, "report"))
    assert len(opened.panel(values, "K of the moulds")) == 3 and len(opened.panel(values, "mould of each panel")) == 24
    assert np.abs(opened.out(values, "Rationalise", "distance")).max() < 0.02


# ----------------------------------------------------------------------
# Without anybody who looks
# ----------------------------------------------------------------------


@pytest.mark.parametrize("name", push_only([one.name for one in EXAMPLES if one.rhino >= 8], "first_dome", "own_mesh", "two_strategies"))
def test_one_headless_solution_gives_a_surface_or_the_cause(name, canvas, monkeypatch):
    monkeypatch.setattr(sys.modules["Rhino"], "RhinoApp", types.SimpleNamespace(IsRunningHeadless=True), raising=False)
    opened = canvas(name)
    values = opened.solution()
    causes = {"own_mesh": "connect a mesh"}
    assert any(causes.get(name, "run is False") in cause for cause in opened.balloons("Error"))
    opened.set.update({"run": [True], **({"Mesh": [square()]} if name == "own_mesh" else {})})
    values = opened.solution()
    surface = "Rationalise" if name == "rationalise" else "Solve"
    (mesh,) = opened.out(values, surface, "mesh")
    assert max(point.Z for point in mesh.Vertices) > 0.05 and not opened.balloons("Error") and not opened.document.scheduled


# ----------------------------------------------------------------------
# By Hops, against a real server
# ----------------------------------------------------------------------


def with_server(opened, running):
    for placed in opened.scripts.values():
        assert placed.container.get("RemoteDefinitionLocation").startswith("http://127.0.0.1:7331/cgc/"), "where compas-cgc serve listens"
        placed.server = running.url
    return opened


def test_a_dome_by_hops(canvas, open_server):
    opened = with_server(canvas("hops_dome"), open_server)
    opened.solution()
    assert opened.balloons("Warning") == ["Input parameter Mesh failed to collect data"]
    opened.set["Mesh"] = [square()]
    values = opened.solution()
    assert opened.balloons("Error") + opened.balloons("Warning") == []
    assert "converged" in opened.panel(values, "info")[0] and opened.panel(values, "largest error")[0] < 1e-7
    assert max(p.Z for p in opened.out(values, "CGC Dome", "Mesh")[0].Vertices) > 0.5
    opened.set["curvature K"] = [1.0]
    opened.solution()
    assert "too large for this boundary" in opened.balloons("Error")[0]


def test_nine_regions_by_hops_from_the_rhino_file(canvas, open_server):
    model = rhino3dm.File3dm.Read(str(ROOT / "examples" / "nine_regions.3dm"))
    found = {kind: [o.Geometry for o in model.Objects if isinstance(o.Geometry, kind)] for kind in KINDS}
    mesh = found[rhino3dm.Mesh][0]
    vertices = [(p.X, p.Y, p.Z) for p in mesh.Vertices.ToPoint3dArray()]
    low, high = np.min(vertices, axis=0), np.max(vertices, axis=0)
    thirds = [low + (high - low) * [(i + 0.5) / 3, (j + 0.5) / 3, 0] for i in range(3) for j in range(3)]
    curves = [line.TryGetPolyline() for line in found[rhino3dm.Curve]]
    opened = with_server(canvas("hops_regions"), open_server)
    opened.set.update(
        {
            "Mesh": [rhino_mesh(vertices, [mesh.Faces[i] for i in range(len(mesh.Faces))])],
            "supports": [Point3d(p.Location.X, p.Location.Y, p.Location.Z) for p in found[rhino3dm.Point]],
            "creases": [PolylineCurve([Point3d(p.X, p.Y, p.Z) for p in line]) for line in curves],
            "points in regions": [Point3d(*map(float, place)) for place in thirds],
        }
    )
    values = opened.solution()
    assert opened.balloons("Error") == [] and "converged" in opened.panel(values, "info")[0]
    surface = np.array(opened.out(values, "CGC Solve", "Mesh")[0].Vertices)
    drawn = read_mesh(ROOT / "examples" / "nine_regions.3dm")[0].to_problem()
    inside = np.abs(np.array(vertices)[:, :2] - thirds[4][:2]).max(axis=1) < (high - low)[0] / 6.5
    K = measured_curvature(drawn.with_targets(0.04).with_vertices(surface), "mid-edge")[inside]
    assert K == pytest.approx(0.04, rel=0.13), "read off five squares a side, of a third of the radius each"
    assert opened.panel(values, "largest error")[0] == pytest.approx(np.abs(K - 0.04).max())
    K = [0.01] * 4 + [0.04] + [0.01] * 4
    assert np.allclose(surface, solve(drawn.with_targets(dict(enumerate(K)))).vertices, atol=1e-9)
    assert opened.panel(values, "report")


KINDS = (rhino3dm.Mesh, rhino3dm.Curve, rhino3dm.Point)


# ----------------------------------------------------------------------
# What is refused
# ----------------------------------------------------------------------


@pytest.mark.parametrize(
    "node, sentence",
    [
        (Script("x", "CGC_Solve", {"mesh": "a.out"}), "x has no input 'mesh'"),
        (Script("x", "CGC_Solve", {"cgc_mesh": "t.mesh"}), "the source of the wire from 't.mesh' to x.cgc_mesh does not exist"),
        (Script("x", "CGC_Solve", {"cgc_mesh": "t"}), "the source of the wire from 't' to x.cgc_mesh does not exist"),
        (Script("x", "CGC_Solve", {"run": "K.value"}), "the source of the wire from 'K.value' to x.run does not exist"),
        (Panel("x", "p", source="nobody"), "the source of the wire from 'nobody' to x. does not exist"),
        (Group("x", "g", ("nobody",)), "refers to an object that does not exist"),
        (Slider("K", "K", 0, 0, 1), "two objects with the same key"),
        (Hops("x", "cgc/dome", {"Curve": "K"}), "x has no input 'Curve'"),
    ],
)
def test_a_wrong_wire_is_found_when_it_is_built(node, sentence):
    nodes = (Slider("K", "K", 0, 0, 1), Script("t", "CGC_Target", {"K": "K"}), node)
    with pytest.raises(FileError, match=sentence):
        definition_archive(Definition("d", "d", "", nodes), BUNDLES)


def changed(part, path, change):
    """Return an archive with the chunk at a path changed."""
    if not path:
        return change(part)
    return replace(part, chunks=tuple(changed(c, path[1:], change) if (c.name, c.index) == path[0] else c for c in part.chunks))


OBJECTS = [("Definition", None), ("DefinitionObjects", None)]


def with_item(name, kind, value, index=None):
    def change(part):
        kept = [entry for entry in part.items if (entry.name, entry.index) != (name, index)]
        return replace(part, items=(*kept, item(name, kind, value, index)))

    return change


def script_path(root):
    objects = root.child("Definition").child("DefinitionObjects").children("Object")
    index = next(part.index for part in objects if part.get("Name") == "Example")
    return [*OBJECTS, ("Object", index), ("Container", None)]


@pytest.mark.parametrize(
    "where, change, sentence",
    [
        (OBJECTS, with_item("ObjectCount", "gh_int32", 99), "ObjectCount is 99"),
        ([*OBJECTS, ("Object", 0)], with_item("Colour", "gh_int32", 1), "GUID, Lib and Name only"),
        ([*OBJECTS, ("Object", 0)], lambda part: replace(part, chunks=()), "exactly one chunk, its Container"),
        ([*OBJECTS, ("Object", 0), ("Container", None)], lambda part: replace(part, chunks=()), "no Attributes"),
        ("parameters", with_item("InputCount", "gh_int32", 1), "InputCount is 1"),
        ("input", with_item("SourceCount", "gh_int32", 5), "SourceCount is 5"),
        ("input", with_item("Source", "gh_guid", "00000000-0000-0000-0000-000000000009", 0), "is not in the file"),
        ("source", with_item("Text", "gh_string", "!"), "its source cannot be read"),
        ([], lambda part: replace(part, name="Other"), "is not a definition"),
        ([("Definition", None)], lambda part: chunk("Definition"), "no DefinitionObjects"),
    ],
)
def test_a_broken_rule_is_named(where, change, sentence):
    root = definition_archive(BY_NAME["first_dome"], BUNDLES)
    script = script_path(root)
    data = [*script, ("ParameterData", None)]
    named = {"parameters": data, "input": [*data, ("InputParam", 0)], "source": [*script, ("Script", None)]}
    broken = changed(root, named[where] if isinstance(where, str) else where, change)
    assert any(sentence in problem for problem in definition_problems(broken))


def test_two_objects_of_one_name_are_named():
    root = definition_archive(BY_NAME["first_dome"], BUNDLES)
    first = root.child("Definition").child("DefinitionObjects").children("Object")[0].child("Container").get("InstanceGuid")
    twice = changed(root, [*OBJECTS, ("Object", 1), ("Container", None)], with_item("InstanceGuid", "gh_guid", first))
    assert any("occurs twice" in problem for problem in definition_problems(twice))
