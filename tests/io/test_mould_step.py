"""STEP files of moulds: named faces of the moulds, of panels on them and of panels in place."""

from __future__ import annotations

import re
from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from scipy.interpolate import CubicSpline
from scipy.spatial import cKDTree

import compas_cgc
from compas_cgc.cli import main
from compas_cgc.discrete import face_areas
from compas_cgc.fabrication import moulds
from compas_cgc.fabrication import panels
from compas_cgc.fabrication.mould_patches import ACCURACY
from compas_cgc.fabrication.revolution import revolution
from compas_cgc.io import read_problem
from compas_cgc.io.builds import write_mould_files
from compas_cgc.io.opencascade import step_content
from compas_cgc.io.opencascade import untrimmed_face
from compas_cgc.rationalisation import SplineSurface

from ..support.roofs import irregular_disk

occt = pytest.importorskip("compas_occt._occt")
FACE, EDGE = 4, 6


@cache
def solved(sample):
    return compas_cgc.solve(compas_cgc.read(compas_cgc.get(f"{sample}.3dm")), settings={"measure": "exact"})


def area(face):
    """Return the area of a face by triangles [m^2]; the integration of OpenCASCADE is not precise on rational surfaces."""
    vertices, faces, _ = occt.tesselate(face, 5.0, 0.1)
    return 1e-6 * face_areas(np.asarray(vertices).reshape(-1, 3), np.asarray(faces).reshape(-1, 3)).sum()


def centre(face):
    """Return the centroid of a face by triangles [mm]."""
    vertices, faces, _ = occt.tesselate(face, 5.0, 0.1)
    vertices, faces = np.asarray(vertices).reshape(-1, 3), np.asarray(faces).reshape(-1, 3)
    near = vertices - vertices[0]
    return vertices[0] + np.average(near[faces].mean(axis=1), axis=0, weights=face_areas(near, faces))


def free_edges(shape, faces):
    """Return the number of edges of some faces that belong to one face."""
    edges = [edge for face in faces for edge in occt.shape_explore(face, EDGE)]
    return sum(len(occt.ancestors(shape, edge, EDGE, FACE)) == 1 for edge in edges)


@pytest.mark.parametrize(("sample", "size"), [("vault", 3.0), ("canopy", 3.0), ("facade", 3.0)])
def test_moulds_and_panels_are_named_faces(sample, size, tmp_path):
    result = solved(sample)
    report = moulds(result, panels(result, size))
    path = tmp_path / "moulds.step"
    assert write_mould_files(path, result.problem, report) == []
    names = re.findall(r"ADVANCED_FACE\('([^']*)'", path.read_text(encoding="utf-8"))
    shape = occt.read_step(str(path))
    faces = occt.shape_explore(shape, FACE)
    assert len(names) == len(faces) == 3 + 2 * len(report.panels) and all(map(occt.is_valid, faces))
    own = dict(zip(names, faces))
    (mould,) = report.moulds
    root = np.sqrt(abs(mould.K))
    cap = {1: lambda x: 2 * (1 - np.cos(x)), 0: lambda x: x * x, -1: lambda x: 2 * (np.cosh(x) - 1)}[int(np.sign(mould.K))]
    unit = root or 1.0
    assert area(own["mould 1"]) == pytest.approx(np.pi * cap(unit * mould.radius) / unit**2, rel=2e-3)
    for side, sign in (("lower", -1.0), ("upper", 1.0)):
        # By Steiner's formula the areas differ by offset² K, and by the mean curvature, which has one sign on spheres.
        beside = area(own[f"{side} face on mould 1"]) / area(own["mould 1"])
        assert beside == pytest.approx((1.0 + sign * 0.003 * root) ** 2 if mould.K > 0.0 else 1.0, rel=1e-4)
    for fit in report.panels:
        # The triangles of the mesh are inscribed.
        assert area(own[f"panel {fit.panel.name} on mould 1"]) == pytest.approx(face_areas(fit.on_mould, fit.faces).sum(), rel=3e-3)
        assert area(own[f"panel {fit.panel.name} in place"]) == pytest.approx(face_areas(fit.vertices, fit.faces).sum(), rel=5e-3)
    in_place = [face for name, face in own.items() if name.endswith("in place")]
    assert 0 < free_edges(shape, in_place) < sum(len(occt.shape_explore(face, EDGE)) for face in in_place) / 2


def test_moulds_of_a_georeferenced_roof_are_valid_faces_in_their_place(tmp_path):
    result = solved("facade")
    away = np.array([691_234.5, 5_334_321.25, 520.0])
    report = moulds(result, panels(result, 3.0))
    far = replace(result.problem, vertices=result.problem.vertices + away)
    shapes = []
    for name, problem, made in (("near", result.problem, report), ("far", far, moulds(far, panels(far, 3.0)))):
        path = tmp_path / f"{name}.step"
        assert write_mould_files(path, problem, made) == []
        shapes.append(occt.shape_explore(occt.read_step(str(path)), FACE))
    assert all(map(occt.is_valid, shapes[1])) and len(shapes[0]) == len(shapes[1])
    # Surfaces of moulds are rational.
    near, there = (np.array([*map(centre, faces[:3]), *map(occt.centroid, faces[3:])]) for faces in shapes)
    assert there == pytest.approx(near + 1e3 * away, abs=0.01, rel=0)


