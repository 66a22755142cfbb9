"""Membrane forces: closed forms, balance under refinement, finite elements, files, and what has no such state."""

from __future__ import annotations

import json

import numpy as np
import pytest
from scipy.integrate import cumulative_trapezoid

import compas_cgc
from compas_cgc import CGCError
from compas_cgc import CGCMesh
from compas_cgc import CGCProblem
from compas_cgc import solve
from compas_cgc.discrete import edge_faces
from compas_cgc.discrete import face_areas
from compas_cgc.discrete import face_normals
from compas_cgc.discrete.topology import within_rings
from compas_cgc.fabrication import membrane
from compas_cgc.fabrication.closing import closed
from compas_cgc.fabrication.loads import nodal_load
from compas_cgc.fabrication.membrane_fields import principal_forces
from compas_cgc.io.forces import write_forces
from compas_cgc.model.roles import FIXED
from compas_cgc.model.verdict import verdict

from ..support.constant_curvature import cone
from ..support.constant_curvature import revolved_patch
from ..support.membrane_elements import membrane_stresses
from ..support.roofs import irregular_disk
from ..support.roofs import nine_regions
from ..support.roofs import obtuse_share
from ..support.roofs import shaken_square
from ..support.shapes import alternating
from ..support.shapes import grid


def stress_at_vertices(state) -> np.ndarray:
    """Return the stress tensor N at every vertex, the area-weighted mean of its faces (n, 3, 3) [F/L]."""
    V, F = state.problem.vertices, state.problem.faces
    areas = face_areas(V, F)
    tensors = np.einsum("mk,mki,mkj->mij", state.forces, state.directions, state.directions)
    total, area = np.zeros((len(V), 3, 3)), np.zeros(len(V))
    for k in range(3):
        np.add.at(total, F[:, k], tensors * areas[:, None, None])
        np.add.at(area, F[:, k], areas)
    return total / np.maximum(area, np.finfo(float).tiny)[:, None, None]


def patch(n, K) -> CGCProblem:
    return CGCProblem(*revolved_patch(n, K)).with_supports("boundary").with_targets(K)


def unsupported() -> CGCProblem:
    return CGCProblem(*revolved_patch(6, 0.02)).with_targets(0.02)


def inside(n, margin):
    i, j = np.divmod(np.arange((n + 1) ** 2), n + 1)
    return (np.minimum(i, j) >= margin) & (np.maximum(i, j) <= n - margin)


def test_a_sphere_under_pressure_has_half_pressure_times_radius():
    vertices, faces = grid(16, 8.0)
    vertices[:, :2] -= 4.0
    vertices[:, 2] = np.sqrt(100.0 - vertices[:, 0] ** 2 - vertices[:, 1] ** 2)
    state = membrane(CGCProblem(vertices, faces).with_supports("boundary").with_targets(0.01), pressure=3.0)
    assert state.forces == pytest.approx(15.0, rel=1e-2)
    assert np.linalg.norm(state.edge_loads.load, axis=1) == pytest.approx(15.0, rel=2e-2)


@pytest.mark.parametrize("K", [0.02, -0.02], ids=["dome", "saddle"])
def test_along_a_surface_of_revolution_the_forces_are_those_of_its_rings(K):
    """Along the meridian p (r^2 + c) / 2 r cos: for N = p cof S / 2 K that is p k / 2 K, k the curvature of the ring."""
    n = 24
    state = membrane(patch(n, K), pressure=1.0)
    V = state.problem.vertices
    r = np.hypot(V[:, 1], V[:, 2])
    slope2 = (16.0 - r**2) * K  # of r along the meridian, squared: of 4 cos or 4 cosh
    ring = np.sqrt(1.0 - slope2) / r
    N = stress_at_vertices(state)
    # Across the meridian stands the circle around the axis.
    around = np.column_stack([0 * r, V[:, 2], -V[:, 1]]) / r[:, None]
    normal_to_ring = np.trace(N, axis1=1, axis2=2) - np.einsum("ni,nij,nj->n", around, N, around)
    inner = inside(n, 2)
    assert normal_to_ring[inner] == pytest.approx(ring[inner] / (2 * K), rel=5e-3)
    assert np.einsum("ni,nij,nj->n", around, N, around)[inner] == pytest.approx(1.0 / (2 * ring[inner]), rel=5e-3)


