"""Numbers of things in words."""

from __future__ import annotations

from collections.abc import Sequence

__all__ = ["counted", "listed"]

MAX_LISTED = 20  # names in a sentence; longer sentences are not read


def counted(number: int, what: str) -> str:
    """Return a number with what it counts, such as ``1 mould`` or ``2 moulds``."""
    return f"{number} {what}{'' if number == 1 else 's'}"


def listed(names: Sequence[str], where: str) -> str:
    """Return names as a list in a sentence, the first of many with the number of others and where these are found."""
    others = len(names) - MAX_LISTED
    return ", ".join(names[:MAX_LISTED]) + (f" and {counted(others, 'other')} ({where})" if others > 0 else "")
