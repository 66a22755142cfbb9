"""Damaged Rhino files: a sentence each, no traceback, no hang, nothing overwritten."""

from __future__ import annotations

import struct
import subprocess
import sys

import numpy as np
import pytest
import rhino3dm

from compas_cgc.errors import CGCError
from compas_cgc.errors import FileError
from compas_cgc.io.rhino import archive
from compas_cgc.io.rhino import read_3dm
from compas_cgc.io.rhino.archive import read_archive

from ...support.rhino_models import Sketch
from ...support.rhino_models import corners_of
from ...support.rhino_models import quads
from ...support.rhino_models import row


@pytest.fixture(scope="module")
def whole(tmp_path_factory):
    """Return the bytes of a sound file."""
    sketch = Sketch()
    vertices, faces = quads(8, 8.0)
    sketch.mesh(vertices + 1 / 3, faces, "CGC::Mesh", {"K": "0.02"})
    sketch.points(vertices[corners_of(8)] + 1 / 3, "CGC::Supports")
    sketch.curve(vertices[row(8, 3)] + 1 / 3, "CGC::Creases")
    return sketch.save(tmp_path_factory.mktemp("sound") / "a.3dm").read_bytes()


def mutated(data, seed):
    """Return a file cut short, with bytes changed, with a stretch blotted out, or with a stretch lost."""
    random = np.random.default_rng(seed)
    broken = bytearray(data)
    at = int(random.integers(len(data)))
    kind = seed % 4
    if kind == 0:
        return bytes(broken[:at])
    if kind == 1:
        for place in random.integers(len(data), size=random.integers(1, 9)):
            broken[place] ^= int(random.integers(1, 256))
    elif kind == 2:
        length = int(random.integers(1, 200))
        broken[at : at + length] = bytes([255 if random.random() < 0.5 else 0]) * len(broken[at : at + length])
    else:
        del broken[at : at + int(random.integers(1, 400))]
    return bytes(broken)


@pytest.mark.parametrize("seed", range(52))
def test_a_mutated_file_is_refused_in_a_sentence_or_read(whole, tmp_path, seed):
    path = tmp_path / "roof.3dm"
    path.write_bytes(mutated(whole, seed))
    try:
        model = read_3dm(path)
    except CGCError as refusal:
        assert "roof.3dm" in str(refusal) and "\n" not in str(refusal) and str(refusal).count(";") >= 1
    else:
        # The damage hit nothing that is read: all of the mesh is there.
        assert len(model.problem.vertices) == 81 and len(model.problem.faces) == 128


@pytest.mark.parametrize("share", [0.0, 0.001, 0.3, 0.9, 0.99])
def test_a_file_cut_short_is_never_read_in_part(whole, tmp_path, share):
    path = tmp_path / "roof.3dm"
    path.write_bytes(whole[: int(share * len(whole))])
    with pytest.raises(FileError, match="empty|not a Rhino file|incomplete"):
        read_archive(path)


def test_a_file_of_rhino_1_cannot_be_told_whole_and_is_refused(whole, tmp_path):
    path = tmp_path / "old.3dm"
    path.write_bytes(whole[:24] + b"       1" + whole[32:])
    with pytest.raises(FileError, match="Rhino 1; open it in a newer Rhino"):
        read_archive(path)


@pytest.mark.parametrize("end", ["crash", "hang", "no process"])
def test_what_kills_or_stops_the_reader_is_reported(whole, tmp_path, monkeypatch, end):
    path = tmp_path / "roof.3dm"
    path.write_bytes(whole)
    real = subprocess.run

    def run(command, timeout, **options):
        if end == "no process":
            raise OSError("not allowed")
        code = "import os; os.abort()" if end == "crash" else "import time; time.sleep(60)"
        return real([sys.executable, "-c", code], timeout=0.2 if end == "hang" else timeout, **options)

    monkeypatch.setattr("compas_cgc.io.rhino.archive.subprocess.run", run)
    if end == "no process":
        assert len(read_archive(path).Objects) == 6
    else:
        with pytest.raises(FileError, match="is damaged; open it in Rhino"):
            read_archive(path)


@pytest.mark.skipif(sys.platform == "win32", reason="systems without a limit of processor time")
def test_a_trial_that_has_used_its_processor_time_is_ended(whole, tmp_path, monkeypatch):
    path = tmp_path / "roof.3dm"
    path.write_bytes(whole)
    monkeypatch.setattr(archive, "_TRIAL", archive._TRIAL.replace("import rhino3dm", "while True: pass"))
    monkeypatch.setattr(archive, "TRIAL_SECONDS", 0.2)
    monkeypatch.setattr(archive, "TRIAL_PATIENCE", 1000.0)
    with pytest.raises(FileError, match="is damaged; open it in Rhino"):
        read_archive(path)


def test_a_damaged_dimension_of_a_curve_takes_no_gigabytes(tmp_path):
    model = rhino3dm.File3dm()
    model.Objects.AddCurve(rhino3dm.PolylineCurve([rhino3dm.Point3d(k, k % 2, 0) for k in range(5)]))
    path = tmp_path / "curve.3dm"
    model.Write(str(path), 7)
    parameters = struct.pack("<5d", *range(5))
    content = path.read_bytes()
    assert content.count(parameters + struct.pack("<i", 3)) == 1
    path.write_bytes(content.replace(parameters + struct.pack("<i", 3), parameters + struct.pack("<i", 900_000_000)))
    with pytest.raises(FileError, match="is damaged; open it in Rhino"):
        read_archive(path)


def test_inside_rhino_no_second_rhino_is_started(whole, tmp_path, monkeypatch):
    path = tmp_path / "roof.3dm"
    path.write_bytes(whole)
    monkeypatch.setattr(sys, "executable", "/Applications/Rhinoceros")
    monkeypatch.setattr("compas_cgc.io.rhino.archive.subprocess.run", None)
    assert len(read_archive(path).Objects) == 6


def test_where_rhino3dm_is_missing_the_file_is_not_blamed(whole, tmp_path, monkeypatch):
    (tmp_path / "rhino3dm.py").write_text("raise ImportError")
    (tmp_path / "a.3dm").write_bytes(whole)
    monkeypatch.setenv("PYTHONPATH", str(tmp_path))
    script = "import sys, compas_cgc; compas_cgc.read(sys.argv[1])"
    done = subprocess.run([sys.executable, "-c", script, str(tmp_path / "a.3dm")], capture_output=True, text=True)
    assert "requires rhino3dm; install it: pip install 'compas_cgc[rhino]'" in done.stderr and "damaged" not in done.stderr
