"""Storage of jobs in an SQLite file, so that they survive a restart of the server."""

from __future__ import annotations

import json
import sqlite3
import threading
import time
from pathlib import Path
from typing import NamedTuple
from typing import Optional
from typing import Union

from ...errors import FileError

__all__ = ["Job", "Store", "owned_id"]

_TABLES = """
CREATE TABLE IF NOT EXISTS jobs (
    id TEXT PRIMARY KEY, state TEXT NOT NULL, created REAL NOT NULL, started REAL, finished REAL,
    attempts INTEGER NOT NULL DEFAULT 0, client TEXT NOT NULL, digest TEXT NOT NULL, name TEXT NOT NULL,
    progress TEXT, message TEXT, size INTEGER);
CREATE TABLE IF NOT EXISTS requests (id TEXT PRIMARY KEY, kind TEXT NOT NULL, options TEXT NOT NULL, body BLOB NOT NULL);
CREATE TABLE IF NOT EXISTS results (id TEXT PRIMARY KEY, content BLOB NOT NULL);
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


class Store:
    """Jobs, their requests and their results.

    Parameters
    ----------
    path
        Path of the file, or ``":memory:"``.
    """

    def __init__(self, path: Union[str, Path]):
        self._lock = threading.Lock()
        try:
            self._owner = None if str(path) == ":memory:" else _owned(Path(path))
            self._base = sqlite3.connect(str(path), check_same_thread=False, isolation_level=None)
            self._base.execute("PRAGMA journal_mode=WAL")
            self._base.execute("PRAGMA synchronous=NORMAL")
            self._base.execute("PRAGMA cache_size=-500")  # KiB: meshes are read once
            self._base.executescript(_TABLES)
            if tuple(row[1] for row in self._base.execute("PRAGMA table_info(jobs)")) != Job._fields:
                raise OSError("its tables belong to another program or version")
        except (sqlite3.Error, OSError) as error:
            raise FileError(f"jobs cannot be stored in {path} ({error}); move the file away, or choose another with --store") from None

    def add(self, job: Job, kind: str, options: dict, body: bytes) -> None:
        """Store a new job with its request."""
        with self._lock, self._base:
            self._base.execute("BEGIN")
            marks = ",".join("?" * len(Job._fields))
            self._base.execute(f"INSERT INTO jobs VALUES ({marks})", (*job[:9], json.dumps(job.progress), *job[10:]))
            self._base.execute("INSERT INTO requests VALUES (?,?,?,?)", (job.id, kind, json.dumps(options), body))

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

    def request(self, id: str) -> tuple[str, dict, bytes]:
        """Return format, options and body of a request."""
        with self._lock:
            kind, options, body = self._base.execute("SELECT kind, options, body FROM requests WHERE id = ?", (id,)).fetchone()
        return kind, json.loads(options), body

    def result(self, id: str) -> Optional[bytes]:
        """Return a result, None if it does not exist or was deleted."""
        with self._lock:
            row = self._base.execute("SELECT content FROM results WHERE id = ?", (id,)).fetchone()
        return row[0] if row else None

    def set_started(self, id: str) -> None:
        """Mark a job as running and count the attempt."""
        self._change("UPDATE jobs SET state = 'running', started = ?, attempts = attempts + 1 WHERE id = ?", time.time(), id)

    def set_queued(self, id: str) -> None:
        """Mark a job as queued after an orderly interruption, which does not count as an attempt."""
        self._change("UPDATE jobs SET state = 'queued', started = NULL, attempts = max(0, attempts - 1) WHERE id = ?", id)

    def set_waiting(self, id: str) -> None:
        """Mark a job as queued after a crash of the server, which counts as an attempt."""
        self._change("UPDATE jobs SET state = 'queued', started = NULL WHERE id = ?", id)

    def finish(self, id: str, state: str, message: str, progress: dict, result: Optional[bytes] = None) -> None:
        """Store the outcome of a job, unless the job was deleted meanwhile."""
        size = None if result is None else len(result)
        with self._lock, self._base:
            self._base.execute("BEGIN")
            done = self._base.execute(
                "UPDATE jobs SET state = ?, finished = ?, message = ?, progress = ?, size = ? WHERE id = ?",
                (state, time.time(), message, json.dumps(progress), size, id),
            )
            if done.rowcount and result is not None:
                self._base.execute("INSERT OR REPLACE INTO results VALUES (?, ?)", (id, result))
            self._base.execute("DELETE FROM requests WHERE id = ?", (id,))

    def add_result(self, id: str, result: bytes) -> None:
        """Store the late result of a cancelled or failed job, unless the job was deleted meanwhile or already has a result."""
        with self._lock, self._base:
            self._base.execute("BEGIN")
            query = "UPDATE jobs SET size = ? WHERE id = ? AND size IS NULL AND state IN ('cancelled', 'failed')"
            if self._base.execute(query, (len(result), id)).rowcount:
                self._base.execute("INSERT OR REPLACE INTO results VALUES (?, ?)", (id, result))

    def delete(self, id: str) -> None:
        """Delete a job with its request and result."""
        try:
            self._delete(id)
        except sqlite3.OperationalError:
            # On a full disk, truncating the write-ahead log frees space.
            with self._lock:
                self._base.execute("PRAGMA wal_checkpoint(TRUNCATE)")
            self._delete(id)

    def _delete(self, id: str) -> None:
        with self._lock, self._base:
            self._base.execute("BEGIN")
            for table in ("jobs", "requests", "results"):
                self._base.execute(f"DELETE FROM {table} WHERE id = ?", (id,))

    def tidy(self, results: int, result_bytes: int, remembered: int, keep: str = "") -> None:
        """Delete the oldest results beyond a number or total size, and the oldest finished jobs beyond a number."""
        with self._lock, self._base:
            self._base.execute("BEGIN")
            # `keep` comes first, as the clock may have been set back since the other jobs finished.
            newest = "SELECT id, size FROM jobs WHERE size IS NOT NULL ORDER BY id = ? DESC, finished DESC, rowid DESC"
            rows = self._base.execute(newest, (keep,)).fetchall()
            total = 0
            for place, (id, size) in enumerate(rows):
                total += size
                # Keep the newest result whatever its size, so that the client can fetch it.
                if place and (place >= results or total > result_bytes):
                    self._base.execute("UPDATE jobs SET size = NULL WHERE id = ?", (id,))
                    self._base.execute("DELETE FROM results WHERE id = ?", (id,))
            old = "SELECT id FROM jobs WHERE finished IS NOT NULL AND size IS NULL ORDER BY finished DESC LIMIT -1 OFFSET ?"
            self._base.execute(f"DELETE FROM jobs WHERE id IN ({old})", (remembered,))

    def close(self) -> None:
        """Close the file."""
        with self._lock:
            self._base.close()
            if self._owner is not None:
                self._owner.close()

    def _rows(self, query: str, *values: object) -> list[Job]:
        with self._lock:
            rows = self._base.execute(query, values).fetchall()
        return [Job(*row)._replace(progress=json.loads(row[9] or "{}")) for row in rows]

    def _change(self, query: str, *values: object) -> None:
        with self._lock:
            self._base.execute(query, values)


def _owned(path: Path) -> sqlite3.Connection:
    """Lock the file for this process, so that no two servers run the same jobs. The lock ends with the process."""
    path.parent.mkdir(mode=0o700, parents=True, exist_ok=True)
    path.touch(mode=0o600)  # meshes are confidential
    owner = sqlite3.connect(f"{path}-owner", timeout=0, check_same_thread=False, isolation_level=None)
    try:
        owner.execute("BEGIN EXCLUSIVE")
    except sqlite3.OperationalError:
        owner.close()
        raise OSError("another server is using it") from None
    return owner