@pytest.mark.parametrize("K", [0.02, -0.02], ids=["dome", "saddle"])
def test_the_formula_is_balanced_the_better_the_finer_the_mesh(K):
    states = [membrane(patch(n, K), pressure=1.0) for n in (10, 20, 40)]
    errors = np.array([state.out_of_balance for state in states])
    assert (np.log2(errors[:-1] / errors[1:]) > 1.5).all()
    assert states[-1].correction < 0.01
    for state in states:
        assert state.imbalance < 1e-12
        total = state.reactions.sum(axis=0) + state.load.sum(axis=0)
        assert np.abs(total).max() < 1e-10 * np.linalg.norm(state.load, axis=1).sum()


def test_on_irregular_meshes_of_the_exact_measure_the_formula_is_balanced_too():
    """An oval dome, a third of its triangles obtuse: pressure by circumcentric cells is what its folds balance."""
    states = []
    for count in (140, 560, 2240):
        disk = irregular_disk(count)
        result = solve(disk.with_vertices(disk.vertices * [1.4, 1.0, 1.0]), method="newton", settings={"measure": "exact"})
        states.append(membrane(result, pressure=1.0))
    errors = np.array([state.out_of_balance for state in states])
    assert (np.log2(errors[:-1] / errors[1:]) > 1.0).all()
    assert max(state.correction for state in states[1:]) < 0.01
    assert max(state.imbalance for state in states) < 1e-12
    for load, reactions in (state.totals for state in states):
        assert reactions == pytest.approx(-load, abs=1e-10 * np.linalg.norm(load))


@pytest.mark.parametrize("K", [0.01, -0.01], ids=["dome", "saddle"])
def test_vertices_of_irregular_meshes_are_slid_until_the_formula_is_balanced(K):
    """Without the measure exact: edge forces were 17 to 117 % off, and are within 1 % after a slide that is said."""
    result = solve(shaken_square(25, K), method="projection")
    still, slid = (membrane(result, pressure=1.0, close=close) for close in (False, True))
    assert still.correction > 0.15 and slid.correction < 0.01 and slid.imbalance < 1e-12
    assert still.moved == 0.0 and (still.problem.vertices == result.problem.vertices).all()
    move = np.linalg.norm(slid.problem.vertices - result.problem.vertices, axis=1)
    assert slid.moved == pytest.approx(move.max()) and 0.01 < slid.moved < 0.3
    assert (move[~result.problem.asked] == 0.0).all()
    assert slid.remarks[0].startswith("vertices were slid by up to") and "mm" in slid.remarks[0]
    assert verdict(slid.problem).fair
    # What does not depend on the layout is as it was.
    assert np.median(slid.forces, axis=0) == pytest.approx(np.median(still.forces, axis=0), rel=0.02)


def shaken_saddle(n, shake, K=-0.02) -> CGCProblem:
    """Return a patch of a pseudosphere in closed form, of `n` rows of points shaken along it, held at its edge."""
    plan = shaken_square(n, K, shake=shake, width=8.0)
    s, turn = plan.vertices[:, 0] - 4.0, (plan.vertices[:, 1] - 4.0) / 4.0
    a, fine = (-K) ** 0.5, np.linspace(-4.0, 4.0, 20_001)
    x = np.interp(s, fine, cumulative_trapezoid(np.sqrt(1.0 - (4.0 * a * np.sinh(a * fine)) ** 2), fine, initial=0))
    r = 4.0 * np.cosh(a * s)
    return plan.with_vertices(np.column_stack([x, r * np.sin(turn), r * np.cos(turn)])).with_supports("boundary")


