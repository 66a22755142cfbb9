"""Fitted polynomials know the curvature of a surface on any mesh, and what its layout puts into angle defects."""

from __future__ import annotations

import numpy as np
import pytest

from compas_cgc.discrete import boundary_vertices
from compas_cgc.discrete import gaussian_curvature
from compas_cgc.discrete.local_fits import local_fits
from compas_cgc.discrete.smooth_measure import layout_errors
from compas_cgc.discrete.smooth_measure import layout_errors_and_slopes

from ..support import shapes

NOTHING = np.zeros(3)


def sheet(count: int, height):
    """A Delaunay mesh of a disk, lifted."""
    vertices, faces = shapes.delaunay_disk(count)
    x, y, _ = vertices.T
    return np.column_stack([x, y, height(x, y)]), faces


def curvature(p, q, xx, xy, yy):
    return (xx * yy - xy**2) / (1 + p**2 + q**2) ** 2


SURFACES = {
    "sphere": (lambda x, y: np.sqrt(4 - x**2 - y**2), lambda x, y: 0.25 + 0 * x),
    "saddle": (lambda x, y: 0.3 * (x**2 - y**2), lambda x, y: curvature(0.6 * x, -0.6 * y, 0.6, 0, -0.6)),
    "cylinder": (lambda x, y: np.sqrt(4 - (0.8 * x + 0.6 * y) ** 2), lambda x, y: 0 * x),
}


@pytest.mark.parametrize("name", SURFACES)
def test_the_error_of_angle_defects_is_told_by_the_fits(name):
    height, exact = SURFACES[name]
    vertices, faces = sheet(900, height)
    fits = local_fits(vertices, faces, degree=4, rings=3)
    here = np.isfinite(fits.gaussian)
    K = exact(*vertices[here, :2].T)
    defect = gaussian_curvature(vertices, faces)[here]
    assert np.median(np.abs(fits.gaussian[here] - K)) < 1e-5
    corrected = np.abs(defect - fits.truncation[here] - K)
    assert np.median(corrected) < 0.01 * np.median(np.abs(defect - K))
    assert np.percentile(corrected, 95) < 0.02 * np.percentile(np.abs(defect - K), 95)


@pytest.mark.parametrize("name", SURFACES)
def test_slopes_of_the_error_are_its_central_differences(name):
    """Of smooth surfaces: frames and weights, which are taken as they are, count as much as the waves."""
    vertices, faces = sheet(300, SURFACES[name][0])
    asked = ~boundary_vertices(vertices, faces)
    errors, slopes = layout_errors_and_slopes(vertices, faces, asked)
    assert np.array_equal(errors, layout_errors(vertices, faces, asked))
    move = np.random.default_rng(3).normal(size=vertices.shape)
    above, below = (layout_errors(vertices + step * move, faces, asked) for step in (1e-7, -1e-7))
    change, told = (above - below) / 2e-7, slopes @ move.ravel()
    assert np.linalg.norm(change - told) < 0.02 * np.linalg.norm(change)


def test_curvatures_turn_and_scale_with_the_surface():
    vertices, faces = sheet(300, SURFACES["saddle"][0])
    turn = np.linalg.qr(np.random.default_rng(1).normal(size=(3, 3)))[0]
    turn *= np.linalg.det(turn)
    here, there = local_fits(vertices, faces), local_fits(10 * vertices @ turn.T + [5, -7, 90], faces)
    assert np.allclose(there.gaussian, here.gaussian / 100, atol=1e-12, equal_nan=True)
    assert np.allclose(there.mean, here.mean / 10, atol=1e-11, equal_nan=True)
    assert np.allclose(there.truncation, here.truncation / 100, atol=1e-11, equal_nan=True)


def test_fits_are_made_inside_only_and_do_not_look_across_a_crease():
    vertices, faces = shapes.grid(10)
    vertices[:, 2] = np.abs(vertices[:, 0] - 0.5)
    ridge = np.abs(vertices[:, 0] - 0.5) < 1e-9
    fits = local_fits(vertices, faces, ~ridge, ~ridge)
    inner = (vertices[:, :2] > 0.01).all(axis=1) & (vertices[:, :2] < 0.99).all(axis=1)
    assert np.array_equal(np.isfinite(fits.gaussian), inner & ~ridge)
    assert np.nanmax(np.abs(fits.mean)) < 1e-9, "both sides are flat"


def test_without_the_layout_all_else_is_told():
    vertices, faces = shapes.grid(8, 4.0)
    vertices[:, 2] = 0.1 * vertices[:, 0] ** 2
    whole, less = local_fits(vertices, faces), local_fits(vertices, faces, layout=False)
    assert np.isnan(less.truncation).all() and not np.isnan(whole.truncation).all()
    assert all(np.array_equal(one, other, equal_nan=True) for one, other in zip(whole, less._replace(truncation=whole.truncation)))
