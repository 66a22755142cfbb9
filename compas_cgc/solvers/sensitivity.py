"""What a little more K, or of the constant of another law, does to a solved surface."""

from __future__ import annotations

from collections.abc import Mapping
from collections.abc import Sequence
from dataclasses import dataclass
from dataclasses import replace
from functools import partial
from typing import Callable
from typing import Optional

import numpy as np
from scipy.sparse.linalg import LinearOperator
from scipy.sparse.linalg import gmres

from ..datastructures import SolveResult
from ..discrete import vertex_normals
from ..discrete.arrays import FloatArray
from ..discrete.arrays import IntArray
from ..discrete.jacobian import CurvatureEquations
from ..discrete.smooth_measure import layout_errors
from ..discrete.space_form import EXACT
from ..errors import CGCError
from ..errors import ProblemError
from ..errors import names_what_was_meant
from ..linalg import factorise
from ..model.goals import measures
from ..model.goals.binding import DIFFERENCE_STEP
from ..model.goals.binding import bind
from ..model.goals.binding import support_height
from ..model.goals.binding import unknown_constants
from ..model.goals.binding import without_constants
from ..model.laws import ConstantCurvature
from ..model.laws import Law
from ..model.measures import is_held_along_edges
from ..model.measures import read_across
from ..model.problem import CGCProblem
from ..model.roles import FIXED
from ..model.tolerances import ROUNDING
from .between_lines import moves_of_lines
from .constants import CONVERGED
from .constants import ELSEWHERE
from .constants import KRYLOV
from .projection.settings import ProjectionSettings
from .settings import Settings

__all__ = ["Sensitivity", "sensitivity"]

# Of units that files name: a smaller one that designers speak of, and how many of it make one.
_SMALLER = {"Meters": ("mm", 1e3), "Centimeters": ("mm", 10.0), "Millimeters": ("mm", 1.0), "Feet": ("in", 12.0), "Inches": ("in", 1.0)}
NEARER = 3  # Newton's steps to the exact minimum; a solve ends within 1e-7 of it, and two steps reach rounding level
REFINED = 4  # restarts of GMRES; systems that are not solved after 240 directions have no reliable derivative
PRECISE = 1e-7  # relative residual of GMRES; three digits more than the sensitivities are printed with

Moves = Callable[[FloatArray], FloatArray]  # of the vertices (n, 3), to first order, by a change of K (k,)


@dataclass(frozen=True, eq=False)
class Sensitivity:
    """Derivatives of a solved surface by the constants of its regions: K, or that of another law, such as h of H = h.

    Parameters
    ----------
    regions
        ``(r,)`` numbers of the regions in which a law is prescribed.
    targets
        ``(r,)`` their K [1/L^2], or the constants of their other laws.
    moves
        ``(r, n, 3)`` dx/dK of every vertex [L^3], of other laws per unit of their constants.
    height
        ``(r,)`` dz/dK of the highest vertex [L^3].
    volume
        ``(r,)`` dV/dK of the volume over the mean height of the supports [L^5].
    area
        ``(r,)`` dA/dK of the area [L^4].
    laws
        ``(r,)`` laws of the regions.
    units
        Unit system of the drawing, None where it has none.
    """

    regions: tuple[int, ...]
    targets: FloatArray
    moves: FloatArray
    height: FloatArray
    volume: FloatArray
    area: FloatArray
    size: float
    laws: tuple[Law, ...]
    units: Optional[str] = None

    def sentences(self) -> list[str]:
        """Return a sentence for every region, such as ``1 % more K in region 0 lifts the crown by 12 mm``."""
        return [self._sentence(number) for number in range(len(self.regions))]

    def __str__(self) -> str:
        return "; ".join(self.sentences())

    def to_dict(self) -> dict:
        """Return the derivatives by region without those of single vertices, ready for JSON."""
        columns = {name: getattr(self, name).tolist() for name in ("targets", "height", "volume", "area")}
        return {"regions": list(self.regions), **columns, "sentences": self.sentences()}

    def _sentence(self, number: int) -> str:
        c, law = float(self.targets[number]), self.laws[number]
        more, name = 0.01 * law.scale(self.size**2), law.constant_name
        what = f"1 % more {name}" if c > 0 else f"1 % more negative {name}" if c < 0 else f"{more:.3g} more {name}"
        lift = float(self.height[number]) * (-more if c < 0 else more)
        where = "" if len(self.regions) == 1 else f" in region {self.regions[number]}"
        if abs(lift) <= ROUNDING * self.size:
            return f"{what}{where} does not move the crown"
        unit, factor = _SMALLER.get(self.units or "", ("", 1.0))
        amount = f"{abs(lift) * factor:.3g} {unit}".rstrip() if unit else f"{abs(lift):.3g}"
        return f"{what}{where} {'lifts' if lift > 0 else 'lowers'} the crown by {amount}"


