"""JSON Schema of requests and responses."""

from __future__ import annotations

from ...io.formats import FORMATS
from ...meshing.boundary import SUPPORT_NAMES
from ...model.constraint_data import KINDS as CONSTRAINTS
from ...solvers.registry import method_names
from ..jobs.designs import MODES
from .builds import SOLVE
from .builds import TASK_NAMES
from .builds import tasks
from .methods import settings_schema
from .options import USER_ROLES
from .remedies import REMEDIES
from .result_schemas import PACKED
from .units import UNITS

__all__ = [
    "BYTES",
    "CURVATURES",
    "DESIGN",
    "DESIGN_LIST",
    "JOB",
    "JOB_LIST",
    "LINK",
    "LINK_LIST",
    "LINK_REQUEST",
    "METHODS",
    "MODEL",
    "PAGE",
    "PROBLEM",
    "STATES",
    "SURFACE",
    "TASKS",
    "build_schema",
    "drawing_schema",
    "request_schema",
]

# Client generators read the OpenAPI 3.0 keyword `format`.
BYTES = {"type": "string", "contentEncoding": "binary", "format": "binary"}
STATES = ("queued", "running", "succeeded", "failed", "cancelled")
PAGE = {
    "limit": {"type": "integer", "minimum": 1, "maximum": 1000, "default": 100},
    "offset": {"type": "integer", "minimum": 0, "maximum": 10**9, "default": 0},
    "state": {"enum": list(STATES)},
}
JOB = {
    "type": "object",
    "required": ["id", "state", "progress", "message"],
    "properties": {
        "id": {"type": "string"},
        "name": {"type": "string"},
        "state": {"enum": list(STATES)},
        "position": {"type": ["integer", "null"], "minimum": 1, "description": "position in the queue, null if the job is not queued"},
        "progress": {"type": "number", "minimum": 0, "maximum": 1},
        "task": {"type": "string", "description": "solve, or the name of a task on a solved surface"},
        "stage": {"type": "string"},
        "iteration": {"type": "integer"},
        "iterations": {"type": ["integer", "null"]},
        "error": {"type": ["number", "null"], "description": "largest |K - target| [1/L^2]"},
        "residual": {"type": ["number", "null"]},
        "energy": {"type": ["number", "null"]},
        "elapsed": {"type": ["number", "null"], "description": "seconds"},
        "created": {"type": "number", "description": "seconds since 1970"},
        "message": {"type": ["string", "null"], "description": "one sentence, when the job is finished"},
        "remedies": REMEDIES,
        "has_result": {"type": "boolean"},
    },
}
JOB_LIST = {
    "type": "object",
    "required": ["jobs", "total", "limit", "offset"],
    "properties": {
        "jobs": {"type": "array", "items": {"$ref": "#/components/schemas/Job"}},
        "total": {"type": "integer", "description": "number of jobs on all pages"},
        "limit": {"type": "integer"},
        "offset": {"type": "integer"},
    },
}
_LINK_MODE = {"enum": list(MODES), "description": "whether the link opens a copy that can be edited, or a view only"}
DESIGN = {
    "type": "object",
    "required": ["id", "name", "revision", "changed", "bytes"],
    "properties": {
        "id": {"type": "string"},
        "name": {"type": "string"},
        "revision": {"type": "integer", "minimum": 1},
        "changed": {"type": "number", "description": "time [s since 1970]"},
        "bytes": {"type": "integer"},
    },
}
DESIGN_LIST = {"type": "object", "required": ["designs"], "properties": {"designs": {"type": "array", "items": DESIGN}}}
LINK = {
    "type": "object",
    "required": ["id", "mode", "created"],
    "properties": {
        "id": {"type": "string"},
        "mode": _LINK_MODE,
        "created": {"type": "number", "description": "time [s since 1970]"},
        "token": {"type": "string", "description": "secret of a new link, which is not shown again"},
    },
}
LINK_LIST = {"type": "object", "required": ["links"], "properties": {"links": {"type": "array", "items": LINK}}}
LINK_REQUEST = {"type": "object", "required": ["mode"], "properties": {"mode": _LINK_MODE}}
CURVATURES = {
    "type": "object",
    "required": ["curvature", "gaussian", "mean", "largest", "smallest"],
    "properties": {
        "curvature": {**PACKED, "description": "K (n,), NaN where it is not prescribed or cannot be read, as beside supports [1/L^2]"},
        "gaussian": {**PACKED, "description": "K of fitted quadrics (n,) [1/L^2]"},
        **{
            name: {**PACKED, "description": f"{words} of fitted quadrics (n,) [1/L]"}
            for name, words in (("mean", "mean curvature"), ("largest", "larger principal curvature"), ("smallest", "smaller one"))
        },
    },
}
INDICES = {"type": "array", "items": {"type": "integer", "minimum": 0}}
PROBLEM = {
    "type": "object",
    "required": ["message", "values", "errors", "warnings"],
    "properties": {
        "message": {"type": "string"},
        "values": {"type": "array", "items": {"type": "object"}, "description": "empty; newer Hops reads it"},
        "errors": {"type": "array", "items": {"type": "string"}},
        "warnings": {"type": "array", "items": {"type": "string"}},
        "remedies": REMEDIES,
    },
}
MODEL = {
    "type": "object",
    "required": ["vertices", "faces", "roles", "supports", "creases", "regions", "targets", "notes", "problems"],
    "properties": {
        "name": {"type": "string"},
        "unit": {"type": "string", "description": "unit of length, empty if unknown"},
        "vertices": {"type": "array", "items": {"type": "array", "items": {"type": "number"}, "minItems": 3, "maxItems": 3}},
        "faces": {"type": "array", "items": {**INDICES, "minItems": 3, "maxItems": 3}},
        "roles": {"type": "array", "items": {"enum": list(USER_ROLES)}},
        "supports": {
            "type": "object",
            "description": "supports in the file, and alternatives",
            "properties": {"file": INDICES, "boundary": INDICES, "corners": INDICES},
        },
        "support_choice": {"enum": ["file", "boundary"], "description": "choice of supports on which roles and problems are based"},
        "creases": {"type": "array", "items": INDICES, "description": "paths along edges"},
        "goals": {"type": "array", "items": {"type": "object"}, "description": "in the format of a request"},
        "regions": {**INDICES, "description": "region of every face"},
        "targets": {
            "type": "array",
            "items": {"type": ["number", "null"]},
            "description": "by region, null if not constant; a suggestion if the file has no targets [1/L^2]",
        },
        "vertex_targets": {
            "type": ["array", "null"],
            "items": {"type": ["number", "null"]},
            "description": "per vertex, if the target of a region is not constant [1/L^2]",
        },
        "laws": {"type": "object", "additionalProperties": {"type": "string"}, "description": "by region, those other than constant K"},
        "settings": {"type": "object", "description": "settings of the paper, for an example"},
        "notes": {"type": "array", "items": {"type": "string"}},
        "problems": {
            "type": "array",
            "items": {"type": "object", "properties": {"text": {"type": "string"}, "fatal": {"type": "boolean"}, "remedies": REMEDIES}},
        },
    },
}
TASKS = {
    "type": "object",
    "required": ["tasks"],
    "properties": {
        "tasks": {
            "type": "array",
            "items": {
                "type": "object",
                "required": ["name", "text", "options", "formats"],
                "properties": {
                    "name": {"enum": list(TASK_NAMES[1:])},
                    "text": {"type": "string"},
                    "options": {"type": "array", "items": {"type": "object", "required": ["name"]}, "description": "name and JSON schema"},
                    "formats": {"type": "array", "items": {"type": "string"}, "description": "formats of the result"},
                },
            },
        },
    },
}
METHODS = {
    "type": "object",
    "required": ["methods"],
    "properties": {
        "methods": {
            "type": "array",
            "items": {
                "type": "object",
                "required": ["name", "text", "options"],
                "properties": {
                    "name": {"type": "string"},
                    "text": {"type": "string", "description": "purpose of the method"},
                    "options": {"type": "array", "items": {"type": "object", "required": ["name"]}, "description": "name and JSON schema"},
                },
            },
        },
    },
}


