"""Outputs of a finished study: contact sheet, Pareto picture, and files of the best variants."""

from __future__ import annotations

from pathlib import Path
from typing import Optional

from .. import io
from ..rationalisation import Rationalised
from ..rationalisation.files import write_rationalised
from .pareto import pareto_figure
from .pareto import pareto_front
from .results import Results
from .sheet import contact_sheet

__all__ = ["best_variants", "write_best", "write_pictures"]

BEST = "best"
FIRST = 3  # number of best variants taken from the Pareto front if the study has no ranking


def write_pictures(results: Results) -> list[Path]:
    """Write the contact sheet, and the Pareto picture if the study has objectives; return their paths.

    Variants of a design have no contact sheet: their surfaces are not kept.

    Raises
    ------
    CGCError
        If matplotlib is not installed.
    """
    from ..plot import save

    written = [] if results.of_design else [save(contact_sheet(results), results.folder / "contact_sheet.png")]
    if len(results.study.pareto.columns) > 1 and len(results.good()):
        written.append(save(pareto_figure(results), results.folder / "pareto.png"))
    return written


def best_variants(results: Results) -> list[int]:
    """Return the best variants: by the ranking of the study, or the first ones of its Pareto front."""
    if results.study.best.columns:
        return results.best(results.study.best)
    if results.study.pareto.columns:
        return pareto_front(results)[:FIRST].tolist()
    return []


def write_best(results: Results, source: Optional[Path] = None) -> list[Path]:
    """Solve the best variants again and write each result as a ``.3dm`` file; return their paths.

    Parameters
    ----------
    results
        A study.
    source
        File of the drawing. The other contents of a .3dm file are kept if the shape is not varied.

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
        found = results.plan.solve(variant)
        if isinstance(found, Rationalised):
            of_design = source if source is not None and source.suffix.lower() == ".3dm" else None
            write_rationalised(path, found, found.to_dict(), of_design)
        else:
            io.write(path, found, source=kept)
        written.append(path)
    return written
