"""Saved state: texts in the file of a definition, by component and run, and problems as texts."""

from __future__ import annotations

import base64
import hashlib
import io
import json
from collections.abc import Mapping
from typing import Any
from typing import NamedTuple
from typing import Optional

import numpy as np

from ..._version import __version__
from ...model.constraint_data import constraint_data
from ...model.problem import CGCProblem
from ...model.problem import Drawing
from ...model.problem import Names
from ...model.problem import Origin
from .headless import is_headless
from .memories import run_of

__all__ = ["Saved", "delete", "load", "problem_from_text", "problem_to_text", "save"]

PREFIX = "compas_cgc"
COLUMNS = ("vertices", "faces", "roles", "targets", "s", "e", "creases")


class Saved(NamedTuple):
    """State of a run of a component."""

    text: str
    inputs: str  # hash of the inputs and the version of the package

    def is_for(self, inputs: tuple[str, ...]) -> bool:
        """Check whether the state belongs to inputs, given by their fingerprints."""
        return self.inputs == _hash(inputs)


def save(component: Any, inputs: tuple[str, ...], text: str) -> None:
    """Save a text with the definition of a component, and delete those of components that no longer exist."""
    table = _table(component)
    if table is None:
        return
    _delete_orphans(component.OnPingDocument(), table)
    key = _key(component)
    # Inputs can contain the key of a server, so only a hash is saved.
    table.SetValue(key, json.dumps({"inputs": _hash(inputs), "text": text}))
    table.SetValue(PREFIX, json.dumps(sorted({*_keys(table), key})))


def load(component: Any) -> Optional[Saved]:
    """Return what was saved for this run of a component, or None."""
    table = _table(component)
    found = "" if table is None else str(table.GetValue(_key(component), "") or "")
    return Saved(**json.loads(found)) if found else None


def delete(component: Any) -> None:
    """Delete what was saved for this run of a component."""
    table = _table(component)
    if table is not None:
        table.DeleteValue(_key(component))


def problem_to_text(problem: CGCProblem) -> str:
    """Return a problem as a text, without loss."""
    out = io.BytesIO()
    np.savez_compressed(out, **_arrays(problem))
    return base64.b64encode(out.getvalue()).decode("ascii")


def problem_from_text(text: str) -> CGCProblem:
    """Return the problem of a text."""
    with np.load(io.BytesIO(base64.b64decode(text)), allow_pickle=False) as arrays:
        return _problem({name: arrays[name] for name in arrays.files})


def _arrays(problem: CGCProblem, prefix: str = "") -> dict[str, Any]:
    data = {
        "goals": [constraint_data(goal) for goal in problem.goals],
        "laws": {region: str(law) for region, law in problem.laws.items()},
        "drawing": problem.drawing._asdict(),
        "measure": None if problem.origin is None else problem.origin.measure,
        "evenness": 0.0 if problem.origin is None else problem.origin.evenness,
    }
    made = {name: getattr(problem, name) for name in COLUMNS}
    made.update(vertex_names=problem.names.vertices, face_names=problem.names.faces, data=np.array(json.dumps(data)))
    found = {prefix + name: column for name, column in made.items()}
    if problem.origin is not None:
        found[f"{prefix}found"] = problem.origin.vertices
        found.update(_arrays(problem.origin.drawn, f"{prefix}drawn."))
    return found


def _problem(arrays: Mapping[str, Any], prefix: str = "") -> CGCProblem:
    data = json.loads(str(arrays[f"{prefix}data"]))
    places = tuple((name, points) for name, points in data["drawing"].pop("places"))
    north = tuple(data["drawing"].pop("north", Drawing().north))
    origin = None
    if data["measure"] is not None:
        origin = Origin(_problem(arrays, f"{prefix}drawn."), arrays[f"{prefix}found"], data["measure"], data.get("evenness", 0.0))
    return CGCProblem(
        **{name: arrays[prefix + name] for name in COLUMNS},
        goals=tuple(data["goals"]),
        laws={int(region): law for region, law in data["laws"].items()},
        names=Names(arrays[f"{prefix}vertex_names"], arrays[f"{prefix}face_names"]),
        drawing=Drawing(**data["drawing"], places=places, north=north),
        origin=origin,
    )


def _table(component: Any) -> Optional[Any]:
    """Return the values that Grasshopper saves with a definition; headless documents are not saved."""
    return None if is_headless(component) else getattr(component.OnPingDocument(), "ValueTable", None)


def _key(component: Any) -> str:
    return f"{PREFIX}:{component.InstanceGuid}:{run_of(component)}"


def _keys(table: Any) -> list[str]:
    return json.loads(str(table.GetValue(PREFIX, "") or "[]"))


def _delete_orphans(document: Any, table: Any) -> None:
    import System

    keys = _keys(table)
    kept = [key for key in keys if document.FindObject(System.Guid(key.split(":")[1]), True) is not None]
    for key in set(keys) - set(kept):
        table.DeleteValue(key)
    table.SetValue(PREFIX, json.dumps(kept))


def _hash(inputs: tuple[str, ...]) -> str:
    return hashlib.blake2b(repr((__version__, inputs)).encode("utf-8"), digest_size=20).hexdigest()
