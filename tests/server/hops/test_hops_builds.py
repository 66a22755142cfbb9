"""Functions of Hops that build from a solved surface, by real requests in every generation."""

from __future__ import annotations

import numpy as np
import pytest
import rhino3dm

from compas_cgc import CGCProblem
from compas_cgc.fabrication import curve_net
from compas_cgc.fabrication import membrane
from compas_cgc.fabrication import moulds
from compas_cgc.fabrication import panels
from compas_cgc.fabrication import plane_quads
from compas_cgc.fabrication import unroll
from compas_cgc.fabrication.curves import plural
from compas_cgc.io.rhino.meshes import mesh_from_arrays
from compas_cgc.io.rhino.meshes import mesh_to_arrays

from ...support.constant_curvature import cone
from ...support.constant_curvature import revolved_patch
from ...support.exact_surfaces import catenoid
from ...support.freeform import mesh_over
from ...support.hops_client import Hops
from ...support.server_process import KEY
from ...support.tables import rows_and_notes


@pytest.fixture
def hops(server):
    return lambda name, generation=8, comma=False: Hops(f"{server.url}/cgc/{name}", generation, KEY, comma)


def lengths(curves):
    """Return the length of every polyline."""
    found = []
    for curve in curves:
        points = np.array([(curve.Point(k).X, curve.Point(k).Y, curve.Point(k).Z) for k in range(curve.PointCount)])
        found.append(np.linalg.norm(np.diff(points, axis=0), axis=1).sum())
    return found


def problem(shape, K):
    return CGCProblem(*shape).with_supports("boundary").with_targets(K)


@pytest.mark.parametrize("generation, comma", [(8, True), (2026, False)])
def test_a_cone_is_laid_out_on_sheets(hops, generation, comma):
    shape = cone(6, 24)
    given = {"Mesh": mesh_from_arrays(*shape), "K": [0.0], "Length": 6.0, "Width": 3.0}
    status, outputs, errors, warnings = hops("unroll", generation, comma).solve(**given)
    assert (status, errors, warnings) == (200, [], [])
    patterns = unroll(problem(shape, 0.0), (6.0, 3.0))
    assert outputs["Labels"] == [piece.label for piece in patterns.pieces] and patterns.summary() in outputs["Info"][0]
    assert len(outputs["Outlines"]) == len(outputs["Pieces"]) == len(outputs["Places"]) == len(patterns.pieces)
    expected = [np.linalg.norm(own.points - np.roll(own.points, 1, axis=0), axis=1).sum() for p in patterns.pieces for own in p.loops]
    assert np.allclose(lengths(outputs["Outlines"]), expected, rtol=1e-9) and len(outputs["Sheets"]) == patterns.sheets
    V, F = mesh_to_arrays(outputs["Pieces"][0])
    area = np.linalg.norm(np.cross(V[F[:, 1]] - V[F[:, 0]], V[F[:, 2]] - V[F[:, 0]]), axis=1).sum() / 2
    assert area == pytest.approx(patterns.pieces[0].area)


def test_a_design_becomes_panels_on_few_moulds(hops):
    vertices, quads = mesh_over(lambda x, y: 1.0 - 0.03 * (x - 4.0) ** 2 - 0.04 * (y - 2.0) ** 2, 8.0, 4.0, 0.5)
    mesh = mesh_from_arrays(vertices, np.array(quads))
    status, outputs, errors, warnings = hops("rationalise").solve(Mesh=mesh, Panel=2.0, Moulds=2)
    assert (status, errors, warnings) == (200, [], []) and "8 panels on 2 moulds" in outputs["Info"][0]
    assert len(outputs["Panels"]) == len(outputs["Mould"]) == 8 and len(outputs["K"]) == 2
    assert 0.0 < np.abs(outputs["Distance"]).max() < 0.05
    line = [
        rhino3dm.Point3d(x, 0.3 * x, 1.0 - 0.03 * (x - 4.0) ** 2 - 0.04 * (0.3 * x - 2.0) ** 2) for x in np.linspace(0.0, 8.0, 33).tolist()
    ]
    _, outputs, errors, _ = hops("rationalise").solve(Mesh=mesh, Radii=[14.0], Seams=[rhino3dm.PolylineCurve(line)])
    assert errors == [] and len(outputs["Panels"]) == 2 and outputs["K"] == [pytest.approx(1.0 / 14.0**2)]
    _, outputs, errors, warnings = hops("rationalise").solve(Mesh=mesh, Panel=4.0, Within=1e-4)
    assert errors == [] and "try" in warnings[0]


