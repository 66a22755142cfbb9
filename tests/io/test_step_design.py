"""Designs of STEP files: untrimmed surfaces exactly, trimmed faces by triangles."""

from __future__ import annotations

import math
import re
import sys
import types

import numpy as np
import pytest

import compas_cgc
from compas_cgc import CGCMesh
from compas_cgc.discrete.nurbs import NurbsPatch
from compas_cgc.errors import CGCError
from compas_cgc.errors import FileError
from compas_cgc.io import step_design
from compas_cgc.io.opencascade import opencascade
from compas_cgc.io.opencascade import step_content
from compas_cgc.io.opencascade import untrimmed_face
from compas_cgc.io.step_design import read_step_design
from compas_cgc.rationalisation import read_design
from tests.support.freeform import quarter_torus

pytest.importorskip("compas_occt")


def test_an_untrimmed_rational_surface_is_read_exactly(tmp_path):
    torus = quarter_torus()
    half = NurbsPatch(torus.control[:, :5], (torus.knots[0], np.array([0, 0, 0, 1, 1, 2, 2, 2.0])), torus.degrees)
    path = tmp_path / "torus.step"
    path.write_bytes(step_content(untrimmed_face(opencascade(), half.scaled(1e3)), "torus"))
    design = read_design(path)
    assert design.drawing.units == "Millimeters" and not design.trimmed
    u, v = np.linspace(0, 1, 9), np.linspace(0, 2, 11)
    found = NurbsPatch(design.surface.control, design.surface.knots, design.surface.degrees).at(u, v)
    assert np.abs(found - 1e3 * half.at(u, v)).max() < 1e-8


@pytest.fixture(scope="module")
def roof(tmp_path_factory):
    """A solved roof of several faces, and its STEP file."""
    result = compas_cgc.solve(compas_cgc.read(compas_cgc.get("cushion.3dm")))
    path = tmp_path_factory.mktemp("roof") / "roof.step"
    compas_cgc.write(path, result)
    return result, path


def test_a_shell_of_trimmed_faces_is_one_design(roof, monkeypatch):
    result, path = roof
    drawn = read_step_design(path)
    size = 1e3 * np.linalg.norm(np.ptp(result.vertices, axis=0))
    assert drawn.spline is None and np.linalg.norm(np.ptp(drawn.vertices, axis=0)) == pytest.approx(size, rel=1e-3)
    # The file is read once; the next test reads one by `read_design`.
    monkeypatch.setattr(step_design, "read_step_design", lambda path: drawn)
    design = read_design(path)
    # The rim is the rectangle of the plan.
    assert not design.trimmed and design.deviation < 1e-4 * size


def test_a_face_with_a_round_rim_is_a_trimmed_design(tmp_path):
    angles = np.linspace(0.0, 2.0 * np.pi, 25)[:-1]
    mesh = CGCMesh.from_outline((5.0 * np.column_stack([np.cos(angles), np.sin(angles)])).tolist(), edge_length=0.8)
    mesh.set_supports("boundary")
    mesh.set_target(0.02)
    result = compas_cgc.solve(mesh)
    compas_cgc.write(tmp_path / "dome.step", result)
    design = read_design(tmp_path / "dome.step")
    size = 1e3 * np.linalg.norm(np.ptp(result.vertices, axis=0))
    assert design.trimmed and design.deviation < 1e-4 * size


def test_files_without_a_design_get_one_sentence(tmp_path):
    garbage = tmp_path / "garbage.step"
    garbage.write_text("ISO-10303-21;\nnothing\n", encoding="utf-8")
    with pytest.raises(FileError, match=r"garbage\.step (holds no faces|cannot be read)"):
        read_design(garbage)
    with pytest.raises(FileError, match="there is no file"):
        read_design(tmp_path / "missing.step")
    with pytest.raises(CGCError, match="seams on a layer need"):
        read_design(garbage, seams="Joints")


def test_a_surface_beyond_all_bounds_is_refused_with_a_sentence(roof, tmp_path):
    text = roof[1].read_text(encoding="utf-8")
    pole = text.index("CARTESIAN_POINT('',(", text.index("B_SPLINE_SURFACE")) + len("CARTESIAN_POINT('',(")
    (tmp_path / "far.step").write_text(text[:pole] + "1.E308" + text[text.index(",", pole) :], encoding="utf-8")
    with pytest.raises(FileError, match=r"far\.step holds faces that are not valid"):
        read_step_design(tmp_path / "far.step")


