"""CGCMesh.from_3dm and to_3dm."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import compas_cgc
from compas_cgc import CGCMesh
from compas_cgc import CGCProblem
from compas_cgc import Fixed
from compas_cgc import Height
from compas_cgc import Mirror
from compas_cgc import OnCurve
from compas_cgc import OnLine
from compas_cgc import OnPlane
from compas_cgc import Proximity
from compas_cgc.io import read_problem
from compas_cgc.model.constraint_data import constraint_data


def test_a_mesh_comes_back_from_a_rhino_file_bit_for_bit(tmp_path):
    mesh = CGCMesh.from_3dm(Path(__file__).parents[2] / "examples" / "nine_regions.3dm")
    mesh.set_target(0.01)
    mesh.set_target(0.04, region=4)
    mesh.vertex_attribute(17, "z", 1 / 3)
    for version in (7, 8):
        mesh.to_3dm(tmp_path / "roof.3dm", version=version)
        back = CGCMesh.from_3dm(tmp_path / "roof.3dm")
        assert all(np.array_equal(a, b) for a, b in zip(back.arrays(), mesh.arrays()))
        assert back.supports() == mesh.supports() and back.creases() == mesh.creases()
        assert [back.region_target(r) for r in range(9)] == [mesh.region_target(r) for r in range(9)]
        assert back.attributes["units"] == "Meters"


def hanging(n=8, height=0.5):
    """Return a mesh on four corners whose middle shall come to a height."""
    mesh = CGCMesh.from_meshgrid(dx=n, nx=n)
    mesh.set_supports("corners")
    mesh.set_target(0.01)
    mesh.set_goals([Height([(n + 1) ** 2 // 2], height)])
    return mesh


@pytest.mark.nightly
def test_what_is_drawn_besides_the_curvature_is_held_by_every_way_in(tmp_path):
    path = tmp_path / "roof.3dm"
    hanging().to_3dm(path)
    top = (8 + 1) ** 2 // 2
    for given in (CGCMesh.from_3dm(path), compas_cgc.read(path), read_problem(path).checked()):
        result = compas_cgc.solve(given)
        assert result.converged and result.vertices[top, 2] == pytest.approx(0.5, abs=1e-9)
    with pytest.raises(ValueError, match="supports constraints"):
        compas_cgc.solve(CGCMesh.from_3dm(path), method="newton")


EVERY_KIND = [
    Height([40], 0.5),
    Height([10, 12], 0.75),
    Fixed([4, 5]),
    OnCurve([0, 1, 2], [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [2.0, 0.0, 0.0]]),
    OnCurve([20], [[9.0, 0.0, 1.0], [9.0, 9.0, 1.0], [0.0, 9.0, 1.0]], closed=True),
    OnPlane([3], [0.0, 0.0, 1 / 3], [0.0, 1.0, 1.0]),
    OnLine([7], [1.0, 2.0, 3.0], [0.0, 0.0, 1.0]),
    Proximity([8], 3.0),
    Mirror([4.0, 0.0, 0.0], [1.0, 0.0, 0.0]),
]


def sorted_data(constraints):
    """Return constraints as plain data in an order of their own, as sets have none."""
    data = map(constraint_data, constraints)
    return sorted(({**own, "vertices": sorted(own.get("vertices", []))} for own in data), key=str)


@pytest.mark.parametrize("change", ["nothing", "dummies", "renumbered"])
def test_constraints_of_every_kind_come_back_as_they_were(tmp_path, change):
    mesh = hanging()
    expected = EVERY_KIND
    if change == "dummies":
        mesh.add_dummy_ring()
    mesh.set_goals(EVERY_KIND)
    if change == "renumbered":
        problem = mesh.to_problem()
        n = len(problem.vertices)
        order = np.roll(np.arange(n), 5)  # where each vertex goes
        vertices, roles, targets = np.empty_like(problem.vertices), np.empty_like(problem.roles), np.empty_like(problem.targets)
        vertices[order], roles[order], targets[order] = problem.vertices, problem.roles, problem.targets
        expected = [constraint.renumbered(order) for constraint in EVERY_KIND]
        moved = CGCProblem(vertices, order[problem.faces], roles, targets, goals=expected)
        mesh = CGCMesh.from_problem(moved)
    for k in range(2):
        mesh.to_3dm(tmp_path / f"{k}.3dm")
        mesh = CGCMesh.from_3dm(tmp_path / f"{k}.3dm")
        assert sorted_data(mesh.goals()) == sorted_data(expected)


def test_rhino_files_are_read_where_compas_does_not_find_the_plugins(tmp_path, monkeypatch):
    monkeypatch.setattr("compas.plugins.plugin_manager._registry", {})
    monkeypatch.setattr("compas.plugins.plugin_manager._discovery_done", True)
    hanging().to_3dm(tmp_path / "roof.3dm")
    assert CGCMesh.from_3dm(tmp_path / "roof.3dm").number_of_vertices() == 81
