"""Panels and the moulds they are made on: closed forms of caps and surfaces, one mould per K, and what is refused."""

from __future__ import annotations

import json

import numpy as np
import pytest
from scipy.spatial import cKDTree

from compas_cgc import CGCProblem
from compas_cgc import solve
from compas_cgc.discrete import edge_faces
from compas_cgc.discrete import face_areas
from compas_cgc.discrete import gaussian_curvature
from compas_cgc.fabrication import MATERIALS
from compas_cgc.fabrication import moulds
from compas_cgc.fabrication import panels
from compas_cgc.fabrication import widest_panel
from compas_cgc.fabrication.bending import corner_operators
from compas_cgc.fabrication.caps import smallest_cap
from compas_cgc.fabrication.fitting import rigid_fits
from compas_cgc.fabrication.flattening import flatten
from compas_cgc.fabrication.materials import bending_stress
from compas_cgc.fabrication.mould_surface import cap_mesh
from compas_cgc.fabrication.mould_surface import surface_for
from compas_cgc.fabrication.panelling import Panel
from compas_cgc.fabrication.space_form import chords
from compas_cgc.fabrication.space_form import geodesics
from compas_cgc.fabrication.space_form import on_form
from compas_cgc.fabrication.space_form import to_pole
from compas_cgc.fabrication.space_form import turned
from compas_cgc.meshing import boundary_loops

from ..support.roofs import irregular_disk
from ..support.roofs import nine_regions
from ..support.shapes import grid

CURVATURES = [0.04, 1e-9, 0.0, -1e-9, -0.04]


@pytest.fixture(scope="module")
def roof() -> CGCProblem:
    result = solve(nine_regions(24, centre=-0.01), method="projection", settings={"measure": "exact"})
    assert result.converged
    return result.problem


# Caps


def polar(distance, angle, K):
    """Return points at distances along the surface from the pole, found by another way than the code's."""
    root = abs(K) ** 0.5
    out = np.sin(root * distance) / root if K > 0 else np.sinh(root * distance) / root if K < 0 else distance
    return on_form(np.column_stack([out * np.cos(angle), out * np.sin(angle)]), K)


@pytest.mark.parametrize("K", CURVATURES)
def test_the_smallest_cap_around_a_disk_is_the_disk(K):
    rng = np.random.default_rng(1)
    edge = polar(np.full(5, 1.5), np.array([0.1, 1.9, 3.4, 4.2, 5.5]), K)
    points = np.vstack([edge, polar(rng.uniform(0, 1.5, 200), rng.uniform(0, 6.3, 200), K)])
    for motion in (np.eye(3), to_pole(polar(np.array([2.0]), np.array([0.7]), K)[0], K)):
        cap = smallest_cap(turned(points, motion), K)
        assert cap.radius == pytest.approx(1.5, abs=1e-12)
        assert np.allclose(cap.centre, motion[:, 0], atol=1e-9)


@pytest.mark.parametrize("K", CURVATURES)
def test_two_points_determine_the_cap_around_an_obtuse_triangle(K):
    points = polar(np.array([1.0, 1.0, 0.2]), np.array([0.0, np.pi, 1.0]), K)
    assert smallest_cap(points, K).radius == pytest.approx(1.0, abs=1e-12)


# Surfaces


def test_the_mould_of_negative_k_is_the_hyperbolic_plane_in_space():
    surface, K = surface_for(-0.04, 1.0), -0.04
    vertices, faces = cap_mesh(surface, 1.0)
    inside = np.arange(len(vertices)) < len(vertices) // 2
    assert np.nanmedian(gaussian_curvature(vertices, faces, "voronoi")[inside]) == pytest.approx(K, rel=0.01)
    # Lengths in space are those along the surface, to the third order.
    points = polar(np.array([0.5, 0.5 + 1e-4, 0.5]), np.array([1.0, 1.0, 1.0 + 1e-4]), K)
    there = surface.places(points)
    for other in (1, 2):
        along = geodesics(chords(points[[0]], points[[other]], K), K)[0]
        assert np.linalg.norm(there[0] - there[other]) == pytest.approx(along, rel=1e-7)
    assert np.allclose(surface.places(polar(np.zeros(1), np.zeros(1), K)), 0.0)
    assert np.allclose(surface.principal(points).prod(axis=1), K)
    # It is convex towards +z along its larger principal curvature, which is that of the parallels.
    across = surface.places(polar(np.array([0.01, 0.01]), np.array([np.pi / 2, -np.pi / 2]), K))
    assert (across[:, 2] < 0).all()


