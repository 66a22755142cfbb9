"""Regions laid onto sphere, plane and hyperbolic plane: congruent where the surface is exact, and told how far off where not."""

from __future__ import annotations

import numpy as np
import pytest

from compas_cgc import CGCProblem
from compas_cgc import solve
from compas_cgc.fabrication import develop
from compas_cgc.fabrication import lay_out

from ..support.roofs import irregular_disk
from ..support.roofs import nine_regions
from ..support.roofs import obtuse_share
from ..support.shapes import grid
from ..support.shapes import icosphere

EXACT = {"measure": "exact"}


def solved(problem, **settings):
    result = solve(problem, method="projection", settings={**EXACT, **settings})
    assert result.converged, result.message
    return result.problem


def saddle(n: int) -> CGCProblem:
    vertices, faces = grid(n, 15.0)
    return CGCProblem(vertices, faces).with_supports("corners").with_targets(-0.005)


@pytest.mark.parametrize(
    "name, problem",
    [
        ("nine regions", nine_regions(30)),
        ("a saddle in the middle", nine_regions(15, centre=-0.01)),
        ("an irregular dome", irregular_disk(600)),
        ("a saddle", saddle(40)),
    ],
)
def test_a_region_and_its_mould_consist_of_congruent_triangles(name, problem):
    roof = solved(problem)
    if name == "an irregular dome":
        assert obtuse_share(roof.vertices, roof.faces) > 0.25
    for region, K in enumerate(roof.region_targets()):
        laid = develop(roof, region)
        assert laid.K == K and laid.edge_error <= 1e-11 and 1e3 * laid.gap <= 1e-8
        places = laid.places
        if K > 0:
            assert np.abs(np.linalg.norm(places + [0, 0, laid.radius], axis=1) - laid.radius).max() < 1e-13
            ends = laid.faces[:, [0, 1]].T
            long = np.linalg.norm(places[ends[0]] - places[ends[1]], axis=1)
            own = roof.vertices[laid.vertices]
            assert np.allclose(long, np.linalg.norm(own[ends[0]] - own[ends[1]], axis=1), rtol=1e-11)


def pyramid(around: int, rows: int):
    """Return the frustum of a pyramid over a regular polygon, its sides flat."""
    row, k = np.divmod(np.arange(around * rows), around)
    angle, radius = 2 * np.pi * k / around, 1.0 + row / (rows - 1)
    vertices = np.column_stack([radius * np.cos(angle), radius * np.sin(angle), 2.0 - radius])
    a = np.arange(around * (rows - 1))
    b = np.where(a % around == around - 1, a - around + 1, a + 1)
    return vertices, np.vstack([np.column_stack([a, a + around, b + around]), np.column_stack([a, b + around, b])])


@pytest.mark.nightly
@pytest.mark.parametrize("K", [0.005, -0.005])
def test_ten_thousand_vertices(K):
    laid = develop(solved(saddle(100).with_targets(K)))
    assert len(laid.points) > 10_000 and laid.edge_error <= 1e-11 and 1e3 * laid.gap <= 1e-8


def test_a_piece_of_a_sphere_is_laid_where_it_was():
    vertices, faces = icosphere(3, radius=2.0)
    cap = faces[(vertices[faces][:, :, 2] > 0.2).all(axis=1)]
    laid = lay_out(vertices, cap, 0.25)
    there = vertices[laid.vertices] - vertices[laid.vertices].mean(axis=0)
    here = laid.places - laid.places.mean(axis=0)
    u, _, v = np.linalg.svd(here.T @ there)
    assert np.linalg.det(u @ v) == pytest.approx(1.0)  # and not its mirror image
    assert np.abs(here @ (u @ v) - there).max() < 1e-12


def test_a_cone_unrolls_along_a_seam_and_the_gap_does_not_depend_on_where():
    around = 24
    vertices, faces = pyramid(around, 9)
    with pytest.raises(ValueError, match="has a hole and needs a seam"):
        lay_out(vertices, faces, 0.0)
    with pytest.raises(ValueError, match="the seam from vertex 0 to 30 does not follow an edge"):
        lay_out(vertices, faces, 0.0, seam=[0, 30])
    with pytest.raises(ValueError, match="does not open"):
        lay_out(vertices, faces, 0.0, seam=[0, around])
    ways = [lay_out(vertices, faces, 0.0, seam="auto"), lay_out(vertices, faces, 0.0, seam=[row * around for row in range(9)])]
    for laid in ways:
        assert len(laid.points) == len(vertices) + 9
        assert laid.gap < 1e-13 and laid.edge_error < 1e-13
        assert np.array_equal(np.sort(np.unique(laid.vertices)), np.arange(len(vertices)))


def test_what_is_not_exact_is_told_by_its_gap():
    problem = nine_regions(15)
    rough = develop(solve(problem, method="projection").problem, 4)
    assert 1e-7 < rough.gap < 1e-3
    by_arcs = solve(problem, method="projection", settings={"measure": "exact-arc"}).problem
    assert develop(by_arcs, 4, arc=True).gap < 1e-12 < 1e-7 < develop(by_arcs, 4).gap


def test_regions_that_cannot_be_laid_are_refused():
    problem = nine_regions(9)
    with pytest.raises(ValueError, match="there is no region 9; the mesh has regions 0 to 8"):
        develop(problem, 9)
    with pytest.raises(ValueError, match="too large for a mould"):
        develop(problem, 0, K=10.0)
    with pytest.raises(ValueError, match="region 0 has no single target K̄"):
        develop(problem.with_targets(np.linspace(0, 1, len(problem.vertices))), 0)
    vertices, faces = icosphere(1)
    with pytest.raises(ValueError, match="is closed; give a seam"):
        lay_out(vertices, faces, 0.5)
