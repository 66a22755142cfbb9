"""Laws as values: derivatives, type, admissible range, texts, similarity, and how problems, meshes and files carry them."""

from __future__ import annotations

import numpy as np
import pytest

from compas_cgc import CGCMesh
from compas_cgc import CGCProblem
from compas_cgc import ConstantCurvature
from compas_cgc import ConstantMeanCurvature
from compas_cgc import LinearWeingarten
from compas_cgc import Minimal
from compas_cgc import check
from compas_cgc import write
from compas_cgc.model.laws import Piecewise
from compas_cgc.model.laws import as_law

LAWS = [ConstantCurvature(-0.3), ConstantMeanCurvature(0.2), Minimal(), LinearWeingarten(0.5, 2.0, 0.7), LinearWeingarten(-0.5, 1.1, -1.0)]


def _two_regions() -> CGCMesh:
    mesh = CGCMesh.from_meshgrid(dx=8, nx=8)
    mesh.set_supports("boundary")
    mesh.set_creases([[9 * 4 + k for k in range(9)]])
    mesh.set_target(0.01)
    return mesh


@pytest.mark.parametrize("law", LAWS, ids=str)
def test_first_derivatives_are_those_of_the_residual(law):
    rng = np.random.default_rng(0)
    H, K, h = rng.standard_normal(5), rng.standard_normal(5), 1e-6
    by_H, by_K = law.first_derivatives(H, K)
    assert (law.residual(H + h, K) - law.residual(H - h, K)) / (2 * h) == pytest.approx(by_H + 0 * H, abs=1e-8)
    assert (law.residual(H, K + h) - law.residual(H, K - h)) / (2 * h) == pytest.approx(by_K + 0 * K, abs=1e-8)


@pytest.mark.parametrize("law", LAWS, ids=str)
def test_shapes_for_initial_guesses_obey_the_law(law):
    shape = law.shape()
    for first, second in (
        (shape.mean + shape.round + shape.saddle, shape.mean + shape.round - shape.saddle),
        (shape.mean - shape.round + shape.saddle, shape.mean - shape.round - shape.saddle),
    ):
        H, K = np.array([(first + second) / 2]), np.array([first * second])
        assert law.residual(H, K) == pytest.approx(0.0, abs=1e-12)
        assert any(low - 1e-12 <= H[0] <= high + 1e-12 for low, high in law.admissible)


@pytest.mark.parametrize("law", LAWS, ids=str)
def test_a_scaled_surface_obeys_the_scaled_law(law):
    H, K = np.array([0.3, -0.2]), np.array([0.05, -0.4])
    before, after = law.residual(H, K), law.scaled(10.0).residual(H / 10, K / 100)
    # Residuals may change their unit, but not their ratio.
    assert after[0] * before[1] == pytest.approx(before[0] * after[1], rel=1e-12)
    assert law.normalised().residual(H, K)[0] * before[1] == pytest.approx(before[0] * law.normalised().residual(H, K)[1])


def test_types():
    assert [law.type for law in LAWS] == ["hyperbolic", "elliptic", "elliptic", "elliptic", "hyperbolic"]
    assert ConstantCurvature(0.0).type == "parabolic"
    assert ConstantCurvature(4.0).admissible == ((-np.inf, -2.0), (2.0, np.inf))


@pytest.mark.parametrize("law", LAWS, ids=str)
def test_texts_lead_back_to_the_law(law):
    assert as_law(str(law)) == law


@pytest.mark.parametrize(
    "text, law",
    [
        ("minimal", Minimal()),
        ("H=0.1", ConstantMeanCurvature(0.1)),
        (" 2*H = 0.4 ", ConstantMeanCurvature(0.2)),
        ("K = -1e-2", ConstantCurvature(-0.01)),
        ("-K + 2 H = .3", LinearWeingarten(2, -1, 0.3)),
        ("H", Minimal()),
        (0.2, ConstantCurvature(0.2)),
    ],
)
def test_texts(text, law):
    assert as_law(text) == law


@pytest.mark.parametrize("text", ["", "x = 1", "H = ", "H K = 2", "0 H = 1", "H = nan", "2 = H", "H = 1 = 2", "HK = 1"])
def test_texts_that_are_no_law_get_a_sentence(text):
    with pytest.raises(ValueError, match="is not a law; write"):
        as_law(text)


def test_each_point_has_its_own_law():
    of = np.array([1, 0, 1, 2])
    law, H, K = Piecewise(LAWS[:3], of), np.array([1.0, 2, 3, 4]), np.array([5.0, 6, 7, 8])
    assert law.residual(H, K) == pytest.approx([0.8, 6.3, 2.8, 4.0])
    assert law.first_derivatives(H, K)[0].tolist() == [1, 0, 1, 1]
    assert law.first_derivatives(H, K)[1].tolist() == [0, 1, 0, 0]
    assert law.second_derivatives(H, K) is None
    assert [error for _, error in law.largest(H, K)] == pytest.approx([6.3, 2.8, 4.0])


