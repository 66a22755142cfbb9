"""Examples, tables, figures and benchmarks of the paper."""

from __future__ import annotations
