"""Background runs of all components: they end with their branch, component, cluster or document, and never block the canvas."""

from __future__ import annotations

import gc
import sys
import threading
import time
import types
from typing import Any
from typing import NamedTuple

import numpy as np
import pytest

from compas_cgc import CGCMesh
from compas_cgc import solve
from compas_cgc.grasshopper.runtime import background
from compas_cgc.grasshopper.runtime import runner as runner_module
from compas_cgc.grasshopper.runtime.background import BackgroundTask
from compas_cgc.grasshopper.runtime.component_feedback import reports_errors
from compas_cgc.grasshopper.runtime.progress import Progress
from compas_cgc.grasshopper.runtime.runner import Finished
from compas_cgc.grasshopper.runtime.runner import Runner
from compas_cgc.grasshopper.runtime.wire_mesh import WireMesh

from ...support.gh_stand_ins import Component
from ...support.gh_stand_ins import Document
from ...support.gh_stand_ins import place
from ...support.gh_stand_ins import rhino  # noqa: F401
from ...support.gh_stand_ins import square
from ...support.server_process import PATIENCE
from ...support.server_process import wait_for
from ...support.tables import rows_and_notes
from .test_solve import until_done

pytestmark = pytest.mark.usefixtures("rhino")


class Outputs(NamedTuple):
    value: Any = None


class Counter:
    """A component that computes for ever, with or without reports, and needs no surface."""

    def __init__(self, reports):
        self.runner, self.component, self.reports = Runner(Outputs(), "counting"), Component(Document()), reports

    def work(self, report, last):
        number = 0
        while True:
            number += 1
            if self.reports and report(Progress(number)):
                return Finished(Outputs(number))

    def solution(self, *values, **options):
        """Run the component once for each value on its wire."""
        outs = []
        for self.component.RunCount, value in enumerate(values, 1):
            outs.append(self.runner.outputs(self.component, (value,), self.work, **options))
        return outs

    def alive(self):
        return len(self.runner.tasks(self.component))


def ends_within_a_second(tasks):
    """Wait for tasks to end by themselves, and check the time that this process had for it, while they compute all the time."""
    start = time.process_time()
    return all(task.wait(PATIENCE) for task in tasks) and time.process_time() - start < 1.0


@pytest.mark.parametrize("reports", [True, False], ids=["that reports", "without reports"])
@pytest.mark.parametrize("end", ["branch", "all branches", "component", "lock", "cluster", "document", "run", "wire", "reset"])
def test_a_computation_ends_with_what_it_belongs_to(monkeypatch, reports, end):
    counter = Counter(reports)
    component, document = counter.component, counter.component.document
    if end == "cluster":
        cluster = Component(Document())
        document.Owner = cluster
        # Inside a cluster, the canvas waits for the computations, until the Escape key is pressed.
        monkeypatch.setattr(runner_module, "is_headless", lambda component: False)
    states = counter.solution("a", "b", "c")
    assert [own.state for own in states] == ["running"] * 3
    tasks = counter.runner.tasks(component)
    if end == "branch":
        counter.solution("a", "b")
        document.tick()
        assert counter.alive() == 2 and [task.cancelled for task in tasks] == [False, False, True]
        gone = tasks[2:]
    elif end == "all branches":
        counter.solution(None)
        document.tick()
        gone = tasks[1:]
    elif end == "component":
        component.document, gone = None, tasks
    elif end == "lock":
        component.Locked, gone = True, tasks
    elif end == "cluster":
        cluster.document, gone = None, tasks
    elif end == "document":
        document.close()
        gone = tasks
    elif end == "run":
        counter.solution("a", "b", "c", run=False)
        gone = tasks
    elif end == "wire":
        for component.RunCount in (1, 2, 3):
            counter.runner.pause(component)
        gone = tasks
    else:
        for component.RunCount in (1, 2, 3):
            counter.runner.reset(component)
        gone = tasks
    assert ends_within_a_second(gone)
    component.document = None
    assert ends_within_a_second(tasks)


def test_an_unlocked_component_goes_on():
    counter = Counter(True)
    counter.solution("a")
    counter.component.Locked = True
    (first,) = counter.runner.tasks(counter.component)
    assert ends_within_a_second([first])
    counter.component.Locked = False
    assert counter.solution("a")[0].state == "running"
    (second,) = counter.runner.tasks(counter.component)
    assert second is not first
    counter.runner.reset(counter.component)
    assert ends_within_a_second([second])


def test_several_branches_share_one_poll(monkeypatch):
    monkeypatch.setattr(runner_module, "MISSED_POLLS", PATIENCE)
    counter = Counter(True)
    for _ in range(5):
        counter.solution("a", "b", "c", brief=False)
    assert len(counter.component.document.scheduled) == 1
    counter.component.document.close()


