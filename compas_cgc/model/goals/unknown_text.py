"""Unknown K as text, for the command line and for user text of drawn objects: ``0,2 ratio + 0.01..0.05``."""

from __future__ import annotations

from typing import Any

from .numbers import ALL
from .wholes import Unknown

__all__ = ["unknown_data", "unknown_text"]

SIGNS = {"+": 1, "-": -1}


def unknown_data(text: str) -> dict[str, Any]:
    """Return the plain data of a goal Unknown written as text.

    Parameters
    ----------
    text
        Numbers of regions joined by commas, or ``all``; after spaces ``ratio`` where they keep the ratios of their drawn values, ``+``
        or ``-`` for the sign, and the least and the largest K joined by two dots [1/L^2].

    Raises
    ------
    ValueError
        If it reads otherwise.
    """
    regions, *rest = text.replace(";", ",").replace(", ", ",").split() or ["none"]
    data: dict[str, Any] = {"kind": "unknown"}
    try:
        data["regions"] = ALL if regions.casefold() == ALL else [int(part) for part in regions.strip(",").split(",")]
        for word in rest:
            least, dots, largest = word.partition("..")
            if word.casefold() == "ratio":
                data["ratio"] = True
            elif dots:
                data["bounds"] = [float(least), float(largest)]
            else:
                data["sign"] = SIGNS[word]
    except (KeyError, ValueError):
        mend = "write numbers of regions or all, then if needed ratio, + or -, and bounds, such as 0,2 ratio 0.01..0.05"
        raise ValueError(f"unknown K cannot be {text!r:.60}; {mend}") from None
    return data


def unknown_text(goal: Unknown) -> str:
    """Return a goal Unknown as text that :func:`unknown_data` reads."""
    words = [ALL if isinstance(goal.regions, str) else ",".join(map(str, goal.regions))]
    words += ["ratio"] if goal.ratio else []
    words += [word for word, sign in SIGNS.items() if sign == goal.sign]
    words += [] if goal.bounds is None else ["..".join(repr(float(end)) for end in goal.bounds)]
    return " ".join(words)
