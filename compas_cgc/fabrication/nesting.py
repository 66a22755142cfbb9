"""Nesting of rectangles on sheets (skyline heuristic)."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple
from typing import Optional

__all__ = ["Place", "nest"]


class Place(NamedTuple):
    """Position of a rectangle."""

    sheet: int
    x: float  # lower left corner [L]
    y: float
    turned: bool  # by 90 degrees


def nest(sizes: Sequence[tuple[float, float]], sheet: tuple[float, float], spacing: float = 0.0, turn: bool = True) -> list[Place]:
    """Return positions of rectangles on sheets: the largest first, each as low as possible on the first sheet with room.

    Parameters
    ----------
    sizes
        Length and width of each rectangle [L].
    sheet
        Length and width of the sheets [L].
    spacing
        Distance between rectangles [L]; not applied at the edges of a sheet.
    turn
        Whether rectangles may be rotated by 90 degrees.

    Returns
    -------
    list of Place
        In the order of the rectangles.

    Raises
    ------
    ValueError
        If a rectangle is larger than the sheet.

    References
    ----------
    Jylänki, A thousand ways to pack the bin, 2010: skyline, bottom left.
    """
    order = sorted(range(len(sizes)), key=lambda i: (-max(sizes[i]), -min(sizes[i]), i))
    skylines: list[list[tuple[float, float, float]]] = []  # per sheet: start x, end x, height
    places: dict[int, Place] = {}
    for i in order:
        ways = [(sizes[i], False), (sizes[i][::-1], True)] if turn else [(sizes[i], False)]
        ways = [(size, turned) for size, turned in ways if size[0] <= sheet[0] and size[1] <= sheet[1]]
        if not ways:
            length, width = sizes[i]
            raise ValueError(
                f"piece {i} of {length:.4g} x {width:.4g} does not fit on a sheet of {sheet[0]:g} x {sheet[1]:g}; use larger sheets"
            )
        for number in range(len(skylines) + 1):
            if number == len(skylines):
                skylines.append([(0.0, sheet[0], 0.0)])
            found = _lowest(skylines[number], ways, sheet)
            if found is not None:
                x, y, (length, width), turned = found
                skylines[number] = _raised(skylines[number], x, x + length + spacing, y + width + spacing)
                places[i] = Place(number, x, y, turned)
                break
    return [places[i] for i in range(len(sizes))]


def _lowest(
    skyline: list[tuple[float, float, float]], ways: list[tuple[tuple[float, float], bool]], sheet: tuple[float, float]
) -> Optional[tuple[float, float, tuple[float, float], bool]]:
    best = None
    for size, turned in ways:
        for x, _, _ in skyline:
            if x + size[0] > sheet[0]:
                continue
            y = max(height for start, end, height in skyline if start < x + size[0] and end > x)
            if y + size[1] <= sheet[1]:
                key = (y + size[1], x)
                if best is None or key < best[0]:
                    best = (key, (x, y, size, turned))
    return None if best is None else best[1]


def _raised(skyline: list[tuple[float, float, float]], left: float, right: float, height: float) -> list[tuple[float, float, float]]:
    parts = [(start, min(end, left), own) for start, end, own in skyline if start < left]
    parts.append((left, right, height))
    parts += [(max(start, right), end, own) for start, end, own in skyline if end > right]
    return parts