@pytest.mark.parametrize("K", [0.04, 0.0])
def test_the_mould_of_other_k_is_a_sphere_or_a_plane(K):
    vertices, _ = cap_mesh(surface_for(K, 2.0), 2.0)
    off = np.linalg.norm(vertices + [0, 0, 5.0], axis=1) - 5.0 if K else vertices[:, 2]
    assert np.abs(off).max() < 1e-14


def test_a_pseudosphere_has_no_room_for_everything():
    with pytest.raises(ValueError, match="a panel of radius 1.5 is too large for a pseudosphere of K = -1"):
        surface_for(-1.0, 1.5)


def test_rigid_motions_are_found_and_mirror_images_are_none():
    rng = np.random.default_rng(3)
    points = rng.normal(size=(20, 3))
    turn, _ = np.linalg.qr(rng.normal(size=(3, 3)))
    turn *= np.linalg.det(turn)
    there = points @ turn.T + [1, 2, 3]
    fit = rigid_fits(np.array([points * [1, 1, -1], points]), there)
    assert fit.most < 1e-14 and np.allclose(fit(points), there)
    assert rigid_fits(np.array([points * [1, 1, -1]]), there).most > 0.1


# Panels


def test_panels_take_every_face_once_and_follow_the_rows_of_a_grid(roof):
    found = panels(roof, 1.25)
    assert len(found) == 144
    faces = np.concatenate([panel.faces for panel in found])
    assert np.array_equal(np.sort(faces), np.arange(len(roof.faces)))
    assert {len(panel.faces) for panel in found} == {8}
    label = roof.regions()
    assert all((label[panel.faces] == panel.region).all() for panel in found)
    assert len({panel.name for panel in found}) == 144


def cut_whole(problem, found):
    """Return the cut mesh of panels that take each of its faces once, all of them parts of one region's faces."""
    cut = found[0].cut
    assert all(panel.cut is cut for panel in found)
    assert np.array_equal(np.sort(np.concatenate([panel.faces for panel in found])), np.arange(len(cut.faces)))
    assert all((problem.regions()[cut.parent[panel.faces]] == panel.region).all() for panel in found)
    return cut


@pytest.mark.parametrize("along", ["plan", "curvature"])
def test_panels_of_an_irregular_mesh_are_in_one_piece_and_of_a_size(along):
    problem = irregular_disk(500)
    found = panels(problem, count=20, along=along)
    assert 14 <= len(found) <= 26
    cut = cut_whole(problem, found)
    for panel in found:
        faces = cut.faces[panel.faces]
        width = np.ptp(cut.vertices[np.unique(faces)], axis=0)
        assert len(boundary_loops(faces)) == 1
        assert len(panel.faces) >= 5 and width.max() < 6.0


def test_cutting_leaves_the_surface_its_nodes_and_its_edges():
    problem = irregular_disk(300)
    x, y = problem.vertices[:, :2].T
    problem = problem.with_vertices(np.column_stack([x, y, 0.1 * x * y]))
    cut = cut_whole(problem, panels(problem, 3.0))
    n = len(problem.vertices)
    assert np.array_equal(cut.vertices[:n], problem.vertices)
    corners = problem.vertices[problem.faces[cut.parent]]
    assert np.abs(np.einsum("fcw,fwx->fcx", cut.weights, corners) - cut.vertices[cut.faces]).max() < 1e-14
    area = np.bincount(cut.parent, face_areas(cut.vertices, cut.faces))
    assert np.allclose(area, face_areas(problem.vertices, problem.faces), rtol=1e-12)
    # Neighbours share every vertex: the open edges are those of the mesh, cut.
    loop, before = boundary_loops(cut.faces), boundary_loops(problem.faces)
    assert len(loop) == 1 and set(before[0]) <= set(loop[0])
    assert len(np.unique(np.sort(edge_faces(cut.faces)[:, :2], axis=1), axis=0)) == len(edge_faces(cut.faces))
    # Nothing is cut twice: no vertex lies within a thousandth of an edge of another.
    assert cKDTree(cut.vertices).query(cut.vertices, k=2)[0][:, 1].min() > 1e-5


