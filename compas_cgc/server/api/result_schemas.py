"""JSON Schema of results, derived from the fields of their classes."""

from __future__ import annotations

from dataclasses import fields
from dataclasses import is_dataclass
from typing import Any
from typing import Union
from typing import get_args
from typing import get_origin
from typing import get_type_hints

from ...analysis import MeshQuality
from ...analysis import RegionReport
from ...analysis import Verdict
from ...model.result import STATUSES
from ...model.result import History
from ...model.roles import ROLES
from .remedies import REMEDIES

__all__ = ["PACKED", "RESULT_SCHEMAS"]

PLAIN: dict[Any, dict] = {
    int: {"type": "integer"},
    float: {"type": "number"},
    bool: {"type": "boolean"},
    str: {"type": "string"},
}
NUMBER = {"type": ["number", "null"]}
TEXTS = {"type": "array", "items": {"type": "string"}}
PACKED = {
    "type": "object",
    "required": ["base64", "type", "shape"],
    "properties": {
        "base64": {"type": "string", "contentEncoding": "base64", "description": "little-endian"},
        "type": {"enum": ["f8", "i4"]},
        "shape": {"type": "array", "items": {"type": "integer", "minimum": 0}, "minItems": 1, "maxItems": 2},
    },
}


def _schema_of(cls: type) -> dict:
    """Return the schema of a dataclass."""
    hints = get_type_hints(cls)
    properties = {own.name: _schema_of_hint(hints[own.name]) for own in fields(cls)}
    return {"type": "object", "required": list(properties), "properties": properties}


def _schema_of_hint(hint: Any) -> dict:
    if hint in PLAIN:
        return PLAIN[hint]
    if is_dataclass(hint):
        return _schema_of(hint)  # type: ignore[arg-type]
    inner = get_args(hint)
    if get_origin(hint) is Union:
        # Only Optional is supported: None becomes null.
        return {"type": [_schema_of_hint(inner[0])["type"], "null"]}
    if get_origin(hint) is dict:
        return {"type": "object", "additionalProperties": _schema_of_hint(inner[1])}
    return {"type": "array", "items": _schema_of_hint(inner[0])}


def _rows(items: dict, text: str) -> dict:
    """Return the schema of an array: a list of triples, or packed in the format 'packed'."""
    three = {"type": "array", "items": items, "minItems": 3, "maxItems": 3}
    return {"oneOf": [{"type": "array", "items": three}, {"$ref": "#/components/schemas/Packed"}], "description": text}


def _column(text: str) -> dict:
    return {"oneOf": [{"type": "array", "items": NUMBER}, {"$ref": "#/components/schemas/Packed"}], "description": text}


def _object(required: str, optional: str = "", /, **properties: dict) -> dict:
    """Return the schema of an object with required and optional properties."""
    names = [*required.split(), *optional.split()]
    return {"type": "object", "required": required.split(), "properties": {name: properties[name] for name in names}}


_VERDICT = _schema_of(Verdict)
_VERDICT["properties"] = {"word": {"enum": ["fair", "rough"]}, **_VERDICT["properties"]}
_REPORT = _object(
    "notes",
    "remedies verdict measure other_measures regions quality max_error moved_max moved_mean",
    notes={**TEXTS, "description": "changes made to the input"},
    remedies=REMEDIES,
    verdict={"$ref": "#/components/schemas/Verdict"},
    measure=PLAIN[str],
    other_measures={"type": "object", "additionalProperties": NUMBER, "description": "largest error of K by other measures [1/L^2]"},
    regions={"type": "array", "items": {"$ref": "#/components/schemas/Region"}},
    quality={"$ref": "#/components/schemas/Quality"},
    max_error={**PLAIN[float], "description": "largest |K - target| in the measure of the solve [1/L^2]"},
    moved_max=NUMBER,
    moved_mean=NUMBER,
)
_HISTORY = {
    "type": "object",
    "required": list(History._fields),
    "properties": {name: {"type": "array", "items": PLAIN[bool] if name == "accepted" else NUMBER} for name in History._fields},
}
_RESULT = _object(
    "status message ending iterations seconds max_error method measure evenness vertices faces turned roles targets curvature creases "
    "history report",
    status={"enum": list(STATUSES)},
    message={**PLAIN[str], "description": "verdict, surface and ending; if K was not reached, the reason"},
    ending={**PLAIN[str], "description": "how the method ended"},
    iterations=PLAIN[int],
    seconds=PLAIN[float],
    max_error={**NUMBER, "description": "largest residual of K in the equations of the method; that of the surface is in report [1/L^2]"},
    method=PLAIN[str],
    measure=PLAIN[str],
    evenness={
        **PLAIN[float],
        "description": "length over which the curvature varies evenly, relative to the square root of the area",
    },
    vertices=_rows(PLAIN[float], "the surface (n, 3) [L]"),
    faces=_rows(PLAIN[int], "(m, 3)"),
    turned={**PLAIN[int], "description": "number of faces changed by flipping overstretched edges for K < 0"},
    roles={"type": "array", "items": {"enum": list(ROLES)}},
    targets=_column("(n,) [1/L^2]"),
    curvature=_column("(n,), null or NaN where K is not prescribed or cannot be read, as beside supports [1/L^2]"),
    creases={"type": "array", "items": {"type": "array", "items": PLAIN[int]}, "description": "paths of vertices"},
    history={"$ref": "#/components/schemas/History"},
    report={"$ref": "#/components/schemas/Report"},
)
_BUILD = _object("task formats notes", "text", task=PLAIN[str], formats=TEXTS, notes=TEXTS, text=PLAIN[str])
_SUBMITTED = _object(
    "id state status_url events_url result_url",
    **dict.fromkeys(("id", "state", "status_url", "events_url", "result_url"), PLAIN[str]),
)
_HEALTH = _object(
    "status",
    "workers starting idle busy waiting replaced",
    status={"enum": ["starting", "ok"]},
    **dict.fromkeys(("workers", "starting", "idle", "busy", "waiting", "replaced"), PLAIN[int]),
)
_VERSION = _object("name version api instance", **dict.fromkeys(("name", "version", "instance"), PLAIN[str]), api=PLAIN[int])
_EXAMPLE = _object("name number title text", number=PLAIN[int], **dict.fromkeys(("name", "title", "text"), PLAIN[str]))
_EXAMPLES = _object("examples", examples={"type": "array", "items": _EXAMPLE})

RESULT_SCHEMAS = {
    "Result": _RESULT,
    "Build": _BUILD,
    "Packed": PACKED,
    "History": _HISTORY,
    "Report": _REPORT,
    "Verdict": _VERDICT,
    "Region": _schema_of(RegionReport),
    "Quality": _schema_of(MeshQuality),
    "Submitted": _SUBMITTED,
    "Health": _HEALTH,
    "Version": _VERSION,
    "Examples": _EXAMPLES,
}
