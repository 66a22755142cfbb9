"""What the components do, run as Grasshopper runs them, with stand-ins for Rhino."""

from __future__ import annotations

import numpy as np
import pytest

from compas_cgc import Above
from compas_cgc import Area
from compas_cgc import AutoSettings
from compas_cgc import Below
from compas_cgc import CGCMesh
from compas_cgc import Clearance
from compas_cgc import EdgeInPlan
from compas_cgc import FlowSettings
from compas_cgc import Height
from compas_cgc import Level
from compas_cgc import NewtonSettings
from compas_cgc import ProjectionSettings
from compas_cgc import Rise
from compas_cgc import Unknown
from compas_cgc import Volume
from compas_cgc.errors import ProblemError
from compas_cgc.grasshopper.components.info import InfoOutputs
from compas_cgc.grasshopper.runtime.component_feedback import as_list
from compas_cgc.grasshopper.runtime.component_feedback import reports_errors
from compas_cgc.grasshopper.runtime.component_feedback import unwrapped

from ...support.gh_stand_ins import BUNDLES
from ...support.gh_stand_ins import Component
from ...support.gh_stand_ins import Document
from ...support.gh_stand_ins import Plane
from ...support.gh_stand_ins import Point3d
from ...support.gh_stand_ins import PolylineCurve
from ...support.gh_stand_ins import SmoothCurve
from ...support.gh_stand_ins import place
from ...support.gh_stand_ins import rhino  # noqa: F401
from ...support.gh_stand_ins import rhino_mesh
from ...support.gh_stand_ins import square
from .test_components import ToySettings
from .test_components import toy  # noqa: F401

pytestmark = pytest.mark.usefixtures("rhino")


def line(*points):
    return PolylineCurve([Point3d(*map(float, point)) for point in points])


def nine_regions():
    """Return the CGC mesh of a square with creases at its thirds."""
    creases = [line((3, 0, 0), (3, 9, 0)), line((6, 0, 0), (6, 9, 0)), line((0, 3, 0), (9, 3, 0)), line((0, 6, 0), (9, 6, 0))]
    return place("Mesh").settle(mesh=square(), creases=creases, fix="corners")["cgc_mesh"]


# ----------------------------------------------------------------------
# Unconnected and wrong inputs
# ----------------------------------------------------------------------


@pytest.mark.parametrize("name", sorted(BUNDLES))
def test_a_component_fresh_from_the_ribbon_breaks_nothing(name):
    placed = place(name[4:])
    out = placed.run()
    assert set(out) == {parameter.name for parameter in BUNDLES[name].outputs}
    assert not placed.said("Error")
    if name[4:] not in ("Example", "Goals", "Info", "Install", "Server", "Settings"):
        assert placed.said("Warning")[0].startswith("connect")


