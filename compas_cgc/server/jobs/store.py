"""Jobs in an SQLite file, so that they survive the server."""

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

__all__ = ["Job", "Store"]

_TABLES = """
CREATE TABLE IF NOT EXISTS jobs (
    id TEXT PRIMARY KEY, state TEXT NOT NULL, created REAL NOT NULL, started REAL, finished REAL,
    attempts INTEGER NOT NULL DEFAULT 0, client TEXT NOT NULL, digest TEXT NOT NULL, name TEXT NOT NULL,
    progress TEXT, message TEXT, size INTEGER);
CREATE TABLE IF NOT EXISTS requests (id TEXT PRIMARY KEY, kind TEXT NOT NULL, options TEXT NOT NULL, body BLOB NOT NULL);
CREATE TABLE IF NOT EXISTS results (id TEXT PRIMARY KEY, content BLOB NOT NULL);
"""


class Job(NamedTuple):
    """What is known of a job."""

    id: str
    state: str  # queued, running, succeeded, failed, cancelled
    created: float  # seconds since 1970
    started: Optional[float]
    finished: Optional[float]
    attempts: int  # times that a solve was started
    client: str  # address that it came from
    digest: str  # of the request
    name: str
    progress: dict  # step, steps, energy, error_norm, max_error, seconds
    message: Optional[str]  # one sentence once it is finished
    size: Optional[int]  # bytes of the result, None when there is none (any more)

    @property
    def over(self) -> bool:
        """Whether it is over, whatever the outcome."""
        return self.state in ("succeeded", "failed", "cancelled")


class Store:
    """Jobs, their requests and their results.

    Parameters
    ----------
    path
        File, or ``":memory:"``.
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
                raise OSError("it holds the jobs of something else")
        except (sqlite3.Error, OSError) as error:
            raise FileError(f"the jobs cannot be kept in {path} ({error}); move the file away, or give another with --store") from None

    def add(self, job: Job, kind: str, options: dict, body: bytes) -> None:
        """Keep a new job with its request."""
        with self._lock, self._base:
            self._base.execute("BEGIN")
            marks = ",".join("?" * len(Job._fields))
            self._base.execute(f"INSERT INTO jobs VALUES ({marks})", (*job[:9], json.dumps(job.progress), *job[10:]))
            self._base.execute("INSERT INTO requests VALUES (?,?,?,?)", (job.id, kind, json.dumps(options), body))

    def get(self, id: str) -> Optional[Job]:
        """Return a job, None if there is none of this id."""
        rows = self._rows("SELECT * FROM jobs WHERE id = ?", id)
        return rows[0] if rows else None

    def all(self) -> list[Job]:
        """Return all jobs that are remembered, the newest first."""
        return self._rows("SELECT * FROM jobs ORDER BY created DESC, rowid DESC")

    def page(self, limit: int, offset: int = 0, state: Optional[str] = None) -> tuple[list[Job], int]:
        """Return so many jobs after the newest ones, all or those in a state, and the number of all of them."""
        where, values = ("", ()) if state is None else ("WHERE state = ?", (state,))
        with self._lock:
            total = self._base.execute(f"SELECT count(*) FROM jobs {where}", values).fetchone()[0]
        return self._rows(f"SELECT * FROM jobs {where} ORDER BY created DESC, rowid DESC LIMIT ? OFFSET ?", *values, limit, offset), total

    def unfinished(self) -> list[Job]:
        """Return the jobs that wait or ran when the server ended, the oldest first."""
        return self._rows("SELECT * FROM jobs WHERE state IN ('queued', 'running') ORDER BY created, rowid")

    def request(self, id: str) -> tuple[str, dict, bytes]:
        """Return kind, options and body of a request."""
        with self._lock:
            kind, options, body = self._base.execute("SELECT kind, options, body FROM requests WHERE id = ?", (id,)).fetchone()
        return kind, json.loads(options), body

    def result(self, id: str) -> Optional[bytes]:
        """Return a result, None if there is none (any more)."""
        with self._lock:
            row = self._base.execute("SELECT content FROM results WHERE id = ?", (id,)).fetchone()
        return row[0] if row else None

    def set_started(self, id: str) -> None:
        """Note that a solve began."""
        self._change("UPDATE jobs SET state = 'running', started = ?, attempts = attempts + 1 WHERE id = ?", time.time(), id)

    def set_queued(self, id: str) -> None:
        """Note that a solve that the server itself interrupted has to begin again."""
        self._change("UPDATE jobs SET state = 'queued', started = NULL, attempts = max(0, attempts - 1) WHERE id = ?", id)

    def set_waiting(self, id: str) -> None:
        """Note that a solve that the end of the server interrupted waits for another attempt."""
        self._change("UPDATE jobs SET state = 'queued', started = NULL WHERE id = ?", id)

    def finish(self, id: str, state: str, message: str, progress: dict, result: Optional[bytes] = None) -> None:
        """Keep the outcome of a job; a job that was deleted meanwhile stays deleted."""
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
        """Keep the result of a job that is over and has none; one that was deleted meanwhile, or whose id another has, stays as it is."""
        with self._lock, self._base:
            self._base.execute("BEGIN")
            query = "UPDATE jobs SET size = ? WHERE id = ? AND size IS NULL AND state IN ('cancelled', 'failed')"
            if self._base.execute(query, (len(result), id)).rowcount:
                self._base.execute("INSERT OR REPLACE INTO results VALUES (?, ?)", (id, result))

    def delete(self, id: str) -> None:
        """Forget a job."""
        try:
            self._delete(id)
        except sqlite3.OperationalError:
            # On a full disk the log of what is already in the file makes room.
            with self._lock:
                self._base.execute("PRAGMA wal_checkpoint(TRUNCATE)")
            self._delete(id)

    def _delete(self, id: str) -> None:
        with self._lock, self._base:
            self._base.execute("BEGIN")
            for table in ("jobs", "requests", "results"):
                self._base.execute(f"DELETE FROM {table} WHERE id = ?", (id,))

    def tidy(self, results: int, result_bytes: int, remembered: int, keep: str = "") -> None:
        """Drop the oldest results beyond a number or size, and the oldest finished jobs beyond a number."""
        with self._lock, self._base:
            self._base.execute("BEGIN")
            # The clock may have been set back since the others were finished.
            newest = "SELECT id, size FROM jobs WHERE size IS NOT NULL ORDER BY id = ? DESC, finished DESC, rowid DESC"
            rows = self._base.execute(newest, (keep,)).fetchall()
            total = 0
            for place, (id, size) in enumerate(rows):
                total += size
                # The newest result is kept whatever its size, or nobody could fetch it.
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
    """Make the file this process's own: two servers would run each other's jobs. A killed process lets go of it."""
    path.parent.mkdir(mode=0o700, parents=True, exist_ok=True)
    path.touch(mode=0o600)  # meshes are nobody else's business
    owner = sqlite3.connect(f"{path}-owner", timeout=0, check_same_thread=False, isolation_level=None)
    try:
        owner.execute("BEGIN EXCLUSIVE")
    except sqlite3.OperationalError:
        owner.close()
        raise OSError("another server uses it") from None
    return owner
