"""STEP files: one valid shell of trimmed faces with shared edges, near the mesh, with the K of every region."""

from __future__ import annotations

import re
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from scipy.integrate import dblquad
from scipy.interpolate import make_interp_spline

import compas_cgc
from compas_cgc import CGCProblem
from compas_cgc.cli import main
from compas_cgc.discrete import face_areas
from compas_cgc.errors import MeshError
from compas_cgc.fabrication.bending import unbounded_curvature
from compas_cgc.fabrication.shell import fit as shell_fit
from compas_cgc.fabrication.shell import regions
from compas_cgc.fabrication.shell.edges import loops_of
from compas_cgc.fabrication.shell.edges import region_edges
from compas_cgc.fabrication.shell.heights import HeightSpace
from compas_cgc.fabrication.shell.patches import region_patches
from compas_cgc.fabrication.shell.regions import TRIALS
from compas_cgc.fabrication.shell.regions import region_surfaces
from compas_cgc.fabrication.shell.singular import singular_vertices
from compas_cgc.io import opencascade
from compas_cgc.io import step
from compas_cgc.io.step import step_bytes

occt = pytest.importorskip("compas_occt._occt")
SHELL, FACE, EDGE = 3, 4, 6


def shell_of(path):
    """Return the shape of a STEP file."""
    return occt.read_step(str(path))


def free_edges(shape):
    """Return the edges of a shape that have one face."""
    return [edge for edge in occt.shape_explore(shape, EDGE) if len(occt.ancestors(shape, edge, EDGE, FACE)) == 1]


@pytest.fixture(scope="module")
def facade():
    return compas_cgc.solve(compas_cgc.read(compas_cgc.get("facade.3dm")))


@contextmanager
def fits_written():
    """Yield a list that receives the surfaces of all files written in the block."""
    fits = []
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(step, "region_surfaces", lambda problem: fits.append(region_surfaces(problem)) or fits[-1])
        yield fits


def file_of(result, folder):
    """Return the surfaces, the shell and the notes of a file of a result."""
    with fits_written() as fits:
        notes = compas_cgc.write(folder / "roof.step", result)
    (fit,) = fits
    return fit, shell_of(folder / "roof.step"), notes


@pytest.fixture(scope="module")
def written(facade, tmp_path_factory):
    """Return the surfaces, the shell and the notes of a file of the facade."""
    return file_of(facade, tmp_path_factory.mktemp("written"))


@pytest.fixture(scope="module")
def facade_fit(written):
    return written[0]


def test_regions_are_one_valid_shell_whose_free_edges_are_the_rim(facade, written):
    _, shell, (note,) = written
    assert note.startswith("3 faces in one shell")
    assert occt.is_valid(shell) and len(occt.shape_explore(shell, FACE)) == 3 and len(occt.shape_explore(shell, SHELL)) == 1
    problem = facade.problem
    rim = [edge for edge in region_edges(problem.vertices, problem.faces, problem.regions()) if len(edge.regions) == 1]
    assert len(free_edges(shell)) == len(rim)
    # Millimetres; the mesh is inscribed.
    assert occt.area(shell) == pytest.approx(1e6 * face_areas(problem.vertices, problem.faces).sum(), rel=3e-3)


def test_a_georeferenced_roof_is_one_valid_shell_in_its_place(facade, written, tmp_path):
    """Ends of edges agree within the rounding of the coordinates only, which is more than 1e-7 mm here."""
    away = np.array([691_234.5, 5_334_321.25, 520.0])
    content, (note,) = step_bytes(replace(facade.problem, vertices=facade.problem.vertices + away))
    (tmp_path / "far.step").write_bytes(content)
    far, near = shell_of(tmp_path / "far.step"), written[1]
    assert note.startswith("3 faces in one shell")
    assert occt.is_valid(far) and len(occt.shape_explore(far, SHELL)) == 1 and len(free_edges(far)) == len(free_edges(near))
    # STEP files have 13 digits, which are steps of .001 mm here.
    assert np.array(occt.centroid(far)) == pytest.approx(np.array(occt.centroid(near)) + 1e3 * away, abs=0.01, rel=0)
    assert occt.area(far) == pytest.approx(occt.area(near), rel=1e-5)


