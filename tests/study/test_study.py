"""Studies: what is sampled and changed, that the table is the same however it comes about, and what is made of it."""

from __future__ import annotations

import os
import signal
import subprocess
import sys

import numpy as np
import pytest

from compas_cgc import CGCMesh
from compas_cgc import Clearance
from compas_cgc import rationalise
from compas_cgc import solve
from compas_cgc import write
from compas_cgc.cli import main
from compas_cgc.discrete import face_normals
from compas_cgc.errors import CGCError
from compas_cgc.io.rhino.archive import list_items
from compas_cgc.io.rhino.archive import read_archive
from compas_cgc.study import Results
from compas_cgc.study import Study
from compas_cgc.study import pareto_front
from compas_cgc.study import read_study
from compas_cgc.study import run_study
from compas_cgc.study import variants
from compas_cgc.study.pareto import non_dominated
from compas_cgc.study.variants import Plan

from ..support.freeform import mesh_over

N = 6


def grid(supports="boundary", K=0.01, creases=()):
    mesh = CGCMesh.from_meshgrid(dx=6.0, nx=N)
    mesh.set_supports(supports)
    mesh.set_creases(creases)
    mesh.set_target(K)
    return mesh


def line(i):
    return [i * (N + 1) + j for j in range(N + 1)]


def of(parameters, **more):
    return Study.from_dict({"parameters": parameters, **more})


def files(folder):
    return {name: (folder / name).read_bytes() for name in ("table.csv", "surfaces.npy")}


# ------------------------------------------------------------------
# Samples
# ------------------------------------------------------------------


def test_a_grid_takes_every_combination_and_a_list_one_after_the_other():
    parameters = {"K": [0.01, 0.02], "s": {"from": 0.0, "to": 1.0, "count": 3}}
    assert of(parameters).variants == [(0.01, 0.0), (0.01, 0.5), (0.01, 1.0), (0.02, 0.0), (0.02, 0.5), (0.02, 1.0)]
    assert of({"K": [0.01, 0.02], "s": [0.0, 1.0]}, sample="list").variants == [(0.01, 0.0), (0.02, 1.0)]
    with pytest.raises(CGCError, match="the same number of values"):
        of(parameters, sample="list").variants  # noqa: B018


def test_steps_by_factors_have_one_ratio():
    values = [row[0] for row in of({"K": {"from": 0.001, "to": 0.016, "count": 5, "scale": "log"}}).variants]
    assert np.allclose(values, [0.001, 0.002, 0.004, 0.008, 0.016], rtol=1e-14)


def test_of_a_latin_hypercube_every_part_of_every_range_has_one_value():
    study = of({"K": {"from": 1.0, "to": 3.0}, "s": {"from": 0.0, "to": 1.0}}, sample="latin hypercube", count=50, seed=7)
    values = np.array(study.variants)
    parts = (values - [1.0, 0.0]) / [2.0, 1.0]
    assert (np.sort((50 * parts).astype(int), axis=0) == np.arange(50)[:, None]).all()
    again = Study.from_dict(dict(study.data))
    assert again.variants == study.variants
    assert Study.from_dict({**study.data, "seed": 8}).variants != study.variants


@pytest.mark.parametrize(
    ("data", "said"),
    [
        ({}, "requires parameters"),
        ({"parameters": {"K": [0.1]}, "sampel": "grid"}, "did you mean 'sample'"),
        ({"parameters": {"k": [0.1]}}, "kind of the parameter"),
        ({"parameters": {"K": []}}, "a list of one or more"),
        ({"parameters": {"K": ["a"]}}, "not a number"),
        ({"parameters": {"K": {"from": 1.0}}}, "has no values; give values"),
        ({"parameters": {"K": {"values": [1.0], "regoin": 1}}}, "unknown key 'regoin'"),
        ({"parameters": {"K": [0.1]}, "sample": "random"}, "requires count"),
        ({"parameters": {"gate": {"kind": "clearance", "where": [3, 0, 1, 1], "values": [2.0]}}}, "where of a clearance"),
        ({"parameters": {"x": {"kind": "move", "vertices": [0], "values": [1.0]}}}, "three numbers"),
        ({"parameters": {"K": [0.1]}, "goals": [{"kind": "rize"}]}, "did you mean 'rise'"),
        ({"parameters": {"K": [0.1]}, "settings": {"stepps": 3}}, "there is no setting"),
    ],
)
def test_what_is_not_understood_is_said_with_what_is(data, said):
    with pytest.raises(CGCError, match=said):
        Study.from_dict(data)