def test_locked_panels_of_a_design_keep_their_moulds(hops):
    vertices, quads = mesh_over(lambda x, y: 1.0 - 0.03 * (x - 4.0) ** 2 - 0.04 * (y - 2.0) ** 2, 8.0, 4.0, 0.5)
    given = {"Mesh": mesh_from_arrays(vertices, np.array(quads)), "Panel": 4.0, "Radii": [14.0, 0.0]}
    _, free, _, _ = hops("rationalise").solve(**given)
    other = [1.0 / 14.0**2, 0.0].index(free["K"][1 - free["Mould"][1]] if len(free["K"]) > 1 else 0.0)
    _, outputs, errors, _ = hops("rationalise").solve(**given, Locked=[1], LockedMoulds=[other])
    assert errors == [] and outputs["K"][outputs["Mould"][1]] == pytest.approx([1.0 / 14.0**2, 0.0][other])
    assert outputs["K"][outputs["Mould"][1]] != free["K"][free["Mould"][1]]
    _, _, errors, _ = hops("rationalise").solve(**given, Locked=[0, 1], LockedMoulds=[1])
    assert "2 panels and LockedMoulds 1 mould" in errors[0]
    _, _, errors, _ = hops("rationalise").solve(**given, Locked=[1], LockedMoulds=[2])
    assert "panel 1 cannot be locked to mould 2" in errors[0]


SHALLOW = mesh_over(lambda x, y: 1.0 - 0.03 * (x - 4.0) ** 2 - 0.04 * (y - 2.0) ** 2, 8.0, 4.0, 0.5)
PRICED = {"Mesh": mesh_from_arrays(SHALLOW[0], np.array(SHALLOW[1])), "Panel": 2.0, "Within": 0.5}


def test_the_cheapest_surface_within_a_distance_is_flat(hops):
    given = {**PRICED, "Panel": 4.0}
    _, outputs, errors, _ = hops("rationalise").solve(**given, Costs=[0.0, 100.0, 5000.0, 400.0, 9000.0, 700.0])
    assert errors == [] and outputs["K"] == [0.0] and "costs: 200, moulds 0 and panels 200" in outputs["Info"][0]
    for wrong, sentence in (({"Costs": [1.0, 2.0]}, "costs are six numbers"), ({"Weights": [4.0, 2.0]}, "weights must be rows")):
        _, _, errors, _ = hops("rationalise").solve(**given, **wrong)
        assert sentence in errors[0]


@pytest.mark.nightly
def test_costs_and_weights_decide_between_surfaces(hops):
    _, outputs, errors, _ = hops("rationalise").solve(**PRICED, Costs=[0.0, 1000.0, 5.0, 400.0, 9000.0, 700.0])
    assert errors == [] and outputs["K"][0] > 0.0 and "costs: 3,205, moulds 5 and panels 3,200" in outputs["Info"][0]
    given = {**PRICED, "Moulds": 1, "Within": 0.0}
    _, even, _, _ = hops("rationalise").solve(**given)
    _, outputs, errors, _ = hops("rationalise").solve(**given, Weights=[4.0, 2.0, 1.0, 1.0, 20.0])
    assert errors == [] and outputs["Distance"] != even["Distance"]


