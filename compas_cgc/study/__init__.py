"""Studies: many variants of one drawing, solved, judged and written in order.

A :class:`Study` defines the parameters and their sampling. :func:`run_study` solves every variant, on worker processes of this
machine or of others. :class:`Results` reads the results, also of a running study.
"""

from __future__ import annotations

from .._lazy import attach

# What is public is listed in __init__.pyi, for type checkers too.
__getattr__, __dir__, __all__ = attach(__name__, __file__)
