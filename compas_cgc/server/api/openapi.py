"""OpenAPI description of the job API."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Optional

from ..._version import __version__
from .design_files import DESIGN_KINDS
from .formats import FORMATS
from .mesh_files import KINDS
from .moulds import MOULD_FORMATS
from .moulds import MOULD_OPTIONS
from .result_schemas import RESULT_SCHEMAS
from .schemas import BYTES
from .schemas import CURVATURES
from .schemas import DESIGN
from .schemas import DESIGN_LIST
from .schemas import JOB
from .schemas import JOB_LIST
from .schemas import LINK
from .schemas import LINK_LIST
from .schemas import LINK_REQUEST
from .schemas import METHODS
from .schemas import MODEL
from .schemas import PAGE
from .schemas import PLAN
from .schemas import PLAN_KINDS
from .schemas import PROBLEM
from .schemas import SURFACE
from .schemas import TASKS
from .schemas import build_schema
from .schemas import drawing_schema
from .schemas import request_schema

__all__ = ["description"]

OPERATIONS = {
    ("get", "/health"): "health",
    ("get", "/ready"): "ready",
    ("get", "/metrics"): "metrics",
    ("get", "/version"): "version",
    ("get", "/api/v1/methods"): "listMethods",
    ("get", "/api/v1/tasks"): "listTasks",
    ("get", "/api/v1/jobs"): "listJobs",
    ("post", "/api/v1/jobs"): "submitJob",
    ("get", "/api/v1/jobs/{id}"): "getJob",
    ("delete", "/api/v1/jobs/{id}"): "deleteJob",
    ("post", "/api/v1/jobs/{id}/cancel"): "cancelJob",
    ("get", "/api/v1/jobs/{id}/result"): "getResult",
    ("post", "/api/v1/jobs/{id}/result"): "mergeResult",
    ("get", "/api/v1/jobs/{id}/moulds"): "getMoulds",
    ("get", "/api/v1/jobs/{id}/surface"): "getSurface",
    ("get", "/api/v1/jobs/{id}/events"): "followJob",
    ("get", "/api/v1/designs"): "listDesigns",
    ("get", "/api/v1/designs/{id}"): "getDesign",
    ("put", "/api/v1/designs/{id}"): "storeDesign",
    ("delete", "/api/v1/designs/{id}"): "deleteDesign",
    ("get", "/api/v1/designs/{id}/links"): "listLinks",
    ("post", "/api/v1/designs/{id}/links"): "createLink",
    ("delete", "/api/v1/designs/{id}/links/{link}"): "revokeLink",
    ("get", "/api/v1/shared/{token}"): "getSharedDesign",
    ("post", "/api/v1/models"): "readModel",
    ("post", "/api/v1/plans"): "readPlan",
    ("post", "/api/v1/surfaces"): "readSurface",
    ("post", "/api/v1/drawings"): "meshDrawing",
    ("post", "/api/v1/curvatures"): "measureCurvatures",
    ("get", "/api/v1/examples"): "listExamples",
    ("get", "/api/v1/examples/{name}"): "getExample",
}
# OpenAPI has no event streams: the schema describes one event.
_EVENT = {
    "type": "object",
    "required": ["event", "data"],
    "properties": {
        "event": {"enum": ["progress", "done", "failed", "surface", "verdict", "result"]},
        "data": {"type": "string", "description": "JSON: the status of the job, its surface, the verdict or the result"},
    },
}
EVENTS = {"description": "events", "content": {"text/event-stream": {"schema": _EVENT}}}
READY = {
    "type": "object",
    "required": ["ready", "problems"],
    "properties": {"ready": {"type": "boolean"}, "problems": {"type": "array", "items": {"type": "string"}}},
}
_ID, _LINK, _TOKEN = ({"name": name, "in": "path", "required": True, "schema": {"type": "string"}} for name in ("id", "link", "token"))


def description() -> dict:
    """Return the OpenAPI description of the job API."""
    found = _description()
    for (method, path), name in OPERATIONS.items():
        found["paths"][path][method]["operationId"] = name
    return found


def _description() -> dict:
    job, model, request, build = (f"#/components/schemas/{name}" for name in ("Job", "Model", "Request", "BuildRequest"))
    tasks = {"200": _json({"$ref": "#/components/schemas/Tasks"})}
    solved = {"anyOf": [{"$ref": f"#/components/schemas/{name}"} for name in ("Result", "Build")] + [{"type": "object"}]}
    result = {"200": {"description": "the result", "content": _content(FORMATS.values(), solved)}}
    merged = {"200": {"description": "the file with the result", "content": _content([KINDS["3dm"]])}}
    moulds = {"200": {"description": "moulds and panels", "content": _content(MOULD_FORMATS.values(), {"type": "object"})}}
    refusals = ("400", "401", "404", "409", "410", "413", "415", "422", "429", "500", "504")
    return {
        "openapi": "3.1.0",
        "info": {"title": "compas_cgc", "version": __version__, "description": "Surfaces of piecewise constant Gaussian curvature"},
        "paths": {
            "/health": {"get": _operation("Check whether the server is running", {"200": _json({"$ref": "#/components/schemas/Health"})})},
            "/ready": {
                "get": _operation("Check whether the server can accept jobs", {"200": _json(READY), "503": _json(READY, "the reasons")})
            },
            "/metrics": {
                "get": _operation(
                    "Return the metrics of the server for Prometheus",
                    {"200": {"description": "metrics", "content": {"text/plain": {"schema": {"type": "string"}}}}},
                    *("401", "403"),
                ),
            },
            "/version": {
                "get": _operation("Return name and version of the program", {"200": _json({"$ref": "#/components/schemas/Version"})}),
            },
            "/api/v1/methods": {
                "get": _operation("List the methods and their settings", {"200": _json({"$ref": "#/components/schemas/Methods"})}, "401"),
            },
            "/api/v1/tasks": {
                "get": _operation("List the tasks on solved surfaces and their settings", tasks, "401"),
            },
            "/api/v1/jobs": {
                "get": {
                    **_operation("List the jobs, newest first", {"200": _json({"$ref": "#/components/schemas/JobList"})}, "401", "422"),
                    "parameters": [{"name": name, "in": "query", "schema": schema} for name, schema in PAGE.items()],
                },
                "post": {
                    **_operation(
                        "Submit a solve, or another task on a solved surface",
                        {"202": _json({"$ref": "#/components/schemas/Submitted"}), "200": EVENTS},
                        *("400", "401", "404", "409", "410", "413", "415", "422", "429"),
                    ),
                    "parameters": [
                        {"name": "kind", "in": "query", "schema": {"enum": ["json", *dict.fromkeys((*KINDS, *DESIGN_KINDS))]}},
                        {
                            "name": "follow",
                            "in": "query",
                            "schema": {"enum": ["true"]},
                            "description": "respond with events, the last one called 'result'; 202 if no stream is free",
                        },
                        {
                            "name": "options",
                            "in": "query",
                            "schema": {"type": "string"},
                            "description": "for files: the other fields of a request as JSON; edge_length [L] meshes curves and surfaces",
                        },
                    ],
                    "requestBody": {
                        "required": True,
                        "content": {
                            "application/json": {"schema": {"anyOf": [{"$ref": request}, {"$ref": build}]}},
                            "application/octet-stream": {"schema": BYTES},
                        },
                    },
                },
            },
            "/api/v1/jobs/{id}": {
                "parameters": [_ID],
                "get": {
                    **_operation("Return the status of a job", {"200": _json({"$ref": job})}, "401", "404"),
                    "parameters": [
                        {
                            "name": "wait",
                            "in": "query",
                            "schema": {"type": "number", "minimum": 0, "maximum": 25},
                            "description": "time to wait for the end of the job [s]",
                        }
                    ],
                },
                "delete": {
                    **_operation("Stop a job and delete it", {"204": {"description": "deleted, or to be deleted"}}, "401", "404"),
                    "parameters": [
                        {
                            "name": "after",
                            "in": "query",
                            "schema": {"type": "number", "minimum": 0, "maximum": 3600},
                            "description": "time [s] within which any other request for the job revokes its deletion",
                        }
                    ],
                },
            },
            "/api/v1/jobs/{id}/cancel": {
                "parameters": [_ID],
                "post": _operation("Stop a job", {"200": _json({"$ref": job})}, "401", "404"),
            },
            "/api/v1/jobs/{id}/result": {
                "parameters": [_ID, {"name": "format", "in": "query", "schema": {"enum": list(FORMATS)}}],
                "get": _operation("Return the result", result, "401", "404", "409", "410", "422"),
                "post": {
                    **_operation("Return the uploaded .3dm file with the result merged into it", merged, *refusals),
                    "requestBody": {"required": True, "content": {"application/octet-stream": {"schema": BYTES}}},
                },
            },
            "/api/v1/jobs/{id}/moulds": {
                "parameters": [
                    _ID,
                    {"name": "format", "in": "query", "schema": {"enum": list(MOULD_FORMATS)}},
                    *({"name": name, "in": "query", "schema": schema} for name, schema in MOULD_OPTIONS.items()),
                ],
                "get": _operation("Return the panels of the result and their moulds", moulds, *refusals),
            },
            "/api/v1/jobs/{id}/surface": {
                "parameters": [_ID],
                "get": _operation(
                    "Return the moving vertices as little-endian float32",
                    {
                        "200": {"description": "vertices", "content": _content(["application/octet-stream"])},
                        "204": {"description": "no vertices: the job has not started, has finished or was not submitted as live"},
                    },
                    "401",
                    "404",
                ),
            },
            "/api/v1/jobs/{id}/events": {
                "parameters": [_ID],
                "get": _operation(
                    "Stream the status of a job whenever it changes",
                    {"200": EVENTS},
                    "401",
                    "404",
                    "429",
                ),
            },
            **_design_paths(),
            "/api/v1/models": {
                "parameters": [
                    {"name": "kind", "in": "query", "required": True, "schema": {"enum": list(KINDS)}},
                    {"name": "name", "in": "query", "schema": {"type": "string"}, "description": "name of the mesh"},
                    {
                        "name": "edge_length",
                        "in": "query",
                        "schema": {"type": "number", "exclusiveMinimum": 0},
                        "description": "edge length of the mesh of curves or surfaces [L]",
                    },
                ],
                "post": {
                    **_operation(
                        "Return the contents of a file", {"200": _json({"$ref": model})}, "400", "401", "413", "415", "422", "429"
                    ),
                    "requestBody": {
                        "required": True,
                        "content": {"application/octet-stream": {"schema": BYTES}},
                    },
                },
            },
            "/api/v1/plans": {
                "parameters": [
                    {"name": "kind", "in": "query", "required": True, "schema": {"enum": list(PLAN_KINDS)}},
                    {
                        "name": "join",
                        "in": "query",
                        "schema": {"type": "number", "minimum": 0},
                        "description": "distance within which ends of curves are joined [L]; small gaps are closed without it",
                    },
                ],
                "post": {
                    **_operation("Read the curves and points of a drawing", {"200": _json(PLAN)}, "400", "401", "413", "415", "422", "429"),
                    "requestBody": {
                        "required": True,
                        "content": {"application/octet-stream": {"schema": BYTES}},
                    },
                },
            },
            "/api/v1/surfaces": {
                "parameters": [{"name": "kind", "in": "query", "required": True, "schema": {"enum": list(DESIGN_KINDS)}}],
                "post": {
                    **_operation(
                        "Return the surface of a freeform design as a mesh",
                        {"200": _json(SURFACE)},
                        *("400", "401", "413", "415", "422", "429"),
                    ),
                    "requestBody": {
                        "required": True,
                        "content": {"application/octet-stream": {"schema": BYTES}},
                    },
                },
            },
            "/api/v1/drawings": {
                "post": {
                    **_operation("Mesh a drawing", {"200": _json({"$ref": model})}, "400", "401", "413", "415", "422", "429"),
                    "requestBody": {"required": True, "content": {"application/json": {"schema": drawing_schema()}}},
                },
            },
            "/api/v1/curvatures": {
                "post": {
                    **_operation(
                        "Return the curvatures of a surface", {"200": _json(CURVATURES)}, "400", "401", "413", "415", "422", "429"
                    ),
                    "requestBody": {"required": True, "content": {"application/json": {"schema": {"$ref": request}}}},
                },
            },
            "/api/v1/examples": {
                "get": _operation("List the examples", {"200": _json({"$ref": "#/components/schemas/Examples"})}, "401"),
            },
            "/api/v1/examples/{name}": {
                "parameters": [{"name": "name", "in": "path", "required": True, "schema": {"type": "string"}}],
                "get": _operation("Return the contents of an example", {"200": _json({"$ref": model})}, "401", "404", "429"),
            },
        },
        "components": {
            "schemas": {
                "Job": JOB,
                "JobList": JOB_LIST,
                "Request": request_schema(),
                "BuildRequest": build_schema(),
                "Methods": METHODS,
                "Tasks": TASKS,
                "Model": MODEL,
                "Problem": PROBLEM,
                **RESULT_SCHEMAS,
            },
            "securitySchemes": {
                "bearer": {"type": "http", "scheme": "bearer"},
                "compute": {"type": "apiKey", "in": "header", "name": "RhinoComputeKey"},
            },
        },
        "security": [{}, {"bearer": []}, {"compute": []}],
    }


def _design_paths() -> dict:
    """Return the descriptions of the addresses of designs and links."""
    content = {"200": {"description": "the content", "content": _content(["application/octet-stream"])}}
    deleted = {"204": {"description": "deleted"}}
    revision = {
        "name": "If-Match",
        "in": "header",
        "schema": {"type": "string"},
        "description": "revision of the design to replace; without this header, a new design is stored",
    }
    return {
        "/api/v1/designs": {"get": _operation("List the designs, newest first", {"200": _json(DESIGN_LIST)}, "401")},
        "/api/v1/designs/{id}": {
            "parameters": [_ID],
            "get": _operation("Return the content of a design", content, "401", "404"),
            "put": {
                **_operation("Store a design", {"200": _json(DESIGN)}, "401", "404", "409", "413", "415", "422", "429", "507"),
                "parameters": [{"name": "name", "in": "query", "schema": {"type": "string"}}, revision],
                "requestBody": {"required": True, "content": {"application/octet-stream": {"schema": BYTES}}},
            },
            "delete": _operation("Delete a design and its links", deleted, "401", "404"),
        },
        "/api/v1/designs/{id}/links": {
            "parameters": [_ID],
            "get": _operation("List the links to a design", {"200": _json(LINK_LIST)}, "401", "404"),
            "post": {
                **_operation("Create a link to a design", {"201": _json(LINK)}, "400", "401", "404", "413", "415", "422"),
                "requestBody": {"required": True, "content": {"application/json": {"schema": LINK_REQUEST}}},
            },
        },
        "/api/v1/designs/{id}/links/{link}": {
            "parameters": [_ID, _LINK],
            "delete": _operation("Revoke a link", deleted, "401", "404"),
        },
        "/api/v1/shared/{token}": {
            "parameters": [_TOKEN],
            "get": _operation("Return the content of the design of a link; needs no key", content, "404"),
        },
    }


def _operation(summary: str, responses: dict, *problems: str) -> dict:
    problem = _json({"$ref": "#/components/schemas/Problem"}, "one sentence that describes the error and the remedy")
    return {"summary": summary, "responses": {**responses, **dict.fromkeys(problems, problem)}}


def _content(kinds: Iterable[str], schema: Optional[dict] = None) -> dict:
    """Return the content of a response: JSON of a schema, and files."""
    return {kind: {"schema": schema if kind == "application/json" and schema else BYTES} for kind in dict.fromkeys(kinds)}


def _json(schema: dict, text: str = "done") -> dict:
    return {"description": text, "content": {"application/json": {"schema": schema}}}
