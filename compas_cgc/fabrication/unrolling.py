"""Unrolling: a surface cut into flat pieces that fit on sheets."""

from __future__ import annotations

from collections.abc import Iterable
from collections.abc import Sequence
from dataclasses import replace
from typing import Optional
from typing import Union

import numpy as np

from ..discrete import edge_faces
from ..discrete.arrays import Edges
from ..errors import CGCError
from ..errors import names_what_was_meant
from ..meshing import path_edges
from ..model.given import checked_number
from ..model.problem import CGCProblem
from ..model.problem import PosesProblem
from .closing import unrollable
from .figures import in_mm
from .figures import metres
from .flattening import flatten
from .layout import among
from .layout import cut_open
from .option_values import truth
from .panelling import Panel
from .patchwork import Patchwork
from .patchwork import weights_in
from .patterns import Patterns
from .patterns import patterns_of
from .piece_strains import strains_of
from .pieces import Box
from .pieces import cut_to_fit
from .placing import extent
from .placing import grain_of
from .placing import on_sheets
from .quarter_turn import turned_pieces
from .regions_in_plane import developed
from .regions_in_plane import developed_panels
from .rows import in_rows
from .rulings import rulings_of
from .sheet_panels import sheet_panels
from .solved import chosen_regions
from .solved import solved_problem
from .stock import Stock
from .stock import stock_of

__all__ = ["unroll"]

MAX_SHEET_RATIO = 20.0  # sheet width over the size of the surface above which the units probably differ
MITRE_ROOMS = (
    1.5,
    2.0,
)  # widths of the strip around pieces that rows leave free at each side: room for mitres of corners from 67, 53 degrees
EDGE_TOLERANCE = 1e-9  # tolerance at the edges of a sheet, relative to it


