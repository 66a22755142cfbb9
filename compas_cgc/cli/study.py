"""``compas-cgc study``: solve many variants of a drawing."""

from __future__ import annotations

import argparse
import os
import sys
import time
from collections.abc import Iterator
from collections.abc import Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING
from typing import Any
from typing import Optional

from ..errors import CGCError
from .arguments import add_input
from .arguments import add_reading
from .arguments import read_input
from .console import bar
from .console import interruptible
from .console import printer
from .exits import DONE
from .exits import INTERRUPTED
from .parser import count

if TYPE_CHECKING:
    from ..study import Results
    from ..study import Study
    from ..study.run import Progress

__all__ = ["add_arguments", "run"]

_EPILOG = """\
The study is a TOML file with the parameters to vary:

  sample = "grid"                     # or "list"; or "random" or "latin hypercube", with count and seed
  supports = "corners"
  [parameters]
  K = { from = 0.002, to = 0.006, count = 9 }
  gate = { kind = "clearance", where = [5.5, 0.0, 9.5, 3.0], values = [2.0, 2.5] }
  [pareto]
  least = ["area"]
  most = ["volume"]

If FILE is a freeform design, as for compas-cgc rationalise, the parameters are moulds, panel, within or seams:

  [rationalise]
  supports = "boundary"               # and other options of rationalise
  [parameters]
  panel = [2.0, 2.5, 3.0]
  moulds = [3, 4, 6, 8]
  [pareto]
  least = ["moulds", "distance"]

OUT is a folder for table.csv (and table.parquet), surfaces.npy, contact_sheet.png, pareto.png and best/*.3dm. To resume a study that was
stopped, run the same command again. See docs/studies.md.

examples:
  compas-cgc study roof.3dm study.toml -o roofs
  compas-cgc study roof.3dm study.toml -o roofs --workers 4
  compas-cgc study design.3dm panels.toml -o panels
  compas-cgc study roof.3dm study.toml -o roofs --executor dask://scheduler:8786
"""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of the command."""
    parser.description = "Solve many variants of a drawing. Write a table with all results and verdicts, pictures, and the best variants."
    parser.epilog = _EPILOG
    add_input(parser)
    parser.add_argument("study", metavar="STUDY", help=".toml file with the parameters to vary")
    parser.add_argument("-o", "--output", required=True, metavar="OUT", help="folder to write to")
    parser.add_argument("--workers", type=count, metavar="N", help="number of processes (default: number of processors)")
    parser.add_argument("--executor", metavar="ADDRESS", help="solve on other machines, such as dask://scheduler:8786")
    parser.add_argument("--no-pictures", action="store_true", help="do not draw pictures")
    parser.add_argument("-q", "--quiet", action="store_true", help="print errors only")
    add_reading(parser)
    parser.set_defaults(run=run)


def run(arguments: argparse.Namespace) -> int:
    """Run the command."""
    from ..study.outputs import best_variants
    from ..study.outputs import write_best
    from ..study.outputs import write_pictures
    from ..study.run import run_study
    from ..study.spec import read_study

    echo = printer(arguments.quiet)
    study = read_study(arguments.study)
    drawing, notes = _varied(arguments, study)
    for note in notes:
        echo(f"{arguments.input}: {note}")
    shown = _Bar(arguments.quiet)
    with interruptible() as cancelled, _executor(arguments) as executor:

        def on_progress(state: Progress) -> bool:
            shown(state)
            return cancelled.is_set()

        try:
            workers = 0 if executor is not None else arguments.workers or os.cpu_count() or 1
            results = run_study(drawing, study, arguments.output, workers=workers, executor=executor, on_progress=on_progress)
        finally:
            shown.close()
    if len(results) < len(study.variants):
        print(
            f"compas-cgc: stopped after {len(results)} of {len(study.variants)} variants; run the command again to resume", file=sys.stderr
        )
        return INTERRUPTED
    echo(_summary(results))
    if not arguments.no_pictures:
        for path in write_pictures(results):
            echo(f"wrote {path}")
    for path, variant in zip(write_best(results, Path(arguments.input)), best_variants(results)):
        echo(f"variant {variant}: wrote {path}")
    return DONE


def _varied(arguments: argparse.Namespace, study: Study) -> tuple[Any, Sequence[str]]:
    """Return the drawing or the freeform design of a study, and notes on reading it."""
    if study.rationalise is None:
        read = read_input(arguments)
        return read.checked(), read.notes
    from ..rationalisation.design import given_design

    design = given_design(arguments.input)
    return design, design.notes


@contextmanager
def _executor(arguments: argparse.Namespace) -> Iterator[Optional[Any]]:
    """Yield the requested executor, or None for processes of this machine."""
    if arguments.executor is None:
        yield None
        return
    if arguments.workers is not None:
        raise CGCError("--workers applies to this machine only; omit it if --executor is given")
    from ..execution.remote import executor_at

    executor = executor_at(arguments.executor)
    try:
        yield executor
    finally:
        executor.shutdown(cancel_futures=True)


class _Bar:
    """Progress of a study on one line of a terminal."""

    def __init__(self, quiet: bool):
        self.quiet = quiet or not sys.stderr.isatty()
        self.began: Optional[float] = None
        self.text = ""

    def __call__(self, state: Progress) -> None:
        """Show the progress."""
        if self.quiet:
            return
        now = time.monotonic()
        self.began = now if self.began is None else self.began
        text = f"{bar(state.done / state.variants)} {state.done} of {state.variants} variants"
        new = state.done - state.before
        if new:
            seconds = (state.variants - state.done) * (now - self.began) / new
            text += f", {seconds:.0f} s left"
        if text != self.text:
            sys.stderr.write("\r" + text.ljust(len(self.text)))
            sys.stderr.flush()
            self.text = text

    def close(self) -> None:
        """Clear the line."""
        if self.text:
            sys.stderr.write("\r" + " " * len(self.text) + "\r")
            sys.stderr.flush()


def _summary(results: Results) -> str:
    status, verdict = results.column("status"), results.column("verdict")
    fair = sum(own == "converged" and word == "fair" for own, word in zip(status, verdict))
    rough = sum(own == "converged" and word != "fair" for own, word in zip(status, verdict))
    exceeded = status.count("exceeded")
    left = len(results) - fair - rough - exceeded
    farther = f"{exceeded} farther from the design than allowed, " if exceeded else ""
    return f"{len(results)} variants: {fair} fair, {rough} rough, {farther}{left} not converged\nwrote {results.folder / 'table.csv'}"
