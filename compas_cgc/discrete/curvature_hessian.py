"""Second derivatives of angle defects and mixed areas, by the dot products of the edges that meet at the corners of faces."""

from __future__ import annotations

from typing import Optional

import numpy as np

from .._compiled import kernel
from .arrays import CSRIndices
from .arrays import Faces
from .arrays import FloatArray
from .arrays import Mask
from .arrays import PerVertex
from .arrays import Vectors
from .arrays import Vertices

__all__ = ["CurvatureHessian"]

NEXT, LAST = [1, 2, 0], [2, 0, 1]  # the other corners of each
OTHER = np.array([[0, 2, 1], [2, 1, 0], [1, 0, 2]])  # the third corner of two, or the one of one
PAIRS = ~np.eye(3, dtype=bool)
COLUMNS = np.arange(3)


class CurvatureHessian:
    r"""The second derivative of a weighted sum of ``defect - K area``.

    What is summed depends on a face by the dot products :math:`d_a` of the edges that meet at its corners alone: with the
    squared edges :math:`l_a = d_b + d_c` across from these and twice the area :math:`D^2 = d_0 d_1 + d_1 d_2 + d_2 d_0`,

    .. math:: \frac{\partial \theta_a}{\partial d_b} = \frac{d_a}{2 D l_c}, \qquad
              \frac{\partial D}{\partial d_a} = \frac{l_a}{2 D}, \qquad \cot\theta_c\, l_c = D - \frac{d_a d_b}{D}.

    Parameters
    ----------
    vertices
        ``(n, 3)`` coordinates [L].
    faces
        ``(m, 3)`` vertex indices.
    weights
        ``(n,)`` of the vertices.
    targets
        ``(n,)`` K [1/L^2]. Default: zero, so that no area counts.
    """

    def __init__(self, vertices: Vertices, faces: Faces, weights: PerVertex, targets: Optional[PerVertex] = None):
        self._counted = np.flatnonzero(weights[faces].any(axis=1))
        self._faces = np.ascontiguousarray(faces[self._counted])
        corners = vertices[self._faces]
        self._edges = corners[:, LAST] - corners[:, NEXT]
        d = -np.einsum("fax,fax->fa", self._edges[:, NEXT], self._edges[:, LAST])
        l, square = d[:, NEXT] + d[:, LAST], d[:, 0] * d[:, 1] + d[:, 1] * d[:, 2] + d[:, 2] * d[:, 0]
        flat = ~(square > 0.0) | ~(l > 0.0).all(axis=1)
        # A face without area says nothing.
        d[flat], l[flat], square[flat] = 0.5, 1.0, 0.75
        D = np.sqrt(square)
        w = np.where(flat[:, None], 0.0, weights[self._faces])
        first, second = _of_angles(d, l, D, w)
        if targets is not None:
            of_areas = _of_areas(d, l, D, w * targets[self._faces])
            first, second = first + of_areas[0], second + of_areas[1]
        self._second = second
        # The dot products have second derivatives of their own, the same in all three coordinates.
        self._plain = first[:, OTHER] - first[:, :, None] - first[:, None]
        self._plain[:, range(3), range(3)] = 2.0 * first

    def along(self, moves: Vectors) -> Vectors:
        """Return how the gradient changes along a move (n, 3), (n, 3)."""
        out = np.zeros(moves.shape)
        _add_along(self._faces, self._edges, self._second, self._plain, np.ascontiguousarray(moves), np.empty(3), out)
        return out

    def blocks(self, slots: CSRIndices, size: int) -> FloatArray:
        """Return the blocks (size, 3, 3) by two vertices each, those of the corners of face f in the `slots` (m, 3, 3), -1 for nowhere."""
        E = self._edges
        slopes = np.zeros((len(E), 3, 3, 3))  # of d_a by the corners
        for a, (p, q) in enumerate(zip(NEXT, LAST)):
            slopes[:, a, a], slopes[:, a, p], slopes[:, a, q] = E[:, p] - E[:, q], -E[:, p], E[:, q]
        flat = slopes.reshape(-1, 3, 9)
        values = (flat.transpose(0, 2, 1) @ (self._second @ flat)).reshape(-1, 3, 3, 3, 3).transpose(0, 1, 3, 2, 4)
        values += self._plain[..., None, None] * np.eye(3)
        at = slots[self._counted]
        into = at >= 0
        places = 9 * at[into][:, None] + np.arange(9)
        return np.bincount(places.ravel(), values[into].ravel(), 9 * size).astype(np.float64, copy=False).reshape(size, 3, 3)


