"""Lengths and curvatures are told in the unit of the file."""

from __future__ import annotations

import numpy as np
import pytest

from compas_cgc import FlowSettings
from compas_cgc import solve
from compas_cgc.errors import FileError
from compas_cgc.io.rhino import read_3dm
from compas_cgc.io.rhino import write_result
from compas_cgc.io.rhino.units import unit_name
from compas_cgc.io.rhino.units import unit_system
from compas_cgc.model.lengths import unit_suffix

from ...support.rhino_models import Sketch
from ...support.rhino_models import corners_of
from ...support.rhino_models import dots_of
from ...support.rhino_models import quads

SHORT = {"Millimeters": "mm", "Centimeters": "cm", "Meters": "m", "Kilometers": "km", "Inches": "in", "Feet": "ft", "Yards": "yd"}


@pytest.mark.parametrize("name", [*SHORT, "Parsecs"])
def test_the_report_in_the_drawing_names_the_unit_of_the_drawing(tmp_path, name):
    sketch = Sketch(name)
    vertices, faces = quads(4, 4.0)
    sketch.mesh(vertices, faces)
    sketch.points(vertices[corners_of(4)])
    sketch.dot("K=0.01", np.array([1.5, 1.5, 0.0]))
    source = sketch.save(tmp_path / "a.3dm")
    problem = read_3dm(source).checked()
    assert problem.drawing.units == name and unit_name(unit_system(name)) == name
    write_result(tmp_path / "b.3dm", solve(problem, settings=FlowSettings(steps=1)), source)
    (line,) = [line for text in dots_of(tmp_path / "b.3dm") for line in text.splitlines() if line.startswith("largest error of K")]
    assert line.endswith(f" 1/{SHORT[name]}²") if name in SHORT else "1/" not in line
    assert unit_suffix(name) == (f" {SHORT[name]}" if name in SHORT else "")


def test_a_unit_that_is_none_is_refused():
    with pytest.raises(FileError, match="unknown unit 'Cubits'"):
        unit_system("Cubits")
