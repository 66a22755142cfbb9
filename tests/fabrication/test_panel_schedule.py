"""Panel schedule: sides, neighbours and diagonals of panels, as CSV and PDF."""

from __future__ import annotations

import io
from dataclasses import replace

import numpy as np
import pytest
import shapely
from matplotlib.backends.backend_agg import FigureCanvasAgg
from shapely import affinity

import compas_cgc
from compas_cgc.discrete import face_areas
from compas_cgc.fabrication import MATERIALS
from compas_cgc.fabrication import moulds
from compas_cgc.fabrication import panels
from compas_cgc.fabrication.bending import unbounded_curvature
from compas_cgc.fabrication.figures import two_digits
from compas_cgc.fabrication.panel_schedule import NOTES
from compas_cgc.fabrication.panel_schedule import PanelSide
from compas_cgc.fabrication.panel_schedule import _in_plane
from compas_cgc.fabrication.panel_schedule import model_notes
from compas_cgc.fabrication.panel_schedule import panel_sheets
from compas_cgc.fabrication.panel_schedule import panel_totals
from compas_cgc.fabrication.panel_schedule import schedule_text
from compas_cgc.fabrication.panel_seams import panel_seams
from compas_cgc.plot import moulds_figure
from compas_cgc.plot.panel_sheets import _pages
from compas_cgc.plot.panel_sheets import panel_figure
from compas_cgc.plot.panel_sheets import save_panel_sheets

from ..support.tables import rows_and_notes


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
        # In position it begins at corner 1, and has the lengths of the sides.
        assert own.outline[0] == pytest.approx(own.corners[0]) and len(own.outline) == sum(len(side.points) - 1 for side in own.sides)
        around = np.linalg.norm(np.roll(own.outline, -1, axis=0) - own.outline, axis=1).sum()
        assert around == pytest.approx(sum(side.length for side in own.sides))
        # The outline is closed, counterclockwise and as long as the sides, up to its projection.
        outline = np.vstack([side.points[:-1] for side in own.sides])
        x, y = outline.T
        assert 0.5 * (x @ np.roll(y, -1) - y @ np.roll(x, -1)) > 0.8e6 * own.area
        assert all(np.allclose(a.points[-1], b.points[0]) for a, b in zip(own.sides, [*own.sides[1:], own.sides[0]]))
    assert sum(own.area for own in sheets.values()) == pytest.approx(face_areas(problem.vertices, problem.faces).sum())


@pytest.mark.parametrize("normal", [(0.0, 0.0, 1.0), (0.6, 0.0, 0.8), (0.0, 0.6, 0.8), (0.28, 0.96, 0.0)])
def test_points_keep_their_distances_in_the_plane_of_a_panel(normal):
    across = np.array([[-normal[1], normal[0], 0.0] if any(normal[:2]) else [1.0, 0.0, 0.0]])
    points = np.vstack([across, np.cross(normal, across)])
    assert _in_plane(points, np.array(normal)) @ _in_plane(points, np.array(normal)).T == pytest.approx(points @ points.T)


def test_the_table_has_one_row_per_panel_in_millimetres(report):
    sheets = panel_sheets(*report)
    rows, _ = rows_and_notes(io.StringIO(schedule_text(sheets)))
    assert [row["panel"] for row in rows] == [own.fit.panel.name for own in sheets]
    for row, own in zip(rows, sheets):
        assert [float(text) for text in row["sides in mm"].split()] == pytest.approx([side.length for side in own.sides], abs=0.06)
        assert float(row["mould radius in mm"]) == pytest.approx(10_000.0)
        corners = np.array([[float(value) for value in text.split(", ")] for text in row["corners in mm"][1:-1].split(") (")])
        assert corners.shape == (len(own.sides), 3) and float(row["stress on 95 % in MPa"]) <= float(row["bending stress in MPa"])
        for i, j, length in own.diagonals:
            assert np.linalg.norm(corners[i] - corners[j]) == pytest.approx(length, abs=0.2)
        assert own.heights.min() < 0.0 < own.heights.max() + own.rise and np.ptp(own.heights) <= own.rise + 1e-6
        places = own.fit.vertices
        longest = 1e3 * np.linalg.norm(places[:, None] - places, axis=2).max()
        assert max(length for _, _, length in own.diagonals) == pytest.approx(longest, rel=1e-3)


