"""Construction curves as files."""

from __future__ import annotations

import json
import os
from typing import Any
from typing import Union

import numpy as np

from .._atomic_write import replacing
from ..fabrication.curves import CurveNet
from ..fabrication.curves import plural
from ..fabrication.drawing import text_box
from ..fabrication.dxf import dxf_text
from ..fabrication.front_view import front_view
from ..fabrication.lath_files import draw_laths
from ..fabrication.lath_files import schedule_text
from ..fabrication.laths import lath_schedule
from ..fabrication.materials import metres_per_unit
from ..fabrication.picture_key import key_of
from ..fabrication.plain_data import build_data
from ..fabrication.start_labels import names_at_starts
from ..meshing import boundary_loops
from ._files import suffix_among
from .formats import OUTPUTS
from .model_dxf import FIRST
from .model_dxf import GREY
from .model_dxf import INK
from .model_dxf import SECOND
from .model_dxf import ModelDxf

__all__ = ["write_net"]

TEXT = 0.025  # height of names of curves, relative to their median length


def write_net(path: Union[str, os.PathLike], net: CurveNet, **laths: Any) -> None:
    """Write curves as polylines in the format of the suffix, atomically.

    Parameters
    ----------
    path
        A .3dm, or a .dxf in millimetres, with one layer per kind and family, a .json with points, lengths and nodes, a .laths.csv with
        the stations of nodes along asymptotic laths, or a .laths.dxf with the straight strips.
    net
        Curves from :func:`compas_cgc.fabrication.curve_net`.
    laths
        Options of :func:`compas_cgc.fabrication.laths.lath_schedule` for .laths files.

    Raises
    ------
    FileError
        If the file cannot be written.
    CGCError
        If a package that the format requires is missing.
    """
    suffix = suffix_among(path, OUTPUTS["net"], "curves")
    if suffix == ".3dm":
        from .rhino.nets import write_net_layers

        write_net_layers(path, net)
        return
    if suffix.startswith(".laths"):
        schedule = lath_schedule(net, **laths)
        text = schedule_text(schedule) if suffix.endswith(".csv") else dxf_text(draw_laths(schedule))
        with replacing(path) as temporary:
            temporary.write_bytes(text.encode("utf-8"))
        return
    with replacing(path) as temporary:
        if suffix == ".json":
            temporary.write_bytes((json.dumps(build_data("net", net.problem, net)) + "\n").encode("utf-8"))
        else:
            _write_dxf(str(temporary), net)


def _write_dxf(path: str, net: CurveNet) -> None:
    """Write the curves in place, with their names beyond their starts, numbers of nodes, edges and creases of the surface, and a legend."""
    mm, problem = 1e3 * metres_per_unit(net.problem.drawing.units), net.problem
    lengths = [mm * curve.length for curve in net.curves]
    height = TEXT * float(np.median(lengths))
    axes = front_view(problem)
    drawing = ModelDxf(height, axes)
    for name, colour in (("CURVE_NUMBERS", INK), ("NODE_NUMBERS", GREY), ("EDGES", INK), ("CREASES", INK)):
        drawing.layer(name, colour)
    layers = {}
    above = mm * net.nodes + 0.9 * height * axes[1]
    boxes = [text_box(str(number), place, 0.6 * height) for number, place in enumerate(above @ axes[:2].T)]
    places = names_at_starts(net.labels, [mm * curve.points @ axes[:2].T for curve in net.curves], height, boxes)
    for label, curve, place in zip(net.labels, net.curves, places):
        layer = f"{plural(curve.kind)} {curve.family + 1}".upper().replace(" ", "_")
        layers[layer] = f"{plural(curve.kind)}, family {curve.family}, {'red' if curve.family else 'blue'}"
        drawing.layer(layer, SECOND if curve.family else FIRST)
        drawing.polyline(mm * curve.points, layer)
        drawing.text(label, np.append(place, mm * curve.points[0] @ axes[2]) @ axes, height, "CURVE_NUMBERS")
    for number, place in enumerate(above):
        drawing.text(str(number), place, 0.6 * height, "NODE_NUMBERS")
    loops = [np.append(loop, loop[0]) for loop in boundary_loops(problem.faces)]
    for layer, paths in (("EDGES", loops), ("CREASES", problem.crease_paths())):
        for vertices in paths:
            drawing.polyline(mm * problem.vertices[vertices], layer)
    notes = [
        "curves in place, 1:1; x, y, z in mm, in the coordinates of the model, x and y in plan, z up, with its origin",
        *(f"{layer}: {meaning}" for layer, meaning in sorted(layers.items())),
        "CURVE_NUMBERS: beyond the start of every curve; L: asymptotic curve, with the number of its lath in the schedule of laths; C: "
        "line of curvature; R: ruling",
        "NODE_NUMBERS: above crossings of curves, with the numbers of the schedule of laths" if len(net.nodes) else "",
        f"EDGES: edges of the surface{'; CREASES: its creases' if len(problem.creases) else ''}; curves end there",
        f"{len(net.curves)} curves of {min(lengths):.0f} to {max(lengths):.0f} mm",
    ]
    drawing.save(path, [note for note in notes if note], key_of(problem))
