"""Run of a study: blocks go to an executor, rows come back in order, and a run that was ended goes on where it was."""

from __future__ import annotations

import json
import os
import pickle
from collections.abc import Callable
from collections.abc import Iterator
from concurrent.futures import FIRST_COMPLETED
from concurrent.futures import Future
from concurrent.futures import wait
from pathlib import Path
from typing import NamedTuple
from typing import Optional
from typing import Union

from .. import io
from .._atomic_write import write_text
from .._version import __version__
from .._warm_up import warm_up
from ..errors import CGCError
from ..errors import names_what_was_meant
from ..execution.future import TaskStopped
from ..execution.future import stop
from ..execution.pool import WorkerPool
from ..execution.protocol import TaskExecutor
from ..model.problem import CGCProblem
from ..model.problem import PosesProblem
from ..model.problem import problem_of
from .blocks import solve_block
from .results import DRAWING
from .results import PARQUET
from .results import STUDY
from .results import SURFACES
from .results import TABLE
from .results import Results
from .spec import Study
from .table import Table
from .table import write_parquet
from .variants import Measured
from .variants import Plan
from .writer import one_writer
from .writer import set_aside

__all__ = ["Progress", "run_study"]

POLL_INTERVAL = 0.1  # seconds between two looks at whether to stop
AHEAD = 3  # blocks for each worker that are under way or wait, at most
TRIES = 2  # times that a block is begun whose worker ends; a variant alone does not look at others of its block the last time


class Progress(NamedTuple):
    """How far a study is."""

    done: int  # variants in the table
    variants: int
    before: int  # that were there already


@names_what_was_meant()
def run_study(
    drawing: PosesProblem,
    study: Study,
    folder: Union[str, os.PathLike[str]],
    *,
    workers: int = 0,
    executor: Optional[TaskExecutor] = None,
    on_progress: Optional[Callable[[Progress], object]] = None,
) -> Results:
    """Solve the variants of a study into a folder, or those that are left.

    The table is the same to the last bit whatever solves it: this process, any number of worker processes, or other machines of
    the same kind; and whether it was done in one go or ended in between.

    Parameters
    ----------
    drawing
        A mesh or problem.
    study
        What is varied and measured.
    folder
        Where table and surfaces go; what is there of the same study is gone on from. While another process writes to it, this one
        waits; what is damaged in it is computed again.
    workers
        Number of processes that are started for it, 0 to solve in this one. A script that starts some needs
        ``if __name__ == "__main__":`` around what it does.
    executor
        Solves the blocks instead, see :mod:`compas_cgc.execution`; it is not closed.
    on_progress
        Called with a :class:`Progress` when rows are written, and now and then; return True to stop.

    Returns
    -------
    Results
        What is there, of a study that was stopped too.

    Raises
    ------
    CGCError
        If the folder holds another study, or the drawing has not what a parameter changes.
    FileError
        If the folder cannot be written to.

    Examples
    --------
    >>> run_study(problem, study, "roofs")  # doctest: +SKIP
    """
    problem = problem_of(drawing, "is varied").without_dummies()
    if not isinstance(study, Study):
        raise CGCError(f"a study says what is varied: Study.from_dict({{...}}), or read_study('study.toml'), not {study!r:.60}")
    plan = Plan(study, problem)
    home = Path(folder)
    count = len(study.variants)
    try:
        home.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise CGCError(f"{home} cannot be used for a study ({error}); give another folder") from None
    with one_writer(home, lambda: bool(on_progress and on_progress(Progress(0, count, 0)))) as held:
        if not held:
            return Results(home)
        digest = _claimed(home, study, problem)
        table = Table(home / TABLE, home / SURFACES, plan.columns, count, len(problem.vertices))
        own = WorkerPool(workers, warm_up) if executor is None and workers and table.rows < count else None
        try:
            run = _Run(plan, digest, pickle.dumps((study, problem)), table, on_progress)
            chosen = executor or own
            finished = run.by(chosen) if chosen is not None else run.here()
        finally:
            if own is not None:
                own.shutdown(cancel_futures=True)
            table.close()
        results = Results(home)
        if finished:
            write_parquet(home / PARQUET, results.columns, results.rows)
        return results


