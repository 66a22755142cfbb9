"""Plane quads: layout, planarity, faces and beams, files."""

import json
import xml.etree.ElementTree as ElementTree
from dataclasses import replace

import numpy as np
import pytest
import shapely
from scipy.spatial import cKDTree

import compas_cgc
from compas_cgc import CGCMesh
from compas_cgc import solve
from compas_cgc.cli.main import main
from compas_cgc.errors import CGCError
from compas_cgc.fabrication import plane_quads
from compas_cgc.fabrication.drawing import text_box
from compas_cgc.fabrication.outlines import signed_area
from compas_cgc.fabrication.quad_drawing import flat_beam
from compas_cgc.fabrication.quad_drawing import labels_in_plan
from compas_cgc.fabrication.quad_tables import beam_text
from compas_cgc.fabrication.quads.cross_field import cross_field
from compas_cgc.fabrication.quads.extraction import Polygons
from compas_cgc.fabrication.quads.merging import merged
from compas_cgc.fabrication.quads.planarity import _diagonals
from compas_cgc.fabrication.quads.planarity import gaps
from compas_cgc.fabrication.quads.planarity import planarised
from compas_cgc.io import write
from compas_cgc.model.problem import CGCProblem
from tests.support.constant_curvature import revolved_patch
from tests.support.exact_surfaces import SURFACES
from tests.support.shapes import grid
from tests.support.tables import rows_and_notes


def _oval():
    mesh = CGCMesh.from_meshgrid(dx=2.0, nx=24)
    vertices, faces = mesh.to_vertices_and_faces()
    x, y = (np.array(vertices)[:, :2] - 1.0).T
    plan = np.column_stack([9.0 * x * np.sqrt(1.0 - y**2 / 2.0), 6.0 * y * np.sqrt(1.0 - x**2 / 2.0), 0.0 * x])
    oval = CGCMesh.from_vertices_and_faces(plan.tolist(), faces)
    oval.set_supports("boundary")
    oval.set_target(0.008)
    return solve(oval)


def _on_corners():
    mesh = CGCMesh.from_meshgrid(dx=15.0, nx=24)
    mesh.set_supports("corners")
    mesh.set_target(0.01)
    return solve(mesh)


DOMES = {
    "cushion": (lambda: solve(compas_cgc.read(compas_cgc.get("cushion.3dm"))), 0.6),
    "oval": (_oval, 1.2),
    "corners": (_on_corners, 1.2),
}


@pytest.fixture(scope="module", params=["cushion", pytest.param("oval", marks=pytest.mark.nightly), "corners"])
def quads(request):
    make, spacing = DOMES[request.param]
    return plane_quads(make(), spacing)


def _ends_inside(quads):
    """Count inner nodes from which fewer than three sides leave, or at which a line meets another from one side only."""
    neighbours = {}
    for face in quads.faces:
        for a, b in zip(face, face[1:] + face[:1]):
            neighbours.setdefault(a, set()).add(b)
            neighbours.setdefault(b, set()).add(a)
    ends = 0
    for node in np.flatnonzero(~quads.rim).tolist():
        ways = np.array([quads.vertices[other] - quads.vertices[node] for other in neighbours[node]])
        ways /= np.linalg.norm(ways, axis=1, keepdims=True)
        ends += len(ways) < 3 or (len(ways) == 3 and (ways @ ways.T).min() < np.cos(np.radians(150.0)))
    return ends


def test_domes_are_covered_by_plane_quads_without_dead_ends(quads):
    for face in quads.faces:
        points = quads.vertices[face] - quads.vertices[face].mean(axis=0)
        normal = np.linalg.svd(points)[2][2]
        assert np.abs(points @ normal).max() < 0.5e-3  # a plane within half a millimetre: diagonals within one
    assert quads.planarity.max() < 1e-3
    assert _ends_inside(quads) == quads.dead_ends == 0
    inner = [face for face in quads.faces if not quads.rim[face].any()]
    assert len(inner) > 10 and all(len(face) == 4 for face in inner)
    uses = {}
    for face in quads.faces:
        for a, b in zip(face, face[1:] + face[:1]):
            uses[a, b] = uses.get((a, b), 0) + 1
    assert set(uses.values()) == {1}  # faces have one orientation, and no side belongs to three
    assert all(quads.rim[a] and quads.rim[b] for a, b in uses if (b, a) not in uses)  # no holes


