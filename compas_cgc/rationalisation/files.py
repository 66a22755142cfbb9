"""Files of rationalised designs."""

from __future__ import annotations

import json
import os
from collections.abc import Mapping
from typing import Any
from typing import Union

from .result import Rationalised

__all__ = ["write_rationalised"]


def write_rationalised(
    path: Union[str, os.PathLike[str]],
    found: Rationalised,
    record: Mapping[str, Any],
    source: Union[str, os.PathLike[str], None] = None,
    nurbs: bool = False,
) -> list[str]:
    """Write panels, seams and distances to a .3dm file with a record of them, and return notes on NURBS surfaces.

    Parameters
    ----------
    path
        The .3dm file.
    found
        A rationalised design.
    record
        Report that is stored in the file.
    source
        The .3dm file of the design, whose contents are kept.
    nurbs
        Whether to draw a NURBS surface for each panel.

    Raises
    ------
    FileError
        If the source cannot be read or the file cannot be written.
    """
    from ..io.rhino.panel_layers import PanelClasses
    from ..io.rhino.panel_layers import write_panels

    classes = PanelClasses(found.panels, found.classes, found.curvatures, found.distance.signed)
    return write_panels(path, found.result, classes, {"compas_cgc.rationalised": json.dumps(record, ensure_ascii=False)}, source, nurbs)
