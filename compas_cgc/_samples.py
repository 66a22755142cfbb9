"""Sample data: drawings that come with the package, by name, as ``compas.get`` has them."""

from __future__ import annotations

from pathlib import Path

from .errors import FileError

__all__ = ["get", "samples"]

_FOLDER = Path(__file__).parent / "_sample_files"


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
