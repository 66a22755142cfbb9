"""Study: the table and the surfaces of a finished or running study."""

from __future__ import annotations

from typing import Any
from typing import NamedTuple
from typing import Optional

from ...errors import CGCError
from ...io.rhino.rhinocommon import mesh_from_arrays
from ...study import Results
from ...study import pareto_front
from ..runtime.component_feedback import add_remark
from ..runtime.component_feedback import add_warning
from ..runtime.component_feedback import ask_for
from ..runtime.component_feedback import reports_errors
from ..runtime.component_feedback import set_message
from ..runtime.paths import file_path
from ..runtime.wire_mesh import WireMesh

__all__ = ["StudyOutputs", "study"]


class StudyOutputs(NamedTuple):
    """Outputs of the component."""

    mesh: Any
    cgc_mesh: Any
    row: Optional[list[str]]
    columns: Optional[list[str]]
    values: Optional[list[Any]]
    front: Optional[list[int]]


@reports_errors(StudyOutputs)
def study(component: Any, path: Optional[str], number: Optional[int], column: Optional[str]) -> StudyOutputs:
    """Show a variant of a study with its row, a column of all variants, and the Pareto-optimal variants."""
    if not path:
        ask_for(component, "the output folder of compas-cgc study")
        return StudyOutputs(*[None] * len(StudyOutputs._fields))
    results = Results(file_path(component, path))
    total = len(results.study.variants)
    if len(results) < total:
        add_remark(component, f"{len(results)} of {total} variants are solved so far")
    if not len(results):
        raise CGCError("the study has no finished variant yet; recompute later")
    number = int(number or 0)
    row = results.row(number)
    front = pareto_front(results).tolist() if results.study.pareto.columns else results.good().tolist()
    values = results.column(column.strip()) if column else None
    set_message(component, f"variant {number} of {len(results)}: {row['verdict'] or row['status']}")
    words = [f"{name}: {value:.6g}" if isinstance(value, float) else f"{name}: {value}" for name, value in row.items() if value is not None]
    if not results.has_surface(number):
        add_warning(component, f"variant {number} has no surface: {row['note']}")
        return StudyOutputs(None, None, words, results.columns, values, front)
    problem = results.problem(number)
    return StudyOutputs(mesh_from_arrays(problem.vertices, problem.faces), WireMesh(problem), words, results.columns, values, front)
