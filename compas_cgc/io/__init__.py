"""Files in and out: a problem of any format, and what was made of it."""

from __future__ import annotations

from .reading import ReadProblem
from .registry import SUFFIXES
from .registry import known_suffix
from .registry import read
from .registry import read_mesh
from .registry import read_problem
from .registry import write

__all__ = ["SUFFIXES", "ReadProblem", "known_suffix", "read", "read_mesh", "read_problem", "write"]
