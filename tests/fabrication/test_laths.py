"""Laths: the schedule alone rebuilds the net; stress, splices, files."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.interpolate import CubicSpline

from compas_cgc import CGCError
from compas_cgc import CGCProblem
from compas_cgc import solve
from compas_cgc.fabrication import curve_net
from compas_cgc.fabrication.drawing import LETTER_WIDTH
from compas_cgc.fabrication.lath_files import draw_laths
from compas_cgc.fabrication.lath_files import schedule_text
from compas_cgc.fabrication.laths import lath_schedule
from compas_cgc.fabrication.start_labels import names_at_starts
from compas_cgc.io.nets import write_net

from ..support.constant_curvature import revolved_patch
from ..support.shapes import grid
from ..support.tables import rows_and_notes

STEPS = 8  # of integration between two nodes


def saddle_on_four_points(n):
    """Return the net of a 15 m saddle, solved by the default method."""
    return curve_net(solve(CGCProblem(*grid(n, 15.0)).with_supports("corners").with_targets(-0.01)), 1.0)


@pytest.fixture(scope="module")
def net():
    return curve_net(CGCProblem(*revolved_patch(32, -0.02)).with_supports("boundary").with_targets(-0.02), 1.0)


def turned(frame, bend, twist, length):
    """Return a frame (tangent, left, normal) carried along a curve of given curvature and torsion."""
    axis = twist * frame[0] + bend * frame[2]
    angle = np.linalg.norm(axis) * length
    if angle == 0.0:
        return frame
    k = axis / np.linalg.norm(axis)
    return frame * np.cos(angle) + np.cross(k, frame) * np.sin(angle) + np.outer(frame @ k, k) * (1.0 - np.cos(angle))


def followed(point, frame, rows, start, twist):
    """Return the points and frames at the nodes of a lath, from its row `start` in both directions."""
    stations, angles, sign = rows["station"], rows["angle"], -1.0 if rows["family"] == 0 else 1.0
    slope = CubicSpline(stations, angles).derivative() if len(stations) > 2 else np.poly1d(np.diff(angles) / np.diff(stations))
    found = {start: (point, frame)}
    for way in (1, -1):
        place, own, i = point, frame, start
        while 0 <= i + way < len(stations):
            h = (stations[i + way] - stations[i]) / STEPS
            for k in range(STEPS):
                bend = sign * float(slope(stations[i] + (k + 0.5) * h))
                place = place + h * turned(own, bend, twist, 0.5 * h)[0]
                own = turned(own, bend, twist, h)
            i += way
            found[i] = (place, own)
    return found


def rebuilt(net, K, path):
    """Return the distances of the nodes of a net from those rebuilt from its schedule alone (k,) [mm]."""
    write_net(path, net)
    laths = {}
    for row in rows_and_notes(path.open())[0]:
        if row["node"]:
            laths.setdefault(int(row["lath"]), []).append(row)
    table = {}
    for number, rows in laths.items():
        table[number] = {
            "family": int(rows[0]["family"]),
            "node": [int(row["node"]) for row in rows],
            "across": [int(row["crosses lath"]) for row in rows],
            "station": np.array([float(row["station in mm"]) for row in rows]) / 1e3,
            "angle": np.radians([float(row["angle in degrees"]) for row in rows]),
            "twist": np.sign(float(rows[0]["twist in degrees per m"])) * (-K) ** 0.5,
        }
    base = max((own for own in table.values() if own["family"] == 0), key=lambda own: len(own["node"]))
    built = {}
    row = followed(np.zeros(3), np.eye(3), base, len(base["node"]) // 2, base["twist"])
    for i, (place, (tangent, left, normal)) in row.items():
        other = table[base["across"][i]]
        along = np.cos(base["angle"][i]) * tangent + np.sin(base["angle"][i]) * left
        frame = np.array([along, np.cross(normal, along), normal])
        for k, (point, _) in followed(place, frame, other, other["node"].index(base["node"][i]), other["twist"]).items():
            built[other["node"][k]] = point
    nodes = sorted(built)
    here, there = np.array([built[k] for k in nodes]), net.nodes[nodes]
    here, there = here - here.mean(axis=0), there - there.mean(axis=0)
    U, _, W = np.linalg.svd(here.T @ there)
    # A rotation only: the mirror image has the opposite twist.
    motion = U @ np.diag([1.0, 1.0, np.linalg.det(U @ W)]) @ W
    return 1e3 * np.linalg.norm(here @ motion - there, axis=1)


def test_the_schedule_alone_rebuilds_a_patch(net, tmp_path):
    off = rebuilt(net, -0.02, tmp_path / "net.laths.csv")
    assert len(off) > 40
    assert off.max() < 1.0 and np.median(off) < 0.3


def test_the_schedule_alone_rebuilds_a_saddle_on_four_points(tmp_path):
    net = saddle_on_four_points(48)
    off = rebuilt(net, -0.01, tmp_path / "net.laths.csv")
    assert len(off) > 250 and off.max() < 1.0
    # The surface that is rebuilt is that of the mesh.
    assert net.surfaces[0].off.max() < 3e-3 and np.median(net.surfaces[0].off) < 1e-3


def test_bending_is_the_change_of_the_angle_and_families_twist_oppositely(net):
    schedule = lath_schedule(net)
    for lath in schedule.laths:
        assert lath.twist == pytest.approx(schedule.laths[0].twist * (1 if lath.family == schedule.laths[0].family else -1))
        assert abs(lath.twist) == pytest.approx(0.02**0.5)
        if len(lath.nodes) > 6:
            change = np.gradient(lath.angles, lath.stations)[2:-2] * (-1.0 if lath.family == 0 else 1.0)
            assert np.abs(change - lath.bending[2:-2]).max() < 3e-3
        # Timber of 80 x 8 mm: outer fibres, and the shear of a thin strip.
        bend = np.abs(lath.bending).max(initial=0.0)
        assert lath.stress == pytest.approx(11e9 * (0.004 * bend + 0.02 * 0.08**2 / 12.0))
        assert lath.shear == pytest.approx(11e9 / 2.6 * 0.008 * 0.02**0.5)


def test_splices_lie_between_nodes_and_leave_no_part_longer_than_the_stock(net):
    schedule = lath_schedule(net, stock=3.0)
    assert any(lath.splices for lath in schedule.laths)
    for lath in schedule.laths:
        ends = np.r_[0.0, lath.splices, lath.length]
        assert np.diff(ends).max() <= 3.0 and (np.diff(ends) > 0.0).all()
        for splice in lath.splices:
            assert np.abs(lath.stations - splice).min() > 0.4
    with pytest.raises(CGCError, match="within a stock length of 0.3 model units"):
        lath_schedule(net, stock=0.3)


def test_strips_are_straight_and_have_a_slot_at_every_node(net, tmp_path):
    ezdxf = pytest.importorskip("ezdxf")
    shapely, affinity = pytest.importorskip("shapely"), pytest.importorskip("shapely.affinity")
    write_net(tmp_path / "net.laths.dxf", net, width=100.0, thickness=10.0)
    document = ezdxf.readfile(tmp_path / "net.laths.dxf")
    assert document.header["$INSUNITS"] == 4
    (title,) = document.modelspace().query('TEXT[layer=="SHEET"]')
    assert title.dxf.text == f"{len(net.curves)} laths of 100 x 10 mm, timber, drawn 1:1" and title.dxf.height == pytest.approx(60.0)
    legend = {text.dxf.text.split(":")[0] for text in document.modelspace().query('TEXT[layer=="LEGEND"]')}
    assert {item.dxf.layer for item in document.modelspace()} - {"LEGEND"} <= legend
    text = " ".join(entity.dxf.text for entity in document.modelspace().query('TEXT[layer=="LEGEND"]'))
    assert "product of the two principal curvatures" in text and "bending strength of timber: 24 MPa" in text
    whole = sum(lath.length for lath in lath_schedule(net).laths)
    assert f"the lower edge is the inner one, the face towards the viewer the right one; {whole:.1f} m in all" in text
    away = {lath.number: np.minimum(lath.stations, lath.length - lath.stations) for lath in lath_schedule(net).laths}
    cut_short = [f"L{number} at node" for number, own in away.items() if (own < 0.1).any()]
    assert all(name in text for name in cut_short) and ("closer to an end than the width of the lath" in text) == bool(cut_short)
    # The plan has the axes of all laths, at the scale of the model.
    plan = [np.array([point[:2] for point in line.get_points()]) for line in document.modelspace().query('LWPOLYLINE[layer ? "FAMILY_."]')]
    assert [np.ptp(line, axis=0) for line in plan] == [pytest.approx(1e3 * np.ptp(own.points[:, :2], axis=0)) for own in net.curves]
    (edge,) = document.modelspace().query('LWPOLYLINE[layer=="OUTLINE"]')
    assert np.ptp([point[:2] for point in edge.get_points()], axis=0) == pytest.approx(1e3 * np.ptp(net.problem.vertices[:, :2], axis=0))
    strips = [
        shapely.Polygon([point[:2] for point in line.get_points()]) for line in document.modelspace().query('LWPOLYLINE[layer=="CUT"]')
    ]
    # Every strip has its number on it, clear of the texts of nodes, and no two numbers of the plan overlap.
    labels = document.modelspace().query('TEXT[layer=="LABEL"]')
    places = [(text.dxf.text, text.get_placement()[1], text.dxf.height) for text in labels]
    on_strips, in_plan = places[: len(strips)], places[len(strips) :]
    nodes = [text.get_placement()[1] for text in document.modelspace().query('TEXT[layer=="NODE"]')]
    for strip, (name, place, height) in zip(strips, on_strips):
        half = 0.5 * LETTER_WIDTH * height * len(name)
        room = shapely.box(place[0] - half, place[1] - 0.5 * height, place[0] + half, place[1] + 0.5 * height)
        assert strip.contains(room) and height >= 10.0
        assert not any(room.buffer(5.0).contains(shapely.Point(node[0], node[1])) for node in nodes)
    assert (
        [name for name, _, _ in on_strips] == [name for name, _, _ in in_plan] == [f"L{lath.number}" for lath in lath_schedule(net).laths]
    )
    # A line leads from the start of every lath to its number.
    leaders = [np.array([point[:2] for point in line.get_points()]) for line in document.modelspace().query('LWPOLYLINE[layer=="LABEL"]')]
    assert len(leaders) == len(plan)
    for leader, line, (name, place, height) in zip(leaders, plan, in_plan):
        half = 0.5 * height * np.array([LETTER_WIDTH * len(name), 1.0]) + height
        assert np.allclose(leader[0], line[0]) and (np.abs(leader[1] - np.array(place)[:2]) <= half).all()
    for i, (name, place, height) in enumerate(in_plan):
        for other, beside, _ in in_plan[:i]:
            width = 0.5 * LETTER_WIDTH * height * (len(name) + len(other))
            assert abs(place[0] - beside[0]) > width or abs(place[1] - beside[1]) > height
    # Numbers of nodes in the plan are clear of the axes.
    axes = shapely.MultiLineString(plan)
    numbers = [text for text in document.modelspace().query('TEXT[layer=="NODE"]') if "/" not in text.dxf.text]
    assert len(numbers) == len(net.nodes)
    crossed = 0
    for text in numbers:
        x, y, _ = text.get_placement()[1]
        half = 0.5 * text.dxf.height * np.array([LETTER_WIDTH * len(text.dxf.text), 1.0])
        crossed += axes.intersects(shapely.box(x - half[0], y - half[1], x + half[0], y + half[1]))
    assert crossed == 0
    schedule = lath_schedule(net, 100.0, 10.0)
    assert len(strips) == len(schedule.laths)
    for strip, lath in zip(strips, schedule.laths):
        # What a crossing lath takes of the length of one 10 mm thick, cut square to it.
        own, other = shapely.box(-1e3, -5.0, 1e3, 5.0), shapely.box(-1e3, -5.0, 1e3, 5.0)
        crossings = [own.intersection(affinity.rotate(other, angle, use_radians=True)).bounds for angle in lath.angles.tolist()]
        slots = 50.0 * sum(right - left for left, _, right, _ in crossings)
        assert strip.is_valid and strip.area == pytest.approx(1e5 * lath.length - slots, rel=1e-3)


@pytest.mark.filterwarnings("error")
def test_numbers_of_nodes_stand_beside_upright_laths_in_plan(net):
    schedule = lath_schedule(net)
    upright = [
        lath._replace(path=lath.path[:, [1, 1, 0]] * [0, 0, 1], points=lath.points[:, [1, 1, 0]] * [0, 0, 1]) for lath in schedule.laths
    ]
    laths = [*upright[:3], *schedule.laths[3:]]
    texts = [text for text in draw_laths(schedule._replace(laths=laths)).texts if text.layer == "NODE"]
    assert len(texts) > len(net.nodes) and all(np.isfinite(text.place).all() for text in texts)


def test_signs_of_the_schedule_are_those_of_its_notes(net, tmp_path):
    """Twist, sides and angles from the coordinates alone, for an observer outside; the patch is turned by its normals."""
    write_net(tmp_path / "net.laths.csv", net)
    laths = {}
    table, sentences = rows_and_notes((tmp_path / "net.laths.csv").open())
    for row in table:
        if row["node"]:
            laths.setdefault(row["lath"], []).append(row)
    notes = " ".join(sentences)
    for word in ("station 0", "right-handed", "positive if the lath bends to the left", "counterclockwise", "origin", "outside"):
        assert word in notes
    along, place = {}, {}
    for rows in laths.values():
        points = np.array([[float(row[f"{axis} in mm"]) for axis in "xyz"] for row in rows])
        if len(rows) < 5:
            continue
        stations = np.array([float(row["station in mm"]) for row in rows])
        assert np.abs(np.linalg.norm(np.diff(points, axis=0), axis=1) / np.diff(stations) - 1.0).max() < 5e-3
        spline = CubicSpline(stations, points)
        for row, at, point in zip(rows, stations, points):
            along[int(row["node"]), int(row["family"])] = spline(at, 1), spline(at, 2)
            place[int(row["node"])] = point
    normal = {}
    for node in {node for node, family in along if (node, 1 - family) in along}:
        own = np.cross(along[node, 0][0], along[node, 1][0])
        faces = net.problem.faces[np.linalg.norm(net.problem.vertices[net.problem.faces].mean(axis=1) - place[node] / 1e3, axis=1).argmin()]
        a, b, c = net.problem.vertices[faces]
        normal[node] = own * np.sign(own @ np.cross(b - a, c - a)) / np.linalg.norm(own)
    checked = [0, 0, 0]
    for rows in laths.values():
        own = [row for row in rows if int(row["node"]) in normal]
        for one, other in zip(own[:-1], own[1:]):
            a, b = int(one["node"]), int(other["node"])
            turn = np.cross(normal[a], normal[b]) @ (place[b] - place[a])
            assert (turn > 0.0) == (one["screw"] == "right-handed") == (float(one["twist in degrees per m"]) > 0.0)
            checked[0] += 1
        for row in own:
            node, family = int(row["node"]), int(row["family"])
            tangent, bend = along[node, family]
            left = bend @ np.cross(normal[node], tangent)
            if abs(left) > 2e-5:
                assert (left > 0.0) == (row["bends to"] == "left") == (float(row["bending radius in mm"]) > 0.0)
                checked[1] += 1
            first, second = along[node, 0][0], along[node, 1][0]
            angle = np.degrees(np.arctan2(np.cross(first, second) @ normal[node], first @ second))
            assert angle == pytest.approx(float(row["angle in degrees"]), abs=0.5)
            checked[2] += 1
    assert min(checked) > 10


def test_laths_need_asymptotic_curves_and_a_section(net):
    dome = curve_net(CGCProblem(*revolved_patch(8, 0.02)).with_supports("boundary").with_targets(0.02), 2.0)
    with pytest.raises(CGCError, match="laths need a region of K < 0"):
        lath_schedule(dome)
    with pytest.raises(CGCError, match="the thickness of laths must be a positive number"):
        lath_schedule(net, thickness=0.0)


def test_laths_that_cross_no_other_are_in_the_table_and_named(net):
    schedule = lath_schedule(net)
    none, empty = np.zeros(0, np.int64), np.zeros(0)
    first = schedule.laths[0]
    alone = first._replace(nodes=none, stations=empty, across=none, angles=empty, bending=empty, points=np.zeros((0, 3)))
    rows, notes = rows_and_notes(schedule_text(schedule._replace(laths=[alone, *schedule.laths[1:]])).splitlines())
    assert {row["lath"] for row in rows} == {str(lath.number) for lath in schedule.laths}
    # Every lath has a row for each end, so that one with few nodes can be set out.
    for lath in (alone, *schedule.laths[1:]):
        own = [row for row in rows if row["lath"] == str(lath.number)]
        ends = [row for row in own if row["node"] == ""]
        assert ends == [own[0], own[-1]] and len(own) == len(lath.nodes) + 2
        assert [float(row["station in mm"]) for row in ends] == pytest.approx([0.0, 1e3 * lath.length], abs=0.06)
        places = [[float(row[f"{axis} in mm"]) for axis in "xyz"] for row in ends]
        assert np.array(places) == pytest.approx(1e3 * lath.path[[0, -1]], abs=0.06)
    assert f"L{alone.number} ({1e3 * alone.length:.0f} mm)" in " ".join(notes)


def test_notes_state_splices_reading_and_straight_laths(net):
    schedule = lath_schedule(net)
    notes = [" ".join(rows_and_notes(schedule_text(lath_schedule(net, stock=stock)).splitlines())[1]) for stock in (0, 3.0)]
    longest = max(lath.length for lath in schedule.laths)
    assert f"no stock length was given; all laths are in one piece, the longest of {1e3 * longest:.1f} mm" in notes[0]
    assert "stock lengths of at most 3000.0 mm meet end to end" in notes[1] and "no stock length" not in notes[1]
    for word in (
        "the lower edge is the inner one, the face towards the viewer the right one",
        "on the axis of the lath, at half its width",
    ):
        assert all(word in text for text in notes)
    # A bow of 0.5 mm over 2 m is a radius of 1 km.
    lath = max(schedule.laths, key=lambda own: len(own.nodes))
    bending = np.resize([1.0 / 990.0, -1.0 / 1010.0], len(lath.nodes))
    rows, _ = rows_and_notes(schedule_text(schedule._replace(laths=[lath._replace(bending=bending)])).splitlines())
    radii = [row["bending radius in mm"] for row in rows if row["node"]]
    assert lath.length > 2.0 and radii == np.resize(["990000", ""], len(bending)).tolist()


def test_the_line_to_a_name_passes_no_other_name():
    """The name of the second curve would lie beyond that of the first, in its direction."""
    shapely = pytest.importorskip("shapely")
    paths = [np.array([[0.0, 0.0], [1.0, -1.0]]), np.array([[0.0, 2.0], [1.0, 4.0]])]
    places = names_at_starts(["L11", "L16"], paths, 0.5, apart=0.5)
    half = 0.25 * np.array([3 * LETTER_WIDTH, 1.0])
    boxes = [shapely.box(*(place - half), *(place + half)) for place in places]
    lines = [shapely.LineString([path[0], place]) for path, place in zip(paths, places)]
    assert not boxes[0].intersects(boxes[1]) and not boxes[0].intersects(lines[1]) and not boxes[1].intersects(lines[0])
    # Without the first name the second one lies in the direction of its curve, where that name is.
    (straight,) = names_at_starts(["L16"], paths[1:], 0.5, apart=0.5)
    assert boxes[0].intersects(shapely.box(*(straight - 1.2 * half), *(straight + 1.2 * half)))
