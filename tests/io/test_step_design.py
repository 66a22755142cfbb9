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
from compas_cgc.io import step_process
from compas_cgc.io.occt import opencascade
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
    reader.write_text("#!/bin/sh\nkill -PROF $$\n", encoding="utf-8")
    reader.chmod(0o755)
    monkeypatch.setattr(sys, "executable", str(reader))
    monkeypatch.setattr(step_design, "_slowness", lambda: 10.0)
    with pytest.raises(FileError, match="takes more than 18 s to read"):
        read_step_design(tmp_path / "cushion.step")


def test_slower_computers_get_more_time(monkeypatch):
    assert step_design._slowness() >= 1.0
    monkeypatch.setattr(step_design, "COUNT_SECONDS", 1e-6)
    assert step_design._slowness() > 100.0
    monkeypatch.setattr(step_design, "COUNT_SECONDS", 1e6)
    assert step_design._slowness() == 1.0


@pytest.mark.skipif(sys.platform == "win32", reason="systems without a limit of processor time")
def test_a_reader_is_ended_when_it_has_used_its_processor_time(cushion, tmp_path, monkeypatch):
    (tmp_path / "cushion.step").write_text(cushion, encoding="utf-8")
    monkeypatch.setattr(step_design, "SECONDS", 0.002)
    monkeypatch.setattr(step_design, "SECONDS_PER_BYTE", 0.0)
    monkeypatch.setattr(step_design, "PATIENCE", 1e5)
    with pytest.raises(FileError, match="takes more than .* s to read"):
        read_step_design(tmp_path / "cushion.step")


@pytest.mark.skipif(sys.platform != "linux", reason="limits of memory hold on Linux")
def test_reading_ends_with_a_limit_of_memory(cushion, tmp_path, monkeypatch):
    (tmp_path / "cushion.step").write_text(cushion, encoding="utf-8")
    monkeypatch.setattr(step_design, "MEMORY", 2**20)
    monkeypatch.setattr(step_design, "MEMORY_PER_BYTE", 0)
    with pytest.raises(FileError, match="cannot be read"):
        read_step_design(tmp_path / "cushion.step")


@pytest.mark.parametrize("spoilt", [lambda points, corners: (points, corners[:0]), lambda points, corners: (np.nan * points, corners)])
def test_faces_that_opencascade_leaves_out_are_refused(spoilt, cushion, tmp_path, monkeypatch):
    """For lack of memory, among other reasons, it returns no triangles for a face, or vertices that are no numbers, and no error."""
    (tmp_path / "cushion.step").write_text(cushion, encoding="utf-8")
    occt = opencascade()
    half = {name: getattr(occt, name) for name in dir(occt)}

    def tesselate(*arguments):
        points, corners, edges = occt.tesselate(*arguments)
        return *spoilt(points, corners), edges

    monkeypatch.setattr(step_process, "opencascade", lambda: types.SimpleNamespace(**{**half, "tesselate": tesselate}))
    with pytest.raises(FileError, match="cannot divide all faces"):
        step_process.contents_of_step(tmp_path / "cushion.step")


