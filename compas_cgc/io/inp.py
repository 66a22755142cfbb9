"""Input files of CalculiX and Abaqus: a surface as membrane elements."""

from __future__ import annotations

import numpy as np

from ..fabrication.membrane_state import MembraneState
from ..model.roles import CREASE
from ..model.roles import FIXED
from ..model.roles import FREE

__all__ = ["inp_text"]

_PER_LINE = 12


def inp_text(state: MembraneState, thickness: float = 0.01, modulus: float = 1e9, poisson: float = 0.3) -> str:
    """Return a surface with its supports and load as an input file: M3D3 elements, sets of nodes and regions, a static step.

    Parameters
    ----------
    state
        Forces from :func:`compas_cgc.fabrication.membrane`; they are written as comments for every element.
    thickness
        Thickness of the membrane [L].
    modulus, poisson
        Young's modulus [F/L^2] and Poisson's ratio. All three defaults are placeholders.
    """
    problem = state.problem
    lines = [
        "*HEADING",
        f"compas_cgc: {problem.drawing.name}, units {problem.drawing.units or 'Meters'}; numbers are mesh numbers plus one",
        f"** pressure {state.pressure!r} along the normals, weight {state.weight!r} downwards per unit area",
        "** membrane forces by compas_cgc: N1 and N2 of every element at the end of this file",
        "*NODE",
    ]
    lines += [f"{i}, {x!r}, {y!r}, {z!r}" for i, (x, y, z) in enumerate(problem.vertices.tolist(), 1)]
    label = problem.regions()
    for region in range(int(label.max()) + 1):
        lines.append(f"*ELEMENT, TYPE=M3D3, ELSET=REGION{region}")
        own = np.flatnonzero(label == region)
        lines += [f"{f}, {a}, {b}, {c}" for f, (a, b, c) in zip((own + 1).tolist(), (problem.faces[own] + 1).tolist())]
    lines += ["*ELSET, ELSET=ALL", *(f"REGION{region}," for region in range(int(label.max()) + 1))]
    for name, role in (("SUPPORTS", FIXED), ("CREASES", CREASE), ("FREE_EDGES", FREE)):
        nodes = (np.flatnonzero(problem.roles == role) + 1).tolist()
        if nodes:
            lines.append(f"*NSET, NSET={name}")
            lines += [", ".join(map(str, nodes[k : k + _PER_LINE])) for k in range(0, len(nodes), _PER_LINE)]
    lines += ["*MATERIAL, NAME=MEMBRANE", "*ELASTIC", f"{modulus!r}, {poisson!r}"]
    lines += ["*DENSITY", "1.0"] if state.weight else []
    lines += ["*MEMBRANE SECTION, ELSET=ALL, MATERIAL=MEMBRANE", repr(float(thickness)), "*STEP", "*STATIC"]
    if (problem.roles == FIXED).any():
        lines += ["*BOUNDARY", "SUPPORTS, 1, 3"]
    if state.pressure:
        # In Abaqus, a positive P acts along the normal of a membrane.
        lines += ["*DLOAD", f"ALL, P, {state.pressure!r}"]
    if state.weight:
        lines += ["*DLOAD", f"ALL, GRAV, {state.weight / thickness!r}, 0.0, 0.0, -1.0"]
    lines += ["*NODE PRINT, NSET=SUPPORTS", "RF"] if (problem.roles == FIXED).any() else []
    lines += ["*EL PRINT, ELSET=ALL", "S", "*END STEP", "** element, N1, N2, direction of N1"]
    for f, ((N1, N2), direction) in enumerate(zip(state.forces.tolist(), state.directions[:, 0].tolist()), 1):
        lines.append(f"** {f}, {N1:.9g}, {N2:.9g}, {', '.join(f'{x:.9g}' for x in direction)}")
    return "\n".join([*lines, ""])
