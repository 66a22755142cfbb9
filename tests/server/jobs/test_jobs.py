"""The job engine: worker processes that may die, jobs that may not."""

from __future__ import annotations

import io
import os
import signal
import threading
import time
import tracemalloc
from concurrent.futures import Future
from concurrent.futures import ThreadPoolExecutor

import pytest

from compas_cgc.execution.future import LimitExceeded
from compas_cgc.execution.future import TaskError
from compas_cgc.execution.future import TaskStopped
from compas_cgc.execution.future import WorkerDied
from compas_cgc.execution.pool import WorkerPool
from compas_cgc.execution.worker import report
from compas_cgc.execution.worker import stop_wanted
from compas_cgc.server.api.requests import accept
from compas_cgc.server.api.serialization import unpack_result
from compas_cgc.server.api.tasks import solve_job
from compas_cgc.server.errors import Busy
from compas_cgc.server.errors import Conflict
from compas_cgc.server.errors import Gone
from compas_cgc.server.hops.warm_up import warm_up
from compas_cgc.server.jobs.engine import Jobs
from compas_cgc.server.jobs.output import JobOutput
from compas_cgc.server.jobs.store import Job
from compas_cgc.server.jobs.store import Store
from compas_cgc.server.limits import Limits

from ...support.server_process import PATIENCE
from ...support.server_process import wait_for
from ...support.shapes import grid


def add(a, b):
    return a + b


def fail():
    raise KeyError("lost")


def sleep_until_told():
    report("begun")
    while not stop_wanted():
        time.sleep(0.01)
    return "stopped gently"


def sleep_for_ever():
    report("begun")
    time.sleep(3600)


class Never:
    """Begins nothing."""

    def submit(self, function, *args):
        return Future()

    def shutdown(self, wait=True, cancel_futures=False):
        pass


def late(kind, options, content, limits):
    report({"step": 1})
    while not stop_wanted():
        time.sleep(0.01)
    time.sleep(0.5)
    return JobOutput("as far as it got", b"the surface", True)


def soon(kind, options, content, limits):
    report({"step": 1})
    time.sleep(float(content))
    return JobOutput("done", b"")


def die():
    os._exit(3)


def body(n=6, **more):
    vertices, faces = grid(n)
    request = {"vertices": vertices.tolist(), "faces": faces.tolist(), "supports": "boundary", "targets": 0.5, **more}
    return "json", accept(request, Limits())


def endless(n=24):
    return body(n, method="flow", settings={"steps": 100000, "tolerance": 0.0})


@pytest.fixture(scope="module")
def pool():
    with_two = WorkerPool(2, warm_up, grace=1.0)
    # On a new machine both compile the kernels first.
    assert with_two.wait_until_ready(4 * PATIENCE)
    yield with_two
    with_two.shutdown(cancel_futures=True)


@pytest.fixture
def jobs(pool):
    class Borrowed:
        """The shared pool; closing the jobs leaves it open."""

        start = staticmethod(pool.start)

        def shutdown(self, wait=True, cancel_futures=False):
            pass

    engine = Jobs(Borrowed(), Store(":memory:"), solve_job, Limits(queue=6, per_client=4, results=3))
    yield engine
    for job in engine.list():
        engine.cancel(job.id)
    wait_for(lambda: all(job.over for job in engine.list()))
    engine.close()


def begun(pool, function):
    seen = []
    task = pool.start(function, on_progress=seen.append)
    wait_for(lambda: seen)
    return task


def test_the_pool_is_an_executor(pool):
    assert list(pool.map(add, [1, 2, 3], [10, 20, 30])) == [11, 22, 33]


def test_an_exception_comes_back_with_the_name_of_its_class(pool):
    with pytest.raises(TaskError, match="lost") as error:
        pool.submit(fail).result(PATIENCE)
    assert error.value.kind == "KeyError" and "in fail" in error.value.trace


def test_a_task_that_listens_is_stopped_without_force(pool):
    before = pool.processes()
    task = begun(pool, sleep_until_told)
    task.stop()
    assert task.result(PATIENCE) == "stopped gently"
    assert pool.processes() == before


@pytest.mark.nightly
def test_a_task_that_does_not_listen_is_ended_and_its_worker_replaced(pool):
    before = set(pool.processes())
    task = begun(pool, sleep_for_ever)
    task.stop("enough")
    with pytest.raises(TaskStopped, match="enough"):
        task.result(PATIENCE)
    wait_for(lambda: len(set(pool.processes()) - before) == 1)
    assert pool.submit(add, 1, 1).result(PATIENCE) == 2


