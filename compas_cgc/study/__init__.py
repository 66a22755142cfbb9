"""Studies: many variants of one drawing, solved, judged and written as they come.

A :class:`Study` says what is varied and how it is sampled; :func:`run_study` solves every variant, on worker processes of this
machine or of others, and :class:`Results` reads what is there, of a study that still runs too.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from .._lazy import attach

if TYPE_CHECKING:
    from .pareto import pareto_figure
    from .pareto import pareto_front
    from .results import Results
    from .run import run_study
    from .sheet import contact_sheet
    from .spec import Study
    from .spec import read_study

__all__ = ["Results", "Study", "contact_sheet", "pareto_figure", "pareto_front", "read_study", "run_study"]

__getattr__, __dir__ = attach(
    __name__,
    {
        "Results": ".results",
        "Study": ".spec",
        "contact_sheet": ".sheet",
        "pareto_figure": ".pareto",
        "pareto_front": ".pareto",
        "read_study": ".spec",
        "run_study": ".run",
    },
)
