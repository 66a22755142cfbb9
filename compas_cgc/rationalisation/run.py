"""From a freeform design to a handful of moulds."""

from __future__ import annotations

from collections.abc import Mapping
from collections.abc import Sequence
from dataclasses import replace
from typing import Optional
from typing import Union

import numpy as np
from numpy.typing import ArrayLike
from scipy.spatial import cKDTree

from ..datastructures import SolveResult
from ..discrete import boundary_vertices
from ..discrete import face_areas
from ..discrete.arrays import FloatArray
from ..discrete.arrays import Mask
from ..errors import CGCError
from ..errors import MeshError
from ..errors import names_what_was_meant
from ..meshing import named_supports
from ..meshing.polyline import nearest_on_polyline
from ..meshing.regions import inner_labels
from ..model.counts import counted
from ..model.given import refuse_other_units
from ..model.problem import CGCProblem
from ..model.result import History
from ..model.result import Solution
from ..solvers.projection import ProjectionSettings
from ..solvers.run import solve
from .assignment import DONE
from .assignment import Placed
from .assignment import catalogue
from .costs import Allowance
from .costs import Costs
from .costs import costs_of
from .design import Design
from .design import DesignInput
from .design import read_design
from .importance import importance_at
from .mould_choice import MAX_MOULDS
from .mould_choice import MouldsInput
from .mould_choice import Wanted
from .mould_choice import best_moulds
from .normal_moves import NormalMoves
from .panelling import Panelling
from .progress import Progress
from .progress import Stop
from .progress import Watch
from .progress import part_of
from .result import Rationalised
from .seams import LEVELS
from .seams import SeamsInput
from .seams import panels_of
from .smooth_moves import smoothed
from .symmetry import symmetric_panels

__all__ = ["Progress", "rationalise"]

MAX_PANELS_ALONG = 1000  # along the size of a design
MAX_WITHIN_RATIO = 0.1  # distance that is to be kept, relative to the size
MAX_RADIUS_RATIO = 100.0  # of radii of moulds and the size; a sphere of this radius deviates from a plane by 1/800 of the size
FIT_PART = 0.1  # of the distance that is to be kept, within which a surface is fitted to a mesh by default


