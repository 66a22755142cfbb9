"""Costs of moulds and panels, and places that count more, on designs whose answers are known in advance."""

from __future__ import annotations

import itertools
from functools import cache

import numpy as np
import pytest

import compas_cgc
from compas_cgc.errors import CGCError
from compas_cgc.rationalisation import assignment
from compas_cgc.rationalisation import read_design
from compas_cgc.rationalisation import sweep
from compas_cgc.rationalisation.assignment import Placed
from compas_cgc.rationalisation.assignment import finished
from compas_cgc.rationalisation.assignment import rank
from compas_cgc.rationalisation.costs import Allowance
from compas_cgc.rationalisation.costs import costs_of
from compas_cgc.rationalisation.linear_search import Assignment
from compas_cgc.rationalisation.normal_moves import NormalMoves
from compas_cgc.rationalisation.seams import panels_of

from ..support.freeform import bumpy
from ..support.freeform import mesh_over

COSTS = {"flat": (0.0, 100.0), "sphere": (5000.0, 400.0), "saddle": (9000.0, 700.0)}
RADIUS = 20.0


@cache
def vault(width: float = 10.0) -> compas_cgc.rationalisation.design.Design:
    """A barrel of 12 m with a part of a sphere at either end: as many panels of K = 0 as of 1/400 on a grid of 2 x 2 m."""

    def heights(x, y):
        beyond = np.maximum(np.abs(x - 12.0) - 6.0, 0.0)
        return np.sqrt(RADIUS**2 - beyond**2 - (y - 0.5 * width) ** 2) - 15.0

    return read_design(mesh_over(heights, 24.0, width, 0.25), tolerance=2e-4)


def rationalised(**options):
    return compas_cgc.rationalise(vault(), panel=2.0, edges=4, **options)


def test_a_vault_costs_its_flat_sheets_its_spherical_ones_and_one_mould():
    design, options = vault(4.0), {"panel": 2.0, "edges": 4}
    found = compas_cgc.rationalise(design, **options, moulds=None, within=0.01, costs=COSTS)
    assert found.status == "kept" and found.costs_of_parts == (5000.0, 12 * 100.0 + 12 * 400.0)
    assert found.panels_per_class.tolist() == [12, 12] and found.curvatures[0] == 0.0
    assert 1.0 / np.sqrt(found.curvatures[1]) == pytest.approx(RADIUS, rel=0.01)
    assert found.to_dict()["costs"] == {"moulds": 5000.0, "panels": 6000.0}
    assert "costs: 11,000, moulds 5,000 and panels 6,000" in found.summary
    # The nearest surface has no flat mould, so that it would cost more.
    assert 0.0 not in compas_cgc.rationalise(design, **options, moulds=2).curvatures


def test_where_flat_sheets_stay_within_the_distance_all_are_flat():
    flat = rationalised(moulds=1)
    found = rationalised(moulds=None, within=1.01 * flat.farthest, costs=COSTS)
    assert found.curvatures.tolist() == [0.0] and found.costs_of_parts == (0.0, 60 * 100.0)


def test_panels_become_flat_one_by_one_and_in_exchange_for_others():
    """Rounds of many moves alone end at 12,600."""
    found = rationalised(moulds=None, within=0.03, costs=COSTS)
    assert found.kept and sum(found.costs_of_parts) - 5000.0 <= 9600.0


def test_spherical_panels_that_cost_less_replace_flat_ones():
    dear = {"flat": (0.0, 1000.0), "sphere": (5000.0, 400.0), "saddle": (9000.0, 700.0)}
    found = rationalised(moulds=None, within=0.08, costs=dear)
    assert found.kept and found.panels_per_class[found.curvatures > 0.0].sum() > 30
    assert sum(found.costs_of_parts) < 5000.0 + 30 * 1000.0 + 30 * 400.0