def test_faces_cover_the_surface_and_lie_on_it(quads):
    problem = quads.problem
    size = np.linalg.norm(np.ptp(problem.vertices, axis=0))
    a, b, c = problem.vertices[problem.faces].transpose(1, 0, 2)
    whole = np.linalg.norm(np.cross(b - a, c - a), axis=1).sum()
    own = sum(np.linalg.norm(np.cross(quads.vertices[face], np.roll(quads.vertices[face], -1, axis=0)).sum(axis=0)) for face in quads.faces)
    assert own == pytest.approx(whole, rel=0.02)
    assert np.median(quads.off) < 1e-3 * size and quads.off.max() < 0.01 * size
    assert np.median(quads.twist) < 0.01 * quads.depth and quads.twist.max() < 0.05 * quads.depth
    assert quads.offset_error.max() < 0.005 * quads.depth


@pytest.mark.parametrize("quads", ["cushion"], indirect=True)
def test_a_cushion_has_four_nodes_of_five_sides(quads):
    assert len(quads.irregular) == 4
    assert (np.bincount(quads.edges.ravel())[quads.irregular] == 5).all()


@pytest.mark.parametrize(
    ("name", "irregular"),
    [
        ("cylinder", True),
        ("catenoid", False),
        pytest.param("unduloid", False, marks=pytest.mark.nightly),
        pytest.param("Enneper", True, marks=pytest.mark.nightly),
    ],
)
def test_on_surfaces_of_constant_mean_curvature_quads_are_plane_squares(name, irregular):
    surface = SURFACES[name]()
    V, F, _ = surface.patch(24, irregular)
    result = solve(CGCProblem(V, F).with_supports("boundary").with_laws({0: surface.law}))
    size = np.linalg.norm(np.ptp(V, axis=0))
    quads = plane_quads(result, size / 18)
    widths = quads.aspects[np.isfinite(quads.aspects)] - 1.0
    assert len(widths) > 80 and np.median(widths) < 0.01 and widths.max() < 0.03
    inner = [quads.vertices[face] for face, aspect in zip(quads.faces, quads.aspects) if np.isfinite(aspect)]
    diagonals = np.array([(face[2] - face[0], face[3] - face[1]) for face in inner])
    diagonals /= np.linalg.norm(diagonals, axis=2, keepdims=True)
    assert np.abs(np.einsum("fi,fi->f", *diagonals.transpose(1, 0, 2))).max() < 0.04  # and the widths enclose right angles
    assert quads.planarity.max() < 1e-8 * size and quads.off.max() < 2e-3 * size
    assert quads.dead_ends == 0 and not len(quads.irregular)
    # Squares cover as much area as said by the spacing.
    areas = [np.linalg.norm(np.cross(face[2] - face[0], face[3] - face[1])) / 2 for face in inner]
    assert np.sqrt(np.mean(areas)) == pytest.approx(size / 18, rel=0.15)
    assert "squares inside regions of constant H" in str(quads)


@pytest.mark.nightly
def test_squares_of_a_cushion_close_around_its_umbilic_points():
    mesh = CGCMesh.from_meshgrid(dx=15.0, nx=24, dy=10.0, ny=16)
    mesh.set_supports("boundary")
    mesh.set_law("H = 0.06")
    quads = plane_quads(solve(mesh), 0.75)
    assert quads.dead_ends == 0 and quads.planarity.max() < 1e-6 and len(quads.irregular) == 4
    widths = quads.aspects[np.isfinite(quads.aspects)] - 1.0
    # Lines between the umbilic points close only where their number is whole, which costs some of the proportions.
    assert np.median(widths) < 0.1 and np.quantile(widths, 0.9) < 0.3


