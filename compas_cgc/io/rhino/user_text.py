"""User text: numbers in text dots and objects, and the data of a problem that layers cannot show."""

from __future__ import annotations

import hashlib
import json
import math
import re
from collections.abc import Mapping
from collections.abc import Sequence
from typing import Optional

import numpy as np

from ...discrete.arrays import FloatArray
from ...discrete.arrays import IntArray
from ...model.constraint_data import constraint_data
from ...model.constraint_data import constraint_of
from ...model.constraints import Constraint
from ...model.constraints import check_indices
from ...model.laws import ConstantCurvature
from ...model.laws import Law
from ...model.laws import as_law
from ...model.measures import known_measure
from ...model.problem import CGCProblem
from ...model.problem import Origin

__all__ = [
    "GOALS_KEY",
    "VERTEX_KEY",
    "constraint_text",
    "dot_law",
    "drawn_from",
    "drawn_text",
    "text_constraints",
    "user_law",
    "user_number",
    "vertex_text",
    "vertex_values",
]

# Keys of user text on a mesh: values of single vertices, if not constant in a region, and
# constraints that cannot be drawn.
VERTEX_KEY = "cgc vertices"
GOALS_KEY = "cgc goals"
# On the drawing that a mesh was found for: the digest of that mesh, which changes when it is edited.
FOUND_KEY = "cgc found"

_NUMBER = r"[+-]?(?:\d+[.,]?\d*|[.,]\d+)(?:[eE][+-]?\d+)?"
_NAMED = re.compile(rf"^\s*(?:k|target)\s*[=:]\s*({_NUMBER})\s*$", re.IGNORECASE | re.MULTILINE)
_BARE = re.compile(rf"^\s*({_NUMBER})\s*$")


def dot_law(text: str, named: bool = False) -> Optional[Law]:
    """Return the law in a text dot such as ``K=0.03`` or ``H=0.1``, or None; with `named`, bare numbers are ignored."""
    found = _NAMED.search(text or "")
    if found:
        return _constant(_number(found.group(1)))
    for line in (text or "").splitlines():
        law = _law(line) if "=" in line or line.strip().lower() == "minimal" else None
        if law is not None:
            return law
    return None if named else _constant(_number(text))


def user_number(text: Mapping[str, str], *keys: str) -> Optional[float]:
    """Return the number under the first key that the user text has, or None."""
    for key in keys:
        if key in text:
            return _number(text[key])
    return None


def user_law(text: Mapping[str, str]) -> Optional[Law]:
    """Return the law in user text under the key ``law``, or the target under ``K`` or ``target``; case is ignored."""
    return _law(text["law"]) if "law" in text else _constant(user_number(text, "k", "target"))


def _constant(K: Optional[float]) -> Optional[Law]:
    return None if K is None else ConstantCurvature(K)


def _law(text: str) -> Optional[Law]:
    """Return the law in a text, with decimal points or commas, or None."""
    try:
        return as_law(text.replace(",", "."))
    except ValueError:
        return None


def _number(text: str) -> Optional[float]:
    """Return the finite number in a text, with a decimal point or comma, or None."""
    found = _BARE.match(text or "")
    if not found:
        return None
    value = float(found.group(1).replace(",", "."))
    return value if math.isfinite(value) else None


def vertex_text(problem: CGCProblem) -> dict[str, str]:
    """Return user text with the values of single vertices, empty if all regions are constant."""
    values = {}
    if None in problem.region_laws() and np.isfinite(problem.targets[problem.asked]).any():
        values["target"] = problem.targets
    for name in ("s", "e"):
        if np.isfinite(getattr(problem, name)).any():
            values[name] = getattr(problem, name)
    plain = {name: [None if x != x else x for x in column.tolist()] for name, column in values.items()}
    return {VERTEX_KEY: json.dumps(plain)} if plain else {}


def vertex_values(text: Mapping[str, str], n: int) -> dict[str, FloatArray]:
    """Return the values of single vertices in the user text of a mesh with n vertices.

    Returns
    -------
    dict
        ``target``, ``s``, ``e``, each (n,), NaN if not set; empty if the text belongs to
        another mesh.
    """
    try:
        found = json.loads(text.get(VERTEX_KEY, "{}"))
        columns = {name: np.array([np.nan if x is None else x for x in values], dtype=np.float64) for name, values in found.items()}
    except (AttributeError, TypeError, ValueError):
        return {}
    return {name: values for name, values in columns.items() if name in ("target", "s", "e") and values.shape == (n,)}


def constraint_text(constraints: Sequence[Constraint], n: int) -> dict[str, str]:
    """Return user text with constraints on a mesh with n vertices, empty if there are none."""
    data = {"vertices": n, "goals": [constraint_data(constraint) for constraint in constraints]}
    return {GOALS_KEY: json.dumps(data)} if constraints else {}


def text_constraints(text: Mapping[str, str], n: int) -> tuple[Constraint, ...]:
    """Return the constraints in the user text of a mesh with n vertices.

    Raises
    ------
    ValueError
        If the text is malformed, or belongs to another mesh.
    """
    if GOALS_KEY not in text:
        return ()
    found = json.loads(text[GOALS_KEY])
    if not isinstance(found, dict) or not isinstance(found.get("goals"), list):
        raise ValueError("it is not a list of goals")
    if found.get("vertices") != n:
        raise ValueError(f"it belongs to a mesh with {found.get('vertices')} vertices, but this mesh has {n}")
    constraints = tuple(constraint_of(item) for item in found["goals"])
    check_indices(constraints, n)
    return constraints


def drawn_text(problem: CGCProblem) -> dict[str, str]:
    """Return user text of the drawing that the surface of a problem was found for."""
    _, _, measure, evenness = problem.origin or Origin(problem, problem.vertices)
    return {FOUND_KEY: _digest(problem), **({"measure": measure} if measure else {}), **({"evenness": repr(evenness)} if evenness else {})}


def drawn_from(problem: CGCProblem, vertices: FloatArray, faces: IntArray, text: Mapping[str, str]) -> CGCProblem:
    """Return the problem of a surface with the drawing (n, 3), (m, 4) that it was found for [L], without it if either was edited since."""
    same = text.get(FOUND_KEY) == _digest(problem) and vertices.shape == problem.vertices.shape
    if not same or not np.array_equal(faces[:, :3], problem.faces) or not np.isfinite(vertices).all():
        return problem
    return problem.drawn_as(vertices, known_measure(text.get("measure")), max(user_number(text, "evenness") or 0.0, 0.0))


def _digest(problem: CGCProblem) -> str:
    # Negative zeros are lost in text formats and equal in all others.
    return hashlib.sha256((problem.vertices + 0.0).tobytes() + problem.faces.tobytes()).hexdigest()
