"""``compas-cgc rationalise``: a design in, panels on moulds out."""

from __future__ import annotations

import json
import os
import types
from contextlib import nullcontext
from pathlib import Path

import pytest

from compas_cgc import read
from compas_cgc.cli import rationalise as cli_rationalise
from compas_cgc.cli.exits import INCOMPLETE
from compas_cgc.cli.exits import INTERRUPTED
from compas_cgc.cli.exits import REFUSED
from compas_cgc.cli.main import main
from compas_cgc.cli.rationalise import length
from compas_cgc.errors import CGCError
from compas_cgc.io import write
from compas_cgc.io.rhino.archive import list_items
from compas_cgc.io.rhino.archive import read_archive
from compas_cgc.model.problem import CGCProblem

from ..support.freeform import mesh_over


def written(path, heights):
    vertices, quads = mesh_over(heights, 8.0, 4.0, 0.25)
    triangles = [triangle for a, b, c, d in quads for triangle in ((a, b, c), (a, c, d))]
    write(path, CGCProblem(vertices, triangles))
    return path


@pytest.fixture
def design(tmp_path):
    return written(tmp_path / "roof.3dm", lambda x, y: 1.0 - 0.03 * (x - 4.0) ** 2 - 0.04 * (y - 2.0) ** 2)


@pytest.fixture
def skew_design(tmp_path):
    """A design without mirrors, whose panels all have moulds of their own."""
    return written(tmp_path / "skew.3dm", lambda x, y: 1.0 - 0.03 * (x - 4.0) ** 2 - 0.04 * (y - 2.0) ** 2 + 0.004 * (x - 3.0) ** 2 * y)


def test_a_design_becomes_panels_with_a_report_and_is_read_by_the_mould_command(design, tmp_path):
    out, report = tmp_path / "panels.3dm", tmp_path / "panels.json"
    code = main(
        ["rationalise", str(design), "-o", str(out), "--panel", "2", "--edges", "4", "--moulds", "2", "--report", str(report), "-q"]
    )
    record = json.loads(report.read_text(encoding="utf-8"))
    assert code == 0 and record["status"] == "kept"
    assert len(record["curvatures"]) == 2 and sum(record["panels_per_class"]) == record["panels"] == 8
    assert 0.0 < record["distance"]["rms"] < record["distance"]["max"] < 0.05
    layers = [item.layer for item in list_items(read_archive(out))]
    assert sum(layer.startswith("CGC Rationalised::Moulds::") for layer in layers) == 8
    assert "CGC Rationalised::Distance" in layers and "CGC Rationalised::Seams" in layers
    moulds = tmp_path / "moulds.json"
    command = ["mould", str(out), "-o", str(tmp_path / "moulds.3dm"), "--count", "1", "--no-page", "--report", str(moulds), "-q"]
    assert main(command) == 0
    gaps = [panel["gap"] for panel in json.loads(moulds.read_text(encoding="utf-8"))["panels"]]
    assert len(gaps) == 8 and max(gaps) < 1e-9
    assert read(out) is not None


def test_costs_and_weights_are_read_from_the_command_line(design, tmp_path, capsys):
    report = tmp_path / "panels.json"
    command = ["rationalise", str(design), "-o", str(tmp_path / "panels.3dm"), "--panel", "2", "--edges", "4", "--report", str(report)]
    prices = ["--cost", "flat", "0", "1000", "--cost", "sphere", "50", "400", "--cost", "saddle", "9000", "700"]
    weighted = ["--weight", "4", "2", "1", "1.5", "10", "--sweep", "1"]
    assert main([*command, "--moulds", "1", *weighted, *prices]) == 0
    record = json.loads(report.read_text(encoding="utf-8"))
    assert record["costs"] == {"moulds": 0.0, "panels": 8000.0} and "costs: 8,000, moulds 0 and panels 8,000" in capsys.readouterr().out
    assert record["weighted_distance"] > record["distance"]["max"] > 0.0
    table = (tmp_path / "panels.csv").read_text(encoding="utf-8").splitlines()
    assert table[0].split(",")[-2:] == ["costs", "status"] and table[1].split(",")[-2] == "8000.0"
    for wrong, sentence in (
        (["--cost", "sphere", "dear", "450"], "two numbers"),
        (["--cost", "flat", "0", "1"], "costs must be given for"),
        ([*prices, "--cost", "flat", "0", "1"], "given twice for one kind"),
    ):
        assert main([*command, *wrong]) == REFUSED
        assert sentence in capsys.readouterr().err


