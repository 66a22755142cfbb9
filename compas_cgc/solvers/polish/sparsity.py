"""Second derivatives of the Lagrangian, summed up in the slots of the saddle matrix."""

from __future__ import annotations

import copy
from typing import TYPE_CHECKING
from typing import NamedTuple

import numpy as np
from scipy import sparse

from ...discrete import face_normals
from ...discrete.arrays import FloatArray
from ...discrete.arrays import IntArray
from ...discrete.measured_curvature import LEAST_FACES
from ...discrete.measured_curvature import linear_residuals
from ...discrete.mid_edge import OCCURRENCES
from ...discrete.mid_edge import MidEdgeMesh
from ._assembly import add_cells
from ._assembly import slots

if TYPE_CHECKING:
    from .lagrangian import Lagrangian
    from .lagrangian import State

__all__ = ["Model", "Parts", "Pattern"]


class Model(NamedTuple):
    """The Lagrangian to second order about a state, in the free unknowns (q,), then the multipliers (r + k,)."""

    gradient: FloatArray  # (q,) of the energy
    hessian: FloatArray  # entries of the second derivatives, in the slots of the saddle matrix
    convex: FloatArray  # the same of their part that is never negative
    jacobian: sparse.csr_matrix  # (r + k, q) of the equations
    gradients: FloatArray  # entries of the Jacobian in the slots of the saddle matrix


class Parts(NamedTuple):
    """What faces and equations contribute to a model."""

    gradient: FloatArray  # (m, 6) of the energy
    convex: FloatArray  # (m, 6, 6) second derivatives of bending that are never negative
    curved: FloatArray  # (m, 6, 6) all others of a face
    slopes: FloatArray  # (m, 7, 6) of the shape operator times the area, and of the area
    shape_slopes: FloatArray  # (m, 6, 6) of the shape operator
    rows: FloatArray  # (r, 7) derivatives of the residuals by sums of tensors and areas
    row_curvature: FloatArray  # (r, 7, 7) their second derivatives times the multipliers


class _Group(NamedTuple):
    """Pairs whose cells have as many faces and unknowns."""

    faces: IntArray  # (g, k) of the cells
    places: IntArray  # (g, k, 6) of the unknowns of each face among those of the cell
    owned: FloatArray  # (g, k) 1 where the cell is the first of the face, which adds what belongs to the face itself
    row: IntArray  # (g,) equation, -1 without one
    width: int  # number of unknowns of a cell
    even: FloatArray = np.zeros((0, 0, 0))  # (g, k, k) what shape operators of the faces differ from linear functions


