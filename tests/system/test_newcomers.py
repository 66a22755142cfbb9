"""Mistakes of a first hour, in Python and in a terminal: each gets the sentence that says what to write instead."""

from __future__ import annotations

import numpy as np
import pytest
from compas.datastructures import Mesh
from compas.geometry import Point
from compas.geometry import Polyline

import compas_cgc
from compas_cgc import AtHeight
from compas_cgc import CGCMesh
from compas_cgc import CGCProblem
from compas_cgc import Clearance
from compas_cgc import FlowSettings
from compas_cgc import Rise
from compas_cgc import check
from compas_cgc import read
from compas_cgc import solve
from compas_cgc import write
from compas_cgc.cli import main

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
    "a mask for supports": (lambda: plan().set_supports(plan().arrays()[0][:, 0] == 0.0), r"not a mask; np.flatnonzero\(mask\)"),
    "a word for supports": (lambda: plan().set_supports("edge"), "supports must be vertices, 'boundary' or 'corners', not 'edge'"),
    "a word in a list": (lambda: plan().set_supports(["corners"]), "write 'corners' without the brackets"),
    "a support that is not there": (lambda: plan().set_supports([999]), "there is no vertex 999"),
    "the boundary of a closed solid": (lambda: ball().set_supports("boundary"), "is closed, it has no boundary; name vertices"),
    "a closed solid that nothing holds": (lambda: solve(ball()), r"the mesh is closed and has no edge.*set_supports\(\[...\]\)"),
    "a flat list for a crease": (lambda: plan().set_creases([0, 1, 2]), r"write \[\[0, 1, 2\]\]"),
    "a crease as coordinates": (lambda: plan().set_creases([SQUARE]), "of a crease must be keys of vertices, not coordinates"),
    "a crease as a polyline": (lambda: plan().set_creases([Polyline(SQUARE)]), "of a crease must be keys of vertices, not coordinates"),
    "a number for creases": (lambda: plan().set_creases(3), r"such as \[\[0, 1, 2\]\], not 3"),
    "a crease of one vertex": (lambda: plan().set_creases([[3]]), "two vertices or more"),
    "a crease across the faces": (lambda: plan().set_creases([[0, 20]]), "from vertex 0 to 20 does not follow an edge"),
    "a region beyond a crease that parts nothing": (
        lambda: creased(INSIDE).set_target(0.02, region=1),
        "there is no region 1; the mesh has 1.*from edge to edge, or to close",
    ),
    "a region by its name": (lambda: posed().set_target(0.1, region="middle"), "a region is a number from 0 to 0, not 'middle'"),
    "targets in a list": (lambda: posed().set_target([0.1, 0.2]), r"one number, .*set_target\(K, region=r\)"),
    "targets by region": (lambda: posed().set_target({0: 0.1}), r"one number, .*set_target\(K, region=r\)"),
    "a word for K": (lambda: posed().set_target("steep"), "the target must be a number, not 'steep'"),
    "no number for K": (lambda: posed().set_target(float("nan")), "the target must be a finite number"),
    "a radius for K": (lambda: solve(only(supports="boundary", K=14.0)), "the target 14 is more than this boundary can carry"),
    "metres in millimetres": (lambda: solve(millimetres()), "0.01 1/m² is 1e-08 1/mm²: are the units those of the model"),
    "nothing said at all": (lambda: solve(plan()), "no support.*no target is set"),
    "no supports": (lambda: solve(only(K=0.01)), r"the mesh has no support, .*set_supports\('boundary'\)"),
    "no target": (lambda: solve(only(supports="boundary")), r"no target is set; .*mesh.set_target\(K\)"),
    "everything held": (lambda: solve(only(supports=range(49), K=0.01)), "no internal vertex.*free some supports"),
    "a COMPAS mesh": (lambda: solve(Mesh.from_meshgrid(5.0, 5)), r"CGCMesh.from_mesh\(mesh\)"),
    "a file": (lambda: solve("roof.3dm"), r"a file is read first: compas_cgc.read\('roof.3dm'\)"),
    "vertices and faces": (lambda: solve(arrays()), r"CGCProblem\(vertices, faces\)"),
    "nothing": (lambda: solve(None), "a CGCMesh or a CGCProblem is solved, not None"),
    "a method misspelt": (lambda: solve(posed(), method="newtn"), "must be one of auto, flow, newton, projection, not 'newtn'"),
    "a setting misspelt": (lambda: solve(posed(), settings={"tolerence": 1e-3}), "'tolerence'; did you mean 'tolerance'?"),
    "a word for steps": (lambda: solve(posed(), settings={"steps": "many"}), "steps must be a whole number"),
    "settings of another method": (
        lambda: solve(posed(), method="newton", settings=FlowSettings()),
        "takes NewtonSettings, not FlowSettings",
    ),
    "an option of another method": (lambda: solve(posed(), method="newton", settings={"s": 0.5}), "s is a setting of flow, not of newton"),
    "a height at coordinates": (lambda: solve(posed(), constraints=[AtHeight([[3.0, 3.0, 0.0]], 1.0)]), "not coordinates such as"),
    "a height before its vertices": (lambda: AtHeight(1.0, [24]), r"height must be a number, not \[24\]"),
    "a height for a support": (lambda: solve(posed(), constraints=[AtHeight([0], 1.0)]), "vertex 0 is fixed away from where.*free it"),
    "a height nowhere": (lambda: solve(posed(), constraints=[AtHeight([999], 1.0)]), "names vertex 999; the mesh has the vertices 0 to 48"),
    "a rise with its unit": (lambda: Rise("4 m"), "rise must be a number, not '4 m'"),
    "no rise": (lambda: Rise(0.0), "rise must be a number other than 0"),
    "a clearance the wrong way round": (lambda: Clearance(2.5, (1, 1, 2, 2)), "height must be a number"),
    "a goal by its name": (lambda: solve(posed(), goals=["rise"]), r"write a value such as Rise\(4.0\)"),
    "unknown switched on": (lambda: solve(posed(), goals=[Rise(0.5)], unknown=True), "must be numbers of regions, or 'all'"),
    "faces half turned": (lambda: solve(half_flipped()), r"and 5 more run against their neighbours; unify them \(mesh.unify\(\)"),
    "faces from one": (
        lambda: CGCMesh.from_vertices_and_faces(arrays()[0].tolist(), (arrays()[1] + 1).tolist()),
        "count vertices from 1, and here it is from 0: subtract 1",
    ),
    "vertices in plan": (lambda: CGCMesh.from_vertices_and_faces(arrays()[0][:, :2].tolist(), arrays()[1].tolist()), "add z, 0 for a plan"),
    "arrays in plan": (lambda: CGCProblem(arrays()[0][:, :2], arrays()[1]), r"must have the shape \(n, 3\), not \(49, 2\)"),
    "quads as arrays": (lambda: CGCProblem(SQUARE[:4], [[0, 1, 2, 3]]), "triangulate quads and n-gons first"),
    "arrays swapped": (lambda: CGCProblem(arrays()[1], arrays()[0]), "faces must hold integers"),
    "half a square": (lambda: CGCMesh.from_meshgrid(dx=15, nx=15.5), "nx is the number of squares"),
    "no squares": (lambda: CGCMesh.from_meshgrid(dx=15, nx=0), "nx is the number of squares"),
    "one hole without a list": (
        lambda: CGCMesh.from_outline(SQUARE, 1.0, holes=[[2, 2, 0], [3, 2, 0], [3, 3, 0], [2, 2, 0]]),
        r"holes=\[curve\]",
    ),
    "an outline that crosses itself": (lambda: CGCMesh.from_outline([SQUARE[k] for k in (0, 2, 1, 3, 0)], 1.0), "a curve crosses itself"),
    "a length below zero": (lambda: CGCMesh.from_outline(SQUARE, -1.0), "the edge length must be above zero"),
    "a file that is not there": (lambda: read("nothing.3dm"), "there is no file nothing.3dm"),
    "a folder": (lambda: read("."), "is a folder; name a file in it"),
    "a kind of file that is not known": (lambda: write("roof.dwg", posed()), r"use .3dm, .json"),
    "write the wrong way round": (lambda: write(posed(), "roof.3dm"), r"write\('roof.3dm', mesh\)"),
    "a strategy without creases": (lambda: posed().set_strategy(s=0.5), "no crease to set a strategy along; set creases first"),
    "a sample that is not there": (lambda: compas_cgc.get("roof"), "there is no sample 'roof'; there are"),
}


