"""Construction curves in a .3dm file: polylines by kind and family."""

from __future__ import annotations

import os
from typing import Union

from ...fabrication.curves import CurveNet
from ...fabrication.curves import plural
from .archive import write_archive
from .layers import CURVES
from .meshes import mesh_from_arrays
from .write import LayerWriter
from .write import new_archive

__all__ = ["write_net_layers"]

COLOURS = ((180, 60, 40), (40, 90, 170))


def write_net_layers(path: Union[str, os.PathLike], net: CurveNet) -> None:
    """Write curves as a .3dm file, with lengths as user text, nodes as points and the surface on a hidden layer.

    Raises
    ------
    FileError
        If the file cannot be written.
    """
    writer = LayerWriter(new_archive(net.problem))
    for label, curve in zip(net.labels, net.curves):
        layer = writer.layer(f"{CURVES}::{plural(curve.kind).capitalize()} {curve.family + 1}", COLOURS[curve.family])
        text = {"region": str(curve.region), "length": repr(curve.length), "off its chord": repr(curve.straightness)}
        writer.polyline(curve.points, writer.attributes(layer, label, text))
    if len(net.nodes):
        writer.points(net.nodes, writer.attributes(writer.layer(f"{CURVES}::Nodes", (60, 60, 60))))
    surface = writer.layer(f"{CURVES}::Surface", (160, 160, 160), visible=False)
    writer.mesh(mesh_from_arrays(net.problem.vertices, net.problem.faces), writer.attributes(surface, net.problem.drawing.name))
    writer.document_text([("compas_cgc.curves", net.summary())])
    write_archive(writer.archive, path, 7)
