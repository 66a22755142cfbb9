"""Example: input meshes of the paper."""

from __future__ import annotations

from typing import Any
from typing import NamedTuple
from typing import Optional

from ...errors import CGCError
from ...io.rhino.rhinocommon import mesh_from_arrays
from ...model.roles import FREE
from ...paper.examples import SurfaceExample
from ...paper.examples import examples_of
from ..runtime.component_feedback import reports_errors
from ..runtime.component_feedback import set_message
from ..runtime.wire_mesh import WireMesh

__all__ = ["ExampleOutputs", "example"]


class ExampleOutputs(NamedTuple):
    """Outputs of the component."""

    mesh: Any
    cgc_mesh: Any
    settings: Any
    title: Optional[str]


@reports_errors(ExampleOutputs)
def example(component: Any, number: Optional[int], variant: Optional[str]) -> ExampleOutputs:
    """Return the mesh and the settings of one of the Examples 2 to 7."""
    number = 4 if number is None else int(number)
    if not 2 <= number <= 7:
        raise CGCError(f"number must be from 2 to 7, not {number}; Example 1 concerns plane curves")
    chosen = examples_of(number, variant.strip() if variant else None)[0]
    assert isinstance(chosen, SurfaceExample)
    mesh, settings = chosen.build()
    problem = mesh.to_problem()
    real = problem.without_dummies()
    if not (real.roles == FREE).any():
        # Dummies outside supports have no effect on K; without them the default method recognises the supported boundary.
        problem = real
    set_message(component, chosen.name)
    return ExampleOutputs(mesh_from_arrays(real.vertices, real.faces), WireMesh(problem), settings, f"Example {number}: {chosen.title}")
