"""Manners on the canvas: surfaces meshed, ids that occur twice, documents that are closed, colours, trees, layers, value lists."""

from __future__ import annotations

import subprocess
import sys
import time

import numpy as np
import pytest
import rhino3dm

from compas_cgc import CGCMesh
from compas_cgc import FlowSettings
from compas_cgc import solve
from compas_cgc.grasshopper.components import solve as solve_module
from compas_cgc.grasshopper.runtime import measured
from compas_cgc.grasshopper.runtime import widgets
from compas_cgc.grasshopper.runtime.address import Address
from compas_cgc.meshing import boundary_loops

from ...support.gh_stand_ins import Brep
from ...support.gh_stand_ins import Instances
from ...support.gh_stand_ins import Point3d
from ...support.gh_stand_ins import PolylineCurve
from ...support.gh_stand_ins import SubD
from ...support.gh_stand_ins import place
from ...support.gh_stand_ins import rhino  # noqa: F401
from ...support.gh_stand_ins import square
from ...support.server_process import PATIENCE
from .test_functions import nine_regions
from .test_solve import dome
from .test_solve import endless
from .test_solve import task_of
from .test_solve import until_done

pytestmark = pytest.mark.usefixtures("rhino")


def ring(*corners):
    return PolylineCurve([Point3d(*map(float, (*corner, 0))) for corner in (*corners, corners[0])])


SQUARE = ring((0, 0), (9, 0), (9, 9), (0, 9))
HOLE = ring((4, 4), (5, 4), (5, 5), (4, 5))


def sphere():
    return rhino3dm.Brep.CreateFromSphere(rhino3dm.Sphere(rhino3dm.Point3d(0, 0, 0), 2.0))


def cube():
    """Return the control net of a SubD with eight vertices."""
    mesh = rhino3dm.Mesh.CreateFromBox(rhino3dm.BoundingBox(rhino3dm.Point3d(0, 0, 0), rhino3dm.Point3d(4, 4, 4)), 1, 1, 1)
    mesh.Vertices.CombineIdentical(True, True)
    return rhino3dm.SubD.CreateFromMesh(mesh)


# ----------------------------------------------------------------------
# Surfaces and outlines
# ----------------------------------------------------------------------


def test_surfaces_are_meshed_at_an_edge_length():
    pytest.importorskip("compas_cgal")
    placed = place("Mesh")
    mesh = placed.settle(surfaces=[Brep(sphere())], edge_length=0.5)["cgc_mesh"]
    V, F = mesh.arrays()
    assert np.allclose(np.linalg.norm(V, axis=1), 2.0, atol=2e-3) and not boundary_loops(F)
    lengths = np.linalg.norm(V[F[:, 0]] - V[F[:, 1]], axis=1)
    assert 0.4 < np.median(lengths) < 0.62
    assert any("meshed with edges of about 0.5 m, within" in said for said in placed.said("Remark"))


def test_outlines_are_filled_with_columns_and_creases_as_drawn():
    pytest.importorskip("compas_cgal")
    placed = place("Mesh")
    crease = PolylineCurve([Point3d(-1.0, 2.0, 0.0), Point3d(10.0, 2.0, 0.0)])
    column = Point3d(3.3, 6.1, 0.0)
    out = placed.settle(surfaces=[HOLE, SQUARE], edge_length=0.8, creases=[crease], supports=[column], fix="points")
    mesh = out["cgc_mesh"]
    assert not placed.said("Error") and len(mesh.boundary_loops()) == 2 and len(mesh.regions()) == 2
    (support,) = mesh.supports()
    assert mesh.vertex_coordinates(support)[:2] == pytest.approx([3.3, 6.1])


