"""Plane quads in a .3dm file: faces, beams and nodes on layers."""

from __future__ import annotations

import os
from typing import Union

import numpy as np

from ...fabrication.quads import PlaneQuads
from .archive import write_archive
from .layers import QUADS
from .meshes import mesh_from_arrays
from .write import LayerWriter
from .write import new_archive

__all__ = ["write_quad_layers"]


def write_quad_layers(path: Union[str, os.PathLike], quads: PlaneQuads) -> None:
    """Write plane quads as a .3dm file: outlines and meshes of faces, beams as strips along the axes of the nodes, irregular nodes.

    Raises
    ------
    FileError
        If the file cannot be written.
    """
    writer = LayerWriter(new_archive(quads.problem))
    outlines, faces = writer.layer(f"{QUADS}::Outlines", (40, 90, 170)), writer.layer(f"{QUADS}::Faces", (150, 180, 220))
    for number, face in enumerate(quads.faces):
        points = quads.vertices[face]
        text = {"region": str(quads.region[number]), "planarity": repr(float(quads.planarity[number]))}
        writer.polyline(np.vstack([points, points[:1]]), writer.attributes(outlines, f"F{number}", text))
        fan = np.array([[0, k, k + 1] for k in range(1, len(face) - 1)])
        writer.mesh(mesh_from_arrays(points, fan), writer.attributes(faces, f"F{number}", text))
    beams = writer.layer(f"{QUADS}::Beams", (180, 60, 40))
    for number, (a, b) in enumerate(quads.edges.tolist()):
        ends = quads.vertices[[a, b]]
        strip = np.vstack([ends, (ends + quads.depth * quads.axes[[a, b]])[::-1]])
        text = {"nodes": f"{a} {b}", "length": repr(float(np.linalg.norm(ends[1] - ends[0]))), "twist": repr(float(quads.twist[number]))}
        writer.mesh(mesh_from_arrays(strip, np.array([[0, 1, 2], [0, 2, 3]])), writer.attributes(beams, f"B{number}", text))
    numbers = writer.layer(f"{QUADS}::Numbers", (60, 60, 60))
    for number, face in enumerate(quads.faces):
        writer.dot(f"F{number}", quads.vertices[face].mean(axis=0), writer.attributes(numbers))
    others = writer.attributes(writer.layer(f"{QUADS}::Numbers of beams and nodes", (120, 120, 120), visible=False))
    for number, ends in enumerate(quads.vertices[quads.edges]):
        writer.dot(f"B{number}", ends.mean(axis=0), others)
    for number, place in enumerate(quads.vertices):
        writer.dot(str(number), place, others)
    if len(quads.irregular):
        writer.points(quads.vertices[quads.irregular], writer.attributes(writer.layer(f"{QUADS}::Irregular nodes", (60, 60, 60))))
    surface = writer.layer(f"{QUADS}::Surface", (160, 160, 160), visible=False)
    problem = quads.problem
    writer.mesh(mesh_from_arrays(problem.vertices, problem.faces), writer.attributes(surface, problem.drawing.name))
    writer.document_text([("compas_cgc.quads", quads.summary())])
    write_archive(writer.archive, path, 7)
