"""A finished freeform design: a smooth surface, what holds it, and its seams where they are drawn."""

from __future__ import annotations

import os
from collections.abc import Sequence
from pathlib import Path
from typing import Any
from typing import NamedTuple
from typing import Optional
from typing import Union

import numpy as np

from ..discrete import edge_faces
from ..discrete import face_areas
from ..discrete.arrays import Edges
from ..discrete.arrays import FloatArray
from ..discrete.arrays import IntArray
from ..errors import CGCError
from ..errors import MeshError
from ..linalg import SingularMatrixError
from ..meshing import triangles_of
from ..meshing.boundary import boundary_loops
from ..model.problem import Drawing
from .chart import Fitted
from .chart import chart_of
from .chart import fitted_surface
from .creases import creases_of
from .cut_functions import CreasedMesh
from .rims import rims_of_closed
from .sharp_edges import sharp_edges
from .spline_surface import SplineSurface
from .unwrapping import Unwrapped
from .unwrapping import refuse_parts
from .unwrapping import unwrapped

__all__ = ["Design", "DesignInput", "GivenDesign", "given_design", "read_design"]

STEP = (".step", ".stp")

DesignInput = Union[str, os.PathLike, SplineSurface, Any]

EPS = float(np.finfo(float).eps)
TOLERANCE = 1e-4  # of the size of a mesh, within which it is fitted by default
LARGEST_DEVIATION = 0.01  # of the size, from which a fitted surface is no longer the design
LARGEST_FACET_DEVIATION = 0.1  # of the size; it is 0.085 for a sphere with four faces around
CORRECTIONS = 2  # of the parameters of vertices for each number of spans; more change little
ON_SIDE = 1e-3  # of a mean edge, within which a rim is a side of the rectangle around it


class DesignMesh(NamedTuple):
    """The mesh of a design."""

    vertices: FloatArray  # (n, 3) [L]
    polygons: Sequence[Sequence[int]]  # corners of its faces
    tolerance: float  # of the surface fitted to it, whether or not it is met [L]
    facet_deviation: float  # largest distance of the middles of its edges from this surface [L]
    notes: tuple[str, ...] = ()  # on this surface


class Design(NamedTuple):
    """A finished design."""

    surface: SplineSurface
    rims: tuple[FloatArray, ...]  # (k, 2) parameters along its rim and holes, empty where the rim is that of the parameters
    deviation: float  # largest distance of the design as given from the surface [L]
    supports: tuple[FloatArray, ...] = ()  # (k, 3) points that are held, or points along curves [L]
    seams: tuple[FloatArray, ...] = ()  # (k, 3) points along drawn seams [L]
    drawing: Drawing = Drawing()
    notes: tuple[str, ...] = ()
    quads: Optional[tuple[FloatArray, IntArray]] = None  # parameters (k, 2) of the corners and corners (q, 4) of a quad mesh
    mesh: Optional[DesignMesh] = None  # to which the surface is fitted
    creases: tuple[FloatArray, ...] = ()  # (k, 2) parameters along lines at which the surface folds

    def refitted(self, tolerance: float) -> Design:
        """Return the same design with its surface fitted to the mesh within another tolerance [L]; itself if it is no mesh."""
        if self.mesh is None:
            return self
        made = _fitted(self.mesh.vertices, self.mesh.polygons, tolerance)
        notes = tuple(note for note in self.notes if note not in self.mesh.notes) + made.notes
        return made._replace(supports=self.supports, seams=self.seams, drawing=self.drawing, notes=notes)

    def finer(self, limit: float) -> Design:
        """Return the design, refitted if its surface deviates more than a limit [L] and was fitted within a larger tolerance."""
        met = self.mesh is None or min(self.deviation, self.mesh.tolerance) <= limit
        return self if met else self.refitted(limit)

    @property
    def trimmed(self) -> bool:
        """Whether the rim is not that of the parameters."""
        return bool(self.rims)


