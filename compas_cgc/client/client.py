"""HTTP client of the compute server."""

from __future__ import annotations

import http.client
import json
import random
import time
import urllib.error
import urllib.request
import uuid
from collections.abc import Iterable
from collections.abc import Mapping
from contextlib import suppress
from typing import Any
from typing import Callable
from typing import Literal
from typing import Optional
from typing import Protocol
from typing import Union
from typing import overload
from typing import runtime_checkable
from urllib.parse import quote
from urllib.parse import urlencode

from .errors import ClientError
from .errors import Failed
from .errors import Refused
from .errors import ServerUnavailable
from .packed import Rows
from .packed import pack
from .packed import unpack

__all__ = ["Client"]

API = 1
MAX_PAUSE = 30.0  # upper limit of the pause requested by a server [s]
LONG_INTERVAL = 1.0  # polling interval without callbacks [s]; limits the delay of Ctrl-C
LOST = (OSError, http.client.HTTPException)
# Connections to the local machine bypass the system proxy.
_DIRECT = urllib.request.build_opener(urllib.request.ProxyHandler({}))


@runtime_checkable
class Listable(Protocol):
    """A NumPy array or scalar."""

    def tolist(self) -> Any:
        """Return the array as lists of Python numbers, or the scalar as a Python number."""
        ...