def test_a_study_of_what_the_drawing_has_not_is_refused_before_it_begins(tmp_path):
    for parameters, said in (
        ({"K": {"region": 3, "values": [0.1]}}, "no region 3"),
        ({"s": {"crease": 0, "values": [0.1]}}, "no crease 0"),
        ({"x": {"kind": "move", "vertices": [999], "direction": [0, 0, 1], "values": [1.0]}}, "no vertex 999"),
        ({"above": {"kind": "clearance", "where": "gate", "values": [1.0]}}, "no place 'gate'"),
    ):
        with pytest.raises(CGCError, match=said):
            run_study(grid(), of(parameters), tmp_path / "out")
    with pytest.raises(CGCError, match="no column 'cost'"):
        run_study(grid(), of({"K": [0.01]}, pareto={"least": "cost"}), tmp_path / "out")
    assert not (tmp_path / "out").exists()


# ------------------------------------------------------------------
# Parameters
# ------------------------------------------------------------------


def test_regions_strategies_supports_and_goals_are_what_is_asked_of_the_variant():
    mesh = grid(creases=[line(3)])
    plan = Plan(
        of({"K": {"region": 1, "values": [0.02]}, "s": [0.3], "gate": {"kind": "clearance", "where": [1, 0, 3, 1], "values": [2.5]}}),
        mesh.to_problem(),
    )
    problem = plan.problem(0)
    other = mesh.to_problem().with_targets(0.02, region=1)
    assert np.array_equal(problem.targets, other.targets, equal_nan=True)
    assert np.array_equal(np.flatnonzero(problem.s == 0.3), line(3))
    assert [type(own) for own in problem.goals] == [Clearance] and problem.goals[0].height == 2.5
    plan = Plan(of({"supports": ["corners", "boundary"], "K": [0.01]}), mesh.to_problem())
    assert [len(plan.problem(k).supports) for k in (0, 1)] == [4, 4 * N]


@pytest.mark.parametrize("crossing", [False, True])
def test_a_crease_that_is_moved_takes_the_mesh_along_and_leaves_the_edge_of_the_plan(crossing):
    across = [[k * (N + 1) + 2 for k in range(N + 1)]] if crossing else []
    problem = grid("boundary", creases=[line(3), *across]).to_problem()
    V = problem.vertices
    axis = int(np.argmax(np.ptp(V[[line(0)[0], line(1)[0]]], axis=0)))  # across the line
    number = next(k for k, path in enumerate(problem.crease_paths()) if set(path) <= set(line(3)))
    direction = np.eye(3)[axis].tolist()
    plan = Plan(of({"ridge": {"kind": "move", "crease": number, "direction": direction, "values": [-1.2, 0.0, 1.5, 4.0]}}), problem)
    assert np.array_equal(plan.problem(1).vertices, V)
    for variant, distance in ((0, -1.2), (2, 1.5)):
        moved = plan.problem(variant).vertices
        # The rows of the mesh are spread evenly between the line and the edges, so that straight lines stay straight.
        rows = np.interp(V[:, axis], [0.0, 3.0, 6.0], [0.0, 3.0 + distance, 6.0])
        assert np.allclose(moved[:, axis], rows, atol=0.05 if crossing else 1e-12)
        assert np.allclose(moved[line(3), axis], 3.0 + distance, atol=1e-12)
        assert np.array_equal(np.delete(moved, axis, axis=1), np.delete(V, axis, axis=1))
        assert (face_normals(moved, problem.faces)[:, 2] * face_normals(V, problem.faces)[:, 2] > 0.99).all()
    with pytest.raises(CGCError, match="flips"):
        plan.problem(3)


