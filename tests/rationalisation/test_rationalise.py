"""From designs to moulds: distances, moulds, promises, on small designs."""

from __future__ import annotations

import re
from dataclasses import replace
from functools import cache

import numpy as np
import pytest

import compas_cgc
from compas_cgc.cli import main
from compas_cgc.discrete.measured_curvature import measured_curvature
from compas_cgc.discrete.space_form import space_form_angle_sums
from compas_cgc.errors import CGCError
from compas_cgc.errors import MeshError
from compas_cgc.meshing import named_supports
from compas_cgc.meshing.regions import inner_labels
from compas_cgc.model.problem import Drawing
from compas_cgc.model.verdict import verdict
from compas_cgc.rationalisation import Rationalised
from compas_cgc.rationalisation import design as design_module
from compas_cgc.rationalisation import run as run_module
from compas_cgc.rationalisation import seams as seams_module
from compas_cgc.rationalisation.assignment import evened
from compas_cgc.rationalisation.assignment import finished
from compas_cgc.rationalisation.design import read_design
from compas_cgc.rationalisation.normal_moves import FOLD_LENGTH
from compas_cgc.rationalisation.normal_moves import NormalMoves
from compas_cgc.rationalisation.seams import panels_of
from compas_cgc.rationalisation.smooth_moves import smoothed
from compas_cgc.rationalisation.symmetry import symmetric_panels

from ..support.freeform import bumpy
from ..support.freeform import mesh_over
from ..support.freeform import quarter_torus


def heights(x, y):
    return 2.5 - 0.02 * (x - 6.0) ** 2 - 0.03 * (y - 4.0) ** 2 + 0.5 * np.exp(-((x - 8.0) ** 2 + (y - 5.0) ** 2) / 8.0)


DESIGN = mesh_over(heights, 12.0, 8.0, 0.25)


@cache
def found(moulds: int = 3) -> Rationalised:
    return compas_cgc.rationalise(DESIGN, panel=2.0, edges=4, moulds=moulds)


def test_every_panel_has_the_curvature_of_its_mould_in_the_exact_measure():
    own = found()
    inside = inner_labels(len(own.result.vertices), own.result.problem.faces, own.panels)
    rows = np.flatnonzero(inside >= 0)
    K = own.curvatures[own.classes[inside[rows]]]
    each = np.zeros(len(inside))
    each[rows] = K
    sums = space_form_angle_sums(own.result.vertices, own.result.problem.faces, each)[rows]
    assert len(own.curvatures) == 3 and own.result.status == "converged"
    assert np.abs(2 * np.pi - sums).max() < 1e-11
    assert own.panels_per_class.sum() == 24 and (own.panels_per_class > 0).all()


def test_where_no_surface_is_found_the_result_tells_how_much_the_design_bends(monkeypatch):
    """The design bends by 0.19 /m at most, 21 degrees across 2 m."""
    failed = replace(found(1).result, status="infeasible")
    monkeypatch.setattr(run_module, "_solved", lambda *given: failed)
    own = compas_cgc.rationalise(DESIGN, panel=2.0, edges=4, moulds=1)
    assert not own.kept and own.suggestion in own.summary and "narrower than 2" in own.suggestion
    (angle,) = re.findall(r"bends by (\d+) degrees across a panel", own.suggestion)
    assert 12 <= int(angle) <= 21


def test_more_moulds_are_nearer_and_flat_sheets_farther():
    distances = [found(moulds).distance.largest for moulds in (1, 3, 6)]
    assert distances[0] > 2.0 * distances[1] > 2.0 * distances[2], distances
    assert found(1).curvatures.tolist() == [0.0]
    assert found(1).summary.startswith("24 panels on 1 mould: flat (24 panels)")


def test_with_a_mould_for_every_panel_the_surface_is_nearer_than_with_few():
    own = compas_cgc.rationalise(DESIGN, panel=4.0, edges=6, moulds=9, flat=False)
    few = compas_cgc.rationalise(DESIGN, panel=4.0, edges=6, moulds=2)
    assert len(own.curvatures) >= 5 and own.panelling.panel_count == 6
    assert own.distance.largest < few.distance.largest


def clustered(moves: NormalMoves, number: int):
    """Return the surface whose panels have the K of clusters of the design's."""
    from compas_cgc.rationalisation.assignment import Moulds
    from compas_cgc.rationalisation.assignment import _given
    from compas_cgc.rationalisation.assignment import _placed

    nothing = np.zeros(len(moves.columns))
    return _placed(moves, _given(moves, Moulds(number, flat=True), moves.mean_curvatures(nothing))[0], nothing)


