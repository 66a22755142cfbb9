"""``compas-cgc bench``: what it costs, as ratios."""

from __future__ import annotations

import argparse
import json

from .exits import DONE


def add_parser(subparsers: argparse._SubParsersAction) -> None:
    """Add the command and its arguments."""
    parser = subparsers.add_parser(
        "bench",
        help="measure the speed on this machine",
        description="Time the paper's examples, the growth with the mesh and the curvature kernel, as ratios where that can be.",
    )
    parser.add_argument("--json", metavar="FILE", help="write the figures as JSON too")
    parser.set_defaults(run=run)


def run(arguments: argparse.Namespace) -> int:
    """Run the command."""
    from ..atomic import write_text
    from ..benchmarks import example_times
    from ..benchmarks import growth
    from ..benchmarks import kernel_ratio

    figures = {}
    print("The paper's examples, solve only")
    print("example        vertices  steps      ours [s]   paper [s]   faster by   us per vertex and step")
    figures["examples"] = example_times()
    for row in figures["examples"]:
        print(
            f"{row['example']:<14} {row['vertices']:8d} {row['steps']:6d}  {row['seconds']:12.4f}  {row['paper_seconds']:10.1f}"
            f"  {row['times_faster']:10.0f}  {row['microseconds_per_vertex_and_step']:8.2f}"
        )
    print("\nGrowth of the flow: Example 2 on finer grids, a filter radius of five edges")
    print("vertices   us per vertex and step")
    figures["growth"] = growth()
    for row in figures["growth"]:
        print(f"{row['vertices']:8d}   {row['microseconds_per_vertex_and_step']:8.2f}")
    print(f"time of a step grows as vertices to the power {figures['growth'][0]['exponent']:.2f}")
    print("\nCurvature kernel against libigl (angle defects and mixed areas)")
    try:
        figures["kernel"] = kernel_ratio()
    except ImportError:
        print("left out: libigl is not installed")
    else:
        print("vertices        ours [s]      libigl [s]   ratio")
        for row in figures["kernel"]:
            print(f"{row['vertices']:8d}  {row['seconds']:14.6f}  {row['libigl_seconds']:14.6f}   {row['ratio']:5.2f}")
    if arguments.json:
        write_text(arguments.json, json.dumps(figures, indent=1) + "\n")
    return DONE
