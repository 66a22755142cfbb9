"""Panel schedule: sides, neighbours and diagonals of panels, as CSV and PDF."""

from __future__ import annotations

import csv
import io

import numpy as np
import pytest

import compas_cgc
from compas_cgc.discrete import face_areas
from compas_cgc.fabrication import moulds
from compas_cgc.fabrication import panels
from compas_cgc.fabrication.panel_schedule import panel_sheets
from compas_cgc.fabrication.panel_schedule import schedule_text
from compas_cgc.fabrication.panel_seams import panel_seams
from compas_cgc.plot.panel_sheets import save_panel_sheets


@pytest.fixture(scope="module")
def report():
    facade = compas_cgc.solve(compas_cgc.read(compas_cgc.get("facade.3dm")), settings={"measure": "exact"}).problem
    return facade, moulds(facade, panels(facade, 2.3))


def test_sides_are_the_seams_with_the_neighbours(report):
    problem, made = report
    sheets = {own.fit.panel.name: own for own in panel_sheets(problem, made)}
    lengths = {frozenset(seam.panels): seam.length for seam in panel_seams(problem, [fit.panel for fit in made.panels])}
    for name, own in sheets.items():
        assert len(own.sides) >= 4
        for side in own.sides:
            if side.neighbour != "edge":
                assert side.length == pytest.approx(1e3 * lengths[frozenset((name, side.neighbour))])
                # Both panels have the same length on their common side.
                beyond = [other.length for other in sheets[side.neighbour].sides if other.neighbour == name]
                assert beyond == pytest.approx([side.length])
        # The outline is closed, counterclockwise and as long as the sides, up to its projection.
        outline = np.vstack([side.points[:-1] for side in own.sides])
        x, y = outline.T
        assert 0.5 * (x @ np.roll(y, -1) - y @ np.roll(x, -1)) > 0.8e6 * own.area
        assert all(np.allclose(a.points[-1], b.points[0]) for a, b in zip(own.sides, [*own.sides[1:], own.sides[0]]))
    assert sum(own.area for own in sheets.values()) == pytest.approx(face_areas(problem.vertices, problem.faces).sum())


def test_the_table_has_one_row_per_panel_in_millimetres(report):
    sheets = panel_sheets(*report)
    rows = list(csv.DictReader(io.StringIO(schedule_text(sheets))))
    assert [row["panel"] for row in rows] == [own.fit.panel.name for own in sheets]
    for row, own in zip(rows, sheets):
        assert [float(text) for text in row["sides in mm"].split()] == pytest.approx([side.length for side in own.sides], abs=0.06)
        assert float(row["mould radius in mm"]) == pytest.approx(10_000.0)
        places = own.fit.vertices
        longest = 1e3 * np.linalg.norm(places[:, None] - places, axis=2).max()
        assert max(length for _, _, length in own.diagonals) == pytest.approx(longest, rel=1e-3)


def test_the_pdf_has_a_page_per_panel_and_is_the_same_again(report, tmp_path):
    sheets = panel_sheets(*report)[:3]
    first, again = (save_panel_sheets(sheets, tmp_path / name, "facade:").read_bytes() for name in ("a.pdf", "b.pdf"))
    assert first == again
    assert first.count(b"/Type /Page ") == 1 + len(sheets)
