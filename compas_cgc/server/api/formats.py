"""A result in the formats that clients ask for."""

from __future__ import annotations

import json

import numpy as np

from ...model.result import History
from ...model.roles import INTERNAL
from ...model.roles import ROLES
from .decoding import packed
from .mesh_files import KINDS
from .mesh_files import file_bytes
from .serialization import unpack
from .serialization import unpack_arrays

__all__ = ["FORMATS", "beside", "encoded", "get_ready"]

FORMATS = {**dict.fromkeys(("arrays", "packed", "compas", "hops"), "application/json"), **KINDS}


def encoded(name: str, content: bytes) -> bytes:
    """Return a packed result in a format.

    Parameters
    ----------
    name
        ``arrays``, ``packed``, ``compas``, ``hops``, ``3dm`` or ``obj``.
    content
        See :func:`compas_cgc.server.api.serialization.pack`.
    """
    if name in ("arrays", "packed"):
        return _arrays(content, name == "packed")
    result, _ = unpack(content)
    if name == "compas":
        from compas.data import json_dumps

        return json_dumps(result.mesh).encode("utf-8")
    if name == "hops":
        from ..hops.geometry import mesh_text

        return mesh_text(*result.mesh.arrays()).encode()
    return file_bytes(name, result)


def get_ready() -> None:
    """Load what files take, so that the first does not wait for it."""
    from ... import io as files  # noqa: F401
    from ...datastructures import CGCMesh  # noqa: F401
    from ...io import rhino  # noqa: F401


def beside(content: bytes, source: bytes) -> bytes:
    """Return a packed result as a .3dm file beside what is in the bytes of another."""
    return file_bytes("3dm", unpack(content)[0], source)


def _arrays(content: bytes, in_bytes: bool) -> bytes:
    """Return everything as JSON, arrays of numbers as lists with null for what is no number, or as packed arrays.

    Straight from the arrays: with the COMPAS mesh in between it would take thrice the time.
    """
    from ...discrete import gaussian_curvature
    from ...meshing import crease_paths

    column = packed if in_bytes else _column
    data, words = unpack_arrays(content)
    report = words.pop("report")
    words.pop("name")
    vertices, faces, roles = data["vertices"], data["faces"], data["roles"]
    K = np.where(roles == INTERNAL, gaussian_curvature(vertices, faces), np.nan)
    names = np.array(ROLES, dtype=object)
    body = {
        **{name: _plain(value) for name, value in words.items()},
        "vertices": packed(vertices) if in_bytes else vertices.tolist(),
        "faces": packed(faces) if in_bytes else faces.tolist(),
        "roles": names[roles].tolist(),
        "targets": column(data["target"]),
        "curvature": column(K),
        "creases": crease_paths(tuple(edge) for edge in data["keys"][data["creases"]].tolist()),
        "history": {name: _plain(data[f"history_{name}"].tolist()) for name in History._fields},
        "report": _plain(report),
    }
    return json.dumps(body, ensure_ascii=False, allow_nan=False).encode("utf-8")


def _column(values: np.ndarray) -> list:
    """Return numbers as a list with None for those that are none."""
    return np.where(np.isfinite(values), values.astype(object), None).tolist()


def _plain(value: object) -> object:
    if isinstance(value, dict):
        return {name: _plain(item) for name, item in value.items()}
    if isinstance(value, (list, tuple)):
        return [_plain(item) for item in value]
    return None if isinstance(value, float) and not np.isfinite(value) else value
