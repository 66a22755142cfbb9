"""The benchmarks measure what they say: the solves in them arrive. Nothing here is timed."""

from __future__ import annotations

import json

import pytest

from compas_cgc.cli import bench
from compas_cgc.paper import benchmarks
from compas_cgc.paper.benchmarks.timing import best_of


@pytest.mark.nightly
def test_examples_carry_the_papers_seconds():
    rows = benchmarks.example_times()
    assert [row["paper_seconds"] for row in rows] == [117.8, 111.5, 273.0, 488.5, 963.8, 870.0]
    assert all(row["times_faster"] == pytest.approx(row["paper_seconds"] / row["seconds"]) for row in rows)


@pytest.mark.nightly
def test_newton_arrives_in_a_process_of_its_own():
    small, large = benchmarks.newton_growth((100, 400))
    for row in (small, large):
        assert row["status"] == "converged" and row["residual"] <= 1e-13
        assert row["max_error"] < 1e3 * row["rounding_floor"]
        assert row["peak_memory_bytes"] is None or row["peak_memory_bytes"] > 1e7
    assert json.dumps([small, large])


@pytest.mark.nightly
def test_the_fairest_surface_is_one():
    up, down = benchmarks.fairest_growth((100,))
    assert (up["K"], down["K"]) == (1.0, -1.0) and up["vertices"] == down["vertices"] == 100
    for row in (up, down):
        assert row["status"] == "converged" and row["verdict"] == "fair" and row["ratio"] > 0 and row["max_error"] < 1e-10


def test_optimisers_and_newton_solve_the_same():
    rows = benchmarks.against_optimisers(8, 6)
    assert [row["method"] for row in rows] == ["least_squares", "L-BFGS"]
    assert all(row["max_error"] < 1e-8 for row in rows)


def test_a_roof_is_solved_again():
    row = benchmarks.interactive(8)
    assert row["status"] == "converged" and row["max_error"] < 1e-10


@pytest.mark.nightly
def test_a_server_solves_the_same_mesh_by_every_door():
    (row,) = benchmarks.server_overhead((64,))
    assert row["vertices"] == 64
    assert row["job_ratio"] > 1.0 and row["hops_ratio"] > 0.5, "the same is done there, and more"
    assert row["job_cpu_ratio"] is None or row["job_cpu_ratio"] > 0.5
    assert row["cancel_seconds"] > 0 and row["hang_up_seconds"] > 0


def test_kernel_and_growth_have_a_row_for_every_size():
    assert [row["vertices"] for row in benchmarks.kernel_ratio((10, 20))] == [100, 400]
    assert [row["vertices"] for row in benchmarks.growth((5, 9))] == [64, 144]


def test_exponents_are_fitted():
    rows = [{"vertices": n, "seconds": 3.0 * n**1.5} for n in (10, 100, 1000, 10000)]
    assert benchmarks.fitted_exponent(rows, "seconds") == pytest.approx(1.5)


def test_best_of_calls_once_more_to_warm_up():
    calls = []
    assert best_of(lambda: calls.append(None), repeats=3, budget=0.0) >= 0
    assert len(calls) == 4


def test_tables_line_up(capsys):
    bench._print([{"a": 1, "b_c": 0.123456}, {"a": 1000, "b_c": None}], "a b_c")
    assert capsys.readouterr().out.splitlines() == ["   a    b c", "   1  0.123", "1000      -"]