def test_regions_of_a_plane_through_its_centre_keep_their_names(tmp_path):
    """The volume between a plane and the origin of the shape is 0, and so is the centroid that OpenCASCADE computes from it."""
    plane = compas_cgc.CGCMesh.from_meshgrid(dx=6.0, nx=12)
    plane.set_supports("corners")
    plane.set_creases([[13 * 4 + k for k in range(13)]])
    plane.set_target(0.0)
    compas_cgc.write(tmp_path / "plane.step", compas_cgc.solve(plane))
    names = re.findall(r"ADVANCED_FACE\('([^']*)'", (tmp_path / "plane.step").read_text(encoding="utf-8"))
    areas = [occt.area(face) for face in occt.shape_explore(shell_of(tmp_path / "plane.step"), FACE)]
    vertices, faces = plane.arrays()[:2]
    own = {f"region {k}": 1e6 * face_areas(vertices, faces[region]).sum() for k, region in enumerate(plane.regions())}
    assert areas == pytest.approx([own[name] for name in names]) and sorted(areas) == pytest.approx([12e6, 24e6])


def test_a_roof_in_two_parts_is_two_valid_shells(tmp_path):
    first = compas_cgc.CGCMesh.from_meshgrid(dx=6.0, nx=12)
    vertices, faces = first.arrays()[:2]
    both = np.concatenate([vertices, 0.5 * vertices + [8.0, 1.0, 0.0]])
    roof = compas_cgc.CGCMesh.from_vertices_and_faces(both.tolist(), np.concatenate([faces, faces + len(vertices)]).tolist())
    roof.set_supports("boundary")
    roof.set_target(0.02)
    result = compas_cgc.solve(roof)
    (note,) = compas_cgc.write(tmp_path / "parts.step", result)
    shape = shell_of(tmp_path / "parts.step")
    assert note.startswith("2 faces in 2 shells, ") and len(occt.shape_explore(shape, SHELL)) == 2 and occt.is_valid(shape)
    assert occt.area(shape) == pytest.approx(1e6 * face_areas(result.problem.vertices, result.problem.faces).sum(), rel=5e-3)


def test_surfaces_that_opencascade_refuses_do_not_cost_the_mesh(facade, tmp_path, monkeypatch, capsys):
    def refuse(*_):
        raise RuntimeError("BRep_API: command not done")

    monkeypatch.setattr(opencascade, "_faces", refuse)
    compas_cgc.write(tmp_path / "drawn.3dm", facade)
    assert main(["solve", str(tmp_path / "drawn.3dm"), "-o", str(tmp_path / "roof.step"), "-q"]) == 4
    assert "OpenCASCADE cannot trim and join the surfaces (BRep_API: command not done); refine the mesh" in capsys.readouterr().err
    assert (tmp_path / "roof.obj").exists() and not (tmp_path / "roof.step").exists()


def test_surfaces_meet_and_have_their_curvature(facade_fit):
    fit = facade_fit
    assert fit.gap < 1e-5 and fit.distance < 5e-4 * fit.scale
    half, most, _ = fit.percentiles()
    assert half < 0.002 and most < 0.02


def edge_integral(piece, loop):
    """Return the area of the graph of heights inside a loop of points (k, 2) of its plane, by Green's theorem."""
    nodes, weights = np.polynomial.legendre.leggauss(4)
    places = np.arange(len(loop) + 1)
    spline = make_interp_spline(places, np.vstack([loop, loop[:1]]), k=1)
    at = (places[:-1, None] + 0.5 * (nodes + 1.0)).ravel()
    xy, rise = spline(at), spline(at, 1)[:, 1] * np.tile(0.5 * weights, len(loop))
    total, spans = 0.0, np.unique(piece.space.knots[0])
    for start, end in zip(spans[:-1], spans[1:]):
        length = np.maximum(np.minimum(end, xy[:, 0]) - start, 0.0)
        for node, weight in zip(nodes, weights):
            points = np.column_stack([start + 0.5 * length * (node + 1.0), xy[:, 1]])
            p, q = (piece.space.basis(points, order) @ piece.coefficients for order in ((1, 0), (0, 1)))
            total += (0.5 * length * weight * np.sqrt(1.0 + p * p + q * q)) @ rise
    return abs(total)


def area_between_edges(fit, finer=3):
    """Return the area of all surfaces of a fit between their edges, of regions with one loop of edges, in its frame."""
    total = 0.0
    for number, piece in enumerate(fit.pieces):
        (loop,) = loops_of(fit.edges, [k for k, edge in enumerate(fit.edges) if number in edge.regions])
        here, points = fit.edges[loop[0]].path[0], []
        for k in loop:
            path, curve = fit.edges[k].path, fit.curves[k]
            if path[0] != here:
                path, curve = path[::-1], curve[::-1]
            here = path[-1]
            fine = np.linspace(0.0, len(curve) - 1.0, finer * (len(curve) - 1) + 1)[:-1]
            points.append(piece.local(make_interp_spline(np.arange(len(curve)), curve, k=3)(fine))[:, :2])
        total += edge_integral(piece, np.concatenate(points))
    return total


