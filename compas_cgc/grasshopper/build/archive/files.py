"""Reading and writing of Grasshopper files by suffix."""

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
        Path of the file.

    Returns
    -------
    Chunk
        The root.

    Raises
    ------
    FileError
        If the file cannot be read.

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
    """Write a .gh, .ghx or .ghuser file, atomically.

    Parameters
    ----------
    path
        Path of the file; an existing file is replaced when the new one is complete.
    root
        Root chunk of the file.

    Raises
    ------
    FileError
        If the suffix is not supported, or a string cannot be written in XML.

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
        raise FileError(f"{path}: the suffix of a Grasshopper file must be one of {', '.join(_FORMS)}, not {suffix or 'empty'!r}")
    return _FORMS[suffix]
