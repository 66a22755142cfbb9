"""Mistakes of a first hour, in Python and in a terminal: each gets the sentence that says what to write instead."""

from __future__ import annotations

import re

import numpy as np
import pytest
from compas.datastructures import Mesh
from compas.geometry import Circle
from compas.geometry import Frame
from compas.geometry import Point
from compas.geometry import Polyline

import compas_cgc
from compas_cgc import CGCMesh
from compas_cgc import CGCProblem
from compas_cgc import Clearance
from compas_cgc import Fixed
from compas_cgc import FlowSettings
from compas_cgc import Height
from compas_cgc import Mirror
from compas_cgc import OnCurve
from compas_cgc import Proximity
from compas_cgc import Rise
from compas_cgc import check
from compas_cgc import read
from compas_cgc import settings_for
from compas_cgc import solve
from compas_cgc import write
from compas_cgc.cli import main
from compas_cgc.fabrication import curve_net
from compas_cgc.fabrication import develop
from compas_cgc.fabrication import draw_sheets
from compas_cgc.fabrication import membrane
from compas_cgc.fabrication import moulds
from compas_cgc.fabrication import panels
from compas_cgc.fabrication import unroll
from compas_cgc.fabrication import widest_panel
from compas_cgc.solvers.limits import largest_target
from compas_cgc.study import Results
from compas_cgc.study import Study
from compas_cgc.study import pareto_front
from compas_cgc.study import run_study

N = 6
SQUARE = [[0, 0, 0], [6, 0, 0], [6, 6, 0], [0, 6, 0], [0, 0, 0]]


def plan() -> CGCMesh:
    return CGCMesh.from_meshgrid(dx=6.0, nx=N)


def posed() -> CGCMesh:
    mesh = plan()
    mesh.set_supports("boundary")
    mesh.set_target(0.01)
    return mesh


def arrays():
    return plan().arrays()


def ball() -> CGCMesh:
    mesh = CGCMesh.from_mesh(Mesh.from_polyhedron(20))
    mesh.set_target(1.0)
    return mesh


def half_flipped() -> CGCMesh:
    vertices, faces = arrays()
    faces[:10] = faces[:10, ::-1].copy()
    mesh = CGCMesh.from_vertices_and_faces(vertices.tolist(), faces.tolist())
    mesh.set_supports("boundary")
    mesh.set_target(0.01)
    return mesh


def creased(path) -> CGCMesh:
    mesh = posed()
    mesh.set_creases([path])
    return mesh


def millimetres() -> CGCMesh:
    mesh = CGCMesh.from_meshgrid(dx=6000.0, nx=N)
    mesh.set_supports("boundary")
    mesh.set_target(0.01)
    return mesh


def loose() -> CGCMesh:
    vertices, faces = arrays()
    mesh = CGCMesh.from_vertices_and_faces(vertices[faces.ravel()].tolist(), np.arange(faces.size).reshape(-1, 3).tolist())
    mesh.set_supports("boundary")
    mesh.set_target(0.01)
    return mesh


def only(**what) -> CGCMesh:
    mesh = plan()
    if "supports" in what:
        mesh.set_supports(what["supports"])
    if "K" in what:
        mesh.set_target(what["K"])
    return mesh


INSIDE = [22, 23, 24]  # three vertices in the middle of the plan

