"""Legends of drawings: what every layer and every number in a text means."""

from __future__ import annotations

import textwrap
from collections.abc import Mapping
from collections.abc import Sequence
from typing import Optional

import numpy as np

from ..discrete.arrays import FloatArray
from .drawing import LETTER_WIDTH
from .drawing import Drawing
from .drawing import Line
from .drawing import Text
from .figures import metres
from .front_view import PLAN
from .picture_key import K_MEANING
from .picture_key import Key
from .picture_key import draw_key

__all__ = ["curvature_notes", "key_of_plan", "outside_is_above", "outside_note", "with_legend"]

LINE_PITCH = 1.8  # distance of lines of text, relative to their height
MIN_LINE = 60  # characters on a line at least


def outside_is_above(normals: FloatArray) -> Optional[bool]:
    """Return whether the side to which all normals (m, 3) point is above (True) or below (False), None where it is neither."""
    up = normals[:, 2]
    return True if up.min() > 0.0 else False if up.max() < 0.0 else None


def outside_note(above: Optional[bool]) -> str:
    """Return the sentence that defines the outside of a surface, by :func:`outside_is_above`."""
    where = {True: ", here above everywhere", False: ", here below everywhere", None: ""}[above]
    return f"outside: the side to which the normals of the surface point{where}"


def curvature_notes(key: Key) -> list[str]:
    """Return the sentence that defines K, if the key of a drawing has a K."""
    return [K_MEANING] if any(words.startswith("K =") for words in key.words) else []


def key_of_plan(
    key: Key, at: FloatArray, width: float, height: float, units: Optional[str], axes: FloatArray = PLAN
) -> tuple[list[Line], list[Text]]:
    """Return the key of a plan, 1:1 and in millimetres like all dimensions on it, on the layer LEGEND.

    Parameters
    ----------
    key
        North and words.
    at
        ``(2,)`` left end of the scale bar [L].
    width
        Width of the plan [L].
    height
        Height of the texts [L].
    units
        Units of the lengths L by name.
    axes
        ``(3, 3)`` unit vectors to the right, upwards, and to the viewer.
    """
    marks = draw_key(key._replace(unit="mm"), width, 0.001 / metres(units), height, axes).moved(at)
    texts = [Text("LEGEND", text, place, height, starts=True) for text, place in marks.texts]
    return [Line("LEGEND", line) for line in marks.lines], texts


def with_legend(drawing: Drawing, meanings: Mapping[str, str], notes: Sequence[str], height: float, width: float = 0.0) -> Drawing:
    """Return a drawing with a legend above it, on the layer LEGEND.

    Parameters
    ----------
    drawing
        The drawing; its size grows to include the legend.
    meanings
        Meaning of each layer, in the order of the legend; layers that the drawing does not use are left out.
    notes
        Further sentences, before the layers.
    height
        Height of the texts [L].
    width
        Width of the legend [L]. 0: that of the drawing.
    """
    used = {line.layer for line in drawing.lines} | {text.layer for text in drawing.texts}
    entries = [("LEGEND", note) for note in notes]
    entries += [(layer, f"{layer}: {meaning}") for layer, meaning in meanings.items() if layer in used]
    length = max(MIN_LINE, int((width or drawing.size[0]) / (LETTER_WIDTH * height)))
    rows = [(layer, row) for layer, text in entries for row in textwrap.wrap(text, length, subsequent_indent="    ")]
    pitch = LINE_PITCH * height
    bottom = max([drawing.size[1], *(float(text.place[1]) + text.height for text in drawing.texts)]) + pitch
    texts = [
        Text("LEGEND", row, np.array([0.0, bottom + (len(rows) - 1 - k) * pitch]), height, layer, True)
        for k, (layer, row) in enumerate(rows)
    ]
    return drawing._replace(texts=[*drawing.texts, *texts], size=(drawing.size[0], bottom + len(rows) * pitch))
