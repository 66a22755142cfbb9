"""Bending of panels against an independent evaluation: closed forms in position, differentiated moulds, rigid triangles between them."""

from __future__ import annotations

import re
import shutil

import numpy as np
import pytest
from scipy.spatial import cKDTree

from compas_cgc import CGCMesh
from compas_cgc import CGCProblem
from compas_cgc import solve
from compas_cgc.fabrication import moulding
from compas_cgc.fabrication import moulds
from compas_cgc.fabrication import panels
from compas_cgc.fabrication import space_form
from compas_cgc.fabrication.bending import corner_operators
from compas_cgc.fabrication.bending import plate_stress
from compas_cgc.fabrication.bending import unbounded_curvature
from compas_cgc.fabrication.materials import MATERIALS
from compas_cgc.fabrication.mould_report import _percentile_95
from compas_cgc.fabrication.shape_operators import shape_operators

from ..support.constant_curvature import revolved_patch
from ..support.plate_elements import Revolved
from ..support.plate_elements import bending_stresses
from ..support.shapes import grid


def mesh_dependent(problem):
    """Return the vertices where curvature is unbounded for whatever cause (n,)."""
    return np.any(list(unbounded_curvature(problem).values()), axis=0)


def patch(n, K) -> CGCProblem:
    return CGCProblem(*revolved_patch(n, K)).with_supports("boundary").with_targets(K)


def revolved_operator(points, K):
    """Return the shape operators of the surface of revolution through points (n, 3), convex across its rings (n, 3, 3)."""
    r = np.hypot(points[:, 1], points[:, 2])
    root = np.sqrt(1.0 - (16.0 - r**2) * K)
    around = np.column_stack([0 * r, points[:, 2], -points[:, 1]]) / r[:, None]
    slope = np.sqrt(np.maximum((16.0 - r**2) * K, 0.0))
    along = np.column_stack([root, -np.sign(points[:, 0] * K)[:, None] * (slope / r)[:, None] * points[:, 1:]])
    along /= np.linalg.norm(along, axis=1, keepdims=True)
    ring = root / r
    return ring[:, None, None] * around[:, :, None] * around[:, None] + (K / ring)[:, None, None] * along[:, :, None] * along[:, None]


def differentiated_operators(surface, points):
    """Return the shape operators of a mould at points of the space form by finite differences of its positions (p, 3, 3)."""
    step = 1e-3
    ways = step * np.eye(3)[1:]

    def at(move):
        return surface.places(space_form.normalised(points + move, surface.K))

    slopes = np.stack([(at(way) - at(-way)) / (2 * step) for way in ways], axis=2)
    normals = np.cross(slopes[:, :, 0], slopes[:, :, 1])
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    second = np.empty((len(points), 2, 2))
    for i in range(2):
        for j in range(2):
            one, other = ways[i], ways[j]
            bend = (at(one + other) - at(one - other) - at(other - one) + at(-one - other)) / (4 * step**2)
            second[:, i, j] = -np.einsum("pk,pk->p", bend, normals)
    inverse = np.linalg.inv(slopes.transpose(0, 2, 1) @ slopes)
    return slopes @ inverse @ second @ inverse @ slopes.transpose(0, 2, 1)


def independent(fit, mould, K):
    """Return the principal changes of curvature at the corners of the faces of a panel of whole faces (f, 3, 2)."""
    points = fit.development.points
    assert np.allclose(mould.surface.places(points), fit.on_mould)
    places, on_mould = fit.vertices[fit.faces], fit.on_mould[fit.faces]
    mould_operator = differentiated_operators(mould.surface, points)[fit.faces]
    changes = []
    for here, away, M in zip(places, on_mould, mould_operator):
        frames = []
        for corners in (here, away):
            e = corners[1] - corners[0]
            normal = np.cross(e, corners[2] - corners[0])
            frames.append(np.array([e / np.linalg.norm(e), np.cross(normal, e) / np.linalg.norm(np.cross(normal, e))]))
        values = np.linalg.eigvalsh(frames[0] @ revolved_operator(here, K) @ frames[0].T - frames[1] @ M @ frames[1].T)
        changes.append(np.take_along_axis(values, np.argsort(-np.abs(values), axis=1), axis=1))
    return np.array(changes)


@pytest.mark.parametrize("K", [0.02, -0.02], ids=["dome", "saddle"])
def test_stress_is_that_of_an_independent_evaluation_and_not_below(K):
    problem = patch(24, K)
    report = moulds(problem, panels(problem, count=4))
    ratios = []
    for fit in report.panels:
        changes = independent(fit, report.moulds[0], K)
        stress = 1e-6 * plate_stress(report.material, 6e-3, changes)
        ratios.append(fit.stresses / stress.mean(axis=1))
        assert fit.stress == pytest.approx(stress.max(), rel=0.05) and fit.stress >= 0.9995 * stress.max()
    ratios = np.concatenate(ratios)
    assert np.median(ratios) == pytest.approx(1.0, abs=0.01) and 0.993 < ratios.min() and ratios.max() < 1.02


