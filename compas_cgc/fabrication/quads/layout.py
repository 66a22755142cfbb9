"""Plane quads along the lines of curvature of regions with K > 0, and squares where H is constant."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import NamedTuple
from typing import Optional

import numpy as np

from ...discrete import edge_faces
from ...discrete import face_areas
from ...discrete.arrays import Faces
from ...discrete.arrays import FloatArray
from ...discrete.arrays import IntArray
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
from ..curves.net import DEFAULT_SPACING
from ..curves.net import check_spacing
from ..curves.net import region_size
from ..shape_operators import shape_operators
from ..solved import chosen_regions
from ..solved import solved_problem
from .axes import node_axes
from .axes import polygon_normal
from .cross_field import cross_field
from .extraction import Polygons
from .extraction import extracted
from .merging import merged
from .parametrisation import parametrised
from .planarity import gaps
from .planarity import planarised
from .planarity import polygon_edges
from .plane_faces import PlaneQuads
from .plane_faces import dead_ends
from .symmetry import symmetrised

__all__ = ["plane_quads"]

# Lengths over which directions are averaged, relative to the spacing, and weights of the rim, tried until singularities are far enough
# apart and no line ends inside. Near the corners of steep domes principal directions turn fast; the last field follows the rim there.
FIELDS = ((0.3, 1e-3), (0.6, 1e-3), (1.2, 1e-3), (2.4, 1e-3), (4.8, 1.0))
FINENESS = 0.25  # of the spacing, below which the edges of the mesh are divided
FLATNESS = 1e-3  # of the spacing, gap between diagonals below which faces count as plane
MAX_DIVISIONS = 3
SHORTEST = 0.25  # of the spacing, side at the rim below which lines share a vertex of the rim
UMBILIC_RATIO = 1e-3  # half difference of the principal curvatures times the size below which a region counts as a sphere or plane
DEPTH = 0.1  # of the spacing, default depth of beams


class _Layout(NamedTuple):
    """Polygons of a region between lines, and its mesh."""

    polygons: Polygons
    plane: Optional[Polygons]  # the same as plane faces, None until they are computed
    coarse: tuple[Vertices, Faces]  # the mesh of the surface
    fine: tuple[Vertices, Faces]  # and as it was divided
    loops: list[IntArray]  # its rims


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

    The lines are the integer lines of a seamless parametrisation. Its singularities lie where the principal curvatures are equal. Where
    the surface is nearly a sphere, they follow from the smoothest field of crosses. Corners are moved until all faces are plane.

    Where the mean curvature is constant, as on cushions and soap films, quads are squares: their sides are in proportion to
    ``1 / sqrt(k1 - k2)``, so that they are larger where the principal curvatures k1, k2 are alike. The rim
    cuts them off, whereas in regions with K > 0 the lines follow a rim that is a line of curvature.

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
    step = spacing or DEFAULT_SPACING * min(region_size(problem, region) for region in covered)
    for region in covered:
        own = problem.faces[label == region]
        size = region_size(problem, region)
        refuse_other_units("the spacing", step, size, problem.drawing.units)
        check_spacing(size, step, region)
        layouts[region] = _laid_out(problem.vertices, own, None if region in square else targets[region], step, region)
    finished = [_finished(own, step) for own in _symmetric(problem, list(layouts.values()), step)]
    return _joined(problem, step, depth or DEPTH * step, dict(zip(layouts, finished)), tuple(notes))


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
    # Directions vary much near point supports and corners of held rims, which adds singularities where lines would end.
    tried, doubtful = list[tuple[tuple[bool, int, float], _Layout]](), list[_Layout]()
    for length, rim_weight in FIELDS:
        field = cross_field(fine, triangles, S, typical, length * spacing, rim_weight)
        found = extracted(fine, triangles, parametrised(fine, triangles, field, spacing, sides, density), spacing, kinks)
        if not found.faces or not all(len(face) == 4 for face in found.faces if not found.rim[face].any()):
            continue
        own = _Layout(found, None, (V, F), (fine, triangles), loops)
        # Lines that end inside before faces are plane mostly do so afterwards, so that another smoothing is tried first.
        if _dead_ends(merged(found, SHORTEST * spacing)):
            doubtful.append(own)
            continue
        tried.append(_judged(own, spacing))
        if tried[-1][0][:2] == (False, 0):
            return tried[-1][1]
    tried += [_judged(own, spacing) for own in doubtful]
    if not tried:
        raise CGCError(f"singularities of region {region} lie too close together for lines {spacing:.3g} apart; use a smaller spacing")
    return min(tried, key=lambda each: each[0])[1]


def _judged(own: _Layout, spacing: float) -> tuple[tuple[bool, int, float], _Layout]:
    """Return whether faces are warped, the number of lines that end inside and the largest gap [L], and the layout with plane faces."""
    plane = _plane(own, spacing)
    gap = float(gaps(plane.vertices, plane.faces).max())
    return (gap > FLATNESS * spacing, _dead_ends(plane), gap), own._replace(plane=plane)


def _dead_ends(own: Polygons) -> int:
    return dead_ends(own.vertices, polygon_edges(own.faces), own.rim)


def _symmetric(problem: CGCProblem, layouts: list[_Layout], spacing: float) -> list[_Layout]:
    """Return layouts with the symmetries that their lines have together."""
    first = np.cumsum([0, *(len(own.polygons.vertices) for own in layouts)])
    points = np.vstack([own.polygons.vertices for own in layouts])
    faces = [[int(start) + vertex for vertex in face] for start, own in zip(first, layouts) for face in own.polygons.faces]
    moved = symmetrised(points, faces, *_outer(problem), spacing)
    if moved is points:
        return layouts
    parts = np.split(moved, first[1:-1])
    return [own._replace(polygons=own.polygons._replace(vertices=part), plane=None) for own, part in zip(layouts, parts)]


def _outer(problem: CGCProblem) -> tuple[Vectors, Vertices]:
    """Return the kinks (c, 3) and the vertices (r, 3) of the outer rim [L]."""
    V = problem.vertices
    loops = [V[loop] for loop in boundary_loops(problem.faces)]
    if not loops:
        return V[:0], V
    rim = max(loops, key=lambda points: float(np.linalg.norm(np.ptp(points, axis=0))))
    return rim[corners_of(rim)], rim


def _finished(own: _Layout, spacing: float) -> tuple[Polygons, FloatArray]:
    """Return plane polygons without short sides at the rim, and the distances of their corners from the mesh [L]."""
    polygons = own.plane or _plane(own, spacing)
    return polygons, np.linalg.norm(polygons.vertices - nearest_on_mesh(polygons.vertices, *own.coarse)[0], axis=1)


def _plane(own: _Layout, spacing: float) -> Polygons:
    """Return plane polygons without short sides at the rim."""
    polygons = merged(own.polygons, SHORTEST * spacing)
    while True:
        count, points = len(polygons.vertices), planarised(polygons, *own.fine, own.loops, around=False)
        # Corners slide towards kinks of held rims, where the curvature is unbounded.
        polygons = merged(polygons._replace(vertices=points), SHORTEST * spacing)
        if len(polygons.vertices) == count:
            break
    if gaps(polygons.vertices, polygons.faces).max() <= FLATNESS * spacing:
        return polygons
    return polygons._replace(vertices=planarised(polygons, *own.fine, own.loops))


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


def _joined(
    problem: CGCProblem, spacing: float, depth: float, layouts: dict[int, tuple[Polygons, FloatArray]], notes: tuple[str, ...]
) -> PlaneQuads:
    first, faces, region = 0, list[list[int]](), list[int]()
    for number, (polygons, _) in layouts.items():
        faces += [[first + vertex for vertex in face] for face in polygons.faces]
        region += [number] * len(polygons.faces)
        first += len(polygons.vertices)
    points = np.vstack([polygons.vertices for polygons, _ in layouts.values()])
    edges, axes = polygon_edges(faces), node_axes(points, faces)
    beams = np.column_stack([edges, edges[:, ::-1] + len(points)]).tolist()
    normals = np.array([polygon_normal(points[face]) for face in faces])
    return PlaneQuads(
        problem=problem,
        spacing=spacing,
        depth=depth,
        vertices=points,
        faces=faces,
        region=np.array(region, dtype=np.int64),
        rim=np.concatenate([polygons.rim for polygons, _ in layouts.values()]),
        planarity=gaps(points, faces),
        off=np.concatenate([off for _, off in layouts.values()]),
        edges=edges,
        axes=axes,
        twist=gaps(np.vstack([points, points + depth * axes]), beams),
        offset_error=depth * np.array([np.abs(axes[face] @ normal - 1.0).max() for face, normal in zip(faces, normals)]),
        notes=notes,
    )
