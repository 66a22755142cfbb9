"""One way in and out for meshes of all formats: what goes out comes in again, and what is broken is said."""

from __future__ import annotations

import struct

import numpy as np
import pytest
from compas.datastructures import Mesh
from compas.geometry import Box
from hypothesis import given
from hypothesis import strategies as st

from compas_cgc import CGCMesh
from compas_cgc import CGCProblem
from compas_cgc import solve
from compas_cgc.errors import CGCError
from compas_cgc.errors import FileError
from compas_cgc.io import SUFFIXES
from compas_cgc.io import read
from compas_cgc.io import read_mesh
from compas_cgc.io import read_problem
from compas_cgc.io import write
from compas_cgc.io.obj import obj_text
from compas_cgc.io.ply import ply_text

from ..support.rhino_models import row

N = 6
KEEP_ROLES = (".3dm", ".json", ".obj", ".ply")


def roof(origin=(0.0, 0.0, 0.0), scale=1.0):
    """Return a bumpy mesh with supports, a crease and two targets, at coordinates with all their digits."""
    mesh = CGCMesh.from_meshgrid(dx=N, nx=N)
    random = np.random.default_rng(1)
    for v in mesh.vertices():
        x, y, z = np.array(mesh.vertex_coordinates(v)) + 0.1 * random.random(3)
        mesh.vertex[v].update(x=scale * x / 3 + origin[0], y=scale * y / 3 + origin[1], z=scale * z / 3 + origin[2])
    mesh.set_supports("corners")
    mesh.set_creases([row(N, 2)])
    mesh.set_target(0.1 / 3)
    mesh.set_target(0.7, region=1)
    return mesh


def same_arrays(mesh, other):
    (V, F), (W, G) = mesh.arrays(), other.arrays()
    return V.tobytes() == W.tobytes() and np.array_equal(F, G)


@pytest.mark.parametrize("origin, scale", [((0, 0, 0), 1.0), ((1000.0, -700.0, 50.0), 1.0), ((1e6, 1e6, 0), 1000.0)])
@pytest.mark.parametrize("suffix", [s for s in SUFFIXES if s != ".stl"])
def test_every_bit_survives_at_the_origin_and_a_kilometre_away(tmp_path, suffix, origin, scale):
    mesh = roof(origin, scale)
    path = tmp_path / f"roof{suffix}"
    write(path, mesh)
    back, _ = read_mesh(path)
    assert same_arrays(mesh, back)
    if suffix in KEEP_ROLES:
        assert back.supports() == mesh.supports() and back.crease_edges() == mesh.crease_edges()
        assert [back.region_target(r) for r in range(2)] == [0.1 / 3, 0.7]
        assert back.vertices_role() == mesh.vertices_role() and back.check() == mesh.check()


@pytest.mark.parametrize("what", ["mesh", "problem", "result"])
@pytest.mark.parametrize("suffix", SUFFIXES)
def test_a_mesh_a_problem_and_a_result_are_written_alike(tmp_path, suffix, what):
    mesh = roof()
    result = solve(mesh, settings={"steps": 2})
    surface = {"mesh": mesh, "problem": mesh.to_problem(), "result": result}[what]
    path = tmp_path / f"roof{suffix}"
    write(path, surface)
    found = read_problem(path)
    expected = surface.to_problem()
    corners = [own.vertices[own.faces].tobytes() for own in (found.checked(), expected)]
    assert corners[0] == corners[1], "every bit of every triangle"
    if suffix in KEEP_ROLES:
        assert np.array_equal(found.problem.roles, expected.roles)
        assert found.problem.region_targets() == expected.region_targets() == [0.1 / 3, 0.7]
    again = tmp_path / f"again{suffix}"
    write(again, read(path))
    assert same_arrays(read(again), read(path))


# Objects of .3dm files have random identifiers, as Rhino gives them.
@pytest.mark.parametrize("suffix", [s for s in SUFFIXES if s != ".3dm"])
def test_the_same_mesh_is_the_same_file_to_the_last_bit(tmp_path, suffix):
    one, other = tmp_path / f"one{suffix}", tmp_path / f"other{suffix}"
    write(one, roof())
    write(other, roof())
    assert one.read_bytes() == other.read_bytes()


def test_a_mesh_without_a_name_is_called_by_the_name_of_its_file(tmp_path):
    mesh = CGCMesh.from_meshgrid(dx=2.0, nx=2)
    mesh.to_json(tmp_path / "hall.json")
    assert read_problem(tmp_path / "hall.json").problem.drawing.name == "hall"
    mesh.name = "porch"
    mesh.to_json(tmp_path / "hall.json")
    assert read_problem(tmp_path / "hall.json").problem.drawing.name == "porch"


