"""Key of a picture: scale, north and K, as lines and texts."""

from __future__ import annotations

from typing import NamedTuple
from typing import Optional

import numpy as np

from ..discrete.arrays import FloatArray
from ..errors import names_what_was_meant
from ..model.problem import CGCProblem
from ..model.problem import PosesProblem
from ..model.problem import problem_of
from .drawing import LETTER_WIDTH
from .figures import unit_symbol

__all__ = ["ARROW", "K_MEANING", "Key", "KeyMarks", "curvature_text", "draw_key", "key_of", "north_arrow", "scale_bar"]

BAR_SHARE = 0.25  # largest length of the scale bar, relative to the picture
UPRIGHT = 0.2  # share of north in the plane of the picture below which it points to or from the viewer
BAR_ROOM = 3.2  # space around the length of the scale bar, whose letters may be wide, relative to the height of the texts
ARROW = 2.4  # length of the arrow to north, relative to the height of the texts
K_MEANING = "K: Gaussian curvature, the product of the two principal curvatures; 1/R² on a sphere of radius R, negative on a saddle"
ROW = 2.4  # distance of rows, relative to the height of the texts


class Key(NamedTuple):
    """Content of the key of a picture.

    Parameters
    ----------
    unit
        Symbol of the unit of length, such as ``m``; empty if unknown.
    north
        Direction of north in plan; None for pictures without one, such as a curve.
    words
        Further sentences, such as ``K = 0.02 1/m²``.

    Examples
    --------
    >>> Key("m").north
    (0.0, 1.0)
    """

    unit: str = ""  # symbol of the unit of length, such as ``m``; empty if unknown
    north: Optional[tuple[float, float]] = (0.0, 1.0)  # direction in plan; None for pictures without one
    words: tuple[str, ...] = ()  # further sentences, such as ``K = 0.02 1/m²``


class KeyMarks(NamedTuple):
    """Lines and texts of a key, in units of the picture, with the left end of the scale bar at the origin."""

    lines: list[FloatArray]  # (k, 2) open polylines
    texts: list[tuple[str, FloatArray]]  # each with the left end of its middle line (2,)

    @property
    def right(self) -> float:
        """Right end of the lines [unit of the picture]."""
        return max(float(line[:, 0].max()) for line in self.lines)

    @property
    def left(self) -> float:
        """Left end of the lines and texts [unit of the picture]."""
        return min(float(at) for at in (*(line[:, 0].min() for line in self.lines), *(place[0] for _, place in self.texts)))

    def moved(self, by: FloatArray) -> KeyMarks:
        """Return the marks at another place."""
        return KeyMarks([line + by for line in self.lines], [(text, place + by) for text, place in self.texts])


@names_what_was_meant()
def key_of(surface: PosesProblem) -> Key:
    """Return the key of pictures of a surface: the unit and north of its drawing, and its K.

    Parameters
    ----------
    surface
        A result, mesh or problem.

    Returns
    -------
    Key

    Examples
    --------
    >>> import compas_cgc
    >>> key_of(compas_cgc.read(compas_cgc.get("cushion.3dm"))).words
    ('K = 0.02 1/m²',)
    """
    problem = problem_of(surface, "or a result is drawn")
    K = curvature_text(problem)
    unit = unit_symbol(problem.drawing.units) if problem.drawing.units else ""
    return Key(unit, problem.drawing.north, (f"K = {K}",) if K else ())


def curvature_text(problem: CGCProblem) -> str:
    """Return the range of the target K with its unit, such as ``-0.01 to 0.02 1/m²``; empty if none is prescribed."""
    targets = sorted({K + 0.0 for K in problem.region_targets() if K is not None})
    if not targets:
        return ""
    low, high = (f"{K:.3g}" for K in (targets[0], targets[-1]))
    return f"{low if low == high else f'{low} to {high}'} 1/{unit_symbol(problem.drawing.units)}²"


def draw_key(key: Key, width: float, scale: float, height: float, axes: FloatArray) -> KeyMarks:
    """Return the marks of a key: the scale bar, the arrow to north, and the words, below these if they are wide.

    Parameters
    ----------
    key
        Content of the key.
    width
        Width of the picture [unit of the picture].
    scale
        Units of the picture per unit of length of the surface.
    height
        Height of capitals [unit of the picture].
    axes
        ``(3, 3)`` unit vectors to the right, upwards, and to the viewer.
    """
    marks = scale_bar(key.unit, BAR_SHARE * width / scale, scale, height)
    right = marks.right + height * (BAR_ROOM + LETTER_WIDTH * len(marks.texts[0][0]))
    lines, texts, row = list(marks.lines), list(marks.texts), 0
    if key.north is not None:
        towards = axes @ [*(np.array(key.north) / np.linalg.norm(key.north)), 0.0]
        arrow = north_arrow(towards, height)
        # An arrow to the left, in an elevation, begins with its letter.
        arrow = arrow.moved(np.array([right + max(height, -arrow.left), 0.0]))
        lines, texts = [*lines, *arrow.lines], [*texts, *arrow.texts]
        right = max([arrow.right, *(float(place[0]) + LETTER_WIDTH * height * len(text) for text, place in arrow.texts)]) + 2.0 * height
    for words in key.words:
        if right + LETTER_WIDTH * height * len(words) > width:
            row, right = row + 1, 0.0
        texts.append((words, np.array([right, -row * ROW * height])))
        right += LETTER_WIDTH * height * len(words) + 2.0 * height
    return KeyMarks(lines, texts)


def scale_bar(unit: str, longest: float, scale: float, height: float) -> KeyMarks:
    """Return a bar of a round length, at most a longest one [L], with its length beside it; parameters as in :func:`draw_key`."""
    length = round_below(longest)
    end, tick = scale * length, 0.5 * height
    lines = [np.array([[0.0, tick], [0.0, 0.0], [end, 0.0], [end, tick]])]
    return KeyMarks(lines, [(f"{length:g} {unit}".strip(), np.array([end + 0.8 * height, 0.0]))])


def north_arrow(towards: FloatArray, height: float) -> KeyMarks:
    """Return an arrow around the origin with the letter N at its tip.

    Parameters
    ----------
    towards
        ``(3,)`` unit vector to north: to the right, upwards, and to the viewer. Along the line of sight it has no arrow, but a word.
    height
        Height of capitals [unit of the picture].
    """
    length = float(np.hypot(*towards[:2]))
    if length < UPRIGHT:
        words = "N: towards the viewer" if towards[2] > 0.0 else "N: away from the viewer"
        return KeyMarks([np.zeros((2, 2))], [(words, np.zeros(2))])
    along = 0.5 * ARROW * height * towards[:2] / length
    aside = 0.2 * np.array([-along[1], along[0]])
    head = np.stack([0.4 * along + aside, along, 0.4 * along - aside])
    middle = along * (1.0 + 1.6 / ARROW)
    return KeyMarks([np.stack([-along, along]), head], [("N", middle - [0.5 * LETTER_WIDTH * height, 0.0])])


def round_below(length: float) -> float:
    """Return the largest number of the form 1, 2 or 5 times a power of ten not above a positive length."""
    mantissa, exponent = f"{length:e}".split("e")
    step = max(s for s in (1, 2, 5) if s <= float(mantissa))
    return float(f"{step}e{exponent}")
