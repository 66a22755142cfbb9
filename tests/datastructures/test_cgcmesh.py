"""CGCMesh: roles, creases, regions, targets, and what it keeps through copies and files."""

from __future__ import annotations

import pickle

import compas
import numpy as np
import pytest
from compas.datastructures import Mesh
from compas.geometry import Box
from hypothesis import given
from hypothesis import strategies as st

from compas_cgc import CGCMesh
from compas_cgc import CGCProblem
from compas_cgc.model.dummy_ring import with_dummy_ring
from compas_cgc.model.roles import DUMMY
from compas_cgc.model.roles import INTERNAL

from ..support import shapes


def nine_regions(cells=3):
    """Return a square of 3 x 3 regions of `cells` x `cells` squares, with its corners fixed."""
    n = 3 * cells
    mesh = CGCMesh.from_meshgrid(dx=n, nx=n)
    mesh.set_supports("corners")
    lines = [[i * (n + 1) + k for i in range(n + 1)] for k in (cells, 2 * cells)]
    lines += [[k * (n + 1) + j for j in range(n + 1)] for k in (cells, 2 * cells)]
    mesh.set_creases(lines)
    return mesh


def state(mesh):
    names = ("x", "y", "z", "role", "target", "s", "e")
    vertices = {key: [mesh.vertex_attribute(key, name) for name in names] for key in mesh.vertices()}
    return vertices, {face: mesh.face_vertices(face) for face in mesh.faces()}, mesh.creases(), mesh.regions()


# ----------------------------------------------------------------------
# Construction
# ----------------------------------------------------------------------


def test_grids_have_six_edges_at_every_inner_vertex_and_face_up():
    mesh = CGCMesh.from_meshgrid(dx=4, nx=4)
    inner = [v for v in mesh.vertices() if mesh.vertex_role(v) == "internal"]
    assert len(inner) == 9 and all(mesh.vertex_degree(v) == 6 for v in inner)
    assert all(mesh.face_normal(f)[2] > 0 for f in mesh.faces())


def test_quads_and_polygons_are_triangulated():
    mesh = CGCMesh.from_vertices_and_faces(
        [[0, 0, 0], [2, 0, 0], [2, 1, 0], [0, 1, 0], [1, 2, 0], [3, 0.5, 0]], [[0, 1, 2, 3], [3, 2, 4], [1, 5, 2, 2]]
    )
    assert [mesh.face_vertices(f) for f in mesh.faces()] == [[0, 1, 2], [2, 3, 0], [3, 2, 4], [1, 5, 2]]
    pentagon = np.array([[np.cos(t), np.sin(t), 0] for t in 2 * np.pi * np.arange(5) / 5])
    mesh = CGCMesh.from_vertices_and_faces(pentagon, [[0, 1, 2, 3, 4]])
    assert mesh.number_of_faces() == 3 and mesh.area() == pytest.approx(2.5 * np.sin(2 * np.pi / 5))


def test_concave_polygons_keep_their_area():
    arrow = [[0, 0, 0], [2, -1, 0], [1, 0, 0], [2, 1, 0]]
    for shift in range(4):
        order = np.roll(np.arange(4), shift).tolist()
        mesh = CGCMesh.from_vertices_and_faces(arrow, [order])
        assert sum(mesh.face_area(f) for f in mesh.faces()) == pytest.approx(1.0)
        assert all(mesh.face_normal(f)[2] > 0 for f in mesh.faces())


def test_compas_constructors_give_triangles(tmp_path):
    box = Mesh.from_shape(Box(1, 2, 3))
    corners, quads = box.to_vertices_and_faces()
    body = [" ".join(map(str, xyz)) for xyz in corners] + [" ".join(map(str, [4, *quad])) for quad in quads]
    header = ["ply", "format ascii 1.0", "element vertex 8", *(f"property double {x}" for x in "xyz")]
    header += ["element face 6", "property list uchar int vertex_indices", "end_header"]
    # COMPAS itself cannot write these two.
    (tmp_path / "box.off").write_text("\n".join(["OFF", "8 6 0", *body]) + "\n")
    (tmp_path / "box.ply").write_text("\n".join([*header, *body]) + "\n")
    box.to_obj(tmp_path / "box.obj")
    CGCMesh.from_mesh(box).to_stl(tmp_path / "box.stl")
    for suffix in ("obj", "off", "ply", "stl"):
        path = tmp_path / f"box.{suffix}"
        mesh = getattr(CGCMesh, f"from_{suffix}")(path)
        assert isinstance(mesh, CGCMesh) and mesh.is_trimesh() and mesh.number_of_faces() == 12, suffix
    assert CGCMesh.from_polyhedron(6).number_of_faces() == 12
    assert CGCMesh.from_shape(Box(1)).is_trimesh()
    assert CGCMesh.from_polygons([[[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]]]).number_of_faces() == 2


