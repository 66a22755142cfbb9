"""DXF by ezdxf: every digit of the coordinates is kept."""

from __future__ import annotations

import io

from ..errors import CGCError
from .drawing import LAYERS
from .drawing import Drawing

__all__ = ["dxf_text"]

_UNITS = {"Inches": 1, "Feet": 2, "Millimeters": 4, "Centimeters": 5, "Meters": 6, "Kilometers": 7, "Yards": 10}  # $INSUNITS
DARK = 64  # of 255


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
    try:
        from ezdxf import colors
        from ezdxf import filemanagement
        from ezdxf.enums import TextEntityAlignment
    except ImportError:
        raise CGCError("writing DXF needs ezdxf; install compas_cgc[fabrication]") from None
    document = filemanagement.new("R2010", units=_UNITS.get(drawing.units or "Meters", 0))
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
    stream = io.StringIO()
    document.write(stream)
    return stream.getvalue()
