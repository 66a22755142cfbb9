"""The store keeps what may still be asked for, and no more."""

from __future__ import annotations

import os
import sqlite3
import time

import pytest

from compas_cgc.errors import FileError
from compas_cgc.server.errors import Gone
from compas_cgc.server.jobs.store import Job
from compas_cgc.server.jobs.store import Store


@pytest.fixture
def store():
    kept = Store(":memory:")
    yield kept
    kept.close()


def finish(store, id, size):
    """Add a job and finish it with a result of a size."""
    store.add(Job(id, "queued", time.time(), None, None, 0, "", "", "", {}, None, None), "json", {}, b"request")
    store.finish(id, "succeeded", "", {}, size * b"x")


def left(store, *ids):
    return [id for id in ids if store.result(id) is not None]


def test_the_newest_result_is_kept_however_large_it_is(store):
    """Or nobody could ever fetch it; the next one takes its place."""
    for id in ("first", "second"):
        finish(store, id, 1000)
        store.tidy(results=10, result_bytes=10, remembered=10, keep=id)
        assert left(store, "first", "second") == [id] and store.get(id).size == 1000


def test_older_results_go_by_number_and_by_size(store):
    ids = ["a", "b", "c", "d"]
    for id in ids:
        finish(store, id, 100)
    store.tidy(results=3, result_bytes=10**6, remembered=10)
    assert left(store, *ids) == ["b", "c", "d"]
    store.tidy(results=3, result_bytes=250, remembered=10)
    assert left(store, *ids) == ["c", "d"]
    assert [store.get(id).state for id in ids] == ["succeeded"] * 4, "what became of them is remembered for longer"
    store.tidy(results=3, result_bytes=250, remembered=1)
    assert [id for id in ids if store.get(id) is not None] == ["b", "c", "d"]


def test_a_page_of_jobs_is_the_part_of_them_all_that_is_asked_for(store):
    for k in range(7):
        finish(store, f"job-{k}", 1)
        if k % 3 == 0:
            store.finish(f"job-{k}", "failed", "", {})
    for state in (None, "failed", "succeeded", "queued"):
        every = [job for job in store.all() if state in (None, job.state)]
        assert state in (None, "queued") or every
        for limit, offset in ((1, 0), (2, 1), (10, 0), (3, 6), (3, 9)):
            assert store.page(limit, offset, state) == (every[offset : offset + limit], len(every))


# ------------------------------------------------------------------
# The disk
# ------------------------------------------------------------------


def job(id, state="queued"):
    return Job(id, state, time.time(), None, None, 0, "", "", "", {}, None, None)


def files(path):
    return sorted(own.name for own in path.with_name(f"{path.name}-files").iterdir())


def test_large_requests_and_results_are_files_that_go_with_their_jobs(tmp_path):
    own = Store(path := tmp_path / "jobs.sqlite")
    own.add(job("a"), "3dm", {}, large := 300_000 * b"b")
    assert own.body("a") == large and len(files(path)) == 1 and path.stat().st_size < 100_000
    own.finish("a", "succeeded", "", {}, 300_000 * b"r")
    assert own.result("a") == 300_000 * b"r" and [name.rpartition(".")[2] for name in files(path)] == ["result"]
    own.delete("a")
    assert files(path) == [] and own.result("a") is None
    own.finish("a", "succeeded", "", {}, 300_000 * b"r")
    assert files(path) == [], "a deleted job leaves no result"
    own.close()


def test_the_store_shrinks_when_jobs_are_deleted(tmp_path):
    own = Store(tmp_path / "jobs.sqlite")
    for k in range(60):
        own.add(job(f"small-{k}"), "json", {}, 60_000 * b"x")
        own.add(job(f"large-{k}"), "json", {}, 200_000 * b"x")
    full = own.size()
    for k in range(60):
        own.delete(f"small-{k}")
        own.delete(f"large-{k}")
    own.shrink()
    assert full > 15_000_000 and own.size() < 200_000
    own.close()


def test_files_that_a_kill_left_are_deleted_at_the_start_and_a_lost_one_is_said(tmp_path):
    own = Store(path := tmp_path / "jobs.sqlite")
    own.add(job("a"), "3dm", {}, 300_000 * b"b")
    own.add(job("b"), "3dm", {}, 300_000 * b"c")
    (tmp_path / "jobs.sqlite-files" / "left.request").write_bytes(b"x")
    lost = own.blobs.folder / [name for name in files(path) if name != "left.request"][0]
    own.close()
    lost.unlink()
    own = Store(path)
    assert len(files(path)) == 1
    bodies = []
    for id in "ab":
        try:
            bodies.append(own.body(id))
        except Gone as error:
            assert "is lost; submit the job again" in str(error)
    assert len(bodies) == 1
    own.close()


def damage(content, start):
    content[start : start + 3000] = os.urandom(3000)


@pytest.mark.parametrize("start", [0, 4096, 8000])
def test_a_damaged_store_is_set_aside_and_another_begun(tmp_path, start):
    own = Store(path := tmp_path / "jobs.sqlite")
    for k in range(200):
        own.add(job(f"job-{k:04d}"), "json", {}, os.urandom(500))
    own.close()
    content = bytearray(path.read_bytes())
    damage(content, start)
    path.write_bytes(content)
    again = Store(path)
    assert again.notice is None or "was damaged and is renamed" in again.notice
    again.add(job("new-job"), "json", {}, b"x")
    assert again.check() is None and again.get("new-job") is not None
    again.close()


def test_what_is_no_store_is_left_alone(tmp_path):
    (path := tmp_path / "thesis.docx").write_bytes(9000 * b"words ")
    with pytest.raises(FileError, match="jobs cannot be stored in"):
        Store(path)
    assert path.read_bytes() == 9000 * b"words "


def test_a_full_disk_is_said_and_gets_over_without_a_restart(tmp_path):
    own = Store(tmp_path / "jobs.sqlite")
    own.add(job("first"), "json", {}, 1000 * b"x")
    pages = own._base.execute("PRAGMA page_count").fetchone()[0]
    own._base.execute(f"PRAGMA max_page_count = {pages + 1}")
    for k in range(20):
        with pytest.raises(sqlite3.OperationalError, match="full"):
            own.add(job(f"more-{k}"), "json", {}, 50_000 * b"x")
        own._base.execute(f"PRAGMA max_page_count = {pages + 1}")
    own._base.execute("PRAGMA max_page_count = 1000000")
    assert own.check() is None
    own.add(job("later"), "json", {}, 50_000 * b"x")
    assert [one.id for one in own.all()] == ["later", "first"]
    own.close()


def test_a_budget_is_counted_by_owner_and_old_jobs_go_by_age(tmp_path):
    own = Store(tmp_path / "jobs.sqlite")
    own.add(job("anna:a"), "json", {}, 700 * b"x")
    own.add(job("ben:b"), "json", {}, 300 * b"x")
    own.finish("ben:b", "succeeded", "", {}, 400 * b"r")
    assert [own.owner_bytes(name) for name in ("anna", "ben", "")] == [700, 400, 0]
    for k in range(3):
        finish(own, f"anna:r{k}", 400)
    own.tidy(10, 10**6, 10, owner_bytes=900)
    assert left(own, "anna:r0", "anna:r1", "anna:r2", "ben:b") == ["anna:r1", "anna:r2", "ben:b"]
    own._base.execute("UPDATE jobs SET finished = finished - 86400 * 3 WHERE id LIKE 'anna:r%'")
    own.tidy(10, 10**6, 10, days=2.0)
    assert [one.id for one in own.all()] == ["ben:b", "anna:a"]
    own.close()