def test_joints_are_straight_in_plan_through_irregular_faces():
    problem = irregular_disk(500)
    found = panels(problem, 3.0)
    cut = cut_whole(problem, found)
    of = np.empty(len(cut.faces), int)
    for number, panel in enumerate(found):
        of[panel.faces] = number
    edges = edge_faces(cut.faces)
    edges = edges[edges[:, 3] >= 0]
    joint = edges[of[edges[:, 2]] != of[edges[:, 3]], :2]
    whole = problem.vertices[problem.faces]
    off = 0.01 * np.linalg.norm(np.roll(whole, -1, axis=1) - whole, axis=2).max()
    low, extent = problem.vertices[:, :2].min(axis=0), np.ptp(problem.vertices[:, :2], axis=0)
    lines = low[:, None] + extent[:, None] * np.arange(1, 5) / 5
    miss = np.abs(cut.vertices[joint][:, :, :2, None] - lines).min(axis=3)  # by end and axis
    assert (miss.max(axis=1).min(axis=1) <= off).all()
    assert len(joint) > 200 and np.median(miss.max(axis=1).min(axis=1)) < 1e-12


def test_regions_are_cut_from_side_to_side_and_share_the_nodes_on_their_creases():
    # Rows of 8 squares into 3 panels: nothing falls on a row.
    problem = nine_regions(24)
    found = panels(problem, 5.0 / 3.0)
    assert len(found) == 81
    cut = cut_whole(problem, found)
    for panel in found:
        width = np.ptp(cut.vertices[np.unique(cut.faces[panel.faces])], axis=0)
        assert np.allclose(width[:2], 5.0 / 3.0, atol=0.15 * 15.0 / 24)
    edges = edge_faces(cut.faces)
    assert (edges[edges[:, 3] < 0, :2].size // 2) == 4 * (24 + 6)


def test_panels_along_the_lines_of_curvature_of_a_cylinder():
    i, j = np.divmod(np.arange(21 * 21), 21)
    turn = (i + 0.5 * j) / 20 * 1.2  # rows askew to the axis
    vertices = np.column_stack([2 * np.cos(turn), 2 * np.sin(turn), 4 * j / 20])
    _, faces = grid(20)
    found = panels(CGCProblem(vertices, faces), 0.8, along="curvature")
    # The lines of curvature are circles and rulings, so a panel is as wide across and along as asked.
    cut = found[0].cut
    for panel in found:
        used = cut.vertices[np.unique(cut.faces[panel.faces])]
        assert np.ptp(np.arctan2(used[:, 1], used[:, 0])) * 2 < 1.4 and np.ptp(used[:, 2]) < 1.4


def test_panels_between_curves(roof):
    at = np.arange(25)
    middle = 12 * 25 + at  # a row of vertices across the three regions in the middle
    as_points = roof.vertices[middle]
    for curve in (middle, as_points):
        found = panels(roof, curves=[curve])
        assert len(found) == 12
    with pytest.raises(ValueError, match="is not near any edge"):
        panels(roof, curves=[as_points + [0, 0, 50]])


def test_a_curve_across_faces_is_cut_along():
    problem = irregular_disk(400)
    angle = np.linspace(0.0, 2.0 * np.pi, 200)
    circle = np.column_stack([4.0 * np.cos(angle), 4.0 * np.sin(angle), np.zeros(200)])
    across = np.array([[-9.0, 1.0, 0.0], [9.0, -1.0, 0.0]])
    found = panels(problem, curves=[circle, across])
    assert len(found) == 4
    cut = cut_whole(problem, found)
    areas = sorted(face_areas(cut.vertices, cut.faces[panel.faces]).sum() for panel in found)
    assert np.allclose(areas[:2], 0.5 * np.pi * 16.0, rtol=0.01)
    assert np.abs(areas[0] - areas[1]) < 0.02 * areas[0]


def test_how_to_divide_is_said_once():
    problem = nine_regions(6)
    for given in ({}, {"size": 1.0, "count": 4}):
        with pytest.raises(ValueError, match="exactly one of size, count, curves, and columns or rows"):
            panels(problem, **given)
    with pytest.raises(ValueError, match="along must be one of plan, curvature"):
        panels(problem, 1.0, along="laths")
    with pytest.raises(ValueError, match="size of panels must be a positive length"):
        panels(problem, -1.0)


# Moulds


def test_one_mould_for_every_k_and_every_panel_fits(roof):
    report = moulds(roof, panels(roof, 1.25))
    assert [(mould.K, mould.panels, mould.kind) for mould in report.moulds] == [(0.01, 128, "sphere"), (-0.01, 16, "pseudosphere")]
    V = roof.vertices
    for fit in report.panels:
        laid = fit.development
        assert fit.edge_error <= 1e-11 and fit.gap <= 1e-8
        assert np.all(geodesics(chords(laid.points, np.array([[1.0, 0, 0]]), laid.K), laid.K) <= fit.radius * (1 + 1e-9))
        assert fit.radius <= report.moulds[fit.mould - 1].radius
        # Not bent it misses its place by what is told.
        missed = np.linalg.norm(fit.into_place(fit.on_mould) - V[laid.vertices], axis=1).max()
        assert 1e3 * missed == pytest.approx(fit.rigid)
        if laid.K > 0:
            a, b = laid.faces.ravel(), np.roll(laid.faces, -1, axis=1).ravel()
            here = np.linalg.norm(fit.on_mould[a] - fit.on_mould[b], axis=1)
            assert np.allclose(here, np.linalg.norm(V[laid.vertices[a]] - V[laid.vertices[b]], axis=1), rtol=1e-11)
    worst = max(report.panels, key=lambda fit: fit.change)
    # The other principal change adds to the stress or relieves it, by Poisson's ratio at most.
    assert abs(worst.stress / (70e3 * 0.006 * worst.change / (2 * (1 - 0.23**2))) - 1.0) <= 0.23
    assert "144 panels on 2 moulds; edges of triangles are chords of the moulds" in str(report)
    assert json.loads(json.dumps(report.to_dict()))["moulds"][1]["K"] == -0.01


def test_a_panel_around_a_hole_with_a_slit_within_faces_is_laid_out():
    """Its whole faces form a ring, as they are wider than the slit."""
    dome = solve(
        CGCProblem(*grid(12, 4.0)).with_supports("boundary").with_targets(0.05), method="newton", settings={"measure": "exact"}
    ).problem
    found = panels(dome, 0.8)
    cut = found[0].cut
    assert cut is not None
    centres = np.array([cut.vertices[cut.faces[panel.faces]].mean(axis=(0, 1))[:2] for panel in found])
    middle = centres[np.argmin(np.linalg.norm(centres - centres.mean(axis=0), axis=1))]
    around = np.argsort(np.linalg.norm(centres - middle, axis=1))[1:9]
    above = around[np.argmin(np.linalg.norm(centres[around] - middle - [0.0, 0.8], axis=1))]
    beside = around[np.argmin(np.linalg.norm(centres[around] - middle - [0.8, 0.8], axis=1))]
    slit = np.isin(cut.parent[found[above].faces], cut.parent[found[beside].faces])
    ring = np.concatenate([found[k].faces[~slit] if k == above else found[k].faces for k in around])
    assert slit.any() and len(boundary_loops(dome.faces[np.unique(cut.parent[ring])])) == 2
    (panel,) = moulds(dome, [Panel("0-1", 0, ring, cut)]).panels
    assert panel.gap < 1e-9 and panel.edge_error < 1e-11


def test_panels_flattened_are_strained_by_the_rule_for_their_own_width():
    """They are divided in plan: on the roof they are longer than that along one side, and askew."""
    roof = solve(nine_regions(48), method="projection", settings={"measure": "exact"})
    report = moulds(roof, panels(roof, 2.5))
    widest = max(fit.width for fit in report.panels)
    assert 2.2 < min(fit.width for fit in report.panels) < widest < 2.9
    for fit in report.panels:
        used, faces = np.unique(fit.faces, return_inverse=True)
        strain = flatten(fit.vertices[used], faces.reshape(-1, 3)).largest
        assert fit.width == pytest.approx(widest_panel(0.01, strain), rel=0.1)
    assert f"{1e3 * widest:.0f} mm at most) need strains of" in str(report)


def test_cut_panels_are_congruent_to_their_parts_of_the_mould(roof):
    dome = solve(irregular_disk(350), method="newton", settings={"measure": "exact"}).problem
    for solved, size in ((roof, 5.0 / 3.0), (dome, 2.1)):
        found = panels(solved, size)
        cut_whole(solved, found)
        for fit in moulds(solved, found).panels:
            assert fit.gap <= 1e-8 and fit.edge_error <= 1e-11
            u, v = fit.faces.ravel(), np.roll(fit.faces, -1, axis=1).ravel()
            long, there = (np.linalg.norm(points[u] - points[v], axis=1) for points in (fit.vertices, fit.on_mould))
            if fit.development.K < 0:
                assert np.allclose(there, long, rtol=5e-3)
                continue
            # In space, joints too: the mould is the mesh inscribed in the sphere, cut as the roof is.
            assert np.allclose(there, long, rtol=1e-10)
            inscribed = np.isin(fit.vertices, solved.vertices).all(axis=1)
            out = np.linalg.norm(fit.on_mould + [0.0, 0.0, 10.0], axis=1)
            assert np.allclose(out[inscribed], 10.0, rtol=1e-13) and ((out <= 10.0 + 1e-12) & (out > 9.9)).all()
            assert face_areas(fit.on_mould, fit.faces).sum() == pytest.approx(face_areas(fit.vertices, fit.faces).sum(), rel=1e-12)
        shifted = solved.with_vertices(solved.vertices + 1.0)
        with pytest.raises(ValueError, match="belongs to another surface"):
            moulds(shifted, found)


def test_a_dome_fits_its_sphere_without_bending_either_way_up():
    problem = irregular_disk(400)
    dome = solve(problem, method="newton", settings={"measure": "exact"}).problem
    bowl = CGCProblem(dome.vertices * [1, 1, -1], dome.faces, roles=dome.roles, targets=dome.targets)
    turned_over = CGCProblem(dome.vertices, dome.faces[:, ::-1], roles=dome.roles, targets=dome.targets)
    for surface in (dome, bowl, turned_over):
        report = moulds(surface, panels(surface, 4.0), material="steel", thickness=3)
        assert max(fit.rigid for fit in report.panels) < 1e-8
        # Within the edge, and up to the edge, where curvature is extrapolated.
        apart = np.abs(np.sort(np.abs(np.linalg.eigvalsh(corner_operators(surface))), axis=2)[..., 1:] - 0.1).max(axis=2)
        assert apart[surface.asked[surface.faces]].max() < 2e-3
        assert max(fit.change for fit in report.panels) < 2.5e-3


def test_units_and_lengths_along_the_mould_are_noticed():
    problem = nine_regions(12)
    arcs = solve(problem, method="projection", settings={"measure": "exact-arc"}).problem
    report = moulds(arcs, panels(arcs, 5.0))
    assert report.edges == "arcs" and max(fit.gap for fit in report.panels) < 1e-8
    # Joints meet edges as far along their arcs as along the edges in place.
    across = moulds(arcs, panels(arcs, 5.0 / 1.5 / 2))
    assert across.panels[0].panel.cut is not None
    assert max(fit.edge_error for fit in across.panels) < 1e-11 and max(fit.gap for fit in across.panels) < 1e-8
    drawing = problem.drawing._replace(units="Millimeters")
    large = CGCProblem(arcs.vertices * 1e3, arcs.faces, arcs.roles, arcs.targets * 1e-6, creases=arcs.creases, drawing=drawing)
    again = moulds(large, panels(large, 5000.0))
    for one, other in zip(report.panels, again.panels):
        assert (other.rigid, other.stress, other.radius) == pytest.approx((one.rigid, one.stress, 1e3 * one.radius), rel=1e-6)


def test_panels_of_nearly_one_k_share_a_mould_within_a_tolerance():
    problem = nine_regions(12).with_targets({0: 0.0101})
    solved = solve(problem, method="projection", settings={"measure": "exact"}).problem
    divided = panels(solved, 2.5)
    assert len(moulds(solved, divided).moulds) == 2
    shared = moulds(solved, divided, tolerance=1.0)
    assert len(shared.moulds) == 1 and 1e-4 < max(fit.gap for fit in shared.panels) <= 1.0


def test_what_has_no_mould_is_refused_in_a_sentence(roof):
    label = roof.regions()
    across = Panel("by hand", 3, np.flatnonzero((label == 3) | (label == 4)))
    with pytest.raises(ValueError, match="panel by hand has targets K̄ from -0.01 to 0.01, but all K on a mould have the same sign"):
        moulds(roof, [across])
    ring = Panel("ring", 0, np.flatnonzero(label != 4))
    with pytest.raises(ValueError, match="panel ring has a hole and needs a seam"):
        moulds(roof.with_targets(0.01), [ring], rough=True)
    flat = nine_regions(12)
    with pytest.raises(ValueError, match="the surface is rough"):
        moulds(flat, panels(flat, 2.5))
    with pytest.raises(ValueError, match="there is no material 'cheese'; use one of glass, steel, gfrp, timber"):
        moulds(roof, [across], material="cheese")
    with pytest.raises(ValueError, match="thickness must be a positive number"):
        moulds(roof, [across], thickness=0.0)
    with pytest.raises(ValueError, match="there are no panels"):
        moulds(roof, [])
    with pytest.raises(ValueError, match="two panels have the name by hand"):
        moulds(roof, [across, across])
    for faces in ([], [10**6], [0.5]):
        with pytest.raises(ValueError, match="the faces of panel odd must be indices from 0 to 1151"):
            moulds(roof, [Panel("odd", 0, np.array(faces))])
    with pytest.raises(ValueError, match="a region of 128 triangles cannot be divided into [0-9]+ or more panels"):
        panels(roof, count=1_000_000)


def test_a_crumpled_surface_is_refused(roof):
    crumpled = roof.with_vertices(roof.vertices + np.random.default_rng(0).normal(scale=0.05, size=roof.vertices.shape))
    with pytest.raises(ValueError, match="rough"):
        moulds(crumpled, panels(crumpled, 1.25))


def test_bending_stress_of_a_plate():
    assert bending_stress(MATERIALS["glass"], 0.006, 0.023) == pytest.approx(5.1e6, rel=0.01)


def test_points_beyond_the_edge_of_a_pseudosphere_are_not_numbers():
    surface = surface_for(-1.0, 0.5)
    angles = np.linspace(0.0, 2.0 * np.pi, 24, endpoint=False)
    points = on_form(np.concatenate([radius * np.column_stack([np.cos(angles), np.sin(angles)]) for radius in (0.4, 2.0)]), -1.0)
    with np.errstate(all="raise"):
        places, bends = surface.places(points), surface.principal(points)
    beyond = np.isnan(places).all(axis=1)
    assert not beyond[:24].any() and beyond[24:].any() and not beyond[24:].all()
    assert np.isfinite(places[~beyond]).all() and np.array_equal(np.isnan(bends).all(axis=1), beyond)
    assert bends[~beyond].prod(axis=1) == pytest.approx(-1.0)