@pytest.mark.timeout(60)
def test_an_exception_that_leaves_the_block_of_a_pool_ends_what_is_in_it():
    with pytest.raises(ZeroDivisionError), WorkerPool(1) as one:
        running, waiting = begun(one, sleep_for_ever), one.submit(add, 1, 2)
        raise ZeroDivisionError
    with pytest.raises(TaskStopped):
        running.result(0)
    assert waiting.cancelled() and one.processes() == []


def test_the_end_of_the_block_of_a_pool_waits_for_what_is_in_it():
    with WorkerPool(1) as one:
        tasks = [one.submit(add, k, 2) for k in range(3)]
    assert [task.result(0) for task in tasks] == [2, 3, 4] and one.processes() == []


@pytest.mark.nightly
def test_where_no_worker_starts_nobody_waits_for_ever():
    with WorkerPool(1, warm_up=die) as none:
        with pytest.raises(WorkerDied, match="do not start; see its log"):
            none.submit(add, 1, 2).result(PATIENCE)


def test_a_time_limit_stops_a_task():
    with WorkerPool(1, grace=PATIENCE) as gentle:
        assert gentle.start(sleep_until_told, time_limit=0.1).result(PATIENCE) == "stopped gently"
    with WorkerPool(1, grace=0.1) as strict, pytest.raises(LimitExceeded, match="it exceeded the time limit of 0.1 s"):
        strict.start(sleep_for_ever, time_limit=0.1).result(PATIENCE)


def test_a_killed_worker_fails_its_own_task_only(pool):
    pool.wait_until_ready(PATIENCE)
    victim, other = begun(pool, sleep_until_told), begun(pool, sleep_until_told)
    dead = pool.submit(die)
    victim.stop()
    with pytest.raises(WorkerDied, match="exit code 3.*submit the job again"):
        dead.result(PATIENCE)
    assert not other.done()
    other.stop()
    assert other.result(PATIENCE) == "stopped gently"
    assert pool.wait_until_ready(PATIENCE)


@pytest.mark.nightly
@pytest.mark.skipif(not hasattr(signal, "SIGKILL"), reason="no such signal here")
def test_a_job_whose_worker_is_killed_is_reported(pool, jobs):
    pool.wait_until_ready(PATIENCE)
    job, _ = jobs.submit(*endless())
    wait_for(lambda: jobs.get(job.id).progress.get("step"))
    (busy,) = (slot for slot in pool._slots if slot.state == "busy")
    os.kill(busy.process.pid, signal.SIGKILL)
    wait_for(lambda: jobs.get(job.id).over)
    assert jobs.get(job.id).state == "failed" and "signal 9" in jobs.get(job.id).message


def test_a_job_runs_and_keeps_its_result(jobs):
    job, new = jobs.submit(*body(), id="roof-0001")
    assert new and job.state == "queued"
    wait_for(lambda: jobs.get(job.id).over)
    done = jobs.get(job.id)
    assert done.state == "succeeded" and "converged in" in done.message
    result, findings = unpack_result(jobs.result(job.id))
    assert result.converged and result.max_error < 1e-6
    assert result.mesh.number_of_vertices() == 49 and findings["quality"]["faces"] == 72
    assert jobs.submit(*body(), id="roof-0001") == (done, False)
    with pytest.raises(Conflict, match="a different request"):
        jobs.submit(*body(7), id="roof-0001")


def test_a_finished_job_shows_its_last_step_and_no_earlier_one(jobs):
    job, _ = jobs.submit(*body(8, targets=0.3, method="newton"))
    wait_for(lambda: jobs.get(job.id).over)
    done = jobs.get(job.id)
    result, _ = unpack_result(jobs.result(job.id))
    assert result.iterations > 1
    assert {name: done.progress[name] for name in ("step", "max_error", "seconds", "error_norm")} == {
        "step": result.iterations,
        "max_error": result.max_error,
        "seconds": result.seconds,
        "error_norm": result.history.error_norm[-1],
    }


def test_progress_is_told_to_followers_and_cancel_ends_them(jobs):
    job, _ = jobs.submit(*endless())
    states = []
    for state in jobs.follow(job.id):
        states.append(state)
        if len(states) == 4:
            assert jobs.cancel(job.id).id == job.id
    steps = [state.progress["step"] for state in states if state.state == "running"]
    assert steps == sorted(steps) and steps[-1] > 0
    assert states[-1].state == "cancelled" and states[-1].message.startswith("cancelled after")
    assert unpack_result(jobs.result(job.id))[0].status == "cancelled"


def test_a_request_for_a_job_revokes_its_later_deletion(jobs):
    left, asked, sent = (jobs.submit(*endless(), id=f"job-{name}")[0] for name in ("left", "asked", "sent-again"))
    for job in (left, asked, sent):
        jobs.delete(job.id, after=0.5)
    assert len(jobs.list()) == 3
    jobs.wait(asked.id, 0.0)
    assert jobs.submit(*endless(), id=sent.id) == (jobs.get(sent.id), False)
    wait_for(lambda: left.id not in {job.id for job in jobs.list()})
    time.sleep(2.0)  # as long as two rounds of maintenance
    assert {job.id for job in jobs.list()} == {asked.id, sent.id} and not jobs.get(asked.id).over


