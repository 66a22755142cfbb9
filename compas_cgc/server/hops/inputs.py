"""What is connected to the inputs of a solve, as a mesh with what is asked of it."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from ...errors import CGCError
from ...io.rhino.assemble import assemble
from ...io.rhino.sketch import Drawn
from ..api.options import Asked
from ..api.options import read_asked
from ..api.requests import Given
from ..errors import Unprocessable
from ..limits import Limits
from .endpoints import SOLVE_INPUTS
from .geometry import read_curve
from .geometry import read_mesh

if TYPE_CHECKING:
    from ...io.rhino.model import Model3dm

__all__ = ["given_surface", "given_with_targets"]

DEFAULTS = {own.name: own.default for own in SOLVE_INPUTS}


def given_surface(inputs: dict, context: dict) -> Given:
    """Return the mesh of the input Mesh, welded and triangulated."""
    return _given(_assembled({"Mesh": inputs["Mesh"]}, context))


def given_with_targets(inputs: dict, context: dict) -> tuple[Given, Asked]:
    """Return the mesh with what is drawn on it, and what is asked of it.

    Parameters
    ----------
    inputs
        Of ``cgc/solve``, by name.
    context
        ``modelunits`` and ``absolutetolerance`` of the document [L], ``limits`` of the server.

    Raises
    ------
    Unprocessable, CGCError
        With a sentence that names the input.
    """
    K, At = inputs["K"], inputs["At"]
    if At and len(At) != len(K):
        raise Unprocessable(f"input 'At' has {len(At)} points for {len(K)} numbers of K; connect one point per number")
    if not At and len(K) != 1:
        raise Unprocessable(f"input 'K' has {len(K)} numbers; connect as many points At, one in each region, or one number for all")
    model = _assembled(inputs, context)
    return _given(model), _asked(inputs, len(model.vertices), context["limits"])


def _asked(inputs: dict, count: int, limits: Limits) -> Asked:
    asked: dict = {"method": inputs["Method"], "settings": {}}
    if not inputs["Supports"]:
        asked["supports"] = "boundary"
    if not inputs["At"]:
        asked["targets"] = inputs["K"][0]
    if inputs["Tolerance"] > 0:
        asked["settings"]["tolerance"] = inputs["Tolerance"]
    if (inputs["S"], inputs["Delay"]) != (DEFAULTS["S"], DEFAULTS["Delay"]):
        asked["settings"].update(s=inputs["S"], e=inputs["Delay"])
        asked["method"] = "flow" if asked["method"] == "auto" else asked["method"]
    elif asked["method"] == "auto" and asked["settings"]:
        raise Unprocessable("input 'Tolerance' belongs to a method; set Method to flow, newton or projection too")
    return read_asked(asked, count, limits)


def _given(model: Model3dm) -> Given:
    """Return a model as arrays: a mesh of COMPAS in between would take half of the time."""
    from ...model import posing
    from ...model.checks import Names
    from ...model.problem import CGCProblem

    problem = posing.set_creases(CGCProblem(model.vertices, model.faces), model.creases)
    problem = posing.set_supports(problem, model.supports.tolist())
    names = Names(np.arange(len(model.vertices)), np.arange(len(model.faces)))
    # What the model lacks is said by the check of the solve, in the words of the inputs.
    notes = [note for note in model.notes if "no support" not in note]
    return Given(replace(problem, targets=model.targets), names, model.name, notes)


def _assembled(inputs: dict, context: dict) -> Model3dm:
    part = read_mesh(inputs["Mesh"], "Mesh", context["limits"])
    supports = np.array(inputs.get("Supports") or [], dtype=np.float64).reshape(-1, 3)
    curves = inputs.get("Creases") or []
    places = inputs.get("At") or []

    def support(tolerance: float) -> list[Drawn]:
        return [Drawn("of input 'Supports'", "point cloud", supports, None, {})] if len(supports) else []

    def creases(tolerance: float) -> list[Drawn]:
        named = enumerate(curves)
        return [Drawn(f"{i} of input 'Creases'", "curve", read_curve(data, "Creases", tolerance), None, {}) for i, data in named]

    def targets(tolerance: float) -> list[Drawn]:
        named = enumerate(zip(inputs["K"], places))
        return [Drawn(f"point {i} of input 'At'", "point", np.array([place]), K, {}) for i, (K, place) in named]

    model = assemble(
        "mesh",
        [part],
        support,
        creases,
        targets if places else lambda tolerance: [],
        lambda tolerance: [],
        context["modelunits"],
        context["absolutetolerance"],
    )
    if model.problems:
        raise CGCError("; ".join(model.problems))
    return model