@names_what_was_meant()
def unroll(
    surface: PosesProblem,
    sheet: Union[tuple[float, float], Sequence[tuple[float, float]], None] = None,
    *,
    panels: Optional[Sequence[Panel]] = None,
    strain: Optional[float] = None,
    seams: Optional[Iterable[Sequence[int]]] = None,
    regions: Optional[Sequence[int]] = None,
    spacing: Optional[float] = None,
    margin: float = 0.0,
    allowance: float = 0.0,
    kerf: float = 0.0,
    grain: Optional[tuple[float, float]] = None,
    shapes: bool = False,
    rulings: Optional[float] = None,
    shortest: float = 100.0,
    material: str = "",
    thickness: float = 0.0,
    whole: Optional[bool] = None,
    rough: bool = False,
) -> Patterns:
    """Return a surface as flat pieces that fit on sheets.

    Regions of K = 0 are unrolled without strain, after a small move to triangles that close around every vertex. Others are cut into
    panels and flattened at least distortion.

    Parameters
    ----------
    surface
        Solved result, mesh or problem; its creases divide it into regions.
    sheet
        Length and width of the sheets [L], or several sizes: pieces are cut for the largest, and every sheet is the smallest that
        holds its pieces. Default: unlimited, so that only seams are cut.
    panels
        Result of :func:`compas_cgc.fabrication.panels`: the pieces. Default: pieces that fit on the sheets.
    strain
        Largest strain of flattened pieces. Default: limited by the sheet only.
    seams
        Paths of vertex keys to cut along. Default: the shortest ones that open every region.
    regions
        Numbers of regions. Default: all.
    spacing
        Distance between pieces on a sheet [L], 0 for edge to edge. Default: 1 % of the sheet width, or of the largest piece on
        unlimited sheets, enough for a saw or router.
    margin
        Free margin along the edges of a sheet [L].
    allowance
        Width of a strip around every piece for welding or sewing [L]. It is drawn as a separate outline and included in nesting.
    kerf
        Width that the tool removes [L]. Cut lines are drawn half of it outside the pieces (inside holes), in the middle of the cut, and the
        pieces as a separate outline. Default: cut lines are the outlines, for machines that correct the path themselves.
    grain
        Direction in plan along the length of the sheets, such as (1, 0) for a grain along x. Default: pieces have any rotation.
    shapes
        Whether to nest true shapes instead of rectangles, with the package spyrrow. The search is limited by time, so that results may
        differ between runs.
    rulings
        Distance between drawn rulings [L], 0 for none. Default: 1/12 of the size of the region, at most a quarter of the sheet
        width.
    shortest
        Length of seams, without creases, below which joints are moved if possible, and named in the report otherwise [mm].
    material, thickness
        Material of the sheets, and their thickness [mm], which are written on every sheet and in the cut list. The pieces have the size
        of the surface, which is the middle of the thickness.
    whole
        Whether to keep the parts between creases and seams whole, so that parts larger than a sheet are refused instead of cut.
        Default: True if panels or seams are given.
    rough
        Whether to accept a surface with the verdict rough, see :class:`compas_cgc.analysis.Verdict`.

    Returns
    -------
    Patterns

    Raises
    ------
    CGCError
        If the surface is rough, a region of K = 0 does not unroll, seams do not open a region, a region does not exist, the sheet
        is invalid, or a whole panel is larger than a sheet.

    Examples
    --------
    >>> import compas_cgc
    >>> patterns = unroll(compas_cgc.solve(compas_cgc.read(compas_cgc.get("vault.3dm"))), (3.0, 1.5))
    >>> len(patterns.pieces), patterns.sheets
    (20, 15)
    """
    kept = (seams is not None or panels is not None) if whole is None else truth(whole, "whole")
    if seams is not None and panels is not None:
        raise CGCError("give panels or seams, not both; the joints of panels are the seams")
    problem = unrollable(solved_problem(surface, rough))
    stock = stock_of(sheet, spacing, margin, allowance, grain, kerf, material, thickness)
    _check_scale(problem, stock)
    if rulings is not None and checked_number(rulings, "rulings") < 0:
        raise CGCError(f"the distance between rulings must be positive, or 0 for none, not {rulings:g}")
    paths: object = seams
    if paths is not None and (isinstance(paths, str) or not isinstance(paths, Iterable)):
        raise CGCError(f"seams must be paths of vertices, such as [[4, 12, 20]], not {seams!r:.60}")
    if strain is not None and not checked_number(strain, "strain") > 0:
        raise CGCError(f"the largest strain must be positive, such as 0.002, not {strain:g}")
    given = None if seams is None else _given_seams(problem, seams)
    chosen = chosen_regions(problem, regions)
    flat, cuts, unrollings = developed(problem, chosen, given) if panels is None else developed_panels(problem, panels, chosen)
    names = [panel.name for panel in panels or () if panel.region in chosen]
    curved = {own.region for own in unrollings if not own.unrolled}

    def flattened(own: Patchwork, piece: int) -> Patchwork:
        return _flattened(problem, cuts, own, piece) if own.region[own.piece == piece][0] in curved else own

    def too_wide(own: Patchwork, piece: int) -> bool:
        faces = own.piece == piece
        if strain is None or own.region[faces][0] not in curved:
            return False
        worst = float(np.abs(strains_of(own, faces)).max())
        if worst > strain:
            _check_fineness(problem, own, faces, strain, worst)
        return worst > strain

    def taken(own: Patchwork, piece: int) -> np.ndarray:
        return extent(own, piece, stock.strip)

    def along(own: Patchwork, piece: int) -> np.ndarray:
        return grain_of(own, piece, stock.grain or (1.0, 0.0))

    def refuse(own: Patchwork, piece: int, box: Box) -> None:
        if kept:
            _refuse_to_cut(problem, stock, own, piece, box)

    def cut(own: Patchwork) -> Patchwork:
        return cut_to_fit(own, room, flattened, too_wide, taken, refuse, None if grain is None else along, least)

    def in_fitting_rows(whole_parts: Patchwork) -> Patchwork:
        grains = None if grain is None else np.array([along(whole_parts, piece) for piece in range(int(whole_parts.piece.max()) + 1)])
        turned = None if grains is not None else turned_pieces(whole_parts, problem)
        tried = list[Patchwork]()
        for mitre in MITRE_ROOMS:
            inside = room[0] - 2.0 * mitre * stock.strip, room[1] - 2.0 * mitre * stock.strip
            rows = in_rows(whole_parts, inside, (stock.spacing or 0.0) + 2.0 * stock.strip, least, grains, turned)
            tried.append(cut(rows))
            # Sharp mitres need more room where rows had to be cut again.
            if tried[-1].piece.max() == rows.piece.max():
                break
        return min(tried, key=lambda own: int(own.piece.max()))

    room = stock.room[0] * (1 - EDGE_TOLERANCE), stock.room[1] * (1 - EDGE_TOLERANCE)
    least = 1e-3 * checked_number(shortest, "shortest") / metres(problem.drawing.units)
    try:
        divided = stock.sheet is not None and not kept and panels is None
        gridded = divided and len(curved) == len(chosen) and seams is None
        if gridded:
            panels = sheet_panels(problem, chosen, stock, shortest, taken, too_wide, cut)
            flat, cuts, unrollings = (flat, cuts, unrollings) if panels is None else developed_panels(problem, panels, chosen)
        own = on_sheets(in_fitting_rows(flat) if divided and not gridded else cut(flat), stock, truth(shapes, "shapes"))
    except ValueError as error:
        raise CGCError(str(error)) from None
    ruled = [one.region for one in unrollings if one.unrolled] if rulings != 0 else []
    lines, straightness = rulings_of(problem, own.patchwork, ruled, rulings, np.inf if stock.sheet is None else 0.25 * stock.sheet[1])
    # Pieces of another division than the panels of a mould report need other names.
    return patterns_of(problem, own, unrollings, lines, straightness, names if len(names) == len(own.sheets) else ())


