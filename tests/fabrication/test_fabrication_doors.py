"""Patterns, forces and curves by the command line, by Grasshopper, and as the tutorial has them."""

from __future__ import annotations

import re
import shutil
from pathlib import Path

import numpy as np
import pytest

import compas_cgc
from compas_cgc import CGCMesh
from compas_cgc import CGCProblem
from compas_cgc import write
from compas_cgc.cli import main
from compas_cgc.errors import CGCError
from compas_cgc.fabrication import curve_net
from compas_cgc.fabrication import membrane
from compas_cgc.fabrication import option_values
from compas_cgc.fabrication import plane_quads
from compas_cgc.fabrication import unroll
from compas_cgc.fabrication.option_values import sheet
from compas_cgc.fabrication.piece_list import cut_list

from ..support.constant_curvature import cone
from ..support.constant_curvature import revolved_patch
from ..support.gh_stand_ins import Point3d
from ..support.gh_stand_ins import place
from ..support.gh_stand_ins import rhino  # noqa: F401
from ..support.tables import rows_and_notes

DOCS = Path(__file__).parents[2] / "docs"


@pytest.fixture(scope="module")
def files(tmp_path_factory):
    """A solved cone, dome and saddle, and a crumpled cone."""
    folder = tmp_path_factory.mktemp("solved")
    rng = np.random.default_rng(2)
    vertices, faces = cone(6, 24)
    for name, shape, K in (
        ("cone", (vertices, faces), 0.0),
        ("rough", (vertices + 0.1 * rng.standard_normal(vertices.shape), faces), 0.0),
        ("dome", revolved_patch(10, 0.02), 0.02),
        ("saddle", revolved_patch(10, -0.02), -0.02),
    ):
        write(folder / f"{name}.3dm", CGCProblem(*shape).with_supports("boundary").with_targets(K))
    return folder


@pytest.fixture(scope="module")
def patterns():
    """The cone on sheets of 6 m by 3 m, as Python gives it."""
    return unroll(CGCProblem(*cone(6, 24)).with_supports("boundary").with_targets(0.0), (6.0, 3.0))


def test_commands_write_what_python_gives(files, patterns, tmp_path, capsys):
    cut = ["-o", str(tmp_path / "cut.svg"), "-o", str(tmp_path / "cut.csv")]
    assert main(["unroll", str(files / "cone.3dm"), *cut, "--sheet", "6x3"]) == 0
    assert patterns.summary() in capsys.readouterr().out
    assert main(["membrane", str(files / "dome.3dm"), "-o", str(tmp_path / "forces.inp"), "--pressure", "2"]) == 0
    assert "equilibrium to" in capsys.readouterr().out
    assert main(["net", str(files / "saddle.3dm"), "-o", str(tmp_path / "net.json"), "--spacing", "1"]) == 0
    assert "asymptotic curves" in capsys.readouterr().out
    assert {path.name for path in tmp_path.iterdir()} == {"cut.svg", "cut.csv", "forces.inp", "net.json"}
    assert main(["unroll", str(files / "cone.3dm"), "-o", str(tmp_path / "quiet.svg"), "--sheet", "9x9", "-q"]) == 0
    assert not any(capsys.readouterr()) and (tmp_path / "quiet.svg").exists()


def test_the_command_line_has_every_option_of_sheets(files, tmp_path, capsys):
    pytest.importorskip("shapely")
    words = ["unroll", str(files / "cone.3dm"), "--sheet", "6x3", "--margin", ".02", "--spacing", ".03", "--allowance", ".04"]
    out = ["-o", str(tmp_path / "cut.svg"), "-o", str(tmp_path / "cut.list.csv"), "-o", str(tmp_path / "cut.plan.svg"), "--per-sheet"]
    assert main([*words, *out]) == 0
    made = unroll(
        CGCProblem(*cone(6, 24)).with_supports("boundary").with_targets(0.0), (6.0, 3.0), margin=0.02, spacing=0.03, allowance=0.04
    )
    said = capsys.readouterr().out
    assert made.summary() in said and "free: 30 mm between pieces, 20 mm along edges, 40 mm around pieces" in said
    digits = len(str(made.sheets))
    sheets = {f"cut-{number:0{digits}d}.svg" for number in range(1, made.sheets + 1)}
    assert {path.name for path in tmp_path.iterdir()} == {*sheets, "cut.list.csv", "cut.plan.svg"}
    assert said.count("wrote ") == made.sheets + 2


