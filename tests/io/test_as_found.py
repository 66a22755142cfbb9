"""Mesh files as other programs write them: what is read, and what is refused with its place."""

from __future__ import annotations

import json
import warnings

import numpy as np
import pytest

from compas_cgc.errors import CGCError
from compas_cgc.errors import FileError
from compas_cgc.io import read
from compas_cgc.io import read_problem
from compas_cgc.model.checks import check
from tests.support.shapes import grid

POINTS = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0.5, 0.5, 1)]
FACES = [(0, 1, 4), (1, 2, 4), (2, 3, 4), (3, 0, 4)]
ROWS = [*(" ".join(map(str, point)) for point in POINTS), *(f"3 {a} {b} {c}" for a, b, c in FACES)]


@pytest.fixture
def loaded(tmp_path):
    def load(name, content, **how):
        path = tmp_path / name
        path.write_bytes(content if isinstance(content, bytes) else content.encode())
        return read_problem(path, **how)

    return load


def _is_pyramid(read):
    problem = read.problem
    assert np.array_equal(problem.vertices, POINTS) and sorted(map(sorted, problem.faces.tolist())) == sorted(map(sorted, FACES))
    return True


OFF = {
    "plain": "OFF\n5 4 8\n" + "\n".join(ROWS),
    "counts without edges": "OFF\n5 4\n" + "\n".join(ROWS),
    "counts behind the word": "OFF 5 4 0\n" + "\n".join(ROWS),
    "counts joined to the word": "OFF5 4 0\n" + "\n".join(ROWS),
    "without the word": "5 4 0\n" + "\n".join(ROWS),
    "one number a row": "OFF\n5\n4\n0\n" + "\n".join(" ".join(ROWS).split()),
    "all in one row": "OFF 5 4 0 " + " ".join(ROWS),
    "comments and blanks": "OFF # made by hand\n\n5 4 0\n" + "\n# next\n".join(ROWS),
    "colours": "COFF\n5 4 0\n" + "\n".join([f"{row} 1 0 0 1" for row in ROWS[:5]] + [f"{row} 255 0 0" for row in ROWS[5:]]),
    "normals": "NOFF\n5 4 0\n" + "\n".join([f"{row} 0 0 1" for row in ROWS[:5]] + ROWS[5:]),
    "homogeneous": "4OFF\n5 4 0\n" + "\n".join([" ".join(str(2 * x) for x in (*p, 1)) for p in POINTS] + ROWS[5:]),
    "any dimension": "nOFF\n3\n5 4 0\n" + "\n".join(ROWS),
    "old line ends": ("OFF\n5 4 0\n" + "\n".join(ROWS)).replace("\n", "\r"),
}


@pytest.mark.parametrize("kind", OFF)
def test_off(loaded, kind):
    assert _is_pyramid(loaded("a.off", OFF[kind]))


HEADER = "ply\nformat ascii 1.0\ncomment end_header is not here\nelement vertex 5\n"
XYZ = "property double x\nproperty double y\nproperty double z\n"
CORNERS = "element face 4\nproperty list uchar int vertex_indices\nend_header\n"
PLY = {
    "plain": HEADER + XYZ + CORNERS + "\n".join(ROWS),
    "old line ends": (HEADER + XYZ + CORNERS + "\n".join(ROWS)).replace("\n", "\r"),
    "one number a row": HEADER + XYZ + CORNERS + "\n".join(" ".join(ROWS).split()),
    "more values in a row": HEADER + XYZ + CORNERS + "\n".join(f"{row} 7 7" for row in ROWS),
    "comments in the body": HEADER + XYZ + CORNERS + "comment here\n" + "\n".join(ROWS),
    "float lengths": HEADER + XYZ + CORNERS.replace("uchar", "float") + "\n".join([*ROWS[:5], *("3.0" + row[1:] for row in ROWS[5:])]),
    "strips": HEADER + XYZ + "element tristrips 1\nproperty list int int vertex_indices\nend_header\n"
    + "\n".join([*ROWS[:5], "12 0 1 4 2 -1 2 3 4 -1 3 0 4"]),
}  # fmt: skip


@pytest.mark.parametrize("kind", PLY)
def test_ply(loaded, kind):
    assert _is_pyramid(loaded("a.ply", PLY[kind]))


def test_obj_in_any_order_with_exponents_of_fortran_and_targets(loaded):
    faces = "".join(f"f {a + 1}/1 {b + 1}//2 {c + 1}\n" for a, b, c in FACES)
    points = "".join(f"v {x}D+00 {y}d0 {z} 1.0\n" for x, y, z in POINTS)
    read = loaded("a.obj", f"g roof K = .02\n{faces}{points}curv 0 1 1 2\n")
    assert _is_pyramid(read) and np.nanmax(read.problem.targets) == 0.02
    assert any("free-form geometry (curv) was left out" in note for note in read.notes)


