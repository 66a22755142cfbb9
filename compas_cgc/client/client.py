"""HTTP client: solve on a server as if it were here."""

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
LONGEST_PAUSE = 30.0  # seconds that a server may ask for before the next try
UNWATCHED = 1.0  # seconds between two looks that nobody is told of; Ctrl-C may have to wait for one
LOST = (OSError, http.client.HTTPException)
# A proxy of the system between this program and its own machine would only be in the way.
_DIRECT = urllib.request.build_opener(urllib.request.ProxyHandler({}))


@runtime_checkable
class Listable(Protocol):
    """An array of NumPy, or one of its numbers."""

    def tolist(self) -> Any:
        """Return lists of numbers of Python, or such a number."""
        ...


class Client:
    """A compute server.

    Parameters
    ----------
    url
        Its address.
    key
        Its key, where it has one.
    retries
        How often a lost connection or a busy server is tried again, with growing pauses.
    timeout
        Seconds to wait for an answer; a solve may take any time.

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
            Lists of vertex numbers.
        on_progress
            Called with the status at first, and whenever a look finds another.
        cancel
            Asked at every look; True stops the solve.
        interval
            Seconds between two looks; less where `cancel` is asked, more where nobody is told of them.
        id
            Of the job. Default: a new one.
        options
            ``supports``, ``creases``, ``targets``, ``goals``, ``method``, ``settings``, ``flip``, ``roles``, ``name``.

        Returns
        -------
        dict
            With ``id``, ``vertices``, ``faces``, ``status``, ``message``, ``max_error``, ``curvature``, ``history``, ``report``.

        Raises
        ------
        ServerUnavailable, Refused, Failed
            With a sentence to show.
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
            # Nobody would fetch it: Ctrl-C, or a fault in what was given to call.
            with suppress(ClientError):
                self.cancel(id)
            raise

    def _followed(
        self, id: str, on_progress: Optional[Callable[[dict], object]], cancel: Optional[Callable[[], bool]], interval: float
    ) -> dict:
        pause = interval if cancel is None else min(interval, 0.05)
        # The end of the job is told at once; to look before is for who is told of it.
        wait = pause if on_progress or cancel else max(interval, UNWATCHED)
        told: Optional[dict] = None
        while True:
            looked = time.monotonic()
            status = self.poll(id, wait=wait)
            # A job may wait for minutes: the time alone is no news.
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
            # The server answers at once when too many wait for their jobs.
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
        """Make something of a solved surface and wait for it.

        Parameters
        ----------
        task
            ``mould``, ``unroll``, ``membrane``, ``net``; or ``limits``, how much curvature supports carry. See :meth:`tasks`.
        vertices, faces
            The solved surface, with its ``creases``, ``targets`` and ``supports`` among the options.
        job
            Instead: the job that solved it.
        settings
            Of the task, such as ``{"sheet": "3.0x1.5"}``.
        on_progress, cancel, interval, id, options
            See :meth:`solve`.

        Returns
        -------
        dict
            With ``id``, ``text`` to show, ``formats`` for :meth:`result`, and arrays to draw.

        Raises
        ------
        ServerUnavailable, Refused, Failed
            With a sentence to show.
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
        """Hand in a task on a solved surface, or on the result of a job, and return the id of its own job."""
        if job is None:
            return self.submit(
                [] if vertices is None else vertices, [] if faces is None else faces, id, task=task, settings=settings, **options
            )
        body = {"id": id or uuid.uuid4().hex, "task": task, "job": job, "settings": settings, **_plain(options)}
        return self._json("POST", "/api/v1/jobs", body)["id"]

    def tasks(self) -> list[dict]:
        """Return what can be built: name, text, options and formats of each."""
        return self._json("GET", "/api/v1/tasks")["tasks"]

    def submit(self, vertices: Rows, faces: Rows, id: Optional[str] = None, **options: object) -> str:
        """Hand in a solve and return its id; a connection lost on the way does not start it twice."""
        body = {
            "id": id or uuid.uuid4().hex,
            "vertices": _packed(vertices, "f8"),
            "faces": _packed(faces, "i4"),
            **_plain(options),
        }
        return self._json("POST", "/api/v1/jobs", body)["id"]

    def submit_file(self, content: bytes, kind: str, **options: object) -> str:
        """Hand in the bytes of a ``3dm`` or ``obj`` file, for a ``task`` among the options or a solve, and return the id of the job."""
        query = urlencode({"kind": kind, "options": json.dumps({"id": uuid.uuid4().hex, **options})})
        return json.loads(self.request("POST", f"/api/v1/jobs?{query}", content))["id"]

    def poll(self, id: str, wait: float = 0.0) -> dict:
        """Return the status of a job: ``state``, ``progress``, ``iteration``, ``error``, ``elapsed``, ``message``.

        Parameters
        ----------
        id
            The job.
        wait
            Seconds that the server may wait for the end of the job with its answer.
        """
        return self._json("GET", f"/api/v1/jobs/{quote(id)}" + (f"?wait={min(wait, 0.5 * self.timeout):g}" if wait > 0 else ""))

    @overload
    def result(self, id: str, format: Literal["arrays"] = "arrays", beside: Optional[bytes] = None) -> dict: ...

    @overload
    def result(self, id: str, format: str, beside: Optional[bytes] = None) -> Union[dict, bytes]: ...

    def result(self, id: str, format: str = "arrays", beside: Optional[bytes] = None) -> Union[dict, bytes]:
        """Return a result: a dict for ``arrays``, bytes for ``compas``, ``3dm``, ``obj`` and ``hops``, and the files of a build.

        Parameters
        ----------
        id
            The job.
        format
            One of these.
        beside
            Bytes of a ``3dm`` file: the result is put into it, and all that is there stays.
        """
        sent = "packed" if format == "arrays" else format
        content = self.request("GET" if beside is None else "POST", f"/api/v1/jobs/{quote(id)}/result?format={quote(sent)}", beside)
        if format != "arrays":
            return content
        return {"id": id, **{name: unpack(value) for name, value in json.loads(content).items()}}

    def moulds(self, id: str, **options: object) -> dict:
        """Return the moulds that panels of a result are made on.

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
        """Stop a job and forget it."""
        self.request("DELETE", f"/api/v1/jobs/{quote(id)}")

    def jobs(self) -> list[dict]:
        """Return the newest jobs."""
        return self._json("GET", "/api/v1/jobs")["jobs"]

    # ------------------------------------------------------------------
    # The server
    # ------------------------------------------------------------------

    def health(self) -> dict:
        """Return how the server is."""
        return self._json("GET", "/health")

    def version(self) -> dict:
        """Return name and version of the server.

        Raises
        ------
        ServerUnavailable
            If something else answers at the address, or a server of another interface.
        """
        try:
            found = self._json("GET", "/version")
        except Refused:
            found = {}
        if not isinstance(found, Mapping) or found.get("name") != "compas_cgc":
            raise ServerUnavailable(f"what answers at {self.url} is no server of compas_cgc; give another address")
        if found.get("api") != API:
            raise ServerUnavailable(
                f"the server at {self.url} is compas_cgc {found.get('version')}, which this client does not fit; update one"
            )
        return dict(found)

    def request(self, method: str, path: str, body: Optional[bytes] = None) -> bytes:
        """Send a request and return the answer; what can be tried again is.

        Raises
        ------
        ServerUnavailable, Refused
            With a sentence to show.
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
                    raise ServerUnavailable(f"no server answers at {self.url} ({reason}); start one with: compas-cgc serve") from None
            time.sleep(max(min(2.0, 0.1 * 2**attempt), min(asked, LONGEST_PAUSE)) * random.uniform(0.5, 1.0))
            attempt += 1

    def _json(self, method: str, path: str, value: Optional[dict] = None) -> dict:
        body = None if value is None else json.dumps(value, allow_nan=False).encode("utf-8")
        try:
            return json.loads(self.request(method, path, body))
        except ValueError:
            raise ServerUnavailable(f"what answers at {self.url} is no server of compas_cgc; give another address") from None


