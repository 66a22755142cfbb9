"""The shapes that a search may set out from, the most promising first."""

from __future__ import annotations

import math
from typing import NamedTuple
from typing import Optional

import numpy as np
from scipy.sparse.linalg import ArpackError

from ...discrete.arrays import FloatArray
from ...discrete.jacobian import CurvatureEquations
from .initial_guess import flat_share
from .initial_guess import flat_vertices
from .initial_guess import seeded
from .iterate import Point
from .modes import bending_modes
from .modes import is_bulge
from .patchwork import combined_modes
from .ruled import ruled
from .settings import ProjectionSettings
from .system import System
from .vectors import dot
from .vectors import norm

__all__ = ["Starts", "is_flat", "starts"]

NEARLY = 0.05  # residual, against the curvature asked for, of a drawing that is taken as it is
SPANNED = 0.01  # of a surface of straight lines that all but has K = 0
FLAT_SHARE = 0.1  # part of the curvature asked for in flat places above which a seed is needed
FINER = 1.25  # quotient of amplitudes that are tried
AMPLITUDES = 0.02 * FINER ** np.arange(17)  # of a mode, against the size of the mesh
LOWEST = 1e-4  # amplitude, likewise, below which nothing is seen
OTHER_SIDE = 1.5  # how much dearer a start is on the side away from the drawing
SAID = 0.02  # how far a drawing lies to one side, against what is needed, to say so
TRIED = 2  # whose results are compared
ALIKE = 1e-6  # relative difference of residuals up to which two starts are mirror images of each other
CANDIDATES = 4  # at most, of which the move to the equations is worked out
DEAREST, MEANT = 3.0, 15.0  # a start, against the cheapest, that is worth a try, and one to the side that is meant
WRONG = 1.5  # residual, against the curvature asked for, of one that is bent the wrong way: of a flat one it is 1
UNSOLVED = 0.5  # part of the right side that no move accounts for, from which a start is hopeless, such as a flat one
ROUGH = 1e-2  # residual of the linear system for that


class _Candidate(NamedTuple):
    point: Point
    factor: float  # on its cost
    bulge: int = 0  # where nothing else says which way: 1 with the normals, -1 against them


class Starts(NamedTuple):
    """Shapes to set out from, the cheapest to finish first."""

    rivals: list[Point]  # whose results are compared
    others: list[Point]  # for when these lead nowhere

    @property
    def all(self) -> list[Point]:
        """All of them, in the order that they are to be tried in."""
        return self.rivals + self.others


def starts(system: System, equations: CurvatureEquations, drawing: Point, settings: ProjectionSettings) -> Starts:
    """Return the drawing, and shapes bent from the fairest surface through the supports, the cheapest to finish first.

    The cost is the metric length of the least move that fulfils the linear equations. Where the
    drawing is nearly there, or its shape is to be kept and has curvature, it is the only start, and so is what straight
    lines span where that has K = 0 as asked. Where the drawing says nothing of a side, what bulges with the normals comes first.
    """
    flat = is_flat(system, equations, drawing)
    seed = _seeded(system, equations, drawing, settings.seed_height) if flat and settings.seed_height > 0.0 else None
    drawing = system.at(system.settled(drawing.vertices), equations)
    spanned = _spanned(system, equations, drawing) if settings.keep != "shape" else None
    if spanned is not None:
        return Starts([spanned], [drawing])
    if settings.seed_height == 0.0 or system.missing(drawing, equations) <= NEARLY or (system.keep == "shape" and not flat):
        return Starts([drawing], [])
    candidates = [_Candidate(drawing, 1.0)]
    if seed is not None:
        candidates.append(_Candidate(seed, 1.0))
    plate = system.at(system.settled(system.fairness.relaxed()), equations)
    candidates += [_Candidate(plate, 1.0), *_bent(system, equations, plate, drawing)]
    candidates = [one for one in candidates if not is_flat(system, equations, one.point)] or candidates
    missing = [system.missing(one.point, equations) for one in candidates]
    hopeful = [k for k, off in enumerate(missing) if off < WRONG or min(missing) >= 1.0]
    chosen = sorted(hopeful, key=lambda k: candidates[k].factor * missing[k])[:CANDIDATES]
    best = [candidates[k] for k in chosen]
    costs = [one.factor * _cost(system, equations, one.point) for one in best]
    order = [int(k) for k in np.argsort(costs, kind="stable") if costs[k] <= (MEANT if best[k].bulge > 0 else DEAREST) * min(costs)]
    bulging = [k for k in order if best[k].bulge > 0][:1]
    ranked = bulging + [k for k in order if best[k].bulge >= 0 and k not in bulging] if bulging else order
    # Of two mirror images, as over a flat plate, one tells what the other comes to.
    lacking = [missing[k] for k in chosen]
    rivals = [k for at, k in enumerate(ranked) if not np.isclose(lacking[k], [lacking[j] for j in ranked[:at]], ALIKE, 0.0).any()][:TRIED]
    return Starts([best[k].point for k in rivals], [best[k].point for k in order if k not in rivals])


