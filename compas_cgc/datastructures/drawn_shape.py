"""The drawing that the surface of a mesh was found for, in the data of the mesh."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING
from typing import Optional

import numpy as np

from ..errors import CGCError
from ..model.measures import known_measure
from ..model.problem import Origin

if TYPE_CHECKING:
    from .cgcmesh import CGCMesh

__all__ = ["drawn_shape", "origin_from"]


def drawn_shape(mesh: CGCMesh) -> Optional[dict]:
    """Return the drawn vertices of the mesh of a result and the measure of its K, None where its surface is not one that was found."""
    origin = mesh.origin
    if origin is None or len(origin.vertices) != len(mesh.vertex):
        return None
    try:
        drawn = mesh.to_problem().drawn
    except CGCError:
        return None
    return None if drawn is None else {"vertices": drawn.vertices.tolist(), "measure": origin.measure}


def origin_from(mesh: CGCMesh, data: object) -> Optional[Origin]:
    """Return the problem that the surface of a mesh solves, from what :func:`drawn_shape` returned.

    Raises
    ------
    ValueError
        If these are not vertices of a drawing of the mesh.
    """
    if data is None:
        return None
    try:
        vertices = np.array(data["vertices"], dtype=np.float64) if isinstance(data, Mapping) else np.empty(0)
    except (KeyError, TypeError, ValueError):
        vertices = np.empty(0)
    if vertices.shape != (len(mesh.vertex), 3) or not np.isfinite(vertices).all():
        raise ValueError(f"the drawn shape must have 3 finite coordinates for each of {len(mesh.vertex)} vertices; leave 'drawn' out")
    return mesh.to_problem().drawn_as(vertices, known_measure(data["measure"] if "measure" in data else "")).origin  # type: ignore[index,operator]