def test_a_plane_has_no_squares_of_its_own():
    mesh = CGCMesh.from_meshgrid(dx=15.0, nx=8)
    mesh.set_supports("boundary")
    mesh.set_law("minimal")
    with pytest.raises(CGCError, match="is a plane or a sphere, whose lines of curvature are undetermined"):
        plane_quads(solve(mesh))


def test_only_regions_with_positive_K_get_quads():
    saddle = solve(compas_cgc.read(compas_cgc.get("canopy.3dm")))
    with pytest.raises(CGCError, match="plane quads need a region with K > 0"):
        plane_quads(saddle)
    with pytest.raises(CGCError, match="the depth must be larger than 0"):
        plane_quads(saddle, depth=-1.0)


def test_the_indices_of_a_field_around_an_umbilic_add_up_to_a_turn():
    """Principal directions around an isolated umbilic of index 1: four quarters in total, in simple singularities."""
    vertices, faces = grid(21, 2.0)
    vertices = np.column_stack([vertices[:, :2] - vertices[:, :2].mean(axis=0), np.zeros(len(vertices))])
    x, y = vertices[:, :2].T
    operators = np.zeros((len(vertices), 3, 3))
    operators[:, 0, 0], operators[:, 1, 1] = 1.0 + x**2 - y**2, 1.0 - x**2 + y**2
    operators[:, 0, 1] = operators[:, 1, 0] = 2.0 * x * y
    index = cross_field(vertices, faces, operators, 1.0, 0.1, 1e-3).indices
    assert index.sum() == 4 and index.max() == 1 and index.min() == 0


def test_merging_sides_at_the_rim_leaves_no_line_that_ends_inside():
    """The corner at (1, 1) would lose a side if the short one at the rim vanished together with its triangle."""
    points = np.array([[0, 0, 0], [0.95, 0, 0], [1.05, 0, 0], [2, 0, 0], [0, 1, 0], [1, 1, 0], [2, 1, 0], [0, 2, 0], [1, 2, 0], [2, 2, 0]])
    faces = [[0, 1, 5, 4], [1, 2, 5], [2, 3, 6, 5], [4, 5, 8, 7], [5, 6, 9, 8]]
    rim = np.ones(10, bool)
    rim[5] = False
    kinks = np.zeros(10, bool)
    same = merged(Polygons(points.astype(float), faces, rim, kinks), 0.3)
    assert same.faces == faces
    rim[5] = True  # on the rim itself, nothing ends
    assert len(merged(Polygons(points.astype(float), faces, rim, kinks), 0.3).faces) == 4


def test_a_crossing_close_to_the_rim_comes_to_lie_on_it():
    """Two lines cross at (1, 0.05) and end at the rim y = 0; the triangle between them would have sides of 71 and 100 mm."""
    points = np.array([[0, 0, 0], [0.95, 0, 0], [1.05, 0, 0], [2, 0, 0], [1, 0.05, 0], [0, 1, 0], [0.4, 1, 0], [1.6, 1, 0], [2, 1, 0]])
    faces = [[1, 2, 4], [0, 1, 4, 6, 5], [2, 3, 8, 7, 4], [4, 7, 6]]
    rim = np.ones(9, bool)
    rim[4] = False
    own = merged(Polygons(points.astype(float), faces, rim, np.zeros(9, bool)), 0.3)
    assert own.rim.all() and [1.0, 0.0, 0.0] in own.vertices.tolist()
    assert [own.vertices[face, 0].tolist() for face in own.faces] == [[0.0, 1.0, 0.4, 0.0], [2.0, 2.0, 1.6, 1.0], [1.0, 1.6, 0.4]]
    # A crossing further away stays, and a kink of the rim does so where the triangle vanishes.
    assert not merged(Polygons(points * [1, 10, 1], faces, rim, np.zeros(9, bool)), 0.3).rim.all()
    kinks = np.arange(9) == 2
    assert [1.05, 0.0, 0.0] in merged(Polygons(points.astype(float), faces, rim, kinks), 0.3).vertices.tolist()