class Client:
    """Client of a compute server.

    Parameters
    ----------
    url
        Address of the server.
    key
        Key of the server, if it has one.
    retries
        Number of retries after a lost connection or a busy response, with increasing pauses.
    timeout
        Time limit of a response [s]. The duration of a solve is not limited.

    Examples
    --------
    >>> from compas_cgc.client import Client
    >>> Client("http://127.0.0.1:7331", key="a key").url
    'http://127.0.0.1:7331'
    """

    def __init__(self, url: str = "http://127.0.0.1:7331", key: Optional[str] = None, retries: int = 5, timeout: float = 30.0):
        self.url = url.rstrip("/")
        self.key = key
        self.retries = retries
        self.timeout = timeout

    # ------------------------------------------------------------------
    # Solves
    # ------------------------------------------------------------------

    def solve(
        self,
        vertices: Rows,
        faces: Rows,
        on_progress: Optional[Callable[[dict], object]] = None,
        cancel: Optional[Callable[[], bool]] = None,
        interval: float = 0.2,
        id: Optional[str] = None,
        **options: object,
    ) -> dict:
        """Solve and wait for the result.

        Parameters
        ----------
        vertices
            ``(n, 3)`` coordinates [L].
        faces
            Lists of vertex indices.
        on_progress
            Called with the first status, and with every changed status.
        cancel
            Called at every poll; True stops the solve.
        interval
            Polling interval [s]; shorter with `cancel`, longer without callbacks.
        id
            Id of the job. Default: a new id.
        options
            ``supports``, ``creases``, ``targets``, ``goals``, ``method``, ``settings``, ``flip``, ``roles``, ``name``.

        Returns
        -------
        dict
            Result with ``id``, ``vertices``, ``faces``, ``status``, ``message``, ``max_error``, ``curvature``, ``history``, ``report``.

        Raises
        ------
        ServerUnavailable, Refused, Failed
            If the server is not available, it rejects the request, or the job fails.
        """
        return self._fetched(self.submit(vertices, faces, id, **options), on_progress, cancel, interval)

    def _fetched(
        self, id: str, on_progress: Optional[Callable[[dict], object]], cancel: Optional[Callable[[], bool]], interval: float
    ) -> dict:
        try:
            return self._followed(id, on_progress, cancel, interval)
        except (Failed, Refused, ServerUnavailable):
            raise
        except BaseException:
            # Nobody would fetch the result after Ctrl-C or an error in a callback.
            with suppress(ClientError):
                self.cancel(id)
            raise

    def _followed(
        self, id: str, on_progress: Optional[Callable[[dict], object]], cancel: Optional[Callable[[], bool]], interval: float
    ) -> dict:
        pause = interval if cancel is None else min(interval, 0.05)
        # The server responds at the end of the job; intermediate polls are only needed for callbacks.
        wait = pause if on_progress or cancel else max(interval, LONG_INTERVAL)
        told: Optional[dict] = None
        while True:
            looked = time.monotonic()
            status = self.poll(id, wait=wait)
            # A job may be queued for minutes: a change of the elapsed time alone is not reported.
            news = {**status, "elapsed": None}
            if on_progress is not None and news != told:
                on_progress(status)
            told = news
            if status["state"] == "succeeded":
                return self.result(id)
            if status["state"] in ("failed", "cancelled"):
                raise Failed(status["message"] or status["state"], status["state"])
            if cancel is not None and cancel():
                self.cancel(id)
                cancel = None
            # The server responds at once if too many clients wait for their jobs.
            time.sleep(max(0.0, pause - (time.monotonic() - looked)))

    def build(
        self,
        task: str,
        vertices: Optional[Rows] = None,
        faces: Optional[Rows] = None,
        *,
        job: Optional[str] = None,
        settings: Optional[dict] = None,
        on_progress: Optional[Callable[[dict], object]] = None,
        cancel: Optional[Callable[[], bool]] = None,
        interval: float = 0.2,
        id: Optional[str] = None,
        **options: object,
    ) -> dict:
        """Run a task on a solved surface and wait for the result.

        Parameters
        ----------
        task
            ``mould``, ``unroll``, ``membrane``, ``net``, or ``limits`` for the largest feasible curvature. See :meth:`tasks`.
        vertices, faces
            The solved surface; its ``creases``, ``targets`` and ``supports`` are options.
        job
            Id of the job that solved the surface, instead of vertices and faces.
        settings
            Settings of the task, such as ``{"sheet": "3.0x1.5"}``.
        on_progress, cancel, interval, id, options
            See :meth:`solve`.

        Returns
        -------
        dict
            Result with ``id``, a summary ``text``, ``formats`` for :meth:`result`, and arrays.

        Raises
        ------
        ServerUnavailable, Refused, Failed
            If the server is not available, it rejects the request, or the job fails.
        """
        own = self.submit_build(task, vertices, faces, job=job, settings=settings, id=id, **options)
        return self._fetched(own, on_progress, cancel, interval)

    def submit_build(
        self,
        task: str,
        vertices: Optional[Rows] = None,
        faces: Optional[Rows] = None,
        *,
        job: Optional[str] = None,
        settings: Optional[dict] = None,
        id: Optional[str] = None,
        **options: object,
    ) -> str:
        """Submit a task on a solved surface or on the result of a job, and return the id of its job."""
        if job is None:
            return self.submit(
                [] if vertices is None else vertices, [] if faces is None else faces, id, task=task, settings=settings, **options
            )
        body = {"id": id or uuid.uuid4().hex, "task": task, "job": job, "settings": settings, **_plain(options)}
        return self._json("POST", "/api/v1/jobs", body)["id"]

    def tasks(self) -> list[dict]:
        """Return the available tasks with name, text, options and formats."""
        return self._json("GET", "/api/v1/tasks")["tasks"]

    def submit(self, vertices: Rows, faces: Rows, id: Optional[str] = None, **options: object) -> str:
        """Submit a solve and return the id of its job; a retry after a lost connection does not start it twice."""
        body = {
            "id": id or uuid.uuid4().hex,
            "vertices": _packed(vertices, "f8"),
            "faces": _packed(faces, "i4"),
            **_plain(options),
        }
        return self._json("POST", "/api/v1/jobs", body)["id"]

    def submit_file(self, content: bytes, kind: str, **options: object) -> str:
        """Submit the bytes of a ``3dm`` or ``obj`` file for a solve or the option ``task``, and return the id of the job."""
        query = urlencode({"kind": kind, "options": json.dumps({"id": uuid.uuid4().hex, **options})})
        return json.loads(self.request("POST", f"/api/v1/jobs?{query}", content))["id"]

    def poll(self, id: str, wait: float = 0.0) -> dict:
        """Return the status of a job: ``state``, ``progress``, ``iteration``, ``error``, ``elapsed``, ``message``.

        Parameters
        ----------
        id
            The job.
        wait
            Longest time that the server waits for the end of the job before it responds [s].
        """
        return self._json("GET", f"/api/v1/jobs/{quote(id)}" + (f"?wait={min(wait, 0.5 * self.timeout):g}" if wait > 0 else ""))

    @overload
    def result(self, id: str, format: Literal["arrays"] = "arrays", beside: Optional[bytes] = None) -> dict: ...

    @overload
    def result(self, id: str, format: str, beside: Optional[bytes] = None) -> Union[dict, bytes]: ...

    def result(self, id: str, format: str = "arrays", beside: Optional[bytes] = None) -> Union[dict, bytes]:
        """Return a result: a dict for ``arrays``, else the bytes of a file.

        Parameters
        ----------
        id
            The job.
        format
            ``arrays``, ``compas``, ``3dm``, ``obj``, ``hops``, or a format of the build.
        beside
            Bytes of a ``3dm`` file into which the result is merged; its contents are kept.
        """
        sent = "packed" if format == "arrays" else format
        content = self.request("GET" if beside is None else "POST", f"/api/v1/jobs/{quote(id)}/result?format={quote(sent)}", beside)
        if format != "arrays":
            return content
        return {"id": id, **{name: unpack(value) for name, value in json.loads(content).items()}}

    def moulds(self, id: str, **options: object) -> dict:
        """Return the panels of a result and their moulds.

        Parameters
        ----------
        id
            The job.
        options
            ``size`` or ``count`` of the panels, ``along``, ``material``, ``thickness`` [mm], ``tolerance`` [mm], ``rough``.
        """
        return self._json("GET", f"/api/v1/jobs/{quote(id)}/moulds?{_query(options)}")

    def moulds_file(self, id: str, **options: object) -> bytes:
        """Return the bytes of a ``3dm`` file with moulds and panels, see :meth:`moulds`."""
        return self.request("GET", f"/api/v1/jobs/{quote(id)}/moulds?{_query({**options, 'format': '3dm'})}")

    def cancel(self, id: str) -> dict:
        """Stop a job and return its status."""
        return self._json("POST", f"/api/v1/jobs/{quote(id)}/cancel")

    def delete(self, id: str) -> None:
        """Stop a job and delete it."""
        self.request("DELETE", f"/api/v1/jobs/{quote(id)}")

    def jobs(self) -> list[dict]:
        """Return the newest jobs."""
        return self._json("GET", "/api/v1/jobs")["jobs"]

    # ------------------------------------------------------------------
    # The server
    # ------------------------------------------------------------------

    def health(self) -> dict:
        """Return the health of the server."""
        return self._json("GET", "/health")

    def version(self) -> dict:
        """Return name and version of the server.

        Raises
        ------
        ServerUnavailable
            If the address belongs to another program, or to a server with an incompatible interface.
        """
        try:
            found = self._json("GET", "/version")
        except Refused:
            found = {}
        if not isinstance(found, Mapping) or found.get("name") != "compas_cgc":
            raise ServerUnavailable(f"the program at {self.url} is not a server of compas_cgc; choose another address")
        if found.get("api") != API:
            raise ServerUnavailable(
                f"the server at {self.url} has version {found.get('version')}, which is incompatible with this client; update one of them"
            )
        return dict(found)

    def request(self, method: str, path: str, body: Optional[bytes] = None) -> bytes:
        """Send a request and return the response, with retries where possible.

        Raises
        ------
        ServerUnavailable, Refused
            If the server is not available, it rejects the request, or the job fails.
        """
        headers = {"Content-Type": "application/json", **({"Authorization": f"Bearer {self.key}"} if self.key else {})}
        attempt = 0
        while True:
            asked = 0.0
            sent = urllib.request.Request(self.url + path, body, headers, method=method)
            try:
                with _DIRECT.open(sent, timeout=self.timeout) as answer:
                    return answer.read()
            except urllib.error.HTTPError as error:
                refused = Refused(_sentence(error), error.code)
                if error.code not in (429, 502, 503) or attempt == self.retries:
                    raise refused from None
                asked = _pause_of(error)
            except LOST as error:
                if attempt == self.retries:
                    reason = getattr(error, "reason", error)
                    raise ServerUnavailable(f"no server responds at {self.url} ({reason}); start one with: compas-cgc serve") from None
            time.sleep(max(min(2.0, 0.1 * 2**attempt), min(asked, MAX_PAUSE)) * random.uniform(0.5, 1.0))
            attempt += 1

    def _json(self, method: str, path: str, value: Optional[dict] = None) -> dict:
        body = None if value is None else json.dumps(value, allow_nan=False).encode("utf-8")
        try:
            return json.loads(self.request(method, path, body))
        except ValueError:
            raise ServerUnavailable(f"the program at {self.url} is not a server of compas_cgc; choose another address") from None


