"""Patterns in a .3dm file: sheets beside the model, and pieces in their final position."""

from __future__ import annotations

import os
from typing import Union

import numpy as np

from ...discrete.plan import flattened
from ...fabrication.drawing import LAYERS
from ...fabrication.drawing import roomiest
from ...fabrication.patterns import Patterns
from ...fabrication.sheet_drawing import draw_sheets
from .archive import write_archive
from .layers import PATTERNS
from .meshes import mesh_from_arrays
from .write import LayerWriter
from .write import new_archive

__all__ = ["write_pattern_layers"]


def write_pattern_layers(path: Union[str, os.PathLike], patterns: Patterns, nodes: bool = True) -> None:
    """Write patterns as a .3dm file: one layer per kind of line, and the pieces as meshes in their final position.

    Raises
    ------
    FileError
        If the file cannot be written.
    """
    problem = patterns.problem
    writer = LayerWriter(new_archive(problem))
    drawing = draw_sheets(patterns, nodes=nodes)
    # Offset the sheets from the model so that they do not overlap.
    low, high = problem.vertices.min(axis=0), problem.vertices.max(axis=0)
    beside = np.array([high[0] + 0.2 * float(np.linalg.norm(high - low)), low[1], low[2]])
    hidden = ("NODE", "LEGEND")
    layers = {name: writer.layer(f"{PATTERNS}::{_title(name)}", colour, visible=name not in hidden) for name, colour in LAYERS.items()}
    for line in drawing.lines:
        points = np.vstack([line.points, line.points[:1]]) if line.closed else line.points
        writer.polyline(flattened(points) + beside, writer.attributes(layers[line.layer]))
    for text in drawing.texts:
        writer.dot(text.text, flattened(text.place[None])[0] + beside, writer.attributes(layers[text.layer]))
    in_place = writer.layer(f"{PATTERNS}::In place", (140, 110, 60), visible=False)
    named = writer.attributes(writer.layer(f"{PATTERNS}::Names in place", LAYERS["LABEL"], visible=False))
    own = patterns.patchwork
    for number, piece in enumerate(patterns.pieces):
        faces = own.faces[own.piece == number]
        used, corners = np.unique(faces, return_inverse=True)
        middles = own.space[faces].mean(axis=1)
        place, _ = roomiest(middles[:, :2], [own.space[loop.nodes, :2] for loop in piece.loops], piece.label)
        writer.dot(piece.label, middles[np.argmin(np.linalg.norm(middles[:, :2] - place, axis=1))], named)
        figures = {"piece": piece.label, "region": str(piece.region), "sheet": str(piece.sheet + 1), "area": repr(piece.area)}
        attributes = writer.attributes(in_place, piece.label, {**figures, "largest strain": repr(piece.strain)})
        writer.mesh(mesh_from_arrays(own.space[used], corners.reshape(-1, 3)), attributes)
    writer.document_text([("compas_cgc.patterns", patterns.summary())])
    write_archive(writer.archive, path, 7)


def _title(name: str) -> str:
    return name.replace("_", " ").capitalize()