def test_the_table_explains_its_columns_and_compares_stress_with_strength(report):
    problem, made = report
    rows, sentences = rows_and_notes(io.StringIO(schedule_text(panel_sheets(problem, made))))
    notes = " ".join(sentences)
    for word in ("rise: ", "diagonals: ", "sides: ", "mould radius: ", "bending stress: ", "lengths in mm"):
        assert word in notes
    for row, fit in zip(rows, made.panels):
        areas, order = face_areas(fit.vertices, fit.faces), np.argsort(fit.stresses)
        within = areas[order].cumsum() <= 0.95 * areas.sum()
        used = 1e6 * fit.stresses[order][within.sum()] / made.material.strength
        assert float(row["part of strength in %"]) == pytest.approx(100.0 * used, abs=0.6)


def test_the_schedule_has_the_number_and_area_of_all_panels_and_of_every_mould(report):
    problem, made = report
    sheets = panel_sheets(problem, made)
    area = face_areas(problem.vertices, problem.faces).sum()
    mould = "K = 0.01 1/m², radius 10000.0 mm"
    assert panel_totals(sheets) == f"total: {len(sheets)} panels, {area:.3f} m²; mould 1: {mould}"
    assert rows_and_notes(io.StringIO(schedule_text(sheets)))[1] == [panel_totals(sheets), *NOTES, *model_notes(sheets)]
    two = [own._replace(fit=replace(own.fit, mould=2)) if k < 3 else own for k, own in enumerate(sheets)]
    own = sum(sheet.area for sheet in sheets[:3])
    first, second = f"{len(sheets) - 3} panels, {area - own:.3f} m²", f"3 panels, {own:.3f} m²"
    assert panel_totals(two).split("; ")[1] == f"mould 1: {mould} ({first}), mould 2: {mould} ({second})"


def test_panels_that_would_break_come_first_with_remedies_that_hold(report):
    problem, made = report
    stress = max(fit.stress_95 for fit in made.panels)
    # So thin that all panels hold, and so thick that the worst breaks by a tenth.
    thin, thick = (made.thickness * part * 1e-6 * made.material.strength / stress for part in (0.95, 1.1))
    again = [moulds(problem, [fit.panel for fit in made.panels], thickness=thickness) for thickness in (thin, thick)]
    assert not again[0].overstressed and "NOT BUILDABLE" not in str(again[0]) and again[0].to_dict()["overstressed"] == []
    broken = again[1]
    names = [fit.panel.name for fit in broken.overstressed]
    assert names and broken.to_dict()["overstressed"] == names
    first = str(broken).splitlines()[0]
    assert first.startswith(f"NOT BUILDABLE like this: {len(names)} of") and "110 % of it" in first and all(name in first for name in names)
    sheets = panel_sheets(problem, broken)
    assert [own.fit.panel.name for own in sheets if own.used > 1.0] == names
    worst = max(broken.overstressed, key=lambda fit: fit.stress_95)
    own = f"{worst.panel.name} ({two_digits(broken.bending_radius(worst))} m, {two_digits(worst.stress_95)} MPa)"
    assert "of the area of the worst one is" in first and f"bent to reach the same stress, and this stress: {own}" in first
    assert f"95 % of the area of all panels together: at most {two_digits(broken.stress_95)} MPa" in str(broken)
    stronger = [name for name in ("steel", "gfrp", "timber") if MATERIALS[name].title in first.split("use sheets")[1]]
    assert "glass-fibre reinforced plastic (gfrp)" in first and "gfrp" in stronger
    for name in stronger:
        assert not moulds(problem, [fit.panel for fit in made.panels], thickness=thick, material=name).overstressed


