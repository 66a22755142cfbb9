"""What ends a branch of fair surfaces whose targets grow: a fold, a bifurcation, the loss of fairness, or the plan."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ..discrete.arrays import FloatArray

__all__ = ["BIFURCATION", "ENDS", "FOLD", "PLAN", "ROUGH", "folds_back", "rates"]

FOLD, BIFURCATION, ROUGH, PLAN = "fold", "bifurcation", "rough", "plan"
# Why no fair surface with a larger K was found, as messages state it.
ENDS = {
    FOLD: "the branch of these surfaces folds back there, and they would snap to others",
    BIFURCATION: "they become unstable there, at a bifurcation, and would snap to others",
    ROUGH: "they become rough",
    PLAN: "over this convex plan no surface has a larger K, on any mesh",
}
LAST = 3  # rates by which a fold is known [rates]; fewer hardly differ from noise, earlier ones are far from the end
# power of the distance from the end with which rates grow, below which that is a fold; halfway from 0 to -1/2, the one at a fold
EXPONENT = -0.25


def rates(factors: Sequence[float], surfaces: Sequence[FloatArray]) -> FloatArray:
    """Return how fast surfaces move with the logarithm of the factors on their targets, between each and the next (k - 1,) [L].

    Parameters
    ----------
    factors
        ``(k,)``, increasing.
    surfaces
        ``(k, n, 3)`` [L].
    """
    moves = [float(np.linalg.norm(after - before, axis=1).max()) for before, after in zip(surfaces[:-1], surfaces[1:])]
    return np.asarray(np.array(moves) / np.diff(np.log(factors)), dtype=np.float64)


def folds_back(factors: Sequence[float], surfaces: Sequence[FloatArray], end: float) -> bool:
    """Return whether a branch of surfaces folds back at its end.

    There they move ever faster, by the root of the distance from it. Where they only become unstable, they keep their pace.

    Parameters
    ----------
    factors
        ``(k,)`` on the targets, increasing.
    surfaces
        ``(k, n, 3)`` [L].
    end
        Factor at the end of the branch, larger than all of these.

    References
    ----------
    Keller, *Lectures on Numerical Methods in Bifurcation Problems*, 1987, chapter 2.
    """
    pace = rates(factors, surfaces)[-LAST:]
    if len(pace) < LAST or not (pace > 0.0).all():
        return False
    places = np.log(factors[-LAST - 1 :])
    left = np.log(end) - 0.5 * (places[1:] + places[:-1])
    return float(np.polyfit(np.log(left), np.log(pace), 1)[0]) < EXPONENT
