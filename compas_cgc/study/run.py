"""Run of a study: blocks are sent to an executor and rows are written in order; an interrupted run can be resumed."""

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
from typing import cast

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
from ..rationalisation.design import DesignInput
from ..rationalisation.design import GivenDesign
from ..rationalisation.design import given_design
from ..rationalisation.design_data import design_to_dict
from .blocks import solve_block
from .designs import DesignPlan
from .designs import plan_of
from .results import DESIGN
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

POLL_INTERVAL = 0.1  # time between two checks for a stop request [s]
AHEAD = 3  # largest number of running and queued blocks per worker
TRIES = 2  # attempts for a block whose worker ends; the last one is made variant by variant


class Progress(NamedTuple):
    """Progress of a study."""

    done: int  # variants in the table
    variants: int
    before: int  # variants that existed before this run


@names_what_was_meant()
def run_study(
    drawing: Union[PosesProblem, DesignInput],
    study: Study,
    folder: Union[str, os.PathLike[str]],
    *,
    workers: int = 0,
    executor: Optional[TaskExecutor] = None,
    on_progress: Optional[Callable[[Progress], object]] = None,
) -> Results:
    """Solve the variants of a study, or the remaining ones, and write them to a folder.

    The table is bitwise identical whether it is solved by this process, any number of worker processes or other machines of the
    same kind, and whether or not the run was interrupted.

    Parameters
    ----------
    drawing
        A mesh or problem. For a study of a freeform design, anything that :func:`compas_cgc.rationalise` takes.
    study
        Parameters, sampling and measures.
    folder
        Output folder. If it holds results of the same study, the run is resumed. While another process writes to it, this one
        waits; what is damaged in it is computed again.
    workers
        Number of worker processes to start, 0 to solve in this process. A script that starts workers must be
        protected by ``if __name__ == "__main__":``.
    executor
        Executor of the blocks instead, see :mod:`compas_cgc.execution`; it is not closed.
    on_progress
        Called with a :class:`Progress` when rows are written, and periodically; return True to stop.

    Returns
    -------
    Results
        The results so far, also if the run was stopped.

    Raises
    ------
    CGCError
        If the folder holds another study, or a parameter refers to something that the drawing does not have.
    FileError
        If the folder is not writable.

    Examples
    --------
    >>> run_study(problem, study, "roofs")  # doctest: +SKIP
    """
    if not isinstance(study, Study):
        raise CGCError(f"study must be a Study, from Study.from_dict({{...}}) or read_study('study.toml'), not {study!r:.60}")
    varied: Union[CGCProblem, GivenDesign]
    if study.rationalise is None:
        varied = problem_of(cast(PosesProblem, drawing), "is varied").without_dummies()
    else:
        varied = given_design(drawing)
    plan = plan_of(study, varied)
    home = Path(folder)
    count = len(study.variants)
    try:
        home.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise CGCError(f"{home} cannot be used for a study ({error}); choose another folder") from None
    with one_writer(home, lambda: bool(on_progress and on_progress(Progress(0, count, 0)))) as held:
        if not held:
            return Results(home)
        digest = _claimed(home, study, varied)
        starts = [plan.start(k) for k in range(count)]
        # Variants of a design have different meshes, which are not kept.
        kept = None if isinstance(varied, GivenDesign) else len(varied.vertices)
        table = Table(home / TABLE, home / SURFACES, plan.columns, starts, kept)
        own = WorkerPool(workers, warm_up) if executor is None and workers and table.rows < count else None
        try:
            run = _Run(plan, digest, pickle.dumps((study, varied)), table, on_progress)
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

    def __init__(
        self, plan: Union[Plan, DesignPlan], digest: str, content: bytes, table: Table, on_progress: Optional[Callable[[Progress], object]]
    ):
        self.plan, self.digest, self.content, self.table = plan, digest, content, table
        self.on_progress = on_progress
        self.count = len(plan.study.variants)
        self.before = table.rows

    def stopped(self) -> bool:
        """Report progress; return whether to stop."""
        return bool(self.on_progress and self.on_progress(Progress(self.table.rows, self.count, self.before)))

    def here(self) -> bool:
        """Solve in this process; return whether all variants are done."""
        for first in range(self.before, self.count):
            if self.stopped():
                return False
            self.table.add([self.plan.measured(first)])
        self.stopped()
        return True

    def by(self, executor: TaskExecutor) -> bool:
        """Solve with an executor; return whether all variants are done."""
        ahead = AHEAD * max(1, executor.workers)
        left = self._blocks()
        running: dict[Future, tuple[int, int]] = {}
        tries: dict[tuple[int, int], int] = {}
        early: dict[int, list[Measured]] = {}
        again: list[tuple[int, int]] = []

        def begin(block: tuple[int, int]) -> None:
            tries[block] = tries.get(block, 0) + 1
            running[executor.start(solve_block, (self.digest, self.content, *block))] = block

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
        """Return the rows of a block, None if its worker ended and the block is retried, finally variant by variant."""
        try:
            return task.result()
        except TaskStopped:
            raise
        except Exception as error:
            alone = block[1] - block[0] == 1
            if not alone or tries < TRIES:
                return None
            return [self.plan.refused(block[0], f"{error}", "failed")]


def _claimed(home: Path, study: Study, drawing: Union[CGCProblem, GivenDesign]) -> str:
    """Create the folder of a study, or check that it belongs to this study; return the digest of the study."""
    digest = study.digest(drawing)
    try:
        known = json.loads((home / STUDY).read_text(encoding="utf-8")) if (home / STUDY).exists() else None
        if known is not None and not isinstance(known, dict):
            raise ValueError("it holds no object")
    except OSError as error:
        raise CGCError(f"{home} cannot be used for a study ({error}); choose another folder") from None
    except (ValueError, RecursionError):
        # Without it nobody knows of which study the rows are.
        for name in (STUDY, TABLE, SURFACES):
            set_aside(home / name)
        known = None
    if known is not None and (known.get("digest"), known.get("version")) != (digest, __version__):
        raise CGCError(f"{home} holds another study, or one of another version of compas_cgc; choose another folder, or delete this one")
    about = {"version": __version__, "digest": digest, "study": dict(study.data)}
    write_text(home / STUDY, json.dumps(about, indent=1, ensure_ascii=False) + "\n")
    if isinstance(drawing, GivenDesign):
        write_text(home / DESIGN, json.dumps(design_to_dict(drawing), ensure_ascii=False) + "\n")
    else:
        io.write(home / DRAWING, drawing)
    return digest
