"""One sentence on how a projection ended."""

from __future__ import annotations

import numpy as np
from scipy import sparse
from scipy.sparse.csgraph import connected_components

from ...discrete.arrays import Faces
from ...discrete.arrays import FloatArray
from ...discrete.plan import flattened
from ...errors import FOUND
from ...errors import HALVED
from ...errors import Sentence
from ...errors import more_steps
from ...meshing import boundary_loops
from ...meshing.polyline import nearest_on_polyline
from ...model.checks import no_saddle
from ...model.checks import three_faced
from ...model.constraints import Height
from ...model.goals.names import goal_name
from ...model.goals.names import listed
from ...model.laws import types_of
from ...model.lengths import length_text
from ...model.problem import CGCProblem
from ...model.roles import FREE
from ...model.tolerances import DRAWING_ACCURACY
from .iterate import Point
from .system import System

__all__ = ["blamed", "cause", "drawn_in", "enclosed_negative", "found", "laid_out_anew", "message"]


def message(status: str, steps: int, error: float, start_error: float, goal: float, why: str, measure: str = "defect") -> str:
    """Return the sentence for a status; errors and goal are largest |K - K̄|."""
    reached = f"largest |K - K̄| {error:.3g}" + ("" if measure == "defect" else f" in the {measure} measure")
    if status == "converged":
        return f"converged in {steps} steps: {reached}" + (", which is at rounding level on this mesh" if error > goal else "")
    if status == "cancelled":
        return f"cancelled after {steps} steps: {reached}"
    if error > start_error:
        reached += f", larger than {start_error:.3g} of the initial surface"
    if status == "step_limit":
        return Sentence(
            f"not converged in {steps} steps: {reached}, but the tolerance is {goal:.3g}; allow more steps", [more_steps(steps)]
        )
    return Sentence("{}: {}; the best shape is returned, {}").format(status, why, reached)


def laid_out_anew(drawn: Faces, faces: Faces, moved: float) -> str:
    """Return what was done to triangles that leave no room for vertices to slide."""
    turned = int(np.count_nonzero((faces != drawn).any(axis=1)))
    return (
        f"{turned} of {len(faces)} faces were changed by flipping edges, and vertices moved by up to {moved:.3g} along the surface, "
        "because the drawn triangles are too slender for K < 0"
    )


def drawn_in(problem: CGCProblem, axes: FloatArray, vertices: FloatArray) -> str:
    """Return how far the free edges of a surface (n, 3) left their drawn lines, in plan along axes (2, 3); empty where they did not."""
    plan, moved = problem.vertices @ axes.T, vertices @ axes.T
    distance, free = 0.0, problem.roles == FREE
    for loop in boundary_loops(problem.faces):
        line = flattened(plan[np.append(loop, loop[0])])
        distance = max(distance, float(nearest_on_polyline(flattened(moved[loop[free[loop]]]), line)[0].max(initial=0.0)))
    size = float(np.ptp(plan, axis=0).max())
    if distance <= DRAWING_ACCURACY * size:
        return ""
    return f"free edges left their drawn lines by up to {length_text(distance, size)} in plan"


def cause(point: Point, system: System, targets: FloatArray) -> str:
    """Return why nothing better than this was reached, and what to do about it."""
    if not len(system.columns):
        return "all vertices are fixed; release some supports"
    unmet = blamed(point, system)
    if unmet:
        return unmet
    vertex = int(np.argmax(point.gap))
    if point.gap[vertex] > DRAWING_ACCURACY:
        return _astray(vertex, system)
    if enclosed_negative(system, targets):
        held = int(np.count_nonzero(~np.isin(np.unique(system.faces), system.columns)))
        return f"a region of negative K needs a free edge, but all {held} vertices of its edge are held; free one of its sides"
    negative = system.rows[types_of(targets[system.rows]) < 0]
    lost = three_faced(system.faces, negative) if len(negative) else negative
    if len(lost):
        return no_saddle(lost)
    if not system.sound.all():
        a, b, c = system.faces[np.argmin(system.sound)].tolist()
        return f"the face {a}-{b}-{c} has hardly any area; repair the mesh there"
    if system.torn:
        return "the vertices are mirror images of each other, but the faces are not; flip their diagonals, or remove the goal Mirror"
    names = [*(own.name for own in system.goals.equations), *(side.name for side in system.goals.sides)]
    if names:
        text = f"the supports may not allow this curvature together with {listed(names)}; choose other values, or another K̄"
        return Sentence(text, [HALVED])
    return Sentence(
        "the supports may not allow this curvature; free an edge or a crease, or choose a K̄ closer to the curvature of the initial surface",
        [HALVED],
    )


def _astray(vertex: int, system: System) -> str:
    """Return which goals a vertex cannot be brought to."""
    own = [goal for goal in system.goals.places if vertex in np.asarray(goal.vertices, dtype=np.int64)]
    # Their numbers are in the local frame, which is nobody's.
    names = list(dict.fromkeys("the height of vertices" if isinstance(goal, Height) else goal_name(goal) for goal in own))
    if len(own) == 1:
        text = Sentence("vertex {} cannot fulfil its constraints: {} is out of its reach; move or remove that constraint")
        return text.format(vertex, names[0])
    there = Sentence(": {} contradict each other there").format(listed(names)) if len(names) > 1 else ""
    return Sentence("vertex {} cannot fulfil its constraints{}; remove one of them").format(vertex, there)


def blamed(point: Point, system: System) -> str:
    """Return which goals are not met, empty where all are."""
    unmet = [own.name for own, lack in zip(system.goals.equations, point.lacking) if abs(lack) > DRAWING_ACCURACY]
    for side in system.goals.sides:
        at = side.candidates(point.vertices)
        if len(at) and side.goal.slack(point.vertices[at])[0].min() < -DRAWING_ACCURACY:
            unmet.append(side.name)
    if not unmet:
        return ""
    if len(unmet) > 1:
        return Sentence("{} cannot be met together here; remove one of them, or change the value of one").format(listed(unmet))
    text = f"{unmet[0]} cannot be met with this curvature and these supports; choose another value, or let the solve determine K (unknown)"
    return Sentence(text, [FOUND])


def found(targets: list[float], regions: list[int], goals: int) -> str:
    """Return what is to be said of K that was found: `targets` [1/L^2] of some regions, for so many goals."""
    if len(regions) == 1:
        said = f"K = {targets[0]:.6g} was found for region {regions[0]}"
    else:
        said = f"K from {min(targets):.4g} to {max(targets):.4g} was found for {len(regions)} regions"
    if goals < len(regions):
        said += f"; {'the goals do not determine K completely' if goals else 'no goal determines K'}, so it is that of the fairest surface"
    return said


def enclosed_negative(system: System, targets: FloatArray) -> bool:
    """Return whether a region of negative K̄ has fixed vertices all around it."""
    negative = system.rows[types_of(targets[system.rows]) < 0]
    if not len(negative):
        return False
    F, n = system.faces, len(targets)
    asked = np.zeros(n, bool)
    asked[system.rows] = True
    u, v = F.ravel(), np.roll(F, -1, axis=1).ravel()
    inside = asked[u] & asked[v]
    joined = sparse.csr_matrix((np.ones(np.count_nonzero(inside)), (u[inside], v[inside])), shape=(n, n))
    _, region = connected_components(joined, directed=False)
    loose = np.zeros(n, bool)
    loose[system.columns] = True
    loose &= ~asked
    touched = np.zeros(n, bool)
    for a, b in ((u, v), (v, u)):
        touched[region[a[asked[a] & loose[b]]]] = True
    return bool((~touched[region[negative]]).any())
