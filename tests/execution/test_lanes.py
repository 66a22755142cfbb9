"""Lanes: no client and no kind of task holds all workers, and a short call is answered beside long ones."""

from __future__ import annotations

import os
import time
from functools import partial

import pytest

from compas_cgc.execution.future import Task
from compas_cgc.execution.future import TaskStopped
from compas_cgc.execution.lanes import ANY
from compas_cgc.execution.lanes import CALLS
from compas_cgc.execution.lanes import SHORT
from compas_cgc.execution.lanes import Lanes
from compas_cgc.execution.pool import WorkerPool

from ..support import tasks
from ..support.dask_cluster import until

LONG = 100.0


def task(client, urgent=False, long=False, alike=""):
    own = Task((tasks.add, (1, 1), {}), None, None, urgent, client, alike=alike)
    own.long = long
    return own


def test_lanes_are_for_all_tasks_for_calls_and_for_short_calls():
    assert Lanes(2).kinds == [ANY, ANY] and Lanes(1, 1).kinds == [ANY, CALLS] and Lanes(1, 2).kinds == [ANY, CALLS, SHORT]
    assert Lanes(1, 4).kinds == [ANY, CALLS, CALLS, SHORT, SHORT]
    lanes, job, call, long = Lanes(2, 2), task("a"), task("a", urgent=True), task("a", urgent=True, long=True)
    for lane, found in ((ANY, [job, call, long]), (CALLS, [call, long]), (SHORT, [call])):
        assert [own for own in (job, call, long) if lanes.pick(lane, [own], []) is own] == found


def test_the_client_that_holds_the_fewest_lanes_is_next_and_clients_take_turns():
    lanes = Lanes(4)
    a, b, c = (task(name) for name in "abc")
    assert lanes.pick(ANY, [a, b, c], [task("a"), task("c")]) is b
    queue = [task("a") for _ in range(3)] + [task("b"), task("c")]
    order = []
    while queue:
        found = lanes.pick(ANY, queue, [])
        order.append(found.client)
        queue.remove(found)
        time.sleep(0.001)
    # b was served above.
    assert order == ["a", "c", "b", "a", "a"]


def test_no_client_holds_all_lanes_where_there_are_others():
    lanes, own = Lanes(3), [task("a") for _ in range(3)]
    for one in own:
        lanes.submitted(one)
    assert lanes.pick(ANY, own, own[:2]) is not None, "alone it may"
    lanes.submitted(task("b"))
    assert lanes.pick(ANY, own, own[:2]) is None


def test_calls_go_before_jobs_as_long_as_the_first_in_the_queue_is_one():
    lanes, job, call = Lanes(1), task("a"), task("a", urgent=True)
    assert lanes.pick(ANY, [call, job], []) is call
    assert lanes.pick(ANY, [job, call], []) is job, "it has waited for long"


def test_a_client_whose_call_was_long_begins_elsewhere_until_one_is_short():
    lanes, first, second, third = Lanes(1, 2), *(task("a", urgent=True) for _ in range(3))
    lanes.moved(first)
    lanes.submitted(second)
    assert first.long and second.long and not lanes.wants_short_lane([second])
    lanes.ended(second, 0.1)
    lanes.submitted(third)
    assert not third.long and lanes.wants_short_lane([third])


def test_the_short_lane_prefers_clients_whose_last_call_was_short():
    lanes = Lanes(1, 2)
    lanes.ended(task("k", urgent=True), 0.1)
    waiting = [task(name, urgent=True) for name in "abk"]
    lanes.pick(SHORT, [waiting[2]], [])
    assert lanes.pick(SHORT, waiting, []) is waiting[2], "although it was served last"
    assert lanes.pick(CALLS, waiting, []) is waiting[0]
    lanes.ended(waiting[2], 2.0)
    again = task("k", urgent=True)
    lanes.submitted(again)
    assert lanes.pick(SHORT, [again, waiting[1]], []) is waiting[1]


def test_calls_of_a_client_that_differ_are_known_apart():
    lanes, slow, fast = Lanes(1, 2), task("a", True, alike="a rationalise"), task("a", True, alike="a dome")
    lanes.moved(slow)
    again = [task("a", True, alike=own.alike) for own in (slow, fast)]
    for own in again:
        lanes.submitted(own)
    assert [own.long for own in again] == [True, False]


