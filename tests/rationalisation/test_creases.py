"""Sharp edges of designs: meshes with ridges that go through, cross or end inside, kinks of NURBS surfaces, towers with corners."""

from __future__ import annotations

import numpy as np
import pytest

import compas_cgc
from compas_cgc.discrete import edge_faces
from compas_cgc.discrete import face_areas
from compas_cgc.meshing import triangles_of
from compas_cgc.rationalisation import SplineSurface
from compas_cgc.rationalisation import read_design
from compas_cgc.rationalisation.seams import panels_of
from compas_cgc.rationalisation.sharp_edges import sharp_edges

from ..support.freeform import bumpy
from ..support.freeform import mesh_over

LENGTH, WIDTH, SLOPE = 12.0, 8.0, np.tan(np.radians(15.0))


def smooth(x, y):
    return 2.0 - 0.02 * (x - 6.0) ** 2 - 0.03 * (y - 4.0) ** 2 + 0.1 * np.exp(-((x - 3.0) ** 2 + (y - 3.0) ** 2) / 4.0)


def oblique(x, y):
    """A ridge of 30 degrees on the line x = 5 + y / 4."""
    return smooth(x, y) - SLOPE * np.abs(x - 5.0 - 0.25 * y) / np.hypot(1.0, 0.25)


def pyramid(x, y):
    """Four ridges that meet over (6, 4)."""
    return smooth(x, y) - 0.4 * np.maximum(np.abs(x - 6.0), np.abs(y - 4.0))


def fading(x, y, end=5.5, width=3.5):
    """A ridge on the line x = 6 that ends where y = 5.5."""
    part = np.clip((end - y) / (end - 1.0), 0.0, 1.0)
    return smooth(x, y) - SLOPE * part**2 * (3.0 - 2.0 * part) * np.abs(x - 6.0) * np.exp(-(((x - 6.0) / width) ** 2))


def mesh(heights, divisions=48):
    """Return a mesh whose edges follow the ridge of a design."""
    vertices, quads = mesh_over(smooth, LENGTH, WIDTH, LENGTH / divisions)
    x, y = vertices[:, 0].copy(), vertices[:, 1]
    if heights is oblique:
        ridge = 5.0 + 0.25 * y
        x = np.where(x < 6.0, x / 6.0 * ridge, ridge + (x - 6.0) / 6.0 * (LENGTH - ridge))
    vertices = np.column_stack([x, y, heights(x, y)])
    if heights is not pyramid:
        return vertices, quads
    triangles = []
    for a, b, c, d in quads:
        middle = vertices[[a, b, c, d], :2].mean(axis=0)
        first = (middle[0] < 6.0) == (middle[1] < 4.0)
        triangles += [[a, b, c], [a, c, d]] if first else [[a, b, d], [b, c, d]]
    return vertices, triangles


CASES = {"oblique": (oblique, 1, 8.246), "pyramid": (pyramid, 4, 4 * 5.657), "fading": (fading, 1, 5.0)}


@pytest.mark.parametrize("name", CASES)
def test_a_mesh_keeps_its_sharp_edges(name):
    heights, count, length = CASES[name]
    design = read_design(mesh(heights), tolerance=2e-3)
    assert not design.notes and len(design.creases) == count
    assert abs(sum(np.linalg.norm(np.diff(line, axis=0), axis=1).sum() for line in design.creases) - length) < 0.6
    places = np.random.default_rng(0).uniform([0.0, 0.0], [LENGTH, WIDTH], (4000, 2))
    points = design.surface.at(places)
    off = np.abs(points[:, 2] - heights(points[:, 0], points[:, 1]))
    # A crease is rounded close to its end.
    assert np.quantile(off, 0.99) < 1e-3 and off.max() < (5e-3 if name == "fading" else 2e-3)


@pytest.mark.parametrize("name", ("oblique", "pyramid"))
def test_the_surface_folds_at_a_crease_and_has_no_gap_there(name):
    heights = CASES[name][0]
    surface = read_design(mesh(heights)).surface
    t = np.linspace(0.05, 0.45, 60)[:, None]
    start, end = ([5.0, 0.0], [7.0, 8.0]) if name == "oblique" else ([2.0, 0.0], [10.0, 8.0])
    places = (1.0 - t) * start + t * end
    across = np.array([end[1] - start[1], start[0] - end[0]]) / np.hypot(*np.subtract(end, start))
    left, right = surface.normals(places - 1e-3 * across), surface.normals(places + 1e-3 * across)
    step = 1e-3

    def normals(own):
        x, y = own.T
        slopes = [(heights(x + a, y + b) - heights(x - a, y - b)) / 1e-6 for a, b in ((5e-7, 0.0), (0.0, 5e-7))]
        made = np.column_stack([-slopes[0], -slopes[1], np.ones(len(x))])
        return made / np.linalg.norm(made, axis=1)[:, None]

    for own, side in ((left, -step), (right, step)):
        assert np.degrees(np.arccos(np.clip((own * normals(places + side * across)).sum(axis=1), -1.0, 1.0))).max() < 1.0
    gaps = surface.at(places + 1e-9 * across) - surface.at(places - 1e-9 * across)
    assert np.linalg.norm(gaps, axis=1).max() < 1e-3