@pytest.mark.parametrize("K", [0.02, -0.02], ids=["dome", "saddle"])
def test_stress_converges_under_refinement(K):
    reports = []
    for n in (12, 24):
        problem = patch(n, K)
        reports.append(moulds(problem, panels(problem, count=4)))
    coarse, fine = (np.array([max(fit.stress for fit in own.panels), own.stress_95]) for own in reports)
    assert coarse == pytest.approx(fine, rel=0.05)
    assert f"bending stress on 95 % of the area of all panels together: at most {reports[1].stress_95:.2g} MPa" in str(reports[1])


@pytest.mark.nightly
@pytest.mark.parametrize("K", [0.01, -0.01], ids=["dome", "saddle"])
def test_stress_of_panels_is_not_below_that_by_operators_of_a_finer_mesh(K, monkeypatch):
    points, faces = grid(96, 15.0)
    fine = solve(CGCProblem(points, faces).with_supports("corners").with_targets(K)).problem
    coarse, own = grid(24, 15.0)
    at = cKDTree(points).query(coarse)[1]
    roof = CGCProblem(fine.vertices[at], own).with_supports("corners").with_targets(K)
    found = moulds(roof, panels(roof, 1.25), rough=True).panels
    operators = shape_operators(fine.vertices, fine.faces).operators[at][own]
    monkeypatch.setattr(moulding, "corner_operators", lambda problem: operators)
    monkeypatch.setattr(moulding, "fitted_operators", lambda problem, otherwise: otherwise)
    finer = moulds(roof, panels(roof, 1.25), rough=True).panels
    ratios = np.array([one.stress / other.stress for one, other in zip(found, finer) if not one.singular])
    assert len(ratios) > 100 and ratios.min() > 0.96 and np.median(ratios) < 1.02


@pytest.mark.nightly
@pytest.mark.parametrize("K", [0.01, -0.01], ids=["dome", "saddle"])
def test_stress_on_most_of_a_solved_roof_converges_under_refinement(K):
    coarse, fine = (
        moulds(roof, panels(roof, 1.25)).stress_95
        for roof in (solve(CGCProblem(*grid(n, 15.0)).with_supports("corners").with_targets(K)) for n in (24, 48))
    )
    assert coarse == pytest.approx(fine, rel=0.1)


@pytest.mark.nightly
def test_stress_beside_a_held_wall_is_stated_apart_from_that_of_other_panels():
    found = []
    for edge in (0.5, 0.25):
        mesh = CGCMesh.from_outline([[0, 0], [12, 0], [12, 6], [0, 6]], edge, creases=[[[6, 0, 0], [6, 6, 0]]])
        problem = mesh.to_problem()
        wall = np.flatnonzero(np.abs(problem.vertices[:, 1]) < 1e-9).tolist()
        roof = solve(problem.with_supports(wall).with_targets(0.005)).problem
        report = moulds(roof, panels(roof, 1.5), rough=True)
        stresses = [_percentile_95(own) for own in (report.panels, [own for own in report.panels if not own.singular])]
        said = re.search(r"on 95 % of the area of all panels together: at most (\S+) MPa, (\S+) MPa without the panels", str(report))
        assert [float(said[1]), float(said[2])] == pytest.approx(stresses, rel=0.05)
        found.append(stresses)
    (coarse, others), (fine, still) = found
    assert fine > 1.2 * coarse and still == pytest.approx(others, rel=0.07) and others < 0.8 * coarse


def test_panels_are_rotated_on_a_pseudosphere_to_the_least_bending_whatever_angles_are_compared(monkeypatch):
    problem = CGCProblem(*revolved_patch(12, -0.02)).with_supports("boundary").with_targets(-0.02)
    divided = panels(problem, count=9)
    refined = moulds(problem, divided).panels
    monkeypatch.setattr(moulding, "ROTATIONS", 23)
    others = moulds(problem, divided).panels
    monkeypatch.setattr(moulding, "ROTATIONS", 719)
    monkeypatch.setattr(moulding, "ANGLE_TOLERANCE", 1e-5)
    for one, other, dense in zip(refined, others, moulds(problem, divided).panels):
        assert one.stress == pytest.approx(dense.stress, rel=0.01) and other.stress == pytest.approx(dense.stress, rel=0.01)


def test_both_changes_of_curvature_count_with_their_signs():
    glass = MATERIALS["glass"]
    bowl, saddle, roll = plate_stress(glass, 0.006, np.array([[0.1, 0.1], [0.1, -0.1], [0.1, 0.0]]))
    assert bowl == pytest.approx(1.23 * roll) and saddle == pytest.approx(0.77 * roll)


