"""Files that nobody trusts: no foreign import, no traceback, no second or megabyte for what a header merely announces."""

from __future__ import annotations

import json
import random
import sys

import pytest

from compas_cgc import CGCMesh
from compas_cgc.datastructures.compas_data import KNOWN_TYPES
from compas_cgc.datastructures.compas_data import objects_of
from compas_cgc.errors import CGCError
from compas_cgc.errors import FileError
from compas_cgc.fabrication.tables import csv_text
from compas_cgc.fabrication.tables import escaped
from compas_cgc.fabrication.tables import unescaped
from compas_cgc.io import read_problem
from compas_cgc.io.cursor import Cursor
from compas_cgc.io.cursor import ReadLimits

from ..support.mutated_files import FOREIGN
from ..support.mutated_files import SUFFIXES
from ..support.mutated_files import mutated
from ..support.mutated_files import read_all
from ..support.mutated_files import valid_files

PLY = "ply\nformat {kind} 1.0\nelement vertex 3\nproperty double x\nproperty double y\nproperty double z\n{more}end_header\n"
MESH = {"dtype": "compas.datastructures/Mesh", "data": {"vertex": {}, "face": {}}}
TRIANGLE = "v 0 0 0\nv 1 0 0\nv 0 1 0\n"

HOSTILE = {
    "count.ply": (PLY.format(kind="ascii", more="element junk 99999999999\n") + "0 0 0 1 0 0 0 1 0", "declares 99999999999"),
    "negative_count.ply": (
        PLY.format(kind="ascii", more="element face -1\nproperty list char int vertex_indices\n") + "0 0 0 1 0 0 0 1 0",
        "declares -1",
    ),
    "empty_elements.ply": (PLY.format(kind="binary_little_endian", more="element junk 99999999999\n") + 80 * "0", "declares 99999999999"),
    "list_length.ply": (
        PLY.format(kind="binary_little_endian", more="element face 900\nproperty list char uchar vertex_indices\n")
        + 72 * "\0"
        + 900 * "\xff",
        "at least 3 corners, not -1",
    ),
    "count.off": ("OFF\n99999999999 1 0\n0 0 0\n", "declares 99999999999 vertices"),
    "negative_count.off": ("OFF\n-1 -1 0\n0 0 0\n1 0 0\n", "declares -1 vertices"),
    "negative_face.off": ("OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n-3 0 1 2\n", "at least 3 corners, not -3"),
    "continued.obj": ("v 0 0 0 \\\n" * 100_000, "holds no mesh"),
    "corners.obj": (TRIANGLE + "f " + "1 2 3 " * 5000, "15000 corners"),
    "large.obj": (TRIANGLE.replace("1", "1e308") + "f 1 2 3\n", "exceeds 1e[+]12"),
    "index.obj": (TRIANGLE + f"f 1 2 {10**30}\n", "the vertex does not exist"),
    "lists.json": ("[" * 100_000, "nested too deeply"),
    "objects.json": ('{"a":' * 300 + "1" + "}" * 300, "nested more than 64 levels deep"),
    "type.json": (json.dumps({"dtype": f"{FOREIGN}/X", "data": {}}), "it holds X and no mesh"),
    "inner_type.json": (
        json.dumps({**MESH, "data": {"vertex": {"0": {"dtype": "os/system", "data": {}}}}}),
        "contain an object of type 'os/system'",
    ),
    "bases.json": (json.dumps({"dtype": f"{FOREIGN}/X", "inheritance": ["os/_Environ"], "data": {}}), "it holds X and no mesh"),
    "drawn.json": (
        CGCMesh.from_meshgrid(dx=1, nx=1).to_jsonstring().replace('"data": {', '"data": {"drawn": {"vertices": [[0, 0]]}, ', 1),
        "drawn shape must have 3 finite",
    ),
    "no_coordinate.json": (CGCMesh.from_meshgrid(dx=1, nx=1).to_jsonstring().replace('"z": 0.0, ', "", 2), "'z' is missing"),
}


@pytest.mark.parametrize("name", HOSTILE)
def test_a_hostile_file_is_refused_with_one_sentence_at_once(tmp_path, name):
    content, sentence = HOSTILE[name]
    kind = "." + name.partition(".")[2]
    (path := tmp_path / name).write_bytes(content.encode("latin-1"))
    with pytest.raises(FileError, match=sentence):
        read_problem(path)
    read = read_all([(kind, content.encode("latin-1"))], tmp_path)
    assert read.refused == 1 and read.slowest < 2.0 and not read.imported


