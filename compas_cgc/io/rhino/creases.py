"""Conversion of curves to creases along the edges of a mesh."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ...discrete import boundary_vertices
from ...discrete.arrays import FloatArray
from ...discrete.arrays import IntArray
from ...errors import MeshError
from ...meshing import Diagnostic
from ...meshing.map_matching import EdgeNet
from ...meshing.map_matching import edge_net
from ...meshing.split import split_along
from ...meshing.split import split_path
from ...meshing.trace import Trace
from ...meshing.trace import path_deviation
from ...meshing.trace import trace_curve
from .meshes import JoinedMesh
from .sketch import Drawn
from .user_text import user_number

__all__ = ["CREASE_MODES", "Creases", "lay_creases"]

CREASE_MODES = ("trace", "split")


class Creases(NamedTuple):
    """Creases on a mesh, which is split along them on request."""

    mesh: JoinedMesh
    paths: list[list[int]]  # vertex paths along edges
    s: FloatArray  # (n,) factor of S1, NaN if not set
    e: FloatArray  # (n,) delay of S2, NaN if not set
    notes: list[str]
    diagnostics: list[Diagnostic]


class _Ground(NamedTuple):
    """Mesh with the creases laid so far."""

    mesh: JoinedMesh
    net: EdgeNet
    laid: list[list[list[int]]]  # paths of every curve


class _NotLaid(Exception):
    """A curve cannot become a crease; the message states the reason."""


def lay_creases(drawn: list[Drawn], mesh: JoinedMesh, supports: IntArray, tolerance: float, mode: str, unit: str) -> Creases:
    """Lay curves along the edges of a mesh.

    Curves along edges are used directly. For other curves, ``"trace"`` selects the best
    path of edges and ``"split"`` cuts the mesh along the curve. User text ``s`` and ``e``
    of a curve sets the strategies S1 and S2 on its crease.

    Parameters
    ----------
    drawn
        Curves.
    mesh
        The mesh.
    supports
        ``(k,)`` fixed vertices.
    tolerance
        Largest distance of the vertices that lie on a curve [L].
    mode
        ``"trace"`` or ``"split"``.
    unit
        Unit appended to lengths in messages.
    """
    if mode not in CREASE_MODES:
        raise ValueError(f"crease must be one of {', '.join(CREASE_MODES)}, not {mode!r}")
    notes: list[str] = []
    diagnostics: list[Diagnostic] = []
    used: list[Drawn] = []
    ground = _Ground(mesh, edge_net(mesh.vertices, mesh.faces), [])
    for item in drawn:
        curve = item.points
        try:
            if len(curve) < 2:
                raise _NotLaid(f"crease {item.label} has no length; delete it")
            trace = trace_curve(ground.net, curve, tolerance, _anchors(ground))
            if mode == "split" and not trace.exact:
                ground, note = _split(ground, item, curve, supports, tolerance, unit)
            else:
                ground, note = _trace(ground, item, trace, tolerance, unit)
        except _NotLaid as error:
            diagnostics.append(Diagnostic(str(error)))
            continue
        used.append(item)
        notes += [note] if note else []
    s, e = (np.full(len(ground.mesh.vertices), np.nan) for _ in range(2))
    for item, paths in zip(used, ground.laid):
        on = [v for path in paths for v in path]
        for values, key in ((s, "s"), (e, "e")):
            value = user_number(item.text, key)
            if value is not None:
                values[on] = value
    if used:
        notes.insert(0, f"{len(used)} curve{'s are creases' if len(used) > 1 else ' is a crease'}")
    return Creases(ground.mesh, [path for paths in ground.laid for path in paths], s, e, notes, diagnostics)


def _anchors(ground: _Ground) -> np.ndarray:
    """Return a mask (n,) of the vertices where a crease may end: on the boundary and on other creases."""
    marked = boundary_vertices(ground.mesh.vertices, ground.mesh.faces)
    marked[[v for paths in ground.laid for path in paths for v in path]] = True
    return marked


def _trace(ground: _Ground, item: Drawn, trace: Trace, tolerance: float, unit: str) -> tuple[_Ground, str]:
    """Lay a curve along edges, and return a note on their distance from the curve."""
    if not trace.paths:
        raise _NotLaid(f"crease {item.label} does not lie on the mesh; move it onto the mesh, or hide it")
    parts = []
    if not trace.exact:
        share = trace.deviation / float(ground.net.lengths.data.mean())
        parts.append(
            "does not follow mesh edges; the nearest path of edges was used, "
            f"up to {trace.deviation:.3g}{unit} away ({share:.2g} of a mean edge)"
        )
    if trace.outside > tolerance:
        parts.append(f"lies off the mesh for {trace.outside:.3g}{unit}, which was ignored")
    note = f"crease {item.label} {', and '.join(parts)}" if parts else ""
    return ground._replace(laid=[*ground.laid, trace.paths]), note


def _split(ground: _Ground, item: Drawn, curve: FloatArray, supports: IntArray, tolerance: float, unit: str) -> tuple[_Ground, str]:
    """Cut the mesh along a curve, and the earlier creases where it crosses them."""
    mesh = ground.mesh
    keep = _anchors(ground)
    keep[supports] = True
    try:
        split = split_along(mesh.vertices, mesh.faces, curve, tolerance, keep)
    except MeshError:
        split = None
    if split is None:
        raise _NotLaid(f"the mesh cannot be split along crease {item.label}; draw it on the mesh without loops, or use the mode 'trace'")
    new = mesh._replace(vertices=split.vertices, faces=split.faces, owner=mesh.owner[split.parent])
    laid = [[split_path(path, split.inserted) for path in paths] for paths in ground.laid]
    deviation = max(path_deviation(split.vertices, path, curve, both=False) for path in split.paths)
    added = len(split.vertices) - len(mesh.vertices)
    note = f"the mesh was split along crease {item.label}: {added} new vertices, up to {deviation:.3g}{unit} from the curve"
    return _Ground(new, edge_net(new.vertices, new.faces), [*laid, split.paths]), note