def test_a_refused_solve_fails_with_the_sentence_of_the_check(jobs):
    job, _ = jobs.submit(*body(targets=100.0))
    wait_for(lambda: jobs.get(job.id).over)
    assert jobs.get(job.id).state == "failed" and "too large for this boundary" in jobs.get(job.id).message


def test_the_queue_is_bounded_for_one_and_for_all(jobs):
    for _ in range(4):
        jobs.submit(*endless(), client="a")
    with pytest.raises(Busy, match="4 unfinished jobs"):
        jobs.submit(*endless(), client="a")
    for _ in range(2):
        jobs.submit(*endless(), client="b")
    with pytest.raises(Busy, match="queue is full"):
        jobs.submit(*endless(), client="c")


def test_old_results_make_room(jobs):
    ids = []
    for k in range(4):
        ids.append(jobs.submit(*body(targets=0.1 + 0.1 * k))[0].id)
        wait_for(lambda: jobs.get(ids[-1]).over)
    with pytest.raises(Gone, match="submit the job again"):
        jobs.result(ids[0])
    assert jobs.result(ids[-1])


def test_jobs_survive_the_server(tmp_path):
    first = WorkerPool(1)
    engine = Jobs(first, Store(tmp_path / "jobs.sqlite"), solve_job)
    running, _ = engine.submit(*endless(8))
    waiting, _ = engine.submit(*body())
    engine.close()
    # A second server takes up what the first one left; any executor will do.
    with ThreadPoolExecutor(1) as second:
        store = Store(tmp_path / "jobs.sqlite")
        assert [job.id for job in store.unfinished()] == [running.id, waiting.id]
        store.delete(running.id)
        engine = Jobs(second, store, solve_job)
        wait_for(lambda: engine.get(waiting.id).over)
        assert engine.get(waiting.id).state == "succeeded"


@pytest.mark.nightly
def test_a_stop_in_order_costs_a_job_none_of_its_attempts(tmp_path):
    for _ in range(3):
        engine = Jobs(WorkerPool(1), Store(tmp_path / "jobs.sqlite"), solve_job)
        job, _ = engine.submit(*endless(8), id="restarted")
        wait_for(lambda engine=engine: engine.get("restarted").state == "running")
        engine.close()
    store = Store(tmp_path / "jobs.sqlite")
    assert [(job.id, job.state, job.attempts) for job in store.unfinished()] == [("restarted", "queued", 0)]
    store.close()


def test_a_job_that_a_kill_of_the_server_interrupted_waits_until_it_is_begun_again():
    store = Store(":memory:")
    kind, content = body()
    store.add(Job("interrupted", "running", time.time(), time.time(), None, 1, "", "", "", {}, None, None), kind, {}, content)
    engine = Jobs(Never(), store, solve_job)
    again = engine.get("interrupted")
    assert (again.state, again.started, again.attempts) == ("queued", None, 1)
    engine.close()


def test_a_job_that_ended_the_server_twice_is_not_tried_again(tmp_path):
    store = Store(tmp_path / "jobs.sqlite")
    with ThreadPoolExecutor(1) as executor:
        engine = Jobs(executor, store, solve_job)
        job, _ = engine.submit(*body())
        wait_for(lambda: engine.get(job.id).over)
        # As if the server had been killed twice while it ran.
        store.add(job._replace(id="deadly-one", state="running", attempts=2), body()[0], {}, body()[1])
        again = Jobs(executor, store, solve_job)
    assert again.get("deadly-one").state == "failed" and "crashed 2 times" in again.get("deadly-one").message


def test_a_call_is_stopped_when_its_client_is_gone(jobs):
    with pytest.raises(TimeoutError, match="gone"):
        jobs.calls.call(sleep_until_told, disconnected=lambda: True)
    assert jobs.calls.call(add, 2, 2) == 4


def test_a_job_that_is_cancelled_within_a_long_step_keeps_its_surface():
    slow = WorkerPool(1, grace=2 * PATIENCE)
    engine = Jobs(slow, Store(":memory:"), late)
    job, _ = engine.submit("json", b"")
    wait_for(lambda: engine.get(job.id).progress)
    engine.cancel(job.id)
    told = engine.wait(job.id, PATIENCE)
    assert (told.state, told.size) == ("cancelled", None), "whoever waits is told before the step is over"
    wait_for(lambda: engine.get(job.id).size)
    assert engine.result(job.id) == b"the surface" and engine.get(job.id).state == "cancelled"
    engine.close()


