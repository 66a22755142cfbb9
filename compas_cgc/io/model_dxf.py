"""DXF files of a model in place, in millimetres, with a legend below it in its plan or elevation."""

from __future__ import annotations

import textwrap
from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from ..discrete.arrays import FloatArray
from ..fabrication.drawing import LETTER_WIDTH
from ..fabrication.dxf import new_document
from ..fabrication.dxf import show_all
from ..fabrication.picture_key import Key
from ..fabrication.picture_key import draw_key

if TYPE_CHECKING:
    from ezdxf.enums import TextEntityAlignment

__all__ = ["FIRST", "GREY", "INK", "SECOND", "ModelDxf"]

INK, FIRST, SECOND, GREY = 7, 5, 1, 8  # colours of AutoCAD: contrast to the background, blue, red, grey
KEY_ROWS = 3.0  # lines of the legend that the key takes
LINE_PITCH = 1.8  # distance of lines of the legend, relative to their height
MIN_LINE = 60  # characters on a line of the legend at least


class ModelDxf:
    """A DXF with polylines and texts in space [mm].

    Parameters
    ----------
    height
        Height of the texts of the legend [mm].
    axes
        ``(3, 3)`` unit vectors to the right, upwards, and to the viewer who reads the texts.
    """

    def __init__(self, height: float, axes: FloatArray):
        self.document = new_document("Millimeters")
        self.space = self.document.modelspace()
        self.height, self.axes = height, axes
        self.points = list[FloatArray]()

    def layer(self, name: str, colour: int = INK) -> None:
        """Add a layer, if it is new."""
        if name not in self.document.layers:
            self.document.layers.add(name, color=colour)

    def polyline(self, points: FloatArray, layer: str, closed: bool = False) -> None:
        """Add a polyline (k, 3)."""
        self.points.append(points)
        self.space.add_polyline3d(points.tolist(), close=closed, dxfattribs={"layer": layer})

    def text(self, words: str, place: FloatArray, height: float, layer: str) -> None:
        """Add a text with its middle at a place (3,)."""
        from ezdxf.enums import TextEntityAlignment

        self.points.append(place[None])
        self._text(words, place, height, layer, TextEntityAlignment.MIDDLE_CENTER)

    def _text(self, words: str, place: FloatArray, height: float, layer: str, align: TextEntityAlignment) -> None:
        from ezdxf.math import OCS

        front = self.axes[2].tolist()
        entity = self.space.add_text(words, height=height, dxfattribs={"layer": layer, "extrusion": front})
        entity.set_placement(OCS(front).from_wcs(place.tolist()), align=align)

    def save(self, path: str, notes: Sequence[str], key: Key) -> None:
        """Write the file with a key, its lengths in mm, and a legend as wide as the model, on the layer LEGEND."""
        from ezdxf.enums import TextEntityAlignment

        self.layer("LEGEND")
        every = np.vstack(self.points) @ self.axes.T
        low, high = every.min(axis=0), every.max(axis=0)
        length = max(MIN_LINE, int((high[0] - low[0]) / (LETTER_WIDTH * self.height)))
        rows = [row for note in notes for row in textwrap.wrap(note, length, subsequent_indent="    ")]
        places = low - np.outer(2.0 + KEY_ROWS + np.arange(len(rows)), [0.0, LINE_PITCH * self.height, 0.0])
        marks = draw_key(key._replace(unit="mm"), float(high[0] - low[0]), 1.0, self.height, self.axes)
        marks = marks.moved(low[:2] - [0.0, 2.0 * LINE_PITCH * self.height])
        for line in marks.lines:
            marked = np.column_stack([line, np.full(len(line), low[2])]) @ self.axes
            self.space.add_polyline3d(marked.tolist(), dxfattribs={"layer": "LEGEND"})
        for words, at in marks.texts:
            self._text(words, np.append(at, low[2]) @ self.axes, self.height, "LEGEND", TextEntityAlignment.MIDDLE_LEFT)
        for row, place in zip(rows, places @ self.axes):
            self._text(row, place, self.height, "LEGEND", TextEntityAlignment.LEFT)
        show_all(self.document, np.vstack([*self.points, places @ self.axes]), self.axes)
        self.document.saveas(path)
