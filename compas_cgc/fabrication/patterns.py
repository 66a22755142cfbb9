"""Patterns: a surface as flat pieces on sheets."""

from __future__ import annotations

from collections.abc import Iterable
from collections.abc import Sequence
from dataclasses import dataclass
from dataclasses import replace
from typing import NamedTuple
from typing import Optional

import numpy as np

from ..discrete import angle_defects
from ..discrete import boundary_vertices
from ..discrete import edge_faces
from ..discrete import face_areas
from ..discrete import face_normals
from ..discrete.arrays import Edges
from ..discrete.arrays import FloatArray
from ..discrete.arrays import IntArray
from ..discrete.arrays import Mask
from ..discrete.arrays import Vertices
from ..errors import CGCError
from ..meshing import path_edges
from ..model.problem import CGCProblem
from ..model.problem import PosesProblem
from ..model.roles import INTERNAL
from .flattening import flatten
from .flattening import principal_strains
from .layout import among
from .layout import cut_open
from .nesting import nest
from .outlines import Loop
from .outlines import Seam
from .outlines import outline_loops
from .outlines import seams_between
from .outlines import signed_area
from .patchwork import CREASE
from .patchwork import EDGE
from .patchwork import FREE
from .patchwork import NONE
from .patchwork import SEAM
from .patchwork import Patchwork
from .patchwork import mates
from .patchwork import outline_sides
from .patchwork import weights_in
from .pieces import best_box
from .pieces import cut_to_fit
from .plane_layout import unfold
from .rulings import Ruling
from .rulings import Straightness
from .rulings import rulings_of
from .seams import opens_to_disks
from .seams import seam_edges
from .solved import solved_problem

__all__ = ["Unrolling", "Patterns", "Piece", "unroll"]

CLOSED = 1e-6  # gap, against the size of a region, up to which its faces close up
CONE = 1e-9  # angle defect [rad] of a vertex where none is asked, from which on a seam has to pass through it
ROOM = 1e-9  # of a sheet, that is left free at its edges
NO_AREA = 1e-20  # of a face, against the square of the size


class Unrolling(NamedTuple):
    """How a region came into the plane."""

    region: int
    target: Optional[float]  # K asked for [1/L^2], None where it is not one number
    unrolled: bool  # without strain; else flattened
    gap: float  # largest distance between the places of one vertex [L]
    edge_error: float  # largest relative change of an edge
    seam_edges: int


class Piece(NamedTuple):
    """A flat piece on its sheet."""

    label: str
    region: int
    sheet: int
    loops: list[Loop]  # outline and holes, in the coordinates of the sheet
    area: float  # in the plane [L^2]
    area_in_space: float  # [L^2]
    strain: float  # largest, 0 up to rounding where K is 0


