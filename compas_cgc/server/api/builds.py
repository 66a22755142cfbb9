"""Builds: jobs that derive something from a solved surface, such as moulds, and searches.

The result of a build is an archive of files: the data as JSON, and one file for every other format.
"""

from __future__ import annotations

import io
import json
import tempfile
import zipfile
from collections.abc import Mapping
from pathlib import Path
from typing import Any
from typing import Union

from ...errors import CGCError
from ...errors import sentence_of
from ...execution.worker import report
from ...fabrication.plain_data import build_data
from ...fabrication.tasks import TASKS
from ...fabrication.tasks import Task
from ...fabrication.tasks import build
from ...fabrication.tasks import read_options
from ...fabrication.tasks import read_settings
from ...io.builds import write_build
from ...io.formats import MEDIA_TYPES
from ...io.formats import OUTPUTS
from ...model.problem import CGCProblem
from ..errors import Unprocessable
from ..limits import Limits
from .searches import SEARCHES
from .searches import Search

__all__ = ["BUILD_FORMATS", "SOLVE", "TASK_NAMES", "build_file", "built", "check_build", "is_build", "tasks"]

SOLVE = "solve"
TASK_NAMES = (SOLVE, *TASKS, *SEARCHES)
BUILD_FORMATS = {
    "arrays": MEDIA_TYPES[".json"],
    **{suffix[1:]: MEDIA_TYPES[Path(suffix).suffix or suffix] for suffixes in OUTPUTS.values() for suffix in suffixes},
}
_MARK = b"CGC build\n"
_STAGES = 3  # read, make, write


def tasks() -> list[dict]:
    """Return every task except the solve, with its description, options and result formats."""
    formats = {own.name: [suffix[1:] for suffix in OUTPUTS[own.name]] for own in TASKS.values()}
    formats.update({own.name: list(own.formats) for own in SEARCHES.values()})
    own_tasks: list[Union[Task, Search]] = [*TASKS.values(), *SEARCHES.values()]
    return [
        {
            "name": own.name,
            "text": own.text,
            "options": [{"name": option.name, **option.schema, "description": option.text} for option in own.options],
            "formats": ["arrays", *formats[own.name]],
        }
        for own in own_tasks
    ]


def check_build(task: str, settings: object, limits: Limits) -> dict[str, Any]:
    """Return the settings of a task after checking them.

    Raises
    ------
    Unprocessable
        If a setting is unknown or invalid.
    """
    given = {} if settings is None else settings
    if not isinstance(given, dict):
        raise Unprocessable("'settings' must be an object that maps names of settings to values")
    _read(task, given)
    return given


def _read(task: str, given: Mapping[str, Any]) -> dict[str, Any]:
    try:
        return read_settings(task, given) if task in TASKS else read_options(SEARCHES[task].options, given)
    except CGCError as error:
        raise Unprocessable(sentence_of(error)) from None


def built(task: str, problem: Any, given: Mapping[str, Any], notes: list[str]) -> tuple[str, bytes]:
    """Run a task on a problem, or on a design, in a worker; return one sentence that summarises the result, and the archive.

    Raises
    ------
    ValueError
        If the task cannot be carried out on this surface.
    """
    settings = _read(task, given)
    report({"task": task, "stage": "build", "step": 1, "steps": _STAGES})
    if task in SEARCHES:
        found = SEARCHES[task].run(problem, settings)
        data = {**found.data, "notes": [*notes, *found.notes], "task": task, "formats": ["arrays", *found.files]}
        return found.message, _archive({"arrays": _encoded(data), **found.files})
    made = build(task, problem, settings)
    report({"task": task, "stage": "write", "step": 2, "steps": _STAGES})
    files = _files(task, problem, made, settings)
    formats = ["arrays", *(name for name in files if not name.endswith(".refused"))]
    data = {**build_data(task, problem, made), "notes": notes, "task": task, "formats": formats}
    return str(made).splitlines()[0], _archive({"arrays": _encoded(data), **files})


def _encoded(data: dict) -> bytes:
    return json.dumps(data, ensure_ascii=False, allow_nan=False).encode("utf-8")


def _files(task: str, problem: CGCProblem, made: Any, settings: Mapping[str, Any]) -> dict[str, bytes]:
    """Return the file in every format of the task; a format that cannot be written is replaced by a note."""
    found = {}
    with tempfile.TemporaryDirectory() as folder:
        for suffix in OUTPUTS[task]:
            path = Path(folder) / f"{task}{suffix}"
            try:
                written = write_build(path, task, problem, made, settings)
                if len(written) > 1:
                    raise CGCError(f"the format gives {len(written)} files, one per sheet; request the format zip")
                found[suffix[1:]] = written[0].read_bytes()
            except CGCError as error:
                found[f"{suffix[1:]}.refused"] = str(error).encode("utf-8")
    return found


def _archive(files: Mapping[str, bytes]) -> bytes:
    packed = io.BytesIO()
    with zipfile.ZipFile(packed, "w", zipfile.ZIP_DEFLATED, compresslevel=1) as archive:
        for name, content in files.items():
            # A constant time stamp: the same input gives the same bytes.
            archive.writestr(zipfile.ZipInfo(name), content, zipfile.ZIP_DEFLATED, 1)
    return _MARK + packed.getvalue()


def is_build(content: bytes) -> bool:
    """Check whether the result of a job is that of a build."""
    return content.startswith(_MARK)


def build_file(content: bytes, kind: str) -> bytes:
    """Return one file of a build.

    Raises
    ------
    Unprocessable
        If the build has no file of this format.
    """
    with zipfile.ZipFile(io.BytesIO(content[len(_MARK) :])) as archive:
        names = archive.namelist()
        wanted = kind if kind in names else "arrays" if kind in ("json", "packed") else kind
        if wanted in names:
            return archive.read(wanted)
        if f"{kind}.refused" in names:
            raise Unprocessable(archive.read(f"{kind}.refused").decode("utf-8"))
    formats = [name for name in names if not name.endswith(".refused")]
    raise Unprocessable(f"this job has no result in the format {kind}; its formats are {', '.join(formats)}")
