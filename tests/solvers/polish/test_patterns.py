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
    return Patterns(gram, np.zeros((count, 3)) if slope is None else slope, 1.0, ~saddles, saddles, 0.0, side)


def test_domes_alone_go_to_one_side_and_then_to_the_other():
    gram = np.zeros((2, 3, 2, 3))
    gram[:, 0, :, 0] = [[1.0, 0.9], [0.9, 1.0]]
    first, second = patterns(gram, side=-1.0).found()
    assert first[:, 0].tolist() == [-1.0, -1.0] and np.array_equal(second, -first)


@pytest.mark.parametrize("count", [1, 2])
def test_rounding_errors_of_the_energy_leave_patterns_of_a_plate_that_hardly_bends(count):
    saddles = np.ones(count, bool)
    gram = 1e-20 * np.eye(3 * count).reshape(count, 3, count, 3)
    energies = Patterns(gram, np.zeros((count, 3)), -1e-15, ~saddles, saddles, 0.0, 1.0)
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


@pytest.mark.parametrize("push, count", [(0.6, 2), (0.1, 3)])
def test_a_sheet_bends_to_cylinders_and_stays_a_plate_where_it_gains_little(push, count):
    """E = 3 a² / 2 + 2 a s cos t + c is least at a = -2 s cos t / 3, with t = 0 and 180°: two cylinders across each other."""
    gram = np.diag([1.0, 0.5, 0.5]).reshape(1, 3, 1, 3)
    found = Patterns(gram, np.array([[0.0, push, 0.0]]), 0.3, *np.zeros((2, 1), bool), 0.1, 1.0).found()
    ends = [[a, a * np.cos(t), a * np.sin(t)] for t, a in ((0.0, -push / 1.5), (np.pi, push / 1.5))]
    assert np.array(found[:2])[:, 0] == pytest.approx(np.array(ends), rel=1e-3, abs=1e-12)
    assert len(found) == count and (count == 2 or not found[2].any())


def test_panels_with_k_of_both_signs_are_fair():
    """A search with one side and one direction for all panels ends in waves, with twice the energy."""
    solution = polish(chessboard(4, 7, 5, "nodes"))
    assert solution.status == "converged" and solution.verdict.fair, solution.verdict.reasons
    assert solution.branches[0].energy < 1.5