def test_the_slopes_of_the_distance_between_diagonals_are_exact():
    rng = np.random.default_rng(0)
    points, moves = rng.normal(size=(2, 6, 3))
    corners = np.array([[0, 1, 2, 3], [2, 3, 4, 5]])
    gap, slopes = _diagonals(points, corners)
    step = 1e-6
    ahead, back = (_diagonals(points + sign * step * moves, corners)[0] for sign in (1.0, -1.0))
    assert slopes @ moves.ravel() == pytest.approx((ahead - back) / (2.0 * step), rel=1e-6)
    assert gap == pytest.approx(
        [np.linalg.det([b - a, c - a, d - a]) / np.linalg.norm(np.cross(c - a, d - b)) for a, b, c, d in points[corners]]
    )


def test_a_face_with_corners_in_line_is_plane_only_if_its_other_corners_are():
    """Corners 1, 2 and 3 lie in line, so that the corners beside them were not held in one plane."""
    corners = np.array([[0, 0, 0.05], [1, 0, 0], [1, 0.4, 0], [1, 1, 0], [0, 1, 0]], float)
    assert gaps(corners, [[0, 1, 2, 3, 4]])[0] > 0.02
    assert gaps(corners * [1, 1, 0], [[0, 1, 2, 3, 4]])[0] == 0.0
    plane = np.array([[-1.0, -1.0, 0.0], [2.0, -1.0, 0.0], [2.0, 2.0, 0.0], [-1.0, 2.0, 0.0]])
    own = Polygons(corners, [[0, 1, 2, 3, 4]], np.zeros(5, bool), np.zeros(5, bool))
    made = planarised(own, plane, np.array([[0, 1, 2], [0, 2, 3]]), [np.arange(4)])
    assert np.linalg.svd(made - made.mean(axis=0))[1][2] < 1e-6


def test_short_beams_are_named_in_the_report_and_in_the_tables():
    quads = plane_quads(CGCProblem(*revolved_patch(12, 0.02)).with_targets(0.02), 1.0)
    ends = quads.vertices[quads.edges]
    lengths = np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1)
    # In a model of this scale some beams, but not all, are shorter than 100 mm.
    small = replace(quads, vertices=quads.vertices * 0.1 / np.median(lengths))
    named = small.short_beams()
    assert {word.split(" ")[0] for word in named.split(": ")[1].split(", ")} == {
        f"B{k}" for k in np.flatnonzero(lengths < np.median(lengths))
    }
    assert named in small.summary() and named in beam_text(small).replace('""', '"')
    assert replace(quads, vertices=10.0 * quads.vertices).short_beams() == ""


def test_numbers_of_beams_and_nodes_in_place_lie_inside_faces_and_beside_lines():
    """Two regions meet at the diagonal of a plan, where each has beams and nodes of its own."""
    roof = CGCMesh.from_meshgrid(dx=10.0, nx=16)
    roof.set_supports("corners")
    roof.set_creases([[17 * k + k for k in range(17)]])
    roof.set_target(0.01)
    quads = plane_quads(solve(roof).problem, 1.5)
    assert len(set(quads.region)) == 2
    places = 1e3 * quads.vertices[:, :2]
    beams, nodes = labels_in_plan(quads, places, 90.0)
    assert [label.text for label in beams] == [f"B{k}" for k in range(len(quads.edges))]
    assert [label.text for label in nodes] == [str(k) for k in range(len(places))]
    outlines = [shapely.Polygon(places[face]) for face in quads.faces]
    for label in [*beams, *nodes]:
        box = shapely.box(*text_box(label.text, label.place, label.height).ravel())
        assert sum(outline.contains(box) for outline in outlines) == 1, label
    for label, ends in zip(beams, quads.edges):
        assert shapely.LineString(places[ends]).distance(shapely.Point(label.place)) < 3.0 * label.height + 1.0


