"""DXF by ezdxf: every digit of the coordinates is kept."""

from __future__ import annotations

import io
from typing import TYPE_CHECKING
from typing import Optional

import numpy as np

from ..discrete.arrays import FloatArray
from ..errors import CGCError
from .drawing import LAYERS
from .drawing import Drawing

if TYPE_CHECKING:
    from ezdxf.document import Drawing as Document

__all__ = ["dxf_text", "new_document", "show_all"]

_UNITS = {"Inches": 1, "Feet": 2, "Millimeters": 4, "Centimeters": 5, "Meters": 6, "Kilometers": 7, "Yards": 10}  # $INSUNITS
DARK = 64  # of 255
AROUND = 1.1  # of the larger side of what is drawn, that a view of it is high


def new_document(units: Optional[str]) -> Document:
    """Return an empty DXF R2010 in units such as ``Meters``, which None stands for too.

    Raises
    ------
    CGCError
        If ezdxf is not installed.
    """
    try:
        from ezdxf import filemanagement
    except ImportError:
        raise CGCError("writing DXF needs ezdxf; install compas_cgc[fabrication]") from None
    return filemanagement.new("R2010", units=_UNITS.get(units or "Meters", 0))


def show_all(document: Document, points: FloatArray) -> None:
    """Let a DXF open on all of its points (k, 2 or 3): without it, programs open it on an empty view a thousand units high."""
    low, high = (np.append(corner, 0.0)[:3].tolist() for corner in (points.min(axis=0), points.max(axis=0)))
    space = document.modelspace()
    space.reset_extents(low, high)
    space.reset_limits(low[:2], high[:2])
    # It takes a corner at the origin for one that is not known.
    document.header["$EXTMIN"], document.header["$EXTMAX"] = low, high
    middle = 0.5 * (low[0] + high[0]), 0.5 * (low[1] + high[1])
    document.set_modelspace_vport(AROUND * max(high[0] - low[0], high[1] - low[1]), center=middle)


def dxf_text(drawing: Drawing) -> str:
    """Return a drawing as DXF R2010: closed outlines as LWPOLYLINE on the layer OUTLINE, anticlockwise, holes clockwise.

    Parameters
    ----------
    drawing
        What :func:`compas_cgc.fabrication.drawing.draw_sheets` gave.

    Raises
    ------
    CGCError
        If ezdxf is not installed, or finds a fault in the drawing.
    """
    document = new_document(drawing.units)
    from ezdxf import colors
    from ezdxf.enums import TextEntityAlignment

    for name, colour in LAYERS.items():
        # What is nearly black is drawn in the colour that stands out from the screen, whether that is light or dark.
        layer = document.layers.add(name, color=7) if max(colour) < DARK else document.layers.add(name, true_color=colors.rgb2int(colour))
        if name in drawing.hidden:
            layer.freeze()
    space = document.modelspace()
    for line in drawing.lines:
        space.add_lwpolyline(line.points.tolist(), close=line.closed, dxfattribs={"layer": line.layer})
    for text in drawing.texts:
        if text.height > 0:
            entity = space.add_text(text.text, height=text.height, dxfattribs={"layer": text.layer})
            entity.set_placement(tuple(text.place.tolist()), align=TextEntityAlignment.MIDDLE_CENTER)
    faults = document.audit().errors
    if faults:
        raise CGCError(f"the DXF would have {len(faults)} faults, the first: {faults[0].message}")
    show_all(document, np.array([(0.0, 0.0), drawing.size]))
    stream = io.StringIO()
    document.write(stream)
    return stream.getvalue()
