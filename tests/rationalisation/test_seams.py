"""Seams along curves and level lines, on designs with a rim of their own and holes."""

from __future__ import annotations

import numpy as np
import pytest

from compas_cgc.discrete import edge_faces
from compas_cgc.discrete import face_areas
from compas_cgc.errors import MeshError
from compas_cgc.meshing import boundary_loops
from compas_cgc.rationalisation import read_design
from compas_cgc.rationalisation.level_seams import level_seams
from compas_cgc.rationalisation.seams import panels_of

from ..support.freeform import bumpy
from ..support.freeform import mesh_over


def heights(x, y):
    return 1.5 - 0.04 * (x - 5.0) ** 2 - 0.03 * (y - 4.0) ** 2


@pytest.fixture(scope="module")
def plate():
    """A roof over an ellipse with a round hole."""
    vertices, faces = mesh_over(heights, 10.0, 8.0, 0.2)
    middle = vertices[np.array(faces)].mean(axis=1)[:, :2]
    inside = (((middle - [5.0, 4.0]) / [4.8, 3.8]) ** 2).sum(axis=1) < 1.0
    inside &= np.linalg.norm(middle - [4.0, 4.0], axis=1) > 1.0
    return read_design((vertices, [face for face, own in zip(faces, inside) if own]))


@pytest.mark.nightly
def test_a_mesh_follows_a_drawn_seam_around_a_hole(plate):
    assert plate.trimmed and len(plate.rims) == 2
    y = np.linspace(-1.0, 9.0, 60)
    x = 6.5 + 0.4 * np.sin(0.8 * y)
    panelling = panels_of(plate, None, None, [np.column_stack([x, y, heights(x, y)])])
    assert panelling.panel_count == 2 and len(boundary_loops(panelling.faces)) == 2
    on = panelling.vertices[np.unique(panelling.seams)]
    edge = float(np.median(np.linalg.norm(np.diff(panelling.vertices[panelling.faces[:, :2]], axis=1), axis=2)))
    # Chords of the seam are away from it by their sagitta, .4 x .64 h^2 / 8 at most.
    assert np.abs(on[:, 0] - 6.5 - 0.4 * np.sin(0.8 * on[:, 1])).max() < 0.2 * edge**2
    assert np.abs(on[:, 2] - heights(on[:, 0], on[:, 1])).max() < 2e-3


@pytest.mark.nightly
def test_a_grid_is_cut_at_the_rim(plate):
    panelling = panels_of(plate, 2.5, 4)
    edges = edge_faces(panelling.faces)
    assert len(boundary_loops(panelling.faces)) == 2
    assert 8 < panelling.panel_count < 24
    assert (edges[:, 2] >= 0).all()


@pytest.mark.parametrize("side", [5.0, 5.1])
def test_a_grid_leaves_no_strips_beside_the_inner_sides_of_an_l(side):
    vertices, faces = mesh_over(heights, 10.0, 8.0, 0.1)
    middle = vertices[np.array(faces)].mean(axis=1)[:, :2]
    inside = (middle[:, 0] < side) | (middle[:, 1] < 4.0)
    design = read_design((vertices, [face for face, own in zip(faces, inside) if own]))
    panelling = panels_of(design, 1.0, 4)
    areas = np.bincount(panelling.panels, face_areas(panelling.vertices, panelling.faces))
    assert areas.min() > 0.2 and len(panelling.vertices) < 20 * panelling.panel_count


