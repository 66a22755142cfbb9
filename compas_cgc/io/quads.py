"""Plane quads as files."""

from __future__ import annotations

import json
import os
from typing import Union

from .._atomic_write import replacing
from ..fabrication.dxf import new_document
from ..fabrication.dxf import show_all
from ..fabrication.plain_data import build_data
from ..fabrication.quad_tables import beam_text
from ..fabrication.quad_tables import face_text
from ..fabrication.quads import PlaneQuads
from ._files import suffix_among
from .formats import OUTPUTS

__all__ = ["write_quads"]


def write_quads(path: Union[str, os.PathLike], quads: PlaneQuads) -> None:
    """Write plane quads in the format of the suffix, atomically.

    Parameters
    ----------
    path
        A .3dm or .dxf with faces, beams and numbers on layers, a .json with corners, faces, beams and figures, a .csv with one row per
        face, or a .beams.csv with one row per beam.
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
                ".csv": lambda: face_text(quads),
                ".beams.csv": lambda: beam_text(quads),
            }[suffix]()
            temporary.write_bytes(text.encode("utf-8"))


def _write_dxf(path: str, quads: PlaneQuads) -> None:
    document = new_document(quads.problem.drawing.units)
    space = document.modelspace()
    for name in ("FACES", "BEAMS", "LABELS"):
        document.layers.add(name)
    for number, face in enumerate(quads.faces):
        points = quads.vertices[face]
        space.add_polyline3d(points.tolist(), close=True, dxfattribs={"layer": "FACES"})
        middle = points.mean(axis=0).tolist()
        space.add_text(f"F{number}", height=0.1 * quads.spacing, dxfattribs={"layer": "LABELS"}).set_placement(middle)
    for a, b in quads.vertices[quads.edges]:
        space.add_line(a.tolist(), b.tolist(), dxfattribs={"layer": "BEAMS"})
    show_all(document, quads.vertices)
    document.saveas(path)