GOAL_LIST = {
    "type": "array",
    "items": {
        "type": "object",
        "required": ["kind"],
        "properties": {"kind": {"enum": list(CONSTRAINTS)}, "vertices": {"oneOf": [{"type": "string"}, INDICES]}},
    },
}


VERTICES = {"oneOf": [{"type": "array", "items": {"type": "array", "items": {"type": "number"}, "minItems": 3, "maxItems": 3}}, PACKED]}
TARGETS = {
    "oneOf": [
        {"type": "number"},
        {"type": "array", "items": {"type": ["number", "null"]}},
        {"type": "object", "additionalProperties": {"type": "number"}},
    ],
    "description": "Gaussian curvature: one for all, one per vertex, or by the number of the region [1/L^2]",
}
LAWS = {
    "oneOf": [{"type": "string"}, {"type": "object", "additionalProperties": {"type": "string"}}],
    "description": "law of mean curvature H and Gaussian curvature K, one for all or by the number of the region: minimal, H = 0.1, "
    "2 H + 0.5 K = 0.3",
}
LAST = {
    "type": "object",
    "required": ["vertices", "targets"],
    "additionalProperties": False,
    "properties": {"vertices": VERTICES, "targets": TARGETS},
    "description": "surface of the same problem solved for other targets, used as initial guess",
}


