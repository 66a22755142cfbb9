"""Serialization of problems and results as bytes that contain no code, so that stored files are safe to read."""

from __future__ import annotations

import io
import json
from collections.abc import Mapping
from dataclasses import asdict
from typing import Any
from typing import Optional

import numpy as np

from ...datastructures import SolveResult
from ...model.constraint_data import constraint_data
from ...model.laws import as_law
from ...model.problem import CGCProblem
from ...model.problem import Drawing
from ...model.problem import Names
from ...model.result import History
from ...solvers.registry import method_names
from ...solvers.registry import method_of
from ...solvers.registry import settings_for
from ...solvers.settings import Settings
from ..errors import Unprocessable

__all__ = ["NO_SURFACE", "pack_problem", "pack_result", "unpack_problem", "unpack_result"]

NO_SURFACE = "this job has no solved surface; give the id of a solve"
WORDS = ("status", "message", "ending", "iterations", "seconds", "max_error", "method", "measure", "evenness")


def pack_problem(problem: CGCProblem) -> bytes:
    """Return a problem as bytes."""
    return _pack(_arrays_of(problem), _words_of(problem))


def unpack_problem(content: bytes) -> CGCProblem:
    """Return a problem from the bytes of :func:`pack_problem`."""
    return _problem_of(*_unpack(content))


def pack_result(result: SolveResult, report: dict) -> bytes:
    """Return a result and its report (plain data) as bytes."""
    words = {word: getattr(result, word) for word in WORDS}
    words.update(_words_of(result.problem), settings=_settings_data(result.settings), report=report, turned=result.turned)
    history = {f"history_{name}": values for name, values in result.history._asdict().items()}
    start = {} if result.start is None else {"start": result.start}
    return _pack({**_arrays_of(result.problem), **history, **start}, words)


def unpack_result(content: bytes) -> tuple[SolveResult, dict]:
    """Return the result and the report from the bytes of :func:`pack_result`.

    Raises
    ------
    Unprocessable
        If the bytes belong to another task.
    """
    if not content.startswith(b"PK"):
        raise Unprocessable(NO_SURFACE)
    arrays, words = _unpack(content)
    history = History(*(arrays[f"history_{name}"] for name in History._fields))
    settings = _settings_of(words.get("settings"))
    # Results of older versions have no `measure`, no `evenness` and no `ending`.
    fields = {"ending": words["message"], **{word: words[word] for word in WORDS if word in words and word != "message"}}
    start, problem = arrays.get("start"), _problem_of(arrays, words)
    if start is not None and start.shape == problem.vertices.shape:
        problem = problem.drawn_as(start, words.get("measure", ""), words.get("evenness", 0.0))
    more = {"settings": settings, "start": start, "turned": words.get("turned", 0)}
    result = SolveResult(problem, **fields, history=history, **more)
    result.__dict__["message"] = words["message"]
    return result, words["report"]


# The names of arrays and words are part of the format: results stored by older versions remain readable.


def _arrays_of(problem: CGCProblem) -> dict[str, np.ndarray]:
    return {
        "vertices": problem.vertices,
        "faces": problem.faces,
        "keys": problem.names.vertices,
        "face_keys": problem.names.faces,
        "roles": problem.roles.astype(np.int8),
        "target": problem.targets,
        "s": problem.s,
        "e": problem.e,
        "creases": problem.creases,
    }


def _words_of(problem: CGCProblem) -> dict[str, Any]:
    laws = {str(region): str(law) for region, law in problem.laws.items()}
    return {**problem.drawing._asdict(), "goals": [constraint_data(own) for own in problem.goals], "laws": laws}


def _problem_of(arrays: Mapping[str, np.ndarray], words: Mapping[str, Any]) -> CGCProblem:
    return CGCProblem(
        arrays["vertices"],
        arrays["faces"],
        arrays["roles"],
        targets=arrays["target"],
        s=arrays["s"],
        e=arrays["e"],
        creases=arrays["creases"],
        goals=words.get("goals", ()),
        laws={int(region): as_law(law) for region, law in words.get("laws", {}).items()},
        names=Names(arrays["keys"], arrays["face_keys"]),
        drawing=Drawing(words["name"], words.get("units"), words.get("tolerance"), north=tuple(words.get("north", Drawing().north))),
    )


def _settings_data(settings: object) -> Optional[list]:
    return None if not isinstance(settings, Settings) else [method_of(settings), asdict(settings)]


def _settings_of(data: Optional[list]) -> Optional[Settings]:
    # The method may have been removed since.
    return settings_for(*data) if data and data[0] in method_names() else None


def _pack(arrays: Mapping[str, np.ndarray], words: Mapping[str, Any]) -> bytes:
    file = io.BytesIO()
    named: dict[str, Any] = {**arrays, "words": np.frombuffer(json.dumps(words).encode(), dtype=np.uint8)}
    np.savez(file, **named)
    return file.getvalue()


def _unpack(content: bytes) -> tuple[dict[str, np.ndarray], dict[str, Any]]:
    with np.load(io.BytesIO(content), allow_pickle=False) as file:
        arrays = {name: file[name] for name in file.files}
    return arrays, json.loads(arrays.pop("words").tobytes())