def test_meshes_of_smooth_surfaces_have_no_sharp_edges():
    rng = np.random.default_rng(4)
    rough, quads = mesh_over(bumpy("sharp", 0), edge=1.0)
    noisy = rough + rng.normal(0.0, 0.05, rough.shape)
    turn = np.linspace(0.0, 2.0 * np.pi, 13)[:-1]
    pipe = np.array([[3.0 * np.cos(a), 3.0 * np.sin(a), float(z)] for z in range(6) for a in turn])
    around = [[12 * j + i, 12 * j + (i + 1) % 12, 12 * j + 12 + (i + 1) % 12, 12 * j + 12 + i] for j in range(5) for i in range(12)]
    for vertices, polygons in ((rough, quads), (noisy, quads), (pipe, around)):
        assert not len(sharp_edges(vertices, triangles_of(vertices, polygons)[0]))


@pytest.mark.nightly
@pytest.mark.parametrize("name", CASES)
def test_panels_end_at_creases(name):
    heights = CASES[name][0]
    found = compas_cgc.rationalise(mesh(heights), panel=2.0, moulds=4)
    assert found.result.converged and found.result.verdict.fair and found.distance.largest < 0.02
    folds = found.folds
    # The mesh folds sharply at seams alone: no panel has a crease inside.
    normals = np.cross(*(found.result.vertices[found.result.faces[:, k]] - found.result.vertices[found.result.faces[:, 0]] for k in (1, 2)))
    normals /= np.linalg.norm(normals, axis=1)[:, None]
    edges = edge_faces(found.result.faces)
    inner = edges[(edges[:, 3] >= 0)]
    inside = inner[found.panels[inner[:, 2]] == found.panels[inner[:, 3]]]
    angles = np.degrees(np.arccos(np.clip((normals[inside[:, 2]] * normals[inside[:, 3]]).sum(axis=1), -1.0, 1.0)))
    assert folds.angles.max() > 25.0 and angles.max() < 6.0
    assert folds.beyond()["largest"] < 0.5


@pytest.mark.nightly
def test_triangles_without_area_beside_a_seam_do_not_end_a_search():
    """Seams cut off triangles there, beside which all other stiffness is a rounding error."""
    found = compas_cgc.rationalise(mesh(lambda x, y: fading(x, y, 7.0, 4.5)), panel=2.0, moulds=4)
    assert found.distance.largest < 0.05 and np.isfinite(found.result.vertices).all()


@pytest.mark.nightly
@pytest.mark.parametrize("seams", ("grid", "curvature"))
def test_kinks_of_a_nurbs_surface_are_seams(seams):
    knots = np.array([0.0, 0, 0, 0, 3, 6, 6, 6, 9, 12, 12, 12, 12]), np.array([0.0, 0, 0, 0, 4, 8, 8, 8, 8])
    x, y = np.meshgrid(*(np.array([own[k + 1 : k + 4].mean() for k in range(len(own) - 4)]) for own in knots), indexing="ij")
    z = smooth(x, y) - SLOPE * np.abs(x - 6.0)
    design = read_design(SplineSurface(np.stack([x, y, z, np.ones_like(z)], axis=-1), knots, (3, 3)))
    assert [line.tolist() for line in design.creases] == [[[6.0, 0.0], [6.0, 8.0]]]
    panelling = panels_of(design, 2.0, 4, seams)
    on = panelling.vertices[np.unique(panelling.seams)]
    along = np.sort(on[np.abs(on[:, 0] - 6.0) < 1e-6][:, 1])
    assert along[0] == 0.0 and along[-1] == 8.0 and np.diff(along).max() < 1.0


@pytest.mark.nightly
def test_corners_of_a_tower_are_seams():
    turns, levels = 32, 12
    s = np.arange(turns) * 4.0 / turns
    side = np.minimum(s.astype(int), 3)
    corners = np.array([[3.0, -3.0], [3.0, 3.0], [-3.0, 3.0], [-3.0, -3.0], [3.0, -3.0]])
    outwards = np.array([[1.0, 0.0], [0.0, 1.0], [-1.0, 0.0], [0.0, -1.0]])
    t = (s - side)[:, None]
    ring = (1.0 - t) * corners[side] + t * corners[side + 1] + 0.6 * np.sin(np.pi * t) * outwards[side]
    rows = []
    for level in np.arange(levels + 1) / levels:
        c, w = np.cos(0.1 * level), np.sin(0.1 * level)
        plan = (1.0 + 0.1 * np.sin(np.pi * level)) * ring @ np.array([[c, w], [-w, c]])
        rows.append(np.column_stack([plan, np.full(turns, 10.0 * level)]))
    quads = [
        [turns * j + i, turns * j + (i + 1) % turns, turns * (j + 1) + (i + 1) % turns, turns * (j + 1) + i]
        for j in range(levels)
        for i in range(turns)
    ]
    design = read_design((np.concatenate(rows), quads))
    assert len(design.creases) == 4 and not design.notes
    panelling = panels_of(design, 2.5, 4)
    # No line of the grid runs beside a corner of the tower.
    areas = np.bincount(panelling.panels, face_areas(panelling.vertices, panelling.faces))
    assert len(areas) >= 40 and areas.min() > 0.8 * np.median(areas)
    on = np.unique(panelling.seams)
    ends = np.concatenate([rows[level][turns // 4 * np.arange(4)] for level in (3, 6, 9)])
    gaps = np.linalg.norm(panelling.vertices[on][None] - ends[:, None], axis=2).min(axis=1)
    assert gaps.max() < 0.4, "seams pass the corners of the tower, an edge of the mesh apart"
