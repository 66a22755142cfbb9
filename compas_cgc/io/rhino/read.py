"""Reading of problems from .3dm files."""

from __future__ import annotations

import os
from collections.abc import Mapping
from pathlib import Path
from typing import Optional
from typing import Union

from ...discrete.arrays import FloatArray
from ...errors import FileError
from ...errors import names_what_was_meant
from ...model.lengths import unit_suffix
from ...model.units import GivenLength
from ...model.units import within
from ..reading import ReadProblem
from .archive import Item
from .archive import list_items
from .archive import read_archive
from .assemble import assemble
from .curves import EDGE_ACCURACY
from .curves import curve_points
from .curves import to_drawn
from .layers import LayerNames
from .layers import layer_names
from .layers import select
from .meshes import has_mesh
from .meshes import mesh_to_arrays
from .meshes import to_part
from .outlines import outline_part
from .sketch import Drawn
from .surfaces import MeshedSurface
from .surfaces import default_edge_length
from .surfaces import surface_part
from .units import north_of
from .units import unit_name
from .user_text import drawn_from
from .user_text import user_law
from .user_text import user_number

__all__ = ["read_3dm", "read_curves"]


@names_what_was_meant()
def read_3dm(
    path: Union[str, os.PathLike],
    *,
    layers: Optional[Mapping[str, object]] = None,
    crease: str = "trace",
    tolerance: Optional[GivenLength] = None,
    edge_length: Optional[GivenLength] = None,
    result: bool = False,
) -> ReadProblem:
    """Read a surface problem from a .3dm file.

    See ``docs/3dm.md`` for the layers. If the file has none of these layers, the first mesh is
    read, with points as supports and curves as creases.

    Parameters
    ----------
    path
        The .3dm file, from Rhino 2 or later.
    layers
        Names of layers by role, see :func:`compas_cgc.io.rhino.layer_names`.
    crease
        Treatment of creases that do not follow mesh edges: ``"trace"`` selects the best path
        of edges, ``"split"`` cuts the mesh along the crease.
    tolerance
        Distance below which points coincide [L]. Default: the tolerance of the file.
    edge_length
        Edge length for meshing surfaces or, if there are none, the area inside the outlines [L];
        requires the extra ``mesher``. Default for surfaces: use their render mesh, or else a
        thirtieth of their size.
    result
        Whether to read the result of an earlier solve, if the file holds one, instead of the drawing.

    Returns
    -------
    ReadProblem
        The problem. Objects that cannot be used are listed in ``diagnostics``; ``checked()`` raises them as an error.

    Raises
    ------
    FileError
        If the file cannot be read or holds no usable mesh.

    Examples
    --------
    >>> import compas_cgc
    >>> found = read_3dm(compas_cgc.get("nine_regions.3dm"))
    >>> len(found.problem.vertices), len(found.problem.supports)
    (256, 4)
    """
    names = layer_names(path, layers)
    archive = read_archive(path)
    found = select(list_items(archive), names, result)
    units = unit_name(archive.Settings.ModelUnitSystem)
    length, weld = within(edge_length, units), within(tolerance, units)
    own = float(archive.Settings.ModelAbsoluteTolerance) if weld is None else weld
    try:
        unit = unit_suffix(units)
        curves = [item for item in found.creases if item.kind == "curve"] if len(found.mesh) == 1 else []
        lines = [to_drawn(item, 0.25 * own, EDGE_ACCURACY) for item in curves]
        converted = [_converted(item, found.mesh, length, own, unit, lines) for item in found.mesh]
        if any(made.laid for made in converted):
            found = found._replace(creases=[item for item in found.creases if item.kind != "curve"])
        if not converted:
            converted = [outline_part(found, length, own)]
            # The creases are edges of the mesh now, cut at the outline.
            found = found._replace(creases=[])
        joints = [joint for made in converted for joint in made.creases]
        read = assemble(
            name=Path(path).stem,
            parts=[made.part for made in converted],
            supports=lambda fine: _drawn(found.supports, fine),
            creases=lambda fine: _drawn(found.creases, fine) + joints,
            targets=lambda fine: _drawn(found.targets, fine),
            constraints=lambda fine: _drawn(found.constraints, fine),
            goals=lambda fine: [drawn._replace(text={**drawn.text, "name": item.name}) for item, drawn in _with_items(found.goals, fine)],
            units=unit_name(archive.Settings.ModelUnitSystem),
            tolerance=own,
            solved={int(user_number(item.text, "region") or 0): user_law(item.text) for item in found.regions},
            crease=crease,
            notes=found.notes + [note for made in converted for note in made.notes],
            north=north_of(archive),
        )
        if len(found.drawn) == 1:
            (item,) = found.drawn
            read = read._replace(problem=drawn_from(read.problem, *mesh_to_arrays(item.geometry), item.text))
        return read
    except FileError as error:
        raise FileError(f"{path}: {error}") from None


def read_curves(path: Union[str, os.PathLike], layer: str) -> list[FloatArray]:
    """Return the curves on a layer and its sublayers, each as points (k, 3) within the file's tolerance [L].

    Raises
    ------
    FileError
        If the file cannot be read or there are no curves.
    """
    archive = read_archive(path)
    names = LayerNames(mesh=(layer,))
    items = [item for item in list_items(archive) if item.kind == "curve" and names.role(item.layer) == "mesh"]
    if not items:
        raise FileError(f"{path}: the layer {layer!r} has no curves")
    return [curve_points(item.geometry, float(archive.Settings.ModelAbsoluteTolerance)) for item in items]


def _converted(
    item: Item, items: list[Item], edge_length: Optional[float], tolerance: float, unit: str, creases: list[Drawn]
) -> MeshedSurface:
    """Return the mesh of an object: its own, a mesh of its surface, or its render mesh."""
    if item.kind == "mesh" or (edge_length is None and has_mesh(item)):
        part, notes = to_part(item)
        return MeshedSurface(part, [], notes)
    length = default_edge_length(items) if edge_length is None else edge_length
    try:
        return surface_part(item, length, tolerance, unit, creases)
    except FileError:
        if not has_mesh(item):
            raise
    part, notes = to_part(item)
    return MeshedSurface(part, [], notes)


def _with_items(items: list[Item], tolerance: float) -> list[tuple[Item, Drawn]]:
    return list(zip(items, _drawn(items, tolerance)))


def _drawn(items: list[Item], tolerance: float) -> list[Drawn]:
    return [to_drawn(item, tolerance) for item in items]
