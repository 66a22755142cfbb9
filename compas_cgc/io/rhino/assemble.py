"""What is drawn to a surface problem: mesh, supports, creases and targets that fit together."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Callable
from typing import Optional

import numpy as np

from ...meshing import path_edges
from ...meshing.cleanup import mean_edge
from .constraints import find_constraints
from .creases import lay_creases
from .join import join_shell
from .model import Model3dm
from .problem_text import vertex_values
from .sketch import Drawn
from .sketch import Part
from .supports import find_supports
from .targets import find_targets
from .units import unit_suffix

__all__ = ["assemble"]

# Lists of what is drawn depend on how closely curves have to be sampled.
AtTolerance = Callable[[float], list[Drawn]]


def assemble(
    name: str,
    parts: Sequence[Part],
    supports: AtTolerance,
    creases: AtTolerance,
    targets: AtTolerance,
    constraints: AtTolerance,
    units: str,
    tolerance: float,
    solved: Optional[dict[int, Optional[float]]] = None,
    crease: str = "trace",
    notes: Sequence[str] = (),
) -> Model3dm:
    """Fit what is drawn to the vertices and edges of the mesh.

    Parameters
    ----------
    name
        Name of the model.
    parts
        Meshes, to be joined.
    supports, creases, targets, constraints
        Functions that return what is drawn, with curves within the tolerance given to them [L].
    units
        Name of the unit system.
    tolerance
        Distance within which points are one [L].
    solved
        Target of every region of an earlier result.
    crease
        ``"trace"`` or ``"split"``.
    notes
        What has been said already.

    Raises
    ------
    FileError
        If no usable mesh comes of the parts.
    """
    unit = unit_suffix(units)
    reach = tolerance if np.isfinite(tolerance) and tolerance > 0 else 0.0
    shell = join_shell(list(parts), reach, unit)
    size = float(np.linalg.norm(np.ptp(shell.vertices, axis=0)))
    # Points drawn by snapping are off by rounding: that of single precision, or of transforms.
    snap = min(max(reach, 4.0 * shell.rounding, 1e-9 * size), 0.1 * mean_edge(shell.vertices, shell.faces))
    fine = 0.25 * snap
    held, support_notes, support_problems = find_supports(supports(fine), shell.vertices, snap, unit)
    laid = lay_creases(creases(fine), shell, held, snap, crease, unit)
    edges = np.array(path_edges(laid.paths), dtype=np.int64).reshape(-1, 2)
    K, target_notes, target_problems = find_targets(targets(fine), list(parts), solved or {}, laid.shell, edges, unit)
    values = {"target": K, "s": laid.s, "e": laid.e}
    written = vertex_values(parts[0].text if len(parts) == 1 else {}, len(laid.shell.vertices))
    for key, own in written.items():
        values[key] = np.where(np.isfinite(own), own, values[key])
    asked, asked_notes, asked_problems = find_constraints(constraints(fine), laid.shell.vertices, snap, unit)
    return Model3dm(
        name=name,
        vertices=laid.shell.vertices,
        faces=laid.shell.faces,
        supports=held,
        creases=tuple(laid.paths),
        targets=values["target"],
        s=values["s"],
        e=values["e"],
        constraints=tuple(asked),
        units=units,
        tolerance=tolerance,
        notes=tuple([*notes, *shell.notes, *support_notes, *laid.notes, *target_notes, *asked_notes]),
        problems=tuple(support_problems + laid.problems + target_problems + asked_problems),
    )
