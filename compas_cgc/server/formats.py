"""A result in the formats that clients ask for."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING

import numpy as np

from .outcome import unpack
from .uploads import KINDS
from .uploads import file_bytes

if TYPE_CHECKING:
    from ..result import SolveResult

__all__ = ["FORMATS", "encoded"]

FORMATS = {"arrays": "application/json", "compas": "application/json", "hops": "application/json", **KINDS}


def encoded(name: str, content: bytes) -> bytes:
    """Return a packed result in a format.

    Parameters
    ----------
    name
        ``arrays``, ``compas``, ``hops``, ``3dm`` or ``obj``.
    content
        See :func:`compas_cgc.server.outcome.pack`.
    """
    result, report = unpack(content)
    if name == "arrays":
        return _arrays(result, report)
    if name == "compas":
        from compas.data import json_dumps

        return json_dumps(result.mesh).encode("utf-8")
    if name == "hops":
        from .hops.geometry import mesh_text

        return mesh_text(*result.mesh.arrays()).encode()
    return file_bytes(name, result)


def _arrays(result: SolveResult, report: dict) -> bytes:
    """Return everything as plain JSON; what is no number is null."""
    from ..discrete import gaussian_curvature

    mesh = result.mesh
    vertices, faces = mesh.arrays()
    targets = [None if K is None else float(K) for K in mesh.vertices_target()]
    roles = mesh.vertices_role()
    wanted = np.array([role == "internal" for role in roles])
    K = np.where(wanted, gaussian_curvature(vertices, faces), np.nan)
    body = {
        "status": result.status,
        "message": result.message,
        "method": result.method,
        "iterations": result.iterations,
        "seconds": result.seconds,
        "max_error": _plain(result.max_error),
        "vertices": vertices.tolist(),
        "faces": faces.tolist(),
        "roles": roles,
        "targets": targets,
        "curvature": _plain(K.tolist()),
        "creases": mesh.creases(),
        "history": {name: _plain(values) for name, values in result.history.to_dict().items()},
        "report": _plain(report),
    }
    return json.dumps(body, ensure_ascii=False, allow_nan=False).encode("utf-8")


def _plain(value: object) -> object:
    if isinstance(value, dict):
        return {name: _plain(item) for name, item in value.items()}
    if isinstance(value, (list, tuple)):
        return [_plain(item) for item in value]
    return None if isinstance(value, float) and not np.isfinite(value) else value