def _spanned(system: System, equations: CurvatureEquations, drawing: Point) -> Optional[Point]:
    """Return the shape that straight lines between two curves span, where K = 0 is asked for and it is nearer to that than the drawing."""
    missing = system.missing(drawing, equations)
    if equations.targets[system.rows].any() or (missing <= NEARLY and not system.torn):
        return None
    shape = ruled(system, drawing.vertices)
    if shape is None:
        return None
    point = system.at(system.settled(shape), equations)
    return point if system.missing(point, equations) < min(SPANNED, missing) else None


def _bent(system: System, equations: CurvatureEquations, plate: Point, drawing: Point) -> list[_Candidate]:
    lacking = -plate.residual
    signs = np.where(lacking >= 0.0, 1.0, -1.0)
    try:
        modes = bending_modes(system, equations, plate.vertices, lacking)
    except ArpackError:
        return []
    found = []
    drawn = (drawing.vertices - plate.vertices).ravel()
    for mode in modes:
        side = dot(mode.ravel(), drawn) / dot(mode.ravel(), mode.ravel())
        for sign in (1.0, -1.0):
            amplitude = _amplitude(system, equations, plate.vertices, sign * mode, signs)
            point = system.at(system.settled(plate.vertices + sign * amplitude * mode), equations)
            # A drawing that says next to nothing leaves it to the normals, to which modes point.
            said = abs(side) > SAID * amplitude
            away = sign * side < 0.0 if said else sign < 0.0
            bulge = 0 if said or not is_bulge(system, plate.vertices, lacking, mode) else int(sign)
            found.append(_Candidate(point, OTHER_SIDE if away else 1.0, bulge))
    for move in combined_modes(system, equations, plate, modes):
        side = -1.0 if dot(move.ravel(), drawn) < 0.0 else 1.0
        found.append(_Candidate(system.at(system.settled(plate.vertices + side * move), equations), 1.0))
    return found


def _amplitude(system: System, equations: CurvatureEquations, plate: FloatArray, mode: FloatArray, signs: FloatArray) -> float:
    """Return how much of a mode (n, 3) brings all the curvature asked for, where it is counted with its signs (k,)."""

    def off(amplitude: float) -> float:
        return abs(dot(signs, system.at(plate + amplitude * system.size * mode, equations).residual))

    found = [off(float(amplitude)) for amplitude in AMPLITUDES]
    least = float(AMPLITUDES[int(np.argmin(found))])
    best = min(found)
    # Panels bulge far less than a roof as wide.
    while least <= AMPLITUDES[0] and least > LOWEST:
        lower = off(least / FINER)
        if lower >= best:
            break
        least, best = least / FINER, lower
    return least * system.size


def is_flat(system: System, equations: CurvatureEquations, point: Point) -> bool:
    """Return whether a shape is flat where much of the curvature is asked for."""
    return flat_share(point.vertices, system.faces, system.wanted(point, equations)) > FLAT_SHARE


def _cost(system: System, equations: CurvatureEquations, point: Point) -> float:
    linear = system.linearised(point, equations)
    found = linear.solver.cheapest(linear.right, ROUGH)
    if not norm(found.residual) <= UNSOLVED * norm(linear.right):
        return math.inf
    move = found.move
    return math.sqrt(max(0.0, dot(move, linear.solver.metric.times(move))))


def _seeded(system: System, equations: CurvatureEquations, point: Point, highest: float) -> Point:
    """Return the shape with a low dome or saddle where it is flat."""
    rows, targets = system.rows, equations.targets[system.rows]
    wanted = system.wanted(point, equations)

    def defects(vertices: FloatArray) -> FloatArray:
        residual, areas = equations.measure(vertices)
        result = np.zeros(len(vertices))
        result[rows] = residual + targets * areas
        return result

    wanted = np.where(flat_vertices(point.vertices, system.faces, wanted), wanted, 0.0)
    shape = seeded(point.vertices, system.faces, system.columns, system.fairness.plate, wanted, defects, highest)
    return system.at(system.settled(shape), equations)