def test_sheets_have_margins_and_allowances(hops):
    pytest.importorskip("shapely")
    shape = cone(6, 24)
    given = {"Mesh": mesh_from_arrays(*shape), "K": [0.0], "Length": 6.0, "Width": 3.0}
    status, outputs, errors, _ = hops("unroll").solve(**given, Margin=0.02, Allowance=0.03)
    patterns = unroll(problem(shape, 0.0), (6.0, 3.0), margin=0.02, allowance=0.03)
    assert (status, errors) == (200, []) and patterns.summary() in outputs["Info"][0]
    around = [np.linalg.norm(own - np.roll(own, 1, axis=0), axis=1).sum() for piece in patterns.pieces for own in piece.allowance]
    assert np.allclose(lengths(outputs["Allowances"]), around, rtol=1e-9)
    assert outputs["Sheet"] == [piece.sheet for piece in patterns.pieces]
    assert len(rows_and_notes(outputs["CutList"])[0]) == len(patterns.pieces)


def test_the_cut_list_names_material_and_thickness_and_contours_lie_in_the_kerf(hops):
    pytest.importorskip("shapely")
    shape = cone(6, 24)
    given = {"Mesh": mesh_from_arrays(*shape), "K": [0.0], "Length": 6.0, "Width": 3.0}
    status, outputs, errors, _ = hops("unroll").solve(**given, Kerf=0.004, Material="birch plywood", Thickness=9.0)
    patterns = unroll(problem(shape, 0.0), (6.0, 3.0), kerf=0.004, material="birch plywood", thickness=9.0)
    assert (status, errors) == (200, []) and "material: birch plywood, 9 mm thick" in outputs["Info"][0]
    rows, _ = rows_and_notes(outputs["CutList"])
    assert {(row["material"], row["thickness in mm"]) for row in rows} == {("birch plywood", "9")}
    around = [np.linalg.norm(own - np.roll(own, 1, axis=0), axis=1).sum() for piece in patterns.pieces for own in piece.allowance]
    assert np.allclose(lengths(outputs["Allowances"]), around, rtol=1e-9)


def test_a_panel_that_is_kept_whole_is_refused_on_a_smaller_sheet(hops):
    given = {"Mesh": mesh_from_arrays(*cone(6, 24)), "K": [0.0], "Length": 3.0, "Width": 1.5}
    _, outputs, errors, _ = hops("unroll").solve(**given, Whole=True)
    assert "more than a sheet of 3000 x 1500 mm; use larger sheets" in errors[0] and not any(outputs.values())


def test_forces_of_a_dome(hops):
    shape = revolved_patch(8, 0.02)
    status, outputs, errors, warnings = hops("membrane", comma=True).solve(Mesh=mesh_from_arrays(*shape), K=[0.02], Pressure=2.0)
    state = membrane(problem(shape, 0.02), 2.0)
    assert (status, errors, warnings) == (200, [], list(state.remarks))
    assert state.summary() in outputs["Info"][0] and len(outputs["N1"]) == len(shape[0]) and min(outputs["N2"]) > 0
    assert outputs["Compression"] == [] and len(outputs["Tension"]) == 2 * len(shape[1]) and len(outputs["Reactions"]) > 8


def test_a_net_and_curves_through_points(hops):
    shape = revolved_patch(12, -0.02)
    mesh = mesh_from_arrays(*shape)
    status, outputs, errors, _ = hops("net").solve(Mesh=mesh, K=[-0.02], Spacing=1.0)
    net = curve_net(problem(shape, -0.02), 1.0)
    assert (status, errors) == (200, []) and len(outputs["First"]) + len(outputs["Second"]) == len(net.curves)
    assert np.allclose(outputs["Sides"], net.lengths) and len(outputs["Nodes"]) == len(net.nodes)
    status, outputs, errors, _ = hops("net").solve(Mesh=mesh, K=[-0.02], Through=[(0.0, 0.0, 4.0)])
    assert (status, errors) == (200, []) and len(outputs["First"]) == len(outputs["Second"]) == 1