@names_what_was_meant()
def rationalise(
    design: DesignInput,
    *,
    moulds: MouldsInput = 4,
    panel: Optional[float] = None,
    seams: SeamsInput = None,
    within: Optional[float] = None,
    flat: Optional[bool] = None,
    supports: Union[str, Sequence[Sequence[float]], None] = None,
    edges: Optional[int] = None,
    tolerance: Optional[float] = None,
    locked: Optional[Mapping[int, int]] = None,
    costs: Optional[Mapping[str, Sequence[float]]] = None,
    weights: ArrayLike = (),
    callback: Watch = None,
) -> Rationalised:
    """Return the surface with panels from few moulds that is nearest to a freeform design.

    Seams divide the design into panels. Every panel is assigned one of a few values of K, and the surface with exactly these K is
    solved. The values and the assignment minimise the distance of this surface from the design.

    If this surface is rough, a smoother one with the same values of K is sought. It is returned if it is fair and stays within the allowed
    distance, although its largest distance may be larger.

    Parameters
    ----------
    design
        A NURBS surface (:class:`~compas_cgc.rationalisation.SplineSurface`), the path of a file, a COMPAS mesh, or vertices and
        faces.
    moulds
        Number of moulds, or the radii of existing moulds: positive for spheres, negative for saddles, ``inf`` for flat sheets [L].
        With 1, all panels are flat sheets. None: the fewest moulds with which the distance does not exceed ``within``.
    panel
        Width of the panels [L]. Default: a twelfth of the longer side.
    seams
        ``"grid"`` along the parameters of a surface or the plan of a mesh; ``"curvature"`` along lines of curvature, or
        ``"geodesics"``, one panel apart; ``"levels"`` along level lines of K, which gives few regions; several numbers of
        levels are tried, and the surface nearest to the design is returned; ``"faces"`` between the faces of a
        quad mesh; or points (k, 3) along curves on the design. Default: the seams drawn in the file, otherwise the grid.
    within
        Largest distance from the design that is allowed [L], including the deviation of the smooth surface fitted to a mesh.
    flat
        Whether one of the moulds is flat, K = 0. Default: the choice with the smaller distance from the design.
    supports
        Points (k, 3) that are held; ``"corners"``, ``"boundary"`` or ``"none"``. Default: those of the design, else the corners.
    edges
        Edges of the mesh along the side of a panel. Default: four, or more if there are few panels.
    tolerance
        Largest distance between a mesh and the smooth surface fitted to it [L]. Default: as in :func:`read_design`, or less, a tenth of
        ``within``.
    locked
        Panels that keep a given mould: a dict from the number of the panel to the position of the mould in the radii.
    costs
        Pairs of costs, of a mould and of a panel made on it, for ``"flat"``, ``"sphere"`` and ``"saddle"`` moulds, in
        any currency. With ``within``, the cheapest surface within this distance is found, with at most ``moulds`` moulds. Otherwise
        costs are reported and do not influence the result. Existing moulds cost nothing.
    weights
        Rows (k, 5) of x, y, z, radius, factor: within this radius of the point [L], distances and folds are multiplied by the factor, also
        in the comparison with ``within``. Where places overlap, the last one applies.
    callback
        Called with a :class:`Progress` after every round; return True or raise ``StopIteration`` to stop with the best surface so
        far.

    Returns
    -------
    Rationalised
        If the distance exceeds ``within``, the result contains a suggestion.

    Raises
    ------
    CGCError
        If the design cannot be read, or an argument is wrong.

    References
    ----------
    Eigensatz, Kilian, Schiftner, Mitra, Pottmann, Pauly, *Paneling architectural freeform surfaces*, SIGGRAPH 2010,
    doi:10.1145/1778765.1778782.

    Examples
    --------
    >>> import numpy as np
    >>> from compas_cgc.rationalisation import rationalise
    >>> x, y = np.meshgrid(np.linspace(-6, 6, 25), np.linspace(-4, 4, 17), indexing="ij")
    >>> vertices = np.column_stack([x.ravel(), y.ravel(), (2 - 0.03 * x**2 - 0.05 * y**2).ravel()])
    >>> quads = [[i * 17 + j, i * 17 + 17 + j, i * 17 + 18 + j, i * 17 + 1 + j] for i in range(24) for j in range(16)]
    >>> found = rationalise((vertices, quads), panel=2.0, moulds=2)
    >>> found.status, len(found.classes), found.distance.largest < 0.02
    ('kept', 24, True)
    """
    for name, value in (("panel", panel), ("within", within)):
        if value is not None and not (np.isfinite(value) and value > 0.0):
            raise CGCError(f"{name} must be a length above zero, in the units of the design, not {value!r}")
    read = read_design(design, tolerance=tolerance, finest=None if within is None else FIT_PART * within)
    _check_scale(read, panel, within, moulds)
    by_levels = isinstance(seams, str) and seams == "levels"
    if locked and by_levels:
        raise CGCError("panels between level lines are found anew in every run and cannot be locked; give the seams as curves")
    numbers = LEVELS if by_levels else LEVELS[:1]
    found, failed = list[Rationalised](), list[MeshError]()
    stop = Stop(callback)
    prices = None if costs is None else costs_of(costs)
    if prices is not None and not (moulds is None or isinstance(moulds, (int, np.integer))):
        prices = prices._replace(mould=np.zeros_like(prices.mould))
    for past, levels in enumerate(numbers):
        try:
            panelling = panels_of(read, panel, edges, seams, levels)
        except MeshError as error:
            failed.append(error)
            continue
        fixed = _fixed(read, panelling, supports)
        # Locked panels may be on other moulds than their images.
        groups = None if locked else symmetric_panels(panelling, fixed)
        moves = NormalMoves(panelling, fixed, groups=groups, importance=importance_at(panelling.vertices, weights))
        allowance = None if within is None else _allowance(moves, within, read.deviation, prices)
        best = best_moulds(moves, Wanted(moulds, flat, locked, allowance), part_of(stop.shown, past, len(numbers)))
        curvatures, classes = np.unique(best.assigned.K[moves.groups], return_inverse=True)
        problem = _problem(read, panelling, moves, fixed, best.assigned.K)
        own = Rationalised(
            _solved(problem, moves, best), curvatures, classes, panelling, read, within, stop.stopped, "", prices, moves.importance
        )
        if not (own.result.converged and own.result.verdict.fair) and not stop.stopped:
            smooth = smoothed(moves, best, problem)
            if np.isfinite(smooth.norm):
                other = replace(own, result=_solved(problem, moves, smooth))
                own = min(own, other, key=lambda each: (own.kept and not each.kept, *_rank(each, moulds is None)))
        if within is not None and not own.kept and not stop.stopped:
            own = replace(own, suggestion=_suggestion(own, within, min(_most(moulds), moves.panels)))
        if not own.result.converged and not stop.stopped:
            own = replace(own, suggestion=_too_wide(panelling, read))
        found.append(own)
        if stop.stopped:
            break
    if not found:
        raise failed[0]
    return min(found, key=lambda own: _rank(own, moulds is None))