def test_obj_relative_indices_count_from_the_statement(loaded):
    text = "".join(f"v {x} {y} {z}\n" for x, y, z in POINTS)
    assert _is_pyramid(loaded("a.obj", text + "".join(f"f {a - 5} {b - 5} {c - 5}\n" for a, b, c in FACES)))


def test_a_face_in_the_name_of_a_group_and_text_in_utf_16(loaded):
    text = "".join(f"v {x} {y} {z}\n" for x, y, z in POINTS) + "g An f Three Other Things\n"
    text += "".join(f"f {a + 1} {b + 1} {c + 1}\n" for a, b, c in FACES)
    assert _is_pyramid(loaded("a.obj", text)) and _is_pyramid(loaded("a.obj", text.encode("utf-16")))


def _facet(points, end="endfacet"):
    return "facet normal 0 0 1\nouter loop\n" + "".join(f"vertex {x} {y} {z}\n" for x, y, z in points) + f"endloop\n{end}\n"


TRIANGLE = "v 0 0 0\nv 1 0 0\nv 0 1 0\n"
BINARY_PLY = f"ply\nformat binary_little_endian 1.0\nelement vertex 3\n{XYZ}element face 1\nproperty list uchar uchar vertex_indices\n"
BINARY_PLY = (BINARY_PLY + "end_header\n").encode() + np.eye(3).tobytes()
REFUSED = {
    "few.obj": (TRIANGLE + "f 1 2\n", "line 4: .*at least 3 corners, not 2"),
    "moved.obj": (TRIANGLE.replace("0 0\nv", "0\n0 v"), "line 1: .*three coordinates"),
    "longer.obj": ("v 0 0 0 v 1 0 0\n", "line 1: .*'v' is not a number"),
    "number.obj": (TRIANGLE + "f 1 2\n3\n".replace("2\n", "2 3\n"), "line 5: .*begins with a word"),
    "few.off": (OFF["plain"].replace("3 1 2 4", "2 1 2"), "row 9: .*at least 3 corners, not 2"),
    "colour.off": (OFF["colours"].replace("1 0 0 1", "1 0 0", 1), "row 4: the vertex has 7 numbers, but 6 are expected"),
    "index.off": (OFF["plain"].replace("3 1 2 4", "3 1 2 5"), "row 9: vertex 5 does not exist; there are 5"),
    "uneven.ply": (PLY["more values in a row"].replace(" 7 7", " 7", 1), "row 12 .*2 values more than the header declares, unlike other"),
    "few.ply": (PLY["plain"].replace("3 1 2 4", "2 1 2"), "at least 3 corners, not 2"),
    "few_binary.ply": (BINARY_PLY + b"\2\0\1", "at least 3 corners, not 2"),
    "longer.ply": (BINARY_PLY + b"\3\0\1\2\0", "1 bytes more than its header declares"),
    "facets.stl": ("solid a\n" + _facet(POINTS[:2]) + _facet(POINTS[:4]), "facet 1 does not have three vertices"),
    "end.stl": ("solid a\n" + _facet(POINTS[:3], end=""), "facet 1 does not have three vertices"),
    "number.stl": ("solid a\n" + _facet([(0, 0, "blah")]), "facet 1: 'blah' is not a number"),
    "longer.stl": (b"\0" * 80 + (1).to_bytes(4, "little") + b"\0" * 100, "declares 1 triangles but holds 2"),
    "comma.obj": ("v 0,5 0 0\n", "line 1: .*decimal comma"),
    "target.obj": ("g K = soft\n", "line 1: .*'soft' is not a number"),
    "zero.obj": ("v 0 0 0\nf 0 1 1\n", "line 2: .*vertices count from 1"),
    "missing.obj": ("f 1 2 3\nv 0 0 0\n", "line 1: .*the vertex does not exist; there are 1"),
    "corner.off": (OFF["plain"].replace("3 1 2 4", "3 1 2"), r"row 9: the face declares 3 corners, but 2 numbers follow"),
    "short.off": (OFF["plain"].replace("\n3 3 0 4", ""), "the file ends too early"),
    "long.off": (OFF["all in one row"] + " 7", "1 numbers more than its header declares"),
    "binary.off": ("OFF BINARY\n5 4 0\n", "binary .off"),
    "plane.off": ("nOFF\n2\n3 1 0\n0 0\n1 0\n0 1\n3 0 1 2\n", "not three-dimensional"),
    "corner.ply": (PLY["plain"].replace("3 1 2 4", "3 1 2"), "row 17 .*fewer values than the header declares"),
    "names.ply": (PLY["plain"].replace("vertex_indices", "corners"), "no vertex_indices, but corners"),
    "short.stl": (b"\0" * 80 + (3).to_bytes(4, "little") + b"\0" * 100, "declares 3 triangles but holds 2"),
}


