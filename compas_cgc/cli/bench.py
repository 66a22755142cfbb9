"""``compas-cgc bench``: measure the speed as ratios within one run."""

from __future__ import annotations

import argparse
import json

from .console import Parts
from .exits import DONE

__all__ = ["add_arguments", "run"]

_SIZES = (100, 1_000, 10_000, 100_000)


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of the command."""
    parser.description = (
        "Measure the paper's examples, the growth of the time with the mesh size, the solvers, the server and\n"
        "the curvature kernel. Results are ratios within one run."
    )
    parser.add_argument("--large", action="store_true", help="include a million vertices, which takes minutes and gigabytes")
    parser.add_argument("--backend", default="auto", help="linear solver of Newton's method: auto (default), superlu or pardiso")
    parser.add_argument("--json", metavar="FILE", help="also write the figures as JSON")
    parser.set_defaults(run=run)


def run(arguments: argparse.Namespace) -> int:
    """Run the command."""
    from .._atomic_write import write_text
    from ..paper import benchmarks

    figures = {}
    parts = Parts(8)
    print("The paper's examples with the paper's flow, solve only", flush=True)
    with parts.part("the paper's examples"):
        figures["examples"] = benchmarks.example_times()
    _print(figures["examples"], "example vertices steps seconds paper_seconds times_faster microseconds_per_vertex_and_step")

    print("\nThe flow on finer grids, with a filter radius of five edges", flush=True)
    with parts.part("the flow on finer grids"):
        figures["flow_growth"] = benchmarks.growth()
    _print(figures["flow_growth"], "vertices microseconds_per_vertex_and_step")
    print(f"the time of a step grows as vertices to the power {figures['flow_growth'][0]['exponent']:.2f}")

    print("\nNewton's method on a square with a fixed edge and K̄ w² = 1 from a flat start; ratio to one SuperLU")
    print("factorisation of the Laplacian of the same mesh", flush=True)
    sizes = (*_SIZES, 1_000_000) if arguments.large else _SIZES
    with parts.part("Newton's method"):
        figures["newton"] = benchmarks.newton_growth(sizes, arguments.backend)
    _print(figures["newton"], "vertices status steps seconds ratio residual max_error rounding_floor peak_memory_bytes")
    print(f"the time grows as vertices to the power {benchmarks.fitted_exponent(figures['newton'], 'seconds'):.2f}")

    print(
        "\nThe fairest surface on four corners with free edges, including checks and verdict; ratio to the same factorisation", flush=True
    )
    with parts.part("the fairest surface"):
        figures["fairest"] = benchmarks.fairest_growth(sizes[1:])
    _print(figures["fairest"], "vertices K status verdict steps seconds ratio max_error peak_memory_bytes")

    print("\nGeneral optimisers on the same residual, with the exact Jacobian", flush=True)
    with parts.part("general optimisers"):
        figures["optimisers"] = benchmarks.against_optimisers()
    _print(figures["optimisers"], "method vertices seconds newton_seconds times_slower max_error")

    print("\nA roof on four corners, solved again by projection after a change of K̄ by 5 %", flush=True)
    with parts.part("a roof solved again"):
        figures["interactive"] = [benchmarks.interactive()]
    _print(figures["interactive"], "vertices seconds status max_error")

    print("\nA dome on a local server: a job compared with solve and analysis, Hops compared with the solve of a mesh", flush=True)
    with parts.part("the server"):
        figures["server"] = benchmarks.server_overhead((1_024, 10_000, 100_000) if arguments.large else (1_024, 10_000))
    _print(figures["server"], "vertices solve_seconds analysed_seconds job_seconds job_ratio job_cpu_ratio")
    _print(figures["server"], "vertices hops_seconds hops_ratio hops_cpu_ratio cancel_seconds hang_up_seconds")

    print("\nThe curvature kernel compared with libigl (angle defects and mixed areas)", flush=True)
    try:
        with parts.part("the curvature kernel"):
            figures["kernel"] = benchmarks.kernel_ratio()
    except ImportError:
        print("skipped: libigl is not installed")
    else:
        _print(figures["kernel"], "vertices seconds libigl_seconds ratio")
    if arguments.json:
        write_text(arguments.json, json.dumps(figures, indent=1) + "\n")
    return DONE


def _print(rows: list[dict], names: str) -> None:
    """Print the named columns of a table."""
    heads = names.split()
    table = [[head.replace("_", " ") for head in heads]]
    table += [[_text(row[head]) for head in heads] for row in rows]
    widths = [max(len(line[k]) for line in table) for k in range(len(heads))]
    for line in table:
        print("  ".join(cell.rjust(width) for cell, width in zip(line, widths)))


def _text(value: object) -> str:
    return f"{value:.3g}" if isinstance(value, float) else "-" if value is None else str(value)
