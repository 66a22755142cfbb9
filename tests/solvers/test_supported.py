"""A drawing that bulges the wrong way beside its supports says its side, and nothing else."""

from __future__ import annotations

import numpy as np
import pytest

from compas_cgc import solve
from compas_cgc.model.problem import CGCProblem
from compas_cgc.model.roles import FIXED
from compas_cgc.model.roles import FREE
from compas_cgc.model.roles import INTERNAL

from ..support.shapes import grid
from ..support.tiers import push_only

SHAPES = {
    "sine": lambda u, v: np.cos(np.pi * u) * np.cos(np.pi * v),
    "paraboloid": lambda u, v: (1 - 4 * u * u) * (1 - 4 * v * v),
    "pyramid": lambda u, v: 1 - 2 * np.maximum(abs(u), abs(v)),
}


def drawn(shape: str, height: float, K: float, sides: str = "left right bottom", n: int = 14) -> CGCProblem:
    vertices, faces = grid(n, 1.0)
    u, v = (vertices[:, :2] - 0.5).T
    vertices[:, 2] = height * SHAPES[shape](u, v)
    at = {"left": np.isclose(u, -0.5), "right": np.isclose(u, 0.5), "bottom": np.isclose(v, -0.5), "top": np.isclose(v, 0.5)}
    rim, held = np.any(list(at.values()), axis=0), np.any([at[side] for side in sides.split()], axis=0)
    return CGCProblem(vertices, faces, np.where(held, FIXED, np.where(rim, FREE, INTERNAL)), K)


@pytest.mark.parametrize("shape", push_only(SHAPES, "sine"))
@pytest.mark.parametrize("height, K", [(0.2, 0.4), (-0.1, 1.0)])
def test_a_dome_drawn_over_three_sides_is_fair_and_on_its_side(shape, height, K):
    """All kept to the drawing, which has K < 0 in the corners, and came out with folds there."""
    result = solve(drawn(shape, height, K))
    assert result.converged and result.verdict.fair, result.message
    z = result.vertices[:, 2] * np.sign(height)
    assert z.min() > -1e-3 * z.max() and z.max() > 0.1


@pytest.mark.nightly
def test_how_high_it_is_drawn_does_not_matter():
    high, low = solve(drawn("sine", 0.2, 0.6)), solve(drawn("sine", 0.1, 0.6))
    assert np.allclose(high.vertices, low.vertices, atol=1e-6)


@pytest.mark.parametrize("settings", [{"measure": "auto"}, {"tolerance": 1e-10}, {"measure": "smooth"}])
def test_settings_that_every_method_has_leave_a_dome_on_its_side(settings):
    problem = drawn("sine", -0.2, 1.0, "left right bottom top")
    result = solve(problem, settings=settings)
    assert result.verdict.fair and result.vertices[:, 2].max() < 1e-9 and result.vertices[:, 2].min() < -0.1


@pytest.mark.parametrize("settings", [{"measure": "defect"}, {"measure": "smooth"}, {"measure": "exact"}, {"steps": 300}])
def test_what_is_found_step_by_step_is_found_with_settings_too(settings):
    """The first search ends at a branch point, and smaller targets lead past it."""
    vertices, faces = grid(21, 1.0)
    problem = CGCProblem(vertices, faces).with_supports("corners").with_targets(-2.0)
    result = solve(problem, settings=settings)
    assert result.converged and result.verdict.fair, result.message
    assert result.measure == settings.get("measure", "mid-edge")