def test_a_support_that_is_raised_takes_the_edges_along():
    mesh = grid("corners")
    corner = N * (N + 1) + N
    moved = Plan(of({"leg": {"kind": "move", "vertices": [corner], "direction": [0, 0, 1], "values": [2.0]}}), mesh.to_problem()).problem(0)
    edge = [k * (N + 1) + N for k in range(N + 1)]
    assert np.allclose(moved.vertices[edge, 2], np.linspace(0, 2, N + 1), atol=1e-12)
    assert moved.vertices[0, 2] == 0.0 and 0.1 < moved.vertices[line(3)[3], 2] < 1.5


# ------------------------------------------------------------------
# Runs
# ------------------------------------------------------------------

STUDY = {"supports": "corners", "parameters": {"K": {"from": 0.004, "to": 0.012, "count": 4}, "rise": [1.0, -1.5]}, "target": 0.01}


def test_the_table_is_what_single_solves_give(tmp_path):
    results = run_study(grid(), of({"K": {"from": 0.005, "to": 0.9, "count": 3}}, membrane={"pressure": -1.0}), tmp_path)
    assert results.columns[:3] == ["variant", "K", "status"] and results.column("variant") == [0, 1, 2]
    mesh = grid(K=0.005)
    alone = solve(mesh)
    row = dict(zip(results.columns, results.rows[0]))
    assert (row["status"], row["verdict"], row["method"], row["steps"]) == ("converged", "fair", "newton", alone.iterations)
    assert np.array_equal(results.vertices(0), alone.vertices) and row["rise"] == alone.vertices[:, 2].max()
    assert results.problem(0).region_targets() == [0.005]
    assert row["compression"] < 0.0
    # A square of 36 cannot carry a K of 0.9, and says so.
    last = dict(zip(results.columns, results.rows[2]))
    assert last["status"] == "refused" and last["rise"] is None and last["note"]
    with pytest.raises(CGCError, match="has no surface"):
        results.vertices(2)


@pytest.mark.parametrize(("method", "solves"), [("projection", 2), ("auto", 6)])
def test_only_what_decides_the_surface_is_solved_again(tmp_path, monkeypatch, method, solves):
    """The strategies are of the flow alone, which auto takes where they are set on creases."""
    mesh = grid("boundary", 0.01, creases=[line(3)])
    study = of({"K": [0.004, 0.006], "s": [0.0, 0.1, 0.2]}, method=method, settings={"steps": 20})
    alone = [Plan(study, mesh.to_problem()).measured(variant) for variant in range(6)]
    count = []
    monkeypatch.setattr(variants, "solve", lambda *args, **more: count.append(1) or solve(*args, **more))
    plan = Plan(study, mesh.to_problem())
    together = {variant: plan.measured(variant) for variant in (3, 0, 5, 4, 1, 2)}
    assert len(count) == solves
    assert all(together[k].row == one.row and np.array_equal(together[k].vertices, one.vertices) for k, one in enumerate(alone))


def test_two_processes_and_a_run_that_was_stopped_give_the_same_table_bit_for_bit(tmp_path):
    mesh, study = grid(), of({"K": {"from": 0.004, "to": 0.02, "count": 20}})
    run_study(mesh, study, tmp_path / "one")
    run_study(mesh, study, tmp_path / "two", workers=2)
    seen = []
    stopped = run_study(mesh, study, tmp_path / "stopped", on_progress=lambda state: seen.append(state) or state.done >= 15)
    assert len(stopped) == 15 and seen[-1].done == 15
    # What a kill leaves: half a row.
    with open(tmp_path / "stopped" / "table.csv", "a", encoding="utf-8") as file:
        file.write("15,0.0101,conv")
    assert len(Results(tmp_path / "stopped")) == 15
    seen.clear()
    run_study(mesh, study, tmp_path / "stopped", on_progress=seen.append)
    assert seen[0].before == 15
    once = files(tmp_path / "one")
    assert files(tmp_path / "two") == once and files(tmp_path / "stopped") == once
    with pytest.raises(CGCError, match="holds another study"):
        run_study(mesh, of({"K": [0.01]}), tmp_path / "one")