def _plain(options: Mapping[str, object]) -> dict[str, object]:
    return {name: value.tolist() if isinstance(value, Listable) else value for name, value in options.items()}


def _query(options: dict[str, object]) -> str:
    words = {name: str(value).lower() if isinstance(value, bool) else str(value) for name, value in options.items() if value is not None}
    return urlencode(words)


def _packed(rows: Rows, kind: str) -> Union[dict, list]:
    """Return rows of three numbers in packed form; other rows go as lists, for the server to take or to refuse."""
    try:
        return pack(rows, kind, 3)
    except (TypeError, ValueError, OverflowError):
        return _rows(rows)


def _rows(value: Union[Listable, Iterable[Union[Listable, Iterable[float]]]]) -> list:
    """Return arrays as lists; numbers of .NET and NumPy as those of Python."""
    if isinstance(value, Listable):
        return value.tolist()
    return [list(row) if isinstance(row, (list, tuple)) or not isinstance(row, Listable) else row.tolist() for row in value]


def _pause_of(error: urllib.error.HTTPError) -> float:
    """Return the seconds that a server asks its client to wait."""
    told = error.headers.get("Retry-After") or ""
    return float(told) if told.isdecimal() else 0.0


def _sentence(error: urllib.error.HTTPError) -> str:
    try:
        return json.loads(error.read())["message"]
    except (OSError, ValueError, KeyError, TypeError):
        return f"the server answered {error.code} {error.reason}"
