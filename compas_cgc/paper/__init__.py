"""The paper's examples, tables, figures and benchmarks."""

from __future__ import annotations