def test_where_slender_triangles_leave_no_room_others_are_laid_out():
    """A saddle with two fifths of its triangles obtuse: edge forces were 132 % off and stayed so."""
    saddle = shaken_saddle(20, 0.7)
    assert verdict(saddle).fair and obtuse_share(saddle.vertices, saddle.faces) > 0.4 and closed(saddle) is None
    still, slid = (membrane(saddle, pressure=1.0, close=close) for close in (False, True))
    assert still.correction > 1.0 and slid.correction < 0.005 and slid.imbalance < 1e-12
    here, there = still.problem, slid.problem
    assert obtuse_share(there.vertices, there.faces) < 0.1 and verdict(there).fair
    assert np.array_equal(here.vertices[~here.asked], there.vertices[~there.asked]) and (here.roles == there.roles).all()
    # The edge around the mesh has the same edges, and the load is that of the same surface.
    rims = [{tuple(sorted(edge)) for edge in edge_faces(own.faces)[edge_faces(own.faces)[:, 3] < 0, :2].tolist()} for own in (here, there)]
    assert rims[0] == rims[1]
    assert np.linalg.norm(slid.totals[0] - still.totals[0]) < 1e-2 * np.linalg.norm(still.load, axis=1).sum()
    assert "triangles were replaced" in slid.remarks[0]


@pytest.mark.parametrize("K", [0.02, -0.02], ids=["dome", "saddle"])
def test_finite_elements_find_the_same_forces(K):
    pytest.importorskip("skfem")
    n = 40
    state = membrane(patch(n, K), pressure=1.0)
    V, F = state.problem.vertices, state.problem.faces
    elements = membrane_stresses(V, F, 1.0, state.edge_loads.edges, -state.edge_loads.load)
    areas, total, weight = face_areas(V, F), np.zeros((len(V), 3, 3)), np.zeros(len(V))
    for k in range(3):
        np.add.at(total, F[:, k], elements * areas[:, None, None])
        np.add.at(weight, F[:, k], areas)
    ours, inner = stress_at_vertices(state), inside(n, 5)
    off = np.linalg.norm(ours - total / weight[:, None, None], axis=(1, 2)) / np.linalg.norm(ours, axis=(1, 2))
    assert off[inner].max() < 0.03


def test_finite_elements_find_the_forces_of_a_creased_roof_with_its_line_loads():
    """With line loads in place of the beams; with elastic beams instead, forces differ, see the tests of the engineer's model."""
    pytest.importorskip("skfem")
    state = membrane(solve(nine_regions(30)).problem, pressure=-1.5)
    V, F = state.problem.vertices, state.problem.faces
    elements = membrane_stresses(V, F, -1.5, state.edge_loads.edges, -state.edge_loads.load)
    found = principal_forces(np.repeat(elements[:, None], 3, axis=1), face_normals(V, F))[0]
    lines = np.zeros(len(V), bool)
    lines[np.unique(state.edge_loads.edges)] = True
    inner = ~within_rings(F, lines, 2)[F].any(axis=1)
    off = np.abs(found - state.forces)[inner] / np.abs(state.forces[inner]).max(axis=1)[:, None]
    assert inner.sum() > 250 and (np.median(off, axis=0) < 0.005).all()


def test_self_weight_is_balanced_and_compresses_a_dome():
    state = membrane(patch(16, 0.02), weight=2.0)
    area = face_areas(state.problem.vertices, state.problem.faces).sum()
    assert state.imbalance < 1e-12
    assert state.reactions.sum(axis=0) + state.load.sum(axis=0) == pytest.approx([0, 0, 0], abs=1e-9 * area)
    assert state.load[:, 2].sum() == pytest.approx(-2.0 * area, rel=1e-12)
    assert state.forces[:, 1].max() < 0


def test_forces_turn_with_the_surface_and_scale_with_the_load():
    problem = patch(10, 0.02)
    turn = np.linalg.qr(np.array([[1.0, 2.0, 0.5], [0.3, -1.0, 2.0], [2.0, 0.1, 1.0]]))[0]
    turn *= np.sign(np.linalg.det(turn))
    still = membrane(problem, pressure=1.0)
    moved = membrane(problem.with_vertices(problem.vertices @ turn.T), pressure=-2.0)
    assert moved.edge_forces == pytest.approx(-2.0 * still.edge_forces, rel=1e-6, abs=1e-9)
    assert moved.reactions == pytest.approx(-2.0 * still.reactions @ turn.T, rel=1e-6, abs=1e-9)