@pytest.mark.parametrize(
    ("words", "sentence"),
    [
        (("unroll", "rough.3dm", "-o", "out.dxf"), "the surface is rough"),
        (("unroll", "rough.3dm", "-o", "out.dxf", "--rough"), "does not unroll"),
        (("unroll", "cone.3dm", "-o", "out.dxf", "--sheet", "large"), "--sheet must be LENGTHxWIDTH"),
        (("unroll", "cone.3dm", "-o", "out.dxf", "--strain", "much"), "--strain must be a number"),
        (("unroll", "cone.3dm", "-o", "out.dxf", "--seam", "0,1"), "none of the given seams opens"),
        (("unroll", "cone.3dm", "-o", "out.pdf"), "patterns are written to .dxf"),
        (("unroll", "cone.3dm", "-o", "new/out.dxf", "--sheet", "3x1.5", "--margin", ".8"), "margins of 0.8 leave no room on a sheet"),
        (("unroll", "cone.3dm", "-o", "new/out.zip", "--sheet", "3x1.5", "--allowance", ".5"), "an allowance of 0.5 leaves no room"),
        (("unroll", "cone.3dm", "-o", "out.dxf", "--allowance", "-1"), "allowance around pieces must be at least 0"),
        (("unroll", "cone.3dm", "-o", "new/out.zip", "--sheet", "3x1.5", "--whole"), "more than a sheet of 3000 x 1500 mm; use larger"),
        (("membrane", "dome.3dm", "-o", "out.3dm"), "membrane forces need a load"),
        (("membrane", "cone.3dm", "-o", "out.3dm", "--pressure", "1"), "has K = 0"),
        (("net", "saddle.3dm", "-o", "out.3dm", "--through", "1,2"), "--through must be X,Y,Z"),
        (("net", "saddle.3dm", "-o", "out.3dm", "--region", "4"), "there is no region 4; the mesh has 1"),
    ],
)
def test_wrong_orders_end_in_a_sentence_and_write_nothing(files, tmp_path, capsys, words, sentence):
    command, source, flag, out, *rest = words
    assert main([command, str(files / source), flag, str(tmp_path / out), *rest]) == 2
    assert sentence in capsys.readouterr().err
    assert not list(tmp_path.iterdir())


def test_sheets_are_given_in_the_units_of_the_drawing_or_in_others():
    assert sheet("3.0x1.5", "the sheet").within("Meters") == sheet([3.0, 1.5], "the sheet").within(None) == (3.0, 1.5)
    assert sheet("3000 x 1500mm", "the sheet").within("Meters") == pytest.approx((3.0, 1.5))
    assert sheet("3x1.5m", "the sheet").within("Millimeters") == pytest.approx((3000.0, 1500.0))


def test_check_says_how_wide_flat_sheets_may_be(files, capsys):
    main(["check", str(files / "dome.3dm")])
    assert "the strain of flat sheets is at most 0.2 % up to a width of 1.5 m (square)" in capsys.readouterr().out


@pytest.mark.nightly
def test_the_tutorial_does_what_it_says(tmp_path, monkeypatch, capsys):
    own = (DOCS / "fabrication.md").read_text(encoding="utf-8").split("## From a drawing to cut sheets")[1].split("\n## ")[0]
    text = (DOCS / "tutorials" / "vault.md").read_text(encoding="utf-8") + own
    monkeypatch.chdir(tmp_path)
    shutil.copy(compas_cgc.get("vault.3dm"), "vault.3dm")
    scope: dict = {}
    for language, block in re.findall(r"```(py|python|sh)\n(.*?)```", text, re.S):
        if language != "sh":
            exec(compile(block, language, "exec"), scope)
        for line in block.splitlines() if language == "sh" else ():
            assert main(line.split()[1:]) == 0, line
    said = capsys.readouterr().out
    assert "20 pieces" in said and "unrolls into flat sheets without strain" in said
    assert {path.suffix for path in tmp_path.iterdir()} == {".3dm", ".dxf", ".csv"}
    assert len(scope["outlines"]) == len(scope["patterns"].pieces)


# ----------------------------------------------------------------------
# Grasshopper
# ----------------------------------------------------------------------


def solved(shape, K) -> CGCMesh:
    return CGCMesh.from_problem(CGCProblem(*shape).with_supports("boundary").with_targets(K))