def test_from_mesh_keeps_keys_attributes_and_name():
    source = Mesh.from_vertices_and_faces({10: [0, 0, 0], 20: [1, 0, 0], 30: [0, 1, 0]}, {7: [10, 20, 30]})
    source.name = "roof"
    source.vertex_attribute(20, "load", 3.5)
    source.attributes["unit"] = "mm"
    mesh = CGCMesh.from_mesh(source)
    assert list(mesh.vertices()) == [10, 20, 30] and list(mesh.faces()) == [7]
    assert (mesh.name, mesh.vertex_attribute(20, "load"), mesh.attributes["unit"]) == ("roof", 3.5, "mm")
    assert CGCMesh.from_mesh(nine_regions()).regions() == nine_regions().regions()


def test_a_face_that_names_no_vertex_is_refused_in_words():
    with pytest.raises(ValueError, match="face 1 names vertex 9, which does not exist"):
        CGCMesh.from_vertices_and_faces([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2], [0, 1, 9]])


# ----------------------------------------------------------------------
# Roles, creases, regions, targets
# ----------------------------------------------------------------------


def test_roles_follow_from_supports_creases_and_edges():
    mesh = nine_regions()
    roles = mesh.vertices_role()
    assert {role: roles.count(role) for role in set(roles)} == {"internal": 36, "fixed": 4, "crease": 36, "free": 24}
    mesh.set_supports("boundary")
    assert mesh.vertices_role().count("fixed") == 36 and "free" not in mesh.vertices_role()
    mesh.set_supports([0])
    assert mesh.supports() == [0] and mesh.vertices_role().count("crease") == 36
    mesh.set_supports([9], add=True)
    assert mesh.supports() == [0, 9]
    mesh.set_creases([])
    assert "crease" not in mesh.vertices_role() and len(mesh.regions()) == 1


def test_creases_are_paths_between_branchings():
    paths = nine_regions().creases()
    assert len(paths) == 12 and all(len(path) == 4 for path in paths)
    mesh = CGCMesh.from_meshgrid(dx=4, nx=4)
    mesh.set_creases([[6, 7, 8, 13, 18, 17, 16, 11, 6]])
    assert mesh.creases() == [[6, 7, 8, 13, 18, 17, 16, 11, 6]]
    assert [len(region) for region in mesh.regions()] == [24, 8]


def test_regions_are_numbered_by_their_first_face():
    mesh = nine_regions()
    regions = mesh.regions()
    assert [len(region) for region in regions] == [18] * 9
    assert [min(region) for region in regions] == sorted(min(region) for region in regions)
    assert sorted(f for region in regions for f in region) == list(mesh.faces())


def test_targets_by_region_and_by_vertex():
    mesh = nine_regions()
    mesh.set_target(1)
    mesh.set_target(4.0, region=4)
    mesh.set_target(2.5, vertices=[11])
    assert [mesh.region_target(r) for r in range(9)] == [None, 1.0, 1.0, 1.0, 4.0, 1.0, 1.0, 1.0, 1.0]
    assert mesh.vertices_target([11, 12]) == [2.5, 1.0]
    with pytest.raises(ValueError, match="no region 9; the mesh has regions 0 to 8"):
        mesh.set_target(1, region=9)
    for wrong in (float("nan"), float("inf"), "much", None):
        with pytest.raises(ValueError, match="the target must be a"):
            mesh.set_target(wrong)


def test_strategies_by_crease_and_by_vertex():
    mesh = nine_regions()
    mesh.set_strategy(s=0.5, crease=0)
    mesh.set_strategy(e=3, vertices=[33])
    assert [mesh.vertex_s(v) for v in mesh.creases()[0]] == [0.5] * 4 and mesh.vertex_s(33) in (None, 0.5)
    assert mesh.vertex_e(33) == 3
    problem = CGCProblem.from_mesh(mesh)
    assert np.nansum(problem.s == 0.5) == 4 and np.nansum(problem.e == 3) == 1
    with pytest.raises(ValueError, match="s must be between 0 and 1"):
        mesh.set_strategy(s=2)