@dataclass(frozen=True, eq=False)
class Patterns:
    """A surface as flat pieces on sheets.

    Every number refers to the mesh: nodes by the names of its vertices, those that cuts have made by higher numbers.

    Parameters
    ----------
    problem
        The surface.
    patchwork
        Faces with their places on the sheets.
    pieces
        Flat pieces on their sheets.
    seams
        Where pieces meet.
    unrollings
        By region, where K = 0.
    strains
        (m, 2) principal strains of the faces.
    folds
        (m, 3) angle over every side between two faces of a piece [rad], positive where convex; else 0.
    rulings
        Where a region is ruled.
    straightness
        Of the rulings, by region.
    sheet
        Length and width [L]; None where there is no end of it.

    Examples
    --------
    >>> import compas_cgc
    >>> from compas_cgc.fabrication import unroll
    >>> patterns = unroll(compas_cgc.solve(compas_cgc.read(compas_cgc.get("vault.3dm"))), (3.0, 1.5))
    >>> patterns.sheets
    18
    """

    problem: CGCProblem
    patchwork: Patchwork  # faces with their places on the sheets
    pieces: list[Piece]
    seams: list[Seam]
    unrollings: list[Unrolling]
    strains: FloatArray  # (m, 2) principal strains of the faces
    folds: FloatArray  # (m, 3) angle over every side between two faces of a piece [rad], positive where convex; else 0
    rulings: list[Ruling]  # where a region is ruled
    straightness: dict[int, Straightness]  # of the rulings, by region
    sheet: Optional[tuple[float, float]]  # length and width [L]; None where there is no end of it

    @property
    def sheets(self) -> int:
        """Number of sheets."""
        return 1 + max(piece.sheet for piece in self.pieces)

    @property
    def area(self) -> float:
        """Area of all pieces in the plane [L^2]."""
        return sum(piece.area for piece in self.pieces)

    @property
    def area_in_space(self) -> float:
        """Area of the surface [L^2]."""
        return sum(piece.area_in_space for piece in self.pieces)

    @property
    def seam_mismatch(self) -> float:
        """Largest difference in length between the two sides of a seam [L]."""
        return max((abs(seam.lengths[0] - seam.lengths[1]) for seam in self.seams), default=0.0)

    @property
    def largest_strain(self) -> float:
        """Largest strain of a piece."""
        return max(piece.strain for piece in self.pieces)

    def summary(self) -> str:
        """Return what was made, in lines."""
        count = len(self.pieces)
        area = f"area {self.area:.8g} (in space {self.area_in_space:.8g})"
        lines = [f"{count} piece{'s' if count > 1 else ''}, {len(self.seams)} seams, {area}"]
        if self.sheet is not None:
            used = self.area / (self.sheets * self.sheet[0] * self.sheet[1])
            lines.append(f"{self.sheets} sheets of {self.sheet[0]:g} x {self.sheet[1]:g}, {100 * used:.0f} % used")
        lines.append(f"the two sides of every seam agree to {self.seam_mismatch:.2g}, in units of the model")
        for own in self.unrollings:
            if own.unrolled:
                lines.append(f"region {own.region}: unrolled, gap {own.gap:.2g}, edges to {own.edge_error:.2g}{self._straight(own.region)}")
            else:
                strain = max(piece.strain for piece in self.pieces if piece.region == own.region)
                lines.append(f"region {own.region}: K = {_number(own.target)}, flattened with strains up to {100 * strain:.2g} %")
        return "\n".join(lines)

    __str__ = summary

    def _straight(self, region: int) -> str:
        found = self.straightness.get(region)
        if found is None:
            return ""
        return f", rulings off their chords by {100 * found.median:.2g} % (median), {100 * found.largest:.2g} % at most"