def test_steel_yields_by_the_stress_of_von_mises():
    """Bent to a saddle a plate is in pure shear, which yields at 1 / sqrt(3) of the strength."""
    steel = MATERIALS["steel"]
    bowl, saddle, roll = plate_stress(steel, 0.006, np.array([[0.1, 0.1], [0.1, -0.1], [0.1, 0.0]]))
    assert bowl == pytest.approx(1.3 * roll) and saddle == pytest.approx(3**0.5 * 0.7 * roll)


@pytest.mark.skipif(shutil.which("ccx") is None, reason="CalculiX is not installed")
@pytest.mark.parametrize("name", ["glass", "steel"])
@pytest.mark.parametrize(("K", "waist"), [(-0.02, 5.0), (0.02, 4.0), (0.02, 0.02**-0.5), (0.02, 9.0)])
def test_finite_elements_find_the_stress_of_bent_plates_and_not_more(K, waist, name, tmp_path):
    """Where K > 0 the changes have opposite signs, so that the von Mises stress of steel is the larger one."""
    own, here, there = MATERIALS[name], Revolved(K, waist), Revolved(K, 0.9999 * waist)
    at, tensors = bending_stresses(tmp_path, here, there, own.modulus, own.poisson, 0.006)
    found = np.abs(np.linalg.eigvalsh(tensors)).max(axis=1)
    if own.ductile:
        deviators = tensors - np.trace(tensors, axis1=1, axis2=2)[:, None, None] / 3.0 * np.eye(3)
        found = np.maximum(found, np.sqrt(1.5 * (deviators**2).sum(axis=(1, 2))))
    ratios = plate_stress(own, 0.006, (there.curvatures(at) - here.curvatures(at)).T) / found
    assert 1.0 <= ratios.min() and ratios.max() < 1.02


def test_point_supports_corners_and_straight_edges_of_domes_are_named():
    vertices, faces = grid(6, 6.0)
    dome = CGCProblem(vertices, faces).with_supports("boundary").with_targets(0.01)
    rim = (np.abs(vertices[:, :2] - 3.0) == 3.0).any(axis=1)
    assert (mesh_dependent(dome) == rim).all()
    corners = (np.abs(vertices[:, :2] - 3.0) == 3.0).all(axis=1)
    assert (mesh_dependent(dome.with_targets(-0.01)) == corners).all()
    point = CGCProblem(vertices, faces).with_supports([0, 24]).with_targets(-0.01)
    assert np.flatnonzero(mesh_dependent(point)).tolist() == [0, 24]
    # Each with its cause alone.
    by_cause = {cause: where for cause, where in unbounded_curvature(dome).items() if where.any()}
    assert set(by_cause) == {"a corner of a held edge", "a straight held edge (K > 0)"}
    assert (by_cause["a corner of a held edge"] == corners).all() and (by_cause["a straight held edge (K > 0)"] == rim & ~corners).all()
    assert [cause for cause, where in unbounded_curvature(point).items() if where.any()] == ["a point support"]


def creased(n, paths):
    """Return a solved roof on four corners with K = .01 and .005 across creases along paths of points in a grid of n by n."""
    mesh = CGCMesh.from_meshgrid(dx=12.0, nx=n)
    mesh.set_supports("corners")
    mesh.set_creases([[(n + 1) * x + y for x, y in path] for path in paths])
    for region in range(2):
        mesh.set_target((0.01, 0.005)[region], region=region)
    for region in range(2, 1 + max(mesh.to_problem().regions())):
        mesh.set_target(0.01, region=region)
    return solve(mesh, method="bending").to_problem()


def straight(n):
    return [[(n // 2, y) for y in range(n + 1)]]


def crossed(n):
    return [*straight(n), [(x, n // 2) for x in range(n + 1)]]


def kinked(n):
    return [[(n // 2, y) for y in range(n // 2 + 1)] + [(x, n // 2) for x in range(n // 2 + 1, n + 1)]]


@pytest.mark.parametrize("paths", [straight, crossed, kinked])
def test_curvature_grows_with_the_mesh_at_ends_crossings_and_kinks_of_creases_and_nowhere_else_on_them(paths):
    named, others = [], []
    for n in (12, 24, 48):
        problem = creased(n, paths(n))
        V, F = problem.vertices, problem.faces
        dependent = mesh_dependent(problem)
        on_creases = np.unique(problem.creases)
        at = on_creases[dependent[on_creases]]
        assert len(at) == {straight: 2, crossed: 5, kinked: 3}[paths]
        curvature = np.abs(np.linalg.eigvalsh(corner_operators(problem))).max(axis=2)
        far = np.linalg.norm(V[:, None] - V[at], axis=2).min(axis=1) > 2.0
        named.append([curvature[np.isin(F, own)].max() for own in at])
        others.append(curvature[np.isin(F, on_creases[far[on_creases]])].max())
    # Halving edges adds as much to the curvature again and again where it is unbounded.
    steps = np.diff(np.max(named, axis=1)), np.diff(others)
    assert (steps[0] > 0.03 * np.max(named[0])).all() and steps[0][1] > 0.8 * steps[0][0]
    assert abs(steps[1][1]) < 0.015 * others[0]