@pytest.mark.parametrize("mistake", MISTAKES)
def test_a_mistake_gets_its_sentence(mistake, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    made, words = MISTAKES[mistake]
    with pytest.raises(ValueError, match=words):
        made()
    assert not list(tmp_path.iterdir())


# What is no mistake in the end, and what is said all the same.
REMARKS = {
    "upside down": (lambda: (lambda mesh: mesh.flip() or mesh)(posed()), "the normals point down, so the surface hangs"),
    "a crease that ends inside": (lambda: creased(INSIDE), "a crease ends at vertices 22, 24, inside of a region"),
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
    mesh = plan()
    mesh.set_supports([0.0, 6.0])
    assert mesh.supports() == [0, 6] and mesh.vertices_near([[0, 0], [6, 6]]) == [0, 48]


@pytest.mark.parametrize(
    "words, said",
    [
        (["roof.3dm"], "roof.3dm is a file; say what to do with it: compas-cgc check roof.3dm"),
        (["check", "nothing.3dm"], "there is no file nothing.3dm"),
        (["solve", "plan.obj", "-o", "out.obj", "--target", "0,1"], "--target must be a number"),
        (["solve", "plan.obj", "-o", "out.obj"], "no support"),
        (["solve", "plan.obj", "-o", "out.obj", "--supports", "boundary"], "no target is set"),
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