@pytest.mark.parametrize("name", ["nine_regions.3dm", "curved_crease.3dm", "canopy.3dm", "cushion.3dm", "vault.3dm"])
def test_surfaces_of_samples_have_their_curvature_and_their_area_is_read_back(name, tmp_path):
    drawn = compas_cgc.read(compas_cgc.get(name)).to_problem()
    problem = compas_cgc.solve(drawn.with_targets(0.005) if name == "curved_crease.3dm" else drawn).problem
    with fits_written() as fits:
        (tmp_path / "roof.step").write_bytes(step_bytes(problem)[0])
    (fit,) = fits
    assert fit.percentiles()[1] <= 0.02 and fit.distance <= fit.reach and fit.gap < 1e-5
    shell = shell_of(tmp_path / "roof.step")
    rim = [edge for edge in fit.edges if len(edge.regions) == 1]
    assert occt.is_valid(shell) and len(occt.shape_explore(shell, SHELL)) == 1 and len(free_edges(shell)) == len(rim)
    assert occt.area(shell) == pytest.approx(1e6 * fit.scale**2 * area_between_edges(fit), rel=1e-4)


def test_all_edges_that_meet_at_a_vertex_end_at_one_point():
    """Around crossings of creases the planes of four regions differ, and so do the directions of their heights."""
    problem = compas_cgc.solve(compas_cgc.read(compas_cgc.get("nine_regions.3dm"))).problem
    fit = shell_fit.fitted(problem, *TRIALS[0])
    assert fit.distance > 1e-3
    ends: dict[int, list] = {}
    for edge, curve in zip(fit.edges, fit.curves):
        for vertex, point in zip(edge.path[[0, -1]].tolist(), curve[[0, -1]]):
            ends.setdefault(vertex, []).append(fit.scale * point)
    crossings = [points for points in ends.values() if len(points) == 4]
    assert len(crossings) == 4
    assert max(np.linalg.norm(np.ptp(points, axis=0)) for points in ends.values()) <= fit.gap < 1e-5


def test_edges_of_surfaces_are_the_curves_through_the_vertices(facade, facade_fit):
    """They do not wave between the vertices, least of all along supports, where K is singular."""
    fit = facade_fit
    V = facade.problem.vertices
    off = [
        np.linalg.norm(shell_fit.samples(V[edge.path]) - fit.centre - fit.scale * own, axis=1) for edge, own in zip(fit.edges, fit.curves)
    ]
    assert np.concatenate(off).max() < 0.002


@pytest.fixture(scope="module")
def panels():
    """Return a roof of 24 panels on four moulds."""
    x, y = np.meshgrid(np.linspace(-6, 6, 25), np.linspace(-4, 4, 17), indexing="ij")
    vertices = np.column_stack([x.ravel(), y.ravel(), (2 - 0.03 * x**2 - 0.05 * y**2 + 0.1 * np.sin(0.8 * x)).ravel()])
    quads = [[i * 17 + j, i * 17 + 17 + j, i * 17 + 18 + j, i * 17 + 1 + j] for i in range(24) for j in range(16)]
    return compas_cgc.rationalise((vertices, quads), panel=2.0, moulds=4, edges=4)


@pytest.fixture(scope="module")
def written_panels(panels, tmp_path_factory):
    """Return the surfaces, the shell and the notes of a file of the panels."""
    return file_of(panels.result, tmp_path_factory.mktemp("written"))


@pytest.fixture(scope="module")
def panel_fit(written_panels):
    return written_panels[0]


def test_panels_of_a_rationalised_roof_are_one_valid_shell(panels, written_panels):
    problem = panels.result.problem
    assert len(set(problem.region_targets())) == 4
    _, shell, (note,) = written_panels
    assert note.startswith("24 faces in one shell")
    assert occt.is_valid(shell) and len(occt.shape_explore(shell, FACE)) == 24
    rim = [edge for edge in region_edges(problem.vertices, problem.faces, problem.regions()) if len(edge.regions) == 1]
    assert len(free_edges(shell)) == len(rim) == 20


def test_panels_of_a_rationalised_roof_have_their_curvature(panels, panel_fit):
    fit = panel_fit
    assert fit.gap < 1e-6 * fit.scale and fit.distance < 5e-4 * fit.scale and fit.percentiles()[1] < 0.02
    made = region_patches(panels.result.problem, fit)
    assert all(patch.sides for patch in made.patches) and made.percentiles[1] < 0.02


