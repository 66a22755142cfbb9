"""Numbers of things in words."""

from __future__ import annotations

__all__ = ["counted"]


def counted(number: int, what: str) -> str:
    """Return a number with what it counts, such as ``1 mould`` or ``2 moulds``."""
    return f"{number} {what}{'' if number == 1 else 's'}"
