"""Routes for operators: health, readiness and metrics."""

from __future__ import annotations

from typing import Any

from flask import Blueprint
from flask import Response
from flask import current_app

from ..api.blocking_calls import jobs
from ..api.responses import respond

__all__ = ["operation"]

operation = Blueprint("operation", __name__)


@operation.get("/health")
def health() -> Response:
    """Return the state of the server and its workers, without waiting."""
    executor: Any = jobs().executor
    workers: dict = executor.health() if hasattr(executor, "health") else {}
    return respond({"status": "starting" if workers.get("starting") == workers.get("workers", -1) else "ok", **workers})


@operation.get("/ready")
def ready() -> Response:
    """Return whether the server can accept jobs, with 503 and the reasons if it cannot."""
    problems = current_app.extensions["readiness"].problems()
    return respond({"ready": not problems, "problems": list(problems)}, 503 if problems else 200)


@operation.get("/metrics")
def metrics() -> Response:
    """Return the metrics of the server for Prometheus; requires the key of an operator."""
    return Response(current_app.extensions["metrics"].text(), content_type="text/plain; version=0.0.4; charset=utf-8")