def normals(piece, points):
    """Return unit normals of a surface at points of it, from differences towards the middle of its rectangle."""
    xy = piece.local(points)[:, :2]
    inwards = np.where(xy < [0.5 * (knots[0] + knots[-1]) for knots in piece.space.knots], 1e-6, -1e-6)
    u, v = (piece.lifted(xy + inwards * step) - piece.lifted(xy) for step in np.eye(2))
    normal = np.cross(u, v) * np.sign(inwards[:, :1] * inwards[:, 1:])
    return normal / np.linalg.norm(normal, axis=1, keepdims=True)


def kinks(fit, edge, curve):
    """Return the angles between both surfaces along a shared edge [deg]."""
    one, two = (normals(fit.pieces[region], curve) for region in edge.regions)
    return np.degrees(np.arctan2(np.linalg.norm(np.cross(one, two), axis=1), np.einsum("ij,ij->i", one, two)))


def test_kinks_at_smooth_seams_are_bounded_and_reported(panels, panel_fit, monkeypatch):
    fit = panel_fit
    found = np.concatenate([kinks(fit, edge, curve) for edge, curve in zip(fit.edges, fit.curves) if len(edge.regions) == 2])
    assert fit.kinks == pytest.approx(found, abs=1e-3)
    half, most, largest = fit.kink_percentiles()
    assert half < 0.2 and most < 0.65 and largest < 0.8
    text = f"kinks at smooth seams {half:.2g} (50 %), {most:.2g} (95 %), {largest:.2g} degrees (100 %)"
    assert text in fit.accuracy(np.zeros(3), 1.0, "m")
    monkeypatch.setattr(shell_fit, "KINK", 1e9)
    assert half < 0.8 * shell_fit.fitted(panels.result.problem, *TRIALS[0]).kink_percentiles()[0]


def test_edges_stay_inside_the_rectangles_of_their_surfaces(panel_fit):
    for edge, curve in zip(panel_fit.edges, panel_fit.curves):
        for region in edge.regions:
            piece = panel_fit.pieces[region]
            for axis, knots in enumerate(piece.space.knots):
                assert (knots[0] < piece.local(curve)[:, axis]).all() and (piece.local(curve)[:, axis] < knots[-1]).all()


def test_creases_keep_their_folds(facade_fit):
    fit = facade_fit
    assert not len(fit.kinks)
    folds = [np.median(kinks(fit, edge, curve)) for edge, curve in zip(fit.edges, fit.curves) if len(edge.regions) == 2]
    assert len(folds) == 2 and min(folds) > 14.0


@pytest.fixture(scope="module")
def saddle_amid_hills():
    """Return the solved roof of nine regions with K < 0 in the middle."""
    mesh = compas_cgc.CGCMesh.from_meshgrid(dx=15.0, nx=24)
    lines = np.arange(625).reshape(25, 25)
    mesh.set_supports(lines[[0, 0, -1, -1], [0, -1, 0, -1]].tolist())
    mesh.set_creases([line.tolist() for k in (8, 16) for line in (lines[k], lines[:, k])])
    problem = mesh.to_problem().with_targets(0.01)
    V, F = mesh.arrays()
    middle = int(problem.regions()[np.linalg.norm((V[F].mean(axis=1) - V.mean(axis=0)), axis=1).argmin()])
    return compas_cgc.solve(problem.with_targets(-0.04, region=middle))


def test_a_region_with_negative_curvature_amid_others_is_written(saddle_amid_hills, tmp_path):
    fit, shell, (note,) = file_of(saddle_amid_hills, tmp_path)
    assert fit.gap < 1e-5 and fit.distance < 5e-4 * fit.scale and fit.percentiles()[1] < 0.02
    assert len(fit.away) > 0.6 * len(saddle_amid_hills.problem.faces)
    assert note.startswith("9 faces in one shell")
    assert occt.is_valid(shell) and len(occt.shape_explore(shell, FACE)) == 9 and len(free_edges(shell)) == 12


def test_edges_between_hills_and_bowls_are_singular(facade, saddle_amid_hills):
    """Four edges at least, each from a corner of the region in the middle to the rim."""
    problem = saddle_amid_hills.problem
    edges = region_edges(problem.vertices, problem.faces, problem.regions())
    found = singular_vertices(problem)
    inside = [edge for edge in edges if len(edge.regions) == 2]
    singular = [edge for edge in inside if np.isin(edge.path, found).all()]
    assert len(singular) == 4 and all(len(edge.path) == 9 for edge in singular)
    assert set(found) == {*problem.supports, *np.concatenate([edge.path for edge in singular])}
    assert np.any(list(unbounded_curvature(problem).values()), axis=0)[found].all()
    assert np.array_equal(singular_vertices(facade.problem), np.unique(facade.problem.supports))


