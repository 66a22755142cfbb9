"""Surfaces of all regions that meet their tolerances, or one sentence why there are none."""

from __future__ import annotations

from typing import Optional

import numpy as np

from ...errors import MeshError
from ...model.lengths import place_text
from ...model.problem import CGCProblem
from .fit import AWAY_FROM
from .fit import CLOSE
from .fit import LOOSE
from .fit import MAX_CURVATURE_ERROR
from .fit import MAX_GAP
from .fit import MAX_KINK
from .fit import Fit
from .fit import fitted

__all__ = ["region_surfaces"]

# Spans in edge lengths, rows of points per face, and weights, tried in this order.
TRIALS = ((0.5, 3, CLOSE), (0.4, 4, LOOSE), (0.33, 4, LOOSE), (0.4, 4, CLOSE))


def region_surfaces(problem: CGCProblem) -> Fit:
    """Return smooth surfaces of all regions with shared edges.

    Parameters
    ----------
    problem
        A solved problem.

    Raises
    ------
    MeshError
        If a region is not a graph over a plane, or if no fit meets the tolerances.

    Examples
    --------
    >>> import compas_cgc
    >>> result = compas_cgc.solve(compas_cgc.read(compas_cgc.get("facade.3dm")))
    >>> fit = region_surfaces(result.problem)
    >>> len(fit.pieces), bool(fit.gap < 1e-5)
    (3, True)
    """
    fit: Optional[Fit] = None
    for trial in TRIALS:
        found = fitted(problem, *trial)
        if fit is not None and fit.shortfall() <= 1.0 and fit.rank() <= found.rank():
            return fit
        fit = found if fit is None else min(fit, found, key=Fit.rank)
        if fit.meets_aims():
            return fit
    assert fit is not None
    if fit.shortfall() <= 1.0:
        return fit
    size, error, kink = fit.scale, float(fit.percentiles()[1]), float(fit.kink_percentiles()[1])
    reasons = {
        f"they are {1e3 * fit.distance / size:.3g} thousandths of the roof's size from the mesh": fit.distance > fit.reach,
        f"neighbouring surfaces are {1e3 * fit.gap / size:.3g} thousandths of the roof's size apart": fit.gap > MAX_GAP * size,
        f"they kink at smooth seams by {kink:.2g} degrees (95th percentile)": kink > MAX_KINK,
    }
    missed = [reason for reason, missing in reasons.items() if missing]
    if error > MAX_CURVATURE_ERROR:
        missed.append(
            f"K differs from its target by {100 * error:.3g} % (95th percentile {AWAY_FROM}), most at {_place_of_worst(problem, fit)}"
        )
    raise MeshError(
        f"no smooth surfaces of the regions were written, because {' and '.join(missed)}; refine the mesh, or change supports and creases "
        "where the surface bends sharply"
    )


def _place_of_worst(problem: CGCProblem, fit: Fit) -> str:
    """Return the place where K differs most from its target away from singular vertices."""
    worst = fit.away[np.argmax(np.nan_to_num(fit.errors[fit.away]))]
    return place_text(problem.vertices[problem.faces[worst]].mean(axis=0), fit.scale)
