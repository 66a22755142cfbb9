"""The equations of a problem, linear about one shape."""

from __future__ import annotations

from typing import NamedTuple
from typing import Optional
from typing import Union

from ...discrete.arrays import FloatArray
from .bordered import Bordered
from .least_norm import LeastNorm
from .least_norm import Preconditioner
from .metric import Metric

__all__ = ["Kept", "Linearised"]


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
