"""Membrane forces as files for Rhino, finite element programs and COMPAS."""

from __future__ import annotations

import os
from typing import Any
from typing import Union

from .._atomic_write import replacing
from .._version import __version__
from ..fabrication.membrane_state import MembraneState
from ._files import suffix_among
from .compas_json import json_text
from .formats import OUTPUTS
from .inp import Model
from .inp import inp_text

__all__ = ["forces_json", "write_forces"]


def write_forces(path: Union[str, os.PathLike], state: MembraneState, **model: Any) -> None:
    """Write forces in the format of the suffix, atomically.

    Parameters
    ----------
    path
        A .3dm with maps, crosses, reactions and line loads; an .inp for CalculiX and Abaqus; or a COMPAS .json, whose
        mesh has the forces as attributes.
    state
        Forces from :func:`compas_cgc.fabrication.membrane`.
    model
        Fields of :class:`compas_cgc.io.inp.Model` for .inp files.

    Raises
    ------
    FileError
        If the file cannot be written.
    CGCError
        If a thickness, beam or modulus is not positive.
    """
    suffix = suffix_among(path, OUTPUTS["membrane"], "forces")
    if suffix == ".3dm":
        from .rhino.forces import write_force_layers

        write_force_layers(path, state)
        return
    text = inp_text(state, Model(**model)) if suffix == ".inp" else forces_json(state)
    with replacing(path) as temporary:
        temporary.write_bytes(text.encode("utf-8"))


def forces_json(state: MembraneState) -> str:
    """Return the mesh as COMPAS JSON: ``N1``, ``N2``, ``direction`` of faces, ``load``, ``reaction`` of vertices, ``force`` of edges."""
    from ..datastructures import CGCMesh

    mesh = CGCMesh.from_problem(state.problem)
    vertices, faces = list(mesh.vertices()), list(mesh.faces())
    for face, (N1, N2), (direction, _) in zip(faces, state.forces.tolist(), state.directions.tolist()):
        mesh.face_attributes(face, ["N1", "N2", "direction"], [N1, N2, direction])
    for vertex, load, reaction in zip(vertices, state.load.tolist(), state.reactions.tolist()):
        mesh.vertex_attributes(vertex, ["load", "reaction"], [load, reaction])
    for (u, v), force in zip(state.edges.tolist(), state.edge_forces.tolist()):
        mesh.edge_attribute((vertices[u], vertices[v]), "force", force)
    for (u, v), load in zip(state.edge_loads.edges.tolist(), state.edge_loads.load.tolist()):
        mesh.edge_attribute((vertices[u], vertices[v]), "line_load", load)
    mesh.attributes["membrane"] = {"version": __version__, "pressure": state.pressure, "weight": state.weight, "report": state.summary()}
    return json_text(mesh)
