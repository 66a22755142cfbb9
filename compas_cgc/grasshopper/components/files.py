"""Read 3dm and Write 3dm: problems and results as Rhino files, in double precision."""

from __future__ import annotations

import tempfile
from pathlib import Path
from typing import Any
from typing import NamedTuple
from typing import Optional

from ..._atomic_write import published_together
from ...datastructures import CGCMesh
from ...errors import CGCError
from ...errors import FileError
from ...io import read_mesh
from ...io import write as write_file
from ...io.rhino.rhinocommon import mesh_from_arrays
from ..runtime.component_feedback import add_remark
from ..runtime.component_feedback import ask_for
from ..runtime.component_feedback import reports_errors
from ..runtime.component_feedback import set_message
from ..runtime.paths import file_path
from ..runtime.trees import branches_of
from ..runtime.trees import matched
from ..runtime.trees import tree_at
from ..runtime.wire_mesh import WireMesh

__all__ = ["Read3dmOutputs", "Write3dmOutputs", "read_3dm", "write_3dm"]


class Read3dmOutputs(NamedTuple):
    """Outputs of the component."""

    mesh: Any
    cgc_mesh: Any
    notes: Optional[list[str]]


class Write3dmOutputs(NamedTuple):
    """Outputs of the component."""

    written: Any = None


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


@reports_errors(Write3dmOutputs, trees=("path", "cgc_mesh"))
def write_3dm(component: Any, path: Any, cgc_mesh: Any, write: Optional[bool]) -> Write3dmOutputs:
    """Write all meshes of a data tree with their supports, creases, targets and goals if `write` is true, each to its path.

    Raises
    ------
    CGCError
        If several meshes have the same path, or one of the files cannot be written; nothing is written then.
    """
    matches = matched(branches_of(path), branches_of(cgc_mesh))
    rows = [row for match in matches for row in match.rows]
    if not any(all(row) for row in rows):
        ask_for(component, "the path of a file and a CGC mesh")
        return Write3dmOutputs()
    if not write:
        set_message(component, "set write to true")
        return Write3dmOutputs()
    written = [[file_path(component, text) if text and mesh is not None else None for text, mesh in match.rows] for match in matches]
    names = [name for branch in written for name in branch if name is not None]
    twice = next((name for name in names if names.count(name) > 1), None)
    if twice is not None:
        raise CGCError(f"{names.count(twice)} meshes have the path {twice}; connect one path for each mesh")
    with published_together():
        for match, branch in zip(matches, written):
            for (_, mesh), name in zip(match.rows, branch):
                if name is not None:
                    write_file(name, mesh)
    set_message(component, "written" if len(names) == 1 else f"{len(names)} files written")
    return Write3dmOutputs(tree_at((match.path, None, branch) for match, branch in zip(matches, written)))
