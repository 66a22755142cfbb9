"""Meshes in files: of uploads, and for downloads. Only files of the server's own making are opened."""

from __future__ import annotations

import tempfile
from pathlib import Path
from typing import TYPE_CHECKING
from typing import Optional

from ...errors import FileError
from ..errors import Unprocessable

if TYPE_CHECKING:
    from ...datastructures import CGCMesh
    from ...model.result import SolveResult

__all__ = ["KINDS", "file_bytes", "read_upload"]

KINDS = {"3dm": "model/vnd.3dm", "obj": "model/obj"}


def read_upload(kind: str, body: bytes) -> tuple[CGCMesh, list[str]]:
    """Return the mesh in the bytes of a file with all that the file says, and notes on it.

    Raises
    ------
    Unprocessable
        If it is no such file.
    """
    from ...io import read_mesh

    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / f"upload.{kind}"
        path.write_bytes(body)
        try:
            return read_mesh(path)
        except FileError as error:
            raise Unprocessable(str(error).replace(str(path), "the file")) from None


def file_bytes(kind: str, result: SolveResult, source: Optional[bytes] = None) -> bytes:
    """Return a result as the bytes of a .3dm or .obj file, a .3dm beside what is in the bytes of another.

    Raises
    ------
    Unprocessable
        If the source is no such file.
    """
    from ...io import write_mesh

    with tempfile.TemporaryDirectory() as folder:
        path, beside = Path(folder) / f"result.{kind}", Path(folder) / f"source.{kind}"
        if source is not None:
            beside.write_bytes(source)
        try:
            write_mesh(path, result.mesh, result=result, source=beside if source is not None else None)
        except FileError as error:
            raise Unprocessable(str(error).replace(str(beside), "the file")) from None
        return path.read_bytes()