def test_a_constraint_in_a_json_file_that_is_none_is_a_sentence(tmp_path):
    mesh = roof()
    mesh.attributes["goals"] = [{"kind": "height", "vertices": [3], "height": "tall"}]
    path = tmp_path / "roof.json"
    mesh.to_json(path)
    with pytest.raises(FileError, match=r"roof.json: height of a constraint of kind height must be a finite number; set the goals again"):
        read_problem(path)


def test_stl_has_no_vertices_but_every_bit_of_the_triangles(tmp_path):
    mesh = roof((1000.0, 0, 0))
    write(tmp_path / "roof.stl", mesh)
    back, notes = read_mesh(tmp_path / "roof.stl")
    (V, F), (W, G) = mesh.arrays(), back.arrays()
    assert V[F].tobytes() == W[G].tobytes() and len(V) == len(W)
    assert any("welded" in note for note in notes)


@given(st.lists(st.floats(allow_nan=False, allow_infinity=False, width=64), min_size=9, max_size=9, unique=True))
def test_text_formats_write_numbers_that_read_back_the_same(tmp_path_factory, numbers):
    places = np.array(numbers).reshape(3, 3)
    if len(np.unique(places, axis=0)) < 3:
        return
    mesh = CGCMesh.from_vertices_and_faces(places, [[0, 1, 2]])
    for make in (obj_text, ply_text):
        words = make(mesh.to_problem()).split()
        assert {repr(float(x)) for x in places.ravel()} <= set(words)


def test_the_dummy_mesh_and_keys_with_gaps_do_not_show(tmp_path):
    mesh = roof()
    plain = mesh.arrays()
    mesh.add_dummy_ring()
    for suffix in (".3dm", ".obj", ".ply"):
        write(tmp_path / f"a{suffix}", mesh)
        back, _ = read_mesh(tmp_path / f"a{suffix}")
        assert back.arrays()[0].tobytes() == plain[0].tobytes()
    gone = roof()
    gone.delete_vertex(next(iter(gone.vertices())))
    write(tmp_path / "b.obj", gone)
    assert same_arrays(gone, read_mesh(tmp_path / "b.obj")[0])


def test_our_files_open_in_compas(tmp_path):
    mesh = roof()
    vertices, faces = mesh.arrays()
    for suffix, load in ((".obj", Mesh.from_obj), (".ply", Mesh.from_ply), (".off", Mesh.from_off), (".stl", Mesh.from_stl)):
        path = tmp_path / f"roof{suffix}"
        write(path, mesh)
        other = load(str(path))
        assert (other.number_of_vertices(), other.number_of_faces()) == (len(vertices), len(faces))


def test_files_of_compas_are_read(tmp_path):
    box = Mesh.from_shape(Box(1))
    box.to_obj(str(tmp_path / "box.obj"))
    box.to_json(tmp_path / "box.json")
    box.quads_to_triangles()
    box.to_stl(str(tmp_path / "box.stl"), binary=True)
    for suffix in ("obj", "json", "stl"):
        mesh, _ = read_mesh(tmp_path / f"box.{suffix}")
        assert (mesh.number_of_vertices(), mesh.number_of_faces(), mesh.euler()) == (8, 12, 2)


def test_obj_as_other_programs_write_it(tmp_path):
    path = tmp_path / "other.obj"
    path.write_text(
        "\ufeffmtllib x.mtl\no thing\nv 0 0 0 1.0 0.5 0.5\nv 1 0 0\nv 1 1 0 \\\n 1\nv 0 1 0\nv 5 5 5\nvt 0 0\nvn 0 0 1\n"
        "usemtl a\ns 1\ng roof K=0.25 other\nf 1/1/1 2/1/1 3//1 -2\nl 1 3\nl 2 5\np 4\n",
        encoding="utf-8",
    )
    mesh, notes = read_mesh(path)
    assert mesh.arrays()[1].tolist() == [[0, 1, 2], [2, 3, 0]]
    assert mesh.supports() == [3] and mesh.crease_edges() == [(0, 2)] and mesh.vertex_target(1) == 0.25
    assert any("1 lines that do not follow edges" in note for note in notes)
    assert any("without a face" in note for note in notes)