# What is done, and words of the sentence: the thing, and the mend.
MISTAKES = {
    "supports as coordinates": (lambda: plan().set_supports(SQUARE), "not coordinates such as .*mesh.vertices_near"),
    "supports as points": (lambda: plan().set_supports([Point(0, 0, 0)]), "not coordinates such as Point.*mesh.vertices_near"),
    "supports as an array of places": (lambda: plan().set_supports(np.zeros((2, 3))), "not coordinates such as"),
    "supports of arrays as coordinates": (lambda: plan().to_problem().with_supports(SQUARE), "not coordinates such as"),
    "one support": (lambda: plan().set_supports(0), r"must be a list of vertices, not the number 0; write \[0\]"),
    "half a vertex": (lambda: plan().set_supports([0.5]), "must be whole numbers, the keys of vertices, not 0.5"),
    "a mask for supports": (lambda: plan().set_supports(plan().arrays()[0][:, 0] == 0.0), r"not a mask; use np.flatnonzero\(mask\)"),
    "a word for supports": (
        lambda: plan().set_supports("edge"),
        "supports must be vertices, 'boundary', .*, not 'edge'",
    ),
    "a word in a list": (lambda: plan().set_supports(["corners"]), "write 'corners' without list brackets"),
    "one place as supports": (lambda: plan().set_supports((0.0, 0.0, 0.0)), "must be keys of vertices, not coordinates such as"),
    "a goal without its kind": (lambda: compas_cgc.solve(posed(), goals=[{"rise": 2}]), r"write \{'kind': 'rise', 'rise': 2\}"),
    "two outlines": (lambda: CGCMesh.from_outline([SQUARE, SQUARE], 1.0), "a mesh has one outline"),
    "an outline on a line": (lambda: CGCMesh.from_outline([[0, 0], [4, 0], [8, 0]], 1.0), "lie on one line"),
    "an outline without a number": (
        lambda: CGCMesh.from_outline([[0, 0], [4, 0], [4, np.nan]], 1.0),
        "point 2 of the outline has a coordinate",
    ),
    "a crease beside the outline": (lambda: CGCMesh.from_outline(SQUARE, 1.0, creases=[[[9, 0], [9, 4]]]), "lies outside the outline"),
    "a support that is not there": (lambda: plan().set_supports([999]), "there is no vertex 999"),
    "two supports that are not there": (lambda: plan().set_supports([0, 999, -7]), "there are no vertices 999, -7 in the mesh"),
    "the boundary of a closed solid": (lambda: ball().set_supports("boundary"), "is closed and has no boundary; name the support vertices"),
    "a closed solid that nothing holds": (lambda: solve(ball()), r"the mesh is closed and has no boundary.*set_supports\(\[...\]\)"),
    "a flat list for a crease": (lambda: plan().set_creases([0, 1, 2]), r"write \[\[0, 1, 2\]\]"),
    "a crease as coordinates": (lambda: plan().set_creases([SQUARE]), "of a crease must be keys of vertices, not coordinates"),
    "a crease as a polyline": (lambda: plan().set_creases([Polyline(SQUARE)]), "of a crease must be keys of vertices, not coordinates"),
    "a number for creases": (lambda: plan().set_creases(3), r"such as \[\[0, 1, 2\]\], not 3"),
    "a crease of one vertex": (lambda: plan().set_creases([[3]]), "two or more vertices"),
    "a crease across the faces": (lambda: plan().set_creases([[0, 20]]), "from vertex 0 to 20 does not follow an edge"),
    "a region beyond a crease that parts nothing": (
        lambda: creased(INSIDE).set_target(0.02, region=1),
        "there is no region 1; the mesh has 1 region.*from boundary to boundary, or close",
    ),
    "a region by its name": (
        lambda: posed().set_target(0.1, region="middle"),
        "a region must be given by its number, not 'middle'; the mesh has 1 region, number 0",
    ),
    "targets in a list": (lambda: posed().set_target([0.1, 0.2]), r"one number, .*set_target\(K, region=r\)"),
    "targets by region": (lambda: posed().set_target({0: 0.1}), r"one number, .*set_target\(K, region=r\)"),
    "a word for K": (lambda: posed().set_target("steep"), "the target must be a number, not 'steep'"),
    "no number for K": (lambda: posed().set_target(float("nan")), "the target must be a finite number"),
    "a radius for K": (lambda: solve(only(supports="boundary", K=14.0)), "the target 14 is too large for this boundary"),
    "metres in millimetres": (lambda: solve(millimetres()), "check the units: .* 0.01 1/m² is 1e-08 1/mm²"),
    "nothing said at all": (lambda: solve(plan()), "no supports.*no target curvature is set"),
    "no supports": (lambda: solve(only(K=0.01)), r"the mesh has no supports; .*set_supports\('boundary'\)"),
    "no target": (lambda: solve(only(supports="boundary")), r"no target curvature is set; .*mesh.set_target\(K\)"),
    "everything held": (lambda: solve(only(supports=range(49), K=0.01)), "no internal vertex.*free some supports"),
    "a COMPAS mesh": (lambda: solve(Mesh.from_meshgrid(5.0, 5)), r"CGCMesh.from_mesh\(mesh\)"),
    "a file": (lambda: solve("roof.3dm"), r"read the file first: compas_cgc.read\('roof.3dm'\)"),
    "vertices and faces": (lambda: solve(arrays()), r"CGCProblem\(vertices, faces\)"),
    "nothing": (lambda: solve(None), "a CGCMesh or a CGCProblem is solved, not None"),
    "a method misspelt": (lambda: solve(posed(), method="newtn"), "must be one of auto, flow, newton, projection, bending, not 'newtn'"),
    "a setting misspelt": (lambda: solve(posed(), settings={"tolerence": 1e-3}), "'tolerence'; did you mean 'tolerance'?"),
    "a word for steps": (lambda: solve(posed(), settings={"steps": "many"}), "steps must be a whole number"),
    "settings of another method": (
        lambda: solve(posed(), method="newton", settings=FlowSettings()),
        "takes NewtonSettings, not FlowSettings",
    ),
    "an option of another method": (lambda: solve(posed(), method="newton", settings={"s": 0.5}), "s is a setting of flow, not of newton"),
    "a height at coordinates": (lambda: solve(posed(), goals=[Height([[3.0, 3.0, 0.0]], 1.0)]), "not coordinates such as"),
    "a height before its vertices": (lambda: Height(1.0, [24]), r"height must be a number, not \[24\]"),
    "a height for a support": (
        lambda: solve(posed(), goals=[Height([0], 1.0)]),
        "contradicts the height 0 of the support at vertex 0; free that vertex, or remove it from the goal Height",
    ),
    "a height nowhere": (lambda: solve(posed(), goals=[Height([999], 1.0)]), "names vertex 999, but the mesh has vertices 0 to 48"),
    "a rise with its unit": (lambda: Rise("4 m"), "rise must be a number, not '4 m'"),
    "no rise": (lambda: Rise(0.0), "rise must be a number other than 0"),
    "a clearance the wrong way round": (lambda: Clearance(2.5, (1, 1, 2, 2)), "height must be a number"),
    "a goal by its name": (lambda: solve(posed(), goals=["rise"]), r"write a value such as Rise\(4.0\)"),
    "unknown switched on": (lambda: solve(posed(), goals=[Rise(0.5)], unknown=True), "must be numbers of regions, or 'all'"),
    "faces half turned": (lambda: solve(half_flipped()), r"and 5 more are oriented against their neighbours; unify them \(mesh.unify\(\)"),
    "faces from one": (
        lambda: CGCMesh.from_vertices_and_faces(arrays()[0].tolist(), (arrays()[1] + 1).tolist()),
        "the faces count vertices from 1 instead of 0: subtract 1",
    ),
    "triangles that share no vertices": (lambda: solve(loose()), r"its faces share no vertices: weld it \(mesh.weld\(\)\)"),
    "the boundary of no faces": (
        lambda: CGCMesh.from_vertices_and_faces(SQUARE, [[0, 1, 1]]).set_supports("boundary"),
        "the mesh has no faces and so no boundary; add faces of three or more different vertices",
    ),
    "vertices in plan": (
        lambda: CGCMesh.from_vertices_and_faces(arrays()[0][:, :2].tolist(), arrays()[1].tolist()),
        "add z = 0 for a plan",
    ),
    "arrays in plan": (lambda: CGCProblem(arrays()[0][:, :2], arrays()[1]), r"must have the shape \(n, 3\), not \(49, 2\)"),
    "quads as arrays": (lambda: CGCProblem(SQUARE[:4], [[0, 1, 2, 3]]), "triangulate quads and n-gons first"),
    "arrays swapped": (lambda: CGCProblem(arrays()[1], arrays()[0]), "faces must hold integers"),
    "half a square": (lambda: CGCMesh.from_meshgrid(dx=15, nx=15.5), "nx, the number of cells, must be"),
    "no squares": (lambda: CGCMesh.from_meshgrid(dx=15, nx=0), "nx, the number of cells, must be"),
    "one hole without a list": (
        lambda: CGCMesh.from_outline(SQUARE, 1.0, holes=[[2, 2, 0], [3, 2, 0], [3, 3, 0], [2, 2, 0]]),
        r"holes=\[curve\]",
    ),
    "an outline that crosses itself": (lambda: CGCMesh.from_outline([SQUARE[k] for k in (0, 2, 1, 3, 0)], 1.0), "a curve crosses itself"),
    "a length below zero": (lambda: CGCMesh.from_outline(SQUARE, -1.0), "the edge length must be a positive number"),
    "a file that is not there": (lambda: read("nothing.3dm"), "there is no file nothing.3dm"),
    "a drawing of the manual that was not copied": (
        lambda: read("vault.3dm"),
        r"copy the sample drawing vault.3dm from .*vault.3dm",
    ),
    "a folder": (lambda: read("."), "is a folder; give the path of a file in it"),
    "a kind of file that is not known": (lambda: write("roof.dwg", posed()), r"use .3dm, .json"),
    "write the wrong way round": (lambda: write(posed(), "roof.3dm"), r"write\('roof.3dm', mesh\)"),
    "a strategy without creases": (lambda: posed().set_strategy(s=0.5), "no crease to set a strategy for; set creases first"),
    "no target, with one that is gentle": (
        lambda: solve(read(compas_cgc.get("curved_crease.3dm"))),
        r"no target curvature is set; .*mesh.set_target\(K\).* K = 0.005 gives this mesh a gentle curvature",
    ),
    "a number for goals": (lambda: solve(posed(), goals=3), r"goals must be a list such as \[Rise\(4.0\)\], not 3"),
    "a word for goals": (lambda: solve(posed(), goals="rise"), r"goals must be a list such as \[Rise\(4.0\)\], not 'rise'"),
    "a goal without its value": (lambda: solve(posed(), goals=Rise), r"Rise is a class: write Rise\(...\)"),
    "goals without their values": (lambda: solve(posed(), goals=[Rise]), r"write Rise\(...\) with its values"),
    "a number for goals of a mesh": (lambda: posed().set_goals(3), r"goals must be a list such as \[Rise\(4.0\)\], not 3"),
    "a number for the callback": (
        lambda: solve(posed(), callback=3),
        "callback must be a function that is called after every step, .* not 3",
    ),
    "a callback that takes nothing": (lambda: solve(posed(), callback=lambda: None), "callback must be a function of one argument"),
    "a class": (lambda: solve(CGCMesh), "CGCMesh is a class; create an instance first"),
    "options in a list": (lambda: settings_for("newton", [3]), "settings are options by their names"),
    "a mesh of nothing": (lambda: CGCMesh.from_mesh(None), r"takes a COMPAS mesh, not None; read a file with compas_cgc.read"),
    "a mesh of arrays": (lambda: CGCMesh.from_mesh(arrays()), r"convert arrays with CGCMesh.from_vertices_and_faces"),
    "a width as a word": (lambda: CGCMesh.from_meshgrid("10", 5), "dx, the width of the grid, must be a number, not '10'"),
    "an outline by its file": (
        lambda: CGCMesh.from_outline("plan.3dm", 1.0),
        "outline must be points of two or .*'plan.3dm'",
    ),
    "an outline of mixed points": (
        lambda: CGCMesh.from_outline([[0, 0], [6, 0, 0], [6, 6, 0]], 1.0),
        "outline must be points of two or three",
    ),
    "one column without a list": (lambda: CGCMesh.from_outline(SQUARE, 1.0, points=[3, 3, 0]), r"points=\[\[3.0, 3.0, 0.0\]\]"),
    "a number for holes": (lambda: CGCMesh.from_outline(SQUARE, 1.0, holes=3), r"holes must be a list of curves: holes=\[curve\], not 3"),
    "a curve for a surface": (lambda: CGCMesh.from_surface(Circle(1.0), 1.0), "a Circle is not a surface; give a surface of COMPAS"),
    "flat faces": (lambda: CGCMesh.from_vertices_and_faces(SQUARE, [0, 1, 2]), r"faces must be lists of vertices, .*not \[0, 1, 2\]"),
    "no vertices": (lambda: CGCMesh.from_vertices_and_faces(None, [[0, 1, 2]]), "vertices must be points of three numbers, .*not None"),
    "the role of a vertex that is not there": (lambda: plan().vertex_role(999), "there is no vertex 999 in the mesh"),
    "the target of a vertex that is not there": (lambda: plan().vertex_target(999), "there is no vertex 999 in the mesh"),
    "a word for a delay": (lambda: posed().set_strategy(e="two"), "e must be a number, not 'two'"),
    "a crease by its name": (lambda: creased(range(21, 28)).set_strategy(s=0.5, crease="left"), "there is no crease 'left'"),
    "places as a word": (lambda: plan().vertices_near("corner"), "points must be numbers x, y, z, not 'corner'"),
    "an axis by its name": (lambda: solve(posed(), goals=Mirror([0, 0, 0], "x")), "must be numbers x, y, z, not 'x'"),
    "vertices of a constraint as a word": (lambda: solve(posed(), goals=Fixed("corners")), "must be a list of vertices, not 'corners'"),
    "a circle for a polyline": (lambda: OnCurve([0], Circle(1.0)), "points of a curve must be numbers x, y, z, not Circle"),
    "a word for a weight": (lambda: Proximity([0], "near"), "weight must be a number, not 'near'"),
    "a check of a file": (lambda: check("roof.3dm"), r"read the file first: compas_cgc.read\('roof.3dm'\)"),
    "an analysis of nothing": (
        lambda: compas_cgc.analyse(None),
        "or the result of a solve is analysed, not None",
    ),
    "limits of a word": (lambda: largest_target("roof"), r"read the file first: compas_cgc.read\('roof'\)"),
    "limits with a word": (lambda: largest_target(posed(), tolerance="small"), "tolerance must be a number, not 'small'"),
    "derivatives before a solve": (lambda: compas_cgc.sensitivity(posed()), r"a solved surface: sensitivity\(solve\(mesh\)\)"),
    "nothing to write": (lambda: write("roof.obj", None), "a CGCMesh or a CGCProblem or a result is written, not None"),
    "panels with a unit": (lambda: panels(posed(), "2m"), "the size of panels must be a number, not '2m'"),
    "panels of nothing": (lambda: panels(None, 2.0), "or the result of a solve is built from, not None"),
    "moulds of a length": (lambda: moulds(solve(posed()), 2.0), r"panels must be the result of panels\(surface, size\), not 2.0"),
    "a pressure with its unit": (lambda: membrane(solve(posed()), "1 kPa"), "pressure must be a number, not '1 kPa'"),
    "a strain with its unit": (lambda: unroll(solve(posed()), strain="1 %"), "strain must be a number, not '1 %'"),
    "a number for seams": (lambda: unroll(solve(posed()), seams=3), r"seams must be paths of vertices, .*not 3"),
    "a word for regions": (lambda: unroll(solve(posed()), regions="all"), "regions must be numbers of regions, not 'all'"),
    "a spacing with its unit": (lambda: curve_net(solve(posed()), "1m"), "spacing must be a number, not '1m'"),
    "a region to develop by its name": (lambda: develop(posed(), "roof"), "a region must be a whole number, not 'roof'"),
    "a width of a word": (lambda: widest_panel("K", 0.001), "K must be a number, not 'K'"),
    "sheets of a result": (lambda: draw_sheets(posed()), r"sheets are drawn from patterns: draw_sheets\(unroll\(surface\)\)"),
    "a study of nothing": (lambda: Study(None), r"create a study by Study.from_dict\(\{...\}\) .* not from None"),
    "a file for a problem": (lambda: CGCProblem("a.3dm", [[0, 1, 2]]), "vertices and faces must be arrays of numbers"),
    "a study as a dictionary": (lambda: run_study(posed(), {"parameters": {}}, "out"), r"Study.from_dict\(\{...\}\) or read_study"),
    "results of nothing": (lambda: Results(None), r"the argument must be the folder of a study, Results\('folder'\), not None"),
    "a front of a folder": (lambda: pareto_front("out"), r"the argument must be the results of a study, Results\('folder'\), not 'out'"),
    "a sample that is not there": (lambda: compas_cgc.get("roof"), "there is no sample 'roof'; the samples are"),
}