@pytest.mark.parametrize(
    "inputs, sentence",
    [
        ({"surfaces": [SQUARE, Brep(None)]}, "the input has both curves and surfaces"),
        ({"surfaces": [PolylineCurve(SQUARE.points[:3])], "edge_length": 1.0}, "curve 0 is open"),
        ({"surfaces": [SQUARE], "edge_length": 0.0}, "edge_length must be greater than zero, not 0"),
        ({"surfaces": [SQUARE], "mesh": square(2)}, "either a mesh or surfaces"),
        ({"surfaces": [square(2)]}, "the input surfaces received a Mesh; connect surfaces"),
        ({"surfaces": ["roof"]}, "the input surfaces received the text 'roof'"),
        ({"surfaces": [SQUARE], "edge_length": "fine"}, "the input edge_length received the text 'fine'; connect a number"),
        ({"mesh": Brep(None)}, "the input mesh received a Brep; connect a mesh; surfaces and outlines go to the input surfaces"),
        ({"mesh": square(2), "creases": [Brep(None)]}, "the input creases received a Brep; connect curves"),
    ],
)
def test_what_cannot_be_meshed_is_said(inputs, sentence):
    placed = place("Mesh")
    assert placed.settle(**inputs)["cgc_mesh"] is None
    assert sentence in placed.said("Error")[0]


def test_a_subd_is_no_mesh():
    placed = place("Mesh")
    placed.settle(mesh=SubD(None))
    assert "the input mesh received a SubD" in placed.said("Error")[0]


def test_without_the_extra_the_sentence_names_it(monkeypatch):
    monkeypatch.setitem(sys.modules, "rhino3dm", None)
    placed = place("Mesh")
    placed.settle(surfaces=[Brep(None)], edge_length=1.0)
    assert "pip install 'compas_cgc[rhino]'" in placed.said("Error")[0]


# ----------------------------------------------------------------------
# Running, and ending
# ----------------------------------------------------------------------


def test_two_components_with_one_id_both_finish():
    first, second = place("Solve"), place("Solve")
    second.component.InstanceGuid = first.component.InstanceGuid
    meshes = (dome(), dome(0.02))
    end = time.monotonic() + PATIENCE
    states = ["running", "running"]
    while "running" in states:
        assert time.monotonic() < end
        states = [own.run(cgc_mesh=mesh, run=True)["status"] for own, mesh in zip((first, second), meshes)]
        time.sleep(0.02)
    heights = [max(p.Z for p in own.run(cgc_mesh=mesh, run=True)["mesh"].Vertices) for own, mesh in zip((first, second), meshes)]
    assert states == ["converged"] * 2 and heights[0] < heights[1]


def test_closing_the_document_ends_the_thread_and_what_is_remembered():
    before = len(Instances.DocumentServer.DocumentRemoved.handlers)
    placed, other = place("Solve"), place("Solve")
    for own in (placed, other):
        own.run(run=True, **endless())
    task, alive = task_of(placed), task_of(other)
    placed.component.document.close()
    assert task.wait(PATIENCE) and task_of(placed) is None
    assert alive.running, "the other document is still open"
    other.run(reset=True)
    assert alive.wait(PATIENCE) and len(Instances.DocumentServer.DocumentRemoved.handlers) == before


def test_a_thread_ends_whose_component_is_nowhere_any_more():
    placed = place("Solve")
    placed.run(run=True, **endless())
    task, placed.component.document = task_of(placed), None
    assert task.wait(PATIENCE), "without anybody asking"


def test_the_surface_is_there_before_its_report(monkeypatch):
    told = []
    real = solve_module.measure

    def slow(mesh):
        while not told:
            time.sleep(0.01)
        return real(mesh)

    monkeypatch.setattr(solve_module, "measure", slow)
    placed, mesh = place("Solve"), dome()
    out = placed.run(cgc_mesh=mesh, run=True)
    end = time.monotonic() + PATIENCE
    while out["cgc_mesh"] is None:
        assert time.monotonic() < end
        time.sleep(0.02)
        out = placed.run(cgc_mesh=mesh, run=True)
    assert out["report"] is None and out["mesh"] is not None and placed.component.Message == "measuring"
    # It has its colours from then on.
    assert not out["mesh"].VertexColors
    told.append(True)
    out = until_done(placed, cgc_mesh=mesh, run=True)[-1]
    assert "max error" in out["report"] and len(out["mesh"].VertexColors) == 100


def test_a_failed_solve_leaves_no_earlier_surface_beside_its_balloon():
    placed = place("Solve")
    assert until_done(placed, cgc_mesh=dome(), run=True)[-1]["mesh"] is not None
    out = until_done(placed, cgc_mesh=dome(0.5), run=True)[-1]
    assert placed.said("Error") and out["mesh"] is out["cgc_mesh"] is out["report"] is out["legend"] is None


