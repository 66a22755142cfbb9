"""Plane quads along the lines of curvature of regions with K > 0, and squares where H is constant."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple
from typing import Optional

import numpy as np

from ...discrete import edge_faces
from ...discrete import face_areas
from ...discrete.arrays import Faces
from ...discrete.arrays import FloatArray
from ...discrete.arrays import IntArray
from ...discrete.arrays import Mask
from ...discrete.arrays import Vectors
from ...discrete.arrays import Vertices
from ...errors import CGCError
from ...errors import names_what_was_meant
from ...meshing import boundary_loops
from ...meshing.boundary import corners_of
from ...meshing.closest_on_mesh import nearest_on_mesh
from ...model.given import checked_number
from ...model.given import refuse_other_units
from ...model.problem import CGCProblem
from ...model.problem import PosesProblem
from ..curves.net import check_spacing
from ..curves.net import usual_spacing
from ..materials import metres_per_unit
from ..shape_operators import shape_operators
from ..solved import chosen_regions
from ..solved import solved_problem
from .cross_field import cross_field
from .extraction import Polygons
from .extraction import extracted
from .merging import merged
from .parametrisation import parametrised
from .planarity import gaps
from .planarity import planarised
from .planarity import polygon_edges

__all__ = ["PlaneQuads", "axis_lines", "plane_quads"]

SMOOTHING = (0.3, 0.6, 1.2, 2.4)  # of the spacing, over which directions are averaged, until singularities are far enough apart
FINENESS = 0.25  # of the spacing, below which the edges of the mesh are divided
MAX_DIVISIONS = 3
SHORTEST = 0.25  # of the spacing, side at the rim below which lines share a vertex of the rim
STRAIGHT = np.deg2rad(150.0)  # angle at a vertex with three sides from which one of them is a line that ends there
UMBILIC_RATIO = 1e-3  # half difference of the principal curvatures times the size below which a region counts as a sphere or plane
SHORT = 100.0  # mm, beams below which are named
AXIS_RANK = 5e-3  # relative size of singular values below which normals around a corner count as dependent: faces within half a degree
AXIS_STEPS = 10  # of the axes of corners at the rim towards plane beams
AXIS_DAMPING = 1e-3  # weight of changes of axes against twists, which keeps axes of nearly straight rims from leaning
DEPTH = 0.1  # of the spacing, default depth of beams


@dataclass(frozen=True, eq=False)
class PlaneQuads:
    """Plane faces and beams of all regions.

    Parameters
    ----------
    problem
        The surface.
    spacing
        Distance between lines [L].
    depth
        Depth of the beams [L].
    vertices
        (k, 3) corners of the faces [L].
    faces
        Corners of every face, counterclockwise seen from outside; four inside, three or more at the rim.
    region
        (f,) region of every face.
    rim
        (k,) whether a corner lies on the rim of its region.
    planarity
        (f,) largest distance between the diagonals of four consecutive corners [L].
    off
        (k,) distances of the corners from the mesh [L].
    edges
        (e, 2) beams, as pairs of corners.
    axes
        (k, 3) axes of the nodes: moved by them, faces keep their distance from faces moved along their normals as well as possible.
    twist
        (e,) distance between the diagonals of a beam of this depth between the axes of its ends [L].
    offset_error
        (f,) largest deviation from the depth of the distance between a face and its corners moved along the axes by the depth [L].
    notes
        Sentences on regions without quads.

    Examples
    --------
    >>> import compas_cgc
    >>> from compas_cgc.fabrication import plane_quads
    >>> quads = plane_quads(compas_cgc.solve(compas_cgc.read(compas_cgc.get("cushion.3dm"))), 0.8)
    >>> quads.dead_ends, bool(quads.planarity.max() < 1e-3)
    (0, True)
    """

    problem: CGCProblem
    spacing: float  # [L]
    depth: float  # [L]
    vertices: Vectors  # (k, 3) [L]
    faces: list[list[int]]  # corners of every face
    region: IntArray  # (f,) region of every face
    rim: Mask  # (k,) on the rim of its region
    planarity: FloatArray  # (f,) largest distance between diagonals [L]
    off: FloatArray  # (k,) distances from the mesh [L]
    edges: IntArray  # (e, 2) beams
    axes: Vectors  # (k, 3) axes of the nodes
    twist: FloatArray  # (e,) distance between the diagonals of a beam [L]
    offset_error: FloatArray  # (f,) deviation of the offset from the depth [L]
    notes: tuple[str, ...] = ()

    @property
    def irregular(self) -> IntArray:
        """Inner corners with other than four sides: the singularities of the layout (s,)."""
        degree = np.bincount(self.edges.ravel(), minlength=len(self.vertices))
        return np.flatnonzero(~self.rim & (degree != 4))

    @property
    def aspects(self) -> FloatArray:
        """Ratio of the widths of a face along both directions, at least 1 (f,); NaN without four corners and for faces at the rim."""
        inner = np.array([len(face) == 4 and not self.rim[face].any() for face in self.faces])
        found = np.full(len(self.faces), np.nan)
        a, b, c, d = self.vertices[[face for face, own in zip(self.faces, inner) if own]].reshape(-1, 4, 3).transpose(1, 0, 2)
        ratio = np.linalg.norm(b + c - a - d, axis=1) / np.linalg.norm(c + d - a - b, axis=1)
        found[inner] = np.maximum(ratio, 1.0 / ratio)
        return found

    @property
    def dead_ends(self) -> int:
        """Number of lines that end inside: at corners with two sides, or with three of which two are in line."""
        ends = 0
        for vertex in self.irregular.tolist():
            others = self.edges[(self.edges == vertex).any(axis=1)].sum(axis=1) - vertex
            along = self.vertices[others] - self.vertices[vertex]
            along = along / np.linalg.norm(along, axis=1, keepdims=True)
            straight = np.arccos(np.clip(along @ along.T, -1.0, 1.0)).max() >= STRAIGHT
            ends += len(others) < 3 or (len(others) == 3 and bool(straight))
        return ends

    def summary(self) -> str:
        """Return lines of text with counts, planarity, distances from the surface and offsets."""
        mm = 1e3 * metres_per_unit(self.problem.drawing.units)
        sides = mm * np.linalg.norm(self.vertices[self.edges[:, 0]] - self.vertices[self.edges[:, 1]], axis=1)
        corners = np.array([len(face) for face in self.faces])
        others = f", {(corners != 4).sum()} with other numbers of sides at the rim" if (corners != 4).any() else ""
        middle, most = mm * np.median(self.off), mm * self.off.max()
        lines = [
            f"{len(self.faces)} plane faces, {(corners == 4).sum()} quads{others}; {len(self.irregular)} irregular nodes, "
            f"{self.dead_ends} dead ends",
            f"planarity: {mm * self.planarity.max():.2g} mm between diagonals at most",
            f"nodes deviate from the mesh by {middle:.2g} mm (median), {most:.2g} mm at most",
            f"{len(self.edges)} beams of {sides.min():.4g} to {sides.max():.4g} mm; at a depth of {mm * self.depth:.4g} mm they twist by "
            f"{mm * np.median(self.twist):.2g} mm (median), {mm * self.twist.max():.2g} mm at most",
            f"faces offset by {mm * self.depth:.4g} mm miss their nodes by {mm * np.median(self.offset_error):.2g} mm (median), "
            f"{mm * self.offset_error.max():.2g} mm at most",
        ]
        square = np.array([number in self.problem.laws for number in self.region.tolist()])
        aspects = self.aspects[square & np.isfinite(self.aspects)]
        if len(aspects):
            middle, most = 100.0 * (np.median(aspects) - 1.0), 100.0 * (aspects.max() - 1.0)
            lines.append(f"squares inside regions of constant H: widths differ by {middle:.2g} % (median), {most:.2g} % at most")
        short = np.flatnonzero(sides < SHORT)
        if len(short):
            middle = self.vertices[self.edges[short[:3]]].mean(axis=1)
            places = "; ".join(",".join(f"{value:.3g}" for value in place) for place in middle)
            lines.append(f"{len(short)} beams are shorter than {SHORT:g} mm, at {places}{'; ...' if len(short) > 3 else ''}")
        return "\n".join([*lines, *self.notes])

    __str__ = summary


def axis_lines(quads: PlaneQuads) -> FloatArray:
    """Return the axes of the nodes as lines over the depth of the beams (k, 2, 3) [L]."""
    return np.stack([quads.vertices, quads.vertices + quads.depth * quads.axes], axis=1)


class _Layout(NamedTuple):
    """Planarised polygons of a region, and their distances from its mesh."""

    polygons: Polygons
    off: FloatArray


@names_what_was_meant()
def plane_quads(
    surface: PosesProblem,
    spacing: Optional[float] = None,
    *,
    depth: Optional[float] = None,
    regions: Optional[Sequence[int]] = None,
    rough: bool = False,
) -> PlaneQuads:
    """Cover regions with K > 0 or constant H by plane quads along lines of curvature, without lines that end inside.

    The lines are the integer lines of a seamless parametrisation. Its singularities lie where the principal curvatures are equal, or,
    where the surface is nearly a sphere, where the smoothest crosses need them. Corners are moved until all faces are plane.

    Where the mean curvature is constant, as on cushions and soap films, quads are squares: their sides are in proportion to
    ``1 / sqrt(k1 - k2)``, so that they are larger where the principal curvatures k1, k2 are alike. They end at the rim where it cuts
    them, whereas lines of regions with K > 0 follow a rim that is a line of curvature.

    Parameters
    ----------
    surface
        Solved result, mesh or problem with one target K or another law per region.
    spacing
        Distance between lines, the root mean square of the sides of squares [L]. Default: 1/12 of the size of the smallest region.
    depth
        Depth of the beams [L]. Default: 0.1 of the spacing.
    regions
        Numbers of regions. Default: all with K > 0 or constant H.
    rough
        Whether to accept a surface with the verdict rough, see :class:`compas_cgc.analysis.Verdict`.

    Returns
    -------
    PlaneQuads

    Raises
    ------
    CGCError
        If the surface is rough, no region has K > 0 or constant H, or the spacing is too large for the singularities of a region.

    Examples
    --------
    >>> import compas_cgc
    >>> quads = plane_quads(compas_cgc.solve(compas_cgc.read(compas_cgc.get("cushion.3dm"))), 0.8)
    >>> len(quads.irregular)
    4
    """
    problem = solved_problem(surface, rough)
    for name, value in (("spacing", spacing), ("depth", depth)):
        if value is not None and not (np.isfinite(checked_number(value, name)) and value > 0):
            raise CGCError(f"the {name} must be larger than 0, not {value:g}")
    targets, label = problem.region_targets(), problem.regions()
    notes, layouts = [], {}
    chosen = chosen_regions(problem, regions)
    square = [region for region in chosen if region in problem.laws and problem.laws[region].is_isothermic]
    covered = [region for region in chosen if region in square or (targets[region] or 0.0) > 0.0]
    notes += [f"region {region} has neither one K > 0 nor constant H and gets no quads" for region in chosen if region not in covered]
    if not covered:
        raise CGCError("plane quads need a region with K > 0 or constant H; use a net of curves instead")
    step = spacing or min(usual_spacing(problem, region) for region in covered)
    for region in covered:
        own = problem.faces[label == region]
        size = float(np.linalg.norm(np.ptp(problem.vertices[own].reshape(-1, 3), axis=0)))
        refuse_other_units("the spacing", step, size, problem.drawing.units)
        check_spacing(size, step, region)
        layouts[region] = _laid_out(problem.vertices, own, None if region in square else targets[region], step, region)
    return _joined(problem, step, depth or DEPTH * step, layouts, tuple(notes))


def _laid_out(vertices: Vertices, faces: Faces, K: Optional[float], spacing: float, region: int) -> _Layout:
    """Return the layout of a region of K > 0, or of squares where there is no K."""
    used, corner = np.unique(faces, return_inverse=True)
    V, F = vertices[used], corner.reshape(-1, 3)
    S = shape_operators(V, F).operators
    if not np.isfinite(S).all():
        raise CGCError(f"region {region} has too few faces to compute curvatures; refine its mesh")
    fine, triangles, S = _refined(V, F, S, FINENESS * spacing)
    loops = boundary_loops(triangles)
    if not loops:
        raise CGCError(f"region {region} is closed; plane quads need a rim")
    turns = [np.flatnonzero(corners_of(fine[loop])) for loop in loops]
    kinks = np.concatenate([loop[own] for loop, own in zip(loops, turns)])
    if K is None:
        # Lines that follow the rim would change the proportions of squares.
        density, typical = _density_of_squares(fine, triangles, S, region)
        sides = []
    else:
        density, typical = np.ones(len(triangles)), K
        sides = [side for loop, own in zip(loops, turns) for side in _sides(loop, own)]
    polygons = None
    for length in SMOOTHING:
        field = cross_field(fine, triangles, S, typical, length * spacing)
        found = extracted(fine, triangles, parametrised(fine, triangles, field, spacing, sides, density), spacing, kinks)
        if all(len(face) == 4 for face in found.faces if not found.rim[face].any()):
            polygons = merged(found, SHORTEST * spacing)
            break
    if polygons is None or not polygons.faces:
        raise CGCError(f"singularities of region {region} lie too close together for lines {spacing:.3g} apart; use a smaller spacing")
    while True:
        count, points = len(polygons.vertices), planarised(polygons, fine, triangles, loops)
        # Corners slide towards kinks of held rims, where the curvature is unbounded.
        polygons = merged(polygons._replace(vertices=points), SHORTEST * spacing)
        if len(polygons.vertices) == count:
            break
    return _Layout(polygons, np.linalg.norm(points - nearest_on_mesh(points, V, F)[0], axis=1))


def _density_of_squares(vertices: Vertices, faces: Faces, operators: FloatArray, region: int) -> tuple[FloatArray, float]:
    """Return the lines per spacing in faces (m,) for squares, and the mean square of half the difference of the curvatures [1/L²]."""
    S = operators[faces].mean(axis=1)
    mean = 0.5 * np.trace(S, axis1=1, axis2=2)
    apart = np.sqrt(np.maximum(0.5 * np.einsum("fij,fij->f", S, S) - mean**2, 0.0))
    area = face_areas(vertices, faces)
    typical = float(area @ apart) / float(area.sum())
    if typical * math.sqrt(float(area.sum())) < UMBILIC_RATIO:
        raise CGCError(f"region {region} is a plane or a sphere, whose lines of curvature are undetermined; any quads can be used")
    return np.sqrt(apart / typical), float(area @ apart**2) / float(area.sum())


def _sides(loop: IntArray, turns: IntArray) -> list[IntArray]:
    """Return the paths along a rim between its kinks; one closed path if it has none."""
    starts = turns if len(turns) else np.array([0])
    ends = np.append(starts[1:], starts[0] + len(loop))
    return [loop[np.arange(start, end + 1) % len(loop)] for start, end in zip(starts, ends)]


def _refined(vertices: Vertices, faces: Faces, operators: FloatArray, longest: float) -> tuple[Vertices, Faces, FloatArray]:
    """Return a mesh divided at midpoints until half of its edges are short enough, with operators interpolated."""
    for _ in range(MAX_DIVISIONS):
        edges = edge_faces(faces)[:, :2]
        if np.median(np.linalg.norm(vertices[edges[:, 0]] - vertices[edges[:, 1]], axis=1)) <= longest:
            break
        n = len(vertices)
        number = {(min(a, b), max(a, b)): n + k for k, (a, b) in enumerate(edges.tolist())}
        middle = np.array([[number[min(a, b), max(a, b)] for a, b in zip(face, face[1:] + face[:1])] for face in faces.tolist()])
        first = np.stack([faces, middle, np.roll(middle, 1, axis=1)], axis=2).reshape(-1, 3)
        vertices = np.vstack([vertices, vertices[edges].mean(axis=1)])
        operators = np.concatenate([operators, operators[edges].mean(axis=1)])
        faces = np.vstack([first, middle])
    return vertices, faces, operators


def _joined(problem: CGCProblem, spacing: float, depth: float, layouts: dict[int, _Layout], notes: tuple[str, ...]) -> PlaneQuads:
    first, faces, region = 0, list[list[int]](), list[int]()
    for number, layout in layouts.items():
        faces += [[first + vertex for vertex in face] for face in layout.polygons.faces]
        region += [number] * len(layout.polygons.faces)
        first += len(layout.polygons.vertices)
    points = np.vstack([layout.polygons.vertices for layout in layouts.values()])
    edges, axes = polygon_edges(faces), _axes(points, faces)
    beams = np.column_stack([edges, edges[:, ::-1] + len(points)]).tolist()
    normals = np.array([_normal(points[face]) for face in faces])
    return PlaneQuads(
        problem=problem,
        spacing=spacing,
        depth=depth,
        vertices=points,
        faces=faces,
        region=np.array(region, dtype=np.int64),
        rim=np.concatenate([layout.polygons.rim for layout in layouts.values()]),
        planarity=gaps(points, faces),
        off=np.concatenate([layout.off for layout in layouts.values()]),
        edges=edges,
        axes=axes,
        twist=gaps(np.vstack([points, points + depth * axes]), beams),
        offset_error=depth * np.array([np.abs(axes[face] @ normal - 1.0).max() for face, normal in zip(faces, normals)]),
        notes=notes,
    )


def _normal(points: Vectors) -> FloatArray:
    """Return the unit normal (3,) of a plane polygon."""
    normal = np.cross(points, np.roll(points, -1, axis=0)).sum(axis=0)
    return np.asarray(normal / np.linalg.norm(normal))


def _axes(points: Vectors, faces: list[list[int]]) -> Vectors:
    """Return the vectors (k, 3) that move corners by one along the normals of all faces around them, by least squares.

    Corners at the rim have one face or two, which leave freedom to their axes. It is used so that beams from and along the rim are plane.
    """
    around: list[list[FloatArray]] = [[] for _ in points]
    for face in faces:
        normal = _normal(points[face])
        for vertex in face:
            around[vertex].append(normal)
    axes = np.array([np.linalg.lstsq(np.array(own), np.ones(len(own)), rcond=AXIS_RANK)[0] for own in around], dtype=np.float64)
    free = [_kernel(np.array(own)) for own in around]
    owner = np.repeat(np.arange(len(points)), [len(own) for own in free])
    ways = np.vstack(free)
    edges = polygon_edges(faces)
    rim = edges[np.isin(edges, owner).any(axis=1)]
    along = points[rim[:, 1]] - points[rim[:, 0]]
    along = along / np.linalg.norm(along, axis=1, keepdims=True)
    for _ in range(AXIS_STEPS):
        start, end = axes[rim[:, 0]], axes[rim[:, 1]]
        twist = np.einsum("ei,ei->e", along, np.cross(start, end))
        slopes = [np.cross(end, along), np.cross(along, start)]
        J = np.zeros((len(rim), len(owner)))
        for side, slope in enumerate(slopes):
            at = rim[:, side, None] == owner
            J += at * (slope @ ways.T)
        move = np.linalg.lstsq(np.vstack([J, AXIS_DAMPING * np.identity(len(owner))]), np.r_[-twist, np.zeros(len(owner))], rcond=None)[0]
        np.add.at(axes, owner, move[:, None] * ways)
    return axes


def _kernel(normals: FloatArray) -> FloatArray:
    """Return unit vectors (j, 3) perpendicular to some normals (k, 3) and to each other."""
    _, values, rows = np.linalg.svd(normals, full_matrices=True)
    return np.asarray(rows[int((values > AXIS_RANK * values[0]).sum()) :])
