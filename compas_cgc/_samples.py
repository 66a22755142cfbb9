"""Sample drawings included in the package, in the manner of ``compas.get``."""

from __future__ import annotations

from pathlib import Path

from . import DATA
from .errors import FileError
from .errors import names_what_was_meant

__all__ = ["get", "no_file", "samples"]

_FOLDER = Path(DATA)


@names_what_was_meant()
def samples() -> list[str]:
    """Return the names of the sample drawings in the package.

    Returns
    -------
    list of str
        File names for :func:`get`.

    Examples
    --------
    >>> "nine_regions.3dm" in samples()
    True
    """
    return sorted(path.name for path in _FOLDER.iterdir() if path.suffix == ".3dm")


@names_what_was_meant()
def get(name: str) -> str:
    """Return the path of a sample drawing in the package.

    Parameters
    ----------
    name
        File name of the drawing, such as ``"nine_regions.3dm"``; see :func:`samples`.

    Returns
    -------
    str
        The path, for :func:`compas_cgc.read` and for the command line.

    Raises
    ------
    FileError
        If the drawing does not exist; the message lists all drawings.

    Examples
    --------
    >>> import compas_cgc
    >>> mesh = compas_cgc.read(compas_cgc.get("nine_regions.3dm"))
    >>> len(mesh.regions())
    9
    """
    if name not in samples():
        raise FileError(f"there is no sample {name!r}; the samples are {', '.join(samples())}")
    return str(_FOLDER / name)


def no_file(path: object) -> str:
    """Return the message on a missing file, with a hint if it is a sample drawing of the manual."""
    name = Path(str(path)).name
    mend = f"copy the sample drawing {name} from {get(name)}" if name in samples() else "check the name"
    return f"there is no file {path}; {mend}"