@pytest.mark.parametrize(("sample", "size"), [pytest.param("cushion", 3.0, marks=pytest.mark.nightly), ("canopy", 3.0)])
def test_moulds_of_least_bending_are_faces_with_the_area_of_their_cap(sample, size, tmp_path):
    result = solved(sample)
    report = moulds(result, panels(result, size), least_bending=True)
    path = tmp_path / "moulds.step"
    write_mould_files(path, result.problem, report)
    names = re.findall(r"ADVANCED_FACE\('([^']*)'", path.read_text(encoding="utf-8"))
    own = dict(zip(names, occt.shape_explore(occt.read_step(str(path)), FACE)))
    (mould,) = report.moulds
    assert mould.kind in ("spindle", "bulge", "hyperboloid") and all(map(occt.is_valid, own.values()))
    root = np.sqrt(abs(mould.K))
    cap = 2 * np.pi / mould.K * (1 - (np.cos if mould.K > 0 else np.cosh)(root * mould.radius))
    assert area(own["mould 1"]) == pytest.approx(cap, rel=2e-3)
    for fit in report.panels:
        assert area(own[f"panel {fit.panel.name} on mould 1"]) == pytest.approx(face_areas(fit.on_mould, fit.faces).sum(), rel=5e-3)


@pytest.mark.parametrize(
    ("kind", "K", "size", "ends"),
    [
        ("plane", 0.0, 0.0, (0.0, 3.0)),
        ("cylinder", 0.0, 5.0, (0.0, 6.0)),
        ("cone", 0.0, 0.5, (1.0, 6.0)),
        ("sphere", 0.04, 0.0, (-4.0, 5.0)),
        ("spindle", 0.04, 3.0, (-5.0, 5.0)),
        ("bulge", 0.04, 7.0, (-3.0, 3.0)),
        ("pseudosphere", -0.04, 0.0, (0.05, 6.0)),
        ("hyperboloid", -0.04, 3.0, (-4.0, 4.0)),
        ("conic", -0.04, 0.5, (1.0, 5.0)),
    ],
)
def test_surfaces_of_revolution_are_valid_faces_on_their_exact_meridian(kind, K, size, ends, tmp_path):
    own = revolution(kind, K, size)
    patch = own.patch(ends, (0.0, 1.2), 5.0 * ACCURACY)
    path = tmp_path / "surface.step"
    path.write_bytes(step_content(untrimmed_face(occt, patch.scaled(1e3)), kind))
    assert occt.is_valid(occt.read_step(str(path)))
    surface = SplineSurface(patch.control, patch.knots, patch.degrees)
    across = [np.linspace(low, high, 101) for low, high in surface.domain]
    x, y, z = surface.at(np.stack(np.meshgrid(*across, indexing="ij"), axis=-1).reshape(-1, 2)).T
    points = np.column_stack([np.hypot(x, y), z])
    s = np.linspace(*ends, 4001)
    meridian = CubicSpline(s, np.column_stack([own.radii(s), own.heights(s)]))
    place = s[cKDTree(meridian(s)).query(points)[1]]
    for _ in range(4):
        tangent = meridian(place, 1)
        place = np.clip(place + ((points - meridian(place)) * tangent).sum(axis=1) / (tangent**2).sum(axis=1), *ends)
    assert np.linalg.norm(points - meridian(place), axis=1).max() < (1e-9 * K**-0.5 if kind == "sphere" else 1e-6)


def test_the_command_writes_step_and_the_same_surface_gives_the_same_bytes(tmp_path):
    solved = tmp_path / "solved.3dm"
    assert main(["solve", compas_cgc.get("vault.3dm"), "-o", str(solved), "-q"]) == 0
    assert main(["mould", str(solved), "-o", str(tmp_path / "one.step"), "--size", "4", "--material", "gfrp", "--no-page", "-q"]) == 0
    problem = read_problem(solved, result=True).checked()
    write_mould_files(tmp_path / "other.step", problem, moulds(problem, panels(problem, 4.0)))
    assert (tmp_path / "one.step").read_bytes() == (tmp_path / "other.step").read_bytes()


@pytest.mark.parametrize("size", [pytest.param(1.1, marks=pytest.mark.nightly), 1.6])
def test_panels_along_a_closed_rim_are_valid_faces(size, tmp_path):
    """Joints cross an irregular mesh at any distances, and panels along the rim pass the ends of its two curves."""
    flat = irregular_disk(160, radius=4.0)
    vertices = flat.vertices.copy()
    vertices[:, 2] = np.sqrt(100.0 - (vertices[:, :2] ** 2).sum(axis=1)) - np.sqrt(84.0)
    problem = flat.with_vertices(vertices)
    report = moulds(problem, panels(problem, size), rough=True)
    path = tmp_path / "moulds.step"
    assert write_mould_files(path, problem, report) == []
    names = re.findall(r"ADVANCED_FACE\('([^']*)'", path.read_text(encoding="utf-8"))
    own = dict(zip(names, occt.shape_explore(occt.read_step(str(path)), FACE)))
    assert all(map(occt.is_valid, own.values()))
    for fit in report.panels:
        # The rim is a smooth curve through the corners of the mesh.
        assert area(own[f"panel {fit.panel.name} in place"]) == pytest.approx(face_areas(fit.vertices, fit.faces).sum(), rel=0.06)