def test_a_beam_laid_flat_keeps_its_sides_and_the_diagonal_along_which_it_is_unfolded():
    quads = plane_quads(CGCProblem(*revolved_patch(12, 0.02)).with_targets(0.02), 1.0)
    for beam, ends in enumerate(quads.edges):
        near = quads.vertices[ends]
        solid = 1e3 * np.vstack([near, (near + quads.depth * quads.axes[ends])[::-1]])
        flat = flat_beam(quads, beam)
        pairs = np.array([(0, 1), (1, 2), (2, 3), (3, 0), (0, 2)])
        assert np.linalg.norm(np.diff(flat[pairs], axis=1), axis=2) == pytest.approx(np.linalg.norm(np.diff(solid[pairs], axis=1), axis=2))
        assert signed_area(flat) > 0.0 and flat.min(axis=0) == pytest.approx([0.0, 0.0], abs=1e-9)


def test_the_command_writes_faces_and_beams(tmp_path):
    write(tmp_path / "solved.3dm", solve(compas_cgc.read(compas_cgc.get("cushion.3dm"))))
    names = ["q.3dm", "q.dxf", "q.flat.dxf", "q.flat.svg", "q.json", "q.csv", "q.beams.csv"]
    outputs = [word for name in names for word in ("-o", str(tmp_path / name))]
    assert main(["quads", str(tmp_path / "solved.3dm"), "--spacing", "0.8", "--depth", "0.1", "-q", *outputs]) == 0
    data = json.loads((tmp_path / "q.json").read_text())
    with open(tmp_path / "q.csv") as file:
        faces = rows_and_notes(file)[0]
    with open(tmp_path / "q.beams.csv") as file:
        beams = rows_and_notes(file)[0]
    assert len(faces) == len(data["faces"]) and len(beams) == len(data["beams"])
    vertices = 1e3 * np.array(data["vertices"])
    for row, face in zip(faces, data["faces"]):
        sides = np.linalg.norm(vertices[np.roll(face, -1)] - vertices[face], axis=1)
        assert [float(value) for value in row["sides in mm"].split()] == pytest.approx(sides, abs=0.06)
    lengths = {tuple(sorted((int(row["from node"]), int(row["to node"])))): float(row["length in mm"]) for row in beams}
    assert all(tuple(sorted(pair)) in lengths for face in data["faces"] for pair in zip(face, face[1:] + face[:1]))
    import rhino3dm
    from ezdxf import filemanagement

    for row in beams:
        ends = np.array([[float(row[f"{end} {axis} in mm"]) for axis in "xyz"] for end in ("from", "to")])
        assert ends == pytest.approx(vertices[[int(row["from node"]), int(row["to node"])]], abs=0.06)
    normals = {}
    for face in data["faces"]:
        normal = np.cross(vertices[face], np.roll(vertices[face], -1, axis=0)).sum(axis=0)
        normals.update({side: normal / np.linalg.norm(normal) for side in zip(face, face[1:] + face[:1])})
    signed = []
    for row in beams:
        a, b = int(row["from node"]), int(row["to node"])
        # The far corners of a beam lie at its depth from the faces beside it.
        far = np.array([[float(row[f"far {end} {axis} in mm"]) for axis in "xyz"] for end in ("from", "to")])
        for normal in (normals[side] for side in ((a, b), (b, a)) if side in normals):
            assert abs((far - vertices[[a, b]]) @ normal) == pytest.approx(100.0, abs=1.0)
        assert (row["angle between faces in degrees"] == "") == ((a, b) not in normals or (b, a) not in normals)
        if row["angle between faces in degrees"]:
            signed.append(float(row["angle between faces in degrees"]))
            assert abs(signed[-1]) == pytest.approx(np.degrees(np.arccos(np.clip(normals[a, b] @ normals[b, a], -1.0, 1.0))), abs=0.02)
    assert min(angle for angle in signed if abs(angle) > 1.0) > 0.0  # a dome is convex
    document = filemanagement.readfile(tmp_path / "q.dxf")
    layers = [each.dxf.layer for each in document.modelspace()]
    assert layers.count("FACES") == layers.count("FACE_NUMBERS") == len(faces)
    assert layers.count("BEAMS") == layers.count("BEAM_NUMBERS") == len(beams)
    assert document.header["$INSUNITS"] == 4 and np.allclose(document.header["$EXTMAX"], vertices.max(axis=0))
    flat = filemanagement.readfile(tmp_path / "q.flat.dxf")
    assert not flat.audit().errors and flat.header["$INSUNITS"] == 4
    outlines = [np.array([point[:2] for point in line.get_points()]) for line in flat.modelspace().query('LWPOLYLINE[layer=="CUT"]')]
    names = {text.dxf.text: text for text in flat.modelspace().query('TEXT[layer=="LABEL"]')}
    assert set(names) == {*(row["face"] for row in faces), *(row["beam"] for row in beams)} and len(outlines) == len(names)
    lines = ElementTree.parse(tmp_path / "q.flat.svg").getroot().findall(".//{http://www.w3.org/2000/svg}g[@id='CUT']/*")
    assert len(lines) == len(outlines)
    for row, points in zip(faces, outlines):
        sides = np.linalg.norm(np.roll(points, -1, axis=0) - points, axis=1)
        assert sides == pytest.approx([float(value) for value in row["sides in mm"].split()], abs=0.06)
        assert signed_area(points) == pytest.approx(1e6 * float(row["area in m2"]), rel=1e-3)  # also: seen from outside
    for row, points in zip(beams, outlines[len(faces) :]):
        assert np.linalg.norm(points[1] - points[0]) == pytest.approx(float(row["length in mm"]), abs=0.06)
    legend = {text.dxf.text.split(":")[0] for text in flat.modelspace().query('TEXT[layer=="LEGEND"]')}
    assert {each.dxf.layer for each in flat.modelspace()} - {"LEGEND"} <= legend
    model = rhino3dm.File3dm.Read(str(tmp_path / "q.3dm"))
    drawn = [model.Layers[own.Attributes.LayerIndex].FullPath for own in model.Objects]
    assert drawn.count("CGC Quads::Beams") == len(beams)
    assert drawn.count("CGC Quads::Outlines") == drawn.count("CGC Quads::Numbers") == len(faces)