def test_what_is_measured_is_not_measured_again(monkeypatch):
    placed, mesh = place("Analyse"), dome(0.013)
    assert len(placed.settle(cgc_mesh=mesh)["K"]) == 100
    monkeypatch.setattr(measured, "analyse", None)
    assert placed.settle(cgc_mesh=mesh, show="H")["mesh"] is not None
    assert place("Analyse").settle(cgc_mesh=mesh.copy())["mesh"] is not None


@pytest.mark.parametrize("text", ["studio-pc:7331", " http://studio-pc:7331 "])
def test_an_address_gets_the_http_that_it_lacks(text):
    assert Address.from_text(text, " key ") == Address("http://studio-pc:7331", "key")


def test_components_need_none_of_the_extras():
    code = """
import sys
for name in ("rhino3dm", "flask", "waitress", "shapely", "compas_cgal", "matplotlib"):
    sys.modules[name] = None
import importlib, pkgutil
from compas_cgc.grasshopper import components
for module in pkgutil.iter_modules(components.__path__):
    importlib.import_module(f"compas_cgc.grasshopper.components.{module.name}")
from compas_cgc.grasshopper.components.info import info
import types
print(info(types.SimpleNamespace(Message="")).info)
"""
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    assert "numba" in done.stdout


# ----------------------------------------------------------------------
# Colours, trees and lists
# ----------------------------------------------------------------------


def test_the_surface_is_shown_in_colours_with_a_legend():
    placed = place("Solve")
    inputs = dict(cgc_mesh=dome(), settings=FlowSettings(steps=30), run=True)
    out = until_done(placed, **inputs)[-1]
    assert len(out["colours"]) == len(out["legend"]) == 7 and float(out["legend"][-1]) == pytest.approx(0.01, rel=0.05)
    error = until_done(placed, **inputs, show="error")[-1]
    assert error["mesh"].VertexColors != out["mesh"].VertexColors and float(error["legend"][-1]) < 1e-3
    assert placed.run(**{**inputs, "run": False}, show="error")["mesh"] is error["mesh"], "it is not coloured again"
    assert placed.run(**inputs, show="k")["mesh"] is None and "show must be one of K, H" in placed.said("Error")[0]


def test_regions_come_as_trees_too():
    out = place("Regions").settle(cgc_mesh=nine_regions())
    for name in ("by_region", "borders", "points"):
        assert sorted(out[name].branches) == list(range(9))
    assert [mesh for branch in out["by_region"].branches.values() for mesh in branch] == out["regions"]
    assert all(len(border) == 1 and border[0].points[0] == border[0].points[-1] for border in out["borders"].branches.values())
    assert all(len(points) == 16 for points in out["points"].branches.values())


@pytest.mark.parametrize(
    "name, wire, first, some",
    [("Settings", "method", "auto", "newton"), ("Mesh", "fix", "as drawn", "corners"), ("Analyse", "show", "K", "H")],
)
def test_a_value_list_appears_at_a_new_component_once(name, wire, first, some):
    placed = place(name)
    placed.run()
    document = placed.component.document
    assert not document.objects and document.tick() == 1, "the canvas is changed between solutions"
    (made,) = document.objects
    parameter = next(own for own in placed.component.Params.Input if own.Name == wire)
    assert parameter.Sources == [made] and made.chosen == first and made.NickName == wire
    assert f'"{some}"' in [item.Expression for item in made.ListItems] and "One" not in [item.Name for item in made.ListItems]
    bounds = made.Attributes
    bounds.PerformLayout()
    assert bounds.Bounds.X + bounds.Bounds.Width == pytest.approx(parameter.Attributes.Pivot.X - widgets.GAP)
    parameter.Sources.clear()
    placed.run()
    assert not document.scheduled, "one that is deleted does not come back"