@pytest.mark.parametrize("corner, count", [(0.1, 2), (3.0, 3)])
def test_a_seam_that_only_cuts_a_sliver_off_is_left_out(corner, count):
    design = read_design(mesh_over(heights, 10.0, 8.0, 0.5))

    def line(*places):
        t = np.linspace(0.0, 1.0, 30)[:, None]
        x, y = ((1.0 - t) * places[0] + t * places[1]).T
        return np.column_stack([x, y, heights(x, y)])

    middle = line(np.array([5.0, 0.0]), np.array([5.0, 8.0]))
    panelling = panels_of(design, None, None, [middle, line(np.array([0.0, 8.0 - corner]), np.array([corner, 8.0]))])
    assert panelling.panel_count == count
    # What is left of the seams is where it was drawn.
    on = panelling.vertices[np.unique(panelling.seams)]
    away = np.minimum(np.abs(on[:, 0] - 5.0), np.abs(on[:, 1] - on[:, 0] - 8.0 + corner) / np.sqrt(2.0))
    assert away.max() < 1e-3


def test_a_seam_away_from_the_design_is_refused_with_its_place():
    design = read_design(mesh_over(heights, 10.0, 8.0, 1.0))
    with pytest.raises(MeshError, match=r"a seam is .* away from the design at \(5, .*, 30\); draw it on the surface"):
        panels_of(design, None, None, [np.array([[5.0, 1.0, heights(5.0, 1.0)], [5.0, 4.0, 30.0], [5.0, 7.0, heights(5.0, 7.0)]])])


def test_level_lines_run_half_way_between_clusters_of_the_curvature():
    design = read_design(mesh_over(bumpy("soft", 1), edge=1.0))
    lines = level_seams(design.surface, 3)
    assert lines
    for line in lines:
        K = design.surface.gaussian(line)
        assert np.std(K) < 0.3 * np.abs(K).max() + 1e-4


def test_level_lines_divide_nearly_flat_saddles_too():
    """Saddles of a hundredth of the largest K, which clusters of K itself would leave in one region."""
    design = read_design(mesh_over(bumpy("soft", 1), edge=1.0))
    K = np.array([np.median(design.surface.gaussian(line)) for line in level_seams(design.surface, 6)])
    assert (K < 0.0).sum() >= 2 and K.max() > 10.0 * np.abs(K.min())


@pytest.mark.nightly
def test_no_region_between_level_lines_has_hills_and_bowls():
    design = read_design(mesh_over(bumpy("soft", 705), edge=1.0))
    panelling = panels_of(design, None, None, "levels", 5)
    middle = panelling.parameters[panelling.faces].mean(axis=1)
    curvatures = design.surface.principal(middle)[0]
    area = face_areas(panelling.vertices, panelling.faces)
    raised = curvatures.prod(axis=1) > 1e-5
    parts = [np.bincount(panelling.panels, area * (raised & (sign * curvatures.sum(axis=1) > 0.0))) for sign in (1.0, -1.0)]
    assert np.minimum(*parts).max() < 0.002 * area.sum()


def test_the_faces_of_a_quad_mesh_are_the_panels():
    vertices, quads = mesh_over(heights, 10.0, 8.0, 2.0)
    # Shear the plan, so that no seam lies along it.
    vertices = np.column_stack([vertices[:, 0] + 0.2 * vertices[:, 1], vertices[:, 1], vertices[:, 2]])
    design = read_design((vertices, quads), tolerance=1e-3)
    panelling = panels_of(design, None, 4, "faces")
    assert panelling.panel_count == len(quads) and len(panelling.faces) == 32 * len(quads)
    corners = np.column_stack([vertices[:, :2], np.zeros(len(vertices))])
    seams = panelling.vertices[panelling.seams.ravel()]
    sides = {tuple(sorted(side)) for quad in quads for side in zip(quad, quad[1:] + quad[:1])}
    ends = corners[np.array(sorted(sides))]
    along = ends[:, 1] - ends[:, 0]
    off = seams[:, None, :2] - ends[None, :, 0, :2]
    across = np.abs(off[..., 0] * along[:, 1] - off[..., 1] * along[:, 0]) / np.linalg.norm(along, axis=1)
    assert across.min(axis=1).max() < 1e-6
    with pytest.raises(MeshError, match="quads"):
        panels_of(read_design((vertices, [[a, b, c] for a, b, c, _ in quads] + [[a, c, d] for a, _, c, d in quads])), None, 4, "faces")