@names_what_was_meant()
def sensitivity(result: SolveResult) -> Sensitivity:
    r"""Return the derivatives of a surface, its height, volume and area by K of each region, or by the constant of its law.

    For the methods ``bending`` and ``projection``, they follow from the optimality system of the fairest surface,

    .. math:: \begin{pmatrix} H & J^T \\ J & 0 \end{pmatrix} \begin{pmatrix} dx \\ d\lambda \end{pmatrix}
              = \begin{pmatrix} \lambda_i \nabla A_i \\ A_i \end{pmatrix} dK,

    which is factorised once for all regions; H is the second derivative of the Lagrangian, including that of angles and areas. For
    Newton's method, they follow from moves along the normals. If creases and free edges were computed first, by bending, the moves of
    these are included. In the smooth measure, the change of the layout error is computed by finite differences.

    The relative error of the derivatives of the fairest surface is about 1e-8. In the smooth measure, the projection returns a surface
    slightly different from the fairest one; the results of solves with other K then differ from the derivatives by about 3e-4.
    Constraints on the positions of vertices stay satisfied, and vertices on a bound stay on it. The Lagrange multipliers of goals of the
    whole surface are held constant, so the values of these goals may change.

    Parameters
    ----------
    result
        A converged result of the method ``bending``, ``projection`` or ``newton``.

    Returns
    -------
    Sensitivity
        The derivatives of the vertices and of height, volume and area by each K; ``str`` returns a few sentences.

    Raises
    ------
    ProblemError
        If the result is not converged, or is the result of another method.

    References
    ----------
    Fiacco, *Introduction to Sensitivity and Stability Analysis in Nonlinear Programming*, 1983, chapter 3.

    Examples
    --------
    >>> import compas_cgc
    >>> result = compas_cgc.solve(compas_cgc.read(compas_cgc.get("vault.3dm")))
    >>> print(compas_cgc.sensitivity(result)) # doctest: +ELLIPSIS
    0.000177 more K does not move the crown
    """
    if not isinstance(result, SolveResult):
        raise CGCError(f"sensitivity requires a solved surface: sensitivity(solve(mesh)), not {result!r:.60}")
    if not result.converged:
        raise ProblemError([f"the surface is {result.status}, not converged; derivatives by K exist only for a converged surface"])
    if result.method not in ("bending", "projection", "newton"):
        raise ProblemError([f"derivatives are not available for the method {result.method}; solve with the method bending"])
    problem = result.problem
    label = problem.regions()
    groups = {region: np.flatnonzero(problem.region_vertices(region) & problem.asked) for region in range(int(label.max(initial=-1)) + 1)}
    numbers = [region for region, group in groups.items() if len(group) or _law_constant(problem, region) is not None]
    groups = {region: groups[region] for region in numbers}
    laws = tuple(problem.laws.get(region) or ConstantCurvature(float(problem.targets[groups[region]].mean())) for region in numbers)
    if result.method == "bending":
        found = _by_bending(result, numbers)
    elif result.method == "newton":
        found = _by_newton(problem, groups, result.measure == "smooth", _of_lines(result, numbers))
    else:
        found = _by_projection(result, groups)
    moves = np.array([found[region] for region in numbers]).reshape(-1, len(problem.vertices), 3)
    x, faces = problem.vertices, problem.faces
    level = support_height(problem) if (problem.roles == FIXED).any() else 0.0
    top = int(np.argmax(x[:, 2]))
    return Sensitivity(
        tuple(numbers),
        np.array([law.constant for law in laws], dtype=np.float64),
        moves,
        moves[:, top, 2],
        np.einsum("rnx,nx->r", moves, measures.volume_gradient(x, faces, level)),
        np.einsum("rnx,nx->r", moves, measures.area_gradient(x, faces)),
        float(np.sqrt(measures.area(x, faces))),
        laws,
        problem.drawing.units,
    )