def test_a_cancelled_search_ends_at_once_with_the_cheapest_surface_so_far(monkeypatch):
    real, stopped, late, shown = assignment._placed, False, 0, []

    def placed(*given):
        nonlocal late
        late += stopped
        return real(*given)

    def watch(state):
        nonlocal stopped
        shown.append(state.done / state.rounds)
        # One and two moulds with and without a flat one, of up to 16, are past, and three are on their way to cheaper ones.
        stopped = shown[-1] > 4.5 / 32
        return stopped

    monkeypatch.setattr(assignment, "_placed", placed)
    found = rationalised(moulds=None, within=0.01, costs=COSTS, callback=watch)
    assert 4.5 / 32 < shown[-1] < 5.0 / 32 and late == 0, "no surface is solved after the cancel"
    assert found.status == "cancelled" and found.kept and sum(found.costs_of_parts) == 20000.0
    assert shown == sorted(shown), "the progress of all searches together"


def test_a_surface_that_was_not_solved_is_not_the_cheapest():
    panelling = panels_of(vault(), 2.0, 4)
    moves = NormalMoves(panelling, np.zeros(len(panelling.vertices), bool))
    allowance = Allowance(np.full(len(moves.columns), 100.0), np.ones(moves.panels, np.int64), costs_of(COSTS))
    # No surface near the design has panels of 2 m on spheres of 0.5 m.
    one, none = np.ones(1, bool), np.zeros(moves.panels, bool)
    small, large = (Assignment(np.array([K]), np.zeros(moves.panels, np.int64), one, none) for K in (4.0, 1.0 / 400))
    still = np.zeros(len(moves.columns))
    unsolved, solved = finished(moves, Placed(small, still, np.inf)), finished(moves, Placed(large, still, 0.0))
    assert np.isinf(unsolved.norm) and np.isfinite(solved.norm)
    for allowed in (allowance, allowance._replace(limits=-allowance.limits), None):
        assert rank(moves, allowed, solved) < rank(moves, allowed, unsolved)


def test_a_weight_at_a_support_counts_what_the_fitted_surface_deviates():
    design = read_design(mesh_over(bumpy("soft", 3)), tolerance=2e-3)
    corner = design.surface.at(np.zeros((1, 2)))[0]
    options = {"panel": 5.0, "edges": 4, "within": 20.0 * design.deviation}
    found = compas_cgc.rationalise(design, moulds=1, weights=[(*corner, 0.1, 40.0)], **options)
    assert found.weights is not None and (found.weights > 1.0).sum() == 1, "the weight counts at the held corner alone"
    assert found.farthest >= found.weighted_deviation == pytest.approx(40.0 * design.deviation)
    assert found.status == "exceeded" and f"up to {found.weighted_deviation:.2g}, more than" in found.suggestion


@pytest.mark.nightly
def test_a_larger_distance_never_costs_more():
    costs = [sum(rationalised(moulds=None, within=within, costs=COSTS).costs_of_parts) for within in (0.01, 0.03, 0.05)]
    assert costs[0] > costs[1] >= costs[2] > 6000.0


@pytest.mark.nightly
def test_no_division_of_six_panels_on_existing_moulds_costs_less():
    """All 64 assignments are tried."""

    def heights(x, y):
        return 2.5 - 0.02 * (x - 6.0) ** 2 - 0.03 * (y - 4.0) ** 2 + 0.5 * np.exp(-((x - 8.0) ** 2 + (y - 5.0) ** 2) / 8.0)

    design = read_design(mesh_over(heights, 12.0, 8.0, 0.25))
    options = {"panel": 4.0, "edges": 4, "moulds": [14.0, float("inf")]}
    every = []
    for classes in itertools.product((0, 1), repeat=6):
        own = compas_cgc.rationalise(design, **options, locked=dict(enumerate(classes)))
        every.append((400.0 * classes.count(0) + 100.0 * classes.count(1), own.farthest))
    for within, count in ((0.0873, 3), (0.12, 2), (0.21, 1), (0.2486, 1)):
        found = compas_cgc.rationalise(design, **options, within=within, costs=COSTS)
        assert found.kept and len(found.classes) == 6 and len(found.curvatures) == 2
        assert found.costs_of_parts == (0.0, count * 400.0 + (6 - count) * 100.0), "existing moulds are not paid for"
        assert min(cost for cost, farthest in every if farthest <= within) == found.costs_of_parts[1]


