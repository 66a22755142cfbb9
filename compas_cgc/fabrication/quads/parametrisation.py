"""Seamless parametrisation of a region along a cross field: its integer lines form quads without dead ends."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from scipy import sparse
from scipy.sparse.csgraph import breadth_first_order
from scipy.sparse.csgraph import connected_components
from scipy.sparse.csgraph import dijkstra

from ...discrete import edge_faces
from ...discrete.arrays import Faces
from ...discrete.arrays import FloatArray
from ...discrete.arrays import IntArray
from ...discrete.arrays import Mask
from ...discrete.arrays import Vertices
from ...linalg import factorise
from ...meshing import boundary_loops
from .cross_field import QUARTER
from .cross_field import CrossField

__all__ = ["parametrised"]

STRAIGHTNESS = 10.0  # weight of the direction of the lines against their distance
RIM_ANGLE = np.deg2rad(12.0)  # angle between cross and rim up to which a part of the rim becomes a line
MIN_RUN = 2.0  # of the spacing, shortest part of the rim that becomes a line
RIDGE = 1e-9  # relative weight of the squared coordinates, so that the matrix is regular
STIFFENINGS = 10  # largest number of times that faces turned over in the coordinates are made stiffer
TIE = 1e-6  # difference of two distances, relative to the spacing, that is rounding
ASKEW = 0.1 * QUARTER  # start of the range of the first direction [rad]
ROUNDED = 1e-7  # difference from an integer below which a coordinate counts as one


class _Cut(NamedTuple):
    """A region cut open, and a cross field combed on it."""

    copies: IntArray  # (m, 3) copy of every corner of a face
    size: int  # number of copies
    angles: FloatArray  # (m,) angle of the first coordinate direction in the axes of the face [rad]
    seams: IntArray  # (s, 4) cut edges: start, end, left and right face
    quarters: IntArray  # (s,) turns from the left to the right face, in quarters


def parametrised(
    vertices: Vertices, faces: Faces, field: CrossField, spacing: float, sides: list[IntArray], density: FloatArray
) -> FloatArray:
    r"""Return coordinates at the corners of faces (m, 3, 2), in units of the spacing.

    The coordinates u, v minimise

    .. math:: \int (\partial_X u - \rho)^2 + (\partial_Y v - \rho)^2 + c \, (\partial_Y u)^2 + c \, (\partial_X v)^2

    for the directions X, Y of the crosses and the density :math:`\rho` of the lines. Across the cuts that open the region they are
    turned by quarters and shifted by integers, so that integer lines continue; singularities lie at integers, and sides of the rim along
    the crosses are integer lines. Integers are fixed one by one, each time the one nearest to its value.

    Parameters
    ----------
    vertices, faces
        Triangles of a region.
    field
        Its cross field.
    spacing
        Distance between lines [L].
    sides
        Paths of vertices along the rim between its kinks that become lines where they run along the crosses.
    density
        (m,) lines per spacing in the faces.

    References
    ----------
    Bommes, Zimmer, Kobbelt, *Mixed-integer quadrangulation*, 2009, doi:10.1145/1531326.1531383.
    """
    singular = np.flatnonzero(field.indices)
    cut = _cut_open(faces, field, _cut_edges(vertices, faces, field, singular))
    n = cut.size
    stiff = np.ones(len(faces))
    quadratic, linear = _energy(vertices / spacing, faces, field, cut, stiff, density)
    rows = _seam_rows(faces, cut)
    singularities = [_unit(n, int(_copies_of(faces, cut, vertex)[0]), axis) for vertex in singular.tolist() for axis in (0, 1)]
    rim_rows, rims = _rim_rows(vertices, faces, field, cut, sides, spacing)
    rows += rim_rows
    values = np.zeros(len(rows))
    uv = _minimum(quadratic, linear, rows, values)
    # Integer singularities make the shifts of their cuts integers; the reverse does not hold.
    for integers in (singularities, rims, _shifts(faces, cut)):
        whole = sparse.vstack(integers, format="csr") if integers else sparse.csr_matrix((0, 2 * n))
        for _ in integers:
            found = whole @ uv
            integer = np.floor(found + 0.5 + TIE)
            off = np.abs(found - integer)
            if off.max() <= ROUNDED:
                break
            # On symmetric roofs several are as near.
            nearest = int(np.argmin(np.where(off > ROUNDED, np.round(off / TIE), np.inf)))
            rows, values = [*rows, whole[nearest]], np.r_[values, integer[nearest]]
            uv = _minimum(quadratic, linear, rows, values)
    near = _neighbours(faces)
    for _ in range(STIFFENINGS):
        turned = _areas(np.stack([uv[cut.copies], uv[n + cut.copies]], axis=2)) <= 0.0
        if not turned.any():
            break
        stiff *= np.where(near @ turned > 0, 2.0, 1.0)
        quadratic, linear = _energy(vertices / spacing, faces, field, cut, stiff, density)
        uv = _minimum(quadratic, linear, rows, values)
    nearby = np.round(uv)
    uv = np.where(np.abs(uv - nearby) < ROUNDED, nearby, uv)
    return np.stack([uv[cut.copies], uv[n + cut.copies]], axis=2)


def _neighbours(faces: Faces) -> sparse.csr_matrix:
    """Return which faces share a vertex (m, m)."""
    m = len(faces)
    at = sparse.csr_matrix((np.ones(3 * m), faces.ravel(), np.arange(0, 3 * m + 1, 3)))
    return (at @ at.T).tocsr()


def _flat(vertices: Vertices, faces: Faces, field: CrossField) -> FloatArray:
    """Return the corners of faces in their axes (m, 3, 2)."""
    corners = vertices[faces]
    return np.einsum("fki,fji->fkj", corners - corners[:, :1], field.axes)


def _areas(flat: FloatArray) -> FloatArray:
    """Return twice the areas of plane triangles (m,), negative for those turned over."""
    a, b = (flat[:, k] - flat[:, 0] for k in (1, 2))
    return a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]


def _cut_edges(vertices: Vertices, faces: Faces, field: CrossField, singular: IntArray) -> Mask:
    """Return which inner edges (e,) are cut: shortest paths that join singularities and holes to the outer rim."""
    n = len(vertices)
    lengths = np.linalg.norm(vertices[field.edges[:, 0]] - vertices[field.edges[:, 1]], axis=1)
    # Paths that are as long on symmetric roofs shall not be chosen by the rounding of coordinates.
    lengths = np.maximum(np.round(lengths / (TIE * lengths.mean())), 1.0)
    graph = sparse.csr_matrix((lengths, (field.edges[:, 0], field.edges[:, 1])), shape=(n, n))
    loops = sorted(boundary_loops(faces), key=lambda loop: -float(np.linalg.norm(np.diff(vertices[loop], axis=0), axis=1).sum()))
    joined = set(loops[0].tolist())
    targets: list[list[int]] = [*(loop.tolist() for loop in loops[1:]), *([vertex] for vertex in singular.tolist())]
    pairs = set()
    while targets:
        distance, before, _ = dijkstra(graph, directed=False, indices=sorted(joined), return_predecessors=True, min_only=True)
        ends = [min(target, key=lambda vertex: float(distance[vertex])) for target in targets]
        nearest = int(np.argmin(distance[ends]))
        at = ends[nearest]
        while before[at] >= 0:
            pairs.add((min(at, int(before[at])), max(at, int(before[at]))))
            joined.add(at)
            at = int(before[at])
        joined.update(targets.pop(nearest))
    return np.array([(min(a, b), max(a, b)) in pairs for a, b in field.edges[:, :2].tolist()], dtype=bool)


def _cut_open(faces: Faces, field: CrossField, cut: Mask) -> _Cut:
    """Return the copies of vertices along cuts, and directions that turn least from face to face within the cuts."""
    m = len(faces)
    whole = field.edges[~cut]
    pairs = []
    for end in (0, 1):
        corners = [3 * whole[:, side] + np.argmax(faces[whole[:, side]] == whole[:, end, None], axis=1) for side in (2, 3)]
        pairs.append(np.column_stack(corners))
    joined = np.vstack(pairs)
    count, copies = connected_components(sparse.coo_matrix((np.ones(len(joined)), joined.T), shape=(3 * m, 3 * m)), directed=False)
    dual = sparse.coo_matrix((np.ones(len(whole)), (whole[:, 2], whole[:, 3])), shape=(m, m)).tocsr()
    order, before = breadth_first_order(dual, 0, directed=False)
    turn = {}
    for (left, right), angle in zip(field.edges[:, 2:].tolist(), field.turns.tolist()):
        turn[left, right], turn[right, left] = angle, -angle
    angles = field.angles.copy()
    # Symmetric crosses lie at 0 and half of a quarter, where rounding would choose among their directions.
    angles[0] = (angles[0] + ASKEW) % QUARTER - ASKEW
    for face in order[1:].tolist():
        aim = angles[before[face]] + turn[int(before[face]), face]
        angles[face] += QUARTER * np.round((aim - angles[face]) / QUARTER)
    left, right = field.edges[cut, 2], field.edges[cut, 3]
    quarters = np.round((angles[right] - angles[left] - field.turns[cut]) / QUARTER).astype(np.int64) % 4
    return _Cut(copies.reshape(m, 3), count, angles, field.edges[cut], quarters)


def _energy(
    vertices: Vertices, faces: Faces, field: CrossField, cut: _Cut, stiff: FloatArray, density: FloatArray
) -> tuple[sparse.csr_matrix, FloatArray]:
    """Return the matrix (2n, 2n) and the right-hand side (2n,) of the quadratic energy."""
    flat = _flat(vertices, faces, field)
    double = _areas(flat)
    opposite = np.roll(flat, 1, axis=1) - np.roll(flat, -1, axis=1)
    slopes = np.stack([-opposite[..., 1], opposite[..., 0]], axis=2) / double[:, None, None]
    ahead = np.column_stack([np.cos(cut.angles), np.sin(cut.angles)])
    aside = np.column_stack([-ahead[:, 1], ahead[:, 0]])
    m, n = len(faces), cut.size
    along, across = (
        sparse.csr_matrix((np.einsum("fki,fi->fk", slopes, way).ravel(), cut.copies.ravel(), np.arange(0, 3 * m + 1, 3)), shape=(m, n))
        for way in (ahead, aside)
    )
    area = 0.5 * double * stiff
    own = [(one.T @ sparse.diags(area) @ one) for one in (along, across)]
    ridge = sparse.diags(np.bincount(cut.copies.ravel(), np.repeat(area, 3), n) / area.sum()) * RIDGE
    blocks = [own[0] + STRAIGHTNESS * own[1] + ridge, own[1] + STRAIGHTNESS * own[0] + ridge]
    return sparse.block_diag(blocks, format="csr"), np.r_[along.T @ (area * density), across.T @ (area * density)]


def _unit(n: int, copy: int, axis: int) -> sparse.csr_matrix:
    return sparse.csr_matrix(([1.0], ([0], [axis * n + copy])), shape=(1, 2 * n))


def _copies_of(faces: Faces, cut: _Cut, vertex: int) -> IntArray:
    return np.unique(cut.copies[faces == vertex])


def _translation(faces: Faces, cut: _Cut, seam: int, vertex: int) -> list[sparse.csr_matrix]:
    """Return the rows of the shift across a cut edge, right less turned left coordinates, at one of its ends."""
    n = cut.size
    left, right = (int(cut.copies[face][faces[face] == vertex][0]) for face in cut.seams[seam, 2:])
    x, y = np.round([np.cos(QUARTER * cut.quarters[seam]), np.sin(QUARTER * cut.quarters[seam])])
    # Coordinates along directions that are turned by a quarter are the old ones turned back.
    turned = [(x, y), (-y, x)]
    return [_unit(n, right, axis) - a * _unit(n, left, 0) - b * _unit(n, left, 1) for axis, (a, b) in enumerate(turned)]


def _seam_rows(faces: Faces, cut: _Cut) -> list[sparse.csr_matrix]:
    """Return the rows that make the shifts at both ends of every cut edge equal."""
    rows = []
    for seam, (start, end) in enumerate(cut.seams[:, :2].tolist()):
        rows += [a - b for a, b in zip(_translation(faces, cut, seam, start), _translation(faces, cut, seam, end))]
    return rows


def _shifts(faces: Faces, cut: _Cut) -> list[sparse.csr_matrix]:
    """Return the rows of all shifts across cuts; those to singularities are integers by themselves."""
    return [row for seam, start in enumerate(cut.seams[:, 0].tolist()) for row in _translation(faces, cut, seam, start)]


def _rim_rows(
    vertices: Vertices, faces: Faces, field: CrossField, cut: _Cut, sides: list[IntArray], spacing: float
) -> tuple[list[sparse.csr_matrix], list[sparse.csr_matrix]]:
    """Return rows that make a coordinate constant along sides of the rim that run along the crosses, and rows of its values."""
    edges = edge_faces(faces)
    owner = {(a, b): face for a, b, face, right in edges.tolist() if right < 0}
    rows, integers = [], []
    for side in sides:
        ends = np.column_stack([side[:-1], side[1:]])
        owners = np.array([owner[a, b] for a, b in ends.tolist()])
        along = np.einsum("eki,ei->ek", field.axes[owners], vertices[ends[:, 1]] - vertices[ends[:, 0]])
        off = np.arctan2(along[:, 1], along[:, 0]) - cut.angles[owners]
        turns = np.round(off / QUARTER)
        near = np.abs(off - QUARTER * turns) <= RIM_ANGLE
        lengths = np.linalg.norm(along, axis=1)
        breaks = np.flatnonzero(np.diff(near.astype(int))) + 1
        for run in np.split(np.arange(len(ends)), breaks):
            if not near[run[0]] or lengths[run].sum() < MIN_RUN * spacing:
                continue
            for k in run.tolist():
                start, end = (int(cut.copies[owners[k]][faces[owners[k]] == vertex][0]) for vertex in ends[k])
                # Along the first direction the second coordinate is constant, and the other way round.
                axis = 1 - int(turns[k]) % 2
                rows.append(_unit(cut.size, start, axis) - _unit(cut.size, end, axis))
                integers.append(_unit(cut.size, start, axis))
    return rows, integers


def _minimum(quadratic: sparse.csr_matrix, linear: FloatArray, rows: list[sparse.csr_matrix], values: FloatArray) -> FloatArray:
    """Return the minimum (2n,) of a quadratic energy under linear equations, some of which may follow from others."""
    if not rows:
        return factorise(quadratic, symmetric=True).solve(linear)
    fixed = sparse.vstack(rows, format="csr")
    scale = float(quadratic.diagonal().mean())
    slack = sparse.identity(fixed.shape[0]) * (-1e-10 / scale)
    whole = sparse.bmat([[quadratic, fixed.T], [fixed, slack]], format="csr")
    right = np.r_[linear, values]
    solver = factorise(whole)
    found = solver.solve(right)
    # The slack against dependent equations is removed by one more step.
    missed = values - fixed @ found[: len(linear)]
    found = found + solver.solve(np.r_[np.zeros(len(linear)), missed])
    return _centred(found[: len(linear)], fixed)


def _centred(uv: FloatArray, fixed: sparse.csr_matrix) -> FloatArray:
    """Return coordinates (2n,) with the mean 0 of each one that can be shifted without changing products with rows (k, 2n).

    Beside the slack the ridge hardly determines it.
    """
    pair = uv.reshape(2, -1).copy()
    for axis, own in enumerate(pair):
        shift = np.zeros_like(pair)
        shift[axis] = 1.0
        if not np.abs(fixed @ shift.ravel()).any():
            own -= own.mean()
    return pair.ravel()