def test_ply_of_either_byte_order_and_with_more_in_it(tmp_path):
    header = (
        "ply\nformat binary_{}_endian 1.0\ncomment x\nobj_info y\n"
        "element vertex 4\nproperty float x\nproperty float y\nproperty double z\nproperty uchar red\n"
        "element face 2\nproperty uchar flags\nproperty list uint8 uint32 vertex_index\n"
        "element extra 1\nproperty list char short q\nend_header\n"
    )
    for order, sign in (("little", "<"), ("big", ">")):
        body = b"".join(struct.pack(f"{sign}ffdB", x, y, 1 / 3, 9) for x, y in ((0, 0), (1, 0), (1, 1), (0, 1)))
        body += struct.pack(f"{sign}BB4I", 7, 4, 0, 1, 2, 3) + struct.pack(f"{sign}BB3I", 7, 3, 0, 1, 2)
        body += struct.pack(f"{sign}b2h", 2, 5, 6)
        path = tmp_path / f"{order}.ply"
        path.write_bytes(header.format(order).encode() + body)
        mesh, notes = read_mesh(path)
        assert mesh.number_of_faces() == 2, "the second face lies on a half of the first"
        assert mesh.vertex_coordinates(2) == [1.0, 1.0, 1 / 3] and any("seven digits" in note for note in notes)
        path.write_bytes(path.read_bytes()[:-20])
        with pytest.raises(FileError, match="cannot be read as .ply"):
            read_mesh(path)


def test_off_with_counts_on_the_first_line_and_colours(tmp_path):
    path = tmp_path / "a.off"
    path.write_text("COFF 4 1 0\n# a comment\n0 0 0 255 0 0\n1 0 0 0 0 0\n1 1 0 0 0 0\n\n0 1 0 0 0 0\n4 0 1 2 3 0.5 0.5 0.5\n")
    mesh, _ = read_mesh(path)
    assert mesh.number_of_faces() == 2


BROKEN = {
    "empty.obj": b"",
    "points.obj": b"v 0 0 0\nv 1 0 0\n",
    "word.obj": b"v 0 0 zero\n",
    "far.obj": b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 9\n",
    "nan.obj": b"v 0 0 nan\nv 1 0 0\nv 0 1 0\nf 1 2 3\n",
    "flat.obj": b"v 0 0 0\nv 0 0 0\nv 0 0 0\nf 1 2 3\n",
    "binary.obj": bytes(range(256)),
    "short.off": b"OFF\n3 1 0\n0 0 0\n1 0 0\n",
    "word.off": b"3 1 0\n0 0 0\n",
    "counts.off": b"OFF\nmany faces 0\n",
    "far.off": b"OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 7\n",
    "head.ply": b"plywood",
    "type.ply": b"ply\nformat ascii 1.0\nelement vertex 1\nproperty quaternion x\nend_header\n",
    "short.ply": b"ply\nformat ascii 1.0\nelement vertex 9\nproperty double x\nproperty double y\nproperty double z\nend_header\n1 2 3\n",
    "huge.ply": b"ply\nformat binary_little_endian 1.0\nelement vertex 99999999999\nproperty double x\nend_header\n",
    "format.ply": b"ply\nformat morse 1.0\nend_header\n",
    "half.stl": b"solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\n",
    "three.stl": b"solid a\nvertex 0 0 0\nvertex 1 0 0\nvertex 1 1 0\nendfacet\nvertex 2 2 2\n",
    "junk.stl": b"\x00" * 100,
    "word.json": b"{'a': 1}",
    "list.json": b"[1, 2, 3]",
    "unknown.json": b'{"dtype": "no.such/Thing", "data": {}}',
    "binary.json": bytes(range(128, 256)),
    "junk.3dm": b"not a Rhino file at all",
    "a.fbx": b"",
    "nosuffix": b"",
}


@pytest.mark.parametrize("name", sorted(BROKEN))
def test_a_broken_file_ends_in_one_sentence_that_names_it(tmp_path, name):
    path = tmp_path / name
    path.write_bytes(BROKEN[name])
    with pytest.raises(FileError) as refusal:
        read_mesh(path)
    assert name in str(refusal.value) and "\n" not in str(refusal.value)


def test_a_file_that_is_not_there(tmp_path):
    for suffix in SUFFIXES:
        with pytest.raises(FileError, match="there is no file"):
            read_mesh(tmp_path / f"missing{suffix}")
        (tmp_path / f"folder{suffix}").mkdir()
        with pytest.raises(FileError, match="folder"):
            read_mesh(tmp_path / f"folder{suffix}")
        with pytest.raises(FileError, match="folder"):
            write(tmp_path / f"folder{suffix}", roof())


@pytest.mark.parametrize("suffix", SUFFIXES)
def test_a_failed_write_leaves_the_old_file_and_nothing_else(tmp_path, suffix, monkeypatch):
    path = tmp_path / f"roof{suffix}"
    write(path, roof())
    before = path.read_bytes()

    def full(*_):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr("compas_cgc._atomic_write.os.replace", full)
    with pytest.raises(CGCError, match="No space left"):
        write(path, roof((5, 5, 5)))
    assert path.read_bytes() == before and list(tmp_path.iterdir()) == [path]


def test_a_ply_without_creases_names_no_edges(tmp_path):
    problem = CGCProblem([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]])
    path = tmp_path / "plain.ply"
    write(path, problem)
    assert "element edge" not in path.read_text()
    assert read_problem(path).problem.creases.shape == (0, 2)
