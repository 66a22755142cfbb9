"""Plane quads as files."""

from __future__ import annotations

import json
import os
from typing import Union

from .._atomic_write import replacing
from ..discrete.arrays import FloatArray
from ..fabrication.dxf import dxf_text
from ..fabrication.dxf import new_document
from ..fabrication.dxf import show_all
from ..fabrication.materials import metres_per_unit
from ..fabrication.plain_data import build_data
from ..fabrication.quad_drawing import draw_quads
from ..fabrication.quad_tables import beam_text
from ..fabrication.quad_tables import face_text
from ..fabrication.quad_tables import quad_notes
from ..fabrication.quads import PlaneQuads
from ..fabrication.svg import svg_text
from ._files import suffix_among
from .formats import OUTPUTS

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
    mm, height = 1e3 * metres_per_unit(quads.problem.drawing.units), TEXT * quads.spacing
    document = new_document("Millimeters")
    space = document.modelspace()
    for name in ("FACES", "BEAMS", "FACE_NUMBERS", "BEAM_NUMBERS", "NODE_NUMBERS", "LEGEND"):
        document.layers.add(name)

    def number(text: str, place: FloatArray, size: float, layer: str) -> None:
        space.add_text(text, height=mm * size, dxfattribs={"layer": layer}).set_placement((mm * place).tolist())

    for k, face in enumerate(quads.faces):
        points = quads.vertices[face]
        space.add_polyline3d((mm * points).tolist(), close=True, dxfattribs={"layer": "FACES"})
        number(f"F{k}", points.mean(axis=0), height, "FACE_NUMBERS")
    for k, ends in enumerate(quads.vertices[quads.edges]):
        start, end = (mm * ends).tolist()
        space.add_line(start, end, dxfattribs={"layer": "BEAMS"})
        number(f"B{k}", ends.mean(axis=0), 0.6 * height, "BEAM_NUMBERS")
    for k, place in enumerate(quads.vertices):
        number(str(k), place, 0.5 * height, "NODE_NUMBERS")
    # Below the model in plan.
    corner = quads.vertices.min(axis=0)
    notes = ["model in place, 1:1, in mm; FACES: outlines of faces; BEAMS: axes of beams, between nodes at the faces", *quad_notes(quads)]
    for row, note in enumerate(notes):
        number(note, corner - [0.0, (3.0 + 2.0 * row) * 0.5 * height, 0.0], 0.5 * height, "LEGEND")
    show_all(document, mm * quads.vertices)
    document.saveas(path)
