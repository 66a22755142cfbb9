"""What a file or an example holds, as JSON for the page; made in the workers."""

from __future__ import annotations

import json
import math
from typing import TYPE_CHECKING
from typing import Optional

import numpy as np

from ..api.decoding import check_size
from ..api.mesh_files import read_upload
from ..errors import Unprocessable
from ..limits import Limits

if TYPE_CHECKING:
    from ...datastructures import CGCMesh
    from ...io.asked import Asked

__all__ = ["contents", "read_example", "read_model"]


def read_model(kind: str, body: bytes, name: str, limits: Limits) -> bytes:
    """Tell what is in the bytes of a file, as JSON.

    Parameters
    ----------
    kind
        ``"3dm"`` or ``"obj"``.
    body
        The file.
    name
        What to call the mesh.
    limits
        Those of the server.

    Raises
    ------
    Unprocessable, TooLarge
        With a sentence on the file.
    """
    try:
        mesh, notes = read_upload(kind, body)
        check_size(mesh.number_of_vertices(), mesh.number_of_faces(), limits)
        mesh.name = name or mesh.name
        return _json(contents(mesh, notes))
    except ValueError as error:
        raise Unprocessable(str(error)) from None


def read_example(name: str, title: str, text: str) -> bytes:
    """Tell what is in an example of the paper, as JSON."""
    from ...paper.examples import CATALOGUE

    example = next(example for example in CATALOGUE if example.name == name)
    mesh, settings = example.build()
    mesh.name = title
    return _json({**contents(mesh, [text]), "s": settings.s, "e": settings.e})


def contents(mesh: CGCMesh, notes: list[str]) -> dict:
    """Return a mesh with what is asked of it, as plain data.

    Supports and targets that are not there are suggested, which the notes say; the
    problems are those of the mesh with these. Vertices and faces are numbered from 0 in
    their order, without dummies.
    """
    from ...io.asked import asked_of
    from ...io.rhino.units import unit_suffix

    mesh, notes = mesh.without_dummies(), list(notes)
    own = asked_of(mesh)
    index = {key: i for i, key in enumerate(mesh.vertices())}
    named = {name: _supports(mesh, name, index) for name in ("boundary", "corners")}
    chosen = "file" if len(own.supports) else "boundary"
    if chosen == "boundary":
        notes.append("no supports are given: the whole edge is held, to begin with")
        mesh.set_supports("boundary")
    targets, suggested = _targets(mesh)
    if suggested:
        notes.append(f"no curvature is given{_where(suggested, len(targets))}; a gentle one is set, to begin with")
    if np.isfinite(own.s).any() or np.isfinite(own.e).any():
        notes.append("the file sets the strategies s and e along creases; here one of each holds for all")
    asked = asked_of(mesh)
    return {
        "name": mesh.name,
        "unit": unit_suffix(mesh.attributes.get("units") or "").strip(),
        "vertices": asked.vertices.tolist(),
        "faces": asked.faces.tolist(),
        "roles": [mesh.vertex_role(key) for key in mesh.vertices()],
        "supports": {"file": own.supports.tolist(), **named},
        "support_choice": chosen,
        "creases": asked.creases,
        "constraints": mesh.attributes.get("constraints") or [],
        "regions": asked.regions.tolist(),
        "targets": targets,
        "vertex_targets": _of_vertices(asked) if None in targets else None,
        "notes": notes,
        "problems": [{"text": str(problem), "fatal": problem.fatal} for problem in mesh.check()],
    }


def _supports(mesh: CGCMesh, name: str, index: dict[int, int]) -> list[int]:
    copy = mesh.without_dummies()
    copy.set_supports(name)
    return sorted(index[key] for key in copy.supports())


def _targets(mesh: CGCMesh) -> tuple[list[Optional[float]], list[int]]:
    """Return the target of every region, None where it is not one number, after setting one where there is none; and where."""
    targets: list[Optional[float]] = []
    suggested = []
    for region, faces in enumerate(mesh.regions()):
        K = mesh.region_target(region)
        if K is None and not any(mesh.vertex_target(key) is not None for key in mesh.region_vertices(region)):
            area = sum(mesh.face_area(face) for face in faces)
            # A cap that turns through an eighth of what a hemisphere does.
            K = float(f"{math.pi / 4 / area:.1g}") if area > 0 else 0.0
            mesh.set_target(K, region=region)
            suggested.append(region)
        targets.append(K)
    return targets, suggested


def _where(regions: list[int], count: int) -> str:
    if len(regions) == count:
        return ""
    return f" for region{'s' if len(regions) > 1 else ''} {', '.join(map(str, regions))}"


def _of_vertices(asked: Asked) -> list[Optional[float]]:
    return [K if K == K else None for K in asked.targets.tolist()]


def _json(value: dict) -> bytes:
    return json.dumps(value, ensure_ascii=False, allow_nan=False).encode("utf-8")