def test_the_last_free_short_lane_is_kept_for_calls_known_to_be_short():
    lanes, known, new = Lanes(1, 3), task("k", urgent=True), task("a", urgent=True)
    lanes.ended(known, 0.1)
    assert lanes.pick(SHORT, [new], [], free=2) is new
    assert lanes.pick(SHORT, [new], [], free=1) is None
    assert lanes.pick(SHORT, [new, known], [], free=1) is known
    assert Lanes(1, 2).pick(SHORT, [new], [], free=1) is new, "the only one is for all"


@pytest.fixture(scope="module")
def pool():
    with WorkerPool(1, grace=0.5, reserved=2) as own:
        assert own.wait_until_ready(LONG)
        yield own


def test_a_short_call_is_answered_beside_jobs_and_long_calls_of_others(pool, tmp_path):
    """The long call on the short lane begins again on another lane when there is one, and is answered in the end."""
    job = pool.start(tasks.loop, (LONG,), client="a")
    until(job.running)
    end = tmp_path / "end"
    long = [pool.start(tasks.loop_until, (str(end),), client=name, urgent=True) for name in "abc"]
    until(lambda: all(own.running() for own in long))
    assert pool.start(tasks.add, (1, 2), client="k", urgent=True).result(LONG) == 3
    assert not any(own.done() for own in (job, *long))
    job.stop()
    end.touch()
    assert [own.result(LONG) for own in long] == ["ended"] * 3


def test_a_call_that_does_not_hear_leaves_the_short_lane_by_force_and_is_answered(pool):
    busy = []
    for client, urgent in (("d", True), ("e", False)):
        busy.append(pool.start(tasks.loop, (4.0,), client=client, urgent=urgent))
        until(busy[-1].running)
    deaf = pool.start(time.sleep, (1.5,), client="f", urgent=True)
    until(deaf.running)
    time.sleep(0.6)
    assert pool.start(tasks.add, (1, 2), client="k", urgent=True).result(LONG) == 3
    assert deaf.result(LONG) is None
    assert [own.result(LONG) for own in busy]


def test_a_task_that_takes_too_much_memory_is_ended_alone(pool):
    with pytest.raises(TaskStopped, match="memory limit of 1 MB"):
        pool.start(tasks.loop, (LONG,), urgent=True, memory_limit=2**20).result(LONG)
    assert pool.start(tasks.add, (1, 2)).result(LONG) == 3


def test_arguments_are_fetched_when_a_worker_takes_the_task(pool):
    fetched = []
    assert pool.start(tasks.add, lambda: fetched.append(1) or (2, 3)).result(LONG) == 5 and fetched == [1]
    with pytest.raises(ZeroDivisionError):
        pool.start(tasks.add, lambda: 1 / 0).result(LONG)


@pytest.mark.skipif(not hasattr(os, "getpriority"), reason="the system has no priorities")
def test_processes_of_short_lanes_go_first_on_busy_processors():
    with WorkerPool(1, reserved=2, niceness=3) as pool:
        assert pool.wait_until_ready(LONG)
        own = os.getpriority(os.PRIO_PROCESS, 0)
        assert [os.getpriority(os.PRIO_PROCESS, pid) - own for pid in pool.processes()] == [3, 3, 0]


def test_a_call_known_to_be_short_does_not_wait_for_the_start_of_a_worker(tmp_path):
    """A call that does not hear is ended with its worker; another worker answers before the next has started."""
    (tmp_path / "may").touch()
    with WorkerPool(1, partial(tasks.start_when_allowed, str(tmp_path / "may")), grace=0.5, reserved=3) as pool:
        assert pool.wait_until_ready(LONG)
        assert pool.start(tasks.add, (1, 2), client="k", urgent=True).result(LONG) == 3
        busy = []
        for client, urgent in (("d", False), ("e", True)):
            busy.append(pool.start(tasks.loop, (LONG,), client=client, urgent=urgent))
            until(busy[-1].running)
        (tmp_path / "may").unlink()
        deaf = [pool.start(time.sleep, (LONG,), client=name, urgent=True) for name in "fgh"]
        until(lambda: pool.replaced == 1)
        assert pool.start(tasks.add, (1, 2), client="k", urgent=True).result(LONG) == 3
        assert pool.health()["starting"] == 1
        for own in (*busy, *deaf):
            own.stop()
