"""Parameters of which most run nightly."""

from __future__ import annotations

from collections.abc import Iterable

import pytest


def push_only(cases: Iterable, *quick: object) -> list:
    """Return the cases as parameters; all but the quick ones run nightly."""
    return [case if case in quick else pytest.param(case, marks=pytest.mark.nightly) for case in cases]
