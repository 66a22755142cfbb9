"""Number of moulds against distance: a table and a picture to decide by."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING
from typing import Any
from typing import Optional

from ..errors import CGCError
from ..errors import names_what_was_meant
from .design import DesignInput
from .progress import Watch
from .result import Rationalised
from .run import rationalise

if TYPE_CHECKING:
    from matplotlib.figure import Figure

__all__ = ["MOULDS", "Sweep", "sweep"]

MOULDS = (1, 2, 3, 4, 6, 8, 12)  # numbers of moulds by default


@dataclass(frozen=True, eq=False)
class Sweep:
    """Rationalisations of one design with several numbers of moulds.

    Parameters
    ----------
    results
        One for each number of moulds, in rising order.

    Examples
    --------
    >>> from compas_cgc.rationalisation import sweep
    >>> vertices = [[x, y, 1.0 - 0.02 * (x - 4) ** 2 - 0.03 * (y - 3) ** 2] for x in range(9) for y in range(7)]
    >>> quads = [[7 * i + j, 7 * i + 7 + j, 7 * i + 8 + j, 7 * i + 1 + j] for i in range(8) for j in range(6)]
    >>> found = sweep((vertices, quads), [1, 2], panel=2.0, edges=3)
    >>> [row["moulds"] for row in found.rows()]
    [1, 2]
    """

    results: tuple[Rationalised, ...]

    def rows(self) -> list[dict[str, Any]]:
        """Return moulds, distances, folds and, if given, costs and whether the distance is kept, of every result as plain data."""
        rows = []
        for found in self.results:
            beyond = found.folds.beyond()
            figures = {"moulds": len(found.curvatures), "max": found.distance.largest, "rms": found.distance.rms}
            costs = {} if found.costs is None else {"costs": sum(found.costs_of_parts)}
            kinks = {"kink_largest": beyond["largest"], "kink_median": beyond["median"]}
            kept = {} if found.within is None else {"kept": found.kept}
            rows.append({**figures, **kinks, **costs, **kept, "status": found.result.status})
        return rows

    def pareto(self) -> list[Rationalised]:
        """Return the results of which no other has as few moulds and a smaller distance."""
        best: list[Rationalised] = []
        for found in sorted(self.results, key=lambda own: (len(own.curvatures), own.distance.largest)):
            if found.result.converged and (not best or found.distance.largest < best[-1].distance.largest):
                best.append(found)
        return best

    def __str__(self) -> str:
        unit = self.results[0].design.drawing.units if self.results else None
        head = f"moulds  largest distance  rms  folds beyond the design [deg]{'' if unit is None else f'  ({unit.casefold()})'}"
        lines = [
            f"{row['moulds']:6d}  {row['max']:16.3g}  {row['rms']:.3g}  {row['kink_largest']:.2g}"
            + (f"  costs {row['costs']:,.10g}" if "costs" in row else "")
            + ("  within the distance" if row.get("kept") else "")
            for row in self.rows()
        ]
        return "\n".join([head, *lines])

    def figure(self) -> Figure:
        """Return a picture of distance against moulds, for :func:`compas_cgc.plot.save`.

        Raises
        ------
        CGCError
            If matplotlib is not installed.
        """
        from .._figures import new_figure

        figure = new_figure(6.5, 4.5)
        axes = figure.add_subplot()
        front = self.pareto()
        moulds = [len(found.curvatures) for found in front]
        axes.plot(moulds, [found.distance.largest for found in front], "o-", color="#1a1a1a", label="largest")
        axes.plot(moulds, [found.distance.rms for found in front], "o-", color="#7fa6ad", label="root mean square")
        within = self.results[0].within if self.results else None
        if within is not None:
            axes.axhline(within, color="#b03a2e", linestyle="--", linewidth=1.0, label="allowed")
        unit = self.results[0].design.drawing.units if self.results else None
        axes.set_xlabel("moulds")
        axes.set_ylabel("distance from the design" + (f" [{unit.casefold()}]" if unit else ""))
        axes.set_ylim(bottom=0.0)
        axes.grid(True, color="#e6e6e6", linewidth=0.6)
        axes.legend(frameon=False)
        figure.tight_layout()
        return figure


@names_what_was_meant()
def sweep(design: DesignInput, moulds: Sequence[int] = MOULDS, *, callback: Optional[Watch] = None, **options: Any) -> Sweep:
    """Rationalise a design with several numbers of moulds.

    Parameters
    ----------
    design
        As in :func:`~compas_cgc.rationalise`.
    moulds
        Numbers of moulds.
    callback
        As in :func:`~compas_cgc.rationalise`; a cancelled sweep returns the numbers of moulds that are finished.
    options
        Panels, seams, supports and the like, as in :func:`~compas_cgc.rationalise`.

    Returns
    -------
    Sweep
        With a table and a picture.

    Raises
    ------
    CGCError
        If there are no numbers of moulds, or the design cannot be read.

    Examples
    --------
    >>> sweep("roof.3dm", [2, 4, 8], panel=2.5)  # doctest: +SKIP
    """
    if not len(moulds):
        raise CGCError("a sweep needs numbers of moulds, such as [1, 2, 4, 8]")
    found: list[Rationalised] = []
    for number in sorted(set(moulds)):
        found.append(rationalise(found[0].design if found else design, moulds=number, callback=callback, **options))
        if found[-1].cancelled:
            break
    return Sweep(tuple(found))
