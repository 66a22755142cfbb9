"""Curves to build along: nets against closed forms, under refinement, in files, and what is refused."""

from __future__ import annotations

import json
from dataclasses import replace

import numpy as np
import pytest

from compas_cgc import CGCError
from compas_cgc import CGCProblem
from compas_cgc import solve
from compas_cgc.discrete import boundary_vertices
from compas_cgc.fabrication import curve_net
from compas_cgc.fabrication.curves.trace import CURVATURE
from compas_cgc.fabrication.curves.trace import direction_field
from compas_cgc.fabrication.curves.trace import trace
from compas_cgc.fabrication.drawing import overlap
from compas_cgc.fabrication.drawing import text_box
from compas_cgc.fabrication.shape_operators import shape_operators
from compas_cgc.io.nets import write_net
from compas_cgc.model.problem import Drawing

from ..support.constant_curvature import cone
from ..support.constant_curvature import revolved_patch
from ..support.roofs import shaken_square
from ..support.shapes import grid
from ..support.shapes import revolution


def patch(n, K) -> CGCProblem:
    return CGCProblem(*revolved_patch(n, K)).with_supports("boundary").with_targets(K)


def test_an_asymptotic_net_has_equal_sides_the_more_the_finer_the_mesh():
    """Chebyshev: asymptotic curves of constant K < 0 cross at equal distances."""
    nets = [curve_net(patch(n, -0.02), 0.5) for n in (20, 40)]
    # Sides are equal on the surface of constant K, from which the mesh deviates the less the finer it is.
    assert all(np.abs(net.lengths / 0.5 - 1.0).max() < 1e-9 for net in nets)
    off = [net.surfaces[0].off.max() / 0.5 for net in nets]
    assert off[0] < 0.01 and off[1] < 0.5 * off[0]


