"""Contents of a file or an example as JSON for the page, computed in the workers."""

from __future__ import annotations

import json
import math
from collections.abc import Sequence
from typing import TYPE_CHECKING
from typing import Optional

import numpy as np

from ...discrete import face_areas
from ...discrete.arrays import FloatArray
from ...discrete.arrays import IntArray
from ...io.plans.plan import plan_data
from ...meshing import triangles_of
from ...model.checks import check
from ...model.constraint_data import constraint_data
from ...model.lengths import unit_suffix
from ...model.problem import CGCProblem
from ...model.problem import PosesProblem
from ...model.roles import CREASE
from ...model.roles import ROLES
from ..api.decoding import check_size
from ..api.design_files import read_design_file
from ..api.mesh_files import read_upload
from ..api.mesh_files import uploaded
from ..api.remedies import remedies_in
from ..api.units import UNITS
from ..api.wording import in_request_words
from ..errors import Unprocessable
from ..limits import Limits

if TYPE_CHECKING:
    from ...rationalisation import SplineSurface

__all__ = ["contents", "read_example", "read_model", "read_plan", "read_surface"]

SAMPLES = 48  # cells along each parameter of a smooth surface that is shown


def read_model(kind: str, body: bytes, name: str, limits: Limits, edge_length: Optional[float] = None) -> bytes:
    """Return the contents of a file as JSON.

    Parameters
    ----------
    kind
        ``"3dm"`` or ``"obj"``.
    body
        Bytes of the file.
    name
        Name of the mesh.
    limits
        Limits of the server.
    edge_length
        Edge length of the mesh of surfaces or curves [L].

    Raises
    ------
    Unprocessable, TooLarge
        If the file cannot be read or is too large.
    """
    try:
        read = read_upload(kind, body, edge_length=edge_length)
        problem = read.checked()
        check_size(len(problem.vertices), len(problem.faces), limits)
        return _json(contents(problem, read.notes, name))
    except ValueError as error:
        raise Unprocessable(in_request_words(error)) from None


def read_plan(kind: str, body: bytes, join: Optional[float]) -> bytes:
    """Return the curves and points in the bytes of a drawing, as JSON.

    Parameters
    ----------
    kind
        ``"dxf"`` or ``"3dm"``.
    body
        The file.
    join
        Distance within which ends of curves are joined [L]. Default: small gaps are closed.

    Raises
    ------
    Unprocessable
        With a sentence on the file.
    """
    from ...io.plans import read_plan as read_file

    with uploaded(kind, body) as path:
        plan = read_file(path, join=join)
    if not plan.curves:
        raise Unprocessable(f"the file holds no curves; {'; '.join(plan.notes)}")
    short = {full: own for own, full in UNITS.items()}
    return _json({**plan_data(plan), "unit": short.get(plan.unit, "")})


def read_surface(kind: str, body: bytes, limits: Limits) -> bytes:
    """Return the surface in the bytes of a freeform design as a mesh, with what is drawn beside it, as JSON.

    Parameters
    ----------
    kind
        One of :data:`~compas_cgc.server.api.design_files.DESIGN_KINDS`.
    body
        The file.
    limits
        Limits of the server.

    Raises
    ------
    Unprocessable, TooLarge
        If the file cannot be read or is too large.
    """
    try:
        given = read_design_file(kind, body, {}, limits)
        shown = (given.vertices, triangles_of(given.vertices, given.polygons)[0]) if given.surface is None else _sampled(given.surface)
    except ValueError as error:
        raise Unprocessable(in_request_words(error)) from None
    return _json(
        {
            "unit": unit_suffix(given.drawing.units).strip(),
            "vertices": shown[0].tolist(),
            "faces": shown[1].tolist(),
            "smooth": given.surface is not None,
            "supports": [line.tolist() for line in given.supports],
            "seams": [line.tolist() for line in given.seams],
            "notes": list(given.notes),
        }
    )