@pytest.mark.usefixtures("rhino")
def test_the_component_unroll(patterns, tmp_path):
    mesh = solved(cone(6, 24), 0.0)
    path = tmp_path / "cut.dxf"
    out = place("Unroll").settle(cgc_mesh=mesh, length=6.0, width=3.0, path=str(path), write=True)
    assert out["labels"] == [piece.label for piece in patterns.pieces]
    assert len(out["pieces"]) == len(out["places"]) == len(patterns.pieces) == len(out["outlines"])
    assert out["report"] == patterns.summary() and path.exists() and out["allowances"] == []
    assert [row["piece"] for row in rows_and_notes(out["cut_list"])[0]] == [row[1] for row in cut_list(patterns)]


@pytest.mark.usefixtures("rhino")
def test_the_component_unroll_leaves_margins_and_allowances_free(tmp_path):
    pytest.importorskip("shapely")
    mesh = solved(cone(6, 24), 0.0)
    given = {"margin": 0.02, "allowance": 0.03, "spacing": 0.0}
    out = place("Unroll").settle(cgc_mesh=mesh, length=6.0, width=3.0, **given, path=str(tmp_path / "cut.dxf"), write=True, per_sheet=True)
    patterns = unroll(mesh, (6.0, 3.0), **given)
    assert out["report"] == patterns.summary() and len(out["allowances"]) == len(out["outlines"]) == len(patterns.pieces)
    assert len(list(tmp_path.iterdir())) == patterns.sheets > 1


@pytest.mark.usefixtures("rhino")
def test_the_component_unroll_refuses_a_panel_that_is_larger_than_a_sheet(tmp_path):
    placed = place("Unroll")
    given = {"length": 3.0, "width": 1.5, "path": str(tmp_path / "cut.svg"), "write": True}
    assert placed.settle(cgc_mesh=solved(cone(6, 24), 0.0), **given, whole=True)["report"] is None
    assert "more than a sheet of 3000 x 1500 mm" in placed.said("Error")[0] and not list(tmp_path.iterdir())


@pytest.mark.usefixtures("rhino")
def test_the_component_membrane():
    mesh = solved(revolved_patch(8, 0.02), 0.02)
    out = place("Membrane").settle(cgc_mesh=mesh, pressure=2.0)
    assert out["report"] == membrane(mesh, 2.0).summary()
    assert len(out["N1"]) == mesh.number_of_vertices() and min(out["N2"]) > 0
    assert not out["compression"] and len(out["tension"]) == 2 * mesh.number_of_faces()
    placed = place("Membrane")
    assert placed.settle(cgc_mesh=solved(cone(5, 20), 0.0))["report"] is None
    assert "K = 0" in placed.said("Error")[0]


@pytest.mark.usefixtures("rhino")
def test_the_component_net():
    mesh = solved(revolved_patch(12, -0.02), -0.02)
    out = place("Net").settle(cgc_mesh=mesh, spacing=1.0)
    net = curve_net(mesh, 1.0)
    assert len(out["first"]) + len(out["second"]) == len(net.curves) and out["sides"] == net.lengths.tolist()
    through = place("Net").settle(cgc_mesh=mesh, through=[Point3d(0.0, 0.0, 4.0)])
    assert len(through["first"]) == len(through["second"]) == 1


@pytest.mark.usefixtures("rhino")
def test_the_component_quads(tmp_path):
    mesh = solved(revolved_patch(12, 0.02), 0.02)
    path = tmp_path / "roof.flat.dxf"
    out = place("Quads").settle(cgc_mesh=mesh, spacing=1.2, depth=0.1, path=str(path), write=True)
    quads = plane_quads(mesh, 1.2, depth=0.1)
    assert len(out["faces"]) == len(quads.faces) and len(out["beams"]) == len(quads.edges) and path.exists()
    assert out["planarity"] == quads.planarity.tolist() and out["twist"] == quads.twist.tolist() and out["report"] == quads.summary()
    assert len(out["nodes"]) == len(out["axes"]) == len(quads.vertices)


def test_a_strain_given_in_percent_without_its_sign_is_refused():
    with pytest.raises(CGCError, match=r"of 0.5 means 50 %, which breaks any sheet; add a percent sign if 0.5% was intended"):
        option_values.strain("0.5", "--strain")
    assert option_values.strain("0.5%", "--strain") == option_values.strain("0.005", "--strain") == 0.005
