"""Numbers in text dots and user text."""

from __future__ import annotations

import math
import re
from collections.abc import Mapping
from typing import Optional

__all__ = ["dot_target", "number", "user_number", "user_target"]

_NUMBER = r"[+-]?(?:\d+[.,]?\d*|[.,]\d+)(?:[eE][+-]?\d+)?"
_NAMED = re.compile(rf"^\s*(?:k|target)\s*[=:]\s*({_NUMBER})\s*$", re.IGNORECASE | re.MULTILINE)
_BARE = re.compile(rf"^\s*({_NUMBER})\s*$")


def number(text: str) -> Optional[float]:
    """Return the finite number in a text, with a decimal point or comma, or None."""
    found = _BARE.match(text or "")
    if not found:
        return None
    value = float(found.group(1).replace(",", "."))
    return value if math.isfinite(value) else None


def dot_target(text: str, named: bool = False) -> Optional[float]:
    """Return the target in a dot such as ``K=0.03`` [1/L^2], or None; with `named`, a bare number is none."""
    found = _NAMED.search(text or "")
    if found:
        return number(found.group(1))
    return None if named else number(text)


def user_number(text: Mapping[str, str], *keys: str) -> Optional[float]:
    """Return the number under the first of some keys that user text has, or None."""
    for key in keys:
        if key in text:
            return number(text[key])
    return None


def user_target(text: Mapping[str, str]) -> Optional[float]:
    """Return the target in user text [1/L^2]: under ``K`` or ``target``, in capitals or not."""
    return user_number(text, "k", "target")
