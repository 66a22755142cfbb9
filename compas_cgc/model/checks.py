"""What keeps a problem from being solved."""

from __future__ import annotations

import numpy as np

from ..discrete import boundary_vertices
from ..discrete import face_areas
from ..discrete import face_normals
from ..discrete.arrays import Faces
from ..discrete.arrays import FloatArray
from ..discrete.arrays import Indices
from ..discrete.arrays import IntArray
from ..discrete.corners import corner_angles
from ..discrete.smooth_measure import is_regular
from ..errors import ProblemError
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
from .goals.binding import unknown_regions
from .goals.contradictions import goal_problems
from .measures import is_smooth_alone
from .measures import read_across
from .problem import CGCProblem
from .problem import PosesProblem
from .problem import problem_of
from .roles import CREASE
from .roles import FIXED
from .roles import FREE
from .roles import INTERNAL
from .straight_edges import twisted_edges

__all__ = ["check", "dropped_faces", "lost_creases", "no_saddle", "refuse", "three_faced", "turns_about"]

GENTLE = 0.5  # total curvature of a region that is proposed [rad]
STRAIGHT = 1e-6  # of the size of the drawing, across which supports on one line may lie
NEEDLE = 10.0  # degrees, below which a triangle is named where K̄ < 0
FINE = 300  # vertices with K; on a coarser mesh a roof is some percent off anyway


