"""Costs of moulds and panels by the kind of mould."""

from __future__ import annotations

from collections.abc import Mapping
from collections.abc import Sequence
from typing import NamedTuple
from typing import Optional

import numpy as np

from ..discrete.arrays import FloatArray
from ..discrete.arrays import IntArray
from ..discrete.arrays import Mask
from ..errors import CGCError

__all__ = ["KINDS", "Allowance", "Costs", "costs_in_order", "costs_of"]

KINDS = ("flat", "sphere", "saddle")  # K = 0, positive and negative


class Costs(NamedTuple):
    """Costs by kind of mould, in any currency."""

    mould: FloatArray  # (3,) of making a mould
    panel: FloatArray  # (3,) of a panel that comes off such a mould

    def parts(self, K: FloatArray, counts: IntArray) -> tuple[float, float]:
        """Return the costs of moulds with K (k,) and of their panels, for numbers of panels (k,); moulds without panels cost nothing."""
        kinds = _kinds(K)
        return float(self.mould[kinds] @ (counts > 0)), float(self.panel[kinds] @ counts)

    def least(self, moulds: int, panels: int, flat: Optional[bool] = None) -> float:
        """Return a lower bound of the costs of numbers of moulds and panels, with one flat mould, without, or, for None, with either."""
        bent = float(self.mould[1:].min())
        with_flat = float(self.mould[0]) + (moulds - 1) * bent + panels * float(self.panel.min())
        without = moulds * bent + panels * float(self.panel[1:].min())
        return min(with_flat, without) if flat is None else with_flat if flat else without


class Allowance(NamedTuple):
    """Allowed distance from the design, and the costs that are minimised within it."""

    limits: FloatArray  # (c,) largest weighted distances, which are the first criteria [L]
    sizes: IntArray  # (p,) number of panels in every group, which change their mould together
    costs: Optional[Costs] = None

    def keeps(self, criteria: FloatArray) -> Mask:
        """Return whether criteria (d,), or each of several (r, d), stay within the limits."""
        return np.asarray((np.abs(criteria[..., : len(self.limits)]) <= self.limits).all(axis=-1))

    def excess(self, criteria: FloatArray) -> float:
        """Return the largest ratio of criteria (d,) to the limits."""
        with np.errstate(divide="ignore", invalid="ignore"):
            ratios = np.abs(criteria[: len(self.limits)]) / self.limits
        return float(np.where(self.limits > 0.0, ratios, np.inf).max(initial=0.0))

    def total(self, K: FloatArray, classes: IntArray) -> float:
        """Return the costs of moulds with K (k,) and of the panels, for the mould of every panel (p,)."""
        if self.costs is None:
            return 0.0
        return sum(self.costs.parts(K, np.bincount(classes, self.sizes, len(K)).astype(np.int64)))

    def least(self, moulds: int, flat: Optional[bool]) -> float:
        """Return a lower bound of the costs for a number of moulds, see :meth:`Costs.least`."""
        return 0.0 if self.costs is None else self.costs.least(moulds, int(self.sizes.sum()), flat)

    def savings(self, K: FloatArray, classes: IntArray) -> FloatArray:
        """Return the savings (p, k) of moving every panel from its mould (p,) to each mould of K (k,)."""
        if self.costs is None:
            return np.zeros((len(classes), len(K)))
        own = self.costs.panel[_kinds(K)]
        return self.sizes[:, None] * (own[classes][:, None] - own)


def costs_of(given: Mapping[str, Sequence[float]]) -> Costs:
    """Return costs from pairs, of a mould and of a panel, by the names of kinds.

    Raises
    ------
    CGCError
        If they are not by kind, a kind is unknown or missing, or a cost is not a number from 0 up.
    """
    if not isinstance(given, Mapping):
        raise CGCError(f"costs must be pairs of numbers by {', '.join(KINDS)}, such as {{'sphere': (8000, 450)}}, not {given!r:.60}")
    if set(given) != set(KINDS):
        raise CGCError(f"costs must be given for {', '.join(KINDS)}, a pair of numbers for each, not for {', '.join(map(str, given))}")
    values = []
    for kind in KINDS:
        try:
            own = np.asarray(given[kind], dtype=np.float64)
            if own.shape != (2,) or not (np.isfinite(own).all() and (own >= 0.0).all()):
                raise ValueError
        except (TypeError, ValueError):
            raise CGCError(f"costs of {kind} must be two numbers from 0 up, of a mould and of a panel, not {given[kind]!r:.60}") from None
        values.append(own)
    return Costs(*np.array(values).T)


def costs_in_order(numbers: Sequence[float]) -> Optional[dict[str, Sequence[float]]]:
    """Return costs by kind from six numbers, pairs for flat, sphere and saddle moulds; None if there are no numbers.

    Raises
    ------
    CGCError
        If there are not six.
    """
    if not len(numbers):
        return None
    if len(numbers) != 2 * len(KINDS):
        raise CGCError(f"costs are six numbers, of a mould and of a panel for flat, sphere and saddle moulds, not {len(numbers)}")
    return {kind: numbers[2 * k : 2 * k + 2] for k, kind in enumerate(KINDS)}


def _kinds(K: FloatArray) -> IntArray:
    """Return the kinds of moulds with K (k,), as positions in KINDS."""
    return np.sign(K).astype(np.int64) % len(KINDS)
