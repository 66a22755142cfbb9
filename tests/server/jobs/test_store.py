"""The store keeps what may still be asked for, and no more."""

from __future__ import annotations

import time

import pytest

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