@pytest.mark.parametrize("unit", [0.001, 1.0, 25.4, 1000.0], ids=["km", "m", "inches of mm", "mm"])
def test_a_slider_of_radii_fits_the_mesh_in_any_unit(unit):
    placed, mesh = place("Target"), CGCMesh.from_meshgrid(dx=9.0 * unit, nx=9)
    mesh.set_supports("corners")
    placed.component.Params.Input[0].Sources.append("a wire")
    placed.run(cgc_mesh=mesh)
    document = placed.component.document
    assert placed.said("Error")[0].startswith("connect at least one curvature K") and document.tick() == 1
    (slider,) = document.objects
    radius = next(own for own in placed.component.Params.Input if own.Name == "radius")
    assert radius.Sources == [slider] and slider.NickName == "radius"
    low, value, high = (float(own) / unit for own in (slider.Slider.Minimum, slider.Slider.Value, slider.Slider.Maximum))
    assert (low, value, high) == pytest.approx((6.36, 12.73, 63.6), rel=0.03)
    steps = (high - low) * unit * 10.0**slider.Slider.DecimalPlaces
    assert 500.0 < steps and (steps < 10000.0 or not slider.Slider.DecimalPlaces), "neither coarse nor fine"
    for own in (low, value, high):
        out = placed.run(cgc_mesh=mesh, radius=[own * unit])["cgc_mesh"]
        assert solve(out.to_problem()).converged
    radius.Sources.clear()
    placed.run(cgc_mesh=mesh)
    assert not document.scheduled, "one that is deleted does not come back"


def test_no_list_appears_where_something_is_connected_or_the_definition_was_saved_without():
    placed = place("Analyse")
    placed.settle(cgc_mesh=dome())
    assert not placed.component.document.objects


def test_the_first_value_of_a_list_means_the_same_as_nothing():
    points = [Point3d(0.0, 0.0, 0.0)]
    for supports, fix, count in (([], "as drawn", 12), (points, "as drawn", 1), (points, "points", 1), (points, "boundary", 12)):
        mesh = place("Mesh").settle(mesh=square(3), supports=supports, fix=fix)["cgc_mesh"]
        assert len(mesh.supports()) == count
    assert place("Settings").run(method="auto")["settings"] == place("Settings").run()["settings"]


# ----------------------------------------------------------------------
# Baking
# ----------------------------------------------------------------------


def baked_by_layer():
    document = sys.modules["Rhino"].RhinoDoc.ActiveDoc
    paths = [document.Layers.full_path(layer) for layer in document.Layers]
    found = {path: [] for path in paths}
    for one in document.Objects.values():
        found[paths[one.Attributes.LayerIndex]].append(one)
    return found


def test_a_surface_is_baked_on_layers_with_names_and_user_text_and_replaced():
    mesh = place("Target").run(cgc_mesh=nine_regions(), K=[0.01])["cgc_mesh"]
    placed, other = place("Bake"), place("Bake")
    assert placed.run(cgc_mesh=mesh, bake=False)["baked"] is None and not baked_by_layer()
    for _ in range(2):
        out = placed.run(cgc_mesh=mesh, bake=True)
    found = baked_by_layer()
    root = "CGC Result"
    assert {path: len(own) for path, own in found.items()} == {
        root: 0,
        f"{root}::Mesh": 1,
        f"{root}::Regions": 9,
        f"{root}::Creases": len(mesh.creases()),
        f"{root}::Supports": 4,
    }
    assert len(out["baked"].AllData()) == sum(map(len, found.values()))
    assert [one.Attributes.Name for one in found[f"{root}::Regions"]] == [f"region {i}" for i in range(9)]
    text = found[f"{root}::Regions"][4].Attributes.text
    assert text["region"] == "4" and float(text["K"]) == 0.01 and float(text["area"]) == pytest.approx(9.0)
    assert len(found[f"{root}::Mesh"][0].Geometry.VertexColors) == 100
    other.run(cgc_mesh=mesh, layer="Roof::A", bake=True)
    found = baked_by_layer()
    assert len(found["Roof::A::Mesh"]) == len(found[f"{root}::Mesh"]) == 1, "what others have baked stays"
    document = sys.modules["Rhino"].RhinoDoc.ActiveDoc
    assert document.undo == ["Bake CGC"] * 2 and document.open == 0, "one for each change"


def test_what_cannot_be_baked_is_said():
    placed = place("Bake")
    placed.run(cgc_mesh=dome(), layer="::", bake=True)
    assert "Rhino cannot create the layer" in placed.said("Error")[0] and sys.modules["Rhino"].RhinoDoc.ActiveDoc.open == 0
    sys.modules["Rhino"].RhinoDoc.ActiveDoc = None
    placed.run(cgc_mesh=dome(), bake=True)
    assert "no Rhino document is open" in placed.said("Error")[0]