@pytest.mark.parametrize(
    "name, inputs, sentence",
    [
        ("Mesh", {"mesh": "QUAD", "supports": [Point3d(0.3, 0.1, 0.0)]}, "support point 0 is up to 0.3162 m away from the nearest vertex"),
        ("Mesh", {"mesh": "QUAD", "creases": [line((5, 5, 0), (6, 6, 0))]}, "crease curve 0 does not lie on the mesh"),
        ("Mesh", {"mesh": "QUAD", "fix": "edges"}, "supports must be vertices, 'boundary', 'outline' or 'corners', not 'edges'"),
        ("Mesh", {"mesh": "EMPTY"}, "no face with three different corners"),
        ("Target", {"cgc_mesh": "NINE"}, "connect at least one curvature K"),
        ("Target", {"cgc_mesh": "NINE", "K": [1.0, 2.0]}, "there are 2 curvatures for 9 regions"),
        ("Target", {"cgc_mesh": "NINE", "K": [1.0], "region": [9]}, "there is no region 9"),
        ("Target", {"cgc_mesh": "NINE", "K": [1.0], "region": [0], "point": [Point3d(0, 0, 0)]}, "by number or by points, not both"),
        ("Target", {"cgc_mesh": "NINE", "K": [float("nan")]}, "must be a finite number"),
        ("Target", {"cgc_mesh": "NINE", "law": ["H of 2"]}, "'H of 2' is not a law; write minimal, H = 0.1"),
        ("Settings", {"s": 2.0}, "s must be between 0 and 1"),
        ("Settings", {"steps": 0}, "steps must be a whole number from 1 up"),
        ("Settings", {"method": "newton", "delay": 5}, "delay is a setting of flow, not of newton"),
        ("Settings", {"method": "magic"}, "method must be one of auto, flow, newton, projection, bending, not 'magic'"),
        (
            "Settings",
            {"delay": 5, "smoothness": 1.0},
            "the settings delay, smoothness do not belong to one method; name it, flow, newton, projection, bending",
        ),
        ("Constraints", {"cgc_mesh": "NINE", "height": 1.0}, "a height requires points"),
        ("Goals", {"rise": 0.0}, "rise must be a number other than 0"),
        ("Goals", {"clear": [line((0, 0, 0), (1, 0, 0), (1, 1, 0))], "clearance": [1.0]}, "a curve at the input clear is open"),
        ("Goals", {"clear": [line((0, 0, 0), (1, 0, 0))], "clearance": [1.0, 2.0]}, "there are 2 clearances for 1 curves"),
        ("Constraints", {"cgc_mesh": "NINE", "points": [Point3d(0.5, 0.5, 0.0)]}, "point 0 is 0.707 away"),
        ("Constraints", {"cgc_mesh": "NINE", "curve": line((0.5, 0, 1), (0.5, 9, 1))}, "no vertex lies on the curve"),
        ("Example", {"number": 9}, "number must be from 2 to 7, not 9"),
        ("Example", {"number": 4, "variant": "z"}, "has no variant 'z'"),
        ("Analyse", {"cgc_mesh": "NINE", "show": "k"}, "show must be one of K, H"),
        ("Mould", {"cgc_mesh": "NINE", "size": 1.0, "count": 4}, "exactly one of size, count, curves, and columns or rows"),
        ("Mould", {"cgc_mesh": "NINE", "material": "cheese"}, "there is no material 'cheese'; use one of glass"),
        ("Read3dm", {"path": "nowhere.3dm"}, "nowhere.3dm"),
        ("Write3dm", {"path": "a.xyz", "cgc_mesh": "NINE", "write": True}, ".xyz"),
    ],
)
def test_a_wrong_input_gets_a_red_balloon_with_a_sentence(name, inputs, sentence):
    made = {"QUAD": lambda: square(1, 1.0), "EMPTY": lambda: rhino_mesh([], []), "NINE": nine_regions}
    placed = place(name)
    out = placed.settle(**{key: made[value]() if isinstance(value, str) and value in made else value for key, value in inputs.items()})
    (said,) = placed.said("Error")
    assert sentence in said and "Traceback" not in said
    assert set(out.values()) == {None}


def test_every_problem_is_a_balloon_of_its_own():
    @reports_errors(InfoOutputs)
    def refuse(component):
        raise ProblemError(["one", "two"])

    component = Component(Document())
    assert refuse(component) == InfoOutputs(None)
    assert component.balloons == [("Error", "one"), ("Error", "two")]


def test_lists_and_wrapped_values():
    class GH_ObjectWrapper:
        Value = 5

    assert unwrapped(GH_ObjectWrapper()) == 5 and unwrapped(3) == 3
    assert as_list(None) == [] and as_list([1, None, GH_ObjectWrapper()]) == [1, 5]
    assert as_list("boundary") == ["boundary"] and as_list(2.0) == [2.0]


# ----------------------------------------------------------------------
# CGC Mesh and Target
# ----------------------------------------------------------------------


def test_a_mesh_alone_is_fixed_all_around():
    placed = place("Mesh")
    out = placed.settle(mesh=square())
    mesh = out["cgc_mesh"]
    assert isinstance(mesh.mesh, CGCMesh) and len(mesh.supports()) == 36 and out["problems"] == []
    assert mesh.number_of_faces() == 162 and placed.component.Message == "100 vertices, 1 regions"
    assert "split into triangles" in placed.said("Remark")[0]


def test_every_digit_of_the_mesh_is_kept():
    far = [(1e6 + 1 / 3, 2e6 + 1 / 7, 1 / 9), (1e6 + 4 / 3, 2e6 + 1 / 7, 1 / 9), (1e6 + 1 / 3, 2e6 + 8 / 7, 1 / 9)]
    mesh = place("Mesh").settle(mesh=rhino_mesh(far, [(0, 1, 2)]))["cgc_mesh"]
    assert mesh.arrays()[0].tolist() == [list(point) for point in far]


