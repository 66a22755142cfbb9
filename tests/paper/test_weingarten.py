"""The paper's energy for general constants: exact gradient, first variation, stationary spheres, and the special case of Eq. 2."""

from __future__ import annotations

import numpy as np
import pytest

from compas_cgc.discrete import energy
from compas_cgc.discrete import vertex_areas
from compas_cgc.discrete import vertex_normals
from compas_cgc.model.laws import LinearWeingarten
from compas_cgc.paper.weingarten import law_of_constants
from compas_cgc.paper.weingarten import weingarten_energy
from compas_cgc.paper.weingarten import weingarten_gradient

from ..support.shapes import icosphere
from ..support.shapes import torus

LAW = LinearWeingarten(0.7, 1.3, 0.4)


def test_the_gradient_is_exact():
    V, F = torus(10, 14)
    V = V + 0.02 * np.random.default_rng(0).standard_normal(V.shape)
    step = np.random.default_rng(1).standard_normal(V.shape)
    change = (weingarten_energy(V + 1e-6 * step, F, LAW) - weingarten_energy(V - 1e-6 * step, F, LAW)) / 2e-6
    assert change == pytest.approx(float((weingarten_gradient(V, F, LAW) * step).sum()), rel=1e-7)


def test_the_first_variation_is_that_of_the_law():
    def error(rows: int) -> float:
        V, F = torus(rows, 2 * rows)
        t = np.arctan2(V[:, 2], np.hypot(V[:, 0], V[:, 1]) - 1.0)
        H, K = 0.5 * (1 / 0.4 + np.cos(t) / (1 + 0.4 * np.cos(t))), np.cos(t) / (0.4 * (1 + 0.4 * np.cos(t)))
        psi = 1.0 + 0.5 * np.cos(t) + V[:, 0]
        exact = float((LAW.residual(H, K) * psi * vertex_areas(V, F)).sum())
        variation = float((weingarten_gradient(V, F, LAW) * (psi[:, None] * vertex_normals(V, F))).sum())
        return abs(variation / exact - 1.0)

    errors = [error(rows) for rows in (16, 32, 64)]
    assert errors[2] < 2e-3
    assert np.log2(errors[1] / errors[2]) > 1.8


def test_a_sphere_that_obeys_the_law_is_stationary():
    # a / r + b / r² = c
    a, b, r = 0.7, 1.3, 1.7
    law = LinearWeingarten(a, b, a / r + b / r**2)
    V, F = icosphere(4, r)
    normals = V / r
    for psi in (np.ones(len(V)), 1 + V[:, 0] / r, (V[:, 1] / r) ** 2):
        here, off = (float((weingarten_gradient(scale * V, F, law) * (psi[:, None] * normals)).sum()) for scale in (1.0, 1.1))
        assert abs(here) < 0.01 * abs(off)


def test_the_paper_s_special_case():
    V, F = icosphere(2, 1.2)
    law = law_of_constants(1.0, 0.0, 0.3)
    assert weingarten_energy(V, F, law) == pytest.approx(energy(V, F, 0.3))
    # The condition of the paper for an elliptic energy, beta² + alpha gamma > 0.
    for constants in ((1.0, 0.5, -0.2), (1.0, 0.5, -0.3), (0.0, 1.0, 0.3)):
        alpha, beta, gamma = constants
        assert (law_of_constants(*constants).type == "elliptic") == (beta**2 + alpha * gamma > 0)
