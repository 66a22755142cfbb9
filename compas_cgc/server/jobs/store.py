"""Storage of jobs in an SQLite file, so that they survive a restart of the server."""

from __future__ import annotations

import json
import logging
import os
import shutil
import sqlite3
import threading
import time
from collections.abc import Iterable
from collections.abc import Iterator
from contextlib import contextmanager
from contextlib import suppress
from itertools import chain
from pathlib import Path
from typing import NamedTuple
from typing import Optional
from typing import Union

from ...errors import FileError
from ..errors import Gone
from .blobs import Blobs

__all__ = ["DESIGN", "INLINE", "REQUEST", "RESULT", "Job", "Staged", "Store", "design_blob", "locked", "owned_id", "siblings"]

INLINE = 2**16  # bytes up to which content is kept in the tables; larger content is in files
REQUEST, RESULT, DESIGN = "request", "result", "design"
log = logging.getLogger(__name__)

_TABLES = """
CREATE TABLE IF NOT EXISTS jobs (
    id TEXT PRIMARY KEY, state TEXT NOT NULL, created REAL NOT NULL, started REAL, finished REAL,
    attempts INTEGER NOT NULL DEFAULT 0, client TEXT NOT NULL, digest TEXT NOT NULL, name TEXT NOT NULL,
    progress TEXT, message TEXT, size INTEGER);
CREATE TABLE IF NOT EXISTS requests (id TEXT PRIMARY KEY, kind TEXT NOT NULL, options TEXT NOT NULL, body BLOB NOT NULL);
CREATE TABLE IF NOT EXISTS results (id TEXT PRIMARY KEY, content BLOB NOT NULL);
CREATE TABLE IF NOT EXISTS sizes (id TEXT PRIMARY KEY, bytes INTEGER NOT NULL);
CREATE TABLE IF NOT EXISTS designs (
    id TEXT PRIMARY KEY, name TEXT NOT NULL, revision INTEGER NOT NULL, changed REAL NOT NULL,
    bytes INTEGER NOT NULL, content BLOB NOT NULL);
CREATE TABLE IF NOT EXISTS links (digest TEXT PRIMARY KEY, design TEXT NOT NULL, mode TEXT NOT NULL, created REAL NOT NULL);
CREATE TABLE IF NOT EXISTS probe (id INTEGER PRIMARY KEY, moment REAL NOT NULL);
"""


class Job(NamedTuple):
    """State of a job."""

    id: str
    state: str  # queued, running, succeeded, failed, cancelled
    created: float  # seconds since 1970
    started: Optional[float]
    finished: Optional[float]
    attempts: int  # number of times the solve was started
    client: str  # address of the client
    digest: str  # SHA-256 of the request
    name: str
    progress: dict  # step, steps, energy, error_norm, max_error, seconds
    message: Optional[str]  # one sentence, once the job is finished
    size: Optional[int]  # size of the result [bytes], None if there is no result or it was deleted

    @property
    def owner(self) -> str:
        """Name of the owner, empty for the only one of a server without keys."""
        return self.id.rpartition(":")[0]

    def shown(self) -> Job:
        """Return the job under the id that its owner knows."""
        return self._replace(id=self.id.rpartition(":")[2])

    @property
    def over(self) -> bool:
        """Whether the job is finished, whatever the outcome."""
        return self.state in ("succeeded", "failed", "cancelled")


def owned_id(owner: str, id: str) -> str:
    """Return the id under which a job of an owner is stored; two owners may have jobs of the same id."""
    return f"{owner}:{id}" if owner else id


def design_blob(id: str, revision: int) -> str:
    """Return the id under which a revision of a design is stored in a file."""
    return f"{id}#{revision}"


class Staged(NamedTuple):
    """Content that is on the disk, and belongs to no job yet."""

    size: int  # bytes
    inline: bytes  # what goes into the tables
    name: Optional[str]  # name of its file, None if all of it goes into the tables