def unroll(
    surface: PosesProblem,
    sheet: Optional[tuple[float, float]] = None,
    *,
    strain: Optional[float] = None,
    seams: Optional[Iterable[Sequence[int]]] = None,
    regions: Optional[Sequence[int]] = None,
    spacing: float = 0.0,
    rulings: Optional[float] = None,
    rough: bool = False,
) -> Patterns:
    """Lay a surface out as flat pieces, each within a sheet.

    Regions of K = 0 keep all their lengths. Others are cut into panels and flattened with the least distortion.

    Parameters
    ----------
    surface
        A problem, a mesh, or what has ``to_problem()``; its creases divide it into regions.
    sheet
        Length and width of the sheets [L]. Default: no end of it, so that nothing is cut but seams.
    strain
        Largest strain of flattened pieces. Default: what comes of the sheet.
    seams
        Paths of vertices (by their names) to cut along. Default: the shortest ones that open every region.
    regions
        Which to take. Default: all.
    spacing
        Distance between pieces on a sheet [L].
    rulings
        Distance between the rulings that are drawn [L], 0 for none. Default: a twelfth of a region's size.
    rough
        Whether a rough surface (see :class:`compas_cgc.analysis.Verdict`) is taken as it is.

    Returns
    -------
    Patterns

    Raises
    ------
    CGCError
        If the surface is rough, a region of K = 0 does not unroll, seams do not open it, there is no such region, or the sheet is no sheet.

    Examples
    --------
    >>> import compas_cgc
    >>> patterns = unroll(compas_cgc.solve(compas_cgc.read(compas_cgc.get("vault.3dm"))), (3.0, 1.5))
    >>> len(patterns.pieces), patterns.sheets
    (18, 18)
    """
    problem = solved_problem(surface, rough)
    sheet = _checked_sheet(sheet)
    if strain is not None and not strain > 0:
        raise CGCError(f"the largest strain must be more than 0, such as 0.002, not {strain:g}")
    given = None if seams is None else _given_seams(problem, seams)
    flat, cuts, unrollings = _developed(problem, _chosen(problem, regions), given)
    curved = {own.region for own in unrollings if not own.unrolled}

    def flattened(own: Patchwork, piece: int) -> Patchwork:
        return _flattened(problem, cuts, own, piece) if own.region[own.piece == piece][0] in curved else own

    def too_wide(own: Patchwork, piece: int) -> bool:
        faces = own.piece == piece
        if strain is None or own.region[faces][0] not in curved:
            return False
        worst = float(np.abs(_strains(own, faces)).max())
        if worst > strain:
            _check_fineness(problem, own, faces, strain, worst)
        return worst > strain

    limits = (np.inf, np.inf) if sheet is None else (sheet[0] * (1 - ROOM), sheet[1] * (1 - ROOM))
    try:
        cut = cut_to_fit(flat, limits, flattened, too_wide)
    except ValueError as error:
        raise CGCError(str(error)) from None
    placed, on_sheet = _on_sheets(cut, sheet, spacing)
    ruled = [own.region for own in unrollings if own.unrolled] if rulings != 0 else []
    lines, straightness = rulings_of(problem, placed, ruled, rulings)
    return _patterns(problem, placed, on_sheet, unrollings, sheet, lines, straightness)


def _checked_sheet(sheet: Optional[tuple[float, float]]) -> Optional[tuple[float, float]]:
    if sheet is None:
        return None
    length, width = (float(x) for x in sheet)
    if not (np.isfinite([length, width]).all() and min(length, width) > 0):
        raise CGCError(f"a sheet must have a length and a width more than 0, such as 3.0 x 1.5, not {length:g} x {width:g}")
    return max(length, width), min(length, width)


def _chosen(problem: CGCProblem, regions: Optional[Sequence[int]]) -> list[int]:
    count = int(problem.regions().max(initial=-1)) + 1
    if regions is None:
        return list(range(count))
    wrong = [region for region in regions if not 0 <= region < count]
    if wrong:
        raise CGCError(f"there is no region {wrong[0]}; the mesh has {count}, from 0 to {count - 1}")
    return sorted(set(regions))


def _given_seams(problem: CGCProblem, seams: Iterable[Sequence[int]]) -> Edges:
    edges = np.array(path_edges([problem.positions(path).tolist() for path in seams]), dtype=np.int64).reshape(-1, 2)
    lost = ~among(edges, edge_faces(problem.faces)[:, :2], len(problem.vertices))
    if lost.any():
        u, v = problem.names.vertices[edges[np.argmax(lost)]].tolist()
        raise CGCError(f"the seam from vertex {u} to {v} does not follow an edge; lead it along edges of the mesh")
    return edges


# ----------------------------------------------------------------------
# Into the plane
# ----------------------------------------------------------------------


