"""Sample data: drawings that come with the package, by name, as ``compas.get`` has them."""

from __future__ import annotations

from pathlib import Path

from .errors import FileError
from .errors import names_what_was_meant

__all__ = ["get", "no_file", "samples"]

_FOLDER = Path(__file__).parent / "_sample_files"


@names_what_was_meant()
def samples() -> list[str]:
    """Return the names of the drawings that come with the package.

    Returns
    -------
    list of str
        File names, each of which :func:`get` takes.

    Examples
    --------
    >>> "nine_regions.3dm" in samples()
    True
    """
    return sorted(path.name for path in _FOLDER.iterdir() if path.suffix == ".3dm")


@names_what_was_meant()
def get(name: str) -> str:
    """Return the path of a drawing that comes with the package.

    Parameters
    ----------
    name
        Its file name, such as ``"nine_regions.3dm"``; see :func:`samples`.

    Returns
    -------
    str
        The path, for :func:`compas_cgc.read` and for the command line.

    Raises
    ------
    FileError
        If there is no such drawing; the sentence names those that there are.

    Examples
    --------
    >>> import compas_cgc
    >>> mesh = compas_cgc.read(compas_cgc.get("nine_regions.3dm"))
    >>> len(mesh.regions())
    9
    """
    if name not in samples():
        raise FileError(f"there is no sample {name!r}; there are {', '.join(samples())}")
    return str(_FOLDER / name)


def no_file(path: object) -> str:
    """Return the sentence on a file that is not there, which may be a drawing of the manual that was not copied yet."""
    name = Path(str(path)).name
    mend = f"the drawing {name} of the manual is {get(name)}, copy it" if name in samples() else "check the name"
    return f"there is no file {path}; {mend}"
