"""Mesh a plan: outline, holes, creases and columns become a problem."""

from __future__ import annotations

from collections.abc import Collection
from collections.abc import Iterable
from collections.abc import Mapping
from pathlib import Path
from typing import Optional

import numpy as np

from ...errors import FileError
from ...errors import MeshError
from ...meshing.cleanup import Omission
from ...model.lengths import unit_suffix
from ...model.units import GivenLength
from ...model.units import within
from ..reading import ReadProblem
from ..rhino.assemble import assemble
from ..rhino.outlines import outlined
from ..rhino.sketch import Drawn
from ..rhino.sketch import Part
from .dxf import read_dxf_plan
from .plan import Plan
from .plan import left_outside
from .plan import roles
from .plan import size

__all__ = ["problem_of_plan", "read_dxf"]


def read_dxf(
    path: Path,
    layers: Optional[Mapping[str, object]] = None,
    crease: str = "trace",
    tolerance: Optional[GivenLength] = None,
    edge_length: Optional[GivenLength] = None,
) -> ReadProblem:
    """Read a problem from the drawing in a DXF file.

    Parameters
    ----------
    path
        The file, text or binary.
    layers
        Names of the layers to read by role: curves on the layers of ``creases`` are creases even if they are closed, those of
        ``mesh`` are outline, holes and, if they are open, creases, and points are supports. Default: all visible layers.
    crease
        ``"trace"`` or ``"split"``, for creases on the faces of the file.
    tolerance
        Distance within which ends of curves are joined [L]. Default: small gaps are closed.
    edge_length
        Edge length of the mesh inside the outline [L]; not needed if the file holds faces.

    Raises
    ------
    FileError
        If the file cannot be read, or holds neither faces nor a closed curve.
    """
    names = None if not layers else [name for value in layers.values() for name in _names(value)]
    plan = read_dxf_plan(path, names, tolerance)
    creases = {name.casefold() for name in _names((layers or {}).get("creases", ()))}
    try:
        return problem_of_plan(plan, path.stem, within(edge_length, plan.unit), crease, creases)
    except (FileError, MeshError) as error:
        raise FileError(f"{path}: {error}") from None


def problem_of_plan(
    plan: Plan, name: str, edge_length: Optional[float], crease: str = "trace", folded: Collection[str] = ()
) -> ReadProblem:
    """Return the problem of a plan: its faces, or a mesh inside the outline; points are supports.

    Open curves, and all curves on the layers `folded` (in lower case), are creases.

    Raises
    ------
    FileError
        If the plan holds neither faces nor a closed curve, or the edge length is missing.
    """
    unit = unit_suffix(plan.unit)
    part = roles(plan, folded)
    labelled = [
        Drawn(f"the {role} on layer {curve.layer} at ({curve.points[0, 0]:.6g}, {curve.points[0, 1]:.6g})", "curve", curve.points, None, {})
        for role, curve in zip(part, plan.curves)
    ]
    creases = [drawn for role, drawn in zip(part, labelled) if role == "crease"]
    columns = [Drawn(f"the point ({x:.6g}, {y:.6g})", "point", np.array([[x, y, z]]), None, {}) for x, y, z in plan.points.tolist()]
    notes = list(plan.notes)
    outside = part.count("outside")
    if plan.meshes:
        parts = [Part(f"the faces on layer {mesh.layer}", mesh.vertices, mesh.faces, 0.0, None, {}) for mesh in plan.meshes]
        notes += [Omission(f"{len(part) - len(creases)} closed curves were ignored beside the faces")] if len(part) > len(creases) else []
    else:
        rings = [(drawn.label, drawn.points) for role, drawn in zip(part, labelled) if role in ("outline", "hole")]
        if not rings or "outline" not in part:
            raise FileError(f"there is no closed curve to mesh{_widest_gap(plan, unit)}")
        if edge_length is None:
            raise FileError("the drawing has only curves; give an edge length (--edge-length) to mesh the outline")
        try:
            made = outlined(rings, creases, plan.points, edge_length, plan.tolerance)
        except MeshError as error:
            raise FileError(str(error)) from None
        parts, creases = [made.part], made.creases
        notes += made.notes
        notes += [Omission(left_outside(outside))] if outside else []
    return assemble(
        name=name,
        parts=parts,
        supports=lambda fine: columns,
        creases=lambda fine: creases,
        targets=lambda fine: [],
        constraints=lambda fine: [],
        units=plan.unit,
        tolerance=plan.tolerance,
        crease=crease,
        notes=notes,
        north=plan.north,
    )


def _names(value: object) -> Iterable[str]:
    return [value] if isinstance(value, str) else value if isinstance(value, (list, tuple)) else [str(value)]


def _widest_gap(plan: Plan, unit: str) -> str:
    """Return a clause on the gap in the longest open curve."""
    if not plan.curves:
        return "; draw the outline of the roof as a closed curve in model space"
    longest = max(plan.curves, key=lambda curve: size([curve]))
    gap = float(np.linalg.norm(longest.points[0] - longest.points[-1]))
    x, y = longest.points[-1, :2]
    where = f"the longest curve has a gap of {gap:.3g}{unit} between start and end at ({x:.6g}, {y:.6g})"
    return f"; {where}: close it, or join ends within this distance (--weld)"