@pytest.mark.parametrize("name", REFUSED)
def test_a_fault_is_refused_with_its_place(loaded, name):
    content, words = REFUSED[name]
    with pytest.raises(FileError, match=f"{name}.*{words}"):
        loaded(name, content)


def _stl(points):
    corners = np.zeros(len(FACES), np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attribute", "<u2")]))
    corners["corners"] = np.array(points)[np.array(FACES)]
    return b"solid but binary".ljust(80) + len(FACES).to_bytes(4, "little") + corners.tobytes()


def test_text_of_stl_may_begin_with_a_comment(loaded):
    text = "# by hand\nsolid a # roof\n" + "".join(_facet([POINTS[k] for k in face]) for face in FACES) + "endsolid a\n"
    assert len(loaded("a.stl", text).problem.faces) == len(FACES)
    assert len(loaded("a.stl", _stl(POINTS).replace(b"but binary", b"facet norm")).problem.faces) == len(FACES)


def test_stl_with_bytes_after_its_end(loaded):
    read = loaded("a.stl", _stl(POINTS) + b"\0\0")
    assert len(read.problem.vertices) == 5 and any(note.startswith("2 bytes after the last of the 4 triangles") for note in read.notes)


def test_rounding_far_from_the_origin_is_reported_against_the_edge_length(loaded):
    near, far = (" ".join(loaded("a.stl", _stl(np.array(POINTS) + shift)).notes) for shift in (0, [4e5, 8e5, 0]))
    assert "seven digits" in near and "in steps of 0.0625 so far from the origin" in far and "% of the edge length" in far


@pytest.mark.parametrize("suffix", [".obj", ".off"])
def test_points_that_nearly_coincide_are_proposed_for_welding_and_welded(loaded, suffix):
    points = np.array(POINTS, float)[np.array(FACES)].reshape(-1, 3)
    points += 1e-7 * np.random.default_rng(3).normal(size=points.shape)
    if suffix == ".obj":
        text = "".join(f"v {x} {y} {z}\n" for x, y, z in points) + "".join(f"f {k + 1} {k + 2} {k + 3}\n" for k in range(0, 12, 3))
    else:
        text = (
            "OFF 12 4 0\n" + "".join(f"{x} {y} {z}\n" for x, y, z in points) + "".join(f"3 {k} {k + 1} {k + 2}\n" for k in range(0, 12, 3))
        )
    note = next(note for note in loaded(f"a{suffix}", text).notes if "--weld" in note)
    distance = float(note.rpartition(" ")[2])
    assert 1e-8 < distance < 1e-5
    assert len(loaded(f"a{suffix}", text, tolerance=distance).problem.vertices) == 5


def test_a_mutated_file_never_gives_a_different_mesh(loaded):
    """Rows cut or doubled, counts changed and words moved to other rows: the same mesh, or a sentence."""
    vertices, faces = grid(3)
    body = [*(" ".join(map(repr, row)) for row in vertices.tolist()), *(f"3 {a} {b} {c}" for a, b, c in faces.tolist())]
    head = {
        ".off": f"OFF\n{len(vertices)} {len(faces)} 0\n",
        ".ply": f"{HEADER.replace('vertex 5', f'vertex {len(vertices)}')}{XYZ}{CORNERS.replace('face 4', f'face {len(faces)}')}",
    }
    random = np.random.default_rng(5)
    outcomes = {True: 0, False: 0}
    for _ in range(150):
        suffix = (".off", ".ply")[int(random.integers(2))]
        rows, top = list(body), head[suffix]
        kind, at = int(random.integers(4)), int(random.integers(len(body)))
        if kind == 0:
            rows.pop(at)
        elif kind == 1:
            rows.insert(at, rows[at])
        elif kind == 2:
            top = top.replace(str(len(faces)), str(len(faces) + int(random.choice([-2, -1, 1, 2]))), 1)
        else:
            words = " ".join(rows).split()
            cuts = np.sort(random.choice(np.arange(1, len(words)), int(random.integers(1, len(rows))), replace=False))
            rows = [" ".join(part) for part in np.split(np.array(words), cuts)]
        try:
            problem = loaded(f"a{suffix}", top + "\n".join(rows)).problem
        except FileError:
            outcomes[False] += 1
        else:
            outcomes[True] += 1
            assert kind == 3 and np.array_equal(problem.vertices, vertices) and np.array_equal(problem.faces, faces)
    assert min(outcomes.values()) > 20


def _compas_0():
    vertex = {str(k): dict(zip("xyz", point)) for k, point in enumerate(POINTS)}
    return {"attributes": {"name": "Mesh"}, "dva": {"z": 0.0}, "vertex": vertex, "face": {str(k): face for k, face in enumerate(FACES)}}


def test_compas_data_of_older_versions(loaded):
    old = _compas_0()
    for own in old["vertex"].values():
        if own["z"] == 0:
            del own["z"]
    assert _is_pyramid(loaded("a.json", json.dumps(old)))
    assert _is_pyramid(loaded("a.json", json.dumps({"dtype": "compas.datastructures/Mesh", "value": old})))


def test_a_mesh_among_other_objects_is_found_and_named(loaded):
    curve = {"dtype": "compas.geometry/NurbsCurve", "data": {"points": []}}
    read = loaded("a.json", json.dumps({"curve": curve, "roof": _compas_0()}))
    assert _is_pyramid(read) and read.notes == ("beside the mesh the file holds 1 NurbsCurve, which was not read",)
    two = json.dumps([_compas_0(), {"floor": _compas_0()}])
    with pytest.raises(FileError, match=r"2 meshes, '0', '1\[floor\]'|2 meshes, '0', 'floor'; choose one by its name \(--mesh NAME\)"):
        loaded("a.json", two)
    assert _is_pyramid(loaded("a.json", two, mesh="floor"))
    with pytest.raises(FileError, match="no mesh 'wall'"):
        loaded("a.json", two, mesh="wall")
    with pytest.raises(FileError, match="holds NurbsCurve and no mesh"):
        loaded("a.json", json.dumps([curve]))


def test_supports_away_from_the_mesh_are_refused(loaded):
    text = TRIANGLE + "v 0 0 1e-12\nv 5 5 0\nf 1 2 3\np 4\n"
    near, far = loaded("a.obj", text), loaded("a.obj", text + "p 5\n")
    assert near.problem.supports.tolist() == [0] and not near.diagnostics
    with pytest.raises(CGCError, match=r"1 support is not at a vertex of the mesh; the farthest, at \(5, 5, 0\), is 6.4 away"):
        far.checked()


def test_a_warning_names_what_was_left_out(tmp_path):
    (path := tmp_path / "a.obj").write_text(TRIANGLE + "v 0 0 1\nf 1 2 3\nf 3 1 2\nf 1 3 4\n")
    with pytest.warns(UserWarning, match="a.obj: 1 duplicate face was removed") as found:
        read(path)
    assert len(found) == 1 and found[0].filename == __file__
    path.write_text(TRIANGLE + "f 1 2 3\n")
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        read(path)


PLATES = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 -1 0\nv 0 0 1\nv 9 0 0\nv 9 1 0\n"
PARTS = {
    "a fin on a fold": ("f 1 2 3\nf 1 2 4\nf 1 2 5\n", 9),
    "a touching point": ("f 1 2 3\nf 1 4 5\n", 6),
    "two fans at an edge that ends inside": ("f 1 2 3\nf 2 1 4\nf 1 6 7\n", 7),
}


@pytest.mark.parametrize("kind", PARTS)
def test_parts_that_meet_get_vertices_of_their_own_on_request(loaded, kind):
    faces, number = PARTS[kind]
    text = PLATES + faces + "p 1\nl 1 2\n"
    before, after = loaded("a.obj", text).problem, loaded("a.obj", text, manifold=True).problem
    assert any("manifold" in said for said in check(before)) and not any("manifold" in said for said in check(after))
    assert len(after.vertices) == number
    assert sorted(after.vertices[after.faces].sum(axis=(1, 2))) == sorted(before.vertices[before.faces].sum(axis=(1, 2)))
    assert np.array_equal(after.vertices[after.supports], np.zeros((len(after.supports), 3))) and len(after.supports) > 1
    assert len(after.creases) == (kind == "two fans at an edge that ends inside")


def test_a_manifold_mesh_stays_as_it_is(loaded):
    text = "".join(f"v {x} {y} {z}\n" for x, y, z in POINTS) + "".join(f"f {a + 1} {b + 1} {c + 1}\n" for a, b, c in FACES)
    split = loaded("a.obj", text, manifold=True)
    assert _is_pyramid(split) and not split.notes