def test_the_pdf_has_a_page_per_panel_and_is_the_same_again(report, tmp_path):
    sheets = panel_sheets(*report)[:3]
    first, again = (save_panel_sheets(sheets, tmp_path / name, "facade:").read_bytes() for name in ("a.pdf", "b.pdf"))
    assert first == again
    assert first.count(b"/Type /Page ") == 2 + len(sheets)


def test_a_view_says_where_other_panels_are_drawn(report):
    sheets = panel_sheets(*report)
    turned = [own._replace(view=own.view[[0, 2, 1]]) if k < 3 else own for k, own in enumerate(sheets)]
    texts = [" ".join(text.get_text() for text in page.texts) for page in _pages(turned, "facade:", (0.0, 1.0))]
    elevation, plan = [text for text in texts if "dots: corner 1" in text]
    assert f"south elevation of {len(sheets) - 3} of {len(sheets)} panels" in elevation and "the other panels are in: plan" in elevation
    assert f"plan of 3 of {len(sheets)} panels" in plan and "the other panels are in: south elevation" in plan
    # Every page says what K and the strength are.
    drawings = [text for text in texts if "dots: corner 1" not in text]
    assert len(drawings) == 1 + len(sheets)
    assert all("product of the two principal curvatures" in text and "characteristic strength of 45 MPa" in text for text in drawings)


def test_papers_say_where_shapes_are_and_on_which_face_of_a_mould_panels_lie(report):
    problem, made = report
    sheets = panel_sheets(problem, made)
    pages = [" ".join(" ".join(text.get_text() for text in page.texts).split()) for page in _pages(sheets, "facade:", (0.0, 1.0))]
    moulds_page = " ".join(" ".join(text.get_text() for text in moulds_figure(problem, made).texts).split())
    for text in (pages[0], pages[2], moulds_page, schedule_text(sheets).replace('""', '"')):
        assert "whose unit of length is m while papers are in mm" in text
        assert all(f'"{layer}"' in text for layer in ("Outlines", "Panels in place", "Panels on moulds", "Faces"))
    for text in (pages[0], schedule_text(sheets)):
        assert "flat triangles of the model, not of the smooth surface" in text and "mean plane: through the mean" in text
        assert "panel: the number of its region, from 0, then its number in this region" in text
    # The mould of a dome is humped below its panels, which lie with their hollow side on the lower face.
    for fit in made.panels:
        corners = fit.on_mould[fit.faces]
        assert fit.on_mould[:, 2].max() <= 0.0 < np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])[:, 2].min()
    humped = "a mould for the hollow side of panels is humped, and its face is the lower one"
    assert humped in pages[0] and humped in moulds_page and "saddle, humped" not in pages[0] + moulds_page
    saddle = [own._replace(K=-own.K) for own in sheets]
    assert "a mould is a saddle, humped in one direction" in model_notes(saddle)[-1] and humped not in model_notes(saddle)[-1]
    assert len(model_notes([own._replace(K=0.0) for own in sheets])) == 2
    named = [own._replace(fit=replace(own.fit, panel=own.fit.panel._replace(name="door"))) for own in sheets]
    assert len(model_notes(named)) == len(model_notes(sheets)) - 1


def test_the_arrow_to_north_lies_apart_from_the_words_on_the_place_of_a_panel(report):
    sheets = panel_sheets(*report)
    flat = [own._replace(view=np.eye(3)) for own in sheets]
    figure = panel_figure(flat[0], "facade:", flat)
    FigureCanvasAgg(figure).draw()
    (place,) = (text for text in figure.texts if "dot: corner 1" in text.get_text())
    notes = next(text for text in figure.texts if "seen from outside" in text.get_text())
    key = [text for axes in figure.axes for text in axes.texts if text.get_text() in ("N", "2000 mm")]
    assert len(key) == 2
    assert not any(place.get_window_extent().overlaps(other.get_window_extent()) for other in (*key, notes))


