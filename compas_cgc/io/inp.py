"""Input files of CalculiX and Abaqus: a surface of membrane elements with beams, supports and load cases."""

from __future__ import annotations

from collections.abc import Iterable
from collections.abc import Sequence
from typing import NamedTuple
from typing import Union

import numpy as np

from ..discrete.arrays import Edges
from ..discrete.arrays import FloatArray
from ..discrete.arrays import IntArray
from ..errors import CGCError
from ..fabrication.figures import unit_symbol
from ..fabrication.load_cases import LoadCase
from ..fabrication.load_cases import snow_loads
from ..fabrication.load_cases import wind_loads
from ..fabrication.materials import metres_per_unit
from ..fabrication.membrane_state import MembraneState
from ..model.roles import CREASE
from ..model.roles import FIXED
from ..model.roles import FREE

__all__ = ["Model", "inp_text", "load_cases"]

PER_LINE = 12  # numbers of a set on one line; Abaqus reads up to 16
LINE_LENGTH = 120  # of comments; CalculiX reads up to 132 characters
BEAMS = (("CREASE_BEAMS", 1), ("EDGE_BEAMS", 2))  # sets of beams with the kind of their edges in EdgeLoads


class Model(NamedTuple):
    """Sections and further loads of an engineer's model; the modulus is a placeholder.

    Parameters
    ----------
    thickness
        Thickness of the membrane [mm].
    beam
        Side of the square section of the beams along creases and free edges [mm].
    modulus, poisson
        Young's modulus [F/L^2] and Poisson's ratio of membrane and beams.
    snow
        Downward load per area in plan [F/L^2].
    wind
        Wind pressure in plan, a vector of length 2 [F/L^2].
    """

    thickness: float = 10.0
    beam: float = 200.0
    modulus: float = 1e9
    poisson: float = 0.3
    snow: float = 0.0
    wind: Sequence[float] = (0.0, 0.0)


def load_cases(state: MembraneState, model: Model) -> list[LoadCase]:
    """Return the load cases of a model, without those that are zero."""
    V, F = state.problem.vertices, state.problem.faces
    cases = [LoadCase("PRESSURE", pressure=state.pressure)] if state.pressure else []
    cases += [LoadCase("SELF_WEIGHT", weight=state.weight)] if state.weight else []
    cases += [LoadCase("SNOW", forces=snow_loads(V, F, model.snow))] if model.snow else []
    return cases + ([LoadCase("WIND", forces=wind_loads(V, F, np.asarray(model.wind)))] if any(model.wind) else [])


def inp_text(state: MembraneState, model: Union[Model, None] = None) -> str:
    """Return an input file with elements M3D3, beams B31, supports, and one static step per load case.

    Parameters
    ----------
    state
        Surface and forces from :func:`compas_cgc.fabrication.membrane`; the forces are written as comments for every element.
    model
        Sections and further loads.

    Raises
    ------
    CGCError
        If a thickness, beam or modulus is not positive.
    """
    model = model or Model()
    for what in ("thickness", "beam", "modulus"):
        if not getattr(model, what) > 0:
            raise CGCError(f"the {what} of the model must be positive, not {getattr(model, what):g}")
    problem, own = state.problem, state.edge_loads
    millimetre = 1e-3 / metres_per_unit(problem.drawing.units)
    thickness, side = model.thickness * millimetre, model.beam * millimetre
    label = problem.regions()
    lines = ["*HEADING", "compas_cgc", *_comments(state, model), "*NODE"]
    lines += [f"{i}, {_numbers(point)}" for i, point in enumerate(problem.vertices, 1)]
    for region in range(int(label.max()) + 1):
        lines.append(f"*ELEMENT, TYPE=M3D3, ELSET=REGION{region}")
        chosen = np.flatnonzero(label == region)
        lines += [f"{f}, {a}, {b}, {c}" for f, (a, b, c) in zip((chosen + 1).tolist(), (problem.faces[chosen] + 1).tolist())]
    lines += ["*ELSET, ELSET=SURFACE", *(f"REGION{region}," for region in range(int(label.max()) + 1))]
    lines += ["*MATERIAL, NAME=MEMBRANE", "*ELASTIC", _numbers([model.modulus, model.poisson]), "*DENSITY", "1.0"]
    lines += ["*MEMBRANE SECTION, ELSET=SURFACE, MATERIAL=MEMBRANE", _numbers([thickness])]
    if (own.kind > 0).any():
        lines += ["*MATERIAL, NAME=BEAM", "*ELASTIC", _numbers([model.modulus, model.poisson])]
    first = len(problem.faces) + 1
    for name, kind in BEAMS:
        edges = own.edges[own.kind == kind]
        lines += _beams(name, edges, problem.vertices, first, side)
        first += len(edges)
    for name, role in (("SUPPORTS", FIXED), ("CREASES", CREASE), ("FREE_EDGES", FREE)):
        lines += _set("NSET", name, np.flatnonzero(problem.roles == role) + 1)
    held = bool((problem.roles == FIXED).any())
    # Pressure on the negative side acts along the normals in CalculiX and in Abaqus.
    lines += ["*SURFACE, TYPE=ELEMENT, NAME=INSIDE", "SURFACE, SNEG"]
    lines += ["*BOUNDARY", "SUPPORTS, 1, 3"] if held else []
    cases = load_cases(state, model)
    for case in cases:
        lines += [
            f"** load case {case.name}, loads in F and F/{unit_symbol(problem.drawing.units)}^2",
            "*STEP",
            "*STATIC",
            *_loads(case, cases, thickness),
        ]
        lines += ["*NODE PRINT, NSET=SUPPORTS, TOTALS=YES", "RF"] if held else []
        lines += ["*NODE FILE", "U, RF", "*EL FILE", "S", "*END STEP"]
    unit = unit_symbol(problem.drawing.units)
    lines.append(f"** element, N1, N2 [F/{unit}, tension positive], direction of N1 (x, y, z)")
    lines += [
        f"** {f}, {_numbers([*forces, *direction], 9)}"
        for f, (forces, direction) in enumerate(zip(state.forces.tolist(), state.directions[:, 0].tolist()), 1)
    ]
    return "\n".join([*lines, ""])


