"""Function of the component for freeform designs on few moulds, run in the workers."""

from __future__ import annotations

import math
import time

import numpy as np

from ...errors import CGCError
from ..api.rhino_mesh import mesh_text
from ..api.rhino_mesh import polyline_text
from ..limits import Limits
from .data_tree import entry
from .geometry import read_curve
from .inputs import design_of
from .reply import Reply
from .reply import spent

__all__ = ["run_rationalise"]

SAMPLING = 1e-5  # of the size of a design, within which curves are sampled where the tolerance of the document is unknown or finer


def run_rationalise(inputs: dict, context: dict, limits: Limits, started: float) -> Reply:
    """Return the reply of the component."""
    # Workers that never rationalise do without its imports.
    from ...rationalisation import rationalise
    from ...rationalisation.costs import costs_in_order

    locked, own_moulds = inputs["Locked"], inputs["LockedMoulds"]
    if len(locked) != len(own_moulds):
        raise CGCError(f"Locked has {len(locked)} panels and LockedMoulds {len(own_moulds)} moulds; give a mould for every panel")
    problem, notes = design_of(inputs, context, limits)
    read = time.perf_counter()
    own = problem.without_dummies()
    radii = [radius or math.inf for radius in inputs["Radii"]]
    fine = max(context["absolutetolerance"], SAMPLING * float(np.linalg.norm(np.ptp(own.vertices, axis=0))))
    found = rationalise(
        own,
        moulds=radii or (None if inputs["Within"] else inputs["Moulds"]),
        seams=[read_curve(data, "Seams", fine).tolist() for data in inputs["Seams"]] or None,
        within=inputs["Within"] or None,
        panel=inputs["Panel"] or None,
        locked=dict(zip(locked, own_moulds)),
        costs=costs_in_order(inputs["Costs"]),
        weights=inputs["Weights"],
        supports=own.vertices[own.supports].tolist() if len(own.supports) else None,
    )
    done = time.perf_counter()
    V, F = found.result.vertices, found.result.problem.faces
    panels = []
    for number in range(found.panelling.panel_count):
        used, corners = np.unique(F[found.panels == number], return_inverse=True)
        panels.append(mesh_text(V[used], corners.reshape(-1, 3)))
    signed = found.distance.signed
    values = [
        entry("Mesh", "Mesh", [mesh_text(V, F, signed, found.distance.largest or 1.0)]),
        entry("Panels", "Mesh", panels),
        entry("Mould", "Integer", found.classes.tolist()),
        entry("K", "Number", found.curvatures.tolist()),
        entry("Seams", "Curve", [polyline_text(V[seam]) for seam in found.panelling.seams]),
        entry("Distance", "Number", signed.tolist()),
        entry("Info", "Text", ["\n".join([found.summary, *notes])]),
    ]
    warnings = [] if found.kept else [found.suggestion or f"the surface is {found.result.status}"]
    return Reply(200, values, [], warnings, spent(started, read, done))
