"""DXF output with ezdxf, with full precision of the coordinates."""

from __future__ import annotations

import io
from typing import TYPE_CHECKING
from typing import Optional

import numpy as np

from ..discrete.arrays import FloatArray
from ..errors import CGCError
from .drawing import LAYERS
from .drawing import Drawing
from .front_view import PLAN

if TYPE_CHECKING:
    from ezdxf.document import Drawing as Document

__all__ = ["dxf_text", "new_document", "show_all"]

_UNITS = {"Inches": 1, "Feet": 2, "Millimeters": 4, "Centimeters": 5, "Meters": 6, "Kilometers": 7, "Yards": 10}  # $INSUNITS
DARK_LEVEL = 64  # of 255; darker colours become the contrast colour of the screen
VIEW_MARGIN = 1.1  # height of the view relative to the larger side of the drawing


def new_document(units: Optional[str]) -> Document:
    """Return an empty DXF R2010 document in units such as ``Meters`` (default).

    Raises
    ------
    CGCError
        If ezdxf is not installed.
    """
    try:
        from ezdxf import filemanagement
    except ImportError:
        raise CGCError("writing DXF needs the package ezdxf; install compas_cgc[fabrication]") from None
    return filemanagement.new("R2010", units=_UNITS.get(units or "Meters", 0))


def show_all(document: Document, points: FloatArray, axes: FloatArray = PLAN) -> None:
    """Set the initial view of a DXF to all of its points (k, 2 or 3), with axes (3, 3) to the right, upwards and to the viewer."""
    low, high = (np.append(corner, 0.0)[:3].tolist() for corner in (points.min(axis=0), points.max(axis=0)))
    space = document.modelspace()
    space.reset_extents(low, high)
    space.reset_limits(low[:2], high[:2])
    # ezdxf treats a corner at the origin as unknown.
    document.header["$EXTMIN"], document.header["$EXTMAX"] = low, high
    seen = points @ axes[:2, : points.shape[1]].T
    middle, size = 0.5 * (seen.min(axis=0) + seen.max(axis=0)), float(np.ptp(seen, axis=0).max())
    document.set_modelspace_vport(VIEW_MARGIN * size, center=middle.tolist(), dxfattribs={"direction": axes[2].tolist()})


def dxf_text(drawing: Drawing) -> str:
    """Return a drawing as DXF R2010; cuts are closed LWPOLYLINE entities on the layer CUT, counterclockwise, holes clockwise.

    Parameters
    ----------
    drawing
        Result of :func:`compas_cgc.fabrication.draw_sheets`.

    Raises
    ------
    CGCError
        If ezdxf is not installed, or reports errors.
    """
    document = new_document(drawing.units)
    from ezdxf import colors
    from ezdxf.enums import TextEntityAlignment

    # Colour 7 contrasts with the screen background, light or dark.
    paints = {name: {"color": 7} if max(colour) < DARK_LEVEL else {"true_color": colors.rgb2int(colour)} for name, colour in LAYERS.items()}
    for name in dict.fromkeys([*(line.layer for line in drawing.lines), *(text.layer for text in drawing.texts)]):
        document.layers.add(name).dxf.update(paints[name])
    space = document.modelspace()
    for line in drawing.lines:
        space.add_lwpolyline(line.points.tolist(), close=line.closed, dxfattribs={"layer": line.layer})
    for text in drawing.texts:
        if text.height > 0:
            entity = space.add_text(text.text, height=text.height, dxfattribs={"layer": text.layer, **paints.get(text.colour, {})})
            align = TextEntityAlignment.MIDDLE_LEFT if text.starts else TextEntityAlignment.MIDDLE_CENTER
            entity.set_placement(tuple(text.place.tolist()), align=align)
    faults = document.audit().errors
    if faults:
        raise CGCError(f"ezdxf reports {len(faults)} errors in the DXF, the first: {faults[0].message}; please report this")
    show_all(document, np.array([(0.0, 0.0), drawing.size]))
    stream = io.StringIO()
    document.write(stream)
    return stream.getvalue()