def request_schema() -> dict:
    """Return the schema of a request, with all methods and goals."""
    return {
        "type": "object",
        "additionalProperties": False,
        "properties": {
            "id": {"type": "string", "pattern": "^[A-Za-z0-9_-]{8,64}$", "description": "the same id again returns the first job"},
            "name": {"type": "string"},
            "vertices": VERTICES,
            "faces": {"oneOf": [{"type": "array", "items": {**INDICES, "minItems": 3}}, PACKED]},
            "mesh": {"type": "object", "description": "a COMPAS Mesh or CGCMesh as JSON, instead of vertices and faces"},
            "roles": {"type": "array", "items": {"enum": list(USER_ROLES)}},
            "supports": {"oneOf": [{"enum": list(SUPPORT_NAMES)}, INDICES]},
            "creases": {"type": "array", "items": INDICES, "description": "paths along edges"},
            "targets": TARGETS,
            "laws": LAWS,
            "last": LAST,
            "goals": GOAL_LIST,
            "unknown": {
                "oneOf": [{"enum": ["all"]}, INDICES],
                "description": "regions whose K is unknown; it is solved for and returned in the targets of the result",
            },
            "task": {"enum": [SOLVE]},
            "method": {"enum": list(method_names()), "description": "see /api/v1/methods"},
            "settings": settings_schema(),
            "unit": {"enum": list(UNITS), "description": "unit of length, also of the files of the result"},
            "flip": {"type": "boolean"},
            "live": {"type": "boolean", "description": "report the surface of every step; omits errors by other measures"},
        },
    }


PLAN_KINDS = tuple(suffix[1:] for suffix, own in FORMATS.items() if own.plan)
_POINT = {"type": "array", "items": {"type": "number"}, "minItems": 3, "maxItems": 3}
PLAN = {
    "type": "object",
    "required": ["unit", "lines", "columns", "layers", "tolerance", "notes"],
    "properties": {
        "unit": {"enum": list(UNITS)},
        "lines": {
            "type": "array",
            "items": {
                "type": "object",
                "required": ["points", "closed", "layer", "circle"],
                "properties": {
                    "points": {"type": "array", "items": _POINT},
                    "closed": {"type": "boolean"},
                    "layer": {"type": "string"},
                    "circle": {"type": ["object", "null"], "description": "centre x, y and radius r"},
                },
            },
        },
        "columns": {"type": "array", "items": {"type": "object"}, "description": "x, y and height"},
        "layers": {"type": "array", "items": {"type": "object"}, "description": "name, objects, visible and read"},
        "tolerance": {"type": "number", "description": "distance within which ends of curves were joined [L]"},
        "notes": {"type": "array", "items": {"type": "string"}},
    },
}


def drawing_schema() -> dict:
    """Return the schema of a drawing in plan."""
    line = {"type": "array", "items": {"type": "array", "items": {"type": "number"}, "minItems": 2, "maxItems": 2}}
    lines = {"type": "array", "items": line}
    return {
        "type": "object",
        "required": ["outline", "edge_length"],
        "additionalProperties": False,
        "properties": {
            "name": {"type": "string"},
            "unit": {"enum": list(UNITS)},
            "edge_length": {"type": "number", "exclusiveMinimum": 0, "description": "edge length of the mesh [L]"},
            "outline": {**line, "minItems": 3},
            "holes": lines,
            "creases": {**lines, "description": "lines along which the surface may fold"},
            "points": {**line, "description": "columns"},
            "held": {**lines, "description": "lines whose vertices are supports"},
        },
    }


def build_schema() -> dict:
    """Return the schema of a request for a task on a solved surface, given as a mesh or as the job that solved it."""
    properties = {name: schema for name, schema in request_schema()["properties"].items() if name not in ("method", "live", "last")}
    task = {"enum": list(TASK_NAMES[1:]), "description": "see /api/v1/tasks; all except limits and rationalise require a solved surface"}
    job = {"type": "string", "description": "id of the job whose result is used instead of a mesh"}
    settings = {"anyOf": [_settings_of(own) for own in tasks()]}
    return {
        "type": "object",
        "required": ["task"],
        "additionalProperties": False,
        "properties": {**properties, "task": task, "job": job, "settings": settings},
    }


def _settings_of(task: dict) -> dict:
    properties = {own["name"]: {name: value for name, value in own.items() if name != "name"} for own in task["options"]}
    return {"title": task["name"], "type": "object", "additionalProperties": False, "properties": properties}


SURFACE = {
    "type": "object",
    "required": ["unit", "vertices", "faces", "smooth", "supports", "seams", "notes"],
    "properties": {
        "unit": {"enum": list(UNITS)},
        "vertices": {"type": "array", "items": _POINT},
        "faces": {"type": "array", "items": {**INDICES, "minItems": 3, "maxItems": 3}},
        "smooth": {"type": "boolean", "description": "whether the mesh only samples a smooth surface"},
        "supports": {"type": "array", "items": {"type": "array", "items": _POINT}, "description": "points, and points along curves"},
        "seams": {"type": "array", "items": {"type": "array", "items": _POINT}, "description": "points along drawn curves"},
        "notes": {"type": "array", "items": {"type": "string"}},
    },
}