def test_plane_quads_and_their_beams(hops):
    shape = revolved_patch(12, 0.02)
    status, outputs, errors, _ = hops("quads").solve(Mesh=mesh_from_arrays(*shape), K=[0.02], Spacing=1.2, Depth=0.1)
    quads = plane_quads(problem(shape, 0.02), 1.2, depth=0.1)
    assert (status, errors) == (200, []) and len(outputs["Faces"]) == len(quads.faces) and len(outputs["Beams"]) == len(quads.edges)
    assert np.allclose(outputs["Planarity"], quads.planarity) and np.allclose(outputs["Twist"], quads.twist)
    assert len(outputs["Nodes"]) == len(outputs["Axes"]) == len(quads.vertices) and quads.summary() in outputs["Info"][0]


def test_a_net_on_a_soap_film_is_of_the_kind_that_is_chosen(hops):
    surface = catenoid()
    V, F, _ = surface.patch(16)
    given = {"Mesh": mesh_from_arrays(V, F), "K": [0.0], "Law": "minimal", "Spacing": 0.3}
    posed = CGCProblem(V, F).with_supports("boundary").with_laws("minimal")
    for kind in ("", "asymptotic"):
        status, outputs, errors, _ = hops("net").solve(**given, Kind=kind)
        assert (status, errors) == (200, [])
        expected = curve_net(posed, 0.3, kind=kind or None)
        assert plural(expected.curves[0].kind) in outputs["Info"][0]
        assert np.allclose(lengths(outputs["First"]), [own.length for own in expected.curves if own.family == 0], rtol=1e-6)
    assert "kind must be curvature or asymptotic" in hops("net").solve(**given, Kind="square")[2][0]


@pytest.mark.parametrize(
    "name, K, inputs, sentence",
    [
        ("unroll", 0.5, {}, "the surface is rough"),
        ("unroll", 0.02, {"Length": 0.001}, "use larger sheets"),
        ("membrane", 0.02, {"Pressure": 0.0}, "membrane forces need a load"),
        ("net", 0.02, {"Through": [(99.0, 99.0, 99.0)]}, "the points lie on it"),
        ("mould", 0.02, {"Material": "cheese"}, "there is no material 'cheese'"),
    ],
)
def test_what_cannot_be_built_is_said_in_the_balloon(hops, name, K, inputs, sentence):
    status, outputs, errors, _ = hops(name).solve(Mesh=mesh_from_arrays(*revolved_patch(8, 0.02)), K=[K], **inputs)
    assert status == 422 and outputs == {} and len(errors) == 1 and sentence in errors[0]


def test_moulds_of_least_bending_are_chosen_by_an_input(hops):
    shape = revolved_patch(8, 0.02)
    given = {"Mesh": mesh_from_arrays(*shape), "K": [0.02], "Count": 4}
    status, outputs, errors, _ = hops("mould").solve(**given, LeastBending=True)
    assert (status, errors) == (200, [])
    usual = hops("mould").solve(**given)[1]
    own = problem(shape, 0.02)
    divided = panels(own, count=4)
    (least,) = moulds(own, divided, least_bending=True).moulds
    assert least.kind != "sphere" and f"mould 1: {least.kind} of K" in outputs["Info"][0]
    assert "mould 1: sphere of K" in usual["Info"][0]


def test_panels_of_nearly_one_k_share_a_mould_within_a_tolerance(hops):
    V, F = revolved_patch(8, 0.02)
    crease = V[np.abs(V[:, 0]) < 1e-9]
    curve = rhino3dm.PolylineCurve([rhino3dm.Point3d(*point) for point in crease[np.argsort(crease[:, 1])].tolist()])
    given = {"Mesh": mesh_from_arrays(V, F), "Creases": [curve], "K": [0.02, 0.0201], "At": [(-1.0, 0.0, 0.0), (1.0, 0.0, 0.0)], "Count": 1}
    assert sorted(hops("mould").solve(**given)[1]["Mould"]) == [0, 1]
    status, outputs, errors, _ = hops("mould").solve(**given, Tolerance=10.0)
    assert (status, errors) == (200, []) and outputs["Mould"] == [0, 0]
