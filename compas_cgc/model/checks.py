"""Checks of a problem before a solve."""

from __future__ import annotations

import numpy as np

from ..discrete import face_areas
from ..discrete import face_normals
from ..discrete.arrays import Faces
from ..discrete.arrays import FloatArray
from ..discrete.arrays import Indices
from ..discrete.arrays import IntArray
from ..discrete.corners import corner_angles
from ..errors import FINER
from ..errors import ProblemError
from ..errors import Remedy
from ..errors import Sentence
from ..errors import names_what_was_meant
from ..meshing import Diagnostic
from ..meshing import boundary_loops
from ..meshing import existence_problems
from ..meshing import face_regions
from ..meshing import lost_edges
from ..meshing import mesh_problems
from ..meshing import vertex_labels
from ..meshing.checks import listed
from ..meshing.existence import plane_of
from .bulging import two_sided_supports
from .convex_plans import beyond_convex_plans
from .flat_edges import saddle_in_flat_edge
from .goals.binding import unknown_regions
from .goals.contradictions import bound_problems
from .goals.contradictions import goal_problems
from .law_problems import law_problems
from .problem import CGCProblem
from .problem import PosesProblem
from .problem import problem_of
from .roles import CREASE
from .roles import FIXED
from .roles import FREE
from .roles import INTERNAL
from .straight_edges import twisted_edges
from .tolerances import DRAWING_ACCURACY

__all__ = ["check", "dropped_faces", "lost_creases", "no_saddle", "refuse", "three_faced", "turns_about"]

# total curvature of a region for the suggested target [rad]; normals of a cap turn by 46° across it, which every plan can have
GENTLE_TOTAL_CURVATURE = 0.5
# total curvature K A of a region below which K is probably in other units [rad]; a fold of 0.3°; the factor is 1e6 for mm and m
MIN_TOTAL_CURVATURE = 3e-5
MAX_TOTAL_CURVATURE = 1e2  # the same above which K is probably in other units [rad]; 8 whole spheres; the factor is 1,550 for inches and m
# angle of a triangle below which it is reported where K̄ < 0 [degrees]; three times the angle that the verdict calls a needle
NEEDLE_ANGLE = 10.0


@names_what_was_meant()
def check(posed: PosesProblem) -> list[Diagnostic]:
    """List everything that prevents a solve or may surprise: faults of the mesh first, then of roles, targets and goals.

    Parameters
    ----------
    posed
        A problem, or a mesh with roles, targets and creases.

    Returns
    -------
    list of Diagnostic
        Sentences; a solve refuses a problem with a ``fatal`` one, with the same text.

    Examples
    --------
    >>> from compas_cgc import CGCMesh, check
    >>> mesh = CGCMesh.from_meshgrid(dx=4.0, nx=4)
    >>> mesh.set_target(0.01)
    >>> [text.split(";")[0] for text in check(mesh)]
    ['the mesh has no supports']
    """
    try:
        problem = problem_of(posed, "is checked")
    except ProblemError as error:
        return [Diagnostic(text) for text in error.problems]
    names = problem.names
    if len(problem.faces):
        unmet = goal_problems(problem)
        if unmet:
            return [Diagnostic(text) for text in unmet]
    problems = mesh_problems(problem.vertices, problem.faces, *names)
    sound = not any(said.fatal for said in problems)
    # On a mesh with faults the later checks would report consequences of the first ones.
    problems += _role_problems(problem, names.vertices, sound) + _target_problems(problem, names.vertices)
    problems += law_problems(problem) if sound else []
    if sound and not any(said.fatal for said in problems):
        real = problem.without_dummies()
        problems += _unit_problems(real) + _remarks(real) + _existence_problems(real) + _saddle_problems(real)
        warnings = [*bound_problems(real), *two_sided_supports(real), *twisted_edges(real), *saddle_in_flat_edge(real)]
        if not any(said.fatal for said in problems):
            warnings += beyond_convex_plans(real.with_targets(np.where(_unknown(real), 0.0, np.nan)))
        problems += [Diagnostic(said, fatal=False) for said in warnings]
    return problems