def _rank(found: Rationalised, fewest: bool) -> tuple[bool, bool, bool, float, int, float]:
    """Return the sort key of a surface, best first: with its K, fair, within the distance, costs, number of moulds, distance."""
    converged, fair = found.result.converged, found.result.verdict.fair
    cheapest = found.within is not None and found.costs is not None
    cost = sum(found.costs_of_parts) if cheapest else 0.0
    return not converged, not fair, (fewest or cheapest) and not found.kept, cost, len(found.curvatures) if fewest else 0, found.farthest


def _check_scale(design: Design, panel: Optional[float], within: Optional[float], moulds: MouldsInput) -> None:
    """Refuse widths of panels, distances and radii that are probably in other units than the design."""
    size, unit = design.surface.size, (design.drawing.units or "units of the design").lower()
    if panel is not None:
        refuse_other_units("the width of panels", panel, size, design.drawing.units)
        if size > MAX_PANELS_ALONG * panel:
            raise CGCError(
                f"panels of {panel:g} {unit} would divide the design, whose size is {size:.3g} {unit}, more than {MAX_PANELS_ALONG} times; "
                f"give their width in {unit}, {size / MAX_PANELS_ALONG:.2g} or more"
            )
    if within is not None and within > MAX_WITHIN_RATIO * size:
        raise CGCError(
            f"a distance of {within:g} {unit} is more than a tenth of the design, whose size is {size:.3g} {unit}; give within in {unit}"
        )
    if moulds is None or isinstance(moulds, (int, np.integer)):
        return
    for K in catalogue(moulds):
        radius = abs(K) ** -0.5 if K else size
        if not size / MAX_RADIUS_RATIO <= radius <= MAX_RADIUS_RATIO * size:
            raise CGCError(
                f"a mould of radius {radius:g} {unit} does not fit a design of size {size:.3g} {unit}; give radii in {unit}, inf for flat"
            )


def _fixed(design: Design, panelling: Panelling, supports: Union[str, Sequence[Sequence[float]], None]) -> Mask:
    """Return the vertices that are held (n,)."""
    V, F = panelling.vertices, panelling.faces
    fixed = np.zeros(len(V), bool)
    if isinstance(supports, str) or (supports is None and not design.supports):
        name = "corners" if supports is None else supports
        if name not in ("corners", "boundary", "none"):
            raise CGCError(f"supports must be points, 'corners', 'boundary' or 'none', not {name!r}")
        if name != "none" and boundary_vertices(V, F).any():
            fixed[named_supports(V, F, name)] = True
        return fixed if fixed.any() else _three_apart(panelling)
    places = design.supports if supports is None else tuple(np.asarray(supports, dtype=np.float64).reshape(-1, 1, 3))
    edge = float(np.median(np.linalg.norm(V[F[:, 0]] - V[F[:, 1]], axis=1)))
    tree = cKDTree(V)
    for line in places:
        if len(line) > 1 and np.linalg.norm(np.ptp(line, axis=0)) > edge:
            fixed[nearest_on_polyline(V, line)[0] <= 0.5 * edge] = True
        else:
            fixed[tree.query(line)[1]] = True
    return fixed