@pytest.mark.nightly
def test_a_worker_that_is_killed_costs_nothing_but_time(tmp_path):
    mesh, study = grid(), of({"K": {"from": 0.004, "to": 0.02, "count": 60}})
    run_study(mesh, study, tmp_path / "whole")
    from compas_cgc.execution.pool import WorkerPool

    killed = []
    with WorkerPool(1) as pool:

        def kill(state):
            if state.done >= 16 and not killed:
                killed.extend(pool.processes())
                os.kill(killed[0], signal.SIGKILL if hasattr(signal, "SIGKILL") else signal.SIGTERM)

        run_study(mesh, study, tmp_path / "killed", executor=pool, on_progress=kill)
    assert killed and files(tmp_path / "killed") == files(tmp_path / "whole")


# A command that ends, as by a kill, once 60 variants are in the table.
ENDED = """
import importlib, os, sys
from compas_cgc.cli import main
run = importlib.import_module("compas_cgc.study.run")
study = run.run_study
run.run_study = lambda *args, **more: study(*args, **{**more, "on_progress": lambda state: state.done >= 60 and os._exit(9)})
sys.exit(main(sys.argv[1:]))
"""


@pytest.mark.nightly
def test_a_study_that_is_killed_at_40_percent_goes_on_to_the_same_table(tmp_path):
    write(tmp_path / "roof.json", grid())
    (tmp_path / "study.toml").write_text("[parameters]\nK = { from = 0.004, to = 0.02, count = 150 }\n", encoding="utf-8")
    words = ["study", str(tmp_path / "roof.json"), str(tmp_path / "study.toml"), "--no-pictures", "-q"]

    def run(name, workers, *python):
        return subprocess.run([sys.executable, *python, *words, "-o", str(tmp_path / name), "--workers", workers]).returncode

    assert run("whole", "1", "-m", "compas_cgc") == 0
    assert run("killed", "2", "-c", ENDED) == 9
    assert 60 <= len(Results(tmp_path / "killed")) < 150
    assert run("killed", "2", "-m", "compas_cgc") == 0
    assert files(tmp_path / "killed") == files(tmp_path / "whole")


def test_parquet_holds_the_same_table(tmp_path):
    parquet = pytest.importorskip("pyarrow.parquet", reason="pyarrow is not installed")
    results = run_study(grid(), of({"K": [0.004, 0.9]}), tmp_path)
    table = parquet.read_table(tmp_path / "table.parquet")
    assert table.column_names == results.columns
    assert table.column("rise").to_pylist() == results.column("rise")
    assert table.column("status").to_pylist() == ["converged", "refused"]


# ------------------------------------------------------------------
# What is made of it
# ------------------------------------------------------------------


def test_the_front_is_what_comparing_all_pairs_gives():
    costs = np.random.default_rng(3).integers(0, 12, size=(200, 3)).astype(float)
    beaten = [any((other <= own).all() and (other < own).any() for other in costs) for own in costs]
    assert np.array_equal(non_dominated(costs), ~np.array(beaten))


def test_one_command_gives_table_pictures_and_the_best(tmp_path, capsys):
    write(tmp_path / "roof.json", grid("corners"))
    (tmp_path / "study.toml").write_text(
        'unknown = "all"\n[parameters]\nrise = [0.8, 1.2]\nsupports = ["corners", "boundary"]\n'
        '[pareto]\nleast = "area"\nmost = "volume"\n[best]\nmost = "volume"\ncount = 1\n',
        encoding="utf-8",
    )
    assert main(["study", str(tmp_path / "roof.json"), str(tmp_path / "study.toml"), "-o", str(tmp_path / "out"), "--workers", "1"]) == 0
    results = Results(tmp_path / "out")
    assert results.column("rise asked") == [0.8, 0.8, 1.2, 1.2] and results.column("supports") == ["corners", "boundary"] * 2
    assert np.allclose(results.numbers("rise"), [0.8, 0.8, 1.2, 1.2]) and np.isfinite(results.numbers("K0")).all()
    assert all((tmp_path / "out" / name).stat().st_size > 20_000 for name in ("contact_sheet.png", "pareto.png"))
    best = int(np.argmax(results.numbers("volume")))
    assert (tmp_path / "out" / "best" / f"variant-{best:04d}.3dm").exists()
    assert best in pareto_front(results) and "4 variants: 4 fair" in capsys.readouterr().out


DESIGN = mesh_over(lambda x, y: 1.0 - 0.03 * (x - 4.0) ** 2 - 0.04 * (y - 2.0) ** 2 + 0.004 * (x - 3.0) ** 2 * y, 8.0, 4.0, 0.5)


