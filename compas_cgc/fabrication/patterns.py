"""Patterns: a surface as flat pieces on sheets."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from dataclasses import field
from typing import NamedTuple
from typing import Optional

import numpy as np

from ..discrete import face_areas
from ..discrete import face_normals
from ..discrete.arrays import FloatArray
from ..errors import CGCError
from ..model.counts import counted
from ..model.problem import CGCProblem
from .allowance import widened
from .figures import SHORT
from .figures import in_mm
from .figures import in_square_metres
from .figures import metres
from .figures import two_digits
from .figures import unit_symbol
from .outlines import Loop
from .outlines import Seam
from .outlines import outline_loops
from .outlines import seams_between
from .outlines import signed_area
from .patchwork import NONE
from .patchwork import Patchwork
from .patchwork import mates
from .patchwork import outline_sides
from .piece_checks import remarks
from .piece_strains import strains_of
from .placing import Placed
from .rulings import Ruling
from .rulings import Straightness
from .stock import Stock

__all__ = ["Patterns", "Piece", "Unrolling", "patterns_of", "refuse_others"]


class Unrolling(NamedTuple):
    """Result of unrolling or flattening a region."""

    region: int
    target: Optional[float]  # target K [1/L^2], None if it is not one number
    unrolled: bool  # True if without strain, False if flattened
    gap: float  # largest distance between the positions of a vertex in different faces [L]
    edge_error: float  # largest relative change of an edge length
    seam_edges: int


class Piece(NamedTuple):
    """A flat piece on its sheet."""

    label: str
    region: int
    sheet: int
    loops: list[Loop]  # outline and holes, in the coordinates of the sheet
    area: float  # in the plane [L^2]
    area_in_space: float  # [L^2]
    strain: float  # largest absolute strain; 0 up to rounding if K = 0
    allowance: list[FloatArray]  # (k, 2) cut lines, with allowance and half the kerf, and holes [L]; empty without them


@dataclass(frozen=True, eq=False)
class Patterns:
    """A surface as flat pieces on sheets.

    Node numbers are the vertex keys of the mesh; nodes made by cuts have higher numbers.

    Parameters
    ----------
    problem
        The surface.
    patchwork
        Faces with their positions on the sheets.
    pieces
        Flat pieces on their sheets.
    seams
        Seams between pieces.
    unrollings
        Result of unrolling or flattening, by region.
    strains
        (m, 2) principal strains of the faces.
    folds
        (m, 3) fold angle of every side between two faces of a piece, positive if convex; else 0 [rad].
    rulings
        Rulings of unrolled regions.
    straightness
        Straightness of the rulings, by region.
    stock
        Sheet size, spacing, margin and allowance.
    sheet_sizes
        Length and width of every sheet [L]; empty for unlimited sheets.

    Examples
    --------
    >>> import compas_cgc
    >>> from compas_cgc.fabrication import unroll
    >>> patterns = unroll(compas_cgc.solve(compas_cgc.read(compas_cgc.get("vault.3dm"))), (3.0, 1.5))
    >>> patterns.sheets
    15
    """

    problem: CGCProblem
    patchwork: Patchwork  # faces with their positions on the sheets
    pieces: list[Piece]
    seams: list[Seam]
    unrollings: list[Unrolling]
    strains: FloatArray  # (m, 2) principal strains of the faces
    folds: FloatArray  # (m, 3) fold angle of every side between two faces of a piece, positive if convex; else 0 [rad]
    rulings: list[Ruling]  # of unrolled regions
    straightness: dict[int, Straightness]  # of the rulings, by region
    stock: Stock  # sheet size, spacing, margin and allowance
    sheet_sizes: list[tuple[float, float]] = field(default_factory=list)  # of every sheet [L]; empty for unlimited sheets

    @property
    def sheet(self) -> Optional[tuple[float, float]]:
        """Length and width of the largest sheets [L]; None if unlimited."""
        return self.stock.sheet

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
        """Largest absolute strain of all pieces."""
        return max(piece.strain for piece in self.pieces)

    def summary(self) -> str:
        """Return lines of text with the figures."""
        count, units = len(self.pieces), self.problem.drawing.units
        area, in_space = (in_square_metres(area, units) for area in (self.area, self.area_in_space))
        lines = [
            f"{counted(count, 'piece')}, {counted(len(self.seams), 'seam')}, "
            f"flat area {area} m², area in space {in_space} m² (relative difference {abs(self.area / self.area_in_space - 1.0):.1e})"
        ]
        if self.sheet is not None:
            used = self.area / sum(length * width for length, width in self.sheet_sizes)
            counts = [(self.sheet_sizes.count(size), size) for size in sorted(set(self.sheet_sizes), reverse=True)]
            sheets = ", ".join(f"{counted(count, 'sheet')} of {in_mm(size, units)}" for count, size in counts)
            lines.append(f"{sheets}, {100 * used:.0f} % used")
        if self.stock.stuff:
            lines.append(f"material: {self.stock.stuff}")
        lines.append(self.free)
        lines.append(f"largest length difference between the sides of a seam: {two_digits(1000.0 * metres(units) * self.seam_mismatch)} mm")
        short = [seam for seam in self.seams if seam.length < SHORT / metres(units)]
        if short:
            named = ", ".join(
                f"seam {seam.number} of {' and '.join(self.pieces[k].label for k in seam.pieces)} ({in_mm([seam.length], units)})"
                for seam in short
            )
            lines.append(f"seams shorter than {1e3 * SHORT:g} mm: {named}; panels or sheets of another size move them")
        lines += remarks(self)
        for own in self.unrollings:
            if own.unrolled:
                lines.append(
                    f"region {own.region}: unrolled, gap {own.gap:.2g}, edge error {own.edge_error:.2g}{self._straight(own.region)}"
                )
            else:
                strain = max(piece.strain for piece in self.pieces if piece.region == own.region)
                lines.append(f"region {own.region}: {self._curvature(own.target)}, flattened with strains up to {100 * strain:.2g} %")
        return "\n".join(lines)

    __str__ = summary

    @property
    def free(self) -> str:
        """The distances that are kept free around pieces, as a phrase."""
        free = [(self.stock.spacing or 0.0, "between pieces"), (self.stock.margin, "along edges"), (self.stock.strip, "around pieces")]
        kept = [f"{in_mm([length], self.problem.drawing.units)} {where}" for length, where in free if length]
        return "free: " + (", ".join(kept) or "nothing")

    def _curvature(self, K: Optional[float]) -> str:
        return "several K" if K is None else f"K = {K:g} 1/{unit_symbol(self.problem.drawing.units)}²"

    def _straight(self, region: int) -> str:
        found = self.straightness.get(region)
        if found is None:
            return ""
        return f", rulings deviate from their chords by {100 * found.median:.2g} % (median), {100 * found.largest:.2g} % at most"


def refuse_others(patterns: object, what: str, call: str) -> None:
    """Refuse an object that is not a Patterns object; `what` and `call` name the operation."""
    if not hasattr(patterns, "sheets"):
        raise CGCError(f"{what} from patterns: {call}(unroll(surface)), not from {patterns!r:.60}")


def patterns_of(
    problem: CGCProblem,
    placed: Placed,
    unrollings: list[Unrolling],
    rulings: list[Ruling],
    straightness: dict[int, Straightness],
    names: Sequence[str] = (),
) -> Patterns:
    """Return the patterns of pieces that lie on sheets; pieces have the names given, or a letter for the region and a number."""
    own, on_sheet, sizes, stock = placed
    loops = outline_loops(own)
    strains = strains_of(own, np.ones(len(own.faces), bool))
    areas = face_areas(own.space, own.faces)
    first = np.unique(own.piece, return_index=True)[1]
    largest, in_space = np.zeros(len(loops)), np.bincount(own.piece, areas)
    np.maximum.at(largest, own.piece, np.abs(strains).max(axis=1))
    pieces: list[Piece] = []
    within: dict[int, int] = {}
    for piece, region in enumerate(own.region[first].tolist()):
        within[region] = within.get(region, 0) + 1
        area = sum(signed_area(loop.points) for loop in loops[piece])
        label = names[piece] if names else f"{_letters(region)}{within[region]}"
        strip = widened([loop.points for loop in loops[piece]], stock.strip)
        pieces.append(Piece(label, region, on_sheet[piece], loops[piece], area, float(in_space[piece]), float(largest[piece]), strip))
    seams, folds = seams_between(own), _folds(problem, own)
    return Patterns(problem, own, pieces, seams, unrollings, strains, folds, rulings, straightness, stock, sizes)


def _folds(problem: CGCProblem, own: Patchwork) -> FloatArray:
    """Return the fold angle of every side between two faces of a piece, positive if convex (m, 3) [rad]."""
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