def wrong_messages(mistakes: dict, kind: type[Exception]) -> dict[str, str]:
    """Return the mistakes that raise no error of a kind, or one without the expected words."""
    found = {}
    for mistake, (made, words) in mistakes.items():
        try:
            made()
            found[mistake] = "no error"
        except kind as error:
            if not re.search(words, str(error)):
                found[mistake] = f"{error} does not match {words}"
    return found


def test_mistakes_get_their_sentences(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    assert wrong_messages(MISTAKES, ValueError) == {}
    assert not list(tmp_path.iterdir())


# Arguments that do not fit, and words of the sentence.
ARGUMENTS = {
    "columns of an outline": (
        lambda: CGCMesh.from_outline(SQUARE, 1.0, columns=[[3, 3]]),
        "no argument 'columns'; give columns as points: .*points=",
    ),
    "supports of an outline": (lambda: CGCMesh.from_outline(SQUARE, 1.0, supports="boundary"), r"mesh.set_supports\(\"boundary\"\)"),
    "an outline without a length": (
        lambda: CGCMesh.from_outline(SQUARE),
        r"requires the argument 'edge_length'; write from_outline\(outline, ",
    ),
    "moulds without panels": (lambda: moulds(posed()), r"moulds\(\) requires the argument 'panels'; write moulds\(mesh, panels\)"),
    "moulds of a size": (lambda: moulds(posed(), size=2.0), r"give it to the panels: moulds\(surface, panels\(surface, size=...\)\)"),
    "a study without a folder": (lambda: run_study(posed(), None), "requires the argument 'folder'"),
    "a method without its name": (
        lambda: solve(posed(), "newton"),
        "accepts only 'problem' as positional arguments; pass the others by name, such as method=...",
    ),
    "a setting by part of its name": (lambda: solve(posed(), tol=1e-3), r"no argument 'tol'; .*settings=\{'tolerance': ...\}"),
    "a setting with a word before": (lambda: solve(posed(), max_steps=9), r"no argument 'max_steps'; .*settings=\{'steps': ...\}"),
    "a symbol of the paper": (lambda: FlowSettings(mu=3), r"FlowSettings\(\) has no argument 'mu'; did you mean 'mu0'"),
    "a problem of one thing": (lambda: CGCProblem("a.3dm"), "requires the argument 'faces'; write CGCProblem\\(vertices, faces"),
    "a size twice": (lambda: panels(posed(), 2.0, size=2.0), "received 'size' twice"),
}


def test_wrong_arguments_get_their_sentences():
    assert wrong_messages(ARGUMENTS, TypeError) == {}


# What is no mistake in the end, and what is said all the same.
REMARKS = {
    "upside down": (lambda: (lambda mesh: mesh.flip() or mesh)(posed()), "the normals point down, so the surface will hang"),
    "a crease that ends inside": (lambda: creased(INSIDE), "creases end at vertices 22, 24, inside a region"),
}


@pytest.mark.parametrize("case", REMARKS)
def test_what_may_not_be_meant_is_said(case):
    made, words = REMARKS[case]
    said = check(made())
    assert len(said) == 1 and words in said[0] and not said[0].fatal
    assert words in solve(made()).remarks[0]


def test_what_is_meant_is_taken():
    one = solve(posed(), goals=Rise(0.5), unknown=0)
    assert one.converged and one.vertices[:, 2].max() == pytest.approx(0.5)
    assert posed().check() == [] and creased([3 * 7 + k for k in range(7)]).check() == []
    flat = CGCMesh.from_outline([point[:2] for point in SQUARE], 1.5)
    assert flat.arrays()[0][:, 2].max() == 0.0
    holed = CGCMesh.from_outline(SQUARE, 1.0, holes=[Circle(1.2, Frame([3, 3, 0]))])
    assert len(holed.boundary_loops()) == 2
    mesh = plan()
    mesh.set_supports([0.0, 6.0])
    assert mesh.supports() == [0, 6] and mesh.vertices_near([[0, 0], [6, 6]]) == [0, 48]


def test_a_file_of_lines_says_how_they_are_meshed(tmp_path):
    path = tmp_path / "plan.obj"
    path.write_text("v 0 0 0\nv 6 0 0\nv 6 6 0\nl 1 2 3 1\n")
    with pytest.raises(ValueError, match=r"plan.obj holds lines but no faces; .*CGCMesh.from_outline\(points, edge_length\)"):
        read(path)


def test_loose_triangles_welded_are_solved():
    mesh = loose()
    mesh.weld()
    mesh.set_supports("boundary")
    mesh.set_target(0.01)
    assert solve(mesh).converged


@pytest.mark.parametrize(
    "words, said",
    [
        (["roof.3dm"], "roof.3dm is a file; put a command before it, such as compas-cgc check roof.3dm"),
        (["check", "nothing.3dm"], "there is no file nothing.3dm"),
        (["solve", "plan.obj", "-o", "out.obj", "--target", "0,1"], "--target must be a number"),
        (["solve", "plan.obj", "-o", "out.obj"], "no support"),
        (["solve", "plan.obj", "-o", "out.obj", "--supports", "boundary"], "no target curvature is set"),
        (["solve", "plan.obj", "-o", "out.obj", "--supports", "boundary", "--target", "5=0.1"], "there is no region 5"),
        (["solve", "plan.obj", "-o", "out.dwg", "--supports", "boundary", "--target", "0.01"], "use .3dm, .json"),
    ],
    ids=" ".join,
)
def test_a_mistake_in_a_terminal_gets_its_sentence(words, said, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    write("plan.obj", plan())
    assert main(words) == 2
    assert said in capsys.readouterr().err
    assert [path.name for path in tmp_path.iterdir()] == ["plan.obj"]


def test_a_mesh_says_what_it_is():
    mesh = compas_cgc.read(compas_cgc.get("nine_regions.3dm"))
    said = str(mesh)
    assert "256 vertices, 450 faces, 15 x 15 x 0" in said and "4 supports" in said and "region 4: 50 faces, K = 0.04" in said