def _three_apart(panelling: Panelling) -> Mask:
    """Mark three vertices on seams or the rim that are far apart, which hold a design without supports in its place (n,)."""
    V = panelling.vertices
    candidates = np.flatnonzero(inner_labels(len(V), panelling.faces, panelling.panels) < 0)
    points = V[candidates]
    first = int(np.argmax(np.linalg.norm(points - points.mean(axis=0), axis=1)))
    gap = np.linalg.norm(points - points[first], axis=1)
    second = int(np.argmax(gap))
    third = int(np.argmax(np.minimum(gap, np.linalg.norm(points - points[second], axis=1))))
    fixed = np.zeros(len(V), bool)
    fixed[candidates[[first, second, third]]] = True
    return fixed


def _allowance(moves: NormalMoves, within: float, deviation: float, costs: Optional[Costs]) -> Allowance:
    """Return the allowed distances, reduced by the weighted deviation of the surface fitted to a mesh.

    Where this deviation alone exceeds the distance, also at a vertex that is held, no surface keeps it.
    """
    limits = within - deviation * moves.importance
    limits = limits[moves.columns] if (limits >= 0.0).all() else np.full(len(moves.columns), -np.inf)
    return Allowance(limits, np.bincount(moves.groups, minlength=moves.panels), costs)


def _problem(design: Design, panelling: Panelling, moves: NormalMoves, fixed: Mask, K: FloatArray) -> CGCProblem:
    """Return the design as a problem with the K (p,) of its panels."""
    targets = np.full(len(panelling.vertices), np.nan)
    targets[moves.rows] = K[moves.panel_of_row]
    problem = CGCProblem(panelling.vertices, panelling.faces, targets=targets, creases=panelling.seams, drawing=design.drawing)
    return problem.with_supports(np.flatnonzero(fixed).tolist())


def _solved(problem: CGCProblem, moves: NormalMoves, done: Placed) -> SolveResult:
    """Return an assignment with its surface as the result of a solve; it is solved further only where it has not reached its K."""
    vertices, error = moves.shape(done.moves), moves.error(done.moves, done.assigned.K)
    problem = problem.with_vertices(vertices)
    settings = ProjectionSettings(keep="shape", measure="exact")
    if error > DONE:
        return solve(problem, method="projection", settings=settings)
    largest = error / moves.size**2
    ending = f"converged: the largest error of K is {largest:.3g}"
    solution = Solution(vertices, "converged", ending, 0, 0.0, largest, History.from_rows([]), "projection", "exact")
    return SolveResult.from_solution(problem, solution, settings)


def _most(moulds: MouldsInput) -> int:
    """Return the largest number of moulds that is tried."""
    if moulds is None:
        return MAX_MOULDS
    return int(moulds) if isinstance(moulds, (int, np.integer)) else len(moulds)


def _too_wide(panelling: Panelling, design: Design) -> str:
    """Return what to change where no surface with the K of the moulds was found near a design."""
    width = float(np.sqrt(face_areas(panelling.vertices, panelling.faces).sum() / panelling.panel_count))
    bends = np.abs(design.surface.principal(panelling.parameters)[0]).max(axis=1)
    # At poles, and where a mesh folds, the curvature is unbounded.
    angle = np.degrees(width * float(np.quantile(bends, 0.95)))
    return (
        f"no surface with these K was found near the design, which bends by {angle:.0f} degrees across a panel in places; "
        f"try panels narrower than {width:.2g}, more moulds, or a smoother design"
    )


def _suggestion(found: Rationalised, within: float, tried: int) -> str:
    """Return what to change so that a distance is kept: distances go about as the width of panels squared, and as one over moulds."""
    fitted, weighted = found.weighted_deviation, "weighted " if found.weighted else ""
    of_fit = f" (of which {fitted:.2g} is the deviation of the surface fitted to the mesh)" if fitted > 0.0 else ""
    if fitted >= within:
        return (
            f"the {weighted}distance of the mesh from the surface fitted to it is up to {fitted:.2g}, more than {within:.3g}; "
            f"try tolerance={FIT_PART * within * found.design.deviation / fitted:.2g}"
        )
    ratio = (found.farthest - fitted) / (within - fitted)
    moulds = max(int(np.ceil(len(found.curvatures) * ratio)), tried + 1)
    return (
        f"the {weighted}distance of up to {found.farthest:.3g}{of_fit} exceeds {within:.3g}, "
        f"and no smaller one was found with up to {counted(tried, 'mould')}; "
        f"try {moulds} moulds, or panels narrower by a factor of {np.ceil(20.0 * np.sqrt(ratio)) / 20.0:.3g}"
    )
