"""The command line as a user meets it: real processes, real files."""

from __future__ import annotations

import io
import json
import os
import re
import signal
import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pytest

from compas_cgc import CGCMesh
from compas_cgc import check
from compas_cgc import settings_for
from compas_cgc.cli import main
from compas_cgc.cli.arguments import settings_of
from compas_cgc.cli.console import ProgressBar
from compas_cgc.cli.exits import ROUGH
from compas_cgc.cli.main import COMMANDS
from compas_cgc.cli.main import build_parser
from compas_cgc.discrete import gaussian_curvature
from compas_cgc.model.result import History
from compas_cgc.model.result import Solution
from compas_cgc.model.result import SolveState
from compas_cgc.solvers import METHODS
from compas_cgc.solvers import Method
from compas_cgc.solvers import Settings
from compas_cgc.solvers import options as all_options
from compas_cgc.solvers.settings import option

from ..support.server_process import PATIENCE

ROOT = Path(__file__).parents[2]
ROOFS = ROOT / "examples"


def command(*arguments, **options):
    """Run ``compas-cgc`` as a process of its own."""
    words = [sys.executable, "-m", "compas_cgc", *map(str, arguments)]
    return subprocess.run(words, capture_output=True, text=True, encoding="utf-8", cwd=ROOT, **options)


def call(*arguments):
    """Run ``compas-cgc`` in this process, which is quicker."""
    return main([str(argument) for argument in arguments])


@pytest.fixture
def dome(tmp_path):
    """Return a mesh file that is solved in a moment."""
    mesh = CGCMesh.from_meshgrid(dx=9, nx=9)
    mesh.set_supports("boundary")
    path = tmp_path / "dome.json"
    mesh.to_json(path)
    return path


def test_a_law_is_solved_for_and_kept_in_the_file(dome, tmp_path, capsys):
    out = tmp_path / "cushion.json"
    assert call("solve", dome, "-o", out, "--target", "0.01", "--law", "0=H = 0.05") == 0
    assert "H = 0.05 as prescribed" in capsys.readouterr().out
    assert str(CGCMesh.from_json(out).region_law(0)) == "H = 0.05"


def test_the_main_job_as_the_readme_says(tmp_path):
    out, report = tmp_path / "roof.3dm", tmp_path / "report.json"
    done = command("solve", ROOFS / "nine_regions.3dm", "-o", out, "--target", "0.01", "--target", "4=0.04", "--report", report)
    assert done.returncode == 0, done.stderr
    # In a new clone the kernels are compiled first, and that is said.
    assert "converged" in done.stdout and done.stderr in ("", "compiling (first use only); this takes some seconds\n")
    written = json.loads(report.read_text(encoding="utf-8"))
    assert written["status"] == "converged"
    assert [region["target"] for region in written["regions"]] == [0.01] * 4 + [0.04] + [0.01] * 4
    # The solve meets K to rounding; measured on the vertices alone, K is of second order in the length of the edges.
    assert "largest |K - K̄|" in written["message"] and written["verdict"]["fair"]
    assert max(region["rms_error"] for region in written["regions"]) <= 0.1 * 0.04

    import rhino3dm

    model = rhino3dm.File3dm.Read(str(out))
    (layer,) = [layer.Index for layer in model.Layers if layer.FullPath == "CGC Result::Mesh"]
    (mesh,) = [item.Geometry for item in model.Objects if item.Attributes.LayerIndex == layer]
    vertices = np.array([(p.X, p.Y, p.Z) for p in mesh.Vertices.ToPoint3dArray()])
    faces = np.array([mesh.Faces[i][:3] for i in range(len(mesh.Faces))])
    K = gaussian_curvature(vertices, faces)
    inner = np.abs(vertices[:, :2] - 7.5).max(axis=1) < 2.0
    assert np.median(K[inner]) == pytest.approx(0.04, rel=0.1)
    assert model.Settings.ModelUnitSystem == rhino3dm.UnitSystem.Meters