def test_large_distances_are_evened_out():
    """Steps reduce the largest distance and fold by far, by the same norm that accepts them."""
    from compas_cgc.rationalisation.assignment import LAST_POWERS

    panelling = panels_of(read_design(DESIGN), 4.0, 6)
    moves = NormalMoves(panelling, np.zeros(len(panelling.vertices), bool))
    before = clustered(moves, 3)
    after = evened(moves, before, LAST_POWERS)
    assert after.norm < 0.75 * before.norm
    largest = [np.abs(moves.criteria(placed.moves)).max() for placed in (before, after)]
    assert largest[1] < 0.75 * largest[0]
    assert moves.error(after.moves, after.assigned.K) < 0.05


def test_smoothed_surfaces_have_the_curvature_of_their_moulds_up_to_the_seams():
    """Exact equations alone leave the strips of the mesh beside seams free, where curvature is off by ten times that of the moulds."""
    design = read_design(DESIGN)
    panelling = panels_of(design, 4.0, 12)
    corners = np.zeros(len(panelling.vertices), bool)
    corners[named_supports(panelling.vertices, panelling.faces, "corners")] = True
    moves = NormalMoves(panelling, corners)
    before = finished(moves, evened(moves, clustered(moves, 3)))
    K = before.assigned.K
    problem = run_module._problem(design, panelling, moves, corners, K)
    after = smoothed(moves, before, problem)
    assert moves.error(after.moves, K) < 1e-11 and after.distance < before.distance

    def off(placed):
        shape, regions = moves.shape(placed.moves), panelling.panels
        read = measured_curvature(shape, problem.faces, problem.creases, regions)
        on_seams = np.isin(read.pairs[:, 0], problem.creases)
        return float(np.sqrt(np.mean((read.gaussian - K[read.pairs[:, 1]])[on_seams] ** 2)))

    assert off(after) < 0.1 * off(before)
    fair = [verdict(problem.with_vertices(moves.shape(placed.moves))).fair for placed in (before, after)]
    assert fair == [False, True]


def test_the_assignment_is_nearer_than_clusters_of_the_curvature():
    panelling = panels_of(read_design(DESIGN), 2.0, 4)
    moves = NormalMoves(panelling, np.zeros(len(panelling.vertices), bool))
    assert found().distance.largest < 0.8 * clustered(moves, 3).distance


def test_nearly_flat_hollows_get_a_mould_beside_a_hill():
    """Clusters of K alone divide the hill and leave hollows with a third of its K flat, 42 mm away; those of its root do not."""
    design = read_design(mesh_over(bumpy("soft", 104), edge=1.0), tolerance=0.01)
    own = compas_cgc.rationalise(design, panel=2.5, edges=2, moulds=4)
    assert own.panelling.panel_count == 160 and own.curvatures[0] < -3e-4 and own.distance.largest < 0.03


def test_a_flat_mould_leaves_one_for_hollows_and_one_for_hills():
    """Clusters with one value at 0 have two positive ones and are 48 mm away."""
    own = compas_cgc.rationalise(read_design(mesh_over(bumpy("soft", 705))), panel=2.5, moulds=3, flat=True)
    assert np.sign(own.curvatures).tolist() == [-1.0, 0.0, 1.0] and own.distance.largest < 0.035


def test_the_distance_is_that_from_the_true_surface_by_another_search():
    own = found()
    x, y = np.meshgrid(np.linspace(0, 12, 2401), np.linspace(0, 8, 1601), indexing="ij")
    from scipy.spatial import cKDTree

    tree = cKDTree(np.column_stack([x.ravel(), y.ravel(), heights(x, y).ravel()]))
    nearest = tree.query(own.result.vertices)[0]
    # The mesh of points is 5 mm wide, its sheet within a millimetre.
    assert np.all(np.abs(own.distance.signed) >= nearest - 4e-3)
    assert abs(nearest.max() - own.distance.largest) < 1e-3
    moved = own.panelling.vertices + np.array([0.02, 0.0, 0.0])
    from compas_cgc.rationalisation.distance import distance_from

    slid = distance_from(own.design.surface, own.panelling, moved).signed
    on_rim = own.panelling.held[:, 0] & (own.panelling.vertices[:, 0] < 6.0)
    assert np.abs(slid[on_rim]).min() > 0.015, "a rim that slides inwards along the design is away from it"


