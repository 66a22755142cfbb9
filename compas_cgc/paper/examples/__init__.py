"""Examples of the paper: meshes, settings and published values."""

from __future__ import annotations

from .catalogue import CATALOGUE
from .catalogue import CurveExample
from .catalogue import SurfaceExample
from .catalogue import examples_of
from .cone import example5
from .curves import example1
from .grids import example2
from .grids import example3
from .grids import example4
from .grids import table2
from .octants import example7
from .plan import example6

__all__ = [
    "CATALOGUE",
    "CurveExample",
    "SurfaceExample",
    "example1",
    "example2",
    "example3",
    "example4",
    "example5",
    "example6",
    "example7",
    "examples_of",
    "table2",
]