def refuse(problems: list[Diagnostic]) -> None:
    """Raise :class:`ProblemError` if any of the problems is fatal."""
    fatal = [problem for problem in problems if problem.fatal]
    if fatal:
        raise ProblemError(fatal)


def lost_creases(edges: list) -> Diagnostic:
    """Return the sentence on creases that are not edges of the mesh."""
    return Diagnostic(f"creases {listed(edges)} do not follow edges of the mesh; set the creases again (mesh.set_creases)")


def dropped_faces(names: object) -> Diagnostic:
    """Return the sentence on degenerate faces."""
    return Diagnostic(f"faces {listed(names)} of the input are degenerate: they have fewer than three different corners; remove them")


def _role_problems(problem: CGCProblem, names: IntArray, sound: bool) -> list[Diagnostic]:
    problems = []
    if not (problem.roles == FIXED).any():
        if len(boundary_loops(problem.faces)):
            mend = "mesh.set_supports('boundary') or --supports boundary fixes the whole boundary"
            remedies = [Remedy("supports", "boundary")]
        else:
            remedies = []
            mend = "the mesh is closed and has no boundary, so name the vertices: mesh.set_supports([...]), or points in the file"
        problems.append(Diagnostic(f"the mesh has no supports; fix vertices ({mend})", remedies=remedies))
    lost = lost_edges(problem.faces, problem.creases)
    if lost.any():
        problems.append(lost_creases(names[problem.creases[lost]].tolist()))
    if sound and not np.isin(problem.roles, (INTERNAL, FREE)).any():
        # Refinement does not help where the triangles share no vertices.
        loose = len(problem.faces) > 1 and len(np.unique(problem.faces)) == problem.faces.size
        mend = "its faces share no vertices: weld it (mesh.weld())" if loose else "refine the mesh or free some supports or creases"
        problems.append(
            Diagnostic(f"the mesh has no internal vertex at which K could be prescribed; {mend}", remedies=[] if loose else [FINER])
        )
    return problems


def _gentle_target(problem: CGCProblem) -> float:
    """Return the K that gives a region of mean area a total curvature of GENTLE_TOTAL_CURVATURE [1/L^2]."""
    area = float(face_areas(problem.vertices, problem.faces).sum())
    return GENTLE_TOTAL_CURVATURE * len(problem.region_targets()) / area if area > 0.0 else 0.0


def _target_problems(problem: CGCProblem, names: IntArray) -> list[Diagnostic]:
    # A dummy ring makes free edges internal, so that they need targets too.
    asked = problem.asked & ~_unknown(problem)
    missing = asked & np.isnan(problem.targets)
    wrong = asked & np.isinf(problem.targets)
    problems = []
    if missing.any() and (missing == asked).all():
        text = "no target curvature is set; set one (mesh.set_target(K), or --target K)"
        gentle = f"{_gentle_target(problem):.1g}"
        text += f"; K = {gentle} gives this mesh a gentle curvature, and K = 0 a developable surface"
        problems.append(Diagnostic(text, remedies=[Remedy("targets", float(gentle))]))
    elif missing.any():
        text = "have no target curvature; set one for their region (mesh.set_target(K, region=r))"
        problems.append(Diagnostic(f"vertices {listed(names[missing])} {text}"))
    if wrong.any():
        problems.append(Diagnostic(f"the targets of vertices {listed(names[wrong])} are not finite numbers; set finite targets"))
    return problems


