"""Mesh files of uploads and downloads. The server opens only temporary files that it has written."""

from __future__ import annotations

import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING
from typing import Optional

from ...errors import FileError
from ...errors import MeshError
from ...io.formats import FORMATS
from ...io.formats import SUFFIXES
from ..errors import Unprocessable

if TYPE_CHECKING:
    from ...datastructures import SolveResult
    from ...io.reading import ReadProblem

__all__ = ["KINDS", "SURFACES", "file_bytes", "read_upload", "uploaded", "warm_up_io"]

SURFACES = {suffix[1:]: own.media_type for suffix, own in FORMATS.items() if own.surfaces}
KINDS = {suffix[1:]: FORMATS[suffix].media_type for suffix in SUFFIXES if FORMATS[suffix].media_type}


@contextmanager
def uploaded(kind: str, body: bytes) -> Iterator[Path]:
    """Write the bytes of a file of a kind to a path; errors of its readers are raised without this path.

    Raises
    ------
    Unprocessable
        If the file cannot be read.
    """
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / f"upload.{kind}"
        path.write_bytes(body)
        try:
            yield path
        except FileError as error:
            raise Unprocessable(str(error).replace(str(path), "the file").replace(path.name, "the file")) from None


def read_upload(kind: str, body: bytes, result: bool = False, edge_length: Optional[float] = None) -> ReadProblem:
    """Return the problem in the bytes of a file; with `result`, the result stored in a .3dm file.

    Curves and surfaces in a .3dm file are meshed with the given edge length [L].

    Raises
    ------
    Unprocessable
        If the file cannot be read.
    """
    from ...io import read_problem

    with uploaded(kind, body) as path:
        return read_problem(path, result=result, edge_length=edge_length)


def file_bytes(kind: str, result: SolveResult, source: Optional[bytes] = None) -> bytes:
    """Return a result as the bytes of a .3dm, .obj or STEP file; a .3dm can be merged into the bytes of another.

    Raises
    ------
    Unprocessable
        If the source file cannot be read, or if smooth surfaces do not meet their tolerances.
    """
    from ...io import write

    with tempfile.TemporaryDirectory() as folder:
        path, drawing = Path(folder) / f"result.{kind}", Path(folder) / f"source.{kind}"
        if source is not None:
            drawing.write_bytes(source)
        try:
            write(path, result, source=drawing if source is not None else None)
        except (FileError, MeshError) as error:
            raise Unprocessable(str(error).replace(str(drawing), "the file")) from None
        return path.read_bytes()


def warm_up_io() -> None:
    """Import the modules for files, so that the first request is not delayed."""
    from ... import io  # noqa: F401
    from ...datastructures import CGCMesh  # noqa: F401
    from ...io import rhino  # noqa: F401
