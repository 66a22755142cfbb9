"""Result files of CalculiX (.frd, ASCII): displacements and stresses of a membrane, step by step."""

from __future__ import annotations

import os
from dataclasses import replace
from pathlib import Path
from typing import NamedTuple
from typing import Optional
from typing import Union

import numpy as np

from ..discrete import face_normals
from ..discrete.arrays import FloatArray
from ..errors import FileError
from ..fabrication.membrane_fields import principal_forces
from ..fabrication.membrane_state import MembraneState

__all__ = ["FrdStep", "read_frd", "with_results"]

_FIELDS = {"DISP": 3, "STRESS": 6}  # blocks that are read, with the number of their components
_AXES = ((0, 0), (1, 1), (2, 2), (0, 1), (1, 2), (2, 0))  # of the components of a stress


class FrdStep(NamedTuple):
    """Results of one load case at the corners of the faces."""

    displacements: FloatArray  # (m, 3, 3) [L]
    stresses: FloatArray  # (m, 3, 3, 3) [F/L^2]


def read_frd(path: Union[str, os.PathLike], count: int) -> list[FrdStep]:
    """Return the results of every load case in an .frd file.

    CalculiX writes a membrane as triangles, or with beams in the model as wedges with nodes of their own; a corner of a face is
    then the mean of both sides.

    Parameters
    ----------
    path
        File that CalculiX wrote for a model of :func:`compas_cgc.io.inp.inp_text`.
    count
        Number of faces m of the mesh; face f is element f + 1.

    Raises
    ------
    FileError
        If the file cannot be read, holds no results, or belongs to another mesh.
    """
    try:
        lines = Path(path).read_text("ascii", "replace").splitlines()
    except OSError as error:
        raise FileError(f"{path} cannot be read: {error.strerror}") from None
    try:
        elements, blocks = _parsed(lines)
        corners = [elements[f] for f in range(1, count + 1)]
        if any(len(own) not in (3, 6) for own in corners):
            raise KeyError("some faces")
        steps = [FrdStep(*(_at_corners(own, corners) for own in pair)) for pair in zip(blocks["DISP"], blocks["STRESS"])]
    except KeyError as error:
        raise FileError(
            f"{path} has no results for element or node {error.args[0]} of this mesh of {count} faces; "
            "use the results of the .inp file written for this mesh"
        ) from None
    except ValueError:
        raise FileError(f"{path} is damaged; run CalculiX again") from None
    if not steps or len(blocks["DISP"]) != len(blocks["STRESS"]):
        raise FileError(f"{path} does not hold displacements and stresses of a step; request U and S, and run CalculiX again")
    return [FrdStep(own.displacements, _tensors(own.stresses)) for own in steps]


def _parsed(lines: list[str]) -> tuple[dict[int, list[int]], dict[str, list[dict[int, list[float]]]]]:
    """Return the nodes of every element, and per field and step the values of every node."""
    elements: dict[int, list[int]] = {}
    blocks: dict[str, list[dict[int, list[float]]]] = {name: [] for name in _FIELDS}
    field, element = "", 0
    for line in lines:
        code = line[:3]
        if line[:6] == "    3C":
            field = "ELEMENTS"
        elif code == " -4":
            field = line[5:13].strip()
            if field in _FIELDS:
                blocks[field].append({})
        elif code == " -3":
            field = ""
        elif field == "ELEMENTS" and code == " -1":
            element = int(line[3:13])
        elif field == "ELEMENTS" and code == " -2":
            elements.setdefault(element, []).extend(int(node) for node in line[3:].split())
        elif field in _FIELDS and code == " -1":
            blocks[field][-1][int(line[3:13])] = [float(line[13 + 12 * k : 25 + 12 * k]) for k in range(_FIELDS[field])]
    return elements, blocks


def _at_corners(values: dict[int, list[float]], corners: list[list[int]]) -> FloatArray:
    """Return values of nodes at the three corners of every face, means over both sides of wedges (m, 3, k)."""
    return np.array([np.mean([[values[node] for node in own[k : k + 3]] for k in range(0, len(own), 3)], axis=0) for own in corners])


def with_results(state: MembraneState, path: Union[str, os.PathLike], thickness: Optional[float] = None, step: int = 1) -> MembraneState:
    """Return a state with the principal forces that CalculiX computed, for the same files and pictures.

    Parameters
    ----------
    state
        The state from which the model was written.
    path
        Result file (.frd).
    thickness
        Thickness of the membrane in the model [L]. Default: that in the .inp file of the same name beside the results.
    step
        Number of the load case, from 1.

    Returns
    -------
    MembraneState
        N1, N2 and their directions from the file; reactions, edge forces and line loads remain those of equilibrium.

    Raises
    ------
    FileError
        If the file does not fit the surface or has no such step, or the thickness is unknown or not that of the .inp file.
    """
    thick = _checked_thickness(Path(path), thickness)
    V, F = state.problem.vertices, state.problem.faces
    steps = read_frd(path, len(F))
    if not 1 <= step <= len(steps):
        raise FileError(f"{path} has load cases 1 to {len(steps)}, not {step}")
    own = steps[step - 1]
    forces, directions = principal_forces(thick * own.stresses, face_normals(V, F))
    off = np.abs(forces - state.forces).max(axis=1) / np.abs(state.forces).max(axis=1)
    remark = (
        f"N1 and N2 are those of load case {step} in {Path(path).name}; they differ from the membrane forces in equilibrium by "
        f"{100 * np.median(off):.3g} % (median) and {100 * np.percentile(off, 95):.3g} % (95th percentile); largest displacement "
        f"{np.linalg.norm(own.displacements, axis=2).max():.3g}"
    )
    return replace(state, forces=forces, directions=directions, remarks=(*state.remarks, remark))


def _checked_thickness(path: Path, given: Optional[float]) -> float:
    """Return the thickness of the membrane in the model that led to results."""
    model = path.with_suffix(".inp")
    try:
        lines = model.read_text("ascii", "replace").splitlines()
    except OSError:
        lines = []
    sections = [k for k, line in enumerate(lines) if line.startswith("*MEMBRANE SECTION")]
    written = float(lines[sections[0] + 1].split(",")[0]) if sections else None
    if written is None:
        if given is None:
            raise FileError(f"there is no {model.name} beside {path.name}, which states the thickness of the membrane; give the thickness")
        return given
    if given is not None and abs(written - given) > 1e-6 * written:
        raise FileError(f"{model.name} has a membrane {written:g} thick, not {given:g}, in model units; omit the thickness")
    return written


def _tensors(components: FloatArray) -> FloatArray:
    """Return the symmetric matrices (m, 3, 3, 3) of stress components (m, 3, 6)."""
    tensors = np.empty((*components.shape[:2], 3, 3))
    for k, (i, j) in enumerate(_AXES):
        tensors[..., i, j] = tensors[..., j, i] = components[..., k]
    return tensors
