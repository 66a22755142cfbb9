"""Output of a run: mesh, pictures and record."""

from __future__ import annotations

import json
from collections.abc import Sequence
from pathlib import Path
from typing import Union

import numpy as np

from ..._atomic_write import write_text
from ...io import write
from ...model.roles import DUMMY
from ...plot import Curve
from ...plot import Shape
from ...plot import comparison_figure
from ...plot import curve_figure
from ...plot import error_figure
from ...plot import history_figure
from ...plot import save
from ...plot import shape_figure
from ...solvers.flow import CurveResult
from .run import CurveRun
from .run import SurfaceRun

__all__ = ["write_run"]


def write_run(run: Union[CurveRun, SurfaceRun], directory: Union[str, Path], pictures: bool = True) -> list[Path]:
    """Write the files of a run and return their paths.

    Parameters
    ----------
    run
        Run of an example.
    directory
        Output folder, created if missing.
    pictures
        Whether to draw pictures, which requires the extra ``plot``.

    Returns
    -------
    list of Path
        Paths of the files.

    Examples
    --------
    >>> write_run(run_example(CATALOGUE[0]), "out")  # doctest: +SKIP
    """
    directory = Path(directory)
    directory.mkdir(parents=True, exist_ok=True)
    name = run.example.name
    record = directory / f"{name}_record.json"
    write_text(record, json.dumps(run.record(), indent=1, ensure_ascii=False, allow_nan=False) + "\n")
    paths = [record]
    if isinstance(run, SurfaceRun):
        for suffix in (".3dm", ".obj", ".json"):
            paths.append(directory / f"{name}{suffix}")
            write(paths[-1], run.result)
    if pictures:
        figures = _curve_figures(run) if isinstance(run, CurveRun) else _surface_figures(run)
        for kind, figure in figures.items():
            paths.append(directory / f"{name}_{kind}.png")
            save(figure, paths[-1])
    return paths


def comparison_figures(runs: Sequence[Union[CurveRun, SurfaceRun]], directory: Union[str, Path]) -> list[Path]:
    """Draw the comparison figures of the paper (4 to 6, 18 and 28) and return their paths.

    Parameters
    ----------
    runs
        Runs of examples.
    directory
        Output folder.

    Returns
    -------
    list of Path
        Paths of the pictures.

    Examples
    --------
    >>> comparison_figures([run_example(example) for example in CATALOGUE], "out")  # doctest: +SKIP
    """
    plane = {run.example.name: run for run in runs if isinstance(run, CurveRun)}
    surfaces = {run.example.name: run for run in runs if isinstance(run, SurfaceRun)}
    figures = {}
    for kind, early in (("c1", False), ("c2", False), ("c2", True)):
        variants = [plane[f"example1_{kind}{letter}"] for letter in "abc"]
        curves = [_curve(run, run.early if early else run.result, run.example.title) for run in variants]
        figures[f"example1_{kind}_step3" if early else f"example1_{kind}"] = curve_figure(curves)
    for number, letters in ((4, "abcd"), (7, "ab")):
        chosen = [surfaces[f"example{number}_{letter}"] for letter in letters]
        figures[f"example{number}_comparison"] = comparison_figure([_shapes(run)[1]._replace(title=run.example.title) for run in chosen])
    paths = []
    for name, figure in figures.items():
        paths.append(Path(directory) / f"{name}.png")
        save(figure, paths[-1])
    return paths


def _curve(run: CurveRun, result: CurveResult, title: str) -> Curve:
    breaks = () if run.options["crease"] is None else (run.options["crease"],)
    return Curve(title, result.points, result.gradient, breaks=breaks)


def _curve_figures(run: CurveRun) -> dict:
    title = run.example.title
    return {
        "shape": curve_figure([_curve(run, run.result, title)]),
        "step3": curve_figure([_curve(run, run.early, f"{title}, step 3")]),
    }


def _shapes(run: SurfaceRun) -> list[Shape]:
    """Return the initial and the final shape."""
    problem = run.problem
    index = {key: i for i, key in enumerate(run.mesh.vertices())}
    creases = np.array([[index[u], index[v]] for u, v in run.mesh.crease_edges()], dtype=np.int64).reshape(-1, 2)
    return [
        Shape(title, vertices, problem.faces, problem.roles, creases, run.errors(vertices))
        for title, vertices in (("initial", problem.vertices), (_caption(run), run.final_vertices()))
    ]


def _surface_figures(run: SurfaceRun) -> dict:
    shapes = _shapes(run)
    figures = {"shape": shape_figure(shapes)}
    if len(run.result.history.energy):
        figures["history"] = history_figure(run.result.history)
    if run.example.error_map:
        figures["error"] = error_figure([_without_dummies(shape) for shape in shapes])
    return figures


def _caption(run: SurfaceRun) -> str:
    if run.before_divergence is not None:
        return f"step {run.before_divergence.step}, before it diverges"
    return f"step {run.result.iterations}"


def _without_dummies(shape: Shape) -> Shape:
    real = ~(np.asarray(shape.roles) == DUMMY)[shape.faces].any(axis=1)
    return shape._replace(faces=np.asarray(shape.faces)[real])
