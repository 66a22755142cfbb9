"""Between creases each region bends in a way of its own."""

from __future__ import annotations

import numpy as np
import pytest

from compas_cgc.solvers.polish.patterns import Patterns
from compas_cgc.solvers.polish.polisher import polish

from ..projection.test_fairest import chessboard


def patterns(gram, slope=None, saddles=None, side=1.0) -> Patterns:
    count = len(gram)
    saddles = np.zeros(count, bool) if saddles is None else np.array(saddles)
    return Patterns(gram, np.zeros((count, 3)) if slope is None else slope, 1.0, ~saddles, saddles, side)


def test_domes_alone_go_to_one_side_and_then_to_the_other():
    gram = np.zeros((2, 3, 2, 3))
    gram[:, 0, :, 0] = [[1.0, 0.9], [0.9, 1.0]]
    first, second = patterns(gram, side=-1.0).found()
    assert first[:, 0].tolist() == [-1.0, -1.0] and np.array_equal(second, -first)


@pytest.mark.parametrize("count", [1, 2])
def test_rounding_errors_of_the_energy_leave_patterns_of_a_plate_that_hardly_bends(count):
    saddles = np.ones(count, bool)
    gram = 1e-20 * np.eye(3 * count).reshape(count, 3, count, 3)
    energies = Patterns(gram, np.zeros((count, 3)), -1e-15, ~saddles, saddles, 1.0)
    found = energies.found()
    assert found and all(energies.energy(one) < 0.0 for one in found)


def test_the_least_energy_of_a_dome_between_two_saddles_is_found():
    """Compared with all sides and all pairs of directions."""
    random = np.random.default_rng(5)
    root = random.standard_normal((9, 9))
    gram, slope = (root @ root.T).reshape(3, 3, 3, 3), random.standard_normal((3, 3))
    energies = patterns(gram, slope, [True, False, True])
    turns = 2.0 * np.pi * np.arange(64) / 64
    least = min(
        energies.energy(np.array([[0.0, np.cos(a), np.sin(a)], [side, 0.0, 0.0], [0.0, np.cos(b), np.sin(b)]]))
        for a in turns
        for b in turns
        for side in (1.0, -1.0)
    )
    assert energies.energy(energies.found()[0]) == pytest.approx(least, rel=1e-12)


def test_panels_with_k_of_both_signs_are_fair():
    """A search with one side and one direction for all panels ends in waves, with twice the energy."""
    solution = polish(chessboard(4, 7, 5, "nodes"))
    assert solution.status == "converged" and solution.verdict.fair, solution.verdict.reasons
    assert solution.branches[0].energy < 1.5
