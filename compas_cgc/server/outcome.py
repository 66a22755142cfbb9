"""Results as bytes: no code in them, so that they can be kept and read again."""

from __future__ import annotations

import io
import json
from typing import TYPE_CHECKING
from typing import NamedTuple
from typing import Optional

import numpy as np

from ..problem import ROLES
from ..result import History
from ..result import SolveResult

if TYPE_CHECKING:
    from ..datastructures import CGCMesh

__all__ = ["Outcome", "pack", "unpack", "unpack_arrays"]


class Outcome(NamedTuple):
    """What a worker hands back."""

    message: str  # one sentence
    content: Optional[bytes]  # packed result, None if there is none


def pack(result: SolveResult, report: dict) -> bytes:
    """Return a result and the report on it as bytes."""
    mesh = result.mesh
    vertices, faces = mesh.arrays()
    keys = list(mesh.vertices())

    def column(name: str) -> np.ndarray:
        return np.array([np.nan if mesh.vertex[key].get(name) is None else mesh.vertex[key][name] for key in keys], dtype=np.float64)

    words = {
        "status": result.status,
        "message": result.message,
        "iterations": result.iterations,
        "seconds": result.seconds,
        "max_error": result.max_error,
        "method": result.method,
        "name": mesh.name,
        "report": report,
    }
    file = io.BytesIO()
    np.savez(
        file,
        vertices=vertices,
        faces=faces,
        keys=np.array(keys, dtype=np.int64),
        face_keys=np.array(list(mesh.faces()), dtype=np.int64),
        roles=np.array([ROLES.index(role) for role in mesh.vertices_role()], dtype=np.int8),
        target=column("target"),
        s=column("s"),
        e=column("e"),
        creases=np.array(mesh.crease_edges(), dtype=np.int64).reshape(-1, 2),
        words=np.frombuffer(json.dumps(words).encode(), dtype=np.uint8),
        **{f"history_{name}": values for name, values in result.history._asdict().items()},
    )
    return file.getvalue()


def unpack_arrays(content: bytes) -> tuple[dict[str, np.ndarray], dict]:
    """Return the arrays and the words of :func:`pack` by their names there."""
    with np.load(io.BytesIO(content), allow_pickle=False) as file:
        data = {name: file[name] for name in file.files}
    return data, json.loads(data.pop("words").tobytes())


def unpack(content: bytes) -> tuple[SolveResult, dict]:
    """Return the result and the report of :func:`pack`."""
    data, words = unpack_arrays(content)
    history = History(*(data[f"history_{name}"] for name in History._fields))
    names = ("status", "message", "iterations", "seconds", "max_error")
    mesh = _mesh(data)
    mesh.name = words["name"]
    return SolveResult(mesh, *(words[name] for name in names), history, words["method"]), words["report"]


def _mesh(data: dict) -> CGCMesh:
    from ..datastructures import CGCMesh

    keys = data["keys"].tolist()
    faces = data["keys"][data["faces"]].tolist()
    mesh = CGCMesh.from_vertices_and_faces(dict(zip(keys, data["vertices"].tolist())), dict(zip(data["face_keys"].tolist(), faces)))
    for edge in data["creases"].tolist():
        mesh.edge_attribute(tuple(edge), "is_crease", True)
    columns = [data[name].tolist() for name in ("roles", "target", "s", "e")]
    for key, role, target, s, e in zip(keys, *columns):
        values = {"target": target, "s": s, "e": e}
        mesh.vertex[key].update(role=ROLES[role], **{name: value for name, value in values.items() if value == value})
    return mesh
