"""Formats of files: the table that readers, writers, doors and the manual use."""

from __future__ import annotations

from collections.abc import Iterable
from typing import NamedTuple

__all__ = ["FORMATS", "MEDIA_TYPES", "OUTPUTS", "READ_SUFFIXES", "SUFFIXES", "WRITTEN_SUFFIXES", "Format", "listed"]


class Format(NamedTuple):
    """A format of files.

    Parameters
    ----------
    name
        Name of the format.
    coordinates, supports, targets, goals
        What a mesh file stores of coordinates, of supports and creases, of targets and of goals; empty if the format
        holds no meshes.
    plan
        Whether plans are read from the curves of such files.
    surfaces
        Whether the smooth surfaces of the regions of a result are written to such files.
    media_type
        Media type over HTTP; empty if the server does not take such files.
    extra
        Extra of the package that reads and writes the format; empty if none is needed.

    Examples
    --------
    >>> FORMATS[".3dm"].extra
    'rhino'
    """

    name: str
    coordinates: str = ""
    supports: str = ""
    targets: str = ""
    goals: str = ""
    plan: bool = False
    surfaces: bool = False
    media_type: str = ""
    extra: str = ""


FORMATS = {
    ".3dm": Format("Rhino", "exact", "yes", "yes", "yes", plan=True, media_type="model/vnd.3dm", extra="rhino"),
    ".json": Format("COMPAS", "exact", "yes", "yes", "yes"),
    ".obj": Format("Wavefront", "exact", "yes: `p` and `l` elements", "of regions: groups `K=0.03`", "no", media_type="model/obj"),
    ".off": Format("Object File Format", "exact", "no", "no", "no"),
    ".ply": Format("Stanford", "exact", "yes: vertex `role`, edge `crease`", "of vertices: `target`", "no"),
    ".stl": Format("stereolithography", "exact; vertices are renumbered", "no", "no", "no"),
    ".step": Format("STEP", surfaces=True, media_type="model/step", extra="cad"),
    ".stp": Format("STEP", surfaces=True, media_type="model/step", extra="cad"),
    ".dxf": Format("AutoCAD", plan=True, media_type="image/vnd.dxf", extra="fabrication"),
}

SUFFIXES = tuple(suffix for suffix, own in FORMATS.items() if own.coordinates)
READ_SUFFIXES = tuple(suffix for suffix, own in FORMATS.items() if own.coordinates or own.plan)
WRITTEN_SUFFIXES = tuple(suffix for suffix, own in FORMATS.items() if own.coordinates or own.surfaces)

# Files of the tasks that follow a solve; the suffix selects the contents.
OUTPUTS = {
    "mould": (".3dm", ".step", ".ifc", ".csv"),
    "unroll": (".dxf", ".svg", ".csv", ".3dm", ".list.csv", ".plan.dxf", ".plan.svg", ".zip"),
    "membrane": (".3dm", ".inp", ".json"),
    "net": (".3dm", ".dxf", ".json", ".laths.csv", ".laths.dxf"),
    "drawings": (".pdf", ".dxf", ".svg"),
    "quads": (".3dm", ".dxf", ".flat.dxf", ".flat.svg", ".json", ".csv", ".beams.csv"),
}

MEDIA_TYPES = {
    **{suffix: own.media_type for suffix, own in FORMATS.items() if own.media_type},
    ".csv": "text/csv",
    ".ifc": "application/x-step",
    ".inp": "text/plain",
    ".json": "application/json",
    ".pdf": "application/pdf",
    ".svg": "image/svg+xml",
    ".zip": "application/zip",
}


def listed(suffixes: Iterable[str] = SUFFIXES) -> str:
    """Return suffixes in words.

    Parameters
    ----------
    suffixes
        Suffixes; the default is those of mesh files.

    Returns
    -------
    str
        Text for sentences.

    Examples
    --------
    >>> listed()
    '.3dm, .json, .obj, .off, .ply or .stl'
    """
    *others, last = suffixes
    return f"{', '.join(others)} or {last}" if others else last