def test_radii_and_weights_have_units_and_the_sweep_keeps_the_distance(design, tmp_path, capsys):
    out, report = tmp_path / "panels.3dm", tmp_path / "panels.json"
    command = ["rationalise", str(design), "-o", str(out), "--panel", "2", "--edges", "4", "--report", str(report)]
    assert main([*command, "--radii", "12000mm", "-2500cm", "inf", "--weight", "4", "200cm", "1", "1500mm", "10", "-q"]) == 0
    by_units = json.loads(report.read_text(encoding="utf-8"))
    assert main([*command, "--radii", "12", "-25", "inf", "--weight", "4", "2", "1", "1.5", "10", "-q"]) == 0
    record = json.loads(report.read_text(encoding="utf-8"))
    assert by_units["classes"] == record["classes"]
    assert by_units["weighted_distance"] == pytest.approx(record["weighted_distance"], rel=1e-6)
    assert all(radius is None or min(abs(radius - 12.0), abs(radius + 25.0)) < 1e-9 for radius in record["radii"])
    for wrong, sentence in (
        (["--radii", "12furlongs"], "--radii has the unknown unit"),
        (["--weight", "4", "2", "1", "1.5", "10mm"], "needs a factor without a unit"),
    ):
        assert main([*command, *wrong]) == REFUSED
        assert sentence in capsys.readouterr().err
    assert main([*command, "--within", "15mm", "--sweep", "1", "4"]) == 0
    assert "within the distance" in capsys.readouterr().out
    head, flat, curved = ((line.split(",")) for line in (tmp_path / "panels.csv").read_text(encoding="utf-8").splitlines())
    kept = [dict(zip(head, row)) for row in (flat, curved)]
    assert [row["kept"] for row in kept] == ["False", "True"] and float(kept[0]["max"]) > 0.015 > float(kept[1]["max"])


def test_a_second_run_keeps_moulds_and_locked_panels(skew_design, tmp_path, capsys):
    def run(name, *more):
        command = ["rationalise", str(skew_design), "-o", str(tmp_path / f"{name}.3dm"), "--panel", "2", "--edges", "4"]
        code = main([*command, "--report", str(tmp_path / f"{name}.json"), "-q", *more])
        return code, json.loads((tmp_path / f"{name}.json").read_text(encoding="utf-8")) if code == 0 else None

    _, first = run("first", "--moulds", "3", "--flat")
    locked = {panel: (first["classes"][panel] + 1) % len(first["curvatures"]) for panel in (0, 5)}
    wrong = {**first, "classes": [locked.get(panel, own) for panel, own in enumerate(first["classes"])]}
    (tmp_path / "wrong.json").write_text(json.dumps(wrong), encoding="utf-8")
    code, second = run("second", "--keep", str(tmp_path / "wrong.json"), "--locked", "0", "5")
    used = [first["curvatures"].index(pytest.approx(K)) for K in second["curvatures"]]
    assert code == 0 and [used[second["classes"][panel]] for panel in locked] == list(locked.values())
    code, free = run("free", "--keep", str(tmp_path / "first.json"))
    assert code == 0 and free["distance"]["max"] < second["distance"]["max"]
    for options, sentence in (
        (["--locked", "0"], "--locked needs --keep"),
        (["--keep", str(tmp_path / "first.json"), "--locked", "99"], "has panels 0 to 7, not 99"),
        (["--keep", str(skew_design)], "is no report of compas-cgc rationalise"),
    ):
        assert run("refused", *options)[0] != 0 and sentence in capsys.readouterr().err


def test_panels_are_drawn_as_surfaces_on_demand(design, tmp_path, capsys):
    out = tmp_path / "panels.3dm"
    command = ["rationalise", str(design), "-o", str(out), "--panel", "2", "--edges", "4", "--moulds", "2", "--nurbs"]
    assert main([*command, "--report", str(tmp_path / "panels.json")]) == 0
    record = json.loads((tmp_path / "panels.json").read_text(encoding="utf-8"))
    (note,), (figures,) = record["files"], record["surfaces"]
    seams = figures["kinks_at_seams"]
    assert figures["surfaces"] == 8 and len(seams) == 10 and figures["kinks"]["100"] == seams[0]["largest"] >= seams[-1]["largest"]
    for seam in seams:
        # Panels are 2 m wide, so that one coordinate of a place on a seam is a multiple of that.
        x, y, _ = seam["place"]
        assert len(seam["regions"]) == 2 and min(abs(x - 2.0 * round(x / 2.0)), abs(y - 2.0 * round(y / 2.0))) < 0.02
    assert note.startswith("8 NURBS surfaces") and "kinks at smooth seams" in note and note in capsys.readouterr().out
    names = [item.name for item in list_items(read_archive(out)) if item.layer == "CGC::NURBS"]
    assert sum(name.startswith("region") for name in names) == 8
    code = main(["rationalise", str(design), "-o", str(tmp_path / "panels.obj"), "--nurbs", "-q"])
    assert code != 0 and "--nurbs requires a .3dm" in capsys.readouterr().err


