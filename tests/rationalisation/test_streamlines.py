"""Lines of curvature and geodesics at a spacing."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.spatial import cKDTree

import compas_cgc
from compas_cgc.errors import MeshError
from compas_cgc.rationalisation import read_design
from compas_cgc.rationalisation.streamlines import even_lines

from ..support.freeform import mesh_over
from ..support.freeform import quarter_torus


@pytest.fixture(scope="module")
def surface():
    """A translational surface that bends twice as much along x, turned in plan."""

    def heights(x, y):
        return 3.0 - 0.06 * (x - 6.0) ** 2 - 0.02 * (y - 4.0) ** 2 + 0.01 * (x - 6.0) * (y - 4.0)

    return read_design(mesh_over(heights, 12.0, 8.0, 0.25)).surface


def inner(surface, lines):
    """Yield points along lines, their unit tangents and normals, where a line is inside the domain."""
    low, high = surface.domain.T
    for line in lines:
        # The last steps of a line that ends at another one are shorter.
        line = line[2:-2]
        uv = line[((line > low + 0.3) & (line < high - 0.3)).all(axis=1)]
        if len(uv) > 6:
            points = surface.at(uv)
            steps = np.diff(points, axis=0)
            yield points, steps / np.linalg.norm(steps, axis=1)[:, None], surface.normals(uv)


def test_normals_turn_along_lines_of_curvature(surface):
    """Rodrigues: along a line of curvature the normal changes in the direction of the line."""
    twists = []
    for _, tangents, normals in inner(surface, even_lines(surface, "curvature", 1.5)):
        change = np.diff(normals, axis=0)
        twists.append(np.linalg.norm(np.cross(change, tangents), axis=1) / np.maximum(np.linalg.norm(change, axis=1), 1e-12))
    assert len(twists) >= 8
    # The crosses are averaged over one spacing, so lines deviate where directions turn.
    assert np.median(np.concatenate(twists)) < 0.1


def test_geodesics_do_not_turn_within_the_surface(surface):
    turns = []
    for points, tangents, normals in inner(surface, even_lines(surface, "geodesics", 1.5)):
        sideways = np.cross(normals[1:-1], tangents[1:])
        turns.append(np.abs((np.diff(tangents, axis=0) * sideways).sum(axis=1)) / np.linalg.norm(points[2:] - points[1:-1], axis=1))
    assert len(turns) >= 8
    assert np.concatenate(turns).max() < 1e-3, "geodesic curvature"


@pytest.mark.parametrize("kind", ["curvature", "geodesics"])
def test_lines_keep_their_distance_and_leave_no_gaps(surface, kind):
    spacing = 1.5
    low, high = surface.domain.T
    points = [surface.at(np.clip(line, low, high)) for line in even_lines(surface, kind, spacing)]
    uv = np.random.default_rng(0).uniform(low + 0.8, high - 0.8, (300, 2))
    gap = cKDTree(np.concatenate(points)).query(surface.at(uv))[0]
    assert gap.max() < 1.2 * spacing and np.median(gap) > 0.05 * spacing


def test_a_design_is_divided_along_lines_and_rationalised():
    mesh = mesh_over(lambda x, y: 3.0 - 0.06 * (x - 6.0) ** 2 - 0.02 * (y - 4.0) ** 2, 12.0, 8.0, 0.5)
    found = compas_cgc.rationalise(mesh, panel=2.5, edges=4, moulds=3, seams="curvature")
    assert found.result.converged and found.result.verdict.fair and found.distance.largest < 0.05
    assert 12 <= found.panelling.panel_count <= 36
    with pytest.raises(MeshError, match="close"):
        compas_cgc.rationalise(quarter_torus(), panel=2.0, seams="geodesics")