def _plain(options: Mapping[str, object]) -> dict[str, object]:
    return {name: value.tolist() if isinstance(value, Listable) else value for name, value in options.items()}


def _query(options: dict[str, object]) -> str:
    words = {name: str(value).lower() if isinstance(value, bool) else str(value) for name, value in options.items() if value is not None}
    return urlencode(words)


def _packed(rows: Rows, kind: str) -> Union[dict, list]:
    """Return rows of three numbers in packed form; other rows as lists, which the server checks."""
    try:
        return pack(rows, kind, 3)
    except (TypeError, ValueError, OverflowError):
        return _rows(rows)


def _rows(value: Union[Listable, Iterable[Union[Listable, Iterable[float]]]]) -> list:
    """Return arrays as lists, with .NET and NumPy numbers converted to Python numbers."""
    if isinstance(value, Listable):
        return value.tolist()
    return [list(row) if isinstance(row, (list, tuple)) or not isinstance(row, Listable) else row.tolist() for row in value]


def _pause_of(error: urllib.error.HTTPError) -> float:
    """Return the pause requested by a server [s]."""
    told = error.headers.get("Retry-After") or ""
    return float(told) if told.isdecimal() else 0.0


def _sentence(error: urllib.error.HTTPError) -> str:
    try:
        return json.loads(error.read())["message"]
    except (OSError, ValueError, KeyError, TypeError):
        return f"the server responded with status {error.code} ({error.reason})"
