"""A rationalised design in a COMPAS scene: design, panels by mould, seams, and distances."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from compas.colors import Color
from compas.datastructures import Mesh
from compas.geometry import Polyline

from ..discrete.arrays import FloatArray
from ..discrete.arrays import IntArray
from ..errors import CGCError
from ..io.rhino.colours import largest
from ..io.rhino.colours import signed_colours
from ..io.rhino.panel_layers import mould_colour
from ..io.rhino.panel_layers import mould_name
from .result import Rationalised

if TYPE_CHECKING:
    from compas.scene import Scene
    from compas.scene import SceneObject

__all__ = ["add_to_scene"]

SHOWN = ("moulds", "distance", "design")
SEAM = Color.from_rgb255(20, 60, 160)
DESIGN = Color.from_rgb255(190, 190, 190)


def add_to_scene(scene: Scene, found: Rationalised, show: str = "moulds") -> list[SceneObject]:
    """Add a rationalised design to a scene of COMPAS, for Rhino, Grasshopper, notebooks or compas_viewer.

    The scene gets a mesh of the panels of every mould in its colour, polylines along the seams, a mesh coloured by the signed distance from
    the design, blue below and red above, and a mesh of the design.

    Parameters
    ----------
    scene
        The scene.
    found
        A rationalised design.
    show
        The surface that is visible: ``moulds``, ``distance`` or ``design``. The other two are added hidden.

    Returns
    -------
    list[compas.scene.SceneObject]
        The objects: moulds in the order of ``found.curvatures``, ``seams``, ``distance`` and ``design``.

    Raises
    ------
    CGCError
        If `show` is unknown.

    Examples
    --------
    >>> from compas.scene import Scene
    >>> scene = Scene()  # doctest: +SKIP
    >>> add_to_scene(scene, found)  # doctest: +SKIP
    >>> scene.draw()  # doctest: +SKIP
    """
    if show not in SHOWN:
        raise CGCError(f"show must be one of {', '.join(SHOWN)}, not {show!r:.60}")
    problem, moulds = found.result.problem, found.classes[found.panels]
    made = []
    for number, K in enumerate(found.curvatures.tolist()):
        mesh = _mesh(found.result.vertices, problem.faces[moulds == number])
        name = f"mould {number + 1}: {mould_name(K)}"
        made.append(scene.add(mesh, name=name, color=Color.from_rgb255(*mould_colour(number)), show=show == "moulds"))
    for number, line in enumerate(problem.crease_paths()):
        made.append(scene.add(Polyline(found.result.vertices[line].tolist()), name=f"seam {number}", color=SEAM))
    limit = largest(found.distance.signed)
    colours = signed_colours(found.distance.signed, limit).tolist()
    by_vertex = {vertex: Color.from_rgb255(*colour) for vertex, colour in enumerate(colours)}
    coloured = {"vertexcolor": by_vertex, "use_vertexcolors": True}
    name = f"distance from -{limit:.3g} to {limit:.3g}"
    made.append(scene.add(_mesh(found.result.vertices, problem.faces), name=name, show=show == "distance", **coloured))
    made.append(scene.add(_mesh(found.panelling.vertices, problem.faces), name="design", color=DESIGN, show=show == "design"))
    return made


def _mesh(vertices: FloatArray, faces: IntArray) -> Mesh:
    """Return the faces as a mesh with their vertices alone."""
    used, corners = np.unique(faces, return_inverse=True)
    return Mesh.from_vertices_and_faces(vertices[used].tolist(), corners.reshape(-1, 3).tolist())