def test_moves_by_the_linear_model_are_those_of_the_solve():
    panelling = panels_of(read_design(DESIGN), 2.0, 4)
    moves = NormalMoves(panelling, np.zeros(len(panelling.vertices), bool))
    nothing = np.zeros(len(moves.columns))
    K = moves.mean_curvatures(nothing)
    for _ in range(6):
        nothing = moves.newton(nothing, K, 1)
    base, change = nothing, np.zeros(moves.panels)
    change[[5, 12]] = 1e-5, -1e-5
    predicted = moves.sensitivities(base, K).linear().by_panel @ change
    solved = base
    for _ in range(6):
        solved = moves.newton(solved, K + change, 1)
    assert moves.error(base, K) < 1e-9 and moves.error(solved, K + change) < 1e-9
    assert np.abs(solved - base - predicted).max() < 0.02 * np.abs(predicted).max()


def test_adjoint_sensitivities_are_the_transpose_of_the_columns():
    panelling = panels_of(read_design(DESIGN), 2.0, 4)
    moves = NormalMoves(panelling, np.zeros(len(panelling.vertices), bool))
    nothing = np.zeros(len(moves.columns))
    own = moves.sensitivities(nothing, moves.mean_curvatures(nothing))
    weights = np.random.default_rng(0).normal(size=(len(moves.criteria_mass), 2))
    columns = moves.criteria(own.linear().by_panel)
    expected = columns.T @ weights
    found_by_adjoint = own.adjoint(moves.criteria_transposed(weights))
    assert np.abs(found_by_adjoint - expected).max() < 1e-7 * np.abs(expected).max()


def test_fold_criteria_are_the_changes_of_the_angles_at_seams():
    from compas_cgc.rationalisation.distance import folds_at_seams

    panelling = panels_of(read_design(DESIGN), 2.0, 4)
    moves = NormalMoves(panelling, np.zeros(len(panelling.vertices), bool))
    move = 1e-6 * np.random.default_rng(0).normal(size=len(moves.columns))
    folds = folds_at_seams(panelling, moves.shape(move))
    width = FOLD_LENGTH * moves.size / np.sqrt(moves.panels)
    changes = np.abs(moves.criteria(move)[len(move) :]) / width
    clear = folds.design > 0.1
    assert clear.sum() > 50
    assert np.abs(changes - np.abs(np.radians(folds.change())))[clear].max() < 0.01 * changes.max()


def test_panels_that_promise_little_stay_on_their_moulds(monkeypatch):
    from compas_cgc.rationalisation import assignment

    monkeypatch.setattr(assignment, "ACTIVE", 8)
    few = compas_cgc.rationalise(DESIGN, panel=2.0, edges=4, moulds=3)
    assert few.result.converged and few.distance.largest < 1.5 * found().distance.largest


def test_a_search_judges_nearly_flat_designs_on_surfaces_that_have_their_curvature():
    """A facade whose K is a fifth of that of the roofs here, times its area."""
    shown = []
    facade = mesh_over(lambda x, y: 1.2 * np.sin(x / 4.0) * (0.4 + y / 16.0), 28.0, 12.0, 1.0)
    made = compas_cgc.rationalise(facade, moulds=2, callback=lambda progress: shown.append(progress.distance))
    assert made.result.converged and made.distance.largest == pytest.approx(shown[-1], rel=0.1)
    fewest = compas_cgc.rationalise(facade, moulds=None, within=1.2 * made.farthest)
    assert fewest.kept and len(fewest.curvatures) == 2


def test_a_promise_is_kept_or_refused_with_a_suggestion():
    kept = compas_cgc.rationalise(DESIGN, panel=2.0, edges=4, moulds=None, within=0.02)
    assert kept.status == "kept" and kept.distance.largest <= 0.02 and 1 < len(kept.curvatures) < 6
    broken = compas_cgc.rationalise(DESIGN, panel=2.0, edges=4, moulds=2, within=0.001)
    assert broken.status == "exceeded" and broken.distance.largest > 0.001
    assert "try" in broken.suggestion and "moulds" in broken.suggestion