class GivenDesign(NamedTuple):
    """A design as it is given, before a surface is fitted to its mesh."""

    surface: Optional[SplineSurface]  # None for a mesh
    vertices: FloatArray  # (n, 3) of its mesh [L]
    polygons: Sequence[Sequence[int]]  # corners of the faces of its mesh
    tolerance: Optional[float] = None  # default of the surface fitted to it [L]; None: by its size
    supports: tuple[FloatArray, ...] = ()  # (k, 3) points that are held, or points along curves [L]
    seams: tuple[FloatArray, ...] = ()  # (k, 3) points along drawn seams [L]
    drawing: Drawing = Drawing()
    notes: tuple[str, ...] = ()

    def fitted(self, tolerance: Optional[float] = None, finest: float = np.inf) -> Design:
        """Return the design with its surface, fitted to a mesh within a tolerance, or the default one up to a limit [L]."""
        if self.surface is not None:
            made = Design(self.surface, (), 0.0, creases=creases_of(self.surface))
        else:
            if tolerance is None and self.tolerance is not None:
                tolerance = min(self.tolerance, finest)
            made = _fitted(self.vertices, self.polygons, tolerance, finest)
        return made._replace(supports=self.supports, seams=self.seams, drawing=self.drawing, notes=(*self.notes, *made.notes))


def read_design(
    design: DesignInput, *, tolerance: Optional[float] = None, seams: Optional[str] = None, finest: Optional[float] = None
) -> Design:
    """Return a design as a smooth surface.

    Parameters
    ----------
    design
        A :class:`~compas_cgc.rationalisation.SplineSurface`; the path of a ``.3dm``, ``.step`` or mesh file; a COMPAS mesh; or
        vertices (n, 3) and faces, triangles, quads or polygons.
    tolerance
        Largest distance between a mesh and the smooth surface fitted to it [L]. Default: that of the file, or a ten-thousandth of
        its size.
    seams
        Layer of a ``.3dm`` with the seams. Default: the layer ``Seams``, if there is one.
    finest
        Upper limit of the default tolerance [L].

    Returns
    -------
    Design
        The surface with its rims, supports and drawn seams.

    Raises
    ------
    FileError
        If the file cannot be read or holds no surface.
    MeshError
        If no smooth surface can be fitted to the mesh within the tolerance, or the mesh has several parts or handles.
    CGCError
        If it is no design.

    Examples
    --------
    >>> vertices = [[x, y, 0.05 * x * y] for x in range(5) for y in range(4)]
    >>> quads = [[4 * i + j, 4 * i + 4 + j, 4 * i + 5 + j, 4 * i + 1 + j] for i in range(4) for j in range(3)]
    >>> design = read_design((vertices, quads))
    >>> design.trimmed, design.deviation < 1e-4
    (False, True)
    """
    limit = np.inf if finest is None else finest
    if isinstance(design, Design):
        return design if tolerance is not None else design.finer(limit)
    return given_design(design, seams).fitted(tolerance, limit)


def given_design(design: DesignInput, seams: Optional[str] = None) -> GivenDesign:
    """Return a design, as for :func:`read_design`, without fitting a surface to its mesh, for those who need its units first."""
    if isinstance(design, GivenDesign):
        return design
    if isinstance(design, SplineSurface):
        return GivenDesign(design, np.empty((0, 3)), ())
    if isinstance(design, (str, os.PathLike)):
        return _from_file(Path(design), seams)
    return _of_mesh(design)


def _from_file(path: Path, seams: Optional[str]) -> GivenDesign:
    suffix = path.suffix.lower()
    if suffix not in (".3dm", *STEP):
        from ..io import read_problem

        read = read_problem(path)
        return given_design(read.checked())._replace(notes=tuple(read.notes))
    if suffix in STEP:
        from ..io.step_design import read_step_design

        if seams is not None:
            raise CGCError(f"seams on a layer need a .3dm file, and {path.name} is a STEP file; give the seams in a .3dm of their own")
        drawn = read_step_design(path)
    else:
        from ..io.rhino.designs import read_drawn_design

        drawn = read_drawn_design(path, seams)
    surface = None if drawn.spline is None else SplineSurface(*drawn.spline)
    polygons = [list(dict.fromkeys(face)) for face in drawn.faces.tolist()]
    drawing = Drawing(path.stem, drawn.units, drawn.tolerance, north=drawn.north)
    of_drawing = tuple(drawn.supports), tuple(drawn.seams), drawing, tuple(drawn.notes)
    return GivenDesign(surface, drawn.vertices, polygons, drawn.tolerance, *of_drawing)


