"""What a client is told about a job."""

from __future__ import annotations

import time

from ..jobs.store import Job

__all__ = ["status"]


def status(job: Job) -> dict:
    """Return the state of a job as plain data."""
    step, steps = job.progress.get("step", 0), job.progress.get("steps")
    return {
        "id": job.id,
        "name": job.name,
        "state": job.state,
        "progress": 1.0 if job.state == "succeeded" else step / steps if steps else 0.0,
        "stage": "solve" if step else "read" if job.state == "running" else job.state,
        "iteration": step,
        "iterations": steps,
        "error": job.progress.get("max_error"),
        "residual": job.progress.get("error_norm"),
        "energy": job.progress.get("energy"),
        "elapsed": None if job.started is None else (job.finished or time.time()) - job.started,
        "created": job.created,
        "message": job.message,
        "has_result": job.size is not None,
    }