def _of_angles(d: FloatArray, l: FloatArray, D: FloatArray, w: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return the first (f, 3) and second derivatives (f, 3, 3) of the weighted sum of defects by the dot products."""
    # The three angles add up to π: what the one at a gains by d_b, that at b loses.
    pull = (w[:, None] - w[:, :, None]) / (2.0 * D[:, None, None] * l[:, OTHER])
    gain = pull * d[:, :, None]
    first = gain.sum(axis=1)
    # By d_x, which moves all squared edges but its own.
    spared = np.where(PAIRS, gain[:, OTHER, COLUMNS] / l[:, :, None], 0.0).transpose(0, 2, 1)
    falls = (0.5 / (D * D))[:, None] * l
    second = pull.transpose(0, 2, 1) + spared - spared.sum(axis=2, keepdims=True) - first[:, :, None] * falls[:, None]
    return first, second


def _of_areas(d: FloatArray, l: FloatArray, D: FloatArray, asked: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return the same of the sum of mixed areas times K and weights (f, 3), with the sign that they have beside defects.

    Mixed areas are ``Σ cot_c l_c / 8`` over the corners c that are not the vertex, or shares of a face with an obtuse angle.
    """
    obtuse = d < 0.0
    plain: Mask = ~np.any(obtuse, axis=1)
    shares = np.where(plain[:, None], 0.125 * (asked[:, NEXT] + asked[:, LAST]), 0.0)
    whole = np.where(plain, shares.sum(axis=1), 0.125 * (asked.sum(axis=1) + (asked * obtuse).sum(axis=1)))
    D1 = l / (2.0 * D)[:, None]
    D2 = (1.0 - np.eye(3)) / (2.0 * D)[:, None, None] - D1[:, :, None] * D1[:, None] / D[:, None, None]
    # The sum of shares times d_a d_b, whose second derivatives are the shares.
    P2 = shares[:, OTHER] * (1.0 - np.eye(3))
    P1 = np.einsum("fab,fb->fa", P2, d)
    P, rate = 0.5 * np.einsum("fa,fa->f", P1, d)[:, None], 1.0 / (D * D)[:, None]
    first = whole[:, None] * D1 + P * rate * D1 - P1 / D[:, None]
    P, rate = P[..., None], rate[..., None]
    mixed = P1[:, :, None] * D1[:, None]
    second = (whole[:, None, None] + P * rate) * D2 + rate * (mixed + mixed.transpose(0, 2, 1)) - P2 / D[:, None, None]
    return -first, -(second - 2.0 * P * rate / D[:, None, None] * D1[:, :, None] * D1[:, None])


@kernel()
def _add_along(F: Faces, E: FloatArray, second: FloatArray, plain: FloatArray, U: Vectors, changes: FloatArray, out: Vectors) -> None:
    """Add the products of the second derivatives with a move U (n, 3) to `out` (n, 3); `changes` (3,) is room to work in."""
    for f in range(F.shape[0]):
        i, j, k = F[f, 0], F[f, 1], F[f, 2]
        for c in range(3):
            p, q = (c + 1) % 3, (c + 2) % 3
            changes[c] = 0.0  # of the dot product at c
            for x in range(3):
                at = U[F[f, c], x]
                changes[c] += E[f, p, x] * (at - U[F[f, p], x]) + E[f, q, x] * (U[F[f, q], x] - at)
        for a in range(3):
            p, q = (a + 1) % 3, (a + 2) % 3
            s = second[f, a, 0] * changes[0] + second[f, a, 1] * changes[1] + second[f, a, 2] * changes[2]
            for x in range(3):
                at_p, at_q = s * E[f, p, x], s * E[f, q, x]
                out[F[f, a], x] += at_p - at_q + plain[f, a, 0] * U[i, x] + plain[f, a, 1] * U[j, x] + plain[f, a, 2] * U[k, x]
                out[F[f, p], x] -= at_p
                out[F[f, q], x] += at_q