def test_supports_creases_and_flip():
    corners = [Point3d(x, y, 0.0) for x in (0.0, 9.0) for y in (0.0, 9.0)]
    half = SmoothCurve([Point3d(4.0, 9.0 * i / 100, 0.0) for i in range(101)])
    mesh = place("Mesh").settle(mesh=square(), supports=corners, creases=[half], flip=True)["cgc_mesh"]
    assert len(mesh.supports()) == 4 and len(mesh.regions()) == 2 and len(mesh.creases()) == 1
    assert mesh.face_normal(0)[2] == pytest.approx(-1)
    both = place("Mesh").settle(mesh=square(), supports=[Point3d(4.0, 4.0, 0.0)], fix="corners")["cgc_mesh"]
    assert len(both.supports()) == 5


def test_a_crease_beside_the_edges_is_laid_on_them_and_said():
    placed = place("Mesh")
    mesh = placed.settle(mesh=square(), creases=[line((4.2, 0, 0), (4.2, 9, 0))])["cgc_mesh"]
    assert len(mesh.regions()) == 2
    assert any("does not follow mesh edges" in text and "0.2" in text for text in placed.said("Remark"))


def test_targets_everywhere_by_number_and_by_point():
    mesh = nine_regions()
    target = place("Target")

    def targets(**inputs):
        found = target.run(cgc_mesh=mesh, **inputs)["cgc_mesh"]
        return [found.region_target(r) for r in range(9)]

    assert targets(K=[0.01]) == [0.01] * 9
    assert targets(K=[0.01 * (r + 1) for r in range(9)]) == [0.01 * (r + 1) for r in range(9)]
    middle = next(r for r in range(9) if targets(K=[1.0], point=[Point3d(4.5, 4.5, 0.3)])[r] is not None)
    assert targets(K=[0.04], region=[middle]) == [0.04 if r == middle else None for r in range(9)]
    assert targets(K=[0.02, 0.03], point=[Point3d(4.5, 4.5, 0.0), Point3d(0.1, 0.1, 0.0)])[middle] == 0.02
    assert mesh.vertices_target() == [None] * 100, "the mesh on the wire must not change"
    chained = target.run(cgc_mesh=target.run(cgc_mesh=mesh, K=[0.01])["cgc_mesh"], K=[0.04], region=[middle])["cgc_mesh"]
    assert [chained.region_target(r) for r in range(9)] == [0.04 if r == middle else 0.01 for r in range(9)]
    laws = target.run(cgc_mesh=mesh, K=[0.01], region=[0, 1, 2], law=[None, "minimal", "H = 0.1"])["cgc_mesh"]
    assert [str(laws.region_law(r)) for r in range(4)] == ["K = 0.01", "H = 0", "H = 0.1", "None"]


def test_radii_stand_for_curvatures():
    mesh, placed = nine_regions(), place("Target")
    radii = [10.0, -10.0, None, float("inf"), 5.0, 5.0, 5.0, 5.0, 5.0]
    out = placed.run(cgc_mesh=mesh, radius=radii)["cgc_mesh"]
    assert [out.region_target(r) for r in range(5)] == pytest.approx([0.01, -0.01, None, 0.0, 0.04])
    for inputs, sentence in (({"radius": [0.0]}, "other than 0"), ({"radius": [1.0], "K": [1.0]}, "either K or radius")):
        assert placed.run(cgc_mesh=mesh, **inputs)["cgc_mesh"] is None and sentence in placed.said("Error")[0]


# ----------------------------------------------------------------------
# The others
# ----------------------------------------------------------------------


def test_settings_keep_their_defaults():
    settings = place("Settings")
    assert settings.run()["settings"] is None and not settings.said("Error"), "Solve then chooses by the problem"
    assert settings.run(method="flow")["settings"] == FlowSettings() and settings.component.Message == "flow"
    assert settings.run(method="newton", steps=9)["settings"] == NewtonSettings(steps=9)
    assert settings.run(smoothness=0.3, tolerance=1e-9)["settings"] == ProjectionSettings(smoothness=0.3, tolerance=1e-9)
    assert settings.run(steps=9)["settings"] == AutoSettings(steps=9) and settings.component.Message == "auto", "it means the same in all"
    assert place("Settings").run(delay=5)["settings"].s == 1.0
    assert place("Settings").run(delay=5, s=0.5)["settings"].s == 0.5


def test_settings_take_any_method_that_is_registered(toy):  # noqa: F811
    assert place("Settings").run(method="toy", steps=3)["settings"] == ToySettings(steps=3)