def _sampled(surface: SplineSurface) -> tuple[FloatArray, IntArray]:
    """Return points (n, 3) and triangles (m, 3) of a grid on a surface."""
    u, v = (np.linspace(low, high, SAMPLES + 1) for low, high in surface.domain.tolist())
    row = SAMPLES + 1
    first = (np.arange(SAMPLES)[:, None] * row + np.arange(SAMPLES)).reshape(-1, 1)
    corners = np.concatenate([first + np.array(own) for own in ((0, row, row + 1), (0, row + 1, 1))])
    return surface.at(np.stack(np.meshgrid(u, v, indexing="ij"), axis=-1).reshape(-1, 2)), corners


def read_example(name: str, title: str, text: str) -> bytes:
    """Return the contents of an example of the paper as JSON."""
    from ...paper.examples import CATALOGUE
    from ...paper.examples import SurfaceExample

    example = next(own for own in CATALOGUE if isinstance(own, SurfaceExample) and own.name == name)
    mesh, settings = example.build()
    return _json({**contents(mesh, [text], title), "settings": {"s": settings.s, "e": settings.e}})


def contents(posed: PosesProblem, notes: Sequence[str], name: str = "") -> dict:
    """Return a mesh with its supports, targets and constraints as JSON data.

    Missing supports and targets are replaced by suggestions, which the notes list. The
    problems are those of the mesh with these suggestions. Vertices and faces are numbered
    from 0 in their order, without dummies.
    """
    own = posed.to_problem().without_dummies()
    notes = list(notes)
    chosen = "file" if len(own.supports) else "boundary"
    if chosen == "boundary":
        notes.append("the file has no supports: the whole edge is supported by default")
    problem, suggested = _with_targets(own if chosen == "file" else own.with_supports("boundary"))
    targets = problem.region_targets()
    if suggested:
        notes.append(f"the file has no curvature{_where(suggested, len(targets))}: a small one is set by default")
    if np.isfinite(own.s).any() or np.isfinite(own.e).any():
        notes.append("the file sets the strategies s and e along creases; this page uses one value of each for all")
    laws = {str(region): str(law) for region, law in problem.laws.items()}
    return {
        "name": name or own.drawing.name,
        "unit": unit_suffix(own.drawing.units).strip(),
        "vertices": problem.vertices.tolist(),
        "faces": problem.faces.tolist(),
        "roles": [ROLES[role] for role in problem.roles.tolist()],
        "supports": {"file": own.supports.tolist(), **{side: _supports(own, side) for side in ("boundary", "corners")}},
        "support_choice": chosen,
        "creases": problem.crease_paths(),
        "goals": [constraint_data(constraint) for constraint in problem.goals],
        "regions": problem.regions().tolist(),
        "targets": targets,
        "vertex_targets": _of_vertices(problem) if None in targets else None,
        **({"laws": laws} if laws else {}),
        "notes": notes,
        "problems": [{"text": in_request_words(said), "fatal": said.fatal, "remedies": remedies_in([said])} for said in check(problem)],
    }


def _supports(problem: CGCProblem, name: str) -> list[int]:
    return problem.with_supports(name).supports.tolist()


def _with_targets(problem: CGCProblem) -> tuple[CGCProblem, list[int]]:
    """Return the problem with a suggested target in every region without one, and the numbers of these regions."""
    regions, areas = problem.regions(), face_areas(problem.vertices, problem.faces)
    suggested, targets = [], np.full(len(problem.vertices), np.nan)
    for region in range(int(regions.max(initial=-1)) + 1):
        inside = np.zeros(len(problem.vertices), bool)
        inside[problem.faces[regions == region]] = True
        inside &= problem.roles != CREASE
        if region in problem.laws or np.isfinite(problem.targets[inside]).any():
            continue
        area = float(areas[regions == region].sum())
        # A cap with one eighth of the integral curvature of a hemisphere.
        targets[inside] = float(f"{math.pi / 4 / area:.1g}") if area > 0 else 0.0
        suggested.append(region)
    return problem.with_targets(targets), suggested


def _where(regions: list[int], count: int) -> str:
    if len(regions) == count:
        return ""
    return f" for region{'s' if len(regions) > 1 else ''} {', '.join(map(str, regions))}"


def _of_vertices(problem: CGCProblem) -> list[Optional[float]]:
    return [K if K == K else None for K in problem.targets.tolist()]


def _json(value: dict) -> bytes:
    return json.dumps(value, ensure_ascii=False, allow_nan=False).encode("utf-8")
