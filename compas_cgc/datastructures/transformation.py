"""Transformation of meshes with targets, goals and the drawn shape of a result."""

from __future__ import annotations

from typing import TYPE_CHECKING
from typing import Any

import numpy as np
from compas.datastructures import Mesh

from ..model.goals.moved import moved_goals
from ..model.motion import similarity_of

if TYPE_CHECKING:
    from .cgcmesh import CGCMesh

__all__ = ["transform"]


def transform(mesh: CGCMesh, T: Any) -> None:
    """Transform a mesh in place, see :meth:`CGCMesh.transform`.

    Raises
    ------
    ValueError
        If a target or a goal cannot follow the transformation.
    """
    mesh._aabb = mesh._obb = None
    try:
        motion = similarity_of(T)
    except ValueError:
        if mesh.goals() or mesh._laws() or mesh.origin is not None or any(own.get("target") is not None for own in mesh.vertex.values()):
            raise
        Mesh.transform_numpy(mesh, getattr(T, "matrix", T))
        return
    goals = moved_goals(mesh.goals(), motion)
    origin = mesh.origin
    if origin is not None:
        origin = origin._replace(drawn=origin.drawn.transformed(T), vertices=motion.points(origin.vertices))
    points = np.array([[own[axis] for axis in "xyz"] for own in mesh.vertex.values()]).reshape(-1, 3)
    default = mesh.default_vertex_attributes.get("target")
    if default is not None:
        mesh.default_vertex_attributes["target"] = default / motion.scale**2
    for own, (x, y, z) in zip(mesh.vertex.values(), motion.points(points).tolist()):
        own.update(x=x, y=y, z=z)
        if own.get("target") is not None:
            own["target"] /= motion.scale**2
    if mesh.attributes.get("tolerance") is not None:
        mesh.attributes["tolerance"] = motion.measure(mesh.attributes["tolerance"])
    if motion.reflects:
        mesh.flip_cycles()
    mesh.set_goals(goals)
    mesh._set_laws({number: law.scaled(motion.scale) for number, law in mesh._laws().items()})
    mesh.origin = origin