def _developed(problem: CGCProblem, regions: list[int], given: Optional[Edges]) -> tuple[Patchwork, Edges, list[Unrolling]]:
    """Return the chosen regions in the plane, each a piece by itself, the edges cut for it, and how they came there."""
    label, targets = problem.regions(), problem.region_targets()
    planes, sides, faces, unrollings = [], [], [], []
    cuts = [problem.creases]
    for region in regions:
        own = np.flatnonzero(label == region)
        plane, seams, unrolling = _region(problem, region, own, targets[region], given)
        side = np.where(_sides_among(problem.faces[own], seams, len(problem.vertices)), SEAM, EDGE)
        planes.append(plane)
        sides.append(side)
        faces.append(own)
        cuts.append(seams)
        unrollings.append(unrolling)
    parent = np.concatenate(faces)
    F = problem.faces[parent]
    side = np.concatenate(sides)
    mate = mates(F)
    side = np.where(_sides_among(F, problem.creases, len(problem.vertices)), CREASE, side)
    side = np.where(mate < 0, FREE, side)
    used, corners = np.unique(F, return_inverse=True)
    flat = Patchwork(
        space=problem.vertices[used],
        names=problem.names.vertices[used],
        faces=corners.reshape(-1, 3).astype(np.int64),
        plane=np.concatenate(planes),
        side=side,
        piece=label[parent],
        region=label[parent],
        parent=parent,
    )
    return flat, np.vstack(cuts), unrollings


def _sides_among(faces: IntArray, edges: Edges, n: int) -> np.ndarray:
    ends = np.stack([faces, np.roll(faces, -1, axis=1)], axis=2).reshape(-1, 2)
    return among(ends, edges, n).reshape(-1, 3)


def _region(
    problem: CGCProblem, region: int, own: IntArray, target: Optional[float], given: Optional[Edges]
) -> tuple[FloatArray, Edges, Unrolling]:
    """Return a region's corners in the plane (m, 3, 2), the edges that were cut for it, and how it went."""
    edges = edge_faces(problem.faces[own])
    faces, origin = cut_open(problem.faces[own], edges[edges[:, 3] >= 0])
    V = problem.vertices[origin]
    inner = ~boundary_vertices(V, faces)
    defect = np.where(inner, np.abs(angle_defects(V, faces)), 0.0)
    asked = problem.roles[origin] == INTERNAL
    cones = (defect > CONE) & ~asked
    flat = target == 0.0 or (target is None and not (defect[asked] > CLOSED).any())
    if given is None:
        cuts = seam_edges(V, faces, cones if flat else _ends_of_a_slit(V, inner))
    else:
        every = edge_faces(faces)[:, :2]
        cuts = every[among(origin[every], given, len(problem.vertices))]
    layout = unfold(V, faces, cuts)
    size = float(np.linalg.norm(np.ptp(V, axis=0)))
    if given is not None and not opens_to_disks(layout.faces) and layout.gap > CLOSED * size:
        raise CGCError(_no_seam(region))
    if flat and layout.gap > CLOSED * size:
        worst = problem.names.vertices[origin[np.argmax(np.where(asked, defect, 0.0))]]
        raise CGCError(
            f"region {region} does not unroll: its faces leave gaps of up to {layout.gap:.3g} "
            f"({100 * layout.gap / size:.2g} % of its size), most of all at vertex {worst}; "
            "solve it to K = 0 first, on irregular meshes with the measure exact"
        )
    if not flat:
        if not opens_to_disks(layout.faces):
            raise CGCError(_no_seam(region))
        plane = flatten(V[layout.origin], layout.faces).plane[layout.faces]
        gap, error = 0.0, float("nan")
    else:
        plane, gap, error = layout.plane[layout.faces], layout.gap, layout.edge_error
        cuts = cuts[~_close_again(faces, plane, cuts, CLOSED * size)]
    return plane, origin[cuts], Unrolling(region, target, flat, gap, error, len(cuts))


def _ends_of_a_slit(vertices: Vertices, inner: Mask) -> Mask:
    """Mark two vertices far apart on a surface without an open edge, between which it is slit; none on others (n,)."""
    ends = np.zeros(len(vertices), bool)
    if inner.all():
        first = int(np.argmax(np.linalg.norm(vertices - vertices.mean(axis=0), axis=1)))
        ends[[first, int(np.argmax(np.linalg.norm(vertices - vertices[first], axis=1)))]] = True
    return ends


