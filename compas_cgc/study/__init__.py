"""Studies: many variants of one drawing, solved, judged and written as they come.

A :class:`Study` says what is varied and how it is sampled; :func:`run_study` solves every variant, on worker processes of this
machine or of others, and :class:`Results` reads what is there, of a study that still runs too.
"""

from __future__ import annotations

from .._lazy import attach

# What is public is listed in __init__.pyi, for type checkers too.
__getattr__, __dir__, __all__ = attach(__name__, __file__)