def _of_mesh(design: Any) -> GivenDesign:
    """Return the design of a mesh in any form, with its supports."""
    if hasattr(design, "to_problem"):
        problem = design.to_problem().without_dummies()
        held = tuple(problem.vertices[problem.supports, None])
        return GivenDesign(None, problem.vertices, problem.faces.tolist(), supports=held, drawing=problem.drawing)
    if hasattr(design, "to_vertices_and_faces"):
        vertices, faces = design.to_vertices_and_faces()
    elif isinstance(design, Sequence) and not isinstance(design, str) and len(design) == 2:
        vertices, faces = design
    else:
        raise CGCError(f"a design is a path, a spline surface, a mesh, or vertices and faces, not {design!r:.60}")
    V = np.asarray(vertices, dtype=np.float64)
    if V.ndim != 2 or V.shape[1] != 3 or not np.isfinite(V).all():
        raise CGCError(f"vertices of a design must be finite numbers (n, 3), not of shape {V.shape}")
    return GivenDesign(None, V, [list(map(int, face)) for face in faces])


def _fitted(vertices: FloatArray, polygons: Sequence[Sequence[int]], tolerance: Optional[float], limit: float = np.inf) -> Design:
    """Return the surface through a mesh, smooth but for its sharp edges, within a tolerance, by default one up to a limit."""
    faces = triangles_of(vertices, polygons)[0]
    if not len(faces):
        raise MeshError("the design has no faces; give a surface")
    used = np.unique(faces)
    size = float(np.linalg.norm(np.ptp(vertices[used], axis=0)))
    if not float(face_areas(vertices, faces).sum()) > EPS * size**2:
        raise MeshError("the design has no area: all its vertices lie on a line; give a surface")
    wanted = min(TOLERANCE * size, limit) if tolerance is None else tolerance
    refuse_parts(vertices, faces)
    chart, sharp = chart_of(vertices, faces), sharp_edges(vertices, faces)
    if chart is not None:
        over = Unwrapped(chart.to_local(vertices[used])[:, :2], used, np.full(2, np.inf), (False, False), tuple(boundary_loops(faces)))
    else:
        over = unwrapped(vertices, faces, list(sharp[:, :2]))
    points = vertices[over.vertices]
    mesh = _creased(faces, over, sharp)
    try:
        fitted = fitted_surface(over.uv, points, wanted, over.period, over.poles, mesh=mesh)
    except SingularMatrixError:
        raise MeshError("the mesh has too few faces to fit a smooth surface through it; refine it, or give a NURBS surface") from None
    if chart is None and mesh is None and fitted.deviation > wanted:
        corrected = fitted_surface(over.uv, points, wanted, over.period, over.poles, CORRECTIONS)
        fitted = min(fitted, corrected, key=lambda own: own.deviation)
    if fitted.deviation > LARGEST_DEVIATION * size:
        raise MeshError(
            f"the smooth surface fitted to the mesh deviates from it by {fitted.deviation:.3g}, {100.0 * fitted.deviation / size:.2g} % "
            "of its size; the mesh is too coarse where it bends, or between its sharp edges: refine and smooth it, give a NURBS surface, "
            "or divide the design into smooth parts"
        )
    notes = () if fitted.deviation <= wanted else (_note(fitted, wanted),)
    uv = np.zeros((len(vertices), 2))
    uv[over.vertices] = fitted.uv
    facets = _facet_deviation(fitted.surface, vertices, faces, uv)
    if facets > LARGEST_FACET_DEVIATION * size:
        raise MeshError(
            f"the faces of the mesh are up to {facets:.3g}, {100.0 * facets / size:.2g} % of its size, from the smooth surface through its "
            "vertices; the mesh is too coarse: refine it, or give a NURBS surface"
        )
    rims = tuple(uv[loop] for loop in over.rims)
    edge = float(np.median(np.linalg.norm(vertices[faces[:, 0]] - vertices[faces[:, 1]], axis=1)))
    if rims and np.isfinite(over.period).any():
        rims = tuple(rims_of_closed(fitted.surface.domain, over.period, rims))
    elif len(rims) == 1 and _is_rectangle(rims[0], ON_SIDE * edge):
        rims = ()
    quads = None
    if all(len(face) == 4 for face in polygons):
        own = np.array(polygons)
        quads = _joined_corners(uv, own, over, [np.argmin(over.uv[:, 1]), np.argmax(over.uv[:, 1])])
    creases = () if mesh is None else mesh.lines()
    given = DesignMesh(vertices, polygons, wanted, facets, notes)
    return Design(fitted.surface, rims, fitted.deviation, notes=notes, quads=quads, mesh=given, creases=creases)