def test_constraints_for_points_curves_planes_and_mirrors():
    mesh = nine_regions()
    upright = Plane(Point3d(4.5, 4.5, 0.0), Point3d(1.0, 0.0, 0.0))
    edge = Plane(Point3d(0.0, 0.0, 0.0), Point3d(1.0, 0.0, 0.0))
    placed = place("Constraints")
    inputs = dict(points=[Point3d(4.0, 4.0, 0.0)], height=2.0)
    (crown,) = placed.run(cgc_mesh=mesh, **inputs)["goals"]
    assert isinstance(crown, Height) and crown.height == 2.0
    assert [mesh.vertex_coordinates(v) for v in crown.vertices] == [[4.0, 4.0, 0.0]]
    rail, wall, mirror = placed.run(cgc_mesh=mesh, curve=line((0, 0, 0), (9, 0, 0)), plane=edge, mirror=upright)["goals"]
    assert len(rail.vertices) == len(wall.vertices) == 10 and rail.closed is False and wall.normal == [1.0, 0.0, 0.0]
    assert mirror.point == [4.5, 4.5, 0.0] and placed.component.Message == "3 constraints"
    loop = line((0, 0, 0), (9, 0, 0), (9, 9, 0), (0, 9, 0), (0, 0, 0))
    (around, kept) = placed.run(cgc_mesh=mesh, curve=loop, others=[crown])["goals"][::-1]
    assert kept is crown and around.closed and len(around.points) == 4 and len(around.vertices) == 36


def test_goals_and_what_is_to_be_found():
    placed = place("Goals")
    gate = line((1, 0, 0), (4, 0, 0), (4, 2, 0), (1, 2, 0), (1, 0, 0))
    made = placed.run(rise=2.0, clear=[gate], clearance=[1.0], keep_edges=True, unknown=[-1])["goals"]
    assert made == [Rise(2.0), Clearance([[1.0, 0.0], [4.0, 0.0], [4.0, 2.0], [1.0, 2.0]], 1.0), EdgeInPlan(), Unknown("all")]
    assert placed.component.Message == "4 goals"
    more = placed.run(height=3.0, volume=9.0, area=99.0, clearance=[0.5], below=4.0, level_edges=True, unknown=[0, 2], others=made[:1])
    assert more["goals"] == [Rise(2.0), Height("crown", 3.0), Volume(9.0), Area(99.0), Above(0.5), Below(4.0), Level(), Unknown([0, 2])]


def test_regions_are_what_target_counts():
    mesh = place("Target").run(cgc_mesh=nine_regions(), K=[float(r + 1) for r in range(9)])["cgc_mesh"]
    out = place("Regions").settle(cgc_mesh=mesh)
    assert [len(part.Faces) for part in out["regions"]] == [18] * 9 and out["targets"] == [float(r + 1) for r in range(9)]
    assert len(out["creases"]) == 12 and len(out["supports"]) == 4
    (edge,) = out["edges"]
    assert len(edge.points) == 37 and edge.points[0] == edge.points[-1]


def test_analyse_measures_a_sphere():
    n = 12
    u = np.linspace(-0.6, 0.6, n + 1)
    grid = [(x, y, np.sqrt(4 - x * x - y * y)) for x in u for y in u]
    m = n + 1
    cap = rhino_mesh(grid, [(i * m + j, (i + 1) * m + j, (i + 1) * m + j + 1, i * m + j + 1) for i in range(n) for j in range(n)])
    mesh = place("Target").run(cgc_mesh=place("Mesh").settle(mesh=cap)["cgc_mesh"], K=[0.25])["cgc_mesh"]
    out = place("Analyse").settle(cgc_mesh=mesh, show="error")
    inner = [k for k, K in enumerate(out["K"]) if K is not None]
    assert len(inner) == (n - 1) ** 2 and len(out["K"]) == len(out["H"]) == m * m
    for name, exact in (("K", 0.25), ("H", 0.5), ("k_max", 0.5), ("k_min", 0.5), ("error", 0.0)):
        assert np.array([out[name][k] for k in inner]) == pytest.approx(exact, abs=0.05), name
    assert len(out["mesh"].VertexColors) == m * m and out["mesh"].Normals.computed
    assert len(out["colours"]) == len(out["legend"]) == 7 and float(out["legend"][3]) == 0.0
    assert out["colours"][3] == (255, 255, 255) and out["colours"][0][2] > out["colours"][0][0], "blue is low"
    assert "max error" in out["report"]
    aside = place("Analyse").settle(cgc_mesh=mesh, aside=5.0)["mesh"]
    assert [p.X for p in aside.Vertices] == pytest.approx([p.X + 5 for p in out["mesh"].Vertices])


