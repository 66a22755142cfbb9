"""Columns given their heights in a flat mesh leave no spikes, and what nothing says to hang bulges with the normals."""

from __future__ import annotations

import numpy as np
import pytest

from compas_cgc import Above
from compas_cgc import CGCMesh
from compas_cgc import solve
from compas_cgc.meshing import named_supports
from compas_cgc.model.problem import CGCProblem
from compas_cgc.solvers.projection.drawing import as_meant

from ...support import shapes

N = 11
CORNERS = [0, N, N * (N + 1), (N + 1) ** 2 - 1]


def lifted(heights, target=0.01, relief=0.0, width=(10.0, 10.0), cells=N) -> CGCProblem:
    """A sheet over a rectangle, flat but for a relief, whose corners were lifted."""
    vertices, faces = shapes.grid(cells)
    corners = [0, cells, cells * (cells + 1), (cells + 1) ** 2 - 1]
    x, y, _ = vertices.T
    vertices = np.column_stack([width[0] * x, width[1] * y, relief * np.sin(np.pi * x) * np.sin(np.pi * y)])
    vertices[corners, 2] = heights
    return CGCProblem(vertices, faces, targets=target).with_supports(corners)


@pytest.mark.parametrize("heights", [(3, 3, 3, 3), (3, 0, 0, 3), (3, 3, 0, 0), (1, 2, 2, 3), (0, 0, 1.7, 3.3)])
@pytest.mark.parametrize("target", [0.005, 0.012, -0.012])
def test_a_lifted_canopy_bulges_up(heights, target):
    problem = lifted(heights, target, width=(11.0, 15.0))
    result = solve(problem, method="projection")
    assert result.converged and result.verdict.fair
    x, y, z = result.vertices.T
    plane = np.linalg.lstsq(np.column_stack([x, y, np.ones_like(x)])[CORNERS], z[CORNERS], rcond=None)[0]
    over = z - (plane[0] * x + plane[1] * y + plane[2])
    assert over.mean() > (0.5 if target > 0 else -0.5)


def test_it_does_not_depend_on_how_the_flat_sheet_lay():
    """Lifted from the ground, or drawn as the plate that the columns carry already."""
    one, other = (solve(lifted((3, 0, 0, 3)).with_vertices(drawn)) for drawn in (lifted((3, 0, 0, 3)).vertices, plate()))
    assert np.abs(one.vertices - other.vertices).max() < 0.15


def plate() -> np.ndarray:
    problem = lifted((3, 0, 0, 3))
    x, y, _ = problem.vertices.T / 10.0
    return np.column_stack([10 * x, 10 * y, 3 * (1 - x) * (1 - y) + 3 * x * y])


