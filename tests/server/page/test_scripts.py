"""What the page computes by itself, against the package."""

from __future__ import annotations

import numpy as np
import pytest

from compas_cgc import CGCMesh
from compas_cgc.meshing.regions import face_regions

from ...support.hands import open_hands
from ...support.server_process import running_server

pytestmark = pytest.mark.nightly


@pytest.fixture(scope="module")
def hands(tmp_path_factory):
    folder = tmp_path_factory.mktemp("scripts")
    with running_server(folder / "jobs.sqlite", workers=1) as server, open_hands("chromium", folder) as open_:
        open_.open(f"{server.url}/#new")
        open_.seen(".example")
        yield open_


@pytest.fixture(scope="module")
def wavy():
    """A mesh (n, 3), (m, 3) that curves both ways."""
    mesh = CGCMesh.from_meshgrid(dx=9, nx=12)
    vertices, faces = mesh.arrays()
    vertices[:, :2] += 0.1 * np.sin(3.0 * vertices[:, 1::-1])
    vertices[:, 2] = 0.4 * np.sin(0.7 * vertices[:, 0]) * np.cos(0.5 * vertices[:, 1])
    return vertices, faces


GRAPH = "const { Graph, regionsOf } = await import('/page/mesh/graph.js');"


def test_regions_are_numbered_as_the_server_numbers_them(hands, wavy):
    vertices, faces = wavy
    paths = [[13 * 4 + k for k in range(13)], [13 * k + 6 for k in range(13)], [13 * k + 9 for k in range(5)], [3, 16, 29]]
    found = hands.read(
        GRAPH + "return regionsOf(Uint32Array.from(args[0]), args[1], args[2])", faces.ravel().tolist(), paths, len(vertices)
    )
    edges = np.array([pair for path in paths for pair in zip(path, path[1:])])
    assert found == face_regions(faces, edges).tolist() and max(found) >= 3


def test_a_fold_goes_along_edges_as_straight_as_they_allow(hands):
    mesh = CGCMesh.from_meshgrid(dx=10, nx=10)
    vertices, faces = mesh.arrays()
    ends = [0, 120, 55]
    ways = hands.read(
        GRAPH + "const g = new Graph(Uint32Array.from(args[1]), args[0].length / 3); const [a, b, c] = args[2];"
        "return [g.way(args[0], a, b), g.way(args[0], a, a + 10), g.way(args[0], a, c)]",
        vertices.ravel().tolist(),
        faces.ravel().tolist(),
        ends,
    )
    edges = {tuple(sorted(pair)) for face in faces.tolist() for pair in zip(face, face[1:] + face[:1])}
    for way in ways:
        assert all(tuple(sorted(pair)) in edges for pair in zip(way, way[1:]))
        a, b = vertices[way[0]], vertices[way[-1]]
        along = (b - a) / np.linalg.norm(b - a)
        off = vertices[way] - a
        assert np.linalg.norm(off - np.outer(off @ along, along), axis=1).max() < 1.0, "nowhere an edge away from the straight line"
    assert ways[1] in (list(range(11)), list(range(0, 121, 11))[:11]), "a side of the grid is followed to its end"


def test_heights_of_columns_are_carried_smoothly(hands):
    mesh = CGCMesh.from_meshgrid(dx=10, nx=10)
    vertices, _ = mesh.arrays()
    held = [0, 10, 110, 120, 60]
    heights = {"10": 2.0, "120": 2.0}
    raised = np.array(
        hands.read(
            "const { lifted } = await import('/page/mesh/lift.js'); return lifted(args[0], args[1], args[2])",
            vertices.tolist(),
            held,
            heights,
        )
    )
    assert np.allclose(raised[:, :2], vertices[:, :2]) and np.allclose(raised[held, 2], [0, 2, 0, 2, 0], atol=1e-9)
    grid = raised[:, 2].reshape(11, 11)
    bent = np.abs(np.diff(grid, 2, axis=0)).max()
    assert 0.0 < bent < 0.2, "no spike at a column"


