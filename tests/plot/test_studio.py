"""Lit pictures: what hides what, what shades what, and what is smooth."""

from __future__ import annotations

import numpy as np
import pytest

from compas_cgc import CGCMesh
from compas_cgc.plot import View
from compas_cgc.plot import studio_image
from compas_cgc.plot.zbuffer import rasterise

TOP = View(-90.0, 90.0)


def cap(n: int = 24, height: float = 2.0, crease: bool = False):
    """A square of 10 by 10 that bulges, or a gable with a crease along its ridge."""
    mesh = CGCMesh.from_meshgrid(dx=10.0, nx=n)
    for key in mesh.vertices():
        x, y, _ = mesh.vertex_coordinates(key)
        rise = 1 - abs(x / 5 - 1) if crease else (1 - (x / 5 - 1) ** 2) * (1 - (y / 5 - 1) ** 2)
        mesh.vertex_attribute(key, "z", 3.0 + height * rise)
    if crease:
        mesh.set_creases([[(n // 2) * (n + 1) + j for j in range(n + 1)]])
    problem = mesh.to_problem()
    return problem.vertices, problem.faces, problem.roles, problem.creases


def test_the_nearest_triangle_is_seen_and_interpolated():
    far = [[0.0, 0.0, 1.0], [20.0, 0.0, 1.0], [0.0, 20.0, 1.0]]
    leaning = [[0.0, 0.0, 0.0], [20.0, 0.0, 2.0], [0.0, 20.0, 0.0]]
    seen = rasterise(np.array([far, leaning]), 20, 20)
    rows, columns = np.nonzero(seen.face >= 0)
    assert (seen.face[rows, columns] == ((columns + 0.5) / 10 > 1)).all()
    across = seen.interpolated(np.array([far, leaning])[:, :, :1])[:, 0]
    assert across == pytest.approx(columns + 0.5, abs=1e-12)


def test_a_surface_is_smooth_within_a_region_and_folded_at_a_crease():
    bulge = studio_image(*cap(), view=TOP, width=200)
    line = bulge[100, 30:170].mean(axis=1)
    assert np.abs(np.diff(line)).max() < 0.03, "no facets of the 24 squares are seen"
    gable = studio_image(*cap(crease=True), view=TOP, width=200)
    row = gable[100, 30:170].mean(axis=1)
    assert row[65:75].min() < 0.6 * np.median(row), "the crease is a dark line"
    assert abs(row[20:50].mean() - row[90:120].mean()) > 0.02, "its two sides are lit differently"


@pytest.mark.nightly
def test_the_floor_is_white_but_for_the_shadow():
    image = studio_image(*cap(n=12), width=240)
    assert image[2, 2].min() > 0.97 and image[2, -3].min() > 0.97
    assert image[-40:, 60:180].min() < 0.8, "the surface stands over its shadow"
    assert np.array_equal(image, studio_image(*cap(n=12), width=240))