def _no_seam(region: int) -> str:
    return f"region {region} goes round a hole that no seam opens; lead a seam from one open edge to the other, or name none"


def _close_again(faces: IntArray, plane: FloatArray, cuts: Edges, tolerance: float) -> np.ndarray:
    """Tell of which cut edges (s, 2) both sides lie at the same place."""
    edges = edge_faces(faces)
    edges = edges[among(edges[:, :2], cuts, int(faces.max()) + 1)]
    u, v, left, right = edges.T
    apart = np.zeros(len(edges))
    for w in (u, v):
        here, there = (plane[side, np.argmax(faces[side] == w[:, None], axis=1)] for side in (left, right))
        apart = np.maximum(apart, np.linalg.norm(here - there, axis=1))
    together = edges[apart <= tolerance, :2]
    return among(cuts, together, int(faces.max()) + 1)


# ----------------------------------------------------------------------
# Onto sheets
# ----------------------------------------------------------------------


def _flattened(problem: CGCProblem, cuts: Edges, own: Patchwork, piece: int) -> Patchwork:
    """Flatten a curved piece by itself: the whole faces that it has a part of, so that no sliver has a say."""
    faces = own.piece == piece
    parents, position = np.unique(own.parent[faces], return_inverse=True)
    whole = problem.faces[parents]
    edges = edge_faces(whole)
    joined = edges[(edges[:, 3] >= 0) & ~among(edges[:, :2], cuts, len(problem.vertices))]
    opened, origin = cut_open(whole, joined)
    corners = flatten(problem.vertices[origin], opened).plane[opened]
    weights = weights_in(np.repeat(problem.vertices[whole][position], 3, axis=0), own.space[own.faces[faces]].reshape(-1, 3))
    plane = own.plane.copy()
    plane[faces] = np.einsum("fcw,fwk->fck", weights.reshape(-1, 3, 3), corners[position])
    return replace(own, plane=plane)


def _check_fineness(problem: CGCProblem, own: Patchwork, faces: np.ndarray, strain: float, worst: float) -> None:
    """Refuse to cut a piece smaller than the edges of the mesh: it is flattened with the faces that it is of, so that nothing is won.

    Raises
    ------
    ValueError
        With what would help.
    """
    whole = problem.vertices[problem.faces[np.unique(own.parent[faces])]]
    edge = float(np.median(np.linalg.norm(np.roll(whole, -1, axis=1) - whole, axis=2)))
    if np.ptp(own.plane[faces].reshape(-1, 2), axis=0).max() < edge:
        raise ValueError(
            f"region {own.region[faces][0]} would be cut into pieces smaller than the edges of its mesh, {edge:.2g}, for a strain of "
            f"{100 * strain:.2g} %; allow more than {100 * worst:.2g} %, or solve a finer mesh"
        )


def _strains(own: Patchwork, faces: np.ndarray) -> FloatArray:
    """Return the principal strains of faces (k, 2): of every whole face those of its largest part."""
    areas, parents = face_areas(own.space, own.faces[faces]), own.parent[faces]
    order = np.lexsort((-areas, parents, own.piece[faces]))
    key = own.piece[faces].astype(np.int64) * (int(parents.max()) + 1) + parents
    _, first, inverse = np.unique(key[order], return_index=True, return_inverse=True)
    # A part without area is one of a piece's edge, which stretches with the others.
    largest = order[first]
    sound = areas[largest] > NO_AREA * own.size() ** 2
    flat = np.zeros((len(largest), 2))
    flat[sound] = principal_strains(own.space, own.faces[faces][largest[sound]], own.plane[faces][largest[sound]])[0]
    strains = np.empty((len(areas), 2))
    strains[order] = flat[inverse.ravel()]
    return strains