def test_a_newer_input_waits_for_the_older_one_to_end():
    running, most = [], []

    def work(report, last):
        running.append(1)
        most.append(len(running))
        try:
            while not report(Progress(1, preview=lambda: {"value": len(most)})):
                time.sleep(0.002)
        finally:
            running.pop()
        return Finished(Outputs())

    runner, component = Runner(Outputs(), "counting"), Component(Document())
    for value in range(20):
        runner.outputs(component, (value,), work, brief=False)
        time.sleep(0.01)
    (task,) = runner.tasks(component)
    assert max(most) == 1, "one at a time"
    runner.reset(component)
    assert ends_within_a_second([task])


def test_an_error_is_shown_until_the_inputs_change():
    def work(report, last):
        raise ValueError("the roof is upside down")

    runner, component = Runner(Outputs(), "failing"), Component(Document())

    @reports_errors(Outputs)
    def run(component, value):
        return runner.outputs(component, (value,), work).outputs

    for _ in range(2):
        component.balloons.clear()
        assert run(component, 1) == Outputs() and component.balloons == [("Error", "the roof is upside down")]


def test_a_task_that_is_not_wanted_is_interrupted():
    def forever(report):
        while True:
            pass

    task = BackgroundTask(forever, lambda: False)
    assert ends_within_a_second([task]) and task.result is None and task.error is None


def test_a_task_that_has_ended_interrupts_no_thread_with_its_identifier():
    task = BackgroundTask(lambda report: None)
    task.cancel()
    assert task.wait(PATIENCE)
    time.sleep(background.GRACE + 4 * background.CHECK_INTERVAL)
    stop, caught = threading.Event(), []

    def innocent():
        try:
            while not stop.is_set():
                pass
        except BaseException as error:
            caught.append(error)

    threads = [threading.Thread(target=innocent, daemon=True) for _ in range(3)]
    for thread in threads:
        thread.start()
    task.check()
    time.sleep(0.05)
    stop.set()
    for thread in threads:
        thread.join(PATIENCE)
    assert not caught


def test_an_interruption_at_the_end_of_a_task_leaves_the_garbage_collector_enabled():
    begun, go = threading.Event(), threading.Event()

    def function(report):
        begun.set()
        go.wait(PATIENCE)

    wait_for(gc.isenabled, what="tasks of other tests")
    task = BackgroundTask(function)
    assert begun.wait(PATIENCE) and not gc.isenabled()
    task.cancel()
    with background._CHANGE:  # holds whatever a task does at its end
        go.set()
        time.sleep(0.05)
        task._deadline = 0.0
        task.check()
    assert task.wait(PATIENCE)
    wait_for(gc.isenabled)


def test_interruptions_at_any_moment_stay_inside_the_task(monkeypatch):
    monkeypatch.setattr(background, "GRACE", 0.0)
    escaped = []
    monkeypatch.setattr(threading, "excepthook", escaped.append)
    for number in range(300):
        end = time.perf_counter() + 1e-5 * (number % 30)

        def function(report, end=end):
            while time.perf_counter() < end:
                pass

        task = BackgroundTask(function)
        task.cancel()
        while task.running:
            task.check()
    wait_for(gc.isenabled)
    assert not escaped


def test_escape_ends_the_wait(monkeypatch):
    pressed = types.SimpleNamespace(GH_ScheduleDelegate=None, IsEscapeKeyDown=lambda: True)
    monkeypatch.setattr(sys.modules["Grasshopper.Kernel"], "GH_Document", pressed)
    counter = Counter(False)
    with pytest.raises(ValueError, match="Escape"):
        counter.solution("a", wait=True)


# ----------------------------------------------------------------------
# Slider
# ----------------------------------------------------------------------


def grid(n, supports="corners", K=0.01):
    mesh = CGCMesh.from_meshgrid(dx=9.0, nx=n)
    mesh.set_supports(supports)
    mesh.set_target(K)
    return mesh.to_problem()