def test_without_a_distance_costs_are_added_up_and_decide_nothing():
    plain, priced = rationalised(moulds=3), rationalised(moulds=3, costs=COSTS)
    assert np.array_equal(plain.result.vertices, priced.result.vertices) and plain.to_dict()["costs"] is None
    moulds = {0: 0.0, 1: 5000.0, -1: 9000.0}
    panels = {0: 100.0, 1: 400.0, -1: 700.0}
    kinds = np.sign(priced.curvatures).astype(int).tolist()
    assert priced.costs_of_parts == (
        sum(moulds[kind] for kind in kinds),
        sum(panels[kind] * count for kind, count in zip(kinds, priced.panels_per_class.tolist())),
    )
    rows = sweep(vault(), [1, 2], panel=2.0, edges=4, costs=COSTS).rows()
    assert rows[0]["costs"] == 6000.0 < rows[1]["costs"]


@pytest.mark.nightly
def test_distances_decrease_where_they_count_more():
    design = read_design(mesh_over(bumpy("soft", 3)), tolerance=2e-3)
    place = design.surface.at(np.array([[20.0, 12.5]]))[0]
    options = {"panel": 5.0, "edges": 4, "moulds": 3}
    even = compas_cgc.rationalise(design, **options)
    entrance = compas_cgc.rationalise(design, **options, weights=[(*place, 8.0, 5.0)])
    near = np.linalg.norm(even.panelling.vertices - place, axis=1) <= 8.0
    largest = [float(np.abs(own.distance.signed[near]).max()) for own in (even, entrance)]
    assert largest[1] < 0.5 * largest[0] and entrance.distance.largest < 3.0 * even.distance.largest
    weighted = np.where(near, 5.0, 1.0) * (np.abs(entrance.distance.signed) + design.deviation)
    assert entrance.farthest == pytest.approx(weighted.max()) and entrance.to_dict()["weighted_distance"] == entrance.farthest
    # A promise counts the same weights.
    limit = entrance.farthest * 1.01
    assert compas_cgc.rationalise(design, **options, weights=[(*place, 8.0, 5.0)], within=limit).kept
    missed = compas_cgc.rationalise(design, **options, weights=[(*place, 8.0, 500.0)], within=limit)
    assert missed.status == "exceeded" and "weighted distance" in missed.suggestion
    assert even.to_dict()["weighted_distance"] is None


@pytest.mark.parametrize(
    "options, sentence",
    [
        ({"costs": {"flat": (0, 100)}}, "costs must be given for flat, sphere, saddle"),
        ({"costs": {**COSTS, "sphere": (1.0,)}}, "costs of sphere must be two numbers"),
        ({"costs": {**COSTS, "saddle": (-1.0, 2.0)}}, "costs of saddle must be two numbers"),
        ({"costs": {**COSTS, "saddle": ("dear", 2.0)}}, "costs of saddle must be two numbers"),
        ({"costs": [0.0, 100.0]}, "costs must be pairs of numbers by flat, sphere, saddle"),
        ({"weights": [(0.0, 0.0, 1.0)]}, "weights must be rows"),
        ({"weights": [(0.0, 0.0, 1.0)] * 5}, "weights must be rows"),
        ({"weights": 3.0}, "weights must be rows"),
        ({"weights": [{}]}, "weights must be rows"),
        ({"weights": [(0.0, 0.0, 0.0, 1.0, 0.0)]}, "weights must be rows"),
        ({"weights": [(100.0, 0.0, 0.0, 1.0, 2.0)]}, "move it to the design"),
    ],
)
def test_wrong_costs_and_weights_are_refused_with_a_remedy(options, sentence):
    with pytest.raises(CGCError, match=sentence):
        rationalised(**options)