def test_asymptotic_curves_do_not_bend_in_the_normal_direction():
    net = curve_net(patch(40, -0.02), 1.0)
    r0, K = 4.0, -0.02
    for curve in net.curves:
        if curve.length < 2.0:
            continue
        # Normal curvature by chords: of the points on the closed form, along its normal.
        points = curve.points[:: max(1, len(curve.points) // 12)]
        r = np.hypot(points[:, 1], points[:, 2])
        slope = np.sign(points[:, 0]) * np.sqrt((r**2 - r0**2).clip(0) * -K)
        normal = np.column_stack([-slope, *(points[:, 1:] / r[:, None] * np.sqrt(1 - slope**2)[:, None]).T])
        chord = points[1:] - points[:-1]
        fall = np.einsum("ij,ij->i", normal[1:] - normal[:-1], chord) / np.einsum("ij,ij->i", chord, chord)
        assert np.abs(fall).max() < 0.1 * np.sqrt(-K)


@pytest.mark.parametrize("stretch", [1.0, pytest.param(1.5, marks=pytest.mark.nightly)], ids=["15 x 15", "12 x 18"])
def test_the_net_of_a_saddle_solved_from_a_flat_start(stretch):
    vertices, faces = grid(24, 15.0)
    vertices = vertices * ([0.8, 1.2, 1.0] if stretch > 1.0 else 1.0)
    result = solve(CGCProblem(vertices, faces).with_supports("corners").with_targets(-0.01), method="projection")
    net = curve_net(result, 1.0)
    assert result.converged
    assert len(net.lengths) > 300
    assert np.abs(net.lengths - 1.0).max() < 0.015
    # What is asymptotic does not bend across the surface.
    # Fits of shape operators are inaccurate beside the point supports, on free edges.
    inside = ~boundary_vertices(net.problem.vertices, net.problem.faces)[net.problem.faces].any(axis=1)
    S, most = shape_operators(net.problem.vertices, net.problem.faces).operators, 0.0
    for curve in net.curves:
        step = np.diff(curve.points, axis=0)
        long = (np.linalg.norm(step, axis=1) > 0.05) & inside[curve.faces]
        step, own = step[long] / np.linalg.norm(step[long], axis=1)[:, None], S[net.problem.faces[curve.faces[long]]].mean(axis=1)
        most = max(most, np.abs(np.einsum("ki,kij,kj->k", step, own, step)).max(initial=0.0))
    assert most < 0.05 * 0.01**0.5


@pytest.mark.parametrize(("n", "seed"), [(14, 5), pytest.param(24, 6, marks=pytest.mark.nightly)])
def test_the_net_of_a_saddle_on_an_irregular_mesh_has_equal_sides(n, seed):
    """Directions there are off by some degrees, beside free edges by more, while lengths are not."""
    net = curve_net(solve(shaken_square(n, -0.01, 0.4, seed), method="projection"), 1.0)
    assert len(net.lengths) > 300
    assert np.abs(net.lengths - 1.0).max() < 0.02 and not net.notes


def test_a_net_through_points_has_no_spacing_to_hold_its_sides_against():
    problem = patch(12, -0.02)
    middle = np.argsort(np.linalg.norm(problem.vertices - problem.vertices.mean(axis=0), axis=1))
    net = curve_net(problem, 0.5, through=problem.vertices[middle[[0, 8]]])
    assert net.spacing is None and len(net.sides) > 0
    assert "times the spacing" not in str(net)


def test_a_line_of_curvature_runs_straight_where_both_curvatures_are_equal_and_does_not_begin_there():
    vertices, faces = grid(8)
    operators = np.zeros((len(vertices), 3, 3))
    operators[:, 0, 0], operators[:, 1, 1] = np.where(vertices[:, 0] < 0.4, 2.0, 1.0), 1.0
    field = direction_field(vertices, faces, operators)
    begin, end = (int(np.argmin(np.linalg.norm(vertices[faces].mean(axis=1) - place, axis=1))) for place in ([0.1, 0.5, 0], [0.9, 0.5, 0]))
    start = vertices[faces[begin]].mean(axis=0)
    line = trace(field, CURVATURE, 0, begin, start).points
    assert line[[0, -1], 0] == pytest.approx([0.0, 1.0]) and line[:, 1] == pytest.approx(start[1])
    assert len(trace(field, CURVATURE, 0, end, vertices[faces[end]].mean(axis=0)).points) == 1


def test_around_a_hole_asymptotic_curves_are_traced_one_by_one():
    """A ring of the catenoid-like surface of K = -0.02 has no coordinates all around: what is traced has nearly equal sides."""
    K, r0, around, rows = -0.02, 4.0, 60, 15
    x = np.linspace(-2.5, 2.5, rows)
    radius = r0 * np.cosh((-K) ** 0.5 * x)
    height = np.concatenate([[0.0], np.cumsum(np.sqrt(np.diff(x) ** 2 - np.diff(radius) ** 2))])
    vertices, faces = revolution(radius, height, around)
    net = curve_net(CGCProblem(vertices, faces).with_supports("boundary").with_targets(K), 1.0, rough=True)
    assert {curve.family for curve in net.curves} == {0, 1} and len(net.nodes) > 50
    assert "region 0 has no net of equal sides" in str(net)
    # Where both ways around meet curves are as near as they happen to be.
    assert (np.abs(net.lengths - 1.0) < 0.02).mean() > 0.9


def test_lines_of_curvature_keep_their_distance():
    """Towards the corners of a roof they run together: beside each other none is nearer than the stop distance."""
    vertices, faces = grid(16, 12.0)
    result = solve(CGCProblem(vertices, faces).with_supports("corners").with_targets(0.01), method="projection")
    freely, apart = (curve_net(result, 1.5, stop=stop).curves for stop in (0.0, 0.5))
    assert 0 < len(apart) < len(freely)
    assert _nearest_beside(freely) < 0.2 and _nearest_beside(apart) > 0.6
    with pytest.raises(CGCError, match="stop distance, relative to the spacing, must be"):
        curve_net(result, 1.0, stop=1.0)


def _nearest_beside(curves) -> float:
    """Return how near a point of a curve is to one of another that runs the same way, up to 5 degrees."""
    nearest = np.inf
    for k, curve in enumerate(curves):
        for other in curves[:k]:
            directions = [np.gradient(own.points, axis=0) for own in (curve, other)]
            a, b = (each / np.linalg.norm(each, axis=1, keepdims=True) for each in directions)
            away = np.linalg.norm(curve.points[:, None] - other.points, axis=2)
            nearest = min(nearest, away[np.abs(a @ b.T) > np.cos(np.radians(5.0))].min(initial=np.inf))
    return nearest


def test_lines_of_curvature_are_meridians_and_circles():
    net = curve_net(patch(24, 0.02), 0.5)
    kinds = {0: 0, 1: 0}
    for curve in net.curves:
        if curve.length < 1.0:
            continue
        turn = np.ptp(np.arctan2(curve.points[:, 1], curve.points[:, 2]))
        along = np.ptp(curve.points[:, 0])
        assert min(turn * 4.0, along) < 0.02 * curve.length
        kinds[int(along < turn)] += 1
    assert min(kinds.values()) >= 5


def shaken_spindle(K=0.02, rows=15, around=56) -> CGCProblem:
    """Return a spindle of constant K > 0, open at both ends, its vertices off their rows."""
    rng, a = np.random.default_rng(2), K**0.5
    _, faces = revolution(np.ones(rows), np.zeros(rows), around)
    k, j = np.divmod(np.arange(rows * around), around)
    s = (k + np.where((k > 0) & (k < rows - 1), rng.uniform(-0.3, 0.3, len(k)), 0.0)) / (rows - 1) * 6.0 - 3.0
    angle = 2 * np.pi * (j + 0.5 * k + rng.uniform(-0.25, 0.25, len(k))) / around
    fine = np.linspace(-3.0, 3.0, 2001)
    height = np.concatenate([[0.0], np.cumsum(np.sqrt(1 - (4 * a * np.sin(a * 0.5 * (fine[1:] + fine[:-1]))) ** 2))]) * (fine[1] - fine[0])
    r = 4.0 * np.cos(a * s)
    return CGCProblem(np.column_stack([r * np.cos(angle), r * np.sin(angle), np.interp(s, fine, height)]), faces).with_targets(K)


def test_lines_of_curvature_that_come_back_are_closed():
    """The parallels of a spindle, on a mesh that lets lines drift: each goes around once."""
    problem = shaken_spindle()
    circles = [curve for curve in curve_net(problem, 1.0, rough=True).curves if curve.length > 8.0]
    assert len(circles) >= 5
    for curve in circles:
        r = np.hypot(*curve.points[:, :2].T)
        assert curve.length == pytest.approx(2 * np.pi * r.mean(), rel=0.02)
        assert (curve.points[0] == curve.points[-1]).all()
        # Every segment lies in its face.
        corners = problem.vertices[problem.faces[curve.faces]]
        normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
        normal /= np.linalg.norm(normal, axis=1, keepdims=True)
        for ends in (curve.points[:-1], curve.points[1:]):
            assert np.abs(np.einsum("ij,ij->i", ends - corners[:, 0], normal)).max() < 1e-12


def test_rulings_reach_into_fans():
    """Half of a cone whose rulings the curve across the middle one does not all meet: no place is far from one."""
    vertices, faces = grid(16, 4.0)
    x, y = vertices[:, 0] - 2.0, vertices[:, 1] + 1.0
    r, turn = np.hypot(x, y), np.arctan2(x, y)
    slope = 1.5  # the cone over (r, turn): circles of radius r / slope, as far around
    vertices = np.column_stack([r / slope * np.sin(slope * turn), r / slope * np.cos(slope * turn), r * np.sqrt(1 - slope**-2)])
    net = curve_net(CGCProblem(vertices, faces).with_targets(0.0), 0.5, rough=True)
    points = np.vstack([curve.points for curve in net.curves])
    centres = vertices[faces].mean(axis=1)
    assert max(np.linalg.norm(points - centre, axis=1).min() for centre in centres) < 0.75
    assert max(curve.straightness for curve in net.curves) < 0.05


@pytest.mark.parametrize("through", [None, "supports", [[3.0, 0.0, 0.0], [0.0, 3.0, 0.0]]], ids=["a net", "supports", "points"])
def test_rulings_of_a_cone_run_towards_its_apex(through):
    net = curve_net(CGCProblem(*cone(12, 60)).with_supports("boundary").with_targets(0.0), 0.8, through=through)
    assert len(net.curves) >= 2
    for curve in net.curves:
        end, start = curve.points[-1] - [0, 0, 6.0], curve.points[0] - [0, 0, 6.0]
        across = np.linalg.norm(np.cross(start, end)) / np.linalg.norm(start) / np.linalg.norm(end)
        assert across < 0.02 and curve.length > 0.9 * np.hypot(3.0, 1.5)
        assert curve.straightness < 0.01


@pytest.mark.parametrize("spacing", [1.0, None])
def test_curves_do_not_depend_on_where_a_surface_stands(spacing):
    problem = patch(16, -0.02)
    turn = np.linalg.qr(np.array([[1.0, 2.0, 0.5], [0.3, -1.0, 2.0], [2.0, 0.1, 1.0]]))[0]
    turn *= np.sign(np.linalg.det(turn))
    still, moved = (
        curve_net(problem.with_vertices(own), spacing) for own in (problem.vertices, problem.vertices @ turn.T + [50.0, 0.0, 3.0])
    )
    assert [curve.length for curve in moved.curves] == pytest.approx([curve.length for curve in still.curves], rel=1e-6)


@pytest.mark.parametrize("suffix", [".3dm", ".dxf", ".json"])
def test_files_hold_the_curves(suffix, tmp_path):
    net = curve_net(replace(patch(12, -0.02), drawing=Drawing(units="Millimeters")), 1.0)
    path = tmp_path / f"net{suffix}"
    write_net(path, net)
    if suffix == ".json":
        found = [len(curve["points"]) for curve in json.loads(path.read_text())["curves"]]
    elif suffix == ".dxf":
        ezdxf = pytest.importorskip("ezdxf")
        document = ezdxf.readfile(path)
        assert not document.audit().errors and document.header["$INSUNITS"] == 4
        shown = np.array([document.header["$EXTMIN"], document.header["$EXTMAX"]])
        points = np.vstack([curve.points for curve in net.curves])
        assert (shown[0] <= points.min(axis=0) + 1e-9).all() and (shown[1] >= points.max(axis=0) - 1e-9).all()
        lines = document.modelspace().query("POLYLINE")
        assert {line.dxf.layer for line in lines} == {"ASYMPTOTIC_CURVES_1", "ASYMPTOTIC_CURVES_2", "EDGES", "LEGEND"}
        found = [len(line) for line in lines if line.dxf.layer.startswith("ASYMPTOTIC")]
        names = document.modelspace().query("TEXT[layer=='CURVE_NUMBERS']")
        starts = {text.dxf.text: np.array(list(text.dxf.align_point)) for text in names}
        assert list(starts) == [f"L{k}" for k in range(1, len(net.curves) + 1)] == net.labels
        for place, curve in zip(starts.values(), net.curves):
            # Beyond the start of its own curve, in plan.
            away = np.linalg.norm(curve.points[:, :2] - place[:2], axis=1)
            back = curve.points[0, :2] - curve.points[1, :2]
            assert away[0] == away.min() and (place[:2] - curve.points[0, :2]) @ back > 0.999 * away[0] * np.linalg.norm(back)
        size = names[0].dxf.height
        boxes = [text_box(text, place[:2], size) for text, place in starts.items()]
        numbers = document.modelspace().query("TEXT[layer=='NODE_NUMBERS']")
        boxes += [text_box(text.dxf.text, np.array(list(text.dxf.align_point))[:2], text.dxf.height) for text in numbers]
        assert not any(overlap(one, other) for k, one in enumerate(boxes) for other in boxes[:k])
        assert len(document.modelspace().query("TEXT[layer=='NODE_NUMBERS']")) == len(net.nodes)
        legend = " ".join(text.dxf.text for text in document.modelspace().query("TEXT[layer=='LEGEND']"))
        assert all(f"{layer}:" in legend for layer in {line.dxf.layer for line in lines} - {"LEGEND"})
    else:
        from compas_cgc.io.rhino.archive import list_items
        from compas_cgc.io.rhino.archive import read_archive

        items = list_items(read_archive(path))
        found = [len(item.geometry.TryGetPolyline()) for item in items if item.kind == "curve"]
        assert {item.layer for item in items if item.kind == "curve"} == {f"CGC Curves::Asymptotic curves {k}" for k in (1, 2)}
    assert found == [len(curve.points) for curve in net.curves]


def test_drawings_of_curves_are_in_millimetres(tmp_path):
    ezdxf = pytest.importorskip("ezdxf")
    net = curve_net(replace(patch(12, -0.02), drawing=Drawing(units="Feet")), 1.0)
    write_net(tmp_path / "net.dxf", net)
    document = ezdxf.readfile(tmp_path / "net.dxf")
    (first, *_) = document.modelspace().query("POLYLINE")
    assert document.header["$INSUNITS"] == 4
    assert np.allclose([list(point) for point in first.points()], 304.8 * net.curves[0].points)


def sphere(across: float = 1.0) -> CGCProblem:
    """A cap of a sphere of radius 10, of a cylinder where it does not bend across."""
    vertices, faces = grid(8, 4.0)
    vertices[:, :2] -= 2.0
    vertices[:, 2] = np.sqrt(100.0 - vertices[:, 0] ** 2 - across * vertices[:, 1] ** 2)
    return CGCProblem(vertices, faces).with_supports("boundary").with_targets(0.01 * across)


@pytest.mark.parametrize(
    ("call", "sentence"),
    [
        (lambda: curve_net(patch(8, -0.02), 0.0), "the spacing must be larger than 0"),
        (lambda: curve_net(CGCProblem(*revolved_patch(8, 0.02)), 1.0), "no single target K"),
        (lambda: curve_net(sphere(), 1.0), "it is a sphere"),
        (lambda: curve_net(sphere(), 1.0, kind="asymptotic"), "no asymptotic curves: these need K < 0"),
        (lambda: curve_net(sphere(0.0), 1.0, kind="asymptotic"), "no asymptotic curves: these need K < 0"),
        (lambda: curve_net(CGCProblem(*grid(6)).with_supports("boundary").with_targets(0.0), 0.1), "it is a plane"),
        (lambda: curve_net(patch(8, -0.02), through=[[0.0, 0.0]]), "with shape"),
        (lambda: curve_net(patch(8, -0.02), through=[[90.0, 0.0, 0.0]]), "the points lie on it"),
    ],
    ids=["spacing", "target", "sphere", "no saddle", "cylinder", "plane", "points", "far away"],
)
def test_what_cannot_be_traced_is_refused_in_a_sentence(call, sentence):
    with pytest.raises(CGCError, match=sentence):
        call()
