"""Read 3dm and Write 3dm: problems and results as Rhino files, in double precision."""

from __future__ import annotations

from typing import Any
from typing import NamedTuple
from typing import Optional

from ...io import read_mesh
from ...io import write_mesh
from ...io.rhino.rhinocommon import mesh_from_arrays
from ..runtime.component_feedback import remark
from ..runtime.component_feedback import reporting
from ..runtime.component_feedback import say
from ..runtime.component_feedback import warn

__all__ = ["Read3dmOutputs", "Write3dmOutputs", "read_3dm", "write_3dm"]


class Read3dmOutputs(NamedTuple):
    """Outputs of the component."""

    mesh: Any
    cgc_mesh: Any
    notes: Optional[list[str]]


class Write3dmOutputs(NamedTuple):
    """Outputs of the component."""

    written: Optional[str]


@reporting(Read3dmOutputs)
def read_3dm(component: Any, path: Optional[str], split: Optional[bool]) -> Read3dmOutputs:
    """Read a mesh with its supports, creases and targets; other mesh formats are read too."""
    if not path:
        warn(component, "connect the path of a file")
        return Read3dmOutputs(None, None, None)
    mesh, notes = read_mesh(path.strip(), crease="split" if split else "trace")
    for note in notes:
        remark(component, note)
    say(component, f"{mesh.number_of_vertices()} vertices, {len(mesh.regions())} regions")
    return Read3dmOutputs(mesh_from_arrays(*mesh.arrays()), mesh, notes)


@reporting(Write3dmOutputs)
def write_3dm(component: Any, path: Optional[str], cgc_mesh: Any, write: Optional[bool]) -> Write3dmOutputs:
    """Write a mesh with its supports, creases and targets when it is told to."""
    if not path or cgc_mesh is None:
        warn(component, "connect the path of a file and a CGC mesh")
        return Write3dmOutputs(None)
    if not write:
        say(component, "set write to true")
        return Write3dmOutputs(None)
    write_mesh(path.strip(), cgc_mesh)
    say(component, "written")
    return Write3dmOutputs(path.strip())