def test_a_curved_crease_and_a_boundary_of_points(tmp_path):
    out = tmp_path / "leaf.3dm"
    assert call("solve", ROOFS / "curved_crease.3dm", "-o", out, "--target", "0.005") == 0
    again = tmp_path / "again.3dm"
    assert call("solve", out, "-o", again, "--target", "0.005") == 0, "a result must itself be a valid input"


@pytest.mark.parametrize("suffix", ["3dm", "obj", "ply", "off", "stl", "json"])
def test_every_format_goes_out_and_comes_in_again(dome, tmp_path, suffix, capsys):
    out = tmp_path / f"roof.{suffix}"
    assert call("solve", dome, "-o", out, "--target", "0.01") == 0
    assert "converged" in capsys.readouterr().out
    back = tmp_path / "back.json"
    supports = [] if suffix in ("3dm", "json") else ["--supports", "boundary"]
    # The surface is solved already, to the digits that the format keeps.
    assert call("solve", out, "-o", back, "--target", "0.01", *supports) == 0
    farthest = re.search(r"moved by (\S+) at most", capsys.readouterr().out)
    assert farthest is not None and float(farthest[1]) < 1e-5


def test_a_picture_is_drawn_beside_the_surface(dome, small_pictures, tmp_path, capsys):
    from PIL import Image

    solving = ("solve", dome, "-o", tmp_path / "roof.json", "--target", "0.01")
    drawn = {}
    for of in ("K", "zebra"):
        path = tmp_path / f"{of}.png"
        assert call(*solving, "--picture", path, "--picture-of", of) == 0 and f"wrote {path}" in capsys.readouterr().out
        drawn[of] = np.asarray(Image.open(path).convert("RGB"), dtype=float)
    red, green = drawn["K"][..., 0], drawn["K"][..., 1]
    assert (red - green > 40).mean() > 0.1, "K > 0 is red"
    dark = drawn["zebra"].max(axis=2) < 80
    assert 0.05 < dark.mean() < 0.6 and np.count_nonzero(np.diff(dark[dark.shape[0] // 2].astype(int))) > 8, "there are stripes"
    assert call(*solving[:3], tmp_path / "none.json", "--picture", tmp_path / "roof.gif") == 2
    assert "the suffix of a picture must be" in capsys.readouterr().err and not (tmp_path / "none.json").exists()


@pytest.mark.nightly
def test_strategies_and_flip(tmp_path, capsys):
    heights = {}
    for name, options in {"s": ["--s", "0.5"], "flip": ["--flip", "--s", "0.5"]}.items():
        out = tmp_path / f"{name}.json"
        # Either is written; at corners the flow leaves tips, which a verdict of rough names.
        assert call("solve", ROOFS / "nine_regions.3dm", "-o", out, "--target", "0.005", *options) in (0, 3)
        z = [CGCMesh.from_json(out).vertex_coordinates(v)[2] for v in CGCMesh.from_json(out).vertices()]
        heights[name] = max(z, key=abs)
    assert heights["flip"] == pytest.approx(-heights["s"], rel=0.05)


def test_a_pipe_gets_no_progress_and_a_terminal_does():
    state = SolveState(5, 10, 1.0, 0.1, 0.01, 0.1, 1, 0.2, np.zeros((1, 3)))

    class Terminal(io.StringIO):
        def isatty(self):
            return True

    for stream, shows in ((io.StringIO(), False), (Terminal(), True)):
        bar = ProgressBar(stream)
        bar(state)
        assert ("step 5 of at most 10, largest error 0.01" in stream.getvalue()) is shows
        bar.close()
        assert stream.getvalue().endswith("\r") is shows


# ----------------------------------------------------------------------
# What goes wrong
# ----------------------------------------------------------------------


def test_a_solve_that_does_not_converge_keeps_the_old_file(dome, tmp_path, capsys):
    out = tmp_path / "roof.json"
    out.write_text("precious")
    assert call("solve", dome, "-o", out, "--target", "0.01", "--method", "flow", "--steps", "5", "--report", tmp_path / "r.json") == 1
    assert json.loads((tmp_path / "r.unfinished.json").read_text())["surface"] == "roof.unfinished.json"
    assert not (tmp_path / "r.json").exists(), "a report does not stand beside the surface of another solve"
    said = capsys.readouterr()
    assert "not converged in 5 steps" in said.err and "roof.unfinished.json" in said.err
    assert out.read_text() == "precious"
    assert CGCMesh.from_json(tmp_path / "roof.unfinished.json").number_of_vertices() == 100


def test_too_much_curvature_is_refused_with_the_number(dome, tmp_path, capsys):
    out = tmp_path / "roof.json"
    assert call("solve", dome, "-o", out, "--target", "0.05") == 2
    said = capsys.readouterr().err
    assert said.startswith("compas-cgc: the target 0.05 is too large for this boundary") and "0.0387" in said
    assert not out.exists()


REFUSED = [
    (["solve", "missing.3dm", "-o", "out.3dm", "--target", "1"], "missing.3dm"),
    (["solve", "DOME", "-o", "out.xyz", "--target", "0.01"], ".xyz"),
    (["solve", "DOME", "-o", "out.json", "--target", "much"], "--target must be a number or REGION=NUMBER"),
    (["solve", "DOME", "-o", "out.json", "--target", "7=0.01"], "there is no region 7"),
    (["solve", "DOME", "-o", "out.json"], "no target curvature is set"),
    (["solve", "DOME", "-o", "out.json", "--law", "H of 2"], "--law: 'H of 2' is not a law; write minimal"),
    (["solve", "DOME", "-o", "out.json", "--law", "7=minimal"], "there is no region 7"),
    (["solve", "DOME", "-o", "out.json", "--law", "H = 0.3"], "|H| is at most 0.222"),
    (["solve", "DOME", "-o", "out.json", "--target", "0.01", "--s", "3"], "s must be between 0 and 1"),
    (["solve", "DOME", "-o", "out.json", "--target", "0.01", "--method", "magic"], "method must be one of"),
    (["solve", "DOME", "-o", "out.json", "--target", "0.01", "--steps", "0"], "steps must be a whole number from 1 up"),
    (["solve", "DOME", "-o", "out.json", "--target", "0.01", "--s", "0.5", "--method", "newton"], "s is a setting of flow, not of newton"),
    (["solve", "GARBAGE", "-o", "out.json", "--target", "0.01"], "garbage.3dm"),
    (["solve", "EMPTY", "-o", "out.json", "--target", "0.01"], "empty.obj"),
    (["example", "4", "--variant", "z"], "Example 4 has no variant 'z'"),
]


@pytest.mark.parametrize("words, sentence", REFUSED, ids=[sentence for _, sentence in REFUSED])
def test_bad_input_ends_in_one_sentence(dome, tmp_path, monkeypatch, capsys, words, sentence):
    (tmp_path / "garbage.3dm").write_bytes(b"3D Geometry File Format        2" + bytes(range(256)) * 4)
    (tmp_path / "empty.obj").write_text("")
    monkeypatch.chdir(tmp_path)
    before = sorted(path.name for path in tmp_path.iterdir())
    places = {"DOME": str(dome), "GARBAGE": "garbage.3dm", "EMPTY": "empty.obj"}
    assert call(*[places.get(word, word) for word in words]) == 2
    said = capsys.readouterr().err
    assert said.startswith("compas-cgc: ") and sentence in said and "Traceback" not in said
    assert len(said.strip().splitlines()) == 1
    assert sorted(path.name for path in tmp_path.iterdir()) == before


@pytest.mark.nightly
def test_a_reader_that_has_seen_enough_loses_nothing(dome, tmp_path):
    out = tmp_path / "roof.json"
    words = [sys.executable, "-m", "compas_cgc", "solve", dome, "-o", out, "--target", "0.01"]
    process = subprocess.Popen(list(map(str, words)), cwd=ROOT, stdout=subprocess.PIPE, stderr=subprocess.PIPE)
    process.stdout.close()
    _, said = process.communicate(timeout=PATIENCE)
    assert process.returncode == 0 and out.is_file(), said
    assert b"Broken" not in said and b"Traceback" not in said


@pytest.mark.nightly
@pytest.mark.skipif(sys.platform == "win32", reason="Ctrl-C is sent to a process group there")
def test_control_c_keeps_the_last_good_state(tmp_path):
    # Large enough to be still at work when the signal comes.
    mesh = CGCMesh.from_meshgrid(dx=60, nx=60)
    mesh.set_supports("boundary")
    mesh.to_json(tmp_path / "large.json")
    out = tmp_path / "roof.json"
    words = [sys.executable, "-m", "compas_cgc", "solve", tmp_path / "large.json", "-o", out, "--target", "0.0003"]
    words += ["--method", "flow", "--steps", "1000000"]
    words += ["--tolerance", "0", "--report", tmp_path / "report.json"]
    # On a terminal it shows when it is at its steps.
    terminal, its_end = os.openpty()
    process = subprocess.Popen(list(map(str, words)), cwd=ROOT, stderr=its_end, stdout=subprocess.DEVNULL)
    os.close(its_end)
    said = ""
    while "step " not in said:
        said += os.read(terminal, 1000).decode()
    os.kill(process.pid, signal.SIGINT)
    try:
        while piece := os.read(terminal, 1000):
            said += piece.decode()
    except OSError:
        pass  # the other end is closed
    os.close(terminal)
    assert process.wait(PATIENCE) == 130, said
    assert "Traceback" not in said and "cancelled" in said and not out.exists()
    kept = CGCMesh.from_json(tmp_path / "roof.unfinished.json")
    assert max(kept.vertices_attribute("z")) > 0
    assert json.loads((tmp_path / "report.unfinished.json").read_text(encoding="utf-8"))["status"] == "cancelled"


# ----------------------------------------------------------------------
# Examples and reproduction
# ----------------------------------------------------------------------


def test_an_example_writes_meshes_pictures_and_a_record(tmp_path, capsys):
    assert call("example", "4", "--variant", "a", "--out", tmp_path) == 0
    names = {path.name for path in tmp_path.iterdir()}
    expected = {"_record.json", ".3dm", ".obj", ".json", "_shape.png", "_history.png"}
    assert names == {f"example4_a{ending}" for ending in expected}
    record = json.loads((tmp_path / "example4_a_record.json").read_text(encoding="utf-8"))
    assert record["vertices"] == record["paper"]["vertices"] == 324
    assert record["max_error"] < 1e-6 and len(record["history"]["energy"]) == 200
    assert CGCMesh.from_json(tmp_path / "example4_a.json").regions()


@pytest.mark.nightly
def test_reproduce_sets_the_papers_tables_beside_ours(tmp_path, capsys):
    assert call("reproduce", "--out", tmp_path, "--no-pictures") == 0
    page = (tmp_path / "tables.md").read_text(encoding="utf-8")
    for published in ("117.8", "111.5", "273.0", "488.5", "963.8", "870.0", "7.15e-08", "2.15e-09", "3.80e-07", "4.11e-04", "3.268e-03"):
        assert published in page
    tables = json.loads((tmp_path / "tables.json").read_text(encoding="utf-8"))
    assert len(tables["curves"]) == 6 and len(tables["surfaces"]) == 13 and set(tables["table2"]) == {"5", "10", "15", "20"}
    assert page in capsys.readouterr().out


def test_check_says_what_a_file_holds_and_what_is_missing(tmp_path, capsys):
    before = (ROOFS / "nine_regions.3dm").read_bytes()
    assert call("check", ROOFS / "nine_regions.3dm") == 0
    said = capsys.readouterr().out
    assert "4 vertices are supports" in said and "9 regions:" in said and "(7.5, 7.5, 0): 50 faces, K = 0.04" in said
    assert (ROOFS / "nine_regions.3dm").read_bytes() == before
    assert call("check", ROOFS / "curved_crease.3dm") == 2
    said = capsys.readouterr().out
    assert said.splitlines()[-1].startswith("- no target curvature is set") and "--target K" in said
    out = tmp_path / "roof.3dm"
    assert call("solve", ROOFS / "nine_regions.3dm", "-o", out) == 0
    capsys.readouterr()
    assert call("check", out) == 0
    assert "no problems: the file can be solved" in capsys.readouterr().out


def test_layers_of_other_names_are_read(tmp_path, capsys):
    out = tmp_path / "roof.3dm"
    words = ["solve", ROOFS / "nine_regions.3dm", "-o", out, "--target", "0.01"]
    assert call(*words, "--layer", "supports=Supports", "--layer", "mesh=Mesh", "--layer", "creases=None") == 0
    assert "4 supports, 0 creases" in capsys.readouterr().out
    assert call(*words, "--layer", "walls=Supports") == 2
    assert "--layer must be ROLE=NAME" in capsys.readouterr().err


# ----------------------------------------------------------------------
# Options
# ----------------------------------------------------------------------


@pytest.mark.parametrize("words", [["--help"], ["solve", "--help"], ["check", "--help"], ["serve", "--help"]])
def test_help_loads_neither_compiled_kernels_nor_compas(words):
    code = (
        "import sys\nfrom compas_cgc.cli import main\n"
        f"try:\n    main({words!r})\nexcept SystemExit as end:\n    assert end.code == 0\n"
        "print(sorted({'numba', 'compas', 'scipy', 'rhino3dm', 'flask'} & set(sys.modules)))"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, encoding="utf-8", cwd=ROOT, check=True)
    assert done.stdout.splitlines()[-1] == "[]" and "usage: compas-cgc" in done.stdout


def test_the_parser_of_the_command_that_is_called_is_built_alone(monkeypatch):
    for name in set(COMMANDS) - {"check"}:
        monkeypatch.setitem(sys.modules, f"compas_cgc.cli.{name}", None)
    assert build_parser("check").parse_args(["check", "a.3dm"]).input == "a.3dm"


@dataclass(frozen=True)
class ToySettings(Settings):
    height: float = option(1.0, "Height of the flat surface (Eq. 1). It is in units of the model.", float, low=0)
    steps: int = option(1, "Most steps.", int, low=1)
    tolerance: float = option(1e-6, "Tolerance.", float, low=0)


def toy_solve(problem, settings, callback):
    V = problem.vertices * [1, 1, 0] + [0, 0, settings.height]
    return Solution(V, "converged", "the toy is done", 1, 0.0, 0.0, History.from_rows([]), "toy")


def test_a_method_in_the_registry_is_found_with_its_options(dome, tmp_path, monkeypatch, capsys):
    monkeypatch.setitem(METHODS, "toy", Method("toy", "A toy that lifts everything.", ToySettings, toy_solve))
    with pytest.raises(SystemExit):
        call("solve", "--help")
    said = " ".join(capsys.readouterr().out.split())
    assert "toy: A toy that lifts everything" in said
    assert "--toy-height X Height of the flat surface (Eq. 1) (toy; default 1.0)" in said
    for options in (["--method", "toy", "--toy-height", "2.5"], ["--toy-height", "2.5"]):
        assert call("solve", dome, "-o", tmp_path / "out.json", "--target", "0.01", *options) == ROUGH
        assert "rough: the curvature of fitted polynomials deviates from its target by 100 %" in capsys.readouterr().err
        mesh = CGCMesh.from_json(tmp_path / "out.json")
        assert {mesh.vertex_coordinates(v)[2] for v in mesh.vertices()} == {2.5}


def settings_given(*words):
    return settings_of(build_parser("solve").parse_args(["solve", "in.obj", "-o", "out.obj", *words]))


def test_options_are_resolved_as_by_every_other_door():
    assert settings_given() is None
    for words, given in [
        (["--delay", "5"], {"delay": 5}),
        (["--s", "0.5", "--delay", "5"], {"s": 0.5, "delay": 5}),
        (["--steps", "9", "--tolerance", "1e-3"], {"steps": 9, "tolerance": 1e-3}),
        (["--smoothness", "0.3", "--no-retry"], {"smoothness": 0.3, "retry": False}),
        (["--start", "elliptic"], {"start": "elliptic"}),
        (["--zeta", "inf"], {"zeta": float("inf")}),
    ]:
        assert settings_given(*words) == settings_for(**given), words
    for words in (["--s", "0.5", "--smoothness", "1"], ["--method", "newton", "--delay", "3"], ["--energy", "kinetic"], ["--s", "nan"]):
        with pytest.raises(ValueError):
            settings_given(*words)


def test_every_option_of_every_method_has_its_argument():
    arguments = vars(build_parser("solve").parse_args(["solve", "in.obj", "-o", "out.obj"]))
    assert {name for name in arguments if name.startswith("option_")} == {f"option_{name}" for name in all_options()}


def test_the_report_says_how_it_went(dome, tmp_path):
    report = tmp_path / "report.json"
    assert call("solve", dome, "-o", tmp_path / "out.json", "--target", "0.01", "--tolerance", "1e-9", "--report", report, "-q") == 0
    said = json.loads(report.read_text(encoding="utf-8"))
    assert (
        said["settings"] == {"steps": None, "tolerance": 1e-9, "measure": "auto"}
        and said["measure"] == "smooth"
        and said["method"] == "newton"
        and said["input"] == "dome.json"
    )
    assert said["steps"] == len(said["history"]["energy"]) and said["regions"][0]["target"] == 0.01 and said["moved_max"] > 1


def test_a_rhino_file_is_solved_without_a_compas_mesh_and_checked_once(tmp_path, monkeypatch):
    checked = []

    def counted(problem):
        checked.append(problem)
        return check(problem)

    monkeypatch.setattr("compas_cgc.solvers.run.check", counted)
    monkeypatch.setattr(CGCMesh, "__init__", None)
    monkeypatch.setattr(CGCMesh, "to_problem", None)
    assert call("solve", ROOFS / "nine_regions.3dm", "-o", tmp_path / "a.3dm", "--target", "0.01", "-q") == 0
    assert len(checked) == 1


def test_what_does_not_refuse_a_solve_is_said(tmp_path, capsys):
    plan = tmp_path / "plan.obj"
    # An L, whose inner corner wants a crease.
    mesh = CGCMesh.from_meshgrid(dx=8, nx=8)
    for v in [v for v in mesh.vertices() if min(mesh.vertex_coordinates(v)[:2]) > 4]:
        mesh.delete_vertex(v)
    mesh.to_obj(str(plan))
    call("solve", plan, "-o", tmp_path / "out.obj", "--target", "0.001", "--supports", "boundary")
    assert "note: the boundary is concave at vertices" in capsys.readouterr().out


def test_an_output_that_cannot_be_written_is_refused_before_the_solve(tmp_path, capsys):
    assert main(["solve", str(tmp_path / "nothing.obj"), "-o", str(tmp_path / "a.xyz"), "--target", "1"]) == 2
    said = capsys.readouterr()
    assert "the format '.xyz' is not supported; use .3dm" in said.err and not said.out


@pytest.mark.parametrize("output, missing, extra", [("a.3dm", "rhino3dm", "rhino"), ("a.step", "compas_occt._occt", "cad")])
def test_a_package_that_is_missing_is_told_before_the_solve(tmp_path, capsys, monkeypatch, output, missing, extra):
    monkeypatch.setitem(sys.modules, missing, None)
    assert main(["solve", str(tmp_path / "nothing.obj"), "-o", str(tmp_path / output), "--target", "1"]) == 2
    said = capsys.readouterr()
    assert f"pip install 'compas_cgc[{extra}]'" in said.err and not said.out


@pytest.mark.parametrize(
    "words, sentence",
    [
        (["solv", "roof.3dm"], "unknown command 'solv'; did you mean solve?"),
        (["solve", "roof.3dm"], "compas-cgc solve: missing: -o/--output; see compas-cgc solve --help"),
        (
            ["mould", "roof.3dm", "-o", "moulds.3dm"],
            "compas-cgc mould: missing: one of --size, --count, --columns and --curves; see compas-cgc mould --help",
        ),
        (
            ["solve", "roof.3dm", "-o", "out.3dm", "--supports", "0,99"],
            "compas-cgc solve: --supports: must be boundary, outline or corners, not '0,99'; to support single places, draw points on the "
            "layer CGC::Supports, or call mesh.set_supports([...]) in a script; see compas-cgc solve --help",
        ),
        (["solve", "roof.3dm", "-o", "a.3dm", "--edge_length", "1"], "unknown option --edge_length, did you mean --edge-length?"),
        (["solve", "roof.3dm", "-o", "a.3dm", "--K", "0.01"], "unknown option --K, did you mean --target?"),
        (["check", "roof.3dm", "--curvature", "0.01"], "unknown option --curvature"),
        (["solve", "roof.3dm", "-o", "a.3dm", "--rise", "3x"], "the length has the unknown unit 'x'"),
        (["check", "my", "roof.3dm"], "put names that contain spaces in quotation marks"),
    ],
)
def test_mistyped_commands_are_answered_in_one_line(capsys, words, sentence):
    try:
        code = main(words)
    except SystemExit as ended:
        code = ended.code
    said = capsys.readouterr().err
    assert code == 2 and sentence in said and said.count("\n") == 1


def test_help_is_given_without_dashes(capsys):
    with pytest.raises(SystemExit) as ended:
        main(["help", "limits"])
    assert ended.value.code == 0 and "compas-cgc limits" in capsys.readouterr().out


def test_negative_numbers_may_have_exponents_and_units():
    words = ["solve", "plan.obj", "-o", "roof.obj", "--target"]
    for text in ("-1e-2", "-.5E+1", "-3"):
        assert build_parser("solve").parse_args([*words, text]).target == [text]
    radii = ["rationalise", "roof.3dm", "-o", "panels.3dm", "--radii"]
    for text in ("-25m", "-2.5e4mm", "-.5ft"):
        assert build_parser("rationalise").parse_args([*radii, text, "inf", "-q"]).radii == [text, "inf"]


def test_paths_may_keep_their_quotes_and_a_tilde(tmp_path, dome, monkeypatch, capsys):
    monkeypatch.setenv("HOME", str(tmp_path))
    monkeypatch.setenv("USERPROFILE", str(tmp_path))
    assert call("check", f'"{dome}"') == call("check", "~/dome.json")
    assert "no such file" not in capsys.readouterr().err


def test_a_dxf_drawing_is_checked_and_meshed(tmp_path, capsys):
    import ezdxf

    document = ezdxf.new(units=6)
    document.modelspace().add_lwpolyline([(0, 0), (9, 0), (9, 6), (0, 6)], close=True)
    document.saveas(tmp_path / "plan.dxf")
    call("check", tmp_path / "plan.dxf", "--edge-length", "1.5")
    assert "outline" in capsys.readouterr().out
