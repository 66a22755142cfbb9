"""Membrane forces in a .3dm file: maps of N1 and N2, crosses, reactions and line loads."""

from __future__ import annotations

import os
from typing import Union

import numpy as np

from ...fabrication.crosses import crosses
from ...fabrication.membrane_state import MembraneState
from ...fabrication.membrane_state import forces_at_vertices
from .archive import write_archive
from .colours import largest
from .colours import signed_colours
from .layers import FORCES
from .meshes import coloured
from .meshes import mesh_from_arrays
from .write import LayerWriter
from .write import new_archive

__all__ = ["write_force_layers"]

RED, BLUE = (200, 30, 30), (30, 80, 200)  # tension, compression


def write_force_layers(path: Union[str, os.PathLike], state: MembraneState) -> None:
    """Write forces as a .3dm file.

    Raises
    ------
    FileError
        If the file cannot be written.
    """
    problem = state.problem
    writer = LayerWriter(new_archive(problem))
    mesh = mesh_from_arrays(problem.vertices, problem.faces)
    loads = {"pressure": repr(state.pressure), "weight": repr(state.weight)}
    at_vertices = forces_at_vertices(state)
    for k, name in enumerate(("N1", "N2")):
        # Clip the few largest values at corners, which would leave the rest white.
        limit = float(np.percentile(np.abs(at_vertices), 98)) or largest(at_vertices)
        on = writer.layer(f"{FORCES}::{name}", (90, 90, 90), visible=k == 0)
        text = {**loads, "from": repr(-limit), "to": repr(limit)}
        writer.mesh(coloured(mesh, signed_colours(at_vertices[:, k], limit)), writer.attributes(on, name, text))
    drawn = crosses(state)
    for k, name in enumerate(("N1", "N2")):
        on = writer.layer(f"{FORCES}::Crosses {name}", RED)
        for line, force in zip(drawn.lines[k], drawn.forces[:, k].tolist()):
            writer.polyline(line, writer.attributes(on, text={name: repr(force)}, colour=RED if force > 0 else BLUE))
    on = writer.layer(f"{FORCES}::Reactions", (40, 120, 60))
    for vertex in np.flatnonzero(np.abs(state.reactions).max(axis=1) > 0).tolist():
        force = state.reactions[vertex]
        place = problem.vertices[vertex]
        text = {axis: repr(float(part)) for axis, part in zip("xyz", force)}
        writer.polyline(np.array([place, place + drawn.reaction_scale * force]), writer.attributes(on, text=text))
    on = writer.layer(f"{FORCES}::Line loads", (200, 130, 30), visible=False)
    loads_on = state.edge_loads
    for (u, v), kind, load in zip(loads_on.edges.tolist(), loads_on.kind.tolist(), loads_on.load):
        text = {"on": ("support", "crease", "free edge")[kind], "size": repr(float(np.linalg.norm(load)))}
        text.update({axis: repr(float(part)) for axis, part in zip("xyz", load)})
        writer.polyline(problem.vertices[[u, v]], writer.attributes(on, text=text))
    writer.document_text([("compas_cgc.membrane", state.summary())])
    write_archive(writer.archive, path, 7)