def test_what_is_typed_is_a_length_an_angle_or_a_place(hands):
    found = hands.read(
        "const { typedPoint } = await import('/page/draw/typed.js');"
        "return [['5', [1, 2], [1, 9]], ['2<30', [0, 0], null], ['3, 4', [1, 1], null], ['3 4', null, null], ['-1; 2,5', [0, 0], null],"
        "['5', null, [1, 1]], ['x', [0, 0], null], ['0', [0, 0], [1, 0]]].map((each) => typedPoint(...each))"
    )
    assert found[0] == pytest.approx([1, 7]) and found[1] == pytest.approx([3**0.5, 1]) and found[2:5] == [[4, 5], [3, 4], [-1, 2.5]]
    assert found[5:] == [None, None, None]
    comma, *refused = hands.read(
        "const { typedPoint } = await import('/page/draw/typed.js');"
        "return ['12,5', '1.234,5', '1,234,567'].map((text) => typedPoint(text, [0, 0], [1, 0]))"
    )
    assert comma == [12.5, 0] and refused == [None, None]


def test_numbers_are_read_with_a_point_or_a_comma_and_groups_are_refused(hands):
    texts = ["12,5", "12.5", "0,015", "0.015", ",5", "5,", "-1e-3", "\u22123,5", " 7 ", "1,234"]
    read = hands.read("const { numberIn } = await import('/page/fields.js'); return args[0].map(numberIn)", texts)
    assert read == [12.5, 12.5, 0.015, 0.015, 0.5, 5, -0.001, -3.5, 7, 1.234]
    texts = ["1.234,5", "1,234.5", "1 234", "1,234,567", "1'234", "", "x", "0x10", "1e", "--1", "Infinity"]
    assert hands.read("const { numberIn } = await import('/page/fields.js'); return args[0].map(numberIn)", texts) == [None] * len(texts)


def test_a_region_that_is_divided_keeps_name_colour_law_and_K(hands):
    mesh = CGCMesh.from_meshgrid(dx=6, nx=6)
    vertices, faces = mesh.arrays()
    data = {
        "vertices": vertices.tolist(),
        "faces": faces.tolist(),
        "regions": [0] * len(faces),
        "creases": [],
        "targets": [0.02],
        "laws": {"0": "H = 0.1"},
        "names": ["Hall"],
        "colours": ["#112233"],
        "problems": [],
    }
    one, none = hands.read(
        "const { withCrease, withoutCrease } = await import('/page/design/edits.js');"
        "const one = withCrease(args[0], args[1]); return [one, withoutCrease(one, args[1][2])]",
        data,
        [7 * 2 + k for k in range(7)],
    )
    assert one["targets"] == [0.02, 0.02] and sorted(map(str, one["names"])) == ["Hall", "None"] and len(set(one["regions"])) == 2
    share = one["names"].index("Hall")
    assert one["regions"].count(share) > len(faces) / 2 and one["colours"][share] == "#112233"
    assert one["laws"] == {"0": "H = 0.1", "1": "H = 0.1"} and none["laws"] == {"0": "H = 0.1"}
    assert none["regions"] == [0] * len(faces) and none["names"] == ["Hall"] and none["creases"] == []


def test_sentences_have_no_words_for_scripts(hands):
    from compas_cgc.model.checks import check
    from compas_cgc.server.api.wording import in_request_words

    mesh = CGCMesh.from_meshgrid(dx=6, nx=6)
    sentences = [in_request_words(said) for said in check(mesh.to_problem())]
    mesh.set_supports("boundary")
    sentences += [in_request_words(said) for said in check(mesh.to_problem())]
    assert hands.read("const { capital } = await import('/page/words.js'); return capital(args[0])", "from -0.2 (-3 m) to x-2, 1e-3") == (
        "From −0.2 (−3 m) to x-2, 1e-3."
    )
    sentences += ["take another mesh; unify them (mesh.unify())", "give an edge length (--edge-length) to mesh the outline"]
    said = hands.read("const { capital } = await import('/page/words.js'); return args[0].map(capital)", sentences)
    assert len(said) >= 4 and all(text[0].isupper() and text.endswith(".") for text in said)
    for text in said:
        assert not any(sign in text for sign in ("mesh.", "--", "set_", "()", " as targets")), text