def test_a_crease_off_the_edges_is_refused_in_words():
    mesh = CGCMesh.from_meshgrid(dx=3, nx=3)
    with pytest.raises(ValueError, match="from vertex 0 to 15 does not follow an edge"):
        mesh.set_creases([[0, 15]])
    with pytest.raises(ValueError, match="no vertex 99"):
        mesh.set_supports([99])


def test_flip_turns_the_roof_over():
    mesh = nine_regions()
    before = mesh.regions()
    mesh.flip()
    assert all(mesh.face_normal(f)[2] < 0 for f in mesh.faces())
    assert mesh.regions() == before and mesh.vertices_role() == nine_regions().vertices_role()


# ----------------------------------------------------------------------
# Dummy mesh
# ----------------------------------------------------------------------


def test_a_dummy_ring_carries_free_edges_and_goes_again():
    mesh = nine_regions()
    mesh.set_target(1.0)
    ringed = mesh.copy()
    dummies = ringed.add_dummy_ring()
    assert len(dummies) == 36 and ringed.number_of_faces() == mesh.number_of_faces() + 72
    assert "free" not in ringed.vertices_role()
    edge = [v for v in mesh.vertices() if mesh.vertex_role(v) == "free"]
    assert all(ringed.vertex_degree(v) == 6 for v in edge)
    assert ringed.regions() == mesh.regions()
    assert state(ringed.without_dummies()) == state(mesh)
    carried = with_dummy_ring(CGCProblem.from_mesh(mesh))
    by_hand = CGCProblem.from_mesh(ringed)
    assert np.array_equal(carried.roles, by_hand.roles) and np.array_equal(carried.vertices, by_hand.vertices)
    assert (carried.roles == DUMMY).sum() == 36 and (carried.roles == INTERNAL).sum() == 60


# ----------------------------------------------------------------------
# Keeping everything
# ----------------------------------------------------------------------


COPIES = {
    "copy": lambda mesh: mesh.copy(),
    "json": lambda mesh: compas.json_loads(compas.json_dumps(mesh)),
    "pickle": lambda mesh: pickle.loads(pickle.dumps(mesh)),
    "duplicate": lambda mesh: mesh._duplicate(),
}


@pytest.mark.parametrize("how", COPIES)
def test_copies_keep_everything(how):
    mesh = nine_regions()
    mesh.set_target(1.0)
    mesh.set_target(4.0, region=4)
    mesh.set_strategy(s=0.25, e=2, crease=3)
    mesh.add_dummy_ring()
    mesh.name = "roof"
    mesh.attributes["unit"] = "m"
    mesh.update_default_vertex_attributes(target=0.7)
    other = COPIES[how](mesh)
    assert type(other) is CGCMesh and other is not mesh
    assert state(other) == state(mesh)
    assert other.attributes["unit"] == "m" and other.default_vertex_attributes["target"] == 0.7
    if how != "copy":
        assert other.name == "roof"


def test_a_result_shares_nothing_with_its_input():
    mesh = nine_regions()
    mesh.vertex_attribute(5, "loads", [1, 2])
    twin = mesh.with_coordinates(mesh.arrays()[0] + 1)
    twin.vertex_attribute(5, "loads").append(3)
    twin.set_creases([])
    twin.set_target(9.0)
    twin.delete_face(0)
    assert mesh.vertex_attribute(5, "loads") == [1, 2] and mesh.vertex_coordinates(5)[2] == 0.0
    assert len(mesh.creases()) == 12 and mesh.vertex_target(5) is None and mesh.number_of_faces() == 162


def test_a_program_without_us_reads_a_plain_mesh():
    data = compas.json_dumps(nine_regions())
    plain = compas.json_loads(data.replace("compas_cgc.datastructures/CGCMesh", "not_installed.here/CGCMesh"))
    assert type(plain) is Mesh and plain.number_of_faces() == 162
    assert plain.vertex_attribute(0, "role") == "fixed"


def test_numpy_input_survives_json():
    vertices, faces = np.random.default_rng(0).random((4, 3)), np.array([[0, 1, 2], [0, 2, 3]])
    mesh = CGCMesh.from_vertices_and_faces(vertices, faces)
    mesh.set_target(np.float64(0.5), vertices=np.array([1, 2]))
    mesh.set_supports(np.array([0]))
    assert state(compas.json_loads(compas.json_dumps(mesh))) == state(mesh)
    assert np.array_equal(mesh.arrays()[0], vertices)


# ----------------------------------------------------------------------
# Check
# ----------------------------------------------------------------------


def ready(mesh, target=0.01):
    mesh.set_supports("boundary")
    mesh.set_target(target)
    return mesh


