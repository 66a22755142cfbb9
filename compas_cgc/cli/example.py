"""``compas-cgc example``: run one of the paper's examples."""

from __future__ import annotations

import argparse

from .exits import DONE

__all__ = ["add_arguments", "run"]


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of the command."""
    parser.description = "Run an example of the paper and write its mesh, pictures and a record."
    parser.add_argument("number", type=int, choices=range(1, 8), metavar="NUMBER", help="number of the example, 1 to 7")
    parser.add_argument("--variant", help="run one variant, such as 'a' of Example 4 (default: all)")
    parser.add_argument("--out", default="out", metavar="DIR", help="directory for the files (default: out)")
    parser.add_argument("--no-pictures", action="store_true", help="write meshes and records only")
    parser.set_defaults(run=run)


def run(arguments: argparse.Namespace) -> int:
    """Run the command."""
    from ..paper.examples import examples_of
    from ..paper.reproduction import run_example
    from ..paper.reproduction import write_run

    for example in examples_of(arguments.number, arguments.variant):
        done = run_example(example)
        record = done.record()
        outcome = record.get("message", f"largest error {record['max_error']:.3g}")
        print(f"{example.name}: {example.title}: {outcome}")
        for path in write_run(done, arguments.out, pictures=not arguments.no_pictures):
            print(f"  {path}")
    return DONE