def _law_constant(problem: CGCProblem, region: int) -> Optional[float]:
    """Return the constant of the law of a region other than constant K, None without any."""
    return problem.laws[region].constant if region in problem.laws else None


def _by_bending(result: SolveResult, regions: Sequence[int]) -> dict[int, FloatArray]:
    """Return the derivatives by the constants of regions of the surface that bends and folds least."""
    from .polish.derivatives import moves_by_constants
    from .polish.settings import PolishSettings

    settings = result.settings if isinstance(result.settings, PolishSettings) else PolishSettings()
    return moves_by_constants(_drawn(result), settings, result.vertices, regions)


def _of_lines(result: SolveResult, regions: Sequence[int]) -> Optional[dict[int, FloatArray]]:
    """Return dx/dK of the surface on which creases and free edges were found, None for results without such lines."""
    if not is_held_along_edges(result.problem):
        return None
    drawn, lines = _drawn(result), ~result.problem.asked
    settings = result.settings if isinstance(result.settings, Settings) else None
    return moves_of_lines(drawn, regions, settings) if (drawn.vertices != result.vertices)[lines].any() else None


def _drawn(result: SolveResult) -> CGCProblem:
    """Return the drawing of a result, with the unknown K that were found."""
    if result.start is None:
        raise ProblemError(["the drawing of this result is not known; solve it again"])
    drawn = result.problem.with_vertices(result.start)
    # Goals that unknown constants meet push nothing.
    return without_constants(drawn) if unknown_constants(drawn) else drawn


def _by_newton(
    problem: CGCProblem, groups: Mapping[int, np.ndarray], smooth: bool, begun: Optional[dict[int, FloatArray]]
) -> dict[int, FloatArray]:
    """Return dx/dK by region: given moves (n, 3) of the lines, and moves of the other vertices along their normals."""
    local, frame = problem.local()
    if smooth:
        local = replace(local, faces=read_across(local))
    asked = np.flatnonzero(local.asked)
    equations = CurvatureEquations(local.faces, local.targets, asked, asked)
    normals = vertex_normals(local.vertices, local.faces)[asked]
    residual, areas = equations.measure(local.vertices)
    # In another measure than that of defects these are met by other targets, of which the derivatives are told.
    equations.targets = local.targets.copy()
    equations.targets[asked] += residual / areas
    factor = factorise(equations.jacobian(local.vertices, normals))
    by_all = CurvatureEquations(local.faces, equations.targets, asked, np.arange(len(local.vertices))).jacobian(local.vertices)
    still = np.zeros_like(local.vertices)

    def moves(change: FloatArray, first: FloatArray = still) -> FloatArray:
        """Return the moves (n, 3), including given ones, that change K by given amounts (k,)."""
        moved = first.copy()
        moved[asked] += factor.solve(areas * change - by_all @ first.ravel())[:, None] * normals
        return moved

    change_of = partial(_layout_change, local.vertices, local.faces, asked)
    respond = _with_layout(moves, change_of) if smooth else moves
    found = {}
    for region, own in groups.items():
        change = np.isin(asked, own).astype(np.float64)
        first = moves(np.zeros(len(asked)), (begun or {}).get(region, still) / frame.scale**3)
        found[region] = (respond(change + (change_of(first) if smooth else 0.0)) + first) * frame.scale**3
    return found