def test_too_many_triangles_are_avoided_by_a_coarser_division(cushion, tmp_path, monkeypatch):
    (tmp_path / "cushion.step").write_text(cushion, encoding="utf-8")
    usual = step_process.contents_of_step(tmp_path / "cushion.step")
    monkeypatch.setattr(step_process, "MAX_TRIANGLES", len(usual["triangles"]) // 4)
    coarse = step_process.contents_of_step(tmp_path / "cushion.step")
    ratio = len(usual["triangles"]) / len(coarse["triangles"])
    assert 2.5 < ratio < 6.0 and coarse["tolerance"] / usual["tolerance"] == pytest.approx(ratio, rel=0.3)


def written(tmp_path, shape):
    """Write a shape as a STEP file."""
    (path := tmp_path / "shape.step").write_bytes(step_content(shape, "shape"))
    return path


def edges_of(drawn):
    """Return the edges of triangles, one direction for each side, with the number of triangles beside each."""
    corners = drawn.faces[:, :3]
    return np.unique(np.sort(np.stack([corners, np.roll(corners, -1, axis=1)], axis=-1).reshape(-1, 2), axis=1), axis=0, return_counts=True)


def test_one_face_that_is_no_spline_is_divided_into_triangles_that_close_at_its_poles(tmp_path):
    occt = opencascade()
    drawn = read_step_design(written(tmp_path, occt.make_sphere([1.0, 2.0, 3.0], 1000.0)))
    edges, beside = edges_of(drawn)
    assert drawn.spline is None and (beside == 2).all() and len(drawn.vertices) - len(edges) + len(drawn.faces) == 2
    assert np.linalg.norm(drawn.vertices - [1.0, 2.0, 3.0], axis=1) == pytest.approx(1000.0, abs=1e-6)
    centres = drawn.vertices[drawn.faces[:, :3]].mean(axis=1)
    assert (
        1000.0 - np.linalg.norm(centres - [1.0, 2.0, 3.0], axis=1).min() < 2.0 * drawn.tolerance
    )  # OpenCASCADE keeps the deflection along the edges of triangles


def arched_strip(knots, y, width):
    """Return a strip of two quadratic spans beside a parabola over [0, 1] m, whose parameters are split at an inner knot, in mm."""

    def blossom(a, b):
        return (a + b) / 2, 2.0 * (a + b) - 4.0 * a * b

    rows = [[(1e3 * x, 1e3 * side, 300.0 * z, 1.0) for side in (y, y + width)] for x, z in map(blossom, knots[1:-2], knots[2:-1])]
    return NurbsPatch(np.array(rows), (np.array(knots, float), np.array([0, 0, 1, 1.0])), (2, 1))


def test_faces_beside_each_other_share_the_vertices_of_their_common_edge(tmp_path):
    """Their edges are divided at other places unless the faces are sewn."""
    occt = opencascade()
    strips = arched_strip([0, 0, 0, 0.13, 1, 1, 1], 0.0, 1.0), arched_strip([0, 0, 0, 0.71, 1, 1, 1], 1.0, 0.2)
    drawn = read_step_design(written(tmp_path, occt.compound_from_shapes([untrimmed_face(occt, strip) for strip in strips])))
    edges, beside = edges_of(drawn)
    middle = np.abs(drawn.vertices[edges][..., 1] - 1000.0).max(axis=1) < 1e-6
    assert len(drawn.vertices) - len(edges) + len(drawn.faces) == 1
    assert middle.sum() > 10 and (beside[middle] == 2).all()


def test_vertices_of_neighbouring_faces_are_merged(tmp_path):
    occt = opencascade()
    box = occt.make_prism(occt.make_face_polygon([[0.0, 0, 0], [3.0, 0, 0], [3.0, 2, 0], [0.0, 2, 0]]), [0.0, 0.0, 1.0])
    drawn = read_step_design(written(tmp_path, box))
    assert len(drawn.vertices) == 8 and len(drawn.faces) == 12 and (edges_of(drawn)[1] == 2).all()


def test_a_file_of_curves_alone_holds_no_faces(tmp_path):
    occt = opencascade()
    with pytest.raises(FileError, match="holds no faces; export the design as surfaces"):
        read_step_design(written(tmp_path, occt.make_edge_point_point([0.0, 0.0, 0.0], [1.0, 0.0, 0.0])))


def test_faces_crowded_within_the_distance_of_merging_are_refused():
    points = np.random.default_rng(0).uniform(0.0, 1e-6, (300, 3))
    with pytest.raises(FileError, match="too small for its size; remove what lies far"):
        step_design._merged(points, np.arange(300).reshape(-1, 3), 1e-5)