def test_remarks_name_panels_whose_largest_stress_has_no_limit_and_short_seams(report):
    problem, made = report
    sheets = panel_sheets(problem, made)
    assert {own.fit.panel.name for own in sheets if own.remarks} == {fit.panel.name for fit in made.panels if fit.singular} != set()
    rows = {row["panel"]: row for row in rows_and_notes(io.StringIO(schedule_text(sheets)))[0]}
    for own in sheets:
        assert ("unbounded" in rows[own.fit.panel.name]["remarks"]) == own.fit.singular
    # Only the causes at the panel itself are named.
    causes = {name: np.flatnonzero(where) for name, where in unbounded_curvature(problem).items()}
    assert {name for name, where in causes.items() if len(where)} == {cause for fit in made.panels for cause in fit.causes}
    for own in sheets:
        whole = own.fit.panel.cut.parent[own.fit.panel.faces]
        near = [name for name, where in causes.items() if np.isin(problem.faces[whole], where).any()]
        remark = rows[own.fit.panel.name]["remarks"]
        assert [name for name in causes if name in remark] == near
    short = sheets[0]._replace(sides=[side._replace(length=60.0) for side in sheets[0].sides])
    inner = [side.neighbour for side in short.sides if side.neighbour != "edge"]
    assert [remark for remark in short.remarks if "short" in remark] == [f"short seam with {name}: 60.0 mm" for name in inner]


@pytest.mark.parametrize("times", [1, 6])
def test_the_report_on_the_page_of_moulds_lies_above_the_plans(report, times):
    problem, made = report
    figure = moulds_figure(problem, replace(made, moulds=made.moulds * times))
    figure.canvas.draw()
    text = min(own.get_window_extent().y0 for own in figure.texts)
    plans = [own for own in figure.axes if own.get_title() and own.get_position().y0 < 0.3]
    assert len(plans) == 3 and text > max(own.title.get_window_extent().y1 for own in plans)


def test_texts_of_a_narrow_panel_overlap_neither_each_other_nor_its_outline(report):
    """A side of 60 mm beside sides of 2 m, whose texts stand outside at the end of a line."""
    problem, made = report
    own = panel_sheets(problem, made)[0]
    corners = np.array([[0.0, 0.0], [2000.0, -400.0], [2000.0, 400.0], [0.0, 60.0]])
    sides = [
        PanelSide(np.array([a, b]), float(np.linalg.norm(b - a)), name)
        for a, b, name in zip(corners, np.roll(corners, -1, axis=0), ("0-2", "edge", "0-3", "0-12"))
    ]
    diagonals = [(i, j, float(np.linalg.norm(corners[i] - corners[j]))) for i, j in ((0, 2), (1, 3))]
    narrow = own._replace(sides=sides, corners=np.column_stack([corners, np.zeros(4)]), heights=np.zeros(4), diagonals=diagonals)
    figure = panel_figure(narrow)
    FigureCanvasAgg(figure).draw()
    axes = figure.axes[0]
    texts = [text for text in axes.texts if text.get_text()]
    assert {text.get_text() for text in texts} >= {"60.0, 0-12", "800.0", "edge", "0-2", "0-3", "1 (+0.0)", "4 (+0.0)"}
    boxes = []
    for text in texts:
        angle = text.get_rotation()
        text.set_rotation(0.0)
        box = text.get_window_extent()
        text.set_rotation(angle)
        middle = axes.transData.transform(text.get_position())
        boxes.append(affinity.rotate(shapely.box(*(middle - 0.5 * box.size), *(middle + 0.5 * box.size)), angle))
    outline = shapely.LinearRing(axes.transData.transform(corners))
    for k, box in enumerate(boxes):
        assert not box.intersects(outline)
        assert not any(box.intersects(other) for other in boxes[:k])