def _on_sheets(own: Patchwork, sheet: Optional[tuple[float, float]], spacing: float) -> tuple[Patchwork, list[int]]:
    """Turn and shift the pieces to their places, and return the sheet of each."""
    count = int(own.piece.max()) + 1
    limits = (np.inf, np.inf) if sheet is None else sheet
    turned, sizes = [], []
    for piece in range(count):
        corners = own.plane[own.piece == piece]
        box = best_box(corners.reshape(-1, 2), limits)
        along = corners @ np.column_stack([box.along, [-box.along[1], box.along[0]]])
        turned.append(along - along.min(axis=(0, 1)))
        sizes.append(tuple(np.ptp(along.reshape(-1, 2), axis=0).tolist()))
    room = sheet or _roll(sizes, spacing)
    places = nest(sizes, room, spacing)
    plane = np.empty_like(own.plane)
    for piece, place in enumerate(places):
        corners = turned[piece]
        if place.turned:
            corners = corners @ np.array([[0.0, 1.0], [-1.0, 0.0]])
            corners = corners - corners.min(axis=(0, 1))
        plane[own.piece == piece] = corners + [place.x, place.y]
    return replace(own, plane=plane), [place.sheet for place in places]


def _roll(sizes: list[tuple[float, float]], spacing: float) -> tuple[float, float]:
    """Return a sheet that has room for all pieces, about square [L]."""
    side = max(max(max(size) for size in sizes), 1.2 * float(np.sqrt(sum(length * width for length, width in sizes))))
    return side, sum(max(size) + spacing for size in sizes)


# ----------------------------------------------------------------------
# What is drawn
# ----------------------------------------------------------------------


def _patterns(
    problem: CGCProblem,
    own: Patchwork,
    on_sheet: list[int],
    unrollings: list[Unrolling],
    sheet: Optional[tuple[float, float]],
    rulings: list[Ruling],
    straightness: dict[int, Straightness],
) -> Patterns:
    loops = outline_loops(own)
    strains = _strains(own, np.ones(len(own.faces), bool))
    areas = face_areas(own.space, own.faces)
    first = np.unique(own.piece, return_index=True)[1]
    largest, in_space = np.zeros(len(loops)), np.bincount(own.piece, areas)
    np.maximum.at(largest, own.piece, np.abs(strains).max(axis=1))
    pieces: list[Piece] = []
    within: dict[int, int] = {}
    for piece, region in enumerate(own.region[first].tolist()):
        within[region] = within.get(region, 0) + 1
        area = sum(signed_area(loop.points) for loop in loops[piece])
        label = f"{_letters(region)}{within[region]}"
        pieces.append(Piece(label, region, on_sheet[piece], loops[piece], area, float(in_space[piece]), float(largest[piece])))
    seams, folds = seams_between(own), _folds(problem, own)
    return Patterns(problem, own, pieces, seams, unrollings, strains, folds, rulings, straightness, sheet)


def _folds(problem: CGCProblem, own: Patchwork) -> FloatArray:
    """Return the angle over every side between two faces of a piece [rad] (m, 3), positive where convex."""
    normals = face_normals(problem.vertices, problem.faces)[own.parent]
    mate = mates(own.faces)
    other = np.maximum(mate, 0) // 3
    inside = (mate >= 0) & ~outline_sides(own) & (own.side != NONE)
    along = np.roll(own.space[own.faces], -1, axis=1) - own.space[own.faces]
    along = along / np.linalg.norm(along, axis=2, keepdims=True)
    sine = np.einsum("ijk,ijk->ij", np.cross(normals[:, None], normals[other]), along)
    cosine = np.einsum("ik,ijk->ij", normals, normals[other])
    return np.where(inside, np.arctan2(sine, cosine), 0.0)


def _letters(number: int) -> str:
    """Return A, B, ..., Z, AA, AB, ..."""
    text = ""
    while number >= 0:
        text = chr(ord("A") + number % 26) + text
        number = number // 26 - 1
    return text


def _number(value: Optional[float]) -> str:
    return "several" if value is None else f"{value:g}"