def _unit_problems(problem: CGCProblem) -> list[Diagnostic]:
    """Return a warning about regions whose total curvature suggests that K is in other units than the mesh."""
    areas = np.bincount(problem.regions(), face_areas(problem.vertices, problem.faces)).tolist()
    totals = [(abs(K) * area, K, region) for region, (K, area) in enumerate(zip(problem.region_targets(), areas)) if K]
    strange = [own for own in totals if not MIN_TOTAL_CURVATURE <= own[0] <= MAX_TOTAL_CURVATURE]
    if not strange:
        return []
    total, K, region = strange[0]
    spheres = f"would have the curvature of {total / (4.0 * np.pi):.2g} whole spheres"
    others = f" (and {len(strange) - 1} others)" if len(strange) > 1 else ""
    text = (
        f"with K = {K:.3g}, a radius of {abs(K) ** -0.5:.3g}, region {region}{others} of a mesh of size "
        f"{float(np.linalg.norm(np.ptp(problem.vertices, axis=0))):.3g} {'is almost flat' if total < MIN_TOTAL_CURVATURE else spheres}; "
        "check the units: K is in 1/(model unit)², and 0.01 1/m² is 1e-08 1/mm²"
    )
    return [Diagnostic(text, fatal=False)]


def _unknown(problem: CGCProblem) -> np.ndarray:
    """Return the vertices of regions with unknown K (n,)."""
    found = np.zeros(len(problem.vertices), bool)
    for region in unknown_regions(problem):
        found |= problem.region_vertices(region)
    return found


def _remarks(problem: CGCProblem) -> list[Diagnostic]:
    """Return warnings about probable mistakes: normals that point down, creases that end inside a region."""
    V, F, names = problem.vertices, problem.faces, problem.names.vertices
    remarks: list[str] = []
    normals = face_normals(V, F)
    types = problem.types[problem.asked]
    if len(normals) and (normals[:, 2] < -0.5).all() and len(types) and np.nanmin(types, initial=np.inf) > 0:
        text = (
            "the normals point down, so the surface will hang below its supports; flip the faces (mesh.flip(), or --flip) to make it rise"
        )
        remarks.append(Sentence(text, [Remedy("flip", True)]))
    ends, degree = np.unique(problem.creases, return_counts=True)
    loose = ends[(degree == 1) & np.isin(problem.roles[ends], (CREASE, INTERNAL))]
    loose = loose[~np.isin(loose, [v for loop in boundary_loops(F) for v in loop])]
    if len(loose):
        text = "so the mesh is not divided into regions there; run creases from boundary to boundary, or close them"
        remarks.append(f"{_creases_end_at(names[loose])}, inside a region, {text}")
    remarks += turns_about(problem)
    return [Diagnostic(text, fatal=False) for text in remarks]


def _creases_end_at(names: IntArray) -> str:
    return f"a crease ends at vertex {names[0]}" if len(names) == 1 else f"creases end at vertices {listed(names)}"


def turns_about(problem: CGCProblem) -> list[str]:
    """Return a warning if the supports leave the surface free to rotate: one point, two, or several on one straight line.

    A supported mesh edge counts as a wall, which holds the surface.
    """
    fixed = problem.roles == FIXED
    count = int(fixed.sum())
    if not count or problem.goals or not len(boundary_loops(problem.faces)):
        return []
    if count > 2 and ((fixed[problem.faces].sum(axis=1) > 1).any() or not _on_one_line(problem.vertices[fixed], problem.vertices)):
        return []
    what = {1: "one point", 2: "two points"}.get(count, f"{count} points on one straight line")
    about = {1: "this point", 2: "the line through them"}.get(count, "this line")
    away = "at two points that are not on one line with it" if count == 1 else "that is not on this line"
    return [f"the surface is supported at {what} only and can rotate about {about}; add {'supports' if count == 1 else 'a support'} {away}"]


def _on_one_line(points: FloatArray, around: FloatArray) -> bool:
    across = np.linalg.svd(points - points.mean(axis=0), compute_uv=False)[1]
    return bool(across <= DRAWING_ACCURACY * np.ptp(around, axis=0).max())