@pytest.mark.nightly
@pytest.mark.parametrize("supports", ["corners", "boundary"])
def test_a_slider_shows_a_new_surface_in_at_least_12_of_15_ticks(supports):
    """A tick lasts 250 ms, and longer where the system gives this process less time for computing than that."""
    problem, placed = grid(60, supports), place("Solve")
    assert len(problem.vertices) == 3721
    document = placed.component.document
    first, end = placed.run(cgc_mesh=WireMesh(problem), run=True), time.monotonic() + PATIENCE
    while first["status"] == "running":
        assert time.monotonic() < end
        time.sleep(0.02)
        document.tick()
        first = placed.run(cgc_mesh=WireMesh(problem), run=True)
    seen, shown = [first["mesh"]], 0
    for tick in range(15):
        wire = WireMesh(problem.with_targets(0.01 + 0.0002 * tick))
        end, computed = time.monotonic() + 0.25, time.process_time() + 0.25
        out, before = placed.run(cgc_mesh=wire, run=True), len(seen)
        while True:
            if out["mesh"] is not seen[-1]:
                seen.append(out["mesh"])
            time.sleep(max(0.01, min(0.1, end - time.monotonic())))
            if time.monotonic() >= end and (time.process_time() >= computed or out["status"] != "running"):
                break
            document.tick()
            if placed.component.expired:
                out = placed.run(cgc_mesh=wire, run=True)
        shown += len(seen) > before
    placed.run(reset=True)
    print(f"{supports}: {len(seen) - 1} surfaces, new ones in {shown} of 15 ticks")
    assert shown >= 12


def vault(n):
    """Return a barrel vault, which unrolls."""
    flat = grid(n, "boundary", 0.0)
    return flat.with_vertices(flat.vertices + np.outer(flat.vertices[:, 0] * (9.0 - flat.vertices[:, 0]), [0.0, 0.0, 0.05]))


def test_cut_sheets_state_material_and_thickness_and_leave_room_for_the_kerf(tmp_path):
    pytest.importorskip("shapely")
    path = tmp_path / "cut.list.csv"
    given = dict(length=4.0, width=2.0, kerf=0.004, material="birch plywood", thickness=9.0, path=str(path), write=True)
    placed = place("Unroll")
    out = placed.settle(cgc_mesh=WireMesh(vault(9)), **given)
    assert not placed.said("Error") and "material: birch plywood, 9 mm thick" in out["report"]
    for rows in (rows_and_notes(out["cut_list"])[0], rows_and_notes(path.open())[0]):
        assert {(row["material"], row["thickness in mm"]) for row in rows} == {("birch plywood", "9")} and len(rows) == len(out["pieces"])
    assert len(out["allowances"]) == len(out["outlines"]) > 0 and not placed.settle(cgc_mesh=WireMesh(vault(9)), kerf=0.0)["allowances"]


# ----------------------------------------------------------------------
# Blocks of the interface's thread
# ----------------------------------------------------------------------

BLOCKED = {
    "Mesh": dict(),
    "Target": dict(K=[0.02]),
    "Solve": dict(run=True),
    "Analyse": dict(),
    "Regions": dict(),
    "Unroll": dict(),
    "Mould": dict(count=4),
    "Membrane": dict(),
    "Net": dict(),
}


@pytest.mark.nightly
@pytest.mark.parametrize("name", sorted(BLOCKED))
def test_no_component_blocks_the_canvas_for_100_ms(name):
    """The interface runs some Python every 5 ms, which needs the lock of the interpreter as the canvas does.

    A wait during which the system gave this process no time is not a block by the component.
    """
    bent = name in ("Net", "Unroll")
    warm = vault(9) if bent else grid(9, "boundary", 0.001)
    place(name).settle(**BLOCKED[name], **({"mesh": square(9)} if name == "Mesh" else {"cgc_mesh": WireMesh(warm)}))
    given = vault(200) if bent else grid(200, "boundary", 0.001)
    assert len(given.vertices) == 40401
    inputs = dict(BLOCKED[name])
    inputs.update({"mesh": square(200)} if name == "Mesh" else {"cgc_mesh": WireMesh(given)})
    placed, calls = place(name), []

    def timed(call):
        start, used = time.perf_counter(), time.process_time()
        call()
        calls.append(min(time.perf_counter() - start, time.process_time() - used))

    timed(lambda: placed.run(**inputs))
    end = time.monotonic() + 20.0
    while placed.component.document.scheduled and time.monotonic() < end:
        timed(lambda: time.sleep(0.005))
        timed(placed.component.document.tick)
        if placed.component.expired:
            timed(lambda: placed.run(**inputs))
    placed.component.document.close()
    print(f"{name}: {1000 * max(calls):.0f} ms, message {placed.component.Message!r}")
    assert max(calls) <= 0.1


def test_a_result_does_not_depend_on_the_surface_before_it():
    problem, placed = grid(12), place("Solve")
    for K in (0.01, 0.012):
        out = until_done(placed, cgc_mesh=WireMesh(problem.with_targets(K)), run=True)[-1]
    assert np.array_equal(out["cgc_mesh"].problem.vertices, solve(problem.with_targets(0.012)).vertices)
