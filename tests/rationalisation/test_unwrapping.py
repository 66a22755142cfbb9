"""Meshes that lie over no plane: closed designs, tubes and walls that turn by more than half a circle."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.spatial import cKDTree

import compas_cgc
from compas_cgc.discrete import face_areas
from compas_cgc.errors import MeshError
from compas_cgc.meshing.boundary import boundary_loops
from compas_cgc.rationalisation import read_design
from compas_cgc.rationalisation.seams import panels_of
from compas_cgc.rationalisation.unwrapping import unwrapped

from ..support.shapes import grid


def rolled(shape, m: int, n: int, around: bool = True, along: bool = False, poles: bool = False):
    """Return the triangles of a surface over m by n squares of the unit square, closed or not."""
    rows, columns = m + (not around), n + (not along)
    s, t = np.meshgrid(np.arange(rows) / m, np.arange(columns) / n, indexing="ij")
    vertices = np.stack(shape(s, t), axis=-1).reshape(-1, 3)
    i, j = (each.ravel() for each in np.meshgrid(np.arange(m), np.arange(n), indexing="ij"))
    corner = lambda a, b: (a % rows) * columns + b % columns  # noqa: E731
    faces = np.concatenate(
        [
            np.column_stack([corner(i, j), corner(i + 1, j), corner(i + 1, j + 1)]),
            np.column_stack([corner(i, j), corner(i + 1, j + 1), corner(i, j + 1)]),
        ]
    )
    if poles:
        for column in (0, n):
            faces[np.isin(faces, [corner(a, column) for a in range(m)])] = corner(0, column)
        faces = faces[(faces != np.roll(faces, 1, axis=1)).all(axis=1)]
    return vertices, faces


def tower(s, t):
    radius = 3.0 + 0.4 * np.cos(2.0 * t)
    return radius * np.cos(2 * np.pi * s), radius * np.sin(2 * np.pi * s), 10.0 * t


def ball(s, t):
    radius, height = 4.0 * np.sin(np.pi * t), -3.0 * np.cos(np.pi * t)
    return radius * np.cos(2 * np.pi * s), radius * np.sin(2 * np.pi * s), height


def ring(s, t):
    radius = 8.0 + 2.0 * np.cos(2 * np.pi * t)
    return radius * np.cos(2 * np.pi * s), radius * np.sin(2 * np.pi * s), 2.0 * np.sin(2 * np.pi * t)


def wall(s, t):
    angle = 1.5 * np.pi * s
    return 5.0 * np.cos(angle), 5.0 * np.sin(angle), 4.0 * t


def frustum(s, t):
    radius = 4.0 - 1.5 * t
    return radius * np.cos(2 * np.pi * s), radius * np.sin(2 * np.pi * s), 8.0 * t


def barrel(s, t):
    radius = 3.0 + 4.0 * t * (1.0 - t) + 0.1 * np.cos(6 * np.pi * s)
    return radius * np.cos(2 * np.pi * s), radius * np.sin(2 * np.pi * s), 10.0 * t


def with_windows(mesh, windows, radius: float = 1.2):
    """Return a mesh around z without the faces near given angles and heights."""
    vertices, faces = mesh
    x, y, z = vertices[faces].mean(axis=1).T
    apart = np.ones(len(faces), bool)
    for angle, height in windows:
        around = (np.arctan2(y, x) - angle + np.pi) % (2 * np.pi) - np.pi
        apart &= np.hypot(around * np.hypot(x, y), z - height) > radius
    used, faces = np.unique(faces[apart], return_inverse=True)
    return vertices[used], faces.reshape(-1, 3)


def egg(s, t):
    x, y, z = ball(s, t)
    return x, y, z * np.where(z > 0.0, 1.3, 1.0)


@pytest.mark.parametrize(
    ("mesh", "closed", "size"),
    [
        (rolled(tower, 48, 20), (True, False), (2 * np.pi * 3.16, 10.02)),
        (rolled(wall, 40, 16, around=False), (False, False), (7.5 * np.pi, 4.0)),
        (rolled(ring, 60, 24, along=True), (True, True), None),
        (rolled(ball, 48, 32, poles=True), (True, False), None),
    ],
    ids=["tower", "wall", "ring", "ball"],
)
def test_a_smooth_surface_goes_through_the_vertices(mesh, closed, size):
    vertices, faces = mesh
    design = read_design(mesh)
    assert design.surface.closed == closed and not design.trimmed
    assert design.deviation < 2e-3 * design.surface.size
    if size is not None:
        assert np.allclose(np.sort(np.ptp(design.surface.domain, axis=1)), np.sort(size), rtol=0.02)
    over = unwrapped(vertices, faces)
    assert np.linalg.norm(design.surface.at(over.uv) - vertices[over.vertices], axis=1).max() < 2e-3 * design.surface.size
    # The normals of the fitted surface are those of the faces.
    centres = vertices[faces].mean(axis=1)
    cross = np.cross(vertices[faces[:, 1]] - vertices[faces[:, 0]], vertices[faces[:, 2]] - vertices[faces[:, 0]])
    nearest = [int(np.argmin(np.linalg.norm(vertices[over.vertices] - centre, axis=1))) for centre in centres[::97]]
    assert (np.einsum("fx,fx->f", design.surface.normals(over.uv[nearest]), cross[::97]) > 0.0).all()


def test_curvature_at_a_pole_is_that_of_the_surface():
    design = read_design(rolled(egg, 48, 48, poles=True), tolerance=1e-4)
    low = design.surface.domain[:, 0]
    near = low + np.ptp(design.surface.domain, axis=1) * np.column_stack([np.linspace(0.0, 0.9, 10), np.full(10, 0.02)])
    # The lower half is an ellipsoid; at its pole both radii of curvature are a^2 / c.
    assert np.allclose(design.surface.gaussian(near), (3.0 / 16.0) ** 2, rtol=0.1)


def test_closed_designs_and_towers_are_rationalised():
    for mesh, panel in ((rolled(tower, 48, 20), 2.5), (rolled(ball, 48, 32, poles=True), 3.0)):
        found = compas_cgc.rationalise(mesh, panel=panel, edges=4, moulds=4)
        assert found.result.converged and found.result.verdict.fair, found.result.message
        assert found.distance.largest < 0.02 * found.design.surface.size


@pytest.mark.parametrize(
    ("shape", "squares", "windows"),
    [
        (tower, (36, 24), [(0.0, 5.0)]),
        pytest.param(tower, (60, 40), [(np.pi, 4.0), (-2.0, 6.0)], marks=pytest.mark.nightly),
        pytest.param(frustum, (60, 40), [(0.5, 4.0)], marks=pytest.mark.nightly),
        # Together these windows leave no line between the ends that crosses none of them.
        pytest.param(tower, (60, 40), [(k * np.pi / 3, 3.0 + 3.5 * (k % 2)) for k in range(6)], marks=pytest.mark.nightly),
    ],
    ids=["tower", "two windows", "frustum", "all around"],
)
def test_a_tube_with_windows_is_meshed_around_them(shape, squares, windows):
    vertices, faces = mesh = with_windows(rolled(shape, *squares), windows, 1.75 if len(windows) > 2 else 1.2)
    design = read_design(mesh)
    assert design.surface.closed == (True, False)
    assert design.deviation < 2e-4 * design.surface.size
    made = panels_of(design, 3.0, 5)
    # The mesh has the same ends and windows, so that it is closed along the line where its parameters close.
    assert len(boundary_loops(made.faces)) == len(boundary_loops(faces)) == 2 + len(windows)
    assert np.isclose(face_areas(made.vertices, made.faces).sum(), face_areas(vertices, faces).sum(), rtol=0.02)
    lengths = np.linalg.norm(made.vertices[made.faces] - made.vertices[np.roll(made.faces, 1, axis=1)], axis=2)
    # Six tenths are aimed at; edges are shorter beside the saw-tooth rims of windows.
    assert 0.4 < np.median(lengths) < 0.75 and lengths.max() < 3.0 * 0.6
    assert cKDTree(vertices).query(made.vertices)[0].max() < 0.4
    # What the grid cuts off at corners of windows is a part of the panel beside it.
    areas = np.bincount(made.panels, face_areas(made.vertices, made.faces))
    assert areas.min() > 0.01 * np.median(areas)


@pytest.mark.nightly
def test_a_tower_with_a_window_is_rationalised():
    found = compas_cgc.rationalise(with_windows(rolled(barrel, 48, 24), [(1.0, 5.0)]), panel=3.0, edges=5, moulds=4)
    assert found.result.converged and found.result.verdict.fair, found.result.message
    assert found.distance.largest < 0.01 * found.design.surface.size


def test_level_lines_meet_where_parameters_close():
    faces = panels_of(read_design(rolled(tower, 24, 12)), 3.0, 3, seams="levels").faces
    assert len(boundary_loops(faces)) == 2


def test_a_nearly_closed_design_is_a_tube_to_a_pole():
    vertices, faces = rolled(ball, 48, 32, poles=True)
    used, open_ = np.unique(faces[vertices[faces, 2].min(axis=1) > -2.5], return_inverse=True)
    design = read_design((vertices[used], open_.reshape(-1, 3)))
    assert design.surface.closed == (True, False) and not design.trimmed and design.deviation < 2e-4 * design.surface.size
    # Along curves it would be meshed in a rectangle, one side of which is the pole.
    with pytest.raises(MeshError, match="too far from flat"):
        panels_of(design, 2.0, seams="levels")


def test_what_cannot_be_unwrapped_is_refused_with_the_cause():
    vertices, faces = rolled(tower, 24, 8)
    level = grid(3)
    for V, F in ((vertices, faces), level):  # the second one lies over its plan
        with pytest.raises(MeshError, match="2 parts that are not joined"):
            read_design((np.concatenate([V, V + [20.0, 0.0, 0.0]]), np.concatenate([F, F + len(V)])))
    corners = np.array([[x, y, z] for x in (0.0, 1.0) for y in (0.0, 1.0) for z in (0.0, 1.0)])
    quads = [[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]]
    with pytest.raises(MeshError, match="too few faces|deviates"):
        read_design((corners, quads))
    # Lying cylinders, whose lowest and highest vertex are on the rims of their caps.
    for n in (6, 12):
        turn, k = np.linspace(0.0, 2.0 * np.pi, n + 1)[:-1], np.arange(n)
        ring, after = np.column_stack([0.0 * turn, np.cos(turn), np.sin(turn)]), np.roll(k, -1)
        places = np.concatenate([ring, ring + [2.0, 0.0, 0.0], [[0.0, 0.0, 0.0], [2.0, 0.0, 0.0]]])
        sides = [[k, after, k + n], [after, after + n, k + n], [after, k, 0 * k + 2 * n], [k + n, after + n, 0 * k + 2 * n + 1]]
        with pytest.raises(MeshError, match="refine"):
            read_design((places, np.concatenate([np.column_stack(own) for own in sides])))
