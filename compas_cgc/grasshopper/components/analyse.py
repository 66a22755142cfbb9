"""Analyse: curvatures at the vertices, and their colours."""

from __future__ import annotations

import time
from dataclasses import dataclass
from typing import Any
from typing import NamedTuple
from typing import Optional

import numpy as np

from ...io.rhino.rhinocommon import mesh_from_arrays
from ...scene.figures import FIGURES
from ..runtime.background import BackgroundTask
from ..runtime.colour_legend import check_figure
from ..runtime.colour_legend import figure_colours
from ..runtime.component_feedback import add_warning
from ..runtime.component_feedback import poll
from ..runtime.component_feedback import reports_errors
from ..runtime.component_feedback import set_message
from ..runtime.headless import is_headless
from ..runtime.measured import Measured
from ..runtime.measured import known_measures
from ..runtime.measured import measure
from ..runtime.memories import Memories
from ..runtime.widgets import offer_values

__all__ = ["AnalyseOutputs", "analyse"]

POLL_INTERVAL = 200  # [ms]
MAX_WAIT = 2.0  # longest time that the canvas waits for a measurement [s]
CHECK_INTERVAL = 0.01  # time between two checks for running compilation, which the canvas does not wait for [s]


class AnalyseOutputs(NamedTuple):
    """Outputs of the component."""

    mesh: Any = None
    K: Optional[list] = None
    H: Optional[list] = None
    k_max: Optional[list] = None
    k_min: Optional[list] = None
    error: Optional[list] = None
    colours: Optional[list] = None
    legend: Optional[list[str]] = None
    report: Optional[str] = None


@dataclass
class Memory:
    """State of a component between two runs."""

    mesh: Any
    task: BackgroundTask[Measured]

    def end(self) -> None:
        """Cancel the measurement."""
        self.task.cancel()


_MEMORIES: Memories[Memory] = Memories(Memory.end)


@reports_errors(AnalyseOutputs)
def analyse(component: Any, cgc_mesh: Any, show: Optional[str], aside: Optional[float]) -> AnalyseOutputs:
    """Measure a mesh; vertices without a value (on edges and creases) are null items in the lists."""
    offer_values(component, "show", FIGURES)
    if cgc_mesh is None:
        add_warning(component, "connect a CGC mesh")
        return AnalyseOutputs()
    show = show.strip() if show else FIGURES[0]
    check_figure(show)
    found = known_measures(cgc_mesh) or _measured(component, cgc_mesh)
    if found is None:
        return AnalyseOutputs()
    seen = figure_colours(found.figures, show)
    problem = cgc_mesh.to_problem().without_dummies()
    set_message(component, f"{show}: largest {seen.limit:.3g}")
    columns = {name: [None if np.isnan(x) else x for x in column.tolist()] for name, column in found.figures.items()}
    return AnalyseOutputs(
        mesh=mesh_from_arrays(problem.vertices + [aside or 0.0, 0.0, 0.0], problem.faces, seen.vertices),
        **columns,
        colours=seen.colours,
        legend=seen.legend,
        report=str(found.report),
    )


def _measured(component: Any, mesh: Any) -> Optional[Measured]:
    """Return the measurement, or None if it takes long or is being compiled; the component then runs again when it is available."""
    memory = _MEMORIES.of(component)
    if memory is None or memory.mesh is not mesh:
        _MEMORIES.drop(component)
        memory = _MEMORIES.keep(component, Memory(mesh, BackgroundTask(measure(mesh))))
        if is_headless(component):
            memory.task.wait(None)
        end = time.monotonic() + MAX_WAIT
        while memory.task.running and memory.task.progress.compiling is None and time.monotonic() < end:
            memory.task.wait(CHECK_INTERVAL)
    task = memory.task
    if not task.running:
        _MEMORIES.drop(component)
        if task.error is not None:
            raise task.error
        return task.result
    set_message(component, task.progress.measuring())

    def is_over() -> bool:
        set_message(component, task.progress.measuring())
        return not task.running

    poll(component, POLL_INTERVAL, is_over, lambda: _MEMORIES.drop_all(component))
    return None
