"""Lengths with a unit of their own."""

import pytest

from compas_cgc.cli import main
from compas_cgc.errors import CGCError
from compas_cgc.fabrication.tasks import build
from compas_cgc.fabrication.tasks import read_settings
from compas_cgc.io import read_problem
from compas_cgc.model.units import length_of
from compas_cgc.model.units import millimetres_of
from compas_cgc.model.units import within


@pytest.mark.parametrize(
    ("text", "units", "value"),
    [("350mm", "Meters", 0.35), ("0.35", "Millimeters", 0.35), (" 2 ft ", "Inches", 24.0), ("-1e1 CM", None, -0.1), (0.35, "Feet", 0.35)],
)
def test_a_length_is_converted_to_the_units_of_the_drawing(text, units, value):
    assert within(length_of(text, "it"), units) == pytest.approx(value, rel=1e-15)


@pytest.mark.parametrize("value", ["nan", "inf", "1e999", "3 miles", "mm", "", True, None, [1.0]])
def test_what_is_no_length_is_refused(value):
    with pytest.raises(CGCError, match="the spacing"):
        length_of(value, "the spacing")


def test_thicknesses_are_in_millimetres():
    assert (millimetres_of("6", "it"), millimetres_of("0.6cm", "it")) == (6.0, pytest.approx(6.0))


@pytest.fixture(scope="module")
def plan(tmp_path_factory):
    ezdxf = pytest.importorskip("ezdxf")
    path = tmp_path_factory.mktemp("units") / "plan.dxf"
    document = ezdxf.new(units=4)
    document.modelspace().add_lwpolyline([(0, 0), (9000, 0), (9000, 6000), (0, 6000)], close=True)
    document.saveas(path)
    return path


def test_commands_and_tasks_take_lengths_with_units(plan, capsys):
    out = plan.with_name("roof.json")
    words = ["--supports", "corners", "--target", "2e-9", "--edge-length", "1m", "--above", "-2 m", "-q"]
    assert main(["solve", str(plan), "-o", str(out), *words]) == 0
    same = read_problem(plan, edge_length=1000.0).problem
    problem = read_problem(out).problem
    assert len(problem.vertices) == len(same.vertices) and problem.goals[0].height == -2000.0
    task = read_settings("unroll", {"sheet": "3.0x1.5m", "margin": "1cm", "kerf": 0.2, "thickness": "0.8cm"})
    stock = build("unroll", problem, task).stock
    assert (stock.sheet, stock.margin, stock.kerf, stock.thickness) == ((3000.0, 1500.0), 10.0, 0.2, 8.0)
    widths = [len(build("mould", problem, read_settings("mould", {"columns": text})).panels) for text in ("2m,1.5m", "2000,1500")]
    assert widths[0] == widths[1] > 1
    with pytest.raises(SystemExit):
        main(["solve", str(plan), "-o", str(out), "--edge-length", "5 miles"])
    assert "unknown unit 'miles'" in capsys.readouterr().err