def test_a_crease_takes_what_its_two_sides_leave_over():
    """Two domes that meet in a valley: the load on the crease is the sum of both, along the bisector."""
    vertices, faces = revolved_patch(12, 0.02)
    low = vertices.min(axis=0)
    both = np.vstack([vertices, vertices * [-1.0, 1.0, 1.0] + [2 * low[0], 0.0, 0.0]])
    n = len(vertices)
    twin = np.arange(2 * n)
    on = np.flatnonzero(np.abs(vertices[:, 0] - low[0]) < 1e-9)
    twin[on + n] = on
    used, renumbered = np.unique(twin[np.vstack([faces, faces[:, ::-1] + n])], return_inverse=True)
    problem = CGCProblem(both[used], renumbered.reshape(-1, 3)).with_supports("boundary").with_creases([on.tolist()]).with_targets(0.02)
    state = membrane(problem, pressure=1.0)
    on_crease = state.edge_loads.load[state.edge_loads.kind == 1]
    assert len(on_crease) == 12
    # By symmetry nothing across.
    assert np.abs(on_crease[:, 0]).max() < 1e-9
    assert np.linalg.norm(on_crease, axis=1).min() > 0.1
    assert any("creases" in remark for remark in state.remarks)


def test_files_hold_the_forces(tmp_path):
    state = membrane(patch(6, 0.02), pressure=1.5)
    paths = [tmp_path / f"forces{suffix}" for suffix in (".inp", ".json", ".3dm")]
    for path in paths:
        write_forces(path, state)
    text = paths[0].read_text()
    elements = text.split("ELSET=REGION0\n")[1].split("*")[0].split()
    assert text.count("M3D3") == 1 and "INSIDE, P, 1.5" in text and "*BOUNDARY\nSUPPORTS, 1, 3" in text
    assert len(elements) == 4 * len(state.problem.faces)
    from compas.data import json_load

    mesh = json_load(paths[1])
    assert [mesh.face_attribute(face, "N1") for face in mesh.faces()] == state.forces[:, 0].tolist()
    assert np.array([mesh.vertex_attribute(v, "reaction") for v in mesh.vertices()]) == pytest.approx(state.reactions)
    assert json.loads(paths[1].read_text())["data"]["attributes"]["membrane"]["pressure"] == 1.5
    from compas_cgc.io.rhino.archive import list_items
    from compas_cgc.io.rhino.archive import read_archive

    items = list_items(read_archive(paths[2]))
    layers = {item.layer for item in items}
    assert {f"CGC Membrane::{name}" for name in ("N1", "N2", "Crosses N1", "Crosses N2", "Reactions", "Line loads")} <= layers
    drawn = {item.text["n1"] for item in items if item.layer == "CGC Membrane::Crosses N1"}
    assert {repr(force) for force in state.forces[:, 0].tolist()} == drawn


@pytest.mark.parametrize(
    ("call", "sentence"),
    [
        (lambda: membrane(patch(6, 0.02)), "membrane forces need a load"),
        (lambda: membrane(patch(6, 0.02), pressure=float("inf")), "loads must be finite, not a pressure of inf"),
        (lambda: membrane(patch(6, 0.02), weight=float("nan")), "loads must be finite, not .* a weight of nan"),
        (lambda: membrane(CGCProblem(*cone(5, 20)).with_supports("boundary").with_targets(0.0), 1.0), "region 0 has K = 0"),
        (
            lambda: membrane(unsupported(), 1.0, edge_beams=False),
            "without edge beams, membrane forces cannot balance this load",
        ),
        (lambda: membrane(CGCProblem(*revolved_patch(6, 0.02)).with_supports("boundary"), 1.0), "no single target K"),
    ],
    ids=["no load", "endless", "no number", "K = 0", "free edges", "no target"],
)
def test_where_there_is_no_membrane_state_a_sentence_says_why(call, sentence):
    with pytest.raises(CGCError, match=sentence):
        call()


def test_free_edges_are_said_to_need_beams():
    state = membrane(unsupported(), 1.0)
    assert any("edge beam" in remark for remark in state.remarks)


