"""What a finished study is looked at by: the contact sheet, the Pareto picture and the best variants as files of their own."""

from __future__ import annotations

from pathlib import Path
from typing import Optional

from .. import io
from .pareto import pareto_figure
from .pareto import pareto_front
from .results import Results
from .sheet import contact_sheet

__all__ = ["best_variants", "write_best", "write_pictures"]

BEST = "best"
FIRST = 3  # of a front, where the study does not say which variants are the best


def write_pictures(results: Results) -> list[Path]:
    """Write the contact sheet, and the Pareto picture where the study says what is wanted; return their paths.

    Raises
    ------
    CGCError
        If matplotlib is not installed.
    """
    from ..plot import save

    written = [save(contact_sheet(results), results.folder / "contact_sheet.png")]
    if len(results.study.pareto.columns) > 1 and len(results.good()):
        written.append(save(pareto_figure(results), results.folder / "pareto.png"))
    return written


def best_variants(results: Results) -> list[int]:
    """Return the variants that the study calls the best: by its ranking, or the first of its Pareto front."""
    if results.study.best.columns:
        return results.best(results.study.best)
    if results.study.pareto.columns:
        return pareto_front(results)[:FIRST].tolist()
    return []


def write_best(results: Results, source: Optional[Path] = None) -> list[Path]:
    """Solve the best variants again and write each as a ``.3dm`` with all that is told of a result; return their paths.

    Parameters
    ----------
    results
        A study.
    source
        The file of the drawing: what else is in a .3dm is kept, where its shape is not varied.

    Raises
    ------
    CGCError
        If rhino3dm is not installed.
    """
    kept = source if not any(own.is_shape for own in results.study.parameters) else None
    written = []
    for variant in best_variants(results):
        path = results.folder / BEST / f"variant-{variant:04d}.3dm"
        path.parent.mkdir(exist_ok=True)
        io.write(path, results.plan.solve(variant), source=kept)
        written.append(path)
    return written