def test_a_sphere_with_a_courtyard_is_trimmed_to_its_area(tmp_path):
    mesh = compas_cgc.CGCMesh.from_meshgrid(dx=8.0, nx=16)
    V, F = mesh.arrays()
    V = V - [4.0, 4.0, 0.0]
    V[:, 2] = np.sqrt(100.0 - V[:, 0] ** 2 - V[:, 1] ** 2)
    kept = F[np.abs(V[F].mean(axis=1)[:, :2]).max(axis=1) > 1.5]
    used, kept = np.unique(kept, return_inverse=True)
    mesh = compas_cgc.CGCMesh.from_vertices_and_faces(V[used].tolist(), kept.reshape(-1, 3).tolist())
    mesh.set_target(0.01)
    content, _ = step_bytes(mesh.to_problem())
    (tmp_path / "ring.step").write_bytes(content)
    shell = shell_of(tmp_path / "ring.step")
    assert occt.is_valid(shell) and len(free_edges(shell)) == 8

    def area(half):
        """Return the area of the sphere of radius 10 over a square around its pole."""
        return dblquad(lambda y, x: 10.0 / np.sqrt(100.0 - x * x - y * y), -half, half, -half, half)[0]

    assert occt.area(shell) == pytest.approx(1e6 * (area(4.0) - area(1.5)), rel=1e-4)


def test_height_splines_reproduce_polynomials_with_their_curvature():
    space = HeightSpace.over(np.array([-1.0, -2.0]), np.array([1.0, 2.0]), 0.5)
    grid = np.stack(np.meshgrid(np.linspace(-1, 1, 30), np.linspace(-2, 2, 40), indexing="ij"), axis=-1).reshape(-1, 2)
    x, y = grid.T
    B = space.basis(grid)
    coefficients = np.linalg.lstsq(B.toarray(), x**3 * y - y**2, rcond=None)[0]
    assert np.allclose(B @ coefficients, x**3 * y - y**2)
    assert np.allclose(space.basis(grid, (2, 1)) @ coefficients, 6 * x)
    found = shell_fit.Piece(np.eye(3), space, coefficients).gaussian(grid)
    p, q, r, s, t = 3 * x**2 * y, x**3 - 2 * y, 6 * x * y, 3 * x**2, -2.0
    assert np.allclose(found, (r * t - s * s) / (1 + p * p + q * q) ** 2)


def test_a_region_that_closes_is_refused():
    sphere = compas_cgc.CGCMesh.from_polyhedron(20)
    sphere.set_target(1.0)
    with pytest.raises(MeshError, match="closes or folds over"):
        region_surfaces(sphere.to_problem())


def test_a_region_that_overhangs_its_support_is_refused_with_the_place():
    """Beside a straight support with K > 0 the slope grows as the mesh is refined, until only the last row of faces is vertical."""
    rings, count = np.radians(np.linspace(8.0, 94.0, 9)), 48
    turn = np.linspace(0.0, 2.0 * np.pi, count, endpoint=False)
    V = [[0.0, 0.0, 5.0]] + [[5 * np.sin(a) * np.cos(t), 5 * np.sin(a) * np.sin(t), 5 * np.cos(a)] for a in rings for t in turn]
    F = [[0, 1 + k, 1 + (k + 1) % count] for k in range(count)]
    for ring in range(len(rings) - 1):
        for k in range(count):
            a, b = (1 + ring * count + j % count for j in (k, k + 1))
            F += [[a, a + count, b + count], [a, b + count, b]]
    problem = CGCProblem(np.array(V), np.array(F)).with_supports("boundary").with_targets(0.04)
    with pytest.raises(MeshError, match=r"overhangs beside a support at \([-\d., e]+\).*longer mesh edges"):
        region_surfaces(problem)


def test_refused_surfaces_never_cost_the_mesh(tmp_path, monkeypatch, capsys):
    monkeypatch.setattr(shell_fit, "MAX_CURVATURE_ERROR", 1e-12)
    monkeypatch.setattr(regions, "TRIALS", TRIALS[:1])
    out = tmp_path / "facade.step"
    code = main(["solve", compas_cgc.get("facade.3dm"), "-o", str(out)])
    printed = capsys.readouterr()
    assert code != 0 and not out.exists() and Path(tmp_path / "facade.obj").exists()
    assert "no smooth surfaces of the regions were written" in printed.err and "wrote the mesh to" in printed.out
