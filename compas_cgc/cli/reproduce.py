"""``compas-cgc reproduce``: run the paper's examples and compare them with the published values."""

from __future__ import annotations

import argparse
import json
from pathlib import Path

from .console import Parts
from .exits import DONE

__all__ = ["add_arguments", "run"]


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of the command."""
    parser.description = "Run all variants of Examples 1 to 7 and Table 2 of the paper, and write tables, meshes, pictures and records."
    parser.add_argument("--out", default="out", metavar="DIR", help="directory for the files (default: out)")
    parser.add_argument("--no-pictures", action="store_true", help="write meshes, records and tables only")
    parser.set_defaults(run=run)


def run(arguments: argparse.Namespace) -> int:
    """Run the command."""
    from .._atomic_write import write_text
    from ..paper.examples import CATALOGUE
    from ..paper.examples import CurveExample
    from ..paper.reproduction import comparison_figures
    from ..paper.reproduction import report
    from ..paper.reproduction import run_example
    from ..paper.reproduction import run_table2
    from ..paper.reproduction import warm_up
    from ..paper.reproduction import write_run

    directory = Path(arguments.out)
    warm_up()
    runs = []
    parts = Parts(len(CATALOGUE) + 2)
    for example in CATALOGUE:
        print(f"{example.name}: {example.title}", flush=True)
        with parts.part(example.name):
            runs.append(run_example(example))
            write_run(runs[-1], directory, pictures=not arguments.no_pictures)
    with parts.part("Table 2"):
        grids = run_table2()
    curves = [done.record() for done in runs if isinstance(done.example, CurveExample)]
    surfaces = [done.record() for done in runs if not isinstance(done.example, CurveExample)]
    page = report(curves, surfaces, grids)
    write_text(directory / "tables.md", page)
    tables = {"curves": curves, "surfaces": surfaces, "table2": {str(n): record for n, record in grids.items()}}
    for record in [*curves, *surfaces]:
        # The history of each record is in its own file.
        record.pop("history")
        record.pop("points", None)
    write_text(directory / "tables.json", json.dumps(tables, indent=1, ensure_ascii=False, allow_nan=False) + "\n")
    if not arguments.no_pictures:
        with parts.part("pictures of several examples"):
            comparison_figures(runs, directory)
    print("\n" + page)
    print(f"wrote {directory / 'tables.md'} and {directory / 'tables.json'}")
    return DONE