class _Run:
    """One run of a study."""

    def __init__(self, plan: Plan, digest: str, content: bytes, table: Table, on_progress: Optional[Callable[[Progress], object]]):
        self.plan, self.digest, self.content, self.table = plan, digest, content, table
        self.on_progress = on_progress
        self.count = len(plan.study.variants)
        self.before = table.rows

    def stopped(self) -> bool:
        """Tell how far it is; tell whether to stop."""
        return bool(self.on_progress and self.on_progress(Progress(self.table.rows, self.count, self.before)))

    def here(self) -> bool:
        """Solve in this process; tell whether all is done."""
        for first in range(self.before, self.count):
            if self.stopped():
                return False
            self.table.add([self.plan.measured(first)])
        self.stopped()
        return True

    def by(self, executor: TaskExecutor) -> bool:
        """Solve by an executor; tell whether all is done."""
        ahead = AHEAD * max(1, executor.workers)
        left = self._blocks()
        running: dict[Future, tuple[int, int]] = {}
        tries: dict[tuple[int, int], int] = {}
        early: dict[int, list[Measured]] = {}
        again: list[tuple[int, int]] = []

        def begin(block: tuple[int, int]) -> None:
            tries[block] = tries.get(block, 0) + 1
            alone = block[1] - block[0] == 1 and tries[block] == TRIES
            running[executor.start(solve_block, (self.digest, self.content, *block, alone))] = block

        try:
            while True:
                while again:
                    begin(again.pop())
                while len(running) + len(early) < 4 * ahead and len(running) < ahead:
                    block = next(left, None)
                    if block is None:
                        break
                    begin(block)
                if self.stopped():
                    return False
                if not running:
                    return True
                for task in wait(running, POLL_INTERVAL, FIRST_COMPLETED).done:
                    block = running.pop(task)
                    done = self._outcome(task, block, tries[block])
                    if done is None:
                        again += [block] if tries[block] < TRIES else [(k, k + 1) for k in range(*block)]
                    else:
                        early[block[0]] = done
                while self.table.rows in early:
                    self.table.add(early.pop(self.table.rows))
        finally:
            for task in running:
                stop(task, "the study was stopped")

    def _blocks(self) -> Iterator[tuple[int, int]]:
        size = self.plan.block_size
        for first in range(0, self.count, size):
            block = max(first, self.before), min(first + size, self.count)
            if block[0] < block[1]:
                yield block

    def _outcome(self, task: Future, block: tuple[int, int], tries: int) -> Optional[list[Measured]]:
        """Return what was measured of a block; None where its worker ended and it is to be tried again, at last one by one."""
        try:
            return task.result()
        except TaskStopped:
            raise
        except Exception as error:
            alone = block[1] - block[0] == 1
            if not alone or tries < TRIES:
                return None
            return [self.plan.refused(block[0], f"{error}", "failed")]


def _claimed(home: Path, study: Study, problem: CGCProblem) -> str:
    """Make a folder that of a study, or find that it is; return the name of the study."""
    digest = study.digest(problem)
    try:
        known = json.loads((home / STUDY).read_text(encoding="utf-8")) if (home / STUDY).exists() else None
        if known is not None and not isinstance(known, dict):
            raise ValueError("it holds no object")
    except OSError as error:
        raise CGCError(f"{home} cannot be used for a study ({error}); give another folder") from None
    except (ValueError, RecursionError):
        # Without it nobody knows of which study the rows are.
        for name in (STUDY, TABLE, SURFACES):
            set_aside(home / name)
        known = None
    if known is not None and (known.get("digest"), known.get("version")) != (digest, __version__):
        raise CGCError(f"{home} holds another study, or one of another version of compas_cgc; give another folder, or remove this one")
    about = {"version": __version__, "digest": digest, "study": dict(study.data)}
    write_text(home / STUDY, json.dumps(about, indent=1, ensure_ascii=False) + "\n")
    if known is None or not (home / DRAWING).exists():
        io.write(home / DRAWING, problem)
    return digest