@pytest.fixture(scope="module")
def cushion(tmp_path_factory):
    """Text of a STEP file of one trimmed face."""
    path = tmp_path_factory.mktemp("step") / "cushion.step"
    mesh = CGCMesh.from_meshgrid(dx=5, nx=6)
    mesh.set_supports("boundary")
    mesh.set_target(0.05)
    compas_cgc.write(path, compas_cgc.solve(mesh))
    return path.read_text(encoding="utf-8")


def moved(text, entity, index, x):
    """Return a STEP file in which a pole of the first curve or surface has another first coordinate."""
    start = text.index(entity)
    poles = re.findall(r"#\d+", text[start : text.index(".UNSPECIFIED.", start)])
    return re.sub(rf"({poles[index]} = CARTESIAN_POINT\('',\()[^,]*", rf"\g<1>{x}", text, count=1)


def middle_pole(text):
    """Return the index of the pole in the middle of the first surface of a STEP file, which has as many rows as columns."""
    start = text.index("B_SPLINE_SURFACE")
    rows = math.isqrt(len(re.findall(r"#\d+", text[start : text.index(".UNSPECIFIED.", start)])))
    return (rows // 2) * rows + rows // 2


def test_a_spike_does_not_multiply_the_triangles(cushion, tmp_path):
    (tmp_path / "cushion.step").write_text(cushion, encoding="utf-8")
    (tmp_path / "spike.step").write_text(moved(cushion, "B_SPLINE_SURFACE", middle_pole(cushion), "4.E4"), encoding="utf-8")
    smooth, spike = (read_step_design(tmp_path / f"{name}.step") for name in ("cushion", "spike"))
    assert len(spike.faces) < 2 * len(smooth.faces)


def test_edges_far_from_their_faces_are_refused(cushion, tmp_path):
    (tmp_path / "edge.step").write_text(moved(cushion, "B_SPLINE_CURVE", 0, "9.E3"), encoding="utf-8")
    with pytest.raises(FileError, match=r"edge\.step (cannot be read, as OpenCASCADE fails on it|holds faces that are not valid)"):
        read_step_design(tmp_path / "edge.step")


def test_reading_ends_with_a_limit_of_time(cushion, tmp_path, monkeypatch):
    (tmp_path / "cushion.step").write_text(cushion, encoding="utf-8")
    monkeypatch.setattr(step_design, "PATIENCE", 0.0)
    with pytest.raises(FileError, match="was not read within 0 s, as this computer is too busy"):
        read_step_design(tmp_path / "cushion.step")


@pytest.mark.skipif(sys.platform == "win32", reason="systems without a limit of processor time")
def test_a_reader_that_has_used_its_processor_time_is_said(cushion, tmp_path, monkeypatch):
    (tmp_path / "cushion.step").write_text(cushion, encoding="utf-8")
    reader = tmp_path / "python"
    reader.write_text("#!/bin/sh\nkill -XCPU $$\n", encoding="utf-8")
    reader.chmod(0o755)
    monkeypatch.setattr(sys, "executable", str(reader))
    with pytest.raises(FileError, match="takes more than [67] s to read"):
        read_step_design(tmp_path / "cushion.step")


@pytest.mark.skipif(sys.platform != "linux", reason="limits of memory hold on Linux")
def test_reading_ends_with_a_limit_of_memory(cushion, tmp_path, monkeypatch):
    (tmp_path / "cushion.step").write_text(cushion, encoding="utf-8")
    monkeypatch.setattr(step_design, "MEMORY", 2**20)
    monkeypatch.setattr(step_design, "MEMORY_PER_BYTE", 0)
    with pytest.raises(FileError, match="cannot be read"):
        read_step_design(tmp_path / "cushion.step")


def test_faces_that_opencascade_leaves_out_are_refused(cushion, tmp_path, monkeypatch):
    """For lack of memory, among other reasons, it returns no triangles for a face, and no error."""
    (tmp_path / "cushion.step").write_text(cushion, encoding="utf-8")
    occt = step_design.opencascade()
    half = {name: getattr(occt, name) for name in dir(occt)}

    def tesselate(*arguments):
        points, corners, edges = occt.tesselate(*arguments)
        return points, corners[:0], edges

    monkeypatch.setattr(step_design, "opencascade", lambda: types.SimpleNamespace(**{**half, "tesselate": tesselate}))
    with pytest.raises(FileError, match="cannot divide all faces"):
        step_design._read(tmp_path / "cushion.step")
