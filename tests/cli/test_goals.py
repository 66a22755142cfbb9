"""Goals from the command line."""

from __future__ import annotations

import json

import numpy as np
import pytest

from compas_cgc.cli.main import main
from compas_cgc.io import read
from compas_cgc.model.goals.inequalities import Clearance
from compas_cgc.model.goals.wholes import Rise
from compas_cgc.model.goals.wholes import Unknown

from ..support import shapes


@pytest.fixture
def plan(tmp_path):
    vertices, faces = shapes.grid(12, 15.0)
    rows = [f"v {x} {y} {z}" for x, y, z in vertices] + [f"f {a + 1} {b + 1} {c + 1}" for a, b, c in faces]
    (tmp_path / "plan.obj").write_text("\n".join(rows) + "\n")
    return tmp_path / "plan.obj"


def test_a_rise_a_gate_and_k_as_the_answer(plan, capsys):
    out, report = plan.with_name("roof.json"), plan.with_name("report.json")
    asked = ["--supports", "corners", "--rise", "3", "--above", "1.9@5.5,0,9.5,3", "--unknown", "0", "--sensitivity"]
    assert main(["solve", str(plan), "-o", str(out), *asked, "--report", str(report)]) == 0
    said = capsys.readouterr().out
    assert "was found for region 0" in said and "1 % more K lifts the crown by" in said
    problem = read(out).to_problem()
    assert problem.vertices[:, 2].max() == pytest.approx(3.0, abs=1e-10)
    assert problem.goals == (Rise(3.0), Clearance([5.5, 0.0, 9.5, 3.0], 1.9), Unknown([0]))
    assert np.isfinite(problem.targets[problem.asked]).all()
    assert json.loads(report.read_text())["sensitivity"]["regions"] == [0]


def test_all_goals_have_a_flag_or_are_data(plan, capsys):
    out = plan.with_name("roof.json")
    asked = ["--supports", "corners", "--target", "0.004", "--edges-in-plan", "--above", "-1", "--below", "9"]
    more = ["--goal", '{"kind": "near plane", "point": [0, 0, 0], "normal": [0, 0, 1], "distance": 8}', "-q"]
    assert main(["solve", str(plan), "-o", str(out), *asked, *more]) == 0
    kinds = [type(own).__name__ for own in read(out).to_problem().goals]
    assert kinds == ["Above", "Below", "EdgeInPlan", "NearPlane"]


@pytest.mark.parametrize(
    "flags, words",
    [
        (["--above", "2.5@gate"], "the place 'gate' must be a region number"),
        (["--above", "high"], "--above must be a length, such as 0.35 or 350mm, not 'high'"),
        (["--goal", "rise"], "--goal must be a JSON object"),
        (["--goal", '{"kind": "hight"}'], "did you mean 'height'"),
        (["--unknown", "roof"], "--unknown: unknown K cannot be 'roof'; write numbers of regions or all"),
        (["--unknown", "4"], "names region 4, but the mesh has 1"),
        (["--rise", "4000"], "the rise 4000 is far larger than the mesh"),
    ],
)
def test_what_is_wrong_with_a_flag(plan, capsys, flags, words):
    out = plan.with_name("roof.json")
    assert main(["solve", str(plan), "-o", str(out), "--supports", "corners", "--target", "0.01", *flags]) != 0
    assert words in capsys.readouterr().err and not out.exists()
