"""Plans: curves and points of a drawing, from a DXF or .3dm file."""

from __future__ import annotations

import os
from collections.abc import Iterable
from pathlib import Path
from typing import Optional
from typing import Union

from ...errors import FileError
from ...errors import names_what_was_meant
from .plan import Plan

__all__ = ["read_plan"]


@names_what_was_meant()
def read_plan(path: Union[str, os.PathLike], *, layers: Optional[Iterable[str]] = None, join: Optional[float] = None) -> Plan:
    """Read the curves and points of a drawing.

    Parameters
    ----------
    path
        A .dxf or .3dm file.
    layers
        Names of the layers to read, capitals do not matter. Default: all visible ones.
    join
        Distance within which ends of curves are joined [L]. Default: small gaps are closed.

    Returns
    -------
    Plan
        Curves, points, faces, layers, unit and notes on what was done and left out.

    Raises
    ------
    FileError
        If the file cannot be read, or a layer does not exist.

    Examples
    --------
    >>> import compas_cgc
    >>> plan = read_plan(compas_cgc.get("vault.3dm"))
    >>> plan.unit
    'Meters'
    """
    suffix = Path(path).suffix.lower()
    if suffix == ".dxf":
        from .dxf import read_dxf_plan

        return read_dxf_plan(Path(path), layers, join)
    if suffix == ".3dm":
        from .rhino import read_3dm_plan

        return read_3dm_plan(Path(path), layers, join)
    raise FileError(f"{path}: plans are read from .dxf and .3dm files")