def _comments(state: MembraneState, model: Model) -> list[str]:
    problem = state.problem
    rim = int((state.edge_loads.kind == 0).sum())
    unit = unit_symbol(problem.drawing.units)
    notes = [
        f"drawing {problem.drawing.name}; lengths and coordinates in {unit}; node and element numbers are mesh numbers plus one",
        f"unit of force: F, that of the loads below, which were given in F/{unit}^2 (F is kN if they were in kN/{unit}^2); "
        f"forces are in F, line loads and membrane forces in F/{unit}, stresses, pressures and moduli in F/{unit}^2",
        f"pressure {state.pressure:.6g} along the normals, weight {state.weight:.6g} downwards per area of the surface, "
        f"snow {model.snow:.6g} downwards per area in plan, wind {_numbers(model.wind, 6)} as pressure along x, y in plan [F/{unit}^2]",
        f"elastic modulus {model.modulus:.6g} F/{unit}^2, Poisson's ratio {model.poisson:g}, membrane {model.thickness:g} mm, beams "
        f"{model.beam:g} x {model.beam:g} mm; density 1: self weight is written as an acceleration of weight over thickness",
        "modulus, thickness and beam section are placeholders; replace them, and the stiffness of the supports, with those of the design",
        "membrane forces N1 and N2 by compas_cgc are comments at the end of this file",
        "CalculiX includes loads applied directly to supported nodes in RF; subtract them to obtain the reactions",
    ]
    loads = np.linalg.norm(state.edge_loads.load[state.edge_loads.kind > 0], axis=1)
    if len(loads):
        notes.append(
            f"statically indeterminate: the beams of this model, squares of {model.beam:g} mm along creases and free edges, are elastic, "
            "and the forces depend on their stiffness against that of the membrane. N1 and N2 below belong to beams and supports that take "
            f"exactly the line loads of compas_cgc, up to {loads.max():.4g}; finite elements find N1 and N2 with these line loads in place "
            "of the beams, and other forces with beams that deflect."
        )
    if rim > 3:
        notes.append(
            f"statically indeterminate: {rim} edges are held in all directions. Equilibrium alone does not determine the membrane forces; "
            "those of this model depend on the elasticity of membrane and supports and differ from N1 and N2 below, which need "
            "supports that take the line loads of compas_cgc."
        )
    return [line for note in notes for line in _wrapped(note)]


def _wrapped(text: str) -> list[str]:
    import textwrap

    plain = text.encode("ascii", "replace").decode()
    return textwrap.wrap(plain, LINE_LENGTH, initial_indent="** ", subsequent_indent="** ")


def _beams(name: str, edges: Edges, vertices: FloatArray, first: int, side: float) -> list[str]:
    """Return beams of square section; their first axis is the coordinate axis least parallel to them."""
    along = np.abs(vertices[edges[:, 1]] - vertices[edges[:, 0]])
    axis, lines = np.argmin(along, axis=1) if len(edges) else np.zeros(0, np.int64), []
    for k in np.unique(axis).tolist():
        elements = np.flatnonzero(axis == k)
        lines.append(f"*ELEMENT, TYPE=B31, ELSET={name}_{'XYZ'[k]}")
        lines += [f"{first + e}, {edges[e, 0] + 1}, {edges[e, 1] + 1}" for e in elements.tolist()]
        lines.append(f"*BEAM SECTION, ELSET={name}_{'XYZ'[k]}, MATERIAL=BEAM, SECTION=RECT")
        lines += [_numbers([side, side]), _numbers(np.eye(3)[k])]
    return lines


def _loads(case: LoadCase, cases: Sequence[LoadCase], thickness: float) -> list[str]:
    """Return the loads of a step; they replace all loads of the previous step, also by zeros."""
    lines = ["*DSLOAD", f"INSIDE, P, {_numbers([case.pressure])}"] if any(own.pressure for own in cases) else []
    if any(own.weight for own in cases):
        # The density is 1, so that the acceleration is the weight per volume.
        lines += ["*DLOAD", f"SURFACE, GRAV, {_numbers([case.weight / thickness])}, 0.0, 0.0, -1.0"]
    rows, columns = np.nonzero(case.forces)
    lines += ["*CLOAD, OP=NEW"] if any(len(own.forces) for own in cases) else []
    return lines + [
        f"{i + 1}, {k + 1}, {_numbers([force])}"
        for i, k, force in zip(rows.tolist(), columns.tolist(), case.forces[rows, columns].tolist())
    ]


def _set(kind: str, name: str, members: IntArray) -> list[str]:
    numbers = [str(number) for number in members.tolist()]
    rows = [", ".join(numbers[k : k + PER_LINE]) for k in range(0, len(numbers), PER_LINE)]
    return [f"*{kind}, {kind}={name}", *rows] if rows else []


def _numbers(values: Iterable[float], digits: int = 12) -> str:
    """Return numbers of at most 20 characters, the longest that CalculiX and Abaqus read."""
    return ", ".join(f"{float(value):.{digits}g}" for value in values)