def _saddle_problems(problem: CGCProblem) -> list[Diagnostic]:
    """Return warnings about vertices that cannot have K̄ < 0, or else about needle triangles there."""
    saddle = problem.asked & (problem.types < 0)
    lost = three_faced(problem.faces, np.flatnonzero(saddle))
    if len(lost):
        return [Diagnostic(no_saddle(problem.names.vertices[lost]), fatal=False)]
    around = problem.faces[saddle[problem.faces].any(axis=1)]
    angles = np.degrees(corner_angles(problem.vertices, around)).min(axis=1, initial=180.0)
    count = np.count_nonzero(angles < NEEDLE_ANGLE)
    if not count:
        return []
    which = "1 triangle is a needle" if count == 1 else f"{count} triangles are needles"
    worst = listed(problem.names.vertices[around[np.argmin(angles)]])
    return [
        Diagnostic(
            f"{which} (smallest angle {angles.min():.2g} degrees) where K̄ < 0, the worst at vertices {worst}; the measure exact may "
            "stretch them further and make the surface rough; use a more regular mesh",
            fatal=False,
        )
    ]


def three_faced(faces: Faces, vertices: Indices) -> Indices:
    """Return those of the inner vertices (k,) that have only three faces."""
    return vertices[np.bincount(faces.ravel(), minlength=int(vertices.max(initial=0)) + 1)[vertices] == 3]


def no_saddle(names: IntArray) -> str:
    """Return the sentence on vertices of three faces where K̄ is negative."""
    one = len(names) == 1
    has, which = ("has", f"vertex {names[0]}") if one else ("have", f"vertices {listed(names)}")
    return (
        f"{which} {has} three faces only, but K̄ < 0 needs angles that add up to more than 2π; remove "
        f"{'it and merge its three faces' if one else 'them and merge their three faces'}, "
        "or flip an edge of one of these faces that does not meet the vertex"
    )


def _existence_problems(problem: CGCProblem) -> list[Diagnostic]:
    """Check every connected piece: supports, closedness and, without creases, the existence conditions of its fixed boundary."""
    V, F, roles, names = problem.vertices, problem.faces, problem.roles, problem.names.vertices
    piece = face_regions(F, np.empty((0, 2), dtype=np.int64))
    belongs = vertex_labels(len(V), F, piece)
    loops = boundary_loops(F)
    creased = np.unique(belongs[problem.creases])
    unknown = _unknown(problem)
    problems = []
    for p in range(piece.max(initial=-1) + 1):
        own = np.flatnonzero(belongs == p)
        if not (roles[own] == FIXED).any():
            held = f"the piece of the mesh with vertex {names[own].min()} has no supports; fix some of its vertices or remove it"
            problems.append(Diagnostic(held))
            continue
        around = [loop for loop in loops if belongs[loop[0]] == p]
        if not around:
            closed = "the mesh is closed; the only closed smooth surface of constant K is a sphere"
            problems.append(Diagnostic(closed, fatal=False))
        types = problem.types[own[problem.asked[own] & ~unknown[own]]]
        if p in creased or not all((roles[loop] == FIXED).all() for loop in around) or not len(types) or types.min() <= 0:
            continue
        corners = F[piece == p]
        up = face_normals(V, corners).sum(axis=0)
        concave = [loop[_turns_inwards(V[loop], up)] for loop in around]
        if any(map(len, concave)):
            text = "where a surface of K > 0 usually needs a crease; draw creases to them if the solve fails"
            problems.append(
                Diagnostic(f"the boundary is concave at vertices {listed(names[np.concatenate(concave)])}, {text}", fatal=False)
            )
        if len(around) == 1:
            inner = np.zeros(len(V), bool)
            inner[own[problem.asked[own]]] = True
            problems += existence_problems(V, corners, around[0], problem.targets, inner)
    return problems


def _turns_inwards(loop: FloatArray, up: FloatArray) -> np.ndarray:
    """Return where a plane loop with the surface to its left turns right by more than 10 degrees (b,).

    The normal curvature along a plane boundary would change its sign there, which K > 0
    excludes.
    """
    _, reach = plane_of(loop)
    if reach > 1e-6 or not up.any():
        return np.zeros(len(loop), bool)
    ahead = np.roll(loop, -1, axis=0) - loop
    behind = np.roll(ahead, 1, axis=0)
    left = np.cross(behind, ahead) @ (up / np.linalg.norm(up))
    return np.arctan2(left, np.einsum("ij,ij->i", behind, ahead)) < -np.radians(10)