def _check_scale(problem: CGCProblem, stock: Stock) -> None:
    """Refuse sheets, spacings, margins and allowances that are probably in other units than the surface."""
    size = float(np.linalg.norm(np.ptp(problem.vertices, axis=0)))
    units = (problem.drawing.units or "units of the model").lower()
    sheet = stock.sheet
    if sheet is not None and sheet[1] > MAX_SHEET_RATIO * size:
        raise CGCError(
            f"a sheet of {sheet[0]:g} x {sheet[1]:g} {units} is far larger than the surface, whose size is {size:.3g}; add its unit, "
            f"such as {sheet[0]:g}x{sheet[1]:g}mm"
        )
    for what in ("spacing", "margin", "allowance", "kerf"):
        length = getattr(stock, what) or 0.0
        if length > size:
            raise CGCError(f"the {what} of {length:g} {units} is larger than the surface, whose size is {size:.3g}; give it in {units}")


def _given_seams(problem: CGCProblem, seams: Iterable[Sequence[int]]) -> Edges:
    edges = np.array(path_edges([problem.positions(path).tolist() for path in seams]), dtype=np.int64).reshape(-1, 2)
    lost = ~among(edges, edge_faces(problem.faces)[:, :2], len(problem.vertices))
    if lost.any():
        u, v = problem.names.vertices[edges[np.argmax(lost)]].tolist()
        raise CGCError(f"the seam from vertex {u} to {v} does not follow an edge; define it along edges of the mesh")
    return edges


def _flattened(problem: CGCProblem, cuts: Edges, own: Patchwork, piece: int) -> Patchwork:
    """Flatten a curved piece by its whole mesh faces, so that slivers do not matter."""
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


def _refuse_to_cut(problem: CGCProblem, stock: Stock, own: Patchwork, piece: int, box: Box) -> None:
    """Refuse to cut a whole panel.

    Raises
    ------
    ValueError
        With its size, the sheet size and a remedy.
    """
    faces, units = own.piece == piece, problem.drawing.units
    panel = f"the panel of region {own.region[faces][0]} at vertex {own.names[own.faces[faces][0, 0]]}"
    if stock.sheet is not None and box.parts > 1:
        free = "" if stock.room == stock.sheet else f" (usable: {in_mm(stock.room, units)})"
        why = f"needs {in_mm((box.length, box.width), units)}, more than a sheet of {in_mm(stock.sheet, units)}{free}; use larger sheets,"
    else:
        why = "overlaps itself in the plane, or exceeds the allowed strain;"
    raise ValueError(f"{panel} {why} divide it by a crease or a seam, or do not keep panels whole")


def _check_fineness(problem: CGCProblem, own: Patchwork, faces: np.ndarray, strain: float, worst: float) -> None:
    """Refuse to cut pieces smaller than mesh edges: they are flattened by whole faces, so that cutting does not reduce the strain.

    Raises
    ------
    ValueError
        With a remedy.
    """
    whole = problem.vertices[problem.faces[np.unique(own.parent[faces])]]
    edge = float(np.median(np.linalg.norm(np.roll(whole, -1, axis=1) - whole, axis=2)))
    if np.ptp(own.plane[faces].reshape(-1, 2), axis=0).max() < edge:
        raise ValueError(
            f"region {own.region[faces][0]} needs pieces smaller than its mesh edges ({edge:.2g}) for a strain of "
            f"{100 * strain:.2g} %; allow more than {100 * worst:.2g} %, or solve a finer mesh"
        )
