"""Builds: jobs that make something of a solved surface, or look for the limits of its supports, instead of solving.

A build's content is an archive of plain files: what was made as JSON, and in every format that it is written in.
"""

from __future__ import annotations

import io
import json
import tempfile
import zipfile
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from ...errors import CGCError
from ...execution.worker import report
from ...fabrication.plain_data import build_data
from ...fabrication.plain_data import plain
from ...fabrication.tasks import TASKS
from ...fabrication.tasks import build
from ...fabrication.tasks import read_settings
from ...io.builds import BUILD_SUFFIXES
from ...io.builds import write_build
from ...model.problem import CGCProblem
from ..errors import Unprocessable
from ..limits import Limits

__all__ = ["BUILD_FORMATS", "SOLVE", "TASK_NAMES", "build_file", "built", "check_build", "is_build", "tasks"]

SOLVE, LIMITS = "solve", "limits"
TASK_NAMES = (SOLVE, *TASKS, LIMITS)
_JSON = "application/json"
BUILD_FORMATS = {
    "arrays": _JSON,
    "json": _JSON,
    "3dm": "model/vnd.3dm",
    "dxf": "image/vnd.dxf",
    "svg": "image/svg+xml",
    "csv": "text/csv",
    "list.csv": "text/csv",
    "plan.dxf": "image/vnd.dxf",
    "plan.svg": "image/svg+xml",
    "zip": "application/zip",
    "inp": "text/plain",
}
_MARK = b"CGC build\n"
_STAGES = 3  # read, make, write
_LIMITS_TEXT = "Let the targets grow, all in the same ratio, until no fair surface meets them any more, and say where that is."
_LIMITS_OPTIONS = {
    "tolerance": {
        "type": "number",
        "exclusiveMinimum": 0,
        "exclusiveMaximum": 1,
        "default": 0.02,
        "description": "how closely to tell, as a part",
    }
}


def tasks() -> list[dict]:
    """Return every task but the solve, with its text, its options and the formats of its result."""
    built = [
        {
            "name": own.name,
            "text": own.text,
            "options": [{"name": option.name, **option.schema, "description": option.text} for option in own.options],
            "formats": ["arrays", *(suffix[1:] for suffix in BUILD_SUFFIXES[own.name])],
        }
        for own in TASKS.values()
    ]
    options = [{"name": name, **schema} for name, schema in _LIMITS_OPTIONS.items()]
    return [*built, {"name": LIMITS, "text": _LIMITS_TEXT, "options": options, "formats": ["arrays"]}]


def check_build(task: str, settings: object, limits: Limits) -> dict[str, Any]:
    """Return the settings of a task as they were given, when they are such.

    Raises
    ------
    Unprocessable
        With a sentence that names the setting.
    """
    given = {} if settings is None else settings
    if not isinstance(given, dict):
        raise Unprocessable("'settings' must be an object of settings by name")
    _read(task, given)
    return given


def _read(task: str, given: Mapping[str, Any]) -> dict[str, Any]:
    try:
        if task != LIMITS:
            return read_settings(task, given)
        unknown = sorted(set(given) - set(_LIMITS_OPTIONS))
        if unknown:
            raise Unprocessable(f"there is no option {unknown[0]!r:.60}; there are {', '.join(_LIMITS_OPTIONS)}")
        tolerance = given.get("tolerance", 0.02)
        if isinstance(tolerance, bool) or not isinstance(tolerance, (int, float)) or not 0.0 < tolerance < 1.0:
            raise Unprocessable(f"'tolerance' must be between 0 and 1, not {tolerance!r:.60}")
        return {"tolerance": float(tolerance)}
    except CGCError as error:
        raise Unprocessable(str(error)) from None


def built(task: str, problem: CGCProblem, given: Mapping[str, Any], notes: list[str]) -> tuple[str, bytes]:
    """Make what a task asks for, and return one sentence on it and the archive; run in a worker.

    Raises
    ------
    ValueError
        If there is no such thing, in a sentence.
    """
    settings = _read(task, given)
    report({"task": task, "stage": "build", "step": 1, "steps": _STAGES})
    if task == LIMITS:
        from ...solvers.limits import largest_target

        limit = largest_target(problem, **settings)
        told = plain({**limit.to_dict(), "text": limit.message, "notes": notes, "task": task, "formats": ["arrays"]})
        return limit.message, _archive({"arrays": _encoded(told)})
    made = build(task, problem, settings)
    report({"task": task, "stage": "write", "step": 2, "steps": _STAGES})
    files = _files(task, problem, made, settings)
    formats = ["arrays", *(name for name in files if not name.endswith(".refused"))]
    told = {**build_data(task, problem, made), "notes": notes, "task": task, "formats": formats}
    return str(made).splitlines()[0], _archive({"arrays": _encoded(told), **files})


def _encoded(told: dict) -> bytes:
    return json.dumps(told, ensure_ascii=False, allow_nan=False).encode("utf-8")


def _files(task: str, problem: CGCProblem, made: Any, settings: Mapping[str, Any]) -> dict[str, bytes]:
    """Return what was made in every format of the task, or the sentence that says why there is none."""
    found = {}
    with tempfile.TemporaryDirectory() as folder:
        for suffix in BUILD_SUFFIXES[task]:
            path = Path(folder) / f"{task}{suffix}"
            try:
                written = write_build(path, task, problem, made, settings)
                if len(written) > 1:
                    raise CGCError(f"{len(written)} files are no one answer; those of all sheets are in the format zip")
                found[suffix[1:]] = written[0].read_bytes()
            except CGCError as error:
                found[f"{suffix[1:]}.refused"] = str(error).encode("utf-8")
    return found


def _archive(files: Mapping[str, bytes]) -> bytes:
    packed = io.BytesIO()
    with zipfile.ZipFile(packed, "w", zipfile.ZIP_DEFLATED, compresslevel=1) as archive:
        for name, content in files.items():
            # Of the same time always: the same input has the same result.
            archive.writestr(zipfile.ZipInfo(name), content, zipfile.ZIP_DEFLATED, 1)
    return _MARK + packed.getvalue()


def is_build(content: bytes) -> bool:
    """Tell whether the content of a job is that of a build."""
    return content.startswith(_MARK)


def build_file(content: bytes, kind: str) -> bytes:
    """Return one of the files of a build.

    Raises
    ------
    Unprocessable
        If there is none of that kind.
    """
    with zipfile.ZipFile(io.BytesIO(content[len(_MARK) :])) as archive:
        names = archive.namelist()
        wanted = kind if kind in names else "arrays" if kind in ("json", "packed") else kind
        if wanted in names:
            return archive.read(wanted)
        if f"{kind}.refused" in names:
            raise Unprocessable(archive.read(f"{kind}.refused").decode("utf-8"))
    formats = [name for name in names if not name.endswith(".refused")]
    raise Unprocessable(f"this job has no result of the format {kind}; it has {', '.join(formats)}")
