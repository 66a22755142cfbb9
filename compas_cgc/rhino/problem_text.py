"""What is asked of a mesh, in the forms that a .3dm holds."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING

import numpy as np

from ..discrete.arrays import FloatArray
from ..files.asked import region_targets
from .targets import VERTEX_KEY

if TYPE_CHECKING:
    from ..datastructures import CGCMesh

__all__ = ["crease_polylines", "vertex_text"]


def vertex_text(mesh: CGCMesh) -> dict[str, str]:
    """Return user text with the values of single vertices, empty where the regions say it all."""
    keys = [v for v in mesh.vertices() if not mesh.is_dummy(v)]
    values: dict[str, list] = {}
    uniform = region_targets(mesh)
    asked = [mesh.vertex_target(v) for v in keys if mesh.vertex_role(v) == "internal"]
    if None in uniform and any(K is not None for K in asked):
        values["target"] = [mesh.vertex_target(v) for v in keys]
    for name in ("s", "e"):
        column = [mesh.vertex_attribute(v, name) for v in keys]
        if any(value is not None for value in column):
            values[name] = column
    return {VERTEX_KEY: json.dumps(values)} if values else {}


def crease_polylines(mesh: CGCMesh) -> list[FloatArray]:
    """Return the creases as points from end to end (k, 3) [L]."""
    return [np.array([mesh.vertex_coordinates(v) for v in path]) for path in mesh.creases()]