@pytest.mark.parametrize("number, variant, vertices", [(None, None, 324), (2, "nofilter", 100), (5, None, None), (7, "b", None)])
def test_examples_of_the_paper(number, variant, vertices):
    placed = place("Example")
    out = placed.run(number=number, variant=variant)
    assert out["title"].startswith(f"Example {number or 4}: ") and out["settings"].steps >= 200
    if vertices:
        assert out["cgc_mesh"].number_of_vertices() == vertices
    assert not any(problem.fatal for problem in out["cgc_mesh"].check())
    assert len(out["mesh"].Vertices) == len(out["cgc_mesh"].arrays()[0])


def test_panels_of_a_sphere_lie_on_it_and_need_no_bending():
    n = 12
    u = np.linspace(-0.6, 0.6, n + 1)
    m = n + 1
    grid = [(x, y, np.sqrt(4 - x * x - y * y)) for x in u for y in u]
    faces = [(i * m + j, (i + 1) * m + j, (i + 1) * m + j + 1, i * m + j + 1) for i in range(n) for j in range(n)]
    mesh = place("Mesh").settle(mesh=rhino_mesh(grid, faces))["cgc_mesh"]
    mesh = place("Target").run(cgc_mesh=mesh, K=[0.25])["cgc_mesh"]
    placed = place("Mould")
    out = placed.settle(cgc_mesh=mesh, size=0.4, aside=3.0)
    assert not placed.said("Error") and placed.component.Message == "9 panels, 1 mould"
    assert len(out["panels"]) == len(out["on_moulds"]) == len(out["names"]) == 9 and out["mould"] == [0] * 9
    assert max(out["misses"]) < 1e-9 and "sphere of K = 0.25" in out["report"]
    for panel, laid in zip(out["panels"], out["on_moulds"]):
        assert [tuple(face) for face in panel.Faces] == [tuple(face) for face in laid.Faces]
    low = min(p.X for p in out["moulds"][0].Vertices)
    assert low == pytest.approx(0.6 + 3.0, abs=0.01)
    assert placed.settle(cgc_mesh=mesh)["names"] == ["0-1"]


def test_panels_of_nearly_one_k_share_a_mould_within_a_tolerance():
    u = np.linspace(-0.6, 0.6, 9)
    cap = [(x, y, np.sqrt(4 - x * x - y * y)) for x in u for y in u]
    faces = [(9 * i + j, 9 * (i + 1) + j, 9 * (i + 1) + j + 1, 9 * i + j + 1) for i in range(8) for j in range(8)]
    mesh = place("Mesh").settle(mesh=rhino_mesh(cap, faces), creases=[line(*cap[36:45])])["cgc_mesh"]
    mesh = place("Target").run(cgc_mesh=mesh, K=[0.25, 0.251])["cgc_mesh"]
    placed = place("Mould")
    given = {"cgc_mesh": mesh, "count": 1, "rough": True}
    assert sorted(placed.settle(**given)["mould"]) == [0, 1]
    out = placed.settle(**given, tolerance=2.0)
    assert not placed.said("Error") and placed.component.Message == "2 panels, 1 mould" and out["mould"] == [0, 0]
    placed.settle(**given, tolerance=-1.0)
    assert "the tolerance must be at least 0 mm" in placed.said("Error")[0]


def test_files_there_and_back(tmp_path):
    mesh = place("Target").run(cgc_mesh=nine_regions(), K=[1 / 30])["cgc_mesh"]
    path = str(tmp_path / "nine.3dm")
    write = place("Write3dm")
    assert write.run(path=path, cgc_mesh=mesh)["written"] is None and write.component.Message == "set write to true"
    assert write.run(path=path, cgc_mesh=mesh, write=True)["written"].AllData() == [path]
    read = place("Read3dm")
    out = read.run(path=path)
    back = out["cgc_mesh"]
    assert back.arrays()[0].tolist() == mesh.arrays()[0].tolist() and back.region_target(4) == 1 / 30
    assert len(back.regions()) == 9 and len(back.supports()) == 4 and out["notes"] == read.said("Remark")
    assert len(out["mesh"].Vertices) == 100


def test_info_names_what_runs_here():
    placed = place("Info")
    assert placed.run()["info"][0].startswith("compas_cgc ") and placed.component.Message.startswith("v")
