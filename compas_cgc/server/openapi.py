"""The job API in the OpenAPI format."""

from __future__ import annotations

from .._version import __version__
from .formats import FORMATS
from .uploads import KINDS

__all__ = ["description"]

_JOB = {
    "type": "object",
    "required": ["id", "state", "progress", "message"],
    "properties": {
        "id": {"type": "string"},
        "name": {"type": "string"},
        "state": {"enum": ["queued", "running", "succeeded", "failed", "cancelled"]},
        "progress": {"type": "number", "minimum": 0, "maximum": 1},
        "stage": {"type": "string"},
        "iteration": {"type": "integer"},
        "iterations": {"type": ["integer", "null"]},
        "error": {"type": ["number", "null"], "description": "largest |K - target| [1/L^2]"},
        "residual": {"type": ["number", "null"]},
        "energy": {"type": ["number", "null"]},
        "elapsed": {"type": ["number", "null"], "description": "seconds"},
        "created": {"type": "number", "description": "seconds since 1970"},
        "message": {"type": ["string", "null"], "description": "one sentence, when the job is over"},
        "has_result": {"type": "boolean"},
    },
}
_PACKED = {
    "type": "object",
    "required": ["base64", "type", "shape"],
    "properties": {
        "base64": {"type": "string", "contentEncoding": "base64", "description": "little-endian"},
        "type": {"enum": ["f8", "i4"]},
        "shape": {"type": "array", "items": {"type": "integer", "minimum": 0}, "minItems": 1, "maxItems": 2},
    },
}
_INDICES = {"type": "array", "items": {"type": "integer", "minimum": 0}}
_REQUEST = {
    "type": "object",
    "additionalProperties": False,
    "properties": {
        "id": {"type": "string", "pattern": "^[A-Za-z0-9_-]{8,64}$", "description": "the same id again returns the first job"},
        "name": {"type": "string"},
        "vertices": {
            "oneOf": [{"type": "array", "items": {"type": "array", "items": {"type": "number"}, "minItems": 3, "maxItems": 3}}, _PACKED]
        },
        "faces": {"oneOf": [{"type": "array", "items": {**_INDICES, "minItems": 3}}, _PACKED]},
        "mesh": {"type": "object", "description": "a COMPAS Mesh or CGCMesh as JSON, instead of vertices and faces"},
        "roles": {"type": "array", "items": {"enum": ["internal", "fixed", "crease", "free"]}},
        "supports": {"oneOf": [{"enum": ["boundary", "corners"]}, _INDICES]},
        "creases": {"type": "array", "items": _INDICES, "description": "paths along edges"},
        "targets": {
            "oneOf": [
                {"type": "number"},
                {"type": "array", "items": {"type": ["number", "null"]}},
                {"type": "object", "additionalProperties": {"type": "number"}},
            ],
            "description": "Gaussian curvature: one for all, one per vertex, or by the number of the region [1/L^2]",
        },
        "constraints": {
            "type": "array",
            "items": {
                "type": "object",
                "required": ["kind"],
                "properties": {"kind": {"enum": ["plane", "height", "line", "curve", "held", "near", "mirror"]}, "vertices": _INDICES},
            },
        },
        "method": {"enum": ["auto", "flow", "newton", "projection"]},
        "settings": {"type": "object"},
        "flip": {"type": "boolean"},
        "live": {"type": "boolean", "description": "report the moving surface"},
    },
}
_PROBLEM = {
    "type": "object",
    "required": ["message", "values", "errors", "warnings"],
    "properties": {
        "message": {"type": "string"},
        "values": {"type": "array"},
        "errors": {"type": "array", "items": {"type": "string"}},
        "warnings": {"type": "array", "items": {"type": "string"}},
    },
}
_MODEL = {
    "type": "object",
    "required": ["vertices", "faces", "roles", "supports", "creases", "regions", "targets", "notes", "problems"],
    "properties": {
        "name": {"type": "string"},
        "unit": {"type": "string", "description": "of length, empty where it is not known"},
        "vertices": {"type": "array", "items": {"type": "array", "items": {"type": "number"}, "minItems": 3, "maxItems": 3}},
        "faces": {"type": "array", "items": {**_INDICES, "minItems": 3, "maxItems": 3}},
        "roles": {"type": "array", "items": {"enum": ["internal", "fixed", "crease", "free"]}},
        "supports": {
            "type": "object",
            "description": "those of the file, and what could be held instead",
            "properties": {"file": _INDICES, "boundary": _INDICES, "corners": _INDICES},
        },
        "support_choice": {"enum": ["file", "boundary"], "description": "which of them the roles and problems are of"},
        "creases": {"type": "array", "items": _INDICES, "description": "paths along edges"},
        "regions": {**_INDICES, "description": "region of every face"},
        "targets": {
            "type": "array",
            "items": {"type": ["number", "null"]},
            "description": "by region, null where it is not one number; suggested where the file has none [1/L^2]",
        },
        "vertex_targets": {"type": ["array", "null"], "description": "per vertex, where a region has more than one [1/L^2]"},
        "s": {"type": "number", "description": "the paper's, of an example"},
        "e": {"type": "integer", "description": "the paper's, of an example"},
        "notes": {"type": "array", "items": {"type": "string"}},
        "problems": {
            "type": "array",
            "items": {"type": "object", "properties": {"text": {"type": "string"}, "fatal": {"type": "boolean"}}},
        },
    },
}
_ID = {"name": "id", "in": "path", "required": True, "schema": {"type": "string"}}


