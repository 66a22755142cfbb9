"""Stars of vertices folded to saddles, where the least-norm steps to K < 0 come to rest."""

from __future__ import annotations

import numpy as np
import pytest

from compas_cgc.discrete.space_form import space_form_angle_sums
from compas_cgc.solvers.projection.saddles import _saddle

TURNS = np.linspace(0.0, 2.0 * np.pi, 6, endpoint=False)
STAR = np.vstack([np.zeros(3), np.column_stack([np.cos(TURNS), np.sin(TURNS), np.zeros(6)])])
FACES = np.array([[0, k, k % 6 + 1] for k in range(1, 7)])


def excess(star, K):
    return space_form_angle_sums(star, FACES, np.append(K, np.zeros(6)))[0] - 2.0 * np.pi


@pytest.mark.parametrize("K", [-1e-3, -0.05])
def test_a_flat_star_is_folded_along_its_normal_past_the_angles_that_k_asks_for(K):
    folded = _saddle(STAR, FACES, K)
    assert excess(folded, K) == pytest.approx(-excess(STAR, K), rel=1e-6) and excess(STAR, K) < 0.0
    assert folded[:, :2] == pytest.approx(STAR[:, :2]) and np.ptp(folded[:, 2]) > 0.01


def test_a_star_that_would_have_to_be_folded_far_is_left():
    assert _saddle(STAR, FACES, -5.0) is None