def test_a_relief_is_carried_and_says_the_side():
    low, high = (as_meant(lifted((2, 2, 2, 2), relief=relief)).vertices[:, 2] for relief in (-1.0, 1.0))
    middle = (N // 2) * (N + 1) + N // 2
    assert low[middle] == pytest.approx(1.0, abs=0.4) and high[middle] == pytest.approx(3.0, abs=0.4)
    assert (
        solve(lifted((2, 2, 2, 2), relief=-1.0)).vertices[middle, 2]
        < 1.0
        < 3.0
        < solve(lifted((2, 2, 2, 2), relief=1.0)).vertices[middle, 2]
    )


def test_drawings_that_are_meant_stay_to_the_bit():
    vertices, faces = shapes.grid(N, 10.0)
    x, y, _ = vertices.T
    for heights in (3 - 0.06 * ((x - 5) ** 2 + (y - 5) ** 2), 0.06 * x * y, np.hypot(x - 5, y - 5), 0.0 * x):
        drawn = CGCProblem(np.column_stack([x, y, heights]), faces, targets=0.01)
        for supports in ("corners", "boundary", [*CORNERS, (N // 2) * (N + 1) + N // 2]):
            problem = drawn.with_supports(supports)
            assert as_meant(problem) is problem


def test_beside_a_lifted_corner_there_is_none():
    for height in (0.6, 2.0, 6.0):
        problem = lifted((0, height, height, 0))
        assert sorted(named_supports(problem.vertices, problem.faces, "corners").tolist()) == CORNERS
    mesh = CGCMesh.from_meshgrid(dx=10, nx=9)
    mesh.vertex_attribute(0, "z", 3.0)
    mesh.set_supports("corners")
    assert len(mesh.supports()) == 4
    zigzag = lifted((0, 0, 0, 0)).vertices.copy()
    zigzag[1:N:2, 2] = 1.0
    folded = named_supports(zigzag, lifted((0, 0, 0, 0)).faces, "corners")
    assert set(range(1, N - 1)) <= set(folded.tolist()), "an edge that goes up and down has its corners there"


def test_two_bays_held_all_around_are_domes_of_one_height():
    mesh = CGCMesh.from_meshgrid(dx=14, nx=14, dy=7, ny=7)
    vertices, _ = mesh.arrays()
    mesh.set_supports("boundary")
    across = np.flatnonzero(np.abs(vertices[:, 0] - 7.0) < 1e-9)
    mesh.set_creases([across[np.argsort(vertices[across, 1])].tolist()])
    mesh.set_target(0.012)
    result = solve(mesh)
    heights = result.vertices[:, 2]
    left, right = (heights[side] for side in (vertices[:, 0] < 7.0, vertices[:, 0] > 7.0))
    assert result.converged and result.verdict.fair
    assert left.max() == pytest.approx(right.max(), rel=0.02) and heights.mean() > 0.46


@pytest.mark.parametrize("inset", [1, 2, 3, 4])
@pytest.mark.parametrize("turned", [False, True])
def test_a_roof_far_over_its_columns_is_a_dome_whose_edges_come_down(inset, turned):
    """They come down by more than its middle rises, and still it bulges with the normals."""
    mesh = CGCMesh.from_meshgrid(dx=12, nx=12)
    if turned:
        mesh.flip()
    places = (inset, 12 - inset)
    mesh.set_supports(mesh.vertices_near([[x, y] for x in places for y in places]))
    mesh.set_target(0.004)
    result = solve(mesh)
    assert result.converged and result.verdict.fair, result.message
    heights = result.vertices[:, 2] * (-1 if turned else 1)
    middle = heights[mesh.vertices_near([[6, 6]])[0]]
    rim = heights[[v for loop in mesh.boundary_loops() for v in loop]]
    assert middle > 0.0 and (rim < middle).all()


def canopy(outline, heads, target):
    mesh = CGCMesh.from_outline(np.column_stack([outline, np.zeros(len(outline))]), 1.2, points=heads)
    mesh.set_supports(mesh.vertices_near(np.asarray(heads)[:, :2]))
    mesh.set_target(target)
    return mesh


def test_heads_at_uneven_heights_carry_a_dome():
    """Whose sheet leans one way and the other: its bending tells that it bulges, not where it lies on the whole."""
    outline = [[9.2, -0.9], [7.0, 6.9], [-2.1, 6.6], [-7.7, 2.4], [-8.7, -3.0], [-4.2, -7.1], [4.4, -5.9]]
    mesh = canopy(outline, [[6.55, -0.6, 4.37], [-0.67, 4.47, 3.61], [-6.52, -0.75, 4.03], [-1.54, -4.35, 3.95]], 0.005)
    result = solve(mesh)
    rim = result.vertices[[v for loop in mesh.boundary_loops() for v in loop], 2]
    assert result.converged and result.verdict.fair, result.message
    assert result.vertices[:, 2].max() < 5.5 and np.median(rim) < 3.9


def test_heads_that_a_dome_passes_through_with_tips_carry_a_bowl():
    outline = [[11.2, -0.7], [5.8, 7.7], [-2.6, 8.8], [-9.8, 5.0], [-8.9, -2.9], [-2.8, -7.8], [8.8, -5.5]]
    heads = [
        [6.79, 1.79, 3.31],
        [4.7, 5.08, 3.78],
        [2.39, 6.27, 3.88],
        [-0.31, 6.62, 3.57],
        [-2.08, 6.66, 3.61],
        [-5.64, 4.76, 3.26],
        [-6.61, 1.77, 3.51],
        [-5.93, -1.67, 3.74],
        [-3.43, -3.66, 3.53],
        [-0.02, -4.44, 3.86],
        [4.02, -3.64, 3.83],
        [6.88, -1.75, 3.62],
    ]
    result = solve(canopy(outline, heads, 0.006))
    assert result.converged and result.verdict.fair, result.message
    middle = result.vertices[np.argmin(np.hypot(*(result.vertices[:, :2] - np.mean(outline, axis=0)).T)), 2]
    assert middle < min(head[2] for head in heads)


def test_petals_that_dip_under_their_edge_are_told_with_the_goal_that_keeps_them_up():
    angles = np.arange(10) * np.pi / 5
    around = np.where(np.arange(10) % 2, 5.5, 9.0)[:, None] * np.column_stack([np.cos(angles), np.sin(angles)])
    rim = np.column_stack([around, np.zeros(10)]).tolist()
    star = CGCMesh.from_outline([*rim, rim[0]], 0.8, creases=[[[0, 0, 0], rim[k]] for k in range(1, 10, 2)])
    star.set_supports("boundary")
    star.set_target(0.008)
    dipping = solve(star, method="projection")
    assert "below its boundary (goals=[Above(0)] prevents this)" in dipping.message
    kept = solve(star, goals=[Above(0)])
    assert kept.converged and kept.verdict.fair and "below its boundary" not in kept.message
    assert kept.vertices[:, 2].min() > -1e-9
