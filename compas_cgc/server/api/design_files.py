"""Files of freeform designs, which are read as smooth surfaces where they hold them."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING
from typing import Any

from ...io.formats import FORMATS
from ..limits import Limits
from .decoding import check_size
from .mesh_files import uploaded
from .units import UNITS

if TYPE_CHECKING:
    from ...rationalisation.design import GivenDesign

__all__ = ["DESIGN_KINDS", "read_design_file"]

# COMPAS meshes are sent in the field `mesh` of a JSON request, where they are checked before they are decoded.
DESIGN_KINDS = tuple(suffix[1:] for suffix, own in FORMATS.items() if (own.coordinates or own.surfaces) and suffix != ".json")


def read_design_file(kind: str, body: bytes, options: Mapping[str, Any], limits: Limits) -> GivenDesign:
    """Return the design in the bytes of a file.

    Parameters
    ----------
    kind
        One of :data:`DESIGN_KINDS`.
    body
        The file.
    options
        ``name`` and ``unit`` of the design, which replace those of the file.
    limits
        Limits of the server.

    Raises
    ------
    Unprocessable, TooLarge
        If the file cannot be read or is too large.
    """
    # Workers that never rationalise do without its imports.
    from ...rationalisation.design import given_design

    with uploaded(kind, body) as path:
        given = given_design(path)
    check_size(len(given.vertices), len(given.polygons), limits)
    units = UNITS[options.get("unit") or ""] or given.drawing.units
    return given._replace(drawing=given.drawing._replace(name=options.get("name") or "", units=units))