@pytest.mark.parametrize("suffix", SUFFIXES)
def test_mutated_files_end_in_sentences(tmp_path, suffix):
    source = random.Random(suffix)
    seeds = valid_files(tmp_path, suffix)
    count = 10 if suffix == ".3dm" else 60
    read = read_all([(suffix, mutated(source.choice(seeds), suffix, source)) for _ in range(count)], tmp_path)
    assert read.tracebacks == [] and not read.imported
    assert read.refused > count / 5, "the damage is met"


@pytest.mark.nightly
@pytest.mark.parametrize("suffix", SUFFIXES)
def test_thousands_of_mutated_files_cost_little(tmp_path, suffix):
    source = random.Random(f"many {suffix}")
    seeds = valid_files(tmp_path, suffix)
    count = 300 if suffix == ".3dm" else 10_000
    read = read_all([(suffix, mutated(source.choice(seeds), suffix, source)) for _ in range(count)], tmp_path)
    assert read.tracebacks == [] and not read.imported
    assert read.slowest < 2.0 and read.megabytes < 200


def test_compas_data_brings_in_no_foreign_module_by_any_door(tmp_path, monkeypatch):
    (tmp_path / "foreign_door.py").write_text("class X:\n    pass\n")
    monkeypatch.syspath_prepend(tmp_path)
    text = json.dumps({"dtype": "foreign_door/X", "data": {}})
    (path := tmp_path / "foreign.json").write_text(text)
    for read in (lambda: read_problem(path), lambda: CGCMesh.from_json(path), lambda: CGCMesh.from_jsonstring(text)):
        with pytest.raises(CGCError, match="an object of type 'foreign_door/X'|it holds X and no mesh"):
            read()
    assert "foreign_door" not in sys.modules


def test_a_mesh_of_another_package_is_read_as_the_compas_mesh_that_it_derives_from():
    data = {**CGCMesh.from_meshgrid(dx=1, nx=1).__jsondump__(), "dtype": "compas_other/Roof", "inheritance": ["compas.datastructures/Mesh"]}
    data["data"] = json.loads(json.dumps(data["data"]))
    assert len(list(objects_of(data).faces())) == 2
    assert "compas.datastructures/Mesh" in KNOWN_TYPES


def test_a_mesh_comes_back_from_its_own_text(tmp_path):
    mesh = CGCMesh.from_meshgrid(dx=2, nx=2)
    mesh.set_supports("corners")
    mesh.to_json(tmp_path / "mesh.json")
    for back in (
        CGCMesh.from_json(tmp_path / "mesh.json"),
        CGCMesh.from_json(open(tmp_path / "mesh.json")),
        CGCMesh.from_jsonstring(mesh.to_jsonstring()),
    ):
        assert back.supports() == mesh.supports() and back.guid == mesh.guid
    with pytest.raises(TypeError, match="holds a Point, not a CGCMesh"):
        CGCMesh.from_jsonstring('{"dtype": "compas.geometry/Point", "data": [0, 0, 0]}')


def test_a_cursor_stops_at_each_of_its_limits():
    limits = ReadLimits(bytes=100, elements=10, nesting=3, seconds=0.0)
    with pytest.raises(ValueError, match="more than 0 MB"):
        Cursor(bytes(101), limits)
    cursor = Cursor(bytes(100), limits)
    cursor.array("<f8", 2)
    assert cursor.left == 84
    with pytest.raises(ValueError, match="declares 11 values, but only 84 bytes follow"):
        cursor.array("<f8", 11)
    with pytest.raises(ValueError, match="more than 10 elements"):
        cursor.count(9)
    with pytest.raises(ValueError, match="takes more than 0 s"):
        list(cursor.timed(range(5)))
    with pytest.raises(ValueError, match="nested more than 3 levels deep"):
        cursor.check_nesting([[[[]]]])


@pytest.mark.parametrize("text", ["=1+1", "+cmd|' /C calc'!A0", "-2+3", "@SUM(A1)", "\t=1", "\r=1", "=", "-"])
def test_a_cell_that_a_spreadsheet_would_run_is_escaped(text):
    assert escaped(text) == f"'{text}" and unescaped(escaped(text)) == text
    assert csv_text([text], [[text]]).count("'" + text[0]) == 2


@pytest.mark.parametrize("value", ["-1.5", "1e-3", "-inf", -2, -2.5, "'tis", "roof", "", None])
def test_numbers_and_plain_texts_stay_as_they_are(value):
    assert escaped(value) == value
    assert not isinstance(value, str) or unescaped(value) == value
