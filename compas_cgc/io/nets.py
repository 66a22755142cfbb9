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
from ..fabrication.dxf import dxf_text
from ..fabrication.dxf import new_document
from ..fabrication.dxf import show_all
from ..fabrication.lath_files import draw_laths
from ..fabrication.lath_files import schedule_text
from ..fabrication.laths import lath_schedule
from ..fabrication.materials import metres_per_unit
from ..fabrication.plain_data import build_data
from ._files import suffix_among
from .formats import OUTPUTS

__all__ = ["write_net"]


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
    mm = 1e3 * metres_per_unit(net.problem.drawing.units)
    document = new_document("Millimeters")
    space = document.modelspace()
    for curve in net.curves:
        layer = f"{plural(curve.kind)} {curve.family + 1}".upper().replace(" ", "_")
        if layer not in document.layers:
            document.layers.add(layer)
        space.add_polyline3d((mm * curve.points).tolist(), dxfattribs={"layer": layer})
    show_all(document, mm * np.vstack([curve.points for curve in net.curves]))
    document.saveas(path)
