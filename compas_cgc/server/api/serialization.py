"""Results as bytes: no code in them, so that they can be kept and read again."""

from __future__ import annotations

import io
import json
from typing import TYPE_CHECKING
from typing import NamedTuple
from typing import Optional

import numpy as np

from ...model.result import History
from ...model.result import Solution
from ...model.result import SolveResult
from ...model.roles import DUMMY
from ...model.roles import ROLES

if TYPE_CHECKING:
    from ...datastructures import CGCMesh
    from ...model.checks import Names
    from ...model.problem import CGCProblem

__all__ = ["Outcome", "pack", "unpack", "unpack_arrays", "unpack_problem"]

WORDS = ("status", "message", "iterations", "seconds", "max_error", "method")


class Outcome(NamedTuple):
    """What a worker hands back."""

    message: str  # one sentence
    content: Optional[bytes]  # packed result, None if there is none
    stopped: bool = False  # it ended early because that was wanted


def pack(problem: CGCProblem, names: Names, name: str, solution: Solution, report: dict) -> bytes:
    """Return a solved problem without its dummies, how it was solved, and a report as bytes."""
    real = problem.without_dummies()
    words = {**{word: getattr(solution, word) for word in WORDS}, "name": name, "report": report}
    file = io.BytesIO()
    np.savez(
        file,
        vertices=solution.vertices[problem.roles != DUMMY],
        faces=real.faces,
        keys=names.vertices[problem.roles != DUMMY],
        face_keys=names.faces[problem.real_faces],
        roles=real.roles.astype(np.int8),
        target=real.targets,
        s=real.s,
        e=real.e,
        creases=real.creases,
        words=np.frombuffer(json.dumps(words).encode(), dtype=np.uint8),
        **{f"history_{name}": values for name, values in solution.history._asdict().items()},
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
    mesh = _mesh(data)
    mesh.name = words["name"]
    return SolveResult(mesh, **{word: words[word] for word in WORDS}, history=history), words["report"]


def unpack_problem(content: bytes) -> tuple[CGCProblem, dict]:
    """Return the solved problem and the words of :func:`pack`."""
    from ...model.problem import CGCProblem

    data, words = unpack_arrays(content)
    return CGCProblem(*(data[name] for name in ("vertices", "faces", "roles", "target", "s", "e", "creases"))), words


def _mesh(data: dict) -> CGCMesh:
    from ...datastructures import CGCMesh

    keys = data["keys"].tolist()
    faces = data["keys"][data["faces"]].tolist()
    mesh = CGCMesh.from_vertices_and_faces(dict(zip(keys, data["vertices"].tolist())), dict(zip(data["face_keys"].tolist(), faces)))
    for edge in data["keys"][data["creases"]].tolist():
        mesh.edge_attribute(tuple(edge), "is_crease", True)
    columns = [data[name].tolist() for name in ("roles", "target", "s", "e")]
    for key, role, target, s, e in zip(keys, *columns):
        values = {"target": target, "s": s, "e": e}
        mesh.vertex[key].update(role=ROLES[role], **{name: value for name, value in values.items() if value == value})
    return mesh
