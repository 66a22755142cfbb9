"""Energy and curvature equations of a surface by mid-edge normals, with exact first and second derivatives."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from scipy import sparse

from ...discrete.arrays import FloatArray
from ...discrete.arrays import IntArray
from ...discrete.arrays import Mask
from ...discrete.mid_edge import OCCURRENCES
from ...discrete.mid_edge import TRACE
from ...discrete.mid_edge import MidEdgeMesh
from ...discrete.mid_edge import ShapeOperators
from ...discrete.mid_edge import determinants

__all__ = ["Lagrangian", "Model", "State"]

DETERMINANT = np.outer(TRACE, TRACE) - np.diag(OCCURRENCES)  # second derivative of the second invariant of a packed matrix


class State(NamedTuple):
    """Unknowns and what they give."""

    unknowns: FloatArray  # (u,) moves of the vertices [L], then angles [rad]
    operators: ShapeOperators
    energy: float
    residuals: FloatArray  # (r,) integrals of K - K̄ over the cells of the equations [rad]

    def merit(self, weight: float) -> float:
        """Return the energy plus a weight times the sum of the absolute residuals."""
        return self.energy + weight * float(np.abs(self.residuals).sum())


class Model(NamedTuple):
    """The Lagrangian to second order about a state, in the free unknowns (q,), then the multipliers (r,)."""

    gradient: FloatArray  # (q,) of the energy
    hessian: FloatArray  # entries of the second derivatives, in the slots of the saddle matrix
    convex: FloatArray  # the same of their part that is never negative
    jacobian: sparse.csr_matrix  # (r, q) of the residuals
    gradients: FloatArray  # entries of the Jacobian in the slots of the saddle matrix


class Lagrangian:
    r"""Bending, folding and the curvature equations of one problem.

    .. math:: E = \sum_f w_f A_f |S_f|^2 + \frac1\ell \sum_e l_e \vartheta_e^2, \qquad
              r_p = A_p (K_p - \bar K_p) = \frac{\det T_p}{A_p} - \bar K_p A_p,

    with the folds :math:`\vartheta_e` of crease edges, and with the sums :math:`T_p` of :math:`A_f S_f` and :math:`A_p` of areas
    over the faces of every pair of vertex and region.

    Parameters
    ----------
    mesh
        Triangles, angles and directions.
    drawing
        ``(n, 3)`` the vertices before they move [L].
    free
        ``(n,)`` vertices that move.
    targets
        ``(p,)`` K̄ of the pairs, NaN where no equation holds [1/L^2].
    weights
        ``(m,)`` of the bending of the faces.
    fold_length
        ℓ: a strip of this width beside a crease bends as easily as the crease folds [L].
    """

    def __init__(
        self, mesh: MidEdgeMesh, drawing: FloatArray, free: Mask, targets: FloatArray, weights: FloatArray, fold_length: float
    ):  # fmt: skip
        self.mesh, self.drawing, self.weights = mesh, drawing, weights
        self.rows: IntArray = np.flatnonzero(np.isfinite(targets))
        self.targets = targets[self.rows]
        self.free: IntArray = np.concatenate([np.flatnonzero(free), np.arange(len(drawing), mesh.unknowns)])
        self.moves = int(free.sum())  # of the free unknowns, those that are moves come first
        ends = drawing[mesh.angles.ends[mesh.angles.folds[:, 0]]]
        self._fold_columns = len(drawing) + mesh.angles.folds
        self._fold_weights = 2.0 / fold_length * np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1)
        areas = mesh.at(drawing, np.zeros(len(mesh.angles.ends))).areas
        self.cells: FloatArray = (mesh.incidence @ areas)[self.rows]
        self.pattern = _Pattern(self)

    @property
    def size(self) -> int:
        """Number of free unknowns."""
        return len(self.free)

    def vertices(self, unknowns: FloatArray) -> FloatArray:
        """Return the vertices (n, 3) for unknowns (u,)."""
        n = len(self.drawing)
        return self.drawing + unknowns[:n, None] * self.mesh.directions

    def at(self, unknowns: FloatArray) -> State:
        """Return energy and residuals for unknowns (u,)."""
        operators = self.mesh.at(self.vertices(unknowns), unknowns[len(self.drawing) :])
        averages = self.mesh.averages(operators)
        T, A = averages.tensors[self.rows], averages.areas[self.rows]
        folds = self.folds(unknowns)
        energy = float(self.weights @ operators.bending + 0.5 * (self._fold_weights @ folds**2))
        return State(unknowns, operators, energy, determinants(T) / A - self.targets * A)

    def folds(self, unknowns: FloatArray) -> FloatArray:
        """Return the folds of the crease edges (c,) [rad]."""
        return np.asarray(unknowns[self._fold_columns] @ [1.0, -1.0])

    def moved(self, state: State, step: FloatArray) -> State:
        """Return the state after a step of the free unknowns (q,)."""
        unknowns = state.unknowns.copy()
        unknowns[self.free] += step
        return self.at(unknowns)

    def model(self, state: State, multipliers: FloatArray) -> Model:
        """Return the Lagrangian to second order for multipliers (r,)."""
        mesh, own = self.mesh, state.operators
        T, A, w = own.tensors, own.areas, self.weights
        by_tensor, by_area = (2.0 * w / A)[:, None] * OCCURRENCES * T, -w * own.bending / A
        # By entries of T and A: the bending of a face is convex in both.
        second = np.zeros((len(A), 7, 7))
        second[:, range(6), range(6)] = (2.0 * w / A)[:, None] * OCCURRENCES
        second[:, :6, 6] = second[:, 6, :6] = -by_tensor / A[:, None]
        second[:, 6, 6] = 2.0 * w * own.bending / A**2
        slopes = np.zeros((len(A), 7, 6))
        slopes[:, :6], slopes[:, 6, :3] = own.tensor_slopes, own.area_slopes
        convex = slopes.transpose(0, 2, 1) @ second @ slopes
        gradient = np.einsum("me,mek->mk", by_tensor, own.tensor_slopes)
        gradient[:, :3] += by_area[:, None] * own.area_slopes

        averages = mesh.averages(own)
        T, A = averages.tensors[self.rows], averages.areas[self.rows]
        det, weight = determinants(T), multipliers[:, None]
        row_by_tensor, row_by_area = (T @ DETERMINANT) / A[:, None], -det / A**2 - self.targets
        curved = np.zeros((len(A), 7, 7))
        curved[:, :6, :6] = DETERMINANT / A[:, None, None]
        curved[:, :6, 6] = curved[:, 6, :6] = -row_by_tensor / A[:, None]
        curved[:, 6, 6] = 2.0 * det / A**3
        onto = mesh.incidence[self.rows].T
        own_curved = own.second_derivatives(by_tensor + onto @ (weight * row_by_tensor), by_area + onto @ (multipliers * row_by_area))
        rows = np.column_stack([row_by_tensor, row_by_area])
        return self.pattern.model(self, state, gradient, convex, own_curved, slopes, rows, curved * weight[..., None])

    def fold_terms(self, unknowns: FloatArray) -> tuple[FloatArray, IntArray, FloatArray]:
        """Return the derivative of the fold energy by all unknowns (u,), and columns (c, 2) and weights (c,) of its second one."""
        pull = (self._fold_weights * self.folds(unknowns))[:, None] * [1.0, -1.0]
        gradient = np.bincount(self._fold_columns.ravel(), pull.ravel(), len(unknowns)).astype(np.float64, copy=False)
        return gradient, self._fold_columns, self._fold_weights


class _Group(NamedTuple):
    """Pairs whose cells have as many faces and unknowns."""

    faces: IntArray  # (g, k) of the cells
    places: IntArray  # (g, k, 6) of the unknowns of each face among those of the cell
    owned: FloatArray  # (g, k) 1 where the cell is the first of the face, which adds what belongs to the face itself
    row: IntArray  # (g,) equation, -1 without one
    width: int  # number of unknowns of a cell


class _Pattern:
    """Sparsity of the saddle matrix: unknowns of a cell are coupled with each other and with the multiplier of its equation."""

    def __init__(self, lagrangian: Lagrangian):
        mesh, q, r = lagrangian.mesh, lagrangian.size, len(lagrangian.rows)
        reduced = np.full(mesh.unknowns, -1)
        reduced[lagrangian.free] = np.arange(q)
        equation = np.full(len(mesh.pairs), -1)
        equation[lagrangian.rows] = np.arange(r)
        self.size, self.unknowns = q + r, q
        self.groups: list[_Group] = []
        cells: list[IntArray] = []
        for group, unknowns in _groups(mesh, equation):
            self.groups.append(group)
            cells.append(reduced[unknowns])
        diagonal = np.arange(q + r)
        folds = reduced[lagrangian.fold_terms(np.zeros(mesh.unknowns))[1]]
        within = [_keys(cell[:, :, None], cell[:, None, :], self.size) for cell in cells]
        multiplier = [np.where(group.row >= 0, q + group.row, -1)[:, None] for group in self.groups]
        rows = [_keys(one, cell, self.size) for one, cell in zip(multiplier, cells)]
        columns = [_keys(cell, one, self.size) for one, cell in zip(multiplier, cells)]
        fold = _keys(folds[:, [0, 1, 0, 1]], folds[:, [0, 1, 1, 0]], self.size)
        parts = [diagonal * (self.size + 1), fold, *within, *rows, *columns]
        keys, slots = np.unique(np.concatenate([part.ravel() for part in parts]), return_inverse=True)
        first = int(keys[0] < 0)  # entries of vertices that do not move
        self.indptr = np.searchsorted(keys[first:], np.arange(self.size + 1) * self.size).astype(np.int32)
        self.indices = (keys[first:] % self.size).astype(np.int32)
        slots = slots.ravel() - first
        ends = np.cumsum([part.size for part in parts])
        cut = np.split(slots, ends[:-1])
        k = len(self.groups)
        self.diagonal, self.fold, self.within = cut[0], cut[1], np.concatenate(cut[2 : 2 + k])
        self.rows, self.columns = np.concatenate(cut[2 + k : 2 + 2 * k]), np.concatenate(cut[2 + 2 * k :])

    def matrix(self, model: Model, hessian: FloatArray, shift: float, regularisation: FloatArray) -> sparse.csr_matrix:
        """Return the saddle matrix with some second derivatives, a shift of theirs, and minus a regularisation (r,) below."""
        data = hessian + model.gradients
        data[self.diagonal[: self.unknowns]] += shift
        data[self.diagonal[self.unknowns :]] -= regularisation
        return sparse.csr_matrix((data, self.indices, self.indptr), shape=(self.size, self.size))

    def model(
        self,
        lagrangian: Lagrangian,
        state: State,
        gradient: FloatArray,
        convex: FloatArray,
        own_curved: FloatArray,
        slopes: FloatArray,
        rows: FloatArray,
        curved: FloatArray,
    ) -> Model:  # fmt: skip
        """Sum up what faces (m, ...) and equations (r, ...) contribute."""
        mesh, entries = lagrangian.mesh, len(self.indices)
        whole, fold_columns, fold_weights = lagrangian.fold_terms(state.unknowns)
        whole = whole + np.bincount(mesh.columns.ravel(), gradient.ravel(), mesh.unknowns)
        plain, bent, lines = [], [], []
        for group in self.groups:
            g, k = group.faces.shape
            at = np.arange(g)[:, None]
            G = np.zeros((g, group.width, 7))
            C, H = np.zeros((2, g, group.width, group.width))
            for j in range(k):
                face, place = group.faces[:, j], group.places[:, j]
                block = at[..., None], place[:, :, None], place[:, None, :]
                C[block] += group.owned[:, j, None, None] * convex[face]
                H[block] += group.owned[:, j, None, None] * own_curved[face]
                G[at, place] += slopes[face].transpose(0, 2, 1)
            has = (group.row >= 0)[:, None]
            H += np.where(has[..., None], (G @ np.where(has[..., None], curved[group.row], 0.0)) @ G.transpose(0, 2, 1), 0.0)
            lines.append(np.where(has, np.einsum("gse,ge->gs", G, rows[group.row]), 0.0).ravel())
            plain.append(C.ravel())
            bent.append(H.ravel())
        line = np.concatenate(lines)
        folding = np.bincount(self.fold, (fold_weights[:, None] * [1.0, 1.0, -1.0, -1.0]).ravel(), entries)
        convex_data = _summed(self.within, np.concatenate(plain), entries) + folding
        below, beside = _summed(self.rows, line, entries), _summed(self.columns, line, entries)
        q = self.unknowns
        start = int(self.indptr[q])
        J = sparse.csr_matrix((below[start:], self.indices[start:], self.indptr[q:] - start), shape=(self.size - q, self.size))[:, :q]
        hessian = convex_data + _summed(self.within, np.concatenate(bent), entries)
        return Model(whole[lagrangian.free], hessian, convex_data, J, below + beside)


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


def _keys(row: IntArray, column: IntArray, size: int) -> IntArray:
    """Return the keys of entries, -1 where either is none."""
    return np.where((row >= 0) & (column >= 0), row * size + column, -1)


def _summed(slots: IntArray, values: FloatArray, entries: int) -> FloatArray:
    """Return the sums of values by slot, without those of the slot -1."""
    return np.bincount(slots + 1, values, entries + 1)[1:].astype(np.float64, copy=False)
