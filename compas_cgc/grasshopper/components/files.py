"""Read 3dm and Write 3dm: problems and results as Rhino files, in double precision."""

from __future__ import annotations

import tempfile
from pathlib import Path
from typing import Any
from typing import NamedTuple
from typing import Optional

from ...datastructures import CGCMesh
from ...errors import FileError
from ...io import read_mesh
from ...io import write as write_file
from ...io.rhino.rhinocommon import mesh_from_arrays
from ..runtime.component_feedback import add_remark
from ..runtime.component_feedback import ask_for
from ..runtime.component_feedback import reports_errors
from ..runtime.component_feedback import set_message
from ..runtime.paths import file_path
from ..runtime.wire_mesh import WireMesh

__all__ = ["Read3dmOutputs", "Write3dmOutputs", "read_3dm", "write_3dm"]


class Read3dmOutputs(NamedTuple):
    """Outputs of the component."""

    mesh: Any
    cgc_mesh: Any
    notes: Optional[list[str]]


class Write3dmOutputs(NamedTuple):
    """Outputs of the component."""

    written: Optional[str]


@reports_errors(Read3dmOutputs)
def read_3dm(component: Any, path: Optional[str], split: Optional[bool]) -> Read3dmOutputs:
    """Read a mesh with its supports, creases, targets and goals from a .3dm file or another mesh format."""
    if not path:
        ask_for(component, "the path of a file")
        return Read3dmOutputs(None, None, None)
    crease = "split" if split else "trace"
    mesh, notes = _read_text(path) if "\n" in path.strip() else read_mesh(file_path(component, path), crease=crease)
    for note in notes:
        add_remark(component, note)
    set_message(component, f"{mesh.number_of_vertices()} vertices, {len(mesh.regions())} regions")
    return Read3dmOutputs(mesh_from_arrays(*mesh.arrays()), WireMesh(mesh.to_problem()), notes)


def _read_text(text: str) -> tuple[CGCMesh, list[str]]:
    """Return the mesh in the text of an .obj file, such as from a panel."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "panel.obj"
        path.write_text(text, encoding="utf-8")
        try:
            return read_mesh(path)
        except FileError as error:
            raise FileError(str(error).replace(str(path), "the text")) from None


@reports_errors(Write3dmOutputs)
def write_3dm(component: Any, path: Optional[str], cgc_mesh: Any, write: Optional[bool]) -> Write3dmOutputs:
    """Write a mesh with its supports, creases, targets and goals if `write` is true."""
    if not path or cgc_mesh is None:
        ask_for(component, "the path of a file and a CGC mesh")
        return Write3dmOutputs(None)
    if not write:
        set_message(component, "set write to true")
        return Write3dmOutputs(None)
    written = file_path(component, path)
    write_file(written, cgc_mesh)
    set_message(component, "written")
    return Write3dmOutputs(written)