@pytest.mark.parametrize("spacing", [pytest.param(0.8, marks=pytest.mark.nightly), 1.1])
def test_quads_of_a_fourfold_roof_are_fourfold(spacing):
    """Diagonals of the mesh run one way; without the means over images, corners differed by 41 to 85 mm."""
    vertices, faces = grid(20, 10.0)
    quads = plane_quads(solve(CGCProblem(vertices, faces).with_supports("corners").with_targets(0.01)), spacing)
    tree = cKDTree(quads.vertices)
    x, y, z = (quads.vertices - [5.0, 5.0, 0.0]).T
    for image in ((-x, y), (y, x), (-y, x)):
        distance, to = tree.query(np.column_stack([*image, z]) + [5.0, 5.0, 0.0])
        assert distance.max() < 5e-3 and len(np.unique(to)) == len(to)
    assert quads.planarity.max() < 1e-5 and quads.dead_ends == 0


@pytest.mark.parametrize(
    ("width", "K", "spacing"),
    [
        (8.0, 0.02, 1.0),
        pytest.param(8.0, 0.02, 1.2, marks=pytest.mark.nightly),
        pytest.param(12.0, 0.015, 0.6, marks=pytest.mark.nightly),
        pytest.param(12.0, 0.02, 1.0, marks=pytest.mark.nightly),
    ],
)
def test_no_line_ends_beside_corners_of_a_held_square(width, K, spacing):
    """Curvature varies most there, so that directions averaged over a part of the spacing have further singularities."""
    mesh = CGCMesh.from_meshgrid(dx=width, nx=24)
    mesh.set_supports("boundary")
    mesh.set_target(K)
    quads = plane_quads(solve(mesh), spacing)
    assert quads.dead_ends == 0 and quads.planarity.max() < 1e-3
