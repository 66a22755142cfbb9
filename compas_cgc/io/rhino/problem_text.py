"""The values of single vertices as user text."""

from __future__ import annotations

import json

import numpy as np

from ...discrete.arrays import FloatArray
from ..asked import Asked

__all__ = ["VERTEX_KEY", "vertex_text", "vertex_values"]

# User text on a mesh: values of single vertices, where they are not the same all over a region.
VERTEX_KEY = "cgc vertices"


def vertex_text(mesh: Asked) -> dict[str, str]:
    """Return user text with the values of single vertices, empty where the regions say it all."""
    values = {}
    if None in mesh.region_targets() and np.isfinite(mesh.targets[mesh.asked]).any():
        values["target"] = mesh.targets
    for name in ("s", "e"):
        if np.isfinite(getattr(mesh, name)).any():
            values[name] = getattr(mesh, name)
    plain = {name: [None if x != x else x for x in column.tolist()] for name, column in values.items()}
    return {VERTEX_KEY: json.dumps(plain)} if plain else {}


def vertex_values(text: dict[str, str], n: int) -> dict[str, FloatArray]:
    """Return the values of single vertices in the user text of a mesh with n vertices.

    Returns
    -------
    dict
        ``target``, ``s``, ``e``, each (n,), NaN where none; empty where the text does not
        belong to this mesh any more.
    """
    try:
        found = json.loads(text.get(VERTEX_KEY, "{}"))
        columns = {name: np.array([np.nan if x is None else x for x in values], dtype=np.float64) for name, values in found.items()}
    except (AttributeError, TypeError, ValueError):
        return {}
    return {name: values for name, values in columns.items() if name in ("target", "s", "e") and values.shape == (n,)}