class Store:
    """Jobs, their requests and their results: tables in SQLite, and files beside them for large requests and results.

    A damaged file is renamed, and another begun in its place.

    Parameters
    ----------
    path
        Path of the file, or ``":memory:"``.

    Attributes
    ----------
    notice
        Sentence on a damaged file that was set aside, None if there was none.
    """

    def __init__(self, path: Union[str, Path]):
        self._lock = threading.RLock()
        self._path = None if str(path) == ":memory:" else Path(path)
        self.notice: Optional[str] = None
        try:
            self._owner = None if self._path is None else locked(self._path)
            if self._path is not None:
                self._path.touch(mode=0o600)  # meshes are confidential
            self._open()
        except (sqlite3.Error, OSError) as error:
            raise FileError(f"jobs cannot be stored in {path} ({error}); move the file away, or choose another with --store") from None

    def _open(self) -> None:
        """Connect, after setting a damaged file aside."""
        try:
            self._connect()
        except sqlite3.DatabaseError as error:
            # Never touch a file that may be something else than a store.
            if self._path is None or self._path.suffix != ".sqlite" or isinstance(error, sqlite3.OperationalError):
                raise
            with suppress(sqlite3.Error, AttributeError):
                self._base.close()
            self._set_aside(str(error))
            self._connect()
        known = [
            (kind, id)
            for kind, table in ((REQUEST, "requests"), (RESULT, "results"))
            for (id,) in self._base.execute(f"SELECT id FROM {table}")
        ]
        designs = self._base.execute("SELECT id, revision FROM designs").fetchall()
        self.blobs.keep_only([*known, *((DESIGN, design_blob(id, revision)) for id, revision in designs)])

    def _connect(self) -> None:
        path = ":memory:" if self._path is None else str(self._path)
        self._base = sqlite3.connect(path, check_same_thread=False, isolation_level=None)
        self._base.execute("PRAGMA auto_vacuum=INCREMENTAL")
        self._base.execute("PRAGMA journal_mode=WAL")
        self._base.execute("PRAGMA synchronous=NORMAL")
        self._base.execute("PRAGMA cache_size=-500")  # KiB: meshes are read once
        found = self._base.execute("PRAGMA quick_check(1)").fetchone()[0]
        if found != "ok":
            raise sqlite3.DatabaseError(found)
        self._base.executescript(_TABLES)
        if tuple(row[1] for row in self._base.execute("PRAGMA table_info(jobs)")) != Job._fields:
            raise OSError("its tables belong to another program or version")
        self.blobs = Blobs(None if self._path is None else siblings(self._path, "-files"))

    def _set_aside(self, reason: str) -> None:
        assert self._path is not None
        stamp = time.strftime("%Y%m%d-%H%M%S")
        for name in ("", "-wal", "-shm", "-files"):
            source = Path(f"{self._path}{name}")
            if source.exists():
                os.replace(source, f"{self._path}.damaged-{stamp}{name}")
        self.notice = f"the store was damaged and is renamed to {self._path.name}.damaged-{stamp}; jobs in it are lost"
        log.error("%s (%s)", self.notice, reason)
        self._path.touch(mode=0o600)

    @contextmanager
    def writing(self) -> Iterator[sqlite3.Connection]:
        """Write within a transaction; after a failure, such as a full disk, the next one finds a working connection."""
        with self._lock:
            try:
                self._base.execute("BEGIN IMMEDIATE")
                yield self._base
                self._base.execute("COMMIT")
            except BaseException as error:
                with suppress(sqlite3.Error):
                    if self._base.in_transaction:
                        self._base.execute("ROLLBACK")
                if isinstance(error, sqlite3.Error) and self._path is not None:
                    with suppress(sqlite3.Error, OSError):
                        self._base.close()
                        self._open()
                raise

    def check(self) -> Optional[str]:
        """Write something; return what is wrong as a sentence, None if nothing is."""
        try:
            with self.writing() as base:
                base.execute("INSERT OR REPLACE INTO probe VALUES (0, ?)", (time.time(),))
        except (sqlite3.Error, OSError) as error:
            return f"the store cannot be written to ({error})"
        return None

    def free(self) -> Optional[int]:
        """Return the free bytes of the disk, None for a store in memory."""
        return None if self._path is None else shutil.disk_usage(self._path.parent).free

    def size(self) -> int:
        """Return the bytes that the store takes on the disk."""
        if self._path is None:
            return self.blobs.bytes()
        return self.blobs.bytes() + sum(
            os.path.getsize(f"{self._path}{name}") for name in ("", "-wal") if os.path.exists(f"{self._path}{name}")
        )

    def shrink(self) -> None:
        """Give free pages of the tables and the write-ahead log back to the disk."""
        with self._lock, suppress(sqlite3.OperationalError):
            if self._path is not None and self._base.execute("PRAGMA freelist_count").fetchone()[0]:
                # execute() would take a single step, which frees one page.
                self._base.executescript("PRAGMA incremental_vacuum")
            self._base.execute("PRAGMA wal_checkpoint(TRUNCATE)")

    @contextmanager
    def staged(self, content: Union[bytes, Iterable[bytes], Staged]) -> Iterator[Staged]:
        """Write large content to the disk before its job is stored, so that no request waits for the disk of another."""
        if isinstance(content, Staged):
            yield content
            return
        pieces = iter([content] if isinstance(content, bytes) else content)
        first = b""
        for piece in pieces:
            first = first + piece if first else piece
            if len(first) > INLINE:
                break
        if len(first) <= INLINE:
            yield Staged(len(first), first, None)
        else:
            with self.blobs.staged(chain([first], pieces)) as (name, size):
                yield Staged(size, b"", name)

    def place(self, content: Staged, kind: str, id: str) -> None:
        """Make staged content in a file that of a kind and id."""
        if content.name is not None:
            self.blobs.place(content.name, kind, id)

    def add(self, job: Job, kind: str, options: dict, body: Union[bytes, Staged]) -> None:
        """Store a new job with its request."""
        with self.staged(body) as content, self._lock:
            self.place(content, REQUEST, job.id)
            try:
                with self.writing() as base:
                    marks = ",".join("?" * len(Job._fields))
                    base.execute(f"INSERT INTO jobs VALUES ({marks})", (*job[:9], json.dumps(job.progress), *job[10:]))
                    base.execute("INSERT INTO requests VALUES (?,?,?,?)", (job.id, kind, json.dumps(options), content.inline))
                    base.execute("INSERT OR REPLACE INTO sizes VALUES (?,?)", (job.id, content.size))
            except sqlite3.Error:
                self.blobs.delete(REQUEST, job.id)
                raise

    def owner_bytes(self, owner: str) -> int:
        """Return the bytes of the requests, results and designs of an owner."""
        where, values = ("id GLOB ?", (f"{owner}:*",)) if owner else ("id NOT GLOB '*:*'", ())
        with self._lock:
            row = self._base.execute(
                f"SELECT (SELECT total(bytes) FROM sizes WHERE {where}) + (SELECT total(size) FROM jobs WHERE {where})"
                f" + (SELECT total(bytes) FROM designs WHERE {where})",
                (*values, *values, *values),
            ).fetchone()
        return int(row[0])

    def get(self, id: str) -> Optional[Job]:
        """Return the job with this id, None if it does not exist."""
        rows = self._rows("SELECT * FROM jobs WHERE id = ?", id)
        return rows[0] if rows else None

    def all(self) -> list[Job]:
        """Return all stored jobs, newest first."""
        return self._rows("SELECT * FROM jobs ORDER BY created DESC, rowid DESC")

    def page(self, limit: int, offset: int = 0, state: Optional[str] = None, owner: Optional[str] = None) -> tuple[list[Job], int]:
        """Return so many jobs after the newest ones, all or those in a state or of an owner, and the number of all of them."""
        conditions: list[tuple[str, tuple]] = [] if state is None else [("state = ?", (state,))]
        if owner is not None:
            conditions.append(("id GLOB ?", (f"{owner}:*",)) if owner else ("id NOT GLOB '*:*'", ()))
        where = "WHERE " + " AND ".join(text for text, _ in conditions) if conditions else ""
        values = [value for _, own in conditions for value in own]
        with self._lock:
            total = self._base.execute(f"SELECT count(*) FROM jobs {where}", values).fetchone()[0]
        return self._rows(f"SELECT * FROM jobs {where} ORDER BY created DESC, rowid DESC LIMIT ? OFFSET ?", *values, limit, offset), total

    def unfinished(self) -> list[Job]:
        """Return the queued jobs and those interrupted by the end of the server, oldest first."""
        return self._rows("SELECT * FROM jobs WHERE state IN ('queued', 'running') ORDER BY created, rowid")

    def request(self, id: str) -> tuple[str, dict]:
        """Return format and options of a request."""
        with self._lock:
            kind, options = self._base.execute("SELECT kind, options FROM requests WHERE id = ?", (id,)).fetchone()
        return kind, json.loads(options)

    def body(self, id: str) -> bytes:
        """Return the body of a request.

        Raises
        ------
        Gone
            If it is lost.
        """
        with self._lock:
            row = self._base.execute("SELECT body, bytes FROM requests LEFT JOIN sizes USING (id) WHERE requests.id = ?", (id,)).fetchone()
        content = self._whole(REQUEST, id, *row) if row else None
        if content is None:
            raise Gone("the request of this job is lost; submit the job again")
        return content

    def result(self, id: str) -> Optional[bytes]:
        """Return a result, None if it does not exist or was deleted."""
        with self._lock:
            row = self._base.execute("SELECT content, size FROM results LEFT JOIN jobs USING (id) WHERE results.id = ?", (id,)).fetchone()
        return self._whole(RESULT, id, *row) if row else None

    def _whole(self, kind: str, id: str, inline: bytes, size: Optional[int]) -> Optional[bytes]:
        """Return content that is in the table or in a file, None if the file is lost."""
        return inline if inline or not size else self.blobs.get(kind, id)

    def set_started(self, id: str) -> None:
        """Mark a job as running and count the attempt."""
        self._change("UPDATE jobs SET state = 'running', started = ?, attempts = attempts + 1 WHERE id = ?", time.time(), id)

    def set_queued(self, id: str) -> None:
        """Mark a job as queued after an orderly interruption, which does not count as an attempt."""
        self._change("UPDATE jobs SET state = 'queued', started = NULL, attempts = max(0, attempts - 1) WHERE id = ?", id)

    def set_waiting(self, id: str) -> None:
        """Mark a job as queued after a crash of the server, which counts as an attempt."""
        self._change("UPDATE jobs SET state = 'queued', started = NULL WHERE id = ?", id)

    def finish(self, id: str, state: str, message: str, progress: dict, result: Union[None, bytes, Staged] = None) -> None:
        """Store the outcome of a job, unless the job was deleted meanwhile."""
        with self.staged(result or b"") as content, self._lock:
            size = None if result is None else content.size
            self.place(content, RESULT, id)
            with self.writing() as base:
                done = base.execute(
                    "UPDATE jobs SET state = ?, finished = ?, message = ?, progress = ?, size = ? WHERE id = ?",
                    (state, time.time(), message, json.dumps(progress), size, id),
                )
                if done.rowcount and result is not None:
                    base.execute("INSERT OR REPLACE INTO results VALUES (?, ?)", (id, content.inline))
                base.execute("DELETE FROM requests WHERE id = ?", (id,))
                base.execute("DELETE FROM sizes WHERE id = ?", (id,))
            self.blobs.delete(REQUEST, id)
            if not done.rowcount:
                self.blobs.delete(RESULT, id)

    def add_result(self, id: str, result: bytes) -> None:
        """Store the late result of a cancelled or failed job, unless the job was deleted meanwhile or already has a result."""
        with self.staged(result) as content, self.writing() as base:
            query = "UPDATE jobs SET size = ? WHERE id = ? AND size IS NULL AND state IN ('cancelled', 'failed')"
            if base.execute(query, (content.size, id)).rowcount:
                self.place(content, RESULT, id)
                base.execute("INSERT OR REPLACE INTO results VALUES (?, ?)", (id, content.inline))

    def delete(self, id: str) -> None:
        """Delete a job with its request and result."""
        try:
            self._delete(id)
        except sqlite3.OperationalError:
            # On a full disk, truncating the write-ahead log frees space, and so do the files.
            with self._lock:
                for kind in (REQUEST, RESULT):
                    self.blobs.delete(kind, id)
                self._base.execute("PRAGMA wal_checkpoint(TRUNCATE)")
            self._delete(id)

    def _delete(self, id: str) -> None:
        with self._lock:
            with self.writing() as base:
                for table in ("jobs", "requests", "results", "sizes"):
                    base.execute(f"DELETE FROM {table} WHERE id = ?", (id,))
            for kind in (REQUEST, RESULT):
                self.blobs.delete(kind, id)

    def tidy(
        self,
        results: int,
        result_bytes: int,
        remembered: int,
        keep: str = "",
        owner_bytes: Optional[int] = None,
        days: Optional[float] = None,
    ) -> None:
        """Delete the oldest results beyond a number or total size, in all and of each owner, and finished jobs beyond a number or age."""
        gone = []
        with self._lock:
            with self.writing() as base:
                # `keep` comes first, as the clock may have been set back since the other jobs finished.
                newest = "SELECT id, size FROM jobs WHERE size IS NOT NULL ORDER BY id = ? DESC, finished DESC, rowid DESC"
                total = 0
                own: dict[str, int] = {}
                for place, (id, size) in enumerate(base.execute(newest, (keep,)).fetchall()):
                    owner = id.rpartition(":")[0]
                    own[owner] = own.get(owner, 0) + size
                    total += size
                    beyond = place >= results or total > result_bytes or (owner_bytes is not None and own[owner] > owner_bytes)
                    # Keep the newest result whatever its size, so that the client can fetch it.
                    if place and beyond:
                        base.execute("UPDATE jobs SET size = NULL WHERE id = ?", (id,))
                        gone.append(id)
                if days is not None:
                    old = "SELECT id FROM jobs WHERE finished < ? AND id != ?"
                    aged = [id for (id,) in base.execute(old, (time.time() - 86400.0 * days, keep)).fetchall()]
                    base.executemany("DELETE FROM jobs WHERE id = ?", [(id,) for id in aged])
                    gone += aged
                base.executemany("DELETE FROM results WHERE id = ?", [(id,) for id in gone])
                old = "SELECT id FROM jobs WHERE finished IS NOT NULL AND size IS NULL ORDER BY finished DESC LIMIT -1 OFFSET ?"
                base.execute(f"DELETE FROM jobs WHERE id IN ({old})", (remembered,))
            for id in gone:
                self.blobs.delete(RESULT, id)

    def close(self) -> None:
        """Close the file."""
        with self._lock:
            self._base.close()
            if self._owner is not None:
                self._owner.close()

    def rows(self, query: str, *values: object) -> list[tuple]:
        """Return the rows that a query finds."""
        with self._lock:
            return self._base.execute(query, values).fetchall()

    def _rows(self, query: str, *values: object) -> list[Job]:
        return [Job(*row)._replace(progress=json.loads(row[9] or "{}")) for row in self.rows(query, *values)]

    def _change(self, query: str, *values: object) -> None:
        with self.writing() as base:
            base.execute(query, values)


def locked(path: Path) -> sqlite3.Connection:
    """Lock the file for this process, so that no two servers run the same jobs. The lock ends with the process."""
    path.parent.mkdir(mode=0o700, parents=True, exist_ok=True)
    owner = sqlite3.connect(f"{path}-owner", timeout=0, check_same_thread=False, isolation_level=None)
    try:
        owner.execute("BEGIN EXCLUSIVE")
    except sqlite3.OperationalError:
        owner.close()
        raise OSError("another server is using it") from None
    return owner


def siblings(path: Path, ending: str) -> Path:
    """Return the path of what belongs to a store beside its file."""
    return path.with_name(f"{path.name}{ending}")
