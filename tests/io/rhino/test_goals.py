"""Goals drawn in a Rhino file: read, told what is wrong with them, and written back."""

from __future__ import annotations

import numpy as np
import pytest
import rhino3dm

from compas_cgc import solve
from compas_cgc.cli.main import main
from compas_cgc.io import read
from compas_cgc.io.rhino import read_3dm
from compas_cgc.io.rhino import write_problem
from compas_cgc.io.rhino import write_result
from compas_cgc.model.constraints import Height
from compas_cgc.model.goals.inequalities import Above
from compas_cgc.model.goals.inequalities import Below
from compas_cgc.model.goals.inequalities import Clearance
from compas_cgc.model.goals.inequalities import NearPlane
from compas_cgc.model.goals.inequalities import Within
from compas_cgc.model.goals.places import EdgeInPlan
from compas_cgc.model.goals.places import Level
from compas_cgc.model.goals.wholes import Area
from compas_cgc.model.goals.wholes import Length
from compas_cgc.model.goals.wholes import Rise
from compas_cgc.model.goals.wholes import Unknown
from compas_cgc.model.goals.wholes import Volume
from compas_cgc.model.problem import CGCProblem
from compas_cgc.model.problem import Drawing

from ...support import shapes

N = 10
GATE = ((5.5, 0.0), (9.5, 0.0), (9.5, 3.0), (5.5, 3.0))
SITE = [(-1.0, -1.0), (16.0, -1.0), (16.0, 16.0), (-1.0, 16.0)]


def roof(*goals) -> CGCProblem:
    vertices, faces = shapes.grid(N, 15.0)
    problem = CGCProblem(vertices, faces, targets=0.004, drawing=Drawing("roof", "Meters", 0.001))
    return problem.with_supports("corners").with_goals(goals)


EVERY = [
    Rise(3.0),
    Height("crown", 3.25),
    Volume(300.0),
    Volume(300.0, level=0.5),
    Area(250.0),
    Above(-0.5),
    Below(5.0, [7, 8]),
    Clearance([5.5, 0.0, 9.5, 3.0], 1.5),
    Clearance(0, 0.25),
    Within(SITE),
    EdgeInPlan(),
    Level(),
    Length(list(range(0, 121, 11)), 17.0),
    NearPlane([0.0, 0.0, 0.0], [0.0, 0.0, 1.0], 8.0),
    Unknown([0]),
    Unknown("all"),
]


@pytest.mark.parametrize("goal", EVERY, ids=lambda goal: type(goal).__name__)
def test_there_and_back(goal, tmp_path):
    write_problem(tmp_path / "roof.3dm", roof(goal))
    (again,) = read_3dm(tmp_path / "roof.3dm").checked().goals
    if isinstance(goal, (Clearance, Within)) and not isinstance(getattr(goal, "where", None), int):
        line = "where" if isinstance(goal, Clearance) else "points"
        assert np.array_equal(np.array(getattr(again, line)), GATE if isinstance(goal, Clearance) else SITE)
        assert getattr(again, "height", None) == getattr(goal, "height", None)
    else:
        assert again == goal


def add(path, *objects):
    """Add objects with user text and names to the layer of goals."""
    file = rhino3dm.File3dm.Read(str(path))
    layer = rhino3dm.Layer()
    layer.Name = "Goals"
    layer.ParentLayerId = next(own.Id for own in file.Layers if own.FullPath == "CGC")
    index = file.Layers.Add(layer)
    for points, name, text in objects:
        attributes = rhino3dm.ObjectAttributes()
        attributes.LayerIndex, attributes.Name = index, name
        for key, value in text.items():
            attributes.SetUserString(key, value)
        places = [rhino3dm.Point3d(*(*point, 0.0)[:3]) for point in points]
        if len(places) == 1:
            file.Objects.AddPoint(places[0], attributes)
        else:
            file.Objects.AddPolyline(places, attributes)
    file.Write(str(path), 7)


def test_a_designers_drawing_from_the_file_to_the_roof(tmp_path):
    path, out = tmp_path / "roof.3dm", tmp_path / "solved.json"
    write_problem(path, roof())
    edge = [(0.0, y) for y in np.linspace(0, 15, N + 1)]
    add(path, ([(7, 7)], "", {"Rise": "3,5", "unknown": "all"}), ([*GATE, GATE[0]], "gate", {}), (edge, "", {"plan": "keep"}))
    found = read_3dm(path)
    assert not found.diagnostics and [name for name, _ in found.problem.drawing.places] == ["gate"]
    assert main(["solve", str(path), "-o", str(out), "--above", "2@gate", "-q"]) == 0
    solved = read(out).to_problem()
    assert solved.vertices[:, 2].max() == pytest.approx(3.5, abs=1e-9)
    assert np.abs(solved.vertices[: N + 1, 0]).max() < 1e-9
    kinds = {type(own).__name__ for own in solved.goals}
    assert kinds == {"Rise", "Unknown", "EdgeInPlan", "Clearance"}
    write_problem(tmp_path / "again.3dm", found.checked())
    assert read_3dm(tmp_path / "again.3dm").problem.drawing.places == found.problem.drawing.places


def test_a_result_brings_its_goals_along(tmp_path):
    result = solve(roof(Rise(2.0), Unknown([0])))
    write_result(tmp_path / "out.3dm", result)
    again = read_3dm(tmp_path / "out.3dm").checked()
    assert set(map(type, again.goals)) == {Rise, Unknown}
    assert np.abs(solve(again).vertices - result.vertices).max() < 1e-6


@pytest.mark.parametrize(
    "points, text, words",
    [
        ([(7, 7)], {}, "does not state a goal; give it user text such as rise = 4"),
        ([(7, 7)], {"rise": "high"}, "has the user text rise = 'high'; it must be a number"),
        ([(7, 7)], {"unknown": "roof"}, "unknown K cannot be 'roof'"),
        ([(7, 7)], {"clearance": "2"}, "is a point, but clearance requires a curve"),
        ([(1, 1), (5, 1), (5, 5)], {"clearance": "2"}, "is an open curve, but clearance requires a closed curve"),
        ([(1.1, 1.2), (5.3, 1.4)], {"length": "7"}, "does not pass through vertices of the mesh"),
    ],
)
def test_what_is_wrong_with_a_drawn_goal(tmp_path, points, text, words):
    write_problem(tmp_path / "roof.3dm", roof())
    add(tmp_path / "roof.3dm", (points, "", text))
    (said,) = read_3dm(tmp_path / "roof.3dm").diagnostics
    assert words in said and "on layer 'CGC::Goals'" in said
