"""Reproduction of the paper: examples are solved, recorded, drawn and compared with published values."""

from __future__ import annotations

from .run import CurveRun
from .run import SurfaceRun
from .run import run_example
from .run import run_table2
from .run import warm_up
from .tables import report
from .write import comparison_figures
from .write import write_run

__all__ = ["CurveRun", "SurfaceRun", "comparison_figures", "report", "run_example", "run_table2", "warm_up", "write_run"]