def test_a_mesh_is_fitted_more_closely_than_the_distance_that_is_promised():
    mesh, options = mesh_over(bumpy("soft", 1), edge=1.0), {"panel": 5.0, "moulds": 4, "edges": 2}
    loose, drawn = read_design(mesh, tolerance=0.02), Drawing("roof", "Meters", 0.01)
    within = 5.0 * loose.deviation
    design = loose._replace(drawing=drawn, notes=("a note of the file", *loose.notes))
    found = compas_cgc.rationalise(design, within=within, **options).design
    assert loose.deviation > 0.1 * within >= found.deviation
    assert found.drawing == drawn and found.notes == ("a note of the file",)
    assert compas_cgc.rationalise(mesh, within=within, tolerance=0.02, **options).design.deviation == loose.deviation
    assert read_design(loose.surface).refitted(1e-9).deviation == 0.0
    # A limit of the tolerance that is known before costs no second fit, and gives the same surface.
    usual = read_design(mesh)
    limit = 0.5 * usual.deviation
    assert (
        read_design(mesh, finest=limit).deviation == usual.refitted(limit).deviation == read_design(usual, finest=limit).deviation <= limit
    )
    assert read_design(mesh, finest=1.0).deviation == usual.deviation


@pytest.mark.parametrize("reach", [0.02, 1e-6])
def test_a_mesh_is_fitted_once(reach, tmp_path, monkeypatch):
    """By every door that knows the distance, also where no surface is as near to the mesh."""
    mesh, tolerances = mesh_over(bumpy("soft", 1), 12.0, 8.0, 1.0), []
    fitted = design_module._fitted

    def counted(vertices, polygons, tolerance, limit=np.inf):
        tolerances.append(limit if tolerance is None else tolerance)
        return fitted(vertices, polygons, tolerance, limit)

    monkeypatch.setattr(design_module, "_fitted", counted)
    found = compas_cgc.rationalise(mesh, within=10.0 * reach, panel=4.0, edges=3, moulds=2)
    assert tolerances == [pytest.approx(reach)]
    assert compas_cgc.rationalise(found.design, within=10.0 * reach, panel=4.0, edges=3, moulds=2).design is found.design
    assert len(tolerances) == 1
    compas_cgc.write(tmp_path / "roof.obj", compas_cgc.CGCMesh.from_vertices_and_faces(*mesh))
    options = ["--panel", "4", "--edges", "3", "--moulds", "2", "--tolerance", "0.01", "--within", f"{10.0 * reach}", "-q"]
    main(["rationalise", str(tmp_path / "roof.obj"), "-o", str(tmp_path / "out.obj"), *options])
    assert tolerances[1:] == [0.01]


def test_what_the_fit_of_a_mesh_deviates_counts_in_a_promise():
    mesh, options = mesh_over(bumpy("soft", 1), edge=1.0), {"panel": 5.0, "moulds": 4, "edges": 2, "tolerance": 0.02}
    free = compas_cgc.rationalise(mesh, **options)
    assert 1e-3 < free.design.deviation <= 0.02
    missed, kept = (
        compas_cgc.rationalise(mesh, within=free.distance.largest + part * free.design.deviation, **options).status for part in (0.5, 1.01)
    )
    assert (missed, kept) == ("exceeded", "kept")
    close = compas_cgc.rationalise(mesh, within=0.5 * free.design.deviation, **options)
    assert close.status == "exceeded" and "try tolerance=" in close.suggestion


def test_existing_moulds_are_used_as_they_are_and_locked_panels_stay():
    own = compas_cgc.rationalise(DESIGN, panel=2.0, edges=4, moulds=[18.0, 40.0, float("inf")], locked={0: 2, 5: 0})
    assert set(own.curvatures) <= {0.0, 1 / 40.0**2, 1 / 18.0**2}
    assert own.curvatures[own.classes[0]] == 0.0
    assert own.curvatures[own.classes[5]] == 1 / 18.0**2


def test_a_cancelled_search_returns_the_best_so_far():
    states = []

    def stop(state):
        states.append(state)
        return len(states) == 2

    own = compas_cgc.rationalise(DESIGN, panel=2.0, edges=4, callback=stop)
    assert own.status == "cancelled" and own.cancelled and own.result.converged
    assert len(states) == 2


@pytest.mark.parametrize("turn", [0.0, 0.6, -0.5])
def test_the_same_design_gives_the_same_result_in_other_units_places_and_directions(turn):
    """The grid of panels follows the sides of the plan."""
    vertices, faces = DESIGN
    along = np.array([[np.cos(turn), np.sin(turn), 0.0], [-np.sin(turn), np.cos(turn), 0.0], [0.0, 0.0, 1.0]])
    other = compas_cgc.rationalise((1000.0 * vertices @ along + [5e5, -3e5, 2e4], faces), panel=2000.0, edges=4, moulds=3)
    assert other.classes.tolist() == found().classes.tolist()
    assert other.distance.largest == pytest.approx(1000.0 * found().distance.largest, rel=1e-4)


