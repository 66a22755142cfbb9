"""Curvature equations of regions whose K is not given, but found with the surface."""

from __future__ import annotations

import copy
from typing import NamedTuple
from typing import Optional

import numpy as np
from scipy import sparse

from ...discrete.arrays import FloatArray
from ...discrete.arrays import IntArray
from ...discrete.jacobian import CurvatureEquations

__all__ = ["CommonPart", "FoundCurvature"]


class CommonPart(NamedTuple):
    """What equations of a group have in common with their areas, which an unknown K takes up.

    The projector ``r_i - A_i (sum r / sum A)`` over a group. Its transpose takes from multipliers their mean, weighed by areas.
    """

    areas: FloatArray  # (k,) times the drawn K, where these keep their ratios
    group: IntArray  # (k,) number of the unknown K, -1 where it is given
    groups: int

    def removed(self, values: FloatArray) -> FloatArray:
        """Return values of the equations (k,) without it."""
        return values - self.areas * self._of_group(self.sums(values) / self.sums(self.areas))

    def transposed(self, multipliers: FloatArray) -> FloatArray:
        """Return multipliers (k,) that do not see it."""
        return multipliers - self._of_group(self.sums(self.areas * multipliers) / self.sums(self.areas))

    def sums(self, values: FloatArray) -> FloatArray:
        """Return the sums over the groups (groups,)."""
        own = self.group >= 0
        return np.bincount(self.group[own], values[own], self.groups).astype(np.float64)

    def _of_group(self, values: FloatArray) -> FloatArray:
        return np.where(self.group >= 0, np.append(values, 0.0)[self.group], 0.0)


class FoundCurvature(CurvatureEquations):
    r"""One equation per vertex, in groups of one unknown K each, which is eliminated.

    Of a shape the K of a group is :math:`\sum d_i / \sum A_i` over its vertices, defects over areas, by which the residuals
    :math:`d_i - K A_i` of the group sum to zero: they are projections of the defects. A K that makes them all zero is met
    exactly when they are zero, and the multipliers of its group, weighed by areas, then sum to zero: no other K is fairer.

    Parameters
    ----------
    faces, targets, rows, columns
        As of :class:`~compas_cgc.discrete.jacobian.CurvatureEquations`; targets of unknown K are first guesses.
    group
        ``(k,)`` number of the unknown K of every row, -1 where K is given.
    rates
        ``(k,)`` K of the rows per unknown: 1, or the drawn K where a group keeps the ratios of these.
    counting
        ``(k,)`` rows that count in the sums; of mirrored equations one of each is enough.
    """

    def __init__(
        self,
        faces: IntArray,
        targets: FloatArray,
        rows: IntArray,
        columns: IntArray,
        group: IntArray,
        rates: FloatArray,
        counting: IntArray,
    ):
        super().__init__(faces, targets, rows, columns)
        self.group, self.rates, self._counting = group, rates, counting
        self.count = int(group.max(initial=-1)) + 1

    def measure(self, vertices: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return the residuals [rad] for the K of the shape, and the mixed areas [L^2], (k,) each."""
        residual, areas = super().measure(vertices)
        shift = self._shift(residual, areas)
        return residual - areas * self._of_rows(shift), areas

    def targets_of(self, vertices: FloatArray) -> FloatArray:
        """Return the targets (n,) with the K of a shape where it is not given."""
        residual, areas = super().measure(vertices)
        targets = self.targets.copy()
        targets[self.rows] += self._of_rows(self._shift(residual, areas))
        return targets

    def jacobian(self, vertices: FloatArray, directions: Optional[FloatArray] = None, areas: bool = True) -> sparse.csr_matrix:
        """Return the derivative of the residuals for the K of the shape as it is; its common part is yet to be removed."""
        return self.given(vertices).jacobian(vertices, directions, areas)

    def given(self, vertices: FloatArray) -> CurvatureEquations:
        """Return the equations with the K of a shape as given."""
        plain = self.guessed()
        plain.targets = self.targets_of(vertices)
        return plain

    def guessed(self) -> CurvatureEquations:
        """Return the equations with the first guesses as given."""
        plain = CurvatureEquations.__new__(CurvatureEquations)
        plain.__dict__.update({name: value for name, value in copy.copy(self.__dict__).items()})
        return plain

    def common(self, areas: FloatArray, leading: IntArray) -> CommonPart:
        """Return the common part of the leading ones of the equations, of a shape with areas (k,)."""
        return CommonPart((self.rates * areas)[leading], self.group[leading], self.count)

    def _shift(self, residual: FloatArray, areas: FloatArray) -> FloatArray:
        part = self.common(areas, self._counting)
        return part.sums(residual[self._counting]) / part.sums(part.areas)

    def _of_rows(self, values: FloatArray) -> FloatArray:
        return np.where(self.group >= 0, self.rates * np.append(values, 0.0)[self.group], 0.0)