def test_who_is_refused_is_told_to_wait_as_long_as_jobs_take():
    quick = WorkerPool(1)
    engine = Jobs(quick, Store(":memory:"), soon, Limits(queue=3, per_client=2))
    for _ in range(2):
        engine.wait(engine.submit("json", b"2.6")[0].id, PATIENCE)
    for client in ("one", "two", "two"):
        engine.submit("json", b"600", client=client)
    for client, least in (("three", 3), ("two", 5)):
        engine.limits = Limits(queue=3 if client == "three" else 4, per_client=2)
        with pytest.raises(Busy) as refused:
            engine.submit("json", b"600", client=client)
        # A busy machine takes longer; the job of the one comes before those of the two.
        assert least <= int(refused.value.headers["Retry-After"]) <= 60
    wait_for(lambda: sorted(engine.positions().values()) == [1, 2])
    engine.close()


def test_nobody_waits_for_the_worker_of_a_task_that_was_cancelled():
    """The worker has the time of its grace to end by itself; whoever waits for the task is told long before."""
    slow = WorkerPool(1, grace=2 * PATIENCE)
    task = begun(slow, sleep_for_ever)
    busy = slow.processes()
    task.stop("cancelled by the client")
    with pytest.raises(TaskStopped, match="cancelled by the client"):
        task.result(PATIENCE)
    assert slow.processes() == busy and slow.health()["busy"] == 1
    slow.shutdown(cancel_futures=True)


def test_a_worker_that_does_not_heed_a_cancel_is_replaced_after_its_grace(pool):
    before = pool.health()["replaced"]
    task = begun(pool, sleep_for_ever)
    task.stop("cancelled by the client")
    wait_for(lambda: pool.health()["replaced"] == before + 1 and pool.health()["busy"] == 0)


def test_who_is_waited_for_goes_before_all_but_those_who_wait_for_long():
    ended = []
    with WorkerPool(1, None, grace=1.0) as one:
        blocking = begun(one, sleep_until_told)
        tasks = {"old job": one.start(add, (1, 1))}
        tasks["old job"].since -= 60
        tasks.update({name: one.start(add, (1, 1), urgent=name[0] == "c") for name in ("job 1", "call 1", "job 2", "call 2")})
        for name, task in tasks.items():
            task.add_done_callback(lambda task, name=name: ended.append(name))
        blocking.stop("go on")
        wait_for(lambda: len(ended) == 5)
    assert ended == ["old job", "call 1", "call 2", "job 1", "job 2"]


def test_a_reserved_worker_takes_nothing_that_nobody_waits_for():
    with WorkerPool(1, None, 1.0, reserved=1) as two:
        blocking = begun(two, sleep_until_told)
        job = two.start(add, (1, 1))
        job.since -= 60
        assert [two.start(add, (k, 1), urgent=True).result(PATIENCE) for k in range(3)] == [1, 2, 3]
        assert not job.done() and two.health()["waiting"] == 1
        blocking.stop("go on")
        assert job.result(PATIENCE) == 2


def test_nobody_waits_for_the_disk_while_a_large_request_is_written(tmp_path, monkeypatch):
    reached, go, waits = threading.Event(), threading.Event(), []

    def fsync(handle):
        reached.set()
        waits.append(go.wait(10.0))

    store = Store(tmp_path / "jobs.sqlite")
    engine = Jobs(Never(), store, solve_job)
    monkeypatch.setattr(os, "fsync", fsync)
    upload = threading.Thread(target=engine.submit, args=("3dm", 300_000 * b"x"))
    upload.start()
    assert reached.wait(PATIENCE)
    assert engine.list() == [] and not waits, "it is answered before the disk"
    go.set()
    upload.join(PATIENCE)
    assert waits == [True] and store.body(engine.list()[0].id) == 300_000 * b"x"
    engine.close()


class Endless(io.RawIOBase):
    """Stream of zeros, nothing of which is held in memory."""

    def __init__(self, size):
        self.left = size

    def read(self, size=-1):
        count = self.left if size < 0 else min(size, self.left)
        self.left -= count
        return bytes(count)


def test_files_go_to_the_disk_in_pieces(tmp_path, monkeypatch):
    engine = Jobs(Never(), Store(tmp_path / "jobs.sqlite"), soon)
    monkeypatch.setattr(engine, "_start", lambda job, kind, options: None)
    size = 40 * 2**20
    tracemalloc.start()
    job, new = engine.submit("obj", Endless(size), id="large-file")
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert new and peak < size / 4
    assert engine.store.body(job.id) == bytes(size)
    assert engine.submit("obj", bytes(size), id="large-file") == (job, False), "bytes and a stream with the same content are one request"
    with pytest.raises(Conflict):
        engine.submit("obj", Endless(size - 1), id="large-file")
    engine.close()
