"""The protocol of executors, kept by the pool of this machine and by Dask alike; and what dies on a cluster."""

from __future__ import annotations

import logging
import os
import signal
import time

import pytest

from compas_cgc import CGCMesh
from compas_cgc.errors import CGCError
from compas_cgc.execution.dask_executor import DaskExecutor
from compas_cgc.execution.future import TaskError
from compas_cgc.execution.future import TaskStopped
from compas_cgc.execution.future import WorkerDied
from compas_cgc.execution.pool import WorkerPool
from compas_cgc.execution.remote import executor_at
from compas_cgc.study import Study
from compas_cgc.study import run_study

from ..support import tasks
from ..support.dask_cluster import dask_cluster
from ..support.dask_cluster import kill
from ..support.dask_cluster import until

LONG = 100.0  # seconds to wait for what comes at once when the machine has time for it


def needs_dask():
    pytest.importorskip("distributed", reason="distributed is not installed: pip install 'compas_cgc[dask]'")
    logging.getLogger("distributed").setLevel(logging.CRITICAL)


@pytest.fixture(scope="module")
def cluster():
    needs_dask()
    with dask_cluster(2) as running:
        yield running


@pytest.fixture(scope="module", params=["pool", "dask"])
def executor(request):
    if request.param == "pool":
        own = WorkerPool(2, grace=LONG)
    else:
        own = DaskExecutor(request.getfixturevalue("cluster").address.replace("dask://", "tcp://"), grace=LONG)
    assert own.wait_until_ready(LONG)
    until(lambda: own.workers == 2)
    yield own
    own.shutdown(cancel_futures=True)


# ------------------------------------------------------------------
# What both do
# ------------------------------------------------------------------


def test_a_task_reports_and_returns(executor):
    told = []
    assert executor.start(tasks.add, (2,), {"b": 3}, told.append).result(LONG) == 5
    until(lambda: told == [{"step": 1}])


def test_an_exception_comes_with_its_name_its_text_and_the_workers_traceback(executor):
    with pytest.raises(TaskError, match="of no use") as caught:
        executor.start(tasks.fail, ("of no use",)).result(LONG)
    assert caught.value.kind == "ValueError" and "in fail" in caught.value.trace


def test_what_waits_is_not_running_and_what_runs_is(executor):
    two = [executor.start(tasks.loop, (LONG,)) for _ in range(2)]
    until(lambda: all(task.running() for task in two))
    third, urgent = executor.start(tasks.add, (1, 1)), executor.start(tasks.add, (2, 2), urgent=True)
    until(lambda: executor.health()["waiting"] == 2)
    assert executor.health()["busy"] == 2 and not third.running() and not urgent.running()
    third.stop("not needed")
    assert third.cancelled()
    began = time.monotonic()
    for task in two:
        task.stop("enough", LONG)
    assert [task.result(LONG) for task in two] == ["stopped", "stopped"]
    # 0.02 s where the machine has time, and far less than they would run.
    assert time.monotonic() - began < LONG / 2
    assert urgent.result(LONG) == 4


def test_a_task_that_takes_too_long_or_does_not_listen_is_ended(executor):
    began = time.monotonic()
    assert executor.start(tasks.loop, (LONG,), time_limit=0.3).result(LONG) == "stopped"
    task = executor.start(tasks.deaf, (4.0,))
    until(task.running)
    task.stop("it was cancelled")
    with pytest.raises(TaskStopped, match="it was cancelled"):
        task.result(LONG)
    assert time.monotonic() - began < LONG / 2
    if not isinstance(executor, WorkerPool):
        # Without a nanny nobody can end it, so it is named.
        until(lambda: executor.health()["deaf"])
        until(lambda: not executor.health()["deaf"])


# ------------------------------------------------------------------
# Dask
# ------------------------------------------------------------------


def test_an_address_that_is_none_is_refused_with_an_example():
    for wrong in ("scheduler:8786", "ray://host:1", "dask://scheduler", "dask://:8786"):
        with pytest.raises(CGCError, match="dask://HOST:PORT"):
            executor_at(wrong)


def test_a_worker_of_another_version_is_given_nothing_and_is_named():
    needs_dask()
    with dask_cluster(1) as running:
        running.add_worker(other_version=True)
        executor = executor_at(running.address)
        try:
            until(lambda: executor.workers == 1 and len(executor.health()["refused"]) == 1)
            assert list(executor.health()["refused"].values()) == ["0.0.1"]
            places = {executor.start(os.getpid).result(LONG) for _ in range(6)}
            assert places == {running.workers[0].pid}
        finally:
            executor.shutdown(cancel_futures=True)


def test_a_task_whose_worker_ends_is_told_and_not_begun_again(tmp_path):
    needs_dask()
    with dask_cluster(2) as running:
        executor = executor_at(running.address)
        try:
            until(lambda: executor.workers == 2)
            with pytest.raises(WorkerDied, match="ended unexpectedly"):
                executor.start(tasks.end_process, (str(tmp_path / "begun"),)).result(LONG)
            assert (tmp_path / "begun").read_text() == "begun "
            assert executor.start(tasks.add, (1, 2)).result(LONG) == 3
            assert executor.workers == 1 and (tmp_path / "begun").read_text() == "begun "
        finally:
            executor.shutdown(cancel_futures=True)


def test_tasks_live_through_the_death_of_the_scheduler():
    needs_dask()
    with dask_cluster(1) as running:
        executor = executor_at(running.address)
        try:
            assert executor.wait_until_ready(LONG)
            first, second = executor.start(tasks.loop, (1.5,)), executor.start(tasks.add, (1, 2))
            until(first.running)
            kill(running.scheduler)
            until(lambda: not executor.health()["connected"])
            running.restart_scheduler()
            kill(running.workers[0])
            running.add_worker()
            assert first.result(LONG) == "ended" and second.result(LONG) == 3
        finally:
            executor.shutdown(cancel_futures=True)


@pytest.mark.nightly
@pytest.mark.skipif(not hasattr(signal, "SIGKILL"), reason="it kills processes")
def test_a_study_on_a_cluster_where_workers_die_is_the_same_bit_for_bit(tmp_path):
    needs_dask()
    mesh = CGCMesh.from_meshgrid(dx=6.0, nx=6)
    mesh.set_supports("boundary")
    study = Study.from_dict({"parameters": {"K": {"from": 0.004, "to": 0.02, "count": 80}}})
    run_study(mesh, study, tmp_path / "here")
    killed = []
    with dask_cluster(2) as running:
        executor = executor_at(running.address)
        try:

            def lose_one(state):
                if state.done >= 16 and not killed:
                    killed.append(running.workers[0])
                    kill(killed[0])

            run_study(mesh, study, tmp_path / "there", executor=executor, on_progress=lose_one)
        finally:
            executor.shutdown(cancel_futures=True)
    assert killed
    for name in ("table.csv", "surfaces.npy"):
        assert (tmp_path / "there" / name).read_bytes() == (tmp_path / "here" / name).read_bytes()
