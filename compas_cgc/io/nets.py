"""Construction curves as files."""

from __future__ import annotations

import json
import os
from typing import Any
from typing import Union

import numpy as np

from .._atomic_write import replacing
from ..discrete.arrays import FloatArray
from ..fabrication.curves import CurveNet
from ..fabrication.curves import plural
from ..fabrication.dxf import dxf_text
from ..fabrication.dxf import new_document
from ..fabrication.dxf import show_all
from ..fabrication.lath_files import draw_laths
from ..fabrication.lath_files import schedule_text
from ..fabrication.laths import lath_schedule
from ..fabrication.materials import metres_per_unit
from ..fabrication.plain_data import build_data
from ..meshing import boundary_loops
from ._files import suffix_among
from .formats import OUTPUTS

__all__ = ["write_net"]

NAME_PLACE = 0.1  # of the names of curves along them
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
    """Write the curves in place, with their names at their starts, numbers of nodes, edges and creases of the surface, and a legend."""
    mm, problem = 1e3 * metres_per_unit(net.problem.drawing.units), net.problem
    document = new_document("Millimeters")
    space = document.modelspace()
    for layer in ("CURVE_NUMBERS", "NODE_NUMBERS", "EDGES", "CREASES", "LEGEND"):
        document.layers.add(layer)
    lengths = [mm * curve.length for curve in net.curves]
    height = TEXT * float(np.median(lengths))

    def text(words: str, place: FloatArray, size: float, layer: str) -> None:
        space.add_text(words, height=size, dxfattribs={"layer": layer}).set_placement(place.tolist())

    layers = {}
    for label, curve in zip(net.labels, net.curves):
        layer = f"{plural(curve.kind)} {curve.family + 1}".upper().replace(" ", "_")
        if layer not in layers:
            document.layers.add(layer)
        layers[layer] = f"{plural(curve.kind)}, family {curve.family}"
        space.add_polyline3d((mm * curve.points).tolist(), dxfattribs={"layer": layer})
        text(label, mm * _at(curve.points, NAME_PLACE), height, "CURVE_NUMBERS")
    for number, node in enumerate(mm * net.nodes):
        text(str(number), node, 0.6 * height, "NODE_NUMBERS")
    loops = [np.append(loop, loop[0]) for loop in boundary_loops(problem.faces)]
    for layer, paths in (("EDGES", loops), ("CREASES", problem.crease_paths())):
        for vertices in paths:
            space.add_polyline3d((mm * problem.vertices[vertices]).tolist(), dxfattribs={"layer": layer})
    # Below the model in plan.
    corner = mm * problem.vertices.min(axis=0)
    notes = [
        "curves in place, 1:1; x, y, z in mm, in the coordinates of the model, x and y in plan, z up, with its origin",
        *(f"{layer}: {meaning}" for layer, meaning in sorted(layers.items())),
        "CURVE_NUMBERS: on every curve near its start; L: asymptotic curve, with the number of its lath in the schedule of laths; C: line "
        "of curvature; R: ruling",
        "NODE_NUMBERS: crossings of curves, with the numbers of the schedule of laths" if len(net.nodes) else "",
        f"EDGES: edges of the surface{'; CREASES: its creases' if len(problem.creases) else ''}; curves end there",
        f"{len(net.curves)} curves of {min(lengths):.0f} to {max(lengths):.0f} mm",
    ]
    for row, note in enumerate(filter(None, notes)):
        text(note, corner - [0.0, (2.0 + row) * 1.8 * height, 0.0], height, "LEGEND")
    show_all(document, mm * np.vstack([problem.vertices, corner / mm - [0.0, 20.0 * height / mm, 0.0]]))
    document.saveas(path)


def _at(points: FloatArray, share: float) -> FloatArray:
    """Return the point of a polyline (k, 3) at a share of its length (3,)."""
    along = np.r_[0.0, np.cumsum(np.linalg.norm(np.diff(points, axis=0), axis=1))]
    return np.array([np.interp(share * along[-1], along, coordinate) for coordinate in points.T])
