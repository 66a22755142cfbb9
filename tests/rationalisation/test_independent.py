"""Rationalised roofs against measures of their own: K by cubic fits, development in long double, distances from the true surface."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.spatial import cKDTree

import compas_cgc
from compas_cgc.rationalisation import Rationalised
from compas_cgc.rationalisation import SplineSurface
from compas_cgc.rationalisation import read_design

from ..support.freeform import bumpy
from ..support.freeform import mesh_over

pytestmark = pytest.mark.nightly


@pytest.fixture(scope="module")
def roof() -> Rationalised:
    """A roof with panels of 5 m, eight edges a side."""
    return compas_cgc.rationalise(read_design(mesh_over(bumpy("soft", 0)), tolerance=5e-4), panel=5.0, edges=8, moulds=4)


def neighbours(faces: np.ndarray, count: int) -> list[set[int]]:
    found: list[set[int]] = [set() for _ in range(count)]
    for a, b, c in faces.tolist():
        found[a] |= {b, c}
        found[b] |= {a, c}
        found[c] |= {a, b}
    return found


def curvature_by_cubics(found: Rationalised) -> tuple[np.ndarray, np.ndarray]:
    """Return K by cubic fits within panels, at vertices two edges from seams and the rim, and K of their moulds."""
    V, F = found.result.vertices, found.result.problem.faces
    beside = neighbours(F, len(V))
    panels: list[set[int]] = [set() for _ in V]
    for face, panel in zip(F.tolist(), found.panels.tolist()):
        for vertex in face:
            panels[vertex].add(panel)
    halves = {(a, b) for face in F.tolist() for a, b in zip(face, face[1:] + face[:1])}
    on_seam = np.array([len(own) > 1 for own in panels])
    for a, b in halves:
        if (b, a) not in halves:
            on_seam[[a, b]] = True
    near = on_seam | np.array([any(on_seam[w] for w in own) for own in beside])
    fitted, wanted = [], []
    for vertex in np.flatnonzero(~near).tolist():
        (panel,) = panels[vertex]
        ring = front = {vertex}
        for _ in range(3):
            front = {w for v in front if not on_seam[v] for w in beside[v] if panel in panels[w]} - ring
            ring = ring | front
        points = V[sorted(ring)] - V[vertex]
        x, y, z = (points @ np.linalg.svd(points - points.mean(axis=0))[2].T).T
        weight = np.exp(-2.0 * (x * x + y * y) / np.abs([x, y]).max() ** 2)
        columns = np.column_stack([np.ones_like(x), x, y, x * x, x * y, y * y, x**3, x * x * y, x * y * y, y**3])
        c = np.linalg.lstsq(columns * weight[:, None], z * weight, rcond=None)[0]
        fitted.append((4.0 * c[3] * c[5] - c[4] ** 2) / (1.0 + c[1] ** 2 + c[2] ** 2) ** 2)
        wanted.append(found.curvatures[found.classes[panel]])
    return np.array(fitted), np.array(wanted)


def test_curvature_by_fits_within_panels_is_that_of_the_moulds(roof):
    fitted, wanted = curvature_by_cubics(roof)
    off = np.abs(fitted - wanted) / np.abs(roof.curvatures).max()
    assert len(off) > 800
    assert np.median(off) <= 0.01 and np.quantile(off, 0.95) <= 0.05


def geodesic_angles(sides: np.ndarray, K: float) -> np.ndarray:
    """Return the angles (m, 3) of triangles of curvature K from chords (m, 3) opposite to the corners, by half-angle formulas."""
    s = np.sqrt(np.abs(np.longdouble(K)))
    if K > 0.0:
        lengths, half = 2.0 / s * np.arcsin(np.minimum(0.5 * s * sides, 1.0)), lambda t: np.sin(s * t)
    elif K < 0.0:
        lengths, half = 2.0 / s * np.arcsinh(0.5 * s * sides), lambda t: np.sinh(s * t)
    else:
        lengths, half = sides, lambda t: t
    p = lengths.sum(axis=1) / 2.0
    angles = []
    for k in range(3):
        a, b, c = lengths[:, k], lengths[:, (k + 1) % 3], lengths[:, (k + 2) % 3]
        angles.append(2.0 * np.arctan2(np.sqrt(half(p - b) * half(p - c)), np.sqrt(half(p) * half(p - a))))
    return np.stack(angles, axis=1)


def test_every_panel_develops_onto_its_mould(roof):
    """Around every vertex within a panel the triangles of its mould close: gaps are the angles left, times the width of a panel."""
    V, F = roof.result.vertices.astype(np.longdouble), roof.result.problem.faces
    sides = np.stack([np.sqrt(((V[F[:, (k + 1) % 3]] - V[F[:, (k + 2) % 3]]) ** 2).sum(axis=1)) for k in range(3)], axis=1)
    total = np.zeros(len(V), np.longdouble)
    for mould, K in enumerate(roof.curvatures.tolist()):
        own = roof.classes[roof.panels] == mould
        np.add.at(total, F[own], geodesic_angles(sides[own], K))
    inside = np.zeros(len(V), bool)
    halves = {(a, b): panel for face, panel in zip(F.tolist(), roof.panels.tolist()) for a, b in zip(face, face[1:] + face[:1])}
    inside[np.unique(F)] = True
    for (a, b), panel in halves.items():
        if halves.get((b, a)) != panel:
            inside[[a, b]] = False
    gaps = np.abs(2.0 * np.pi - total[inside].astype(float)) * 5.0
    assert inside.sum() > 1500 and gaps.max() * 1e3 <= 1e-9, "millimetres"


def test_distances_are_those_from_the_true_nurbs_surface():
    """A NURBS roof with weights; its points by De Boor's recursion on a grid of 10 mm, refined by the nearest triangle's corners."""
    rng = np.random.default_rng(3)
    u, v = np.meshgrid(np.linspace(0, 20, 6), np.linspace(0, 12, 5), indexing="ij")
    z = 3.0 - 0.02 * (u - 10) ** 2 - 0.03 * (v - 6) ** 2 + rng.uniform(-0.3, 0.3, u.shape)
    w = rng.uniform(0.8, 1.2, u.shape)
    knots = tuple(np.concatenate([np.zeros(3), np.linspace(0, 1, n - 2), np.ones(3)]) for n in u.shape)
    surface = SplineSurface(np.stack([u * w, v * w, z * w, w], axis=-1), knots, (3, 3))
    found = compas_cgc.rationalise(surface, panel=2.0, edges=4, moulds=4)

    def basis(t: np.ndarray, knots: np.ndarray) -> np.ndarray:
        t = np.minimum(t, np.nextafter(knots[-1], 0.0))
        rows = ((knots[:-1] <= t[:, None]) & (t[:, None] < knots[1:])).astype(float)
        for degree in (1, 2, 3):
            left, right = knots[degree:-1] - knots[: -degree - 1], knots[degree + 1 :] - knots[1:-degree]
            a = np.divide(t[:, None] - knots[: -degree - 1], left, out=np.zeros((len(t), len(left))), where=left > 0)
            b = np.divide(knots[degree + 1 :] - t[:, None], right, out=np.zeros((len(t), len(right))), where=right > 0)
            rows = a * rows[:, :-1] + b * rows[:, 1:]
        return rows

    s, t = np.linspace(0, 1, 2001), np.linspace(0, 1, 1201)
    weighted = np.einsum("ai,bj,ijx->abx", basis(s, knots[0]), basis(t, knots[1]), np.stack([u * w, v * w, z * w, w], axis=-1))
    points = (weighted[..., :3] / weighted[..., 3:]).reshape(-1, 3)
    nearest = cKDTree(points).query(found.result.vertices)[0]
    # The nearest of points 10 mm apart is up to 7 mm beside the foot: less than 1 mm farther at 30 mm.
    inner = np.abs(found.distance.signed) > 0.0
    assert np.all(nearest[inner] ** 2 >= found.distance.signed[inner] ** 2 - 1e-4)
    assert abs(np.sqrt(max(nearest.max() ** 2 - 0.005**2, 0.0)) - found.distance.largest) < 1e-3