def test_a_closed_direction_is_joined():
    own = compas_cgc.rationalise(quarter_torus(), panel=1.6, edges=4, moulds=4)
    assert own.result.converged and own.distance.largest < 0.2
    from compas_cgc.meshing import boundary_loops

    assert len(boundary_loops(own.result.problem.faces)) == 2


def test_wrong_arguments_are_refused_with_a_remedy():
    for wrong, word in (({"panel": -1.0}, "panel"), ({"moulds": 0}, "moulds"), ({"within": 0.0}, "within"), ({"moulds": None}, "within")):
        with pytest.raises(CGCError, match=word):
            compas_cgc.rationalise(DESIGN, **{"panel": 4.0, **wrong})
    with pytest.raises(CGCError, match="design"):
        compas_cgc.rationalise(5)


def test_a_flat_design_is_kept_as_it_is():
    own = compas_cgc.rationalise(mesh_over(lambda x, y: 0.0 * x, 4.0, 4.0, 0.5), panel=2.0, edges=3, moulds=2)
    assert own.status == "kept" and own.distance.largest < 1e-9
    assert own.curvatures.tolist() == [0.0] and own.result.verdict.fair


def test_a_flat_design_does_not_slide_in_its_plane():
    vertices, quads = mesh_over(lambda x, y: 0.3 * x - 0.2 * y, 10.0, 10.0, 0.5)
    turn = np.array([[0.36, 0.48, -0.8], [-0.8, 0.6, 0.0], [0.48, 0.64, 0.6]])
    own = compas_cgc.rationalise((vertices @ turn.T / 3.0 + [7.0, -4.0, 1.0], quads), panel=1.2, edges=4, moulds=2)
    assert own.curvatures.tolist() == [0.0]
    assert np.linalg.norm(own.result.vertices - own.panelling.vertices, axis=1).max() < 1e-9


def test_a_design_without_area_is_refused():
    vertices, faces = mesh_over(bumpy("soft", 0), edge=5.0)
    with pytest.raises(CGCError, match="no area"):
        read_design((vertices * [0.0, 1.0, 0.0], faces))


@pytest.mark.nightly
def test_of_several_numbers_of_level_lines_the_fair_surface_nearest_to_the_design_is_taken(monkeypatch):
    shown = []
    design = read_design(mesh_over(bumpy("soft", 1), edge=1.0))
    best = compas_cgc.rationalise(design, seams="levels", moulds=4, callback=shown.append)
    alone = []
    for levels in seams_module.LEVELS:
        monkeypatch.setattr(run_module, "LEVELS", (levels,))
        alone.append(compas_cgc.rationalise(design, seams="levels", moulds=4))
    fair = [found for found in alone if found.result.verdict.fair]
    assert best.distance.largest == min(found.distance.largest for found in fair)
    assert len({found.panelling.panel_count for found in alone}) > 1
    done = [own.done / own.rounds for own in shown]
    assert done == sorted(done) and done[-1] <= 1.0


def test_panels_between_level_lines_are_not_locked():
    with pytest.raises(CGCError, match="cannot be locked; give the seams as curves"):
        compas_cgc.rationalise(DESIGN, seams="levels", moulds=[9.0], locked={0: 0})


@pytest.mark.parametrize("faces", [[], [[0, 0, 1]]])
def test_a_design_without_faces_is_refused_in_a_sentence(faces):
    with pytest.raises(MeshError, match="the design has no faces; give a surface"):
        read_design(([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]], faces))


def test_panels_of_a_symmetric_design_have_symmetric_moulds():
    def heights(x, y):
        hollows = sum(np.exp(-((x - a) ** 2 + (y - 4.0) ** 2) / 3.0) for a in (2.0, 10.0))
        return 1.5 - 0.02 * (x - 6.0) ** 2 - 0.03 * (y - 4.0) ** 2 - 0.2 * hollows

    found = compas_cgc.rationalise(mesh_over(heights, 12.0, 8.0, 0.5), panel=2.0, edges=4, moulds=3)
    classes = found.classes.reshape(6, 4)
    assert len(found.curvatures) == 3
    assert np.array_equal(classes, classes[::-1]) and np.array_equal(classes, classes[:, ::-1])


