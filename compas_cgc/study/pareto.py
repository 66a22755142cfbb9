"""Pareto front: the non-dominated variants of a study."""

from __future__ import annotations

from typing import TYPE_CHECKING
from typing import Optional

import numpy as np

from .._figures import new_figure
from ..discrete.arrays import FloatArray
from ..discrete.arrays import Indices
from ..discrete.arrays import Mask
from ..errors import CGCError
from ..errors import names_what_was_meant
from .results import Results
from .results import refuse_no_results
from .sheet import COLOURS
from .spec import Ranking

if TYPE_CHECKING:
    from matplotlib.figure import Figure

__all__ = ["non_dominated", "pareto_figure", "pareto_front"]

NAMED = 40  # largest number of variants labelled in the picture


def non_dominated(costs: FloatArray) -> Mask:
    """Return a mask of the non-dominated rows of costs (k, c); equal rows are all included.

    Parameters
    ----------
    costs
        ``(k, c)`` finite costs to minimise.
    """
    order = np.lexsort(costs.T[::-1])
    sorted_costs = costs[order]
    keeps = np.ones(len(costs), bool)
    front = np.empty((0, costs.shape[1]))
    for k, row in enumerate(sorted_costs):
        # Only earlier rows in this order can dominate a row.
        beaten = ((front <= row).all(axis=1) & (front < row).any(axis=1)).any()
        keeps[order[k]] = not beaten
        if not beaten:
            front = np.vstack([front, row])
    return keeps


@names_what_was_meant()
def pareto_front(results: Results, ranking: Optional[Ranking] = None) -> Indices:
    """Return the Pareto front of the good variants (k,), sorted by the first objective.

    Parameters
    ----------
    results
        Results of a study.
    ranking
        The objectives. Default: those of the study.

    Returns
    -------
    (k,) int64
        Numbers of variants.

    Raises
    ------
    CGCError
        If there are no objectives, or a column does not exist.

    Examples
    --------
    >>> pareto_front(results)  # doctest: +SKIP
    """
    refuse_no_results(results)
    ranking = ranking or results.study.pareto
    if not ranking.columns:
        raise CGCError("a Pareto front requires objectives, such as [pareto] least = ['area'], most = ['volume'] in the study")
    good = results.good()
    costs = _costs(results, ranking)[good]
    known = np.isfinite(costs).all(axis=1)
    good, costs = good[known], costs[known]
    front = non_dominated(costs)
    return good[front][np.lexsort(costs[front].T[::-1])]


@names_what_was_meant()
def pareto_figure(results: Results, ranking: Optional[Ranking] = None) -> Figure:
    """Return a picture of all variants by two objectives, with the Pareto front of the good ones.

    A third objective colours the front.

    Parameters
    ----------
    results
        Results of a study.
    ranking
        The objectives. Default: those of the study.

    Returns
    -------
    matplotlib.figure.Figure
        For :func:`compas_cgc.plot.save`.

    Raises
    ------
    CGCError
        If there are fewer than two objectives, a column does not exist, or matplotlib is not installed.

    Examples
    --------
    >>> pareto_figure(results)  # doctest: +SKIP
    """
    ranking = ranking or results.study.pareto
    if len(ranking.columns) < 2:
        raise CGCError("a picture of a Pareto front requires two objectives, such as [pareto] least = ['area', 'rise'] in the study")
    front = pareto_front(results, ranking)
    x, y = (results.numbers(name) for name in ranking.columns[:2])
    figure = new_figure(9.0, 6.5)
    axes = figure.add_subplot()
    status, verdict = np.array(results.column("status"), dtype=object), np.array(results.column("verdict"), dtype=object)
    converged = status == "converged"
    for kind, which in (("unfinished", ~converged), ("rough", converged & (verdict != "fair")), ("fair", converged & (verdict == "fair"))):
        which = which & np.isfinite(x) & np.isfinite(y)
        if which.any():
            axes.scatter(x[which], y[which], s=14, color=COLOURS[kind], label=f"{kind} ({int(which.sum())})", linewidths=0)
    if len(ranking.columns) > 2:
        third = results.numbers(ranking.columns[2])[front]
        marks = axes.scatter(x[front], y[front], s=46, c=third, cmap="viridis", edgecolors="#1a1a1a", linewidths=0.8, zorder=3)
        figure.colorbar(marks, ax=axes, label=_wanted(ranking, 2))
    else:
        axes.plot(x[front], y[front], color="#1a1a1a", linewidth=0.8, zorder=2)
        axes.scatter(x[front], y[front], s=40, facecolors="none", edgecolors="#1a1a1a", linewidths=1.0, zorder=3)
    step = max(1, len(front) // NAMED)
    for variant in front[::step].tolist():
        axes.annotate(str(variant), (x[variant], y[variant]), xytext=(5, 5), textcoords="offset points", fontsize=7)
    axes.set_xlabel(_wanted(ranking, 0))
    axes.set_ylabel(_wanted(ranking, 1))
    axes.set_title(f"{results.folder.name}: {len(front)} of {len(results)} variants are Pareto-optimal", fontsize=11)
    axes.legend(frameon=False, fontsize=9)
    axes.grid(True, color="#e6e6e6", linewidth=0.6)
    axes.set_axisbelow(True)
    figure.tight_layout()
    return figure


def _costs(results: Results, ranking: Ranking) -> FloatArray:
    columns = [results.numbers(name) for name in ranking.least] + [-results.numbers(name) for name in ranking.most]
    return np.column_stack(columns)


def _wanted(ranking: Ranking, k: int) -> str:
    side = "least" if k < len(ranking.least) else "most"
    return f"{ranking.columns[k]} ({side} preferred)"