@names_what_was_meant()
def check(posed: PosesProblem) -> list[Diagnostic]:
    """List what keeps a problem from being solved: first of its geometry, then of what is asked of it.

    Parameters
    ----------
    posed
        A problem, or a mesh with roles, targets and creases.

    Returns
    -------
    list of Diagnostic
        Sentences; those with ``fatal`` set make a solve refuse with the same text.

    Examples
    --------
    >>> from compas_cgc import CGCMesh, check
    >>> mesh = CGCMesh.from_meshgrid(dx=4.0, nx=4)
    >>> mesh.set_target(0.01)
    >>> [said.split(",")[0] for said in check(mesh)]
    ['the mesh has no support']
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
    # What goes before mends what follows: of a mesh with faults it cannot be told where K can be asked for.
    problems += _role_problems(problem, names.vertices, sound) + _target_problems(problem, names.vertices)
    if sound and not any(said.fatal for said in problems):
        real = problem.without_dummies()
        problems += _remarks(real) + _existence_problems(real) + _saddle_problems(real) + _corner_problems(real)
        problems += [Diagnostic(said, fatal=False) for said in (*two_sided_supports(real), *twisted_edges(real))]
    return problems


def refuse(problems: list[Diagnostic]) -> None:
    """Raise :class:`ProblemError` with those of the problems that are fatal, if there are any."""
    fatal = [problem for problem in problems if problem.fatal]
    if fatal:
        raise ProblemError(fatal)


def lost_creases(edges: list) -> Diagnostic:
    """Return the sentence on creases that are no edges."""
    return Diagnostic(f"the creases {listed(edges)} do not follow edges of the mesh; set the creases again (mesh.set_creases)")


def dropped_faces(names: object) -> Diagnostic:
    """Return the sentence on faces that are no polygons."""
    return Diagnostic(f"faces {listed(names)} of the input have fewer than three different corners, they are degenerate; remove them")


def _role_problems(problem: CGCProblem, names: IntArray, sound: bool) -> list[Diagnostic]:
    problems = []
    if not (problem.roles == FIXED).any():
        if len(boundary_loops(problem.faces)):
            mend = "mesh.set_supports('boundary') or --supports boundary fixes the whole edge"
        else:
            mend = "the mesh is closed and has no edge to be held at, so name them: mesh.set_supports([...]), or points in the file"
        problems.append(Diagnostic(f"the mesh has no support, nothing holds it; fix vertices ({mend})"))
    lost = lost_edges(problem.faces, problem.creases)
    if lost.any():
        problems.append(lost_creases(names[problem.creases[lost]].tolist()))
    if sound and not np.isin(problem.roles, (INTERNAL, FREE)).any():
        # Triangles that share no vertices are as many meshes as faces, each with nothing inside: finer ones are no better.
        loose = len(problem.faces) > 1 and len(np.unique(problem.faces)) == problem.faces.size
        mend = "its faces share no vertices: weld it (mesh.weld())" if loose else "refine the mesh or free some supports or creases"
        problems.append(Diagnostic(f"there is no internal vertex, so no curvature to ask for; {mend}"))
    return problems


def _gentle_target(problem: CGCProblem) -> float:
    """Return a K that bends regions of the mean size by half a radian in all [1/L^2]."""
    area = float(face_areas(problem.vertices, problem.faces).sum())
    return GENTLE * len(problem.region_targets()) / area if area > 0.0 else 0.0


def _target_problems(problem: CGCProblem, names: IntArray) -> list[Diagnostic]:
    # With a dummy ring, or for a method that adds one, K is asked for on free edges too.
    asked = problem.asked & ~_unknown(problem)
    missing = asked & np.isnan(problem.targets)
    wrong = asked & np.isinf(problem.targets)
    problems = []
    if missing.any() and (missing == asked).all():
        text = "no target is set; say which Gaussian curvature is wanted (mesh.set_target(K), or --target K)"
        problems.append(Diagnostic(f"{text}; {_gentle_target(problem):.1g} would be gentle for its size, and 0 unrolls"))
    elif missing.any():
        text = "have no target; set one for their region (mesh.set_target(K, region=r))"
        problems.append(Diagnostic(f"vertices {listed(names[missing])} {text}"))
    if wrong.any():
        problems.append(Diagnostic(f"the targets of vertices {listed(names[wrong])} are not finite numbers; set numbers"))
    return problems


def _unknown(problem: CGCProblem) -> np.ndarray:
    """Return the vertices whose K is to be found (n,)."""
    found = np.zeros(len(problem.vertices), bool)
    for region in unknown_regions(problem):
        found |= problem.region_vertices(region)
    return found


def _remarks(problem: CGCProblem) -> list[Diagnostic]:
    """Say what a designer may not have meant: a drawing upside down, creases that part nothing."""
    V, F, names = problem.vertices, problem.faces, problem.names.vertices
    remarks = []
    normals = face_normals(V, F)
    targets = problem.targets[problem.asked]
    if len(normals) and (normals[:, 2] < -0.5).all() and len(targets) and np.nanmin(targets, initial=np.inf) > 0:
        remarks.append("the normals point down, so the surface hangs; turn the faces (mesh.flip(), or --flip) and it rises")
    ends, degree = np.unique(problem.creases, return_counts=True)
    loose = ends[(degree == 1) & np.isin(problem.roles[ends], (CREASE, INTERNAL))]
    loose = loose[~np.isin(loose, [v for loop in boundary_loops(F) for v in loop])]
    if len(loose):
        text = "so it parts nothing there; regions are parted by creases that run from edge to edge, or close"
        remarks.append(f"{_creases_end_at(names[loose])}, inside of a region, {text}")
    remarks += turns_about(problem)
    return [Diagnostic(text, fatal=False) for text in remarks]


def _creases_end_at(names: IntArray) -> str:
    return f"a crease ends at vertex {names[0]}" if len(names) == 1 else f"creases end at vertices {listed(names)}"


def turns_about(problem: CGCProblem) -> list[str]:
    """Say what a surface can turn about: one point, two, or more on one straight line; a side that is held is taken for a wall."""
    fixed = problem.roles == FIXED
    count = int(fixed.sum())
    if not count or problem.constraints or not len(boundary_loops(problem.faces)):
        return []
    if count > 2 and ((fixed[problem.faces].sum(axis=1) > 1).any() or not _on_one_line(problem.vertices[fixed], problem.vertices)):
        return []
    what = {1: "one point", 2: "two points"}.get(count, f"{count} points on one straight line")
    about = "them" if count == 2 else "it"
    return [f"the surface is held at {what} only and can turn about {about}; hold it at three that are not on one line"]


def _on_one_line(points: FloatArray, around: FloatArray) -> bool:
    across = np.linalg.svd(points - points.mean(axis=0), compute_uv=False)[1]
    return bool(across <= STRAIGHT * np.ptp(around, axis=0).max())


def _saddle_problems(problem: CGCProblem) -> list[Diagnostic]:
    """Name what K̄ < 0 is at odds with: vertices of three faces, whose angles add up to less than 2π, or where there are none needles."""
    saddle = problem.asked & (problem.targets < 0.0)
    lost = three_faced(problem.faces, np.flatnonzero(saddle))
    if len(lost):
        return [Diagnostic(no_saddle(problem.names.vertices[lost]), fatal=False)]
    around = problem.faces[saddle[problem.faces].any(axis=1)]
    angles = np.degrees(corner_angles(problem.vertices, around)).min(axis=1, initial=180.0)
    count = np.count_nonzero(angles < NEEDLE)
    if not count:
        return []
    which = "1 triangle is a needle" if count == 1 else f"{count} triangles are needles"
    worst = listed(problem.names.vertices[around[np.argmin(angles)]])
    return [
        Diagnostic(
            f"{which} of down to {angles.min():.2g} degrees where K̄ < 0, the worst at vertices {worst}; the measure exact may draw them "
            "out until the surface is rough, so mesh it more evenly",
            fatal=False,
        )
    ]


def _corner_problems(problem: CGCProblem) -> list[Diagnostic]:
    """Name faces that lie flat in corners, where angle defects read K: auto does so on most regular meshes."""
    if int((problem.asked & (problem.targets > 0.0)).sum()) < FINE or not is_regular(problem.faces, problem.asked):
        return []
    held = problem.roles == FIXED
    if held[boundary_vertices(problem.vertices, problem.faces)].all() and is_smooth_alone(problem):
        return []
    flat = np.flatnonzero((read_across(problem) != problem.faces).any(axis=1) & held[problem.faces].all(axis=1))
    if not len(flat):
        return []
    faces = (
        "1 face lies flat in a corner, held at all three vertices, and cuts it off"
        if len(flat) == 1
        else (f"{len(flat)} faces lie flat in corners, held at all three vertices, and cut them off")
    )
    text = "which makes a dome some percent lower; the setting measure='smooth' (--measure smooth) reads K into the corners"
    return [Diagnostic(f"{faces} (faces {listed(problem.names.faces[flat])}), {text}", fatal=False)]


def three_faced(faces: Faces, vertices: Indices) -> Indices:
    """Return those of some inner vertices (k,) that have three faces only."""
    return vertices[np.bincount(faces.ravel(), minlength=int(vertices.max(initial=0)) + 1)[vertices] == 3]


def no_saddle(names: IntArray) -> str:
    """Return the sentence on vertices of three faces where K̄ is negative."""
    one = len(names) == 1
    has, which = ("has", f"vertex {names[0]}") if one else ("have", f"vertices {listed(names)}")
    return (
        f"{which} {has} three faces, whose angles never add up to the more than 2π of a K̄ < 0; remove "
        f"{'it, so that its' if one else 'them, so that the'} three faces are one, or flip an edge opposite"
    )


def _existence_problems(problem: CGCProblem) -> list[Diagnostic]:
    """Check every piece: that it is held, whether it is closed, and, without creases, what its fixed edges allow."""
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
            held = f"the piece of vertex {names[own].min()} has no support, nothing holds it; fix one of its vertices or remove it"
            problems.append(Diagnostic(held))
            continue
        around = [loop for loop in loops if belongs[loop[0]] == p]
        if not around:
            closed = "the mesh is closed; the only closed smooth surface of constant K is a sphere"
            problems.append(Diagnostic(closed, fatal=False))
        targets = problem.targets[own[(roles[own] == INTERNAL) & ~unknown[own]]]
        if p in creased or not all((roles[loop] == FIXED).all() for loop in around) or not len(targets) or targets.min() <= 0:
            continue
        corners = F[piece == p]
        up = face_normals(V, corners).sum(axis=0)
        concave = [loop[_turns_inwards(V[loop], up)] for loop in around]
        if any(map(len, concave)):
            text = "where a surface of positive K needs a crease; lead creases to them if the solve fails"
            problems.append(Diagnostic(f"the edge is concave at vertices {listed(names[np.concatenate(concave)])}, {text}", fatal=False))
        if len(around) == 1:
            inner = np.zeros(len(V), bool)
            inner[own[roles[own] == INTERNAL]] = True
            problems += existence_problems(V, corners, around[0], problem.targets, inner)
    return problems


def _turns_inwards(loop: FloatArray, up: FloatArray) -> np.ndarray:
    """Tell where a plane loop, with the surface to its left, turns right by more than 10 degrees (b,).

    The normal curvature along a plane edge would have to change its sign there, which
    it cannot with K > 0.
    """
    _, reach = plane_of(loop)
    if reach > 1e-6 or not up.any():
        return np.zeros(len(loop), bool)
    ahead = np.roll(loop, -1, axis=0) - loop
    behind = np.roll(ahead, 1, axis=0)
    left = np.cross(behind, ahead) @ (up / np.linalg.norm(up))
    return np.arctan2(left, np.einsum("ij,ij->i", behind, ahead)) < -np.radians(10)
