"""Designs as plain data, which JSON holds without loss."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from ..model.problem import Drawing
from .design import GivenDesign
from .spline_surface import SplineSurface

__all__ = ["design_from_dict", "design_to_dict"]


def design_to_dict(design: GivenDesign) -> dict[str, Any]:
    """Return a design as it is given, with its supports, seams and units, as plain data."""
    surface, drawing = design.surface, design.drawing
    return {
        "surface": None
        if surface is None
        else {
            "control": surface.control.tolist(),
            "knots": [own.tolist() for own in surface.knots],
            "degrees": list(map(int, surface.degrees)),
        },
        "vertices": design.vertices.tolist(),
        "polygons": [list(map(int, face)) for face in design.polygons],
        "tolerance": design.tolerance,
        "supports": [line.tolist() for line in design.supports],
        "seams": [line.tolist() for line in design.seams],
        "drawing": {"name": drawing.name, "units": drawing.units, "tolerance": drawing.tolerance, "north": drawing.north},
        "notes": list(design.notes),
    }


def design_from_dict(data: Mapping[str, Any]) -> GivenDesign:
    """Return the design of :func:`design_to_dict`.

    Raises
    ------
    KeyError, TypeError, ValueError
        If the data are incomplete or damaged.
    """
    given, surface = data["surface"], None
    if given is not None:
        u, v = (np.array(own, dtype=np.float64) for own in given["knots"])
        surface = SplineSurface(np.array(given["control"], dtype=np.float64), (u, v), (int(given["degrees"][0]), int(given["degrees"][1])))
    lines = [tuple(np.array(line, dtype=np.float64).reshape(-1, 3) for line in data[name]) for name in ("supports", "seams")]
    vertices = np.array(data["vertices"], dtype=np.float64).reshape(-1, 3)
    drawn = data["drawing"]
    drawing = Drawing(drawn["name"], drawn["units"], drawn["tolerance"], north=(drawn["north"][0], drawn["north"][1]))
    return GivenDesign(surface, vertices, data["polygons"], data["tolerance"], lines[0], lines[1], drawing, tuple(data["notes"]))