def test_a_number_fits_into_its_field_and_keeps_its_digits(hands):
    values = [0.008, -0.000054134567, 0.0123456789, 123.456789, -1e-9, 0]
    shown, kept = hands.read(
        "const { Regions } = await import('/page/regions.js'); const room = document.createElement('div');"
        "const regions = new Regions(room, { change() {}, over() {}, name() {}, colour() {} });"
        "regions.show({ nameOf: String, colourOf: () => '#888888', reach: () => 200, areas: [], laws: {}, unit: 'm', targets: args[0] });"
        "return [regions.rows.slice(1).map(({ number }) => number.value), regions.targets]",
        values,
    )
    assert shown == ["0.008", "-5.41e-5", "0.01235", "123.5", "-1e-9", "0"] and kept == values


def test_many_regions_are_grouped(hands):
    """Seventy-two regions with three kinds of K are a handful of sliders, and each can still be set alone."""
    nx = 12
    mesh = CGCMesh.from_meshgrid(dx=12, nx=nx)
    vertices, faces = mesh.arrays()
    middle = vertices[faces].mean(axis=1)
    regions = (6 * (middle[:, 0] // 1) + middle[:, 1] // 2).astype(int)
    targets = [(0.01, 0.02, -0.01)[k % 3] for k in range(72)]
    none = {"file": [], "boundary": [], "corners": []}
    data = {
        **{"name": "Many", "unit": "m", "vertices": vertices.tolist(), "faces": faces.tolist(), "regions": regions.tolist()},
        **{"supports": none, "support_choice": "file", "creases": [], "goals": [], "notes": [], "problems": [], "targets": targets},
    }
    top, single, changed = hands.read(
        "const [{ Regions }, { Model }] = await Promise.all([import('/page/regions.js'), import('/page/model.js')]);"
        "const room = document.createElement('div'); let told = 0;"
        "const regions = new Regions(room, { change: () => (told += 1), over() {}, name() {}, colour() {} });"
        "regions.show(new Model(args[0]));"
        "const rows = [...room.querySelectorAll('.region')]; const top = rows.filter((row) => !row.closest('details'));"
        "const field = top[1].querySelector('.number'); field.value = 0.03; field.dispatchEvent(new Event('change'));"
        "return [top.length, rows.length - top.length, [told, regions.targets.filter((K) => K === 0.03).length]]",
        data,
    )
    assert top == 4 and single == 72 and changed == [1, 24]


def test_a_surface_is_shown_whole_in_what_the_tools_leave_free(hands):
    """A bar above and a palette at the left take their sides; points reach both ends of the rest, and none is outside."""
    rng = np.random.default_rng(3)
    points = rng.normal(size=(200, 3)) * (3.0, 1.0, 0.5) + (40.0, -7.0, 2.0)
    back = np.array([-0.62, -1.0, 0.72]) / np.linalg.norm([-0.62, -1.0, 0.72])
    right = np.cross([0.0, 0.0, 1.0], back) / np.linalg.norm(np.cross([0.0, 0.0, 1.0], back))
    up = np.cross(back, right)
    free, seen = hands.read(
        "const { freeArea, framing } = await import('/page/see/framing.js');"
        "const box = ([left, top, right, bottom]) => ({ left, top, right, bottom });"
        "const free = freeArea(box([100, 50, 900, 850]), [[100, 60, 900, 100], [110, 110, 160, 400], [950, 50, 990, 90]].map(box));"
        "const [points, right, up, back] = args; return [free, framing(points, { right, up, back }, { across: 0.3, upward: 0.2 })];",
        *(points.ravel().tolist(), right.tolist(), up.tolist(), back.tolist()),
    )
    assert (free["left"], free["top"], free["right"], free["bottom"]) == (70, 60, 790, 790)
    away = points - seen["target"]
    deep = seen["far"] - away @ back
    places = np.array([away @ right / deep / 0.3, away @ up / deep / 0.2])
    assert np.abs(places).max() <= 1.0 + 1e-12
    most = np.abs([places.min(axis=1), places.max(axis=1)]).max(axis=0)
    np.testing.assert_allclose(most.max(), 1.0, atol=1e-12)
    tight = np.argmax(most)
    np.testing.assert_allclose([places[tight].min(), places[tight].max()], [-1.0, 1.0], atol=1e-12)


REGIONS = """
const { Regions } = await import('/page/regions.js');
const room = document.createElement('div'); room.className = 'regions'; document.body.append(room);
const regions = new Regions(room, { change() {}, over() {}, name() {}, colour() {} });
const named = { nameOf: String, colourOf: () => '#888888', reach: () => 0.02, areas: [], laws: {}, unit: 'm' };
const show = (targets) => regions.show({ ...named, targets });
const move = (row, place) => { const { slider } = regions.rows[row]; slider.value = place; slider.dispatchEvent(new Event('input')); };
const told = () => regions.targets.slice();
"""


def test_one_slider_for_all_regions_keeps_what_they_are_to_each_other(hands):
    moved, zero, back, flipped, apart, typed, none = hands.read(
        REGIONS + "show([0.005, 0.01, 0, -0.002, null]); const all = []; const next = () => all.push(told());"
        "const at = regions.rows[0].slider.value; move(0, 150); next(); move(0, 0); next(); move(0, 30); next(); move(0, -100); next();"
        "move(0, 0); move(2, 50); move(0, 100); next();"
        "const { number } = regions.rows[0]; number.value = 0.004; number.dispatchEvent(new Event('change')); next();"
        "show([null, null]); move(0, 100); next(); room.remove(); if (at !== '100') throw new Error(at); return all"
    )
    assert moved == [0.0075, 0.015, 0, -0.003, None]
    assert zero == [0, 0, 0, 0, None]
    assert back == [0.0015, 0.003, 0, -0.0006, None], "through zero and on the proportion is the same"
    assert flipped == [-0.005, -0.01, 0, 0.002, None]
    assert apart == [0, 0.01, 0, 0, None], "what was given one by one in between counts"
    assert typed == [0.004] * 5
    assert none == [0.01, 0.01], "where nothing is given all get the same"


def test_sliders_stand_beside_their_numbers(hands):
    off = hands.read(
        REGIONS + "show([0.005, 0.01]);"
        "const middle = (e) => { const { top, height } = e.getBoundingClientRect(); return top + height / 2; };"
        "const off = regions.rows.map(({ slider, number }) => middle(slider) - middle(number)); room.remove(); return off"
    )
    assert len(off) == 3 and np.abs(off).max() < 1.0


def test_the_key_of_a_net_tells_its_families_apart(hands):
    drawn = (
        "const { drawnOf } = await import('/page/make/drawn.js');"
        "const curve = (family, kind) => ({ family, kind, points: [[0, 0, 0], [1, 0, 0]] });"
        "return drawnOf('net', { curves: args[0].map(([family, kind]) => curve(family, kind)) }).key.map(({ text }) => text)"
    )
    assert hands.read(drawn, [[0, "line of curvature"], [0, "ruling"], [1, "line of curvature"], [0, "ruling"]]) == [
        "line of curvature, ruling, first family",
        "line of curvature, second family",
    ]
    assert hands.read(drawn, [[0, "ruling"], [0, "ruling"]]) == ["ruling"]