def _by_projection(result: SolveResult, groups: Mapping[int, np.ndarray]) -> dict[int, FloatArray]:
    """Return dx/dK by region of the fairest surface."""
    from .projection.measure import smooth_equations
    from .projection.optimality import optimality
    from .projection.system import System

    if result.start is None:
        raise ProblemError(["the drawing of this result is not known; solve it again"])
    settings = result.settings if isinstance(result.settings, ProjectionSettings) else ProjectionSettings()
    if result.measure in EXACT:
        raise ProblemError([f"derivatives are not available in the measure {result.measure}; solve in the measure defect or smooth"])
    posed = result.problem.with_vertices(result.start)
    local, frame = posed.local()
    goals = bind(local, posed.goals)
    system = System(local, settings, goals, found=False)
    smooth = result.measure == "smooth"

    def posed_at(vertices: FloatArray) -> CurvatureEquations:
        plain = system.equations(local.targets)
        return smooth_equations(system, plain, vertices) if smooth else plain

    vertices = frame.to_local(result.vertices)
    equations = posed_at(vertices)
    point = system.at(vertices, equations)
    system = system.touching(point, equations)
    solved = optimality(system, point, equations)
    for _ in range(NEARER):
        step = solved.correction(point, equations, solved.multipliers)[0]
        if smooth:
            moved = partial(_layout_change, point.vertices, equations.faces, system.rows)
            step = step + _with_layout(partial(solved.moves, equations), moved)(moved(step))
        longest = float(np.abs(step).max(initial=0.0))
        if not CONVERGED < longest < ELSEWHERE:
            break
        equations = posed_at(point.vertices + step)
        point = system.at(point.vertices + step, equations)
        solved = optimality(system, point, equations)
    moves: Moves = partial(solved.moves, equations)
    if smooth:
        moves = _with_layout(moves, partial(_layout_change, point.vertices, equations.faces, system.rows))
    return {region: moves(np.isin(system.rows, own).astype(np.float64)) * frame.scale**3 for region, own in groups.items()}


def _with_layout(moves: Moves, layout: Callable[[FloatArray], FloatArray]) -> Moves:
    """Return the moves for changes of K in the smooth measure, from those by defects and what moves change of the layout's part.

    In the measure of defects K changes by what is asked and by what the moves themselves change of that part.
    """

    def smooth_moves(change: FloatArray) -> FloatArray:
        k = len(change)
        operator = LinearOperator((k, k), matvec=lambda own: own - layout(moves(own)), dtype=np.float64)
        found, left = np.zeros(k), change
        for _ in range(REFINED):
            found = found + gmres(operator, left, restart=KRYLOV, maxiter=1, atol=0.0)[0]
            left = change - operator.matvec(found)
            if np.abs(left).max() <= PRECISE * np.abs(change).max():
                return moves(found)
        raise ProblemError(["the layout error of the mesh changes too abruptly for derivatives; solve in the measure defect"])

    return smooth_moves


def _layout_change(vertices: FloatArray, faces: IntArray, rows: IntArray, moves: FloatArray) -> FloatArray:
    """Return what moves (n, 3) change, to first order, of the errors of the layout at some vertices (k,), by central differences."""
    longest = float(np.abs(moves).max(initial=0.0))
    if longest == 0.0:
        return np.zeros(len(rows))
    asked = np.zeros(len(vertices), bool)
    asked[rows] = True
    by = DIFFERENCE_STEP / longest
    ahead, behind = (layout_errors(vertices + sign * by * moves, faces, asked) for sign in (1.0, -1.0))
    return (ahead - behind)[rows] / (2.0 * by)