def test_a_distance_that_is_exceeded_has_an_exit_code_and_a_suggestion(design, tmp_path, capsys):
    out = tmp_path / "panels.3dm"
    code = main(["rationalise", str(design), "-o", str(out), "--panel", "4", "--edges", "4", "--moulds", "1", "--within", "1mm"])
    assert code == 1 and out.exists()
    assert "try" in capsys.readouterr().out


@pytest.mark.parametrize(
    ("text", "units", "value"), [("30mm", "Meters", 0.03), ("2.5", "Millimeters", 2.5), ("2.5 m", "Millimeters", 2500.0)]
)
def test_lengths_have_units(text, units, value):
    assert length(text, units, "--panel") == pytest.approx(value)


@pytest.mark.parametrize("text", ["x", "-1", "3 miles", "inf", ""])
def test_lengths_that_are_not_understood_are_refused(text):
    with pytest.raises(CGCError, match="--panel"):
        length(text, "Meters", "--panel")


def test_a_sweep_appears_together_with_the_surface(design, tmp_path, monkeypatch):
    out, put, real = tmp_path / "panels.obj", [], os.replace
    monkeypatch.setattr(os, "replace", lambda a, b: (put.append(Path(b).name), real(a, b)))
    command = ["rationalise", str(design), "-o", str(out), "--panel", "2", "--edges", "4", "--moulds", "2", "--sweep", "1", "2", "-q"]
    assert main([*command, "--report", str(tmp_path / "panels.json")]) == 0
    assert put[0].endswith(".journal") and put[1:] == ["panels.obj", "panels.json", "panels.csv", "panels.png"]
    assert [row.split(",")[0] for row in out.with_suffix(".csv").read_text().splitlines()] == ["moulds", "1", "2"]


@pytest.mark.parametrize("failing", ["panels.json", "panels.png"])
def test_an_output_that_cannot_be_written_does_not_lose_the_surface(design, tmp_path, capsys, failing):
    out = tmp_path / "panels.obj"
    out.with_suffix(".csv").write_text("old")
    (tmp_path / failing).mkdir()
    command = ["rationalise", str(design), "-o", str(out), "--panel", "2", "--edges", "4", "--moulds", "2", "--sweep", "1", "-q"]
    assert main([*command, "--report", str(tmp_path / "panels.json")]) == INCOMPLETE
    assert f"{failing} is a folder" in capsys.readouterr().err
    assert out.exists() and (out.with_suffix(".csv").read_text() == "old") == (failing == "panels.png")


def test_a_surface_that_cannot_be_written_is_saved_elsewhere(design, tmp_path, capsys, monkeypatch):
    (tmp_path / "full.obj").mkdir()
    monkeypatch.setattr("tempfile.tempdir", str(tmp_path))
    command = ["rationalise", str(design), "-o", str(tmp_path / "full.obj"), "--panel", "2", "--edges", "4", "--moulds", "2", "-q"]
    assert main([*command, "--report", str(tmp_path / "r.json")]) == REFUSED
    message = capsys.readouterr().err
    assert "is a folder" in message and "saved the surface to" in message and not (tmp_path / "r.json").exists()
    assert [path.name for path in tmp_path.glob("compas_cgc-*/*")] == ["full.obj"]


def test_an_interrupted_sweep_is_written_as_far_as_it_came_and_has_an_exit_code(design, tmp_path, monkeypatch):
    real = cli_rationalise._sweep

    def interrupted(*given):
        monkeypatch.setattr(cli_rationalise, "interruptible", lambda: nullcontext(types.SimpleNamespace(is_set=lambda: True)))
        return real(*given)

    monkeypatch.setattr(cli_rationalise, "_sweep", interrupted)
    out = tmp_path / "panels.obj"
    command = ["rationalise", str(design), "-o", str(out), "--panel", "2", "--edges", "4", "--moulds", "2", "--sweep", "1", "2", "-q"]
    assert main(command) == INTERRUPTED
    assert out.exists() and len(out.with_suffix(".csv").read_text().splitlines()) == 2 and out.with_suffix(".png").exists()


def test_an_interrupted_search_leaves_earlier_outputs_alone(design, tmp_path, monkeypatch):
    monkeypatch.setattr(cli_rationalise, "interruptible", lambda: nullcontext(types.SimpleNamespace(is_set=lambda: True)))
    for name in ("panels.obj", "panels.json", "panels.csv", "panels.png"):
        (tmp_path / name).write_text("old")
    out = tmp_path / "panels.obj"
    command = ["rationalise", str(design), "-o", str(out), "--panel", "2", "--edges", "4", "--moulds", "2", "--sweep", "1", "-q"]
    assert main([*command, "--report", str(tmp_path / "panels.json")]) == INTERRUPTED
    assert {path.read_text() for path in tmp_path.glob("panels.???*") if "unfinished" not in path.name} == {"old"}
    assert sorted(path.name for path in tmp_path.glob("*.unfinished.*")) == ["panels.unfinished.json", "panels.unfinished.obj"]
