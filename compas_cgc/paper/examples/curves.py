"""Example 1: a straight line of 20 edges that becomes an arch."""

from __future__ import annotations

import numpy as np

from ...discrete.arrays import FloatArray

__all__ = ["example1"]


def example1(kind: str = "C1", s: float = 1.0, e: int = 0, crease: bool = True) -> tuple[FloatArray, dict]:
    """Return the points (21, 2) and the arguments of :func:`compas_cgc.solvers.flow.curve_flow`.

    Parameters
    ----------
    kind
        ``"C1"`` with k̄ = 0.2, or ``"C2"`` with k̄ = 1. For C2, μ = 0.05 in the paper is
        ten times the stability limit (half of the squared edge length), so μ = 0.0045 and
        6000 steps are used instead of 500.
    s, e
        Strategy S1 or S2 at the vertex in the centre.
    crease
        Whether the curve may fold there.

    Returns
    -------
    points, arguments
        ``(21, 2)`` and a dict.

    Examples
    --------
    >>> points, arguments = example1()
    >>> points.shape
    (21, 2)
    """
    points = np.column_stack([np.linspace(0.0, 2.0, 21), np.zeros(21)])
    pace = dict(target=0.2, mu=0.05, steps=500) if kind == "C1" else dict(target=1.0, mu=0.0045, steps=6000)
    return points, dict(kind=kind, crease=10 if crease else None, s=s, e=e, **pace)
