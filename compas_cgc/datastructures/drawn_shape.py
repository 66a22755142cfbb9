"""The drawing that the surface of a mesh was found for, in the data of the mesh."""

from __future__ import annotations

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
    return None if drawn is None else {"vertices": drawn.vertices.tolist(), "measure": origin.measure, "evenness": origin.evenness}


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
        vertices, evenness = np.array(data["vertices"], dtype=np.float64), float(data.get("evenness", 0.0))  # type: ignore[index,attr-defined]
        measure = known_measure(data.get("measure"))  # type: ignore[attr-defined]
    except (AttributeError, KeyError, TypeError, ValueError):
        vertices, measure, evenness = np.empty(0), "", 0.0
    if vertices.shape != (len(mesh.vertex), 3) or not np.isfinite([*vertices.flat, evenness]).all() or evenness < 0.0:
        raise ValueError(f"the drawn shape must have 3 finite coordinates for each of {len(mesh.vertex)} vertices; leave 'drawn' out")
    return mesh.to_problem().drawn_as(vertices, measure, evenness).origin
