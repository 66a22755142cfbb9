"""Grasshopper files by their suffix."""

from __future__ import annotations

import os
from pathlib import Path
from typing import Union

from ...._atomic_write import replacing
from ....errors import FileError
from .binary import from_bytes
from .binary import to_bytes
from .tree import Chunk
from .xml import from_xml
from .xml import to_xml

__all__ = ["read_archive", "write_archive"]

_FORMS = {".gh": (from_bytes, to_bytes), ".ghuser": (from_bytes, to_bytes), ".ghx": (from_xml, to_xml)}


def read_archive(path: Union[str, os.PathLike]) -> Chunk:
    """Read a .gh, .ghx or .ghuser file.

    Parameters
    ----------
    path
        Of the file.

    Returns
    -------
    Chunk
        The root.

    Raises
    ------
    FileError
        If it cannot be read.

    Examples
    --------
    >>> import os, tempfile
    >>> from compas_cgc.grasshopper.build.archive import chunk, write_archive
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     write_archive(os.path.join(folder, "a.gh"), chunk("Root"))
    ...     print(read_archive(os.path.join(folder, "a.gh")).name)
    Root
    """
    read, _ = _form(Path(path))
    try:
        return read(Path(path).read_bytes())
    except (OSError, FileError) as error:
        raise FileError(f"{path}: {error}") from None


def write_archive(path: Union[str, os.PathLike], root: Chunk) -> None:
    """Write a .gh, .ghx or .ghuser file, whole or not at all.

    Parameters
    ----------
    path
        Of the file, which is replaced when the new one is complete.
    root
        What it shall hold.

    Raises
    ------
    FileError
        If the suffix is another, or a text cannot be written in XML.

    Examples
    --------
    >>> import os, tempfile
    >>> from compas_cgc.grasshopper.build.archive import chunk
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     write_archive(os.path.join(folder, "a.ghx"), chunk("Root"))
    ...     print(os.listdir(folder))
    ['a.ghx']
    """
    _, write = _form(Path(path))
    data = write(root)
    with replacing(Path(path)) as temporary:
        temporary.write_bytes(data)


def _form(path: Path) -> tuple:
    suffix = path.suffix.lower()
    if suffix not in _FORMS:
        raise FileError(f"{path}: files of Grasshopper end in {', '.join(_FORMS)}, not in {suffix or 'nothing'!r}")
    return _FORMS[suffix]
