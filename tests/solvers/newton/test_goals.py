"""One K as the answer to one goal, by Newton's method."""

from __future__ import annotations

import numpy as np
import pytest

from compas_cgc.discrete import boundary_vertices
from compas_cgc.model.goals.measures import area
from compas_cgc.model.goals.measures import volume
from compas_cgc.model.goals.wholes import Area
from compas_cgc.model.goals.wholes import Rise
from compas_cgc.model.goals.wholes import Volume
from compas_cgc.model.problem import CGCProblem
from compas_cgc.model.roles import FIXED
from compas_cgc.model.roles import INTERNAL
from compas_cgc.solvers.run import solve

from ...support import shapes
from ...support.tiers import push_only


def square(n: int = 40, target: float = np.nan) -> CGCProblem:
    vertices, faces = shapes.grid(n, 15.0)
    return CGCProblem(vertices, faces, np.where(boundary_vertices(vertices, faces), FIXED, INTERNAL), target)


@pytest.mark.parametrize("rise", push_only([1.0, 2.0, 3.0, 4.0, 4.5, -2.0], 1.0, 4.5, -2.0))
def test_a_rise_over_a_fixed_edge(rise):
    problem = square()
    assert len(problem.vertices) == 1681
    result = solve(problem, goals=[Rise(rise)], unknown=[0])
    assert result.method == "newton" and result.converged
    assert np.sign(rise) * np.abs(result.vertices[:, 2]).max() == pytest.approx(rise, abs=1e-10)
    assert result.max_error < 1e-13, "rounding"
    K = result.problem.region_targets()[0]
    assert K is not None and f"K = {K:.6g} was found for the rise {rise:g}" in result.message
    plain = solve(square(target=K))
    assert (plain.method, plain.measure) == ("newton", result.measure) and result.iterations <= 2 * plain.iterations
    assert plain.vertices[:, 2].max() == pytest.approx(abs(rise), rel=2e-3), "vertices slide differently"


def test_a_rise_near_half_of_the_span_is_found_from_less():
    """The cap of that rise over the width has more K than a square carries, so the search begins with the half of it."""
    result = solve(square(20), goals=[Rise(6.7)], unknown="all")
    assert result.verdict.fair and result.vertices[:, 2].max() == pytest.approx(6.7)
    plain = solve(square(20, target=result.problem.region_targets()[0]))
    assert plain.vertices[:, 2].max() == pytest.approx(6.7, rel=1e-2), "near the limit the rise changes much with K"


def test_a_volume_and_an_area():
    for goal, measured in ((Volume(300.0), lambda x, f: volume(x, f, 0.0) - 300.0), (Area(260.0), lambda x, f: area(x, f) - 260.0)):
        result = solve(square(20), goals=[goal], unknown="all", method="newton")
        assert result.converged and abs(measured(result.vertices, result.faces)) < 1e-9


def test_a_disk_knows_its_cap():
    """Over a circle of radius a the cap of rise h has K = (2 h / (h² + a²))²; the second goal for the same K is left to projection."""
    vertices, faces = shapes.delaunay_disk(600)
    rim = boundary_vertices(vertices, faces)
    problem = CGCProblem(vertices, faces, np.where(rim, FIXED, INTERNAL), np.nan)
    radius = np.linalg.norm(vertices[rim, :2], axis=1).mean()
    result = solve(problem, goals=[Rise(0.4 * radius)], unknown=[0])
    assert result.problem.targets[0] == pytest.approx((0.8 / 1.16 / radius) ** 2, rel=0.03)