def test_a_problem_carries_laws_and_targets_by_region():
    problem = _two_regions().to_problem().with_laws({1: "H = 0.05"})
    assert problem.region_laws() == [ConstantCurvature(0.01), ConstantMeanCurvature(0.05)]
    within = problem.region_vertices(1)
    assert not problem.asked[within].any() and np.isnan(problem.targets[within]).all()
    assert problem.with_targets(0.02, region=1).laws == {}
    assert problem.with_laws({1: ConstantCurvature(0.02)}).region_targets() == [0.01, 0.02]
    assert problem.transformed(np.diag([10, 10, 10, 1])).laws == {1: ConstantMeanCurvature(0.005)}
    with pytest.raises(ValueError, match="there is no region 2"):
        problem.with_laws({2: "minimal"})


def test_a_mesh_keeps_its_laws_through_its_operations(tmp_path):
    mesh = _two_regions()
    mesh.set_law("2 H + 0.5 K = 0.3", region=1)
    laws = [ConstantCurvature(0.01), LinearWeingarten(2, 0.5, 0.3)]
    mesh.to_json(tmp_path / "roof.json")
    other = _two_regions()
    other.translate([100, 0, 0])
    joined = mesh.copy()
    joined.join(other)
    for same in (
        CGCMesh.from_json(tmp_path / "roof.json"),
        mesh.copy(),
        CGCMesh.from_mesh(mesh),
        mesh.subdivided("corner"),
        CGCMesh.from_problem(mesh.to_problem()),
    ):
        assert [same.region_law(region) for region in (0, 1)] == laws
    assert [joined.region_law(region) for region in range(4)] == [*laws, laws[0], laws[0]]
    assert mesh.region_target(1) is None
    mesh.scale(10)
    assert mesh.region_law(1) == LinearWeingarten(20.0, 50.0, 0.3)
    mesh.set_target(0.02, region=1)
    assert mesh.region_law(1) == ConstantCurvature(0.02)


def test_laws_follow_their_faces_when_creases_change():
    problem = _two_regions().to_problem().with_laws({1: "minimal"})
    more = problem.with_creases([[4 + 9 * i for i in range(9)]], add=True)
    assert [str(law) for law in more.region_laws()] == ["K = 0.01", "K = 0.01", "H = 0", "H = 0"]
    assert problem.with_creases([]).laws == {}


def test_formats_without_laws_say_so(tmp_path):
    mesh = _two_regions()
    mesh.set_law("minimal", region=1)
    assert write(tmp_path / "roof.json", mesh) == []
    assert "laws of regions 1 are not in roof.obj" in write(tmp_path / "roof.obj", mesh)[0]


def test_a_hyperbolic_law_is_refused_where_the_whole_boundary_is_held():
    mesh = _two_regions()
    mesh.set_creases([])
    mesh.set_law(LinearWeingarten(0.1, 1.0, -0.01))
    assert any("hyperbolic" in text and text.fatal for text in check(mesh))
    mesh.set_supports([key for key in mesh.supports() if mesh.vertex_coordinates(key)[0] < 1.0])
    assert not any(text.fatal for text in check(mesh))


def test_more_pressure_than_a_plane_boundary_carries_is_refused():
    mesh = CGCMesh.from_meshgrid(dx=8, nx=8)
    mesh.set_supports("boundary")
    mesh.set_law("H = 0.26")
    assert any("|H| is at most 0.25" in text for text in check(mesh))
    mesh.set_law("H = 0.2")
    assert check(mesh) == []


def test_goals_beside_laws_need_an_unknown_constant_or_free_edges():
    problem = _two_regions().to_problem().with_laws({1: "H = 0.01"}).with_goals([{"kind": "rise", "rise": 1.0}])
    assert isinstance(problem, CGCProblem)
    held = problem.with_supports("boundary")
    assert any("with an unknown constant" in text for text in check(held))
    assert not any(text.fatal for text in check(held.with_goals([{"kind": "unknown", "regions": [1]}])))
    assert not any(text.fatal for text in check(problem.with_supports("corners")))


def test_a_file_carries_laws_as_text_dots(tmp_path):
    pytest.importorskip("rhino3dm")
    mesh = _two_regions()
    mesh.set_law("2 H + 0.5 K = 0.3", region=1)
    mesh.to_3dm(tmp_path / "roof.3dm")
    back = CGCMesh.from_3dm(tmp_path / "roof.3dm")
    assert [back.region_law(region) for region in (0, 1)] == [ConstantCurvature(0.01), LinearWeingarten(2, 0.5, 0.3)]