def square(n=4):
    return ready(CGCMesh.from_meshgrid(dx=n, nx=n))


def with_faces(*faces, vertices=None):
    points = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [1, 1, 0], [2, 0, 1], [5, 5, 5]][: vertices or 6]
    return CGCMesh.from_vertices_and_faces(points, list(faces))


def moebius():
    n = 12
    t = np.repeat(2 * np.pi * np.arange(n) / n, 2)
    w = np.tile([-0.3, 0.3], n)
    vertices = np.column_stack([(1 + w * np.cos(t / 2)) * np.cos(t), (1 + w * np.cos(t / 2)) * np.sin(t), w * np.sin(t / 2)])
    faces = []
    for k in range(n):
        a, b = 2 * k, 2 * k + 1
        c, d = (2 * k + 2, 2 * k + 3) if k < n - 1 else (1, 0)
        faces += [[a, c, d], [a, d, b]]
    return CGCMesh.from_vertices_and_faces(vertices, faces)


def nan():
    mesh = square()
    mesh.vertex_attribute(12, "z", float("nan"))
    return mesh


def quads():
    mesh = square()
    mesh.add_vertex(key=100, x=-1, y=0, z=0)
    mesh.add_vertex(key=101, x=-1, y=1, z=0)
    mesh.add_face([0, 1, 101, 100])
    return mesh


def text_target():
    mesh = square()
    mesh.vertex[12]["target"] = "one"
    return mesh


def no_target():
    mesh = square()
    del mesh.vertex[12]["target"]
    return mesh


def stale_crease():
    mesh = square()
    mesh.set_creases([[6, 7, 8]])
    mesh.delete_vertex(7)
    mesh.edgedata["(6, 7)"] = {"is_crease": True}
    return mesh


def against():
    mesh = square()
    mesh.face[3].reverse()
    return mesh


def touching():
    return ready(CGCMesh.from_vertices_and_faces([[0, 0, 0], [1, 0, 0], [0, 1, 0], [-1, 0, 0], [0, -1, 0]], [[0, 1, 2], [0, 3, 4]]))


REFUSED = [
    (with_faces, "the mesh has no faces; give a mesh with faces"),
    (lambda: with_faces([0, 1, 2], [0, 2, 1], [1, 3, 2], vertices=4), "faces 1 are duplicates of others; remove them"),
    (
        lambda: with_faces([0, 1, 2], [1, 3, 2], [1, 1, 3], vertices=4),
        "faces 2 of the input are degenerate: they have fewer than three different corners",
    ),
    (
        lambda: CGCMesh.from_vertices_and_faces([[0, 0, 0], [1, 0, 0], [2, 0, 0], [0, 1, 0]], [[0, 1, 2], [0, 2, 3]]),
        "faces 0 are degenerate (zero area); weld or remove their vertices, or remesh there",
    ),
    (
        lambda: with_faces([0, 1, 2], [1, 0, 3], [0, 1, 4], vertices=5),
        "edges 0-1 belong to more than two faces, so the mesh is not manifold; remove the extra faces",
    ),
    (touching, "at vertices 0 parts of the mesh touch in a point, so it is not manifold"),
    (moebius, "the mesh is not orientable (like a Moebius strip); cut it open"),
    (against, "faces 3 are oriented against their neighbours; unify them (mesh.unify())"),
    (nan, "vertices 12 have coordinates that are not finite numbers"),
    (lambda: with_faces([0, 1, 2], [1, 3, 2]), "vertices 4, 5 belong to no face; remove them"),
    (quads, "faces 32 have more than three corners; triangulate them"),
    (lambda: CGCMesh.from_meshgrid(dx=2, nx=2), "the mesh has no supports; fix vertices"),
    (lambda: CGCMesh.from_meshgrid(dx=2, nx=2), "no target curvature is set; set one"),
    (lambda: ready(CGCMesh.from_meshgrid(dx=1, nx=1)), "the mesh has no internal vertex at which K could be prescribed"),
    (no_target, "vertices 12 have no target curvature; set one for their region"),
    (text_target, "the targets of vertices 12 are not finite numbers ('one'); set finite targets"),
    (stale_crease, "creases 6-7, 7-8 do not follow edges of the mesh; set the creases again"),
    (lambda: ready(CGCMesh.from_meshgrid(dx=4, nx=4), 0.3), "the target 0.3 is too large for this boundary"),
]