class Pattern:
    """Sparsity of the saddle matrix: unknowns of a cell are coupled with each other and with the multiplier of its equation."""

    def __init__(self, lagrangian: Lagrangian):
        mesh, q, r = lagrangian.mesh, lagrangian.size, len(lagrangian.rows)
        reduced = np.full(mesh.unknowns, -1)
        reduced[lagrangian.free] = np.arange(q)
        equation = np.full(len(mesh.pairs), -1)
        equation[lagrangian.rows] = np.arange(r)
        self.size, self.unknowns = q + lagrangian.count, q
        self.groups: list[_Group] = []
        cells: list[IntArray] = []
        for group, unknowns in _groups(mesh, equation):
            self.groups.append(group)
            cells.append(reduced[unknowns])
        folds = reduced[lagrangian.fold_terms(np.zeros(mesh.unknowns))[1]]
        multipliers = [np.where(group.row >= 0, q + group.row, -1)[:, None] for group in self.groups]
        every = np.arange(self.size)[:, None]
        places = np.arange(q + r, self.size)[:, None]
        placed = np.where(lagrangian.conditions.vertices >= 0, reduced[lagrangian.conditions.vertices], -1)
        coupled = _coupled([every, folds, np.hstack([places, placed]), *(np.hstack(both) for both in zip(cells, multipliers))], self.size)
        self.indptr, self.indices = coupled.indptr, coupled.indices
        self.diagonal, self.fold = slots(self.indptr, self.indices, every, every).ravel(), slots(self.indptr, self.indices, folds, folds)
        self.within = [slots(self.indptr, self.indices, cell, cell) for cell in cells]
        self.rows = [slots(self.indptr, self.indices, one, cell)[:, 0] for one, cell in zip(multipliers, cells)]
        self.places = slots(self.indptr, self.indices, places, placed)[:, 0]
        # Entries of the rows of equations, and those across the diagonal.
        mirrored = sparse.csr_matrix((np.arange(len(self.indices)), self.indices, self.indptr), shape=(self.size, self.size)).T.tocsr()
        self.below = np.arange(self.indptr[q], self.indptr[-1])
        self.across = mirrored.data[self.below]

    def copied(self) -> Pattern:
        """Return the same, for another drawing or evenness."""
        other = copy.copy(self)
        other.groups = list(self.groups)
        return other

    def unevenness(self, lagrangian: Lagrangian, areas: FloatArray, evenness: float = 0.0) -> sparse.csr_matrix:
        """Return the quadratic form (m, m) of what values of faces differ from linear functions about every pair."""
        mesh, V = lagrangian.mesh, lagrangian.drawing
        m, centroids = len(mesh.faces), V[mesh.faces].mean(axis=1)
        normals = face_normals(V, mesh.faces)
        total = sparse.csr_matrix((m, m))
        for at, group in enumerate(self.groups):
            g, k = group.faces.shape
            if k < LEAST_FACES:
                continue
            even = linear_residuals(group.faces, areas, centroids, normals)
            share = areas[group.faces].sum(axis=1) / areas.sum()
            even *= np.sqrt(1.0 + evenness**4 / share**2)[:, None, None]
            self.groups[at] = group._replace(even=even)
            square = even.transpose(0, 2, 1) @ even
            rows, columns = np.repeat(group.faces, k, axis=1).ravel(), np.tile(group.faces, (1, k)).ravel()
            total = total + sparse.csr_matrix((square.ravel(), (rows, columns)), shape=(m, m))
        return total.tocsr()

    def matrix(self, model: Model, hessian: FloatArray, shift: float, regularisation: FloatArray) -> sparse.csr_matrix:
        """Return the saddle matrix with some second derivatives, a shift of theirs, and minus a regularisation (r,) below."""
        data = hessian + model.gradients
        data[self.diagonal[: self.unknowns]] += shift
        data[self.diagonal[self.unknowns :]] -= regularisation
        return sparse.csr_matrix((data, self.indices, self.indptr), shape=(self.size, self.size))

    def model(self, lagrangian: Lagrangian, state: State, parts: Parts) -> Model:
        """Sum up what faces and equations contribute."""
        mesh, entries = lagrangian.mesh, len(self.indices)
        whole, fold_columns, fold_weights = lagrangian.fold_terms(state.unknowns)
        whole = whole + np.bincount(mesh.columns.ravel(), parts.gradient.ravel(), mesh.unknowns)
        convex, curved, below = np.zeros((3, entries))
        shape_slopes = parts.shape_slopes * np.sqrt(2.0 * OCCURRENCES)[:, None]
        for group, within, rows in zip(self.groups, self.within, self.rows):
            k, w = group.faces.shape[1], group.width
            add_cells(
                *(group.faces, group.places, group.owned, group.row, group.even),
                *(parts.convex, parts.curved, parts.slopes, shape_slopes, parts.rows, parts.row_curvature, within, rows),
                *(np.empty((w, 7)), np.empty((6 * k, w)), *np.empty((2, w, w)), np.empty((w, 7)), convex, curved, below),
            )
        known = self.places >= 0
        below[self.places[known]] = state.met.place_slopes[known]
        convex += np.bincount(self.fold.ravel(), (fold_weights[:, None] * [1.0, -1.0, -1.0, 1.0]).ravel(), entries)
        convex[self.diagonal[: self.unknowns]] += lagrangian.kept[lagrangian.free]
        q = self.unknowns
        start = int(self.indptr[q])
        J = sparse.csr_matrix((below[start:], self.indices[start:], self.indptr[q:] - start), shape=(self.size - q, self.size))[:, :q]
        both = below + np.bincount(self.across, below[self.below], entries)
        return Model(whole[lagrangian.free], convex + curved, convex, J, both)


def _groups(mesh: MidEdgeMesh, equation: IntArray) -> list[tuple[_Group, IntArray]]:
    """Return the cells by their numbers of faces and unknowns, with the unknowns (g, width) of each."""
    start, face_of = mesh.incidence.indptr, mesh.incidence.indices
    sizes = np.diff(start)
    first = np.full(len(mesh.faces), len(mesh.pairs))
    for corner in range(3):
        first = np.minimum(first, mesh.pair_of[:, corner])
    found = []
    for k in np.unique(sizes).tolist():
        cells = np.flatnonzero(sizes == k)
        faces = face_of[start[cells][:, None] + np.arange(k)]
        flat = mesh.columns[faces].reshape(len(cells), 6 * k)
        order = np.argsort(flat, axis=1, kind="stable")
        ordered = np.take_along_axis(flat, order, axis=1)
        new = np.ones_like(ordered, dtype=bool)
        new[:, 1:] = ordered[:, 1:] != ordered[:, :-1]
        rank = np.cumsum(new, axis=1) - 1
        places = np.empty_like(flat)
        np.put_along_axis(places, order, rank, axis=1)
        for width in np.unique(rank[:, -1] + 1).tolist():
            at = np.flatnonzero(rank[:, -1] + 1 == width)
            columns = np.empty((len(at), width), np.int64)
            np.put_along_axis(columns, places[at], flat[at], axis=1)
            owned = (first[faces[at]] == cells[at][:, None]).astype(np.float64)
            found.append((_Group(faces[at], places[at].reshape(len(at), k, 6), owned, equation[cells[at]], width), columns))
    return found


def _coupled(cells: list[IntArray], size: int) -> sparse.csr_matrix:
    """Return the sparsity (size, size) of matrices that couple the unknowns of every cell (g, k), -1 for none, with each other."""
    count = sum(len(cell) for cell in cells)
    width = np.concatenate([np.full(len(cell), cell.shape[1]) for cell in cells])
    columns = np.concatenate([cell.ravel() for cell in cells])
    row = np.repeat(np.arange(count), width)[columns >= 0]
    columns = columns[columns >= 0]
    of_cells = sparse.csr_matrix((np.ones(len(columns), bool), (row, columns)), shape=(count, size))
    coupled = (of_cells.T @ of_cells).tocsr()
    coupled.sort_indices()
    return coupled
