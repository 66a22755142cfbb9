"""Least-norm moves for sparse equations together with a few dense ones, such as that of a volume."""

from __future__ import annotations

from functools import cached_property
from typing import NamedTuple
from typing import Optional
from typing import Union

import numpy as np

from ...discrete.arrays import FloatArray
from ..constants import TIGHT_RESIDUAL
from .least_norm import Cheapest
from .least_norm import LeastNorm
from .least_norm import Preconditioner
from .least_norm import Rows
from .metric import Metric

__all__ = ["Bordered", "Kept", "Linearised"]

# square of what sparse equations leave of a dense one, relative to all of it, that counts as zero; a sine of 3e-6, as drawings are
# accurate
STUCK = 1e-11


class Bordered:
    r"""Solves ``J dz = b, G dz = c`` by the moves that are cheapest in a metric, for a few dense rows G.

    Of every dense row the move :math:`u_j` along it that J does not see is found once; the small matrix
    :math:`G U`, Schur's complement, then says how much of each is needed beside the cheapest move for J alone.

    Parameters
    ----------
    sparse
        The solver for the sparse rows.
    dense
        ``(g, q)`` G.
    """

    def __init__(self, sparse: LeastNorm, dense: FloatArray):
        self._sparse, self._dense = sparse, dense
        self._k = sparse.J.shape[0]
        self.metric = sparse.metric
        k, g, q = self._k, len(dense), dense.shape[1]
        self.J = Rows((k + g, q), lambda v: np.concatenate([sparse.J @ v, dense @ v]))
        self.transposed = Rows((q, k + g), lambda y: sparse.transposed @ y[:k] + y[k:] @ dense)

    @property
    def preconditioner(self) -> Optional[Preconditioner]:
        """That of the sparse rows."""
        return self._sparse.preconditioner

    def cheapest(self, right: FloatArray, tolerance: float, floor: float = 0.0) -> Cheapest:
        """Return the cheapest move that fulfils the equations, see :meth:`LeastNorm.cheapest`."""
        k = self._k
        found = self._sparse.cheapest(right[:k], tolerance, floor)
        moves, multipliers, weigh = self._unseen
        share = weigh @ (right[k:] - self._dense @ found.move)
        move = found.move + share @ moves
        return Cheapest(move, np.concatenate([found.multipliers - share @ multipliers, share]), right - self.J @ move)

    def without_effect(self, gradient: FloatArray, tolerance: float) -> tuple[FloatArray, FloatArray]:
        """Return the part of the move ``W⁻¹ gradient`` that no row sees (q,), and the multipliers that do so (k + g,)."""
        move = self.metric.solve(gradient)
        found = self.cheapest(self.J @ move, tolerance)
        return move - found.move, found.multipliers

    @cached_property
    def _unseen(self) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Return the moves (g, q) along the dense rows that J does not see, their multipliers (g, k), and the inverse of G U (g, g)."""
        found = [self._sparse.without_effect(row, TIGHT_RESIDUAL) for row in self._dense]
        moves, multipliers = np.array([move for move, _ in found]), np.array([own for _, own in found])
        gram = self._dense @ moves.T
        gram = 0.5 * (gram + gram.T)
        scale = np.sqrt([max(float(row @ self.metric.solve(row)), 1e-300) for row in self._dense])
        value, vector = np.linalg.eigh(gram / np.outer(scale, scale))
        inverse = np.where(value > STUCK, 1.0 / np.where(value > STUCK, value, 1.0), 0.0)
        return moves, multipliers, (vector * inverse) @ vector.T / np.outer(scale, scale)


class Kept(NamedTuple):
    """A preconditioner, for the next steps in the same metric."""

    metric: Metric
    preconditioner: Optional[Preconditioner]


class Linearised(NamedTuple):
    """What first derivatives say about moves from a shape; q of them are free, k equations are asked."""

    solver: Union[LeastNorm, Bordered]  # of J dz = b
    onto: Optional[FloatArray]  # (3c,) fair move onto the constraints, None without any
    right: FloatArray  # (k,) what J dz has to be for the equations to be fulfilled [rad]

    @property
    def kept(self) -> Kept:
        """What to keep for the next shape."""
        return Kept(self.solver.metric, self.solver.preconditioner)

    def reduced(self, gradient: FloatArray) -> FloatArray:
        """Return a gradient by the coordinates (3c,) as one by the free directions (q,)."""
        basis = self.solver.metric.basis
        return gradient if basis is None else basis.T @ gradient

    def expanded(self, move: FloatArray) -> FloatArray:
        """Return a move in the free directions (q,) by its coordinates (3c,)."""
        basis = self.solver.metric.basis
        return move if basis is None else basis @ move

    def landing(self, move: FloatArray) -> FloatArray:
        """Return the coordinates (3c,) of a move in the free directions (q,) together with that onto the constraints."""
        return self.expanded(move) if self.onto is None else self.onto + self.expanded(move)
