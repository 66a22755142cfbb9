"""Lazy import of matplotlib, and figures as PNG, SVG and PDF files."""

from __future__ import annotations

import os
from collections.abc import Iterable
from importlib import import_module
from io import BytesIO
from pathlib import Path
from threading import Lock
from types import ModuleType
from typing import TYPE_CHECKING
from typing import Union

from ._atomic_write import replacing
from .errors import CGCError
from .errors import FileError
from .errors import names_what_was_meant

if TYPE_CHECKING:
    from matplotlib.figure import Figure

__all__ = ["check_picture", "matplotlib_module", "new_figure", "save", "save_pages"]

DPI = 200
FORMATS = {
    ".png": {"Software": None},
    ".svg": {"Date": None, "Creator": None},
    ".pdf": {"CreationDate": None, "Creator": None, "Producer": None},
}

DETERMINISTIC = {"svg.hashsalt": "compas_cgc", "svg.fonttype": "path"}

# The settings of matplotlib are global, and a server saves from several threads.
_settings = Lock()


def matplotlib_module(name: str) -> ModuleType:
    """Import a module of matplotlib.

    Parameters
    ----------
    name
        Name below ``matplotlib``, such as ``"figure"``.

    Raises
    ------
    CGCError
        If matplotlib is not installed.
    """
    try:
        return import_module(f"matplotlib.{name}")
    except ImportError as error:
        raise CGCError('drawing requires matplotlib: pip install "compas_cgc[plot]"') from error


def new_figure(width: float, height: float) -> Figure:
    """Return an empty white figure of a size in inches, independent of pyplot."""
    return matplotlib_module("figure").Figure(figsize=(width, height), dpi=DPI, facecolor="white")


@names_what_was_meant()
def save(figure: Figure, path: Union[str, os.PathLike]) -> Path:
    """Write a figure as PNG, SVG or PDF, by the suffix of the path.

    The file is written atomically and without a date, so that the same figure gives the same
    bytes.

    Parameters
    ----------
    figure
        Figure from a ``..._figure`` function, or the ``figure`` of axes.
    path
        Output file with a suffix in :data:`FORMATS`; an existing file is replaced.

    Returns
    -------
    pathlib.Path
        The path.

    Raises
    ------
    FileError
        If the suffix is not supported, or the file cannot be written.

    Examples
    --------
    >>> import compas_cgc, os, tempfile
    >>> from compas_cgc.plot import curve_figure
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     print(save(curve_figure([("a line", [[0.0, 0], [1, 1]])]), os.path.join(folder, "line.svg")).name)
    line.svg
    """
    path = Path(path)
    kind = _kind_of(path)
    drawn = BytesIO()
    with _settings, import_module("matplotlib").rc_context(DETERMINISTIC):
        figure.savefig(drawn, format=kind[1:], dpi=figure.dpi, metadata=FORMATS[kind], facecolor="white")
    return _written(drawn, path)


def save_pages(figures: Iterable[Figure], path: Union[str, os.PathLike]) -> Path:
    """Write figures as the pages of a PDF, without a date, so that the same figures give the same bytes.

    Raises
    ------
    FileError
        If the suffix is not .pdf, or the file cannot be written.
    """
    path = Path(path)
    if path.suffix.lower() != ".pdf":
        raise FileError(f"drawings with several pages need the suffix .pdf, not that of {path.name!r}")
    pages = matplotlib_module("backends.backend_pdf")
    drawn = BytesIO()
    with _settings, import_module("matplotlib").rc_context(DETERMINISTIC):
        with pages.PdfPages(drawn, metadata=FORMATS[".pdf"]) as written:
            for figure in figures:
                written.savefig(figure, facecolor="white")
    return _written(drawn, path)


def _written(drawn: BytesIO, path: Path) -> Path:
    # Writers of pictures hide the error of a full disk behind others of their own.
    with replacing(path) as beside:
        beside.write_bytes(drawn.getvalue())
    return path


def check_picture(path: Union[str, os.PathLike]) -> None:
    """Check that a picture can be written, before its content is computed."""
    _kind_of(Path(path))
    matplotlib_module("figure")


def _kind_of(path: Path) -> str:
    kind = path.suffix.lower()
    if kind not in FORMATS:
        raise FileError(f"the suffix of a picture must be one of {', '.join(FORMATS)}, not that of {path.name!r}")
    return kind