def description() -> dict:
    """Return the description of the job API."""
    job, model = "#/components/schemas/Job", "#/components/schemas/Model"
    return {
        "openapi": "3.1.0",
        "info": {"title": "compas_cgc", "version": __version__, "description": "Surfaces of piecewise constant Gaussian curvature"},
        "paths": {
            "/health": {"get": _operation("Tell whether the server lives", {"200": _json({"type": "object"})})},
            "/version": {"get": _operation("Name the program and its version", {"200": _json({"type": "object"})})},
            "/api/v1/jobs": {
                "get": _operation("List the newest jobs", {"200": _json({"type": "object", "required": ["jobs"]})}, "401"),
                "post": {
                    **_operation(
                        "Submit a solve", {"202": _json({"type": "object", "required": ["id"]})}, "400", "401", "409", "413", "422", "429"
                    ),
                    "parameters": [
                        {"name": "kind", "in": "query", "schema": {"enum": ["json", "3dm", "obj"]}},
                        {
                            "name": "options",
                            "in": "query",
                            "schema": {"type": "string"},
                            "description": "for files: the other fields as JSON",
                        },
                    ],
                    "requestBody": {
                        "required": True,
                        "content": {
                            "application/json": {"schema": {"$ref": "#/components/schemas/Request"}},
                            "application/octet-stream": {"schema": {"type": "string", "contentEncoding": "binary"}},
                        },
                    },
                },
            },
            "/api/v1/jobs/{id}": {
                "parameters": [_ID],
                "get": {
                    **_operation("Tell how a job is doing", {"200": _json({"$ref": job})}, "401", "404"),
                    "parameters": [
                        {
                            "name": "wait",
                            "in": "query",
                            "schema": {"type": "number", "minimum": 0, "maximum": 25},
                            "description": "seconds to wait for the end of the job",
                        }
                    ],
                },
                "delete": _operation("Stop a job and forget it", {"204": {"description": "forgotten"}}, "401", "404"),
            },
            "/api/v1/jobs/{id}/cancel": {
                "parameters": [_ID],
                "post": _operation("Stop a job", {"200": _json({"$ref": job})}, "401", "404"),
            },
            "/api/v1/jobs/{id}/result": {
                "parameters": [_ID, {"name": "format", "in": "query", "schema": {"enum": list(FORMATS)}}],
                "get": _operation(
                    "Return the result",
                    {"200": {"description": "the result", "content": {kind: {} for kind in dict.fromkeys(FORMATS.values())}}},
                    "401",
                    "404",
                    "409",
                    "410",
                    "422",
                ),
            },
            "/api/v1/jobs/{id}/surface": {
                "parameters": [_ID],
                "get": _operation(
                    "Return the moving vertices as little-endian float32",
                    {"200": {"description": "vertices", "content": {"application/octet-stream": {}}}},
                    "401",
                    "404",
                ),
            },
            "/api/v1/jobs/{id}/events": {
                "parameters": [_ID],
                "get": _operation(
                    "Send states as they change",
                    {"200": {"description": "events", "content": {"text/event-stream": {}}}},
                    "401",
                    "404",
                    "429",
                ),
            },
            "/api/v1/models": {
                "parameters": [
                    {"name": "kind", "in": "query", "required": True, "schema": {"enum": list(KINDS)}},
                    {"name": "name", "in": "query", "schema": {"type": "string"}, "description": "what to call the mesh"},
                ],
                "post": {
                    **_operation("Tell what is in a file", {"200": _json({"$ref": model})}, "400", "401", "413", "422", "429"),
                    "requestBody": {
                        "required": True,
                        "content": {"application/octet-stream": {"schema": {"type": "string", "contentEncoding": "binary"}}},
                    },
                },
            },
            "/api/v1/examples": {
                "get": _operation("List the examples", {"200": _json({"type": "object", "required": ["examples"]})}, "401"),
            },
            "/api/v1/examples/{name}": {
                "parameters": [{"name": "name", "in": "path", "required": True, "schema": {"type": "string"}}],
                "get": _operation("Tell what is in an example", {"200": _json({"$ref": model})}, "401", "404", "429"),
            },
        },
        "components": {
            "schemas": {"Job": _JOB, "Request": _REQUEST, "Model": _MODEL, "Problem": _PROBLEM},
            "securitySchemes": {
                "bearer": {"type": "http", "scheme": "bearer"},
                "compute": {"type": "apiKey", "in": "header", "name": "RhinoComputeKey"},
            },
        },
        "security": [{}, {"bearer": []}, {"compute": []}],
    }


def _operation(summary: str, responses: dict, *problems: str) -> dict:
    problem = _json({"$ref": "#/components/schemas/Problem"}, "a sentence that says what is wrong")
    return {"summary": summary, "responses": {**responses, **dict.fromkeys(problems, problem)}}


def _json(schema: dict, text: str = "done") -> dict:
    return {"description": text, "content": {"application/json": {"schema": schema}}}
