"""Read the plan in a .3dm file: its visible curves and points."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable
from pathlib import Path
from typing import Optional

import numpy as np

from ...errors import FileError
from ..rhino.archive import list_items
from ..rhino.archive import read_archive
from ..rhino.curves import to_drawn
from ..rhino.units import north_of
from ..rhino.units import unit_name
from .joining import joined
from .plan import Layer
from .plan import Plan
from .plan import PlanCurve

__all__ = ["read_3dm_plan"]

DRAWN = ("curve", "point", "point cloud")


def read_3dm_plan(path: Path, layers: Optional[Iterable[str]] = None, join: Optional[float] = None) -> Plan:
    """Read the curves and points in a .3dm file.

    Parameters
    ----------
    path
        The file.
    layers
        Full names of the layers to read, capitals do not matter. Default: all visible ones.
    join
        Distance within which ends of curves are joined [L]. Default: small gaps are closed.

    Raises
    ------
    FileError
        If the file cannot be read, or a layer holds nothing.
    """
    archive = read_archive(path)
    items = list_items(archive)
    wanted = None if layers is None else {name.casefold() for name in layers}
    missing = (wanted or set()) - {item.layer.casefold() for item in items}
    if missing:
        raise FileError(
            f"{path}: there are no objects on a layer {min(missing)!r}; the layers are {', '.join(sorted({item.layer for item in items}))}"
        )
    read = [item for item in items if (not item.hidden if wanted is None else item.layer.casefold() in wanted)]
    fine = 0.25 * float(archive.Settings.ModelAbsoluteTolerance)
    drawn = [(item.layer, to_drawn(item, fine)) for item in read if item.kind in DRAWN]
    curves = [PlanCurve(one.points, layer) for layer, one in drawn if one.kind == "curve" and len(one.points) > 1]
    points = [one.points for _, one in drawn if one.kind != "curve"]
    made = joined(curves, join)
    omitted = Counter(item.kind for item in read if item.kind not in DRAWN)
    notes = [
        *made.notes,
        *([f"left out: {', '.join(f'{count} of kind {kind}' for kind, count in sorted(omitted.items()))}"] if omitted else []),
    ]
    hidden = len(items) - len(read)
    notes += [f"left out: {hidden} objects that are {'hidden' if wanted is None else 'on other layers'}"] if hidden else []
    listed = [
        Layer(name, count, any(item.layer == name and not item.hidden for item in items), any(item.layer == name for item in read))
        for name, count in sorted(Counter(item.layer for item in items).items())
    ]
    return Plan(
        made.curves,
        np.concatenate([np.empty((0, 3)), *points]),
        [],
        listed,
        unit_name(archive.Settings.ModelUnitSystem),
        made.tolerance,
        notes,
        north_of(archive),
    )