def _facet_deviation(surface: SplineSurface, vertices: FloatArray, faces: IntArray, uv: FloatArray) -> float:
    """Return the largest distance of the middles of edges from the surface through the vertices, which have parameters (n, 2) [L]."""
    sides = edge_faces(faces)[:, :2]
    middles = vertices[sides].mean(axis=1)
    # Searches start from both ends because an edge may cross the seam of periodic parameters.
    feet = [surface.at(surface.foot(middles, uv[sides[:, end]])) for end in (0, 1)]
    return float(np.minimum(*(np.linalg.norm(middles - foot, axis=1) for foot in feet)).max(initial=0.0))


def _creased(faces: IntArray, over: Unwrapped, sharp: Edges) -> Optional[CreasedMesh]:
    """Return the mesh in the plane of its parameters with its sharp edges (c, 4), None if there are none, or if it has poles."""
    if any(over.poles) or not len(sharp):
        return None
    own = np.searchsorted(over.vertices, faces)
    corners = over.uv[own]
    closed = np.isfinite(over.period)
    whole = np.where(closed, over.period, 1.0)
    corners = corners - np.where(closed, whole * np.round((corners - corners[:, :1]) / whole), 0.0)
    sharp = np.column_stack([np.searchsorted(over.vertices, sharp[:, :2]), sharp[:, 2:]])
    return CreasedMesh(own, corners, sharp, over.period)


def _joined_corners(uv: FloatArray, quads: IntArray, over: Unwrapped, ends: Sequence[np.integer]) -> tuple[FloatArray, IntArray]:
    """Return corners of quads (4 q, 2) beside each other, where parameters close or have poles, and those of every quad (q, 4)."""
    corners = uv[quads]
    is_pole = np.zeros(quads.shape, bool)
    for pole, end in zip(over.poles, ends):
        if pole:
            is_pole |= quads == over.vertices[end]
    first = np.argmin(is_pole, axis=1)
    for axis in np.flatnonzero(np.isfinite(over.period)):
        values, period = corners[..., axis], over.period[axis]
        near = np.take_along_axis(values, first[:, None], axis=1)
        values = values - period * np.round((values - near) / period)
        if axis == 0:
            mean = (values * ~is_pole).sum(axis=1) / np.maximum((~is_pole).sum(axis=1), 1)
            values = np.where(is_pole, mean[:, None], values)
        corners[..., axis] = values
    return corners.reshape(-1, 2), np.arange(4 * len(quads)).reshape(-1, 4)


def _note(fitted: Fitted, wanted: float) -> str:
    return (
        f"the smooth surface fitted to the mesh deviates from it by {fitted.deviation:.3g}, more than the tolerance of {wanted:.3g}; "
        "refine the mesh where it bends and where creases end, or smooth it"
    )


def _is_rectangle(rim: FloatArray, reach: float) -> bool:
    low, high = rim.min(axis=0), rim.max(axis=0)
    return bool(np.minimum(np.abs(rim - low), np.abs(rim - high)).min(axis=1).max() <= reach)
