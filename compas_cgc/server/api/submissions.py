"""Submissions: checked bodies of job requests, ready to be queued."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any
from typing import Callable
from typing import NamedTuple
from typing import Optional

from ..errors import BadRequest
from ..errors import Unprocessable
from ..limits import Limits
from .builds import SOLVE
from .builds import TASK_NAMES
from .builds import check_build
from .builds import is_build
from .decoding import number
from .decoding import read_json
from .mesh_files import KINDS
from .options import OPTIONS
from .options import check_options
from .requests import MESH
from .requests import accept
from .searches import SEARCHES
from .serialization import NO_SURFACE

__all__ = ["FILE_OPTIONS", "Submission", "file_submission", "json_submission", "with_result"]

OF_A_SOLVE = ("method", "live", "last")
OF_A_DESIGN = ("name", "unit", "id")
LONGEST_NAME = 100  # characters
FILE_OPTIONS = ("task", "edge_length", *OPTIONS)


class Submission(NamedTuple):
    """A job to be queued."""

    kind: str  # format of the body, one of the readers
    body: bytes
    options: dict[str, Any]
    id: Optional[str]
    job: Optional[str] = None  # id of the job whose result becomes the body


def with_result(given: Submission, result_of: Callable[[str], bytes]) -> Submission:
    """Return a submission whose body is the result of the job that it refers to.

    Raises
    ------
    RequestError
        If the job has no surface.
    """
    if given.job is None:
        return given
    content = result_of(given.job)
    if is_build(content):
        raise Unprocessable(NO_SURFACE)
    return given._replace(body=content)


def json_submission(body: bytes, limits: Limits) -> Submission:
    """Return the submission of a JSON body with a mesh or the id of a solved job.

    Raises
    ------
    RequestError
        If a field is missing or invalid.
    """
    value: Any = read_json(body, limits)
    task = _task_of(value) if isinstance(value, dict) else SOLVE
    if task == SOLVE:
        content = accept(_without(value, "task"), limits, body)
        return Submission("json", content, {"name": value.get("name", "")[:LONGEST_NAME]}, _id_of(value))
    own = _without(value, "task", "settings", "job")
    common = {"task": task, "settings": check_build(task, value.get("settings"), limits), "name": value.get("name", "")}
    _refuse_options_of_a_solve(own, task)
    if value.get("job") is None:
        return Submission("json", accept(own, limits), common, _id_of(value))
    if not isinstance(value["job"], str):
        raise Unprocessable("'job' must be the id of a job")
    wrong = sorted(set(own) & set(MESH))
    if wrong:
        raise Unprocessable(f"give 'job' or {wrong[0]!r}, not both")
    unknown = sorted(set(own) - set(OPTIONS))
    if unknown:
        raise Unprocessable(f"unknown field {unknown[0]!r:.60}; the fields are task, job, {', '.join(OPTIONS)}")
    check_options(own, None, limits)
    return Submission("result", b"", {**_without(own, "id"), **common}, _id_of(value), value["job"])


def file_submission(kind: str, size: int, text: str, limits: Limits) -> Submission:
    """Return the submission of a file of a size [bytes] and its options (JSON), without the content of the file.

    Raises
    ------
    RequestError
        If an option is invalid.
    """
    if not size:
        raise BadRequest("the request is empty; send the bytes of the file")
    options: Any = read_json(text.encode("utf-8", "surrogatepass"), limits)
    if not isinstance(options, dict) or set(options) - set(FILE_OPTIONS):
        raise Unprocessable(f"'options' must be a JSON object with fields from {', '.join(FILE_OPTIONS)}")
    length = options.get("edge_length")
    if length is not None and not number(length, "'edge_length'") > 0:
        raise Unprocessable(f"'edge_length' must be greater than zero, not {length:g}")
    task = _task_of(options)
    if kind not in KINDS and not _takes_designs(task):
        raise Unprocessable(f"the task {task} takes files of the kinds {' and '.join(KINDS)}, not {kind}")
    if task == SOLVE:
        own = _without(options, "task")
        check_options(own, None, limits)
        return Submission(kind, b"", _without(own, "id"), _id_of(own))
    own = _without(options, "task", "settings")
    _refuse_options_of_a_solve(own, task)
    if _takes_designs(task):
        _refuse_options_of_a_drawing(own, task)
    check_options(own, None, limits)
    common = {"task": task, "settings": check_build(task, options.get("settings"), limits)}
    return Submission(kind, b"", {**_without(own, "id"), **common}, _id_of(own))


def _task_of(value: Mapping[str, Any]) -> str:
    task = value.get("task", SOLVE)
    if task not in TASK_NAMES:
        raise Unprocessable(f"'task' must be one of {', '.join(TASK_NAMES)}")
    if task == SOLVE and value.get("job") is not None:
        raise Unprocessable("'job' is for tasks on a solved surface, such as unroll; a solve needs a mesh")
    return task


def _refuse_options_of_a_solve(value: Mapping[str, Any], task: str) -> None:
    wrong = next((name for name in OF_A_SOLVE if name in value), None)
    if wrong is not None:
        raise Unprocessable(f"{wrong!r} is an option of a solve, but the task is {task}; leave it out")


def _takes_designs(task: str) -> bool:
    return task in SEARCHES and SEARCHES[task].of_designs


def _refuse_options_of_a_drawing(value: Mapping[str, Any], task: str) -> None:
    wrong = next((name for name in value if name not in OF_A_DESIGN), None)
    if wrong is not None:
        raise Unprocessable(f"{wrong!r} is no option of a file for the task {task}; its options are in 'settings'")


def _without(value: Any, *names: str) -> Any:
    return {name: item for name, item in value.items() if name not in names} if isinstance(value, dict) else value


def _id_of(value: Mapping[str, Any]) -> Optional[str]:
    id = value.get("id")
    if id is not None and not isinstance(id, str):
        raise Unprocessable("'id' must be a string")
    return id