def test_groups_of_panels_follow_the_mirrors_of_the_design_and_its_supports():
    def groups(heights, held=(0.0, 0.0)):
        panelling = panels_of(read_design(mesh_over(heights, 12.0, 8.0, 0.5)), 2.0, 4)
        fixed = np.linalg.norm(panelling.vertices[:, :2] - held, axis=1) < 1e-6
        return len(np.unique(symmetric_panels(panelling, fixed)))

    assert groups(lambda x, y: 1.0 - 0.02 * (x - 6.0) ** 2 - 0.03 * (y - 4.0) ** 2, (6.0, 4.0)) == 6
    assert groups(lambda x, y: 1.0 - 0.02 * (x - 6.0) ** 2 - 0.03 * (y - 4.0) ** 2) == 24
    assert groups(lambda x, y: 1.0 - 0.02 * (x - 6.0) ** 2 + 0.01 * y, (6.0, 0.0)) == 12
    assert groups(lambda x, y: 1.0 - 0.02 * (x - 5.0) ** 2 + 0.01 * y, (6.0, 0.0)) == 24


def test_faces_of_a_coarse_mesh_are_a_sagitta_from_the_surface_that_is_measured():
    radius, edge = 20.0, 1.0
    mesh = mesh_over(lambda x, y: np.sqrt(radius**2 - (x - 6.0) ** 2 - (y - 4.0) ** 2), 12.0, 8.0, edge)
    own = compas_cgc.rationalise(mesh, panel=4.0, edges=4, moulds=1, flat=False)
    # Diagonals of the squares are the longest edges; towards the corners they are 10 % longer.
    assert 1.0 <= own.facet_deviation / (2.0 * edge**2 / (8.0 * radius)) < 1.25
    assert own.to_dict()["facet_deviation"] == own.facet_deviation > 100.0 * own.design.deviation
    assert f"up to {own.facet_deviation:.2g} from it" in own.summary
    smooth = compas_cgc.rationalise(quarter_torus(), panel=3.0, edges=4, moulds=2)
    assert smooth.facet_deviation is None and "through the vertices" not in smooth.summary


def test_faces_beside_the_seam_of_a_closed_mesh_are_no_farther_from_it():
    angles = np.linspace(0.0, 2.0 * np.pi, 24, endpoint=False)
    vertices = [[3.0 * np.cos(own), 3.0 * np.sin(own), height] for height in range(7) for own in angles]
    quads = [[24 * i + j, 24 * i + (j + 1) % 24, 24 * i + 24 + (j + 1) % 24, 24 * i + 24 + j] for i in range(6) for j in range(24)]
    assert read_design((vertices, quads)).mesh.facet_deviation == pytest.approx(3.0 * (1.0 - np.cos(np.pi / 24.0)), rel=0.02)


def test_a_square_ring_of_pipe_with_four_corners_is_refused():
    """The smooth surface through so few vertices is a round ring, far from the faces."""
    vertices = []
    for x, y in ((-10.0, -7.0), (10.0, -7.0), (10.0, 7.0), (-10.0, 7.0)):
        outwards = np.array([x, y]) / np.hypot(x, y)
        vertices += [[*([x, y] + 2.0 * np.cos(own) * outwards), 2.0 * np.sin(own)] for own in np.pi * np.array([0.25, 0.75, 1.25, 1.75])]
    quads = [[4 * i + j, 4 * i + (j + 1) % 4, 4 * ((i + 1) % 4) + (j + 1) % 4, 4 * ((i + 1) % 4) + j] for i in range(4) for j in range(4)]
    with pytest.raises(MeshError, match=r"the faces of the mesh are up to .* too coarse: refine it"):
        read_design((vertices, quads))


def test_a_cylinder_that_is_rounded_comes_off_one_flat_mould():
    angles = np.linspace(0.0, 2.0 * np.pi, 40, endpoint=False)
    vertices = np.array([[np.cos(own), np.sin(own), 0.25 * height] for height in range(13) for own in angles]).round(6)
    quads = [[40 * i + j, 40 * i + (j + 1) % 40, 40 * i + 40 + (j + 1) % 40, 40 * i + 40 + j] for i in range(12) for j in range(40)]
    own = compas_cgc.rationalise((vertices, quads), panel=1.0, moulds=3)
    assert own.curvatures.tolist() == [0.0] and own.result.verdict.fair and own.distance.largest < 1e-5