def test_moulds_and_panels_of_a_design_are_varied(tmp_path):
    study = of({"panel": [2.0, 4.0], "moulds": {"from": 1, "to": 2, "count": 2}}, rationalise={"edges": 3, "within": "15mm"})
    seen = []
    stopped = run_study(DESIGN, study, tmp_path / "panels", on_progress=lambda state: seen.append(state) or state.done == 2)
    assert len(stopped) == 2
    results = run_study(DESIGN, study, tmp_path / "panels", workers=1)
    assert (tmp_path / "panels" / "table.csv").read_bytes() == (
        run_study(DESIGN, study, tmp_path / "again").folder / "table.csv"
    ).read_bytes()
    assert results.column("moulds asked") == [1, 2, 1, 2] and results.column("panels") == [8, 8, 2, 2]
    for variant, (panel, moulds) in enumerate(((2.0, 1), (2.0, 2), (4.0, 1), (4.0, 2))):
        alone = rationalise(DESIGN, panel=panel, moulds=moulds, edges=3, within=0.015)
        row = results.row(variant)
        assert row["distance"] == alone.farthest and row["moulds"] == len(alone.curvatures)
        assert row["status"] == ("converged" if alone.kept else "exceeded") and bool(row["note"]) != alone.kept
    assert {"converged", "exceeded"} == set(results.column("status"))
    assert results.good().tolist() == [k for k, status in enumerate(results.column("status")) if status == "converged"]
    with pytest.raises(CGCError, match="no common mesh"):
        results.vertices(0)
    with pytest.raises(CGCError, match="holds another study"):
        run_study(DESIGN, of({"moulds": [1]}), tmp_path / "panels")


def test_one_command_varies_a_design_and_writes_the_best_panels(tmp_path, capsys):
    vertices, quads = DESIGN
    write(tmp_path / "design.json", CGCMesh.from_vertices_and_faces(vertices.tolist(), quads))
    text = '[parameters]\nmoulds = [1, 3]\n[rationalise]\npanel = 2.0\nedges = 3\n[pareto]\nleast = ["moulds", "distance"]\n'
    (tmp_path / "study.toml").write_text(text, encoding="utf-8")
    assert main(["study", str(tmp_path / "design.json"), str(tmp_path / "study.toml"), "-o", str(tmp_path / "out"), "--workers", "1"]) == 0
    results = Results(tmp_path / "out")
    assert pareto_front(results).tolist() == [0, 1] and "2 variants: 2 fair" in capsys.readouterr().out
    assert (tmp_path / "out" / "pareto.png").exists() and not (tmp_path / "out" / "contact_sheet.png").exists()
    layers = [item.layer for item in list_items(read_archive(tmp_path / "out" / "best" / "variant-0001.3dm"))]
    assert sum(layer.startswith("CGC Rationalised::Moulds::") for layer in layers) == 8


@pytest.mark.parametrize(
    ("data", "said"),
    [
        ({"parameters": {"moulds": [2], "K": [0.1]}}, "moulds is for freeform designs, but K is for drawings"),
        ({"parameters": {"moulds": [2]}, "supports": "corners"}, "but supports is for drawings"),
        ({"parameters": {"panel": [2.0]}, "rationalise": {"panel": 3.0}}, "panel is a parameter and in the table"),
        ({"parameters": {"panel": [2.0]}, "rationalise": {"mould": 3}}, "did you mean 'moulds'"),
        ({"parameters": {"K": [2.0]}, "rationalise": {}}, "the table .rationalise. is for freeform designs, but K is for drawings"),
    ],
)
def test_a_study_is_of_a_drawing_or_of_a_design(data, said):
    with pytest.raises(CGCError, match=said):
        Study.from_dict(data)


def test_a_file_that_is_no_study_is_told_by_its_name(tmp_path):
    (tmp_path / "study.toml").write_text("K = = 3", encoding="utf-8")
    with pytest.raises(CGCError, match="study.toml is not valid TOML"):
        read_study(tmp_path / "study.toml")
    with pytest.raises(CGCError, match="cannot be read"):
        read_study(tmp_path / "none.toml")
