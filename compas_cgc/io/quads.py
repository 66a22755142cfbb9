"""Plane quads as files."""

from __future__ import annotations

import json
import os
from typing import Union

import numpy as np

from .._atomic_write import replacing
from ..fabrication.dxf import dxf_text
from ..fabrication.front_view import front_view
from ..fabrication.materials import metres_per_unit
from ..fabrication.picture_key import key_of
from ..fabrication.plain_data import build_data
from ..fabrication.quad_drawing import draw_quads
from ..fabrication.quad_drawing import face_label
from ..fabrication.quad_drawing import labels_in_plan
from ..fabrication.quad_tables import beam_text
from ..fabrication.quad_tables import face_text
from ..fabrication.quad_tables import quad_notes
from ..fabrication.quads import PlaneQuads
from ..fabrication.svg import svg_text
from ._files import suffix_among
from .formats import OUTPUTS
from .model_dxf import FIRST
from .model_dxf import GREY
from .model_dxf import INK
from .model_dxf import ModelDxf

__all__ = ["write_quads"]

TEXT = 0.1  # height of numbers of faces relative to the spacing


def write_quads(path: Union[str, os.PathLike], quads: PlaneQuads) -> None:
    """Write plane quads in the format of the suffix, atomically.

    Parameters
    ----------
    path
        A .3dm, or a .dxf in millimetres, with faces, beams and numbers in place on layers; a .flat.dxf or .flat.svg with the outlines of
        all faces and beams, flat at 1:1 in millimetres; a .json with corners, faces, beams and figures; a .csv with one row per face, or
        a .beams.csv with one row per beam.
    quads
        Result of :func:`compas_cgc.fabrication.plane_quads`.

    Raises
    ------
    FileError
        If the file cannot be written.
    CGCError
        If a package that the format requires is missing.
    """
    suffix = suffix_among(path, OUTPUTS["quads"], "plane quads")
    if suffix == ".3dm":
        from .rhino.quads import write_quad_layers

        write_quad_layers(path, quads)
        return
    with replacing(path) as temporary:
        if suffix == ".dxf":
            _write_dxf(str(temporary), quads)
        else:
            text = {
                ".json": lambda: json.dumps(build_data("quads", quads.problem, quads)) + "\n",
                ".flat.dxf": lambda: dxf_text(draw_quads(quads)),
                ".flat.svg": lambda: svg_text(draw_quads(quads)),
                ".csv": lambda: face_text(quads),
                ".beams.csv": lambda: beam_text(quads),
            }[suffix]()
            temporary.write_bytes(text.encode("utf-8"))


def _write_dxf(path: str, quads: PlaneQuads) -> None:
    """Write the model in place, with numbers inside the faces."""
    mm = 1e3 * metres_per_unit(quads.problem.drawing.units)
    height, places = TEXT * mm * quads.spacing, mm * quads.vertices
    axes = front_view(quads.problem)
    drawing, flat = ModelDxf(0.5 * height, axes), places @ axes.T
    for name, colour in (("FACES", INK), ("BEAMS", FIRST), ("FACE_NUMBERS", INK), ("BEAM_NUMBERS", FIRST), ("NODE_NUMBERS", GREY)):
        drawing.layer(name, colour)
    for k, face in enumerate(quads.faces):
        drawing.polyline(places[face], "FACES", closed=True)
        label = face_label(f"F{k}", flat[face][:, :2], height)
        drawing.text(label.text, np.append(label.place, flat[face][:, 2].mean()) @ axes, label.height, "FACE_NUMBERS")
    beams, nodes = labels_in_plan(quads, flat[:, :2], 0.6 * height)
    for label, ends in zip(beams, quads.edges):
        drawing.polyline(places[ends], "BEAMS")
        drawing.text(label.text, np.append(label.place, flat[ends, 2].mean()) @ axes, label.height, "BEAM_NUMBERS")
    for label, place in zip(nodes, flat):
        drawing.text(label.text, np.append(label.place, place[2]) @ axes, label.height, "NODE_NUMBERS")
    notes = ["model in place, 1:1, in mm; FACES: outlines of faces; BEAMS: axes of beams, between nodes at the faces", *quad_notes(quads)]
    drawing.save(path, notes, key_of(quads.problem))
