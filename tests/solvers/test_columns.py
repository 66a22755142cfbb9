"""Columns under K > 0: layouts that exist end fair, and of others the sentence says which column, and how high it may be."""

from __future__ import annotations

import re

import numpy as np
import pytest

from compas_cgc import Above
from compas_cgc import CGCMesh
from compas_cgc import EdgeInPlan
from compas_cgc import solve
from compas_cgc.discrete import boundary_vertices
from compas_cgc.meshing.closest_points import nearest_on_polyline
from compas_cgc.model.bulging import two_sided_supports
from compas_cgc.model.problem import CGCProblem
from compas_cgc.model.verdict import verdict
from compas_cgc.solvers.columns import Attempt
from compas_cgc.solvers.columns import column_advice

from ..support.shapes import grid
from ..support.shapes import revolution

PLAN = np.array([(0, 0, 0), (14, 0, 0), (14, 6, 0), (6, 6, 0), (6, 14, 0), (0, 14, 0)], float)
LOW = [(0, 0), (14, 0), (14, 6), (6, 14), (0, 14)]  # the outward corners


def court(high, lift=0.6, target=0.004):
    """An L folded along its mitre, on columns of 3 at its outward corners and higher ones between."""
    pytest.importorskip("compas_cgal")
    columns = [*LOW, *high]
    mesh = CGCMesh.from_outline(np.vstack([PLAN, PLAN[:1]]), 1.0, creases=[[(0, 0), (6, 6)]], points=columns)
    at = mesh.vertices_near(columns)
    for vertex, place in zip(at, columns):
        mesh.vertex_attribute(vertex, "z", 3.0 + lift * (place in high))
    mesh.set_supports(at)
    mesh.set_target(target)
    return mesh


LAYOUTS = [
    [(14, 3), (3, 14), (10, 6), (6, 10)],
    [(7, 0), (0, 7), (14, 3), (3, 14)],
    [(7, 0), (0, 7), (10, 6), (6, 10)],
    [(7, 0), (0, 7), (6, 10), (14, 3)],
    [(7, 0), (3, 14), (10, 6), (6, 10)],
]


@pytest.mark.parametrize("high", [LAYOUTS[0], LAYOUTS[-1], *(pytest.param(layout, marks=pytest.mark.nightly) for layout in LAYOUTS[1:-1])])
def test_a_court_of_nine_columns_at_two_heights(high):
    mesh = court(high)
    assert len(mesh.supports()) == 9 and len(mesh.regions()) == 2
    result = solve(mesh, goals=[EdgeInPlan(), Above(2.7)])
    assert result.converged and result.verdict.fair and result.max_error < 1e-12
    rim = result.vertices[boundary_vertices(result.vertices, result.faces)] * [1, 1, 0]
    assert np.linalg.norm(nearest_on_polyline(rim, PLAN, closed=True)[0] - rim, axis=1).max() < 1e-3
    assert result.vertices[:, 2].min() >= 2.7 - 1e-9


def roof(place, height, supports="boundary", n=12) -> CGCProblem:
    """A flat square of 10 m with K = 0.01, and a column in it."""
    vertices, faces = grid(n, 10.0)
    column = int(np.argmin(np.hypot(*(vertices[:, :2] - place).T)))
    vertices[column, 2] = height
    return CGCProblem(vertices, faces, targets=0.01).with_supports(supports).with_supports([column], add=True)


@pytest.mark.parametrize("place, supports", [((5, 5), "boundary"), ((5, 5), "corners"), ((3.4, 6.6), "corners")])
def test_a_column_where_the_roof_runs_is_fair(place, supports):
    without = solve(CGCProblem(*grid(12, 10.0), targets=0.01).with_supports(supports)).vertices
    column = int(np.argmin(np.hypot(*(without[:, :2] - place).T)))
    assert solve(roof(place, without[column, 2], supports)).verdict.fair


@pytest.mark.parametrize("height, words", [(1.5, "under"), (2.8, "over")])
def test_a_column_in_the_way_is_named_with_heights_that_do(height, words):
    result = solve(roof((5, 5), height))
    assert not result.verdict.fair
    assert "the column at (5, 5), vertex 84, stands" in result.ending and f"{words} where a surface of K = 0.01" in result.message
    runs = float(re.search(r"without it, at ([\d.]+)", result.ending).group(1).rstrip("."))
    heights = (
        [float(end) for end in re.findall(r"heights from ([\d.]+) to ([\d.]+) were", result.ending)[0]]
        if "heights" in result.ending
        else [runs]
    )
    assert 1.9 < runs < 2.1
    for end in heights:
        assert solve(roof((5, 5), end)).verdict.fair, "what the sentence says can be had"


def test_a_tip_at_a_column_is_seen():
    """A cone of the slope s has the angle defect π s²; the top of a sphere has no tip."""
    radius = np.linspace(1.0, 0.0, 9)[:-1]
    for slope, pointed in ((0.02, False), (0.2, True)):
        vertices, faces = revolution(radius, np.sqrt(100 - radius**2) - slope * radius, 24)
        top = len(vertices)
        last = np.arange(top - 24, top)
        vertices = np.vstack([vertices, [0.0, 0.0, 10.0]])
        faces = np.vstack([faces, np.column_stack([last, np.roll(last, -1), np.full(24, top)])])
        problem = CGCProblem(vertices, faces, targets=0.01).with_supports("boundary").with_supports([top], add=True)
        said = [reason for reason in verdict(problem).reasons if "has a sharp tip" in reason]
        assert bool(said) is pointed
        if pointed:
            assert f"at the support at vertex {top}" in said[0] and abs(float(said[0].split()[6]) - np.degrees(2 * slope)) < 2.0


def test_supports_that_ask_for_both_sides_say_the_heights():
    V, F = grid(8, 8.0)
    problem = CGCProblem(V, F, targets=0.01)
    places = {(0, 0): 3.0, (8, 0): 3.0, (8, 8): 3.0, (0, 8): 3.0, (2, 4): 4.0, (6, 4): 2.0}
    at = [int(np.argmin(np.hypot(*(V[:, :2] - place).T))) for place in places]
    V = V.copy()
    V[at, 2] = list(places.values())
    (said,) = two_sided_supports(problem.with_vertices(V).with_supports(at))
    raised = float(re.search(r"raise the second above z = ([\d.]+)", said).group(1))
    V[at[5], 2] = raised + 0.2
    assert two_sided_supports(problem.with_vertices(V).with_supports(at)) == []


@pytest.mark.parametrize("tilt", [0.0, 0.05])
def test_an_upright_facade_has_no_columns_in_its_plan(tilt):
    """A facade that is rough is told so, and not that a column is in its way."""
    vertices, faces = grid(10, 10.0)
    x, z, _ = vertices.T
    facade = CGCProblem(np.column_stack([x, tilt * z, z]), faces[:, ::-1], targets=0.01).with_supports("corners")
    (middle,) = np.flatnonzero((x == 5) & (z == 5))
    rough = Attempt(facade.vertices, verdict(facade, facade.vertices))
    assert column_advice(facade.with_supports([middle], add=True), rough, lambda problem: None) == ""
    result = solve(facade.with_supports([middle], add=True))
    assert not result.verdict.fair and "the column" not in result.message