@pytest.mark.parametrize("make, words", REFUSED, ids=[words[:30] for _, words in REFUSED])
def test_a_bad_mesh_is_refused_with_the_words_of_the_check(make, words):
    from compas_cgc import solve

    mesh = make()
    problems = mesh.check()
    assert any(words in problem and problem.fatal for problem in problems), problems
    before = state(mesh) if mesh.number_of_faces() else None
    with pytest.raises(ValueError) as refusal:
        solve(mesh)
    assert all(str(problem) in str(refusal.value) for problem in problems if problem.fatal)
    if before is not None and "nan" not in repr(before):
        assert state(mesh) == before


def test_the_mends_that_the_sentences_name_work():
    mesh = quads()
    mesh.triangulate()
    mesh.set_supports("boundary")
    assert not [p for p in mesh.check() if "corners" in p]
    mesh = with_faces([0, 1, 2], [1, 3, 2])
    mesh.remove_unused_vertices()
    assert not [p for p in mesh.check() if "no face" in p]
    mesh = against()
    mesh.unify()
    assert mesh.check() == []


def test_several_pieces_are_solved_and_said():
    from compas_cgc import solve

    one, other = square(), square()
    vertices, faces = one.arrays()
    mesh = CGCMesh.from_vertices_and_faces(np.vstack([vertices, other.arrays()[0] + [10, 0, 0]]), np.vstack([faces, faces + len(vertices)]))
    ready(mesh)
    assert [(str(p), p.fatal) for p in mesh.check()] == [("the mesh has 2 separate pieces, which are solved independently", False)]
    result = solve(mesh)
    z = result.mesh.arrays()[0][:, 2]
    assert result.converged and z[: len(vertices)] == pytest.approx(z[len(vertices) :], rel=1e-6, abs=1e-9)


@given(width=st.floats(0.01, 1e4), part=st.floats(0.05, 2.0))
def test_what_a_boundary_can_carry_scales_with_its_size(width, part):
    """On a square of width w no surface has K above pi / w^2, by the area of the Gauss map."""
    mesh = ready(CGCMesh.from_meshgrid(dx=width, nx=8), part * np.pi / width**2)
    assert bool(mesh.check()) == (part >= 1.0)


def test_an_open_or_creased_or_curved_boundary_is_not_refused():
    mesh = CGCMesh.from_meshgrid(dx=4, nx=4)
    mesh.set_target(5.0)
    mesh.set_supports("corners")
    assert [(said.fatal, "over this convex plan" in said) for said in mesh.check()] == [(False, True)]
    mesh.set_supports("boundary")
    assert [said.fatal for said in mesh.check()] == [True]
    mesh.set_creases([[10, 11, 12, 13, 14]])
    assert [(said.fatal, "over the convex plan of region" in said) for said in mesh.check()] == [(False, True)] * 2


def test_concave_edges_and_closed_meshes_are_noted_but_not_refused():
    grid = CGCMesh.from_meshgrid(dx=6, nx=6)
    vertices, faces = grid.arrays()
    centre = vertices[faces].mean(axis=1)[:, :2]
    for outside, corners in (((centre > 3).all(axis=1), 1), ((np.abs(centre - 3) < 1).all(axis=1), 4)):
        mesh = CGCMesh.from_vertices_and_faces(vertices, faces[~outside])
        mesh.remove_unused_vertices()
        ready(mesh, 0.001)
        note, *others = mesh.check()
        assert not note.fatal and note.startswith("the boundary is concave at vertices")
        # Around the square hole three held vertices of one height lie on a line within the region.
        assert all(not other.fatal and "lies on the straight line or plane" in other for other in others) and len(others) == (corners == 4)
        assert len(note.split(",")[0:-1]) >= 1 and note.count(", ") == corners
        mesh.set_target(0.0)
        assert mesh.check() == []
    sphere = CGCMesh.from_vertices_and_faces(*shapes.icosphere(1))
    sphere.set_supports([0])
    sphere.set_target(1.0)
    (note,) = sphere.check()
    assert not note.fatal and note.startswith("the mesh is closed")


def test_result_is_a_copy_with_everything_but_dummies():
    from compas_cgc import solve

    mesh = nine_regions()
    mesh.set_target(0.05)
    before = state(mesh)
    result = solve(mesh)
    assert result.converged, result.message
    assert state(mesh) == before
    assert list(result.mesh.vertices()) == list(mesh.vertices()) and result.mesh.regions() == mesh.regions()
    assert result.mesh.vertices_role() == mesh.vertices_role() and result.mesh.vertices_target() == mesh.vertices_target()
