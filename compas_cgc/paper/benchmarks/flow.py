"""Benchmark of the flow: examples of the paper, and growth of the cost with mesh size."""

from __future__ import annotations

from dataclasses import replace
from functools import partial

import numpy as np

from ...model.problem import CGCProblem
from ...solvers.flow import FlowSettings
from ...solvers.flow import flow
from ..examples import CATALOGUE
from ..examples import SurfaceExample
from ..examples.grids import grid_with_ring
from .timing import best_of

__all__ = ["example_times", "growth"]


def example_times() -> list[dict]:
    """Return the run times [s] of the examples timed in the paper, with the published times.

    Returns
    -------
    list of dict
        Results by name, one dict per example.

    Examples
    --------
    >>> example_times()[0]["times_faster"]  # doctest: +SKIP
    """
    rows = []
    for example in CATALOGUE:
        if not isinstance(example, SurfaceExample) or example.paper_seconds is None:
            continue
        mesh, settings = example.build()
        problem = CGCProblem.from_mesh(mesh)
        seconds = best_of(partial(flow, problem, settings=settings), budget=0.5)
        rows.append(
            {
                "example": example.name,
                "vertices": len(problem.vertices),
                "steps": settings.steps,
                "seconds": seconds,
                "paper_seconds": example.paper_seconds,
                "times_faster": example.paper_seconds / seconds,
                "microseconds_per_vertex_and_step": 1e6 * seconds / len(problem.vertices) / settings.steps,
            }
        )
    return rows


def growth(sizes: tuple[int, ...] = (9, 18, 36, 72, 97)) -> list[dict]:
    """Return the time per vertex and step of Example 2 on finer grids, with a radius of five edges throughout.

    Parameters
    ----------
    sizes
        Number of squares per side.

    Returns
    -------
    list of dict
        Results by name, one dict per size.

    Examples
    --------
    >>> growth((9, 18))[0]["exponent"]  # doctest: +SKIP
    """
    rows = []
    for n in sizes:
        cell = 0.9 / n
        mesh = grid_with_ring(n, cell)
        mesh.set_supports("boundary")
        mesh.set_target(1.0)
        problem = CGCProblem.from_mesh(mesh)
        # μ0 scales with the square of the radius, for the stability of an explicit step.
        settings = FlowSettings(steps=100, tolerance=0.0, mu0=0.1 * (9 / n) ** 2, filter_radius=5 * cell)
        # The difference of two run lengths excludes loading and the first neighbour lists.
        long = best_of(partial(flow, problem, settings=settings), budget=0.5)
        short = best_of(partial(flow, problem, settings=replace(settings, steps=10)), budget=0.2)
        per_step = (long - short) / 90
        rows.append({"vertices": len(problem.vertices), "microseconds_per_vertex_and_step": 1e6 * per_step / len(problem.vertices)})
    exponent = np.polyfit(
        np.log([row["vertices"] for row in rows]),
        np.log([row["microseconds_per_vertex_and_step"] * row["vertices"] for row in rows]),
        1,
    )[0]
    for row in rows:
        row["exponent"] = float(exponent)
    return rows