@pytest.mark.nightly
def test_a_saddle_along_the_mesh_is_balanced_with_small_corrections():
    """Asymptotic curves along the diagonals of a grid: alternating moves of its vertices hardly stretch an edge."""
    largest = []
    for n in (16, 24, 32):
        saddle = solve(CGCProblem(*grid(n, 15.0)).with_supports("corners").with_targets(-0.01))
        state = membrane(saddle, pressure=-1.5)
        assert state.imbalance < 1e-9 and state.correction < 0.05
        assert state.moved < 0.001 * 15.0 and verdict(state.problem).fair
        free = saddle.problem.roles != FIXED
        assert np.array_equal(state.problem.vertices[~free], saddle.problem.vertices[~free])
        largest.append(np.abs(state.forces).max())
    assert np.allclose(largest, largest[-1], rtol=0.1)


def corner_saddle(faces, vertices) -> CGCProblem:
    """Return a solved saddle over a square of 15 m on its corners, whose asymptotic curves run along the diagonals."""
    corners = [int(np.argmin(np.linalg.norm(vertices[:, :2] - corner, axis=1))) for corner in ((0, 0), (15, 0), (15, 15), (0, 15))]
    return solve(CGCProblem(vertices, faces).with_supports(corners).with_targets(-0.01)).problem


@pytest.mark.parametrize("load", [{"weight": 1.0}, {"pressure": -1.5}], ids=["weight", "pressure"])
def test_forces_out_of_proportion_are_refused_with_the_remedy(load):
    """Neighbours that move in opposite directions along asymptotes stretch no edge: edge forces were 80,000 per unit load."""
    saddle = corner_saddle(alternating(32), grid(32, 15.0)[0])
    with pytest.raises(CGCError, match="forces run along asymptotic curves.* mesh the plan with irregular triangles, as from an outline"):
        membrane(saddle, **load, close=False)


def test_the_remedy_helps():
    """Self weight of the same saddle on the mesh of an outline."""
    own = CGCMesh.from_outline([[0, 0, 0], [15, 0, 0], [15, 15, 0], [0, 15, 0]], 1.0).to_problem()
    state = membrane(corner_saddle(own.faces, own.vertices), weight=1.0)
    assert state.imbalance < 1e-12 and state.amplification < 1.0
    assert not any("K < 0" in remark for remark in state.remarks)


def test_self_weight_of_a_saddle_along_the_mesh_is_balanced_as_far_as_nodal_loads_are_known():
    """The forces are those of the irregular mesh, 4.5 (median) and 8 at most; the residual alternates from vertex to vertex."""
    vertices, faces = grid(24, 15.0)
    state = membrane(corner_saddle(faces, vertices), weight=1.0)
    assert state.imbalance < 1e-4 and state.amplification < 1.0 and np.abs(state.forces).max() < 10.0
    assert any("balance the load up to" in remark and "irregular triangles" in remark for remark in state.remarks)
    load, reactions = state.totals
    assert reactions == pytest.approx(-load, abs=1e-4 * np.linalg.norm(load))


@pytest.mark.parametrize("load", [{"weight": 1.0}, {"pressure": 1.0}], ids=["weight", "pressure"])
def test_amplification_of_domes_does_not_depend_on_the_mesh(load):
    coarse, fine = (membrane(patch(n, 0.02), **load).amplification for n in (12, 24))
    assert coarse == pytest.approx(fine, rel=0.05) and 0.3 < fine < 2.0


def test_neighbours_of_different_valence_carry_the_same_weight():
    vertices = grid(8, 8.0)[0]
    load = nodal_load(vertices, alternating(8), 0.0, 1.0)
    assert load[inside(8, 1)] == pytest.approx(np.tile([0.0, 0.0, -1.0], (49, 1)))


def test_singular_corners_of_a_cushion_are_not_taken_for_an_ill_conditioned_mesh():
    state = membrane(solve(compas_cgc.read(compas_cgc.get("cushion.3dm"))), pressure=-1.5)
    assert state.amplification > 3.0 and not any("ill-conditioned" in remark for remark in state.remarks)
