"""Status of a job, as sent to clients."""

from __future__ import annotations

import time
from typing import Optional

from ..jobs.store import Job

__all__ = ["status"]


def status(job: Job, position: Optional[int] = None) -> dict:
    """Return the status of a job as plain data, with its position in the queue while it is queued."""
    step, steps = job.progress.get("step", 0), job.progress.get("steps")
    return {
        "id": job.id,
        "name": job.name,
        "state": job.state,
        "position": position if job.state == "queued" else None,
        "progress": 1.0 if job.state == "succeeded" else step / steps if steps else 0.0,
        "task": job.progress.get("task", "solve"),
        "stage": _stage(job),
        "iteration": step,
        "iterations": steps,
        "error": job.progress.get("max_error"),
        "residual": job.progress.get("error_norm"),
        "energy": job.progress.get("energy"),
        "elapsed": None if job.started is None else (job.finished or time.time()) - job.started,
        "created": job.created,
        "message": job.message,
        "remedies": job.progress.get("remedies", []),
        "has_result": job.size is not None,
    }


def _stage(job: Job) -> str:
    if job.state != "running":
        return "solve" if job.progress.get("step", 0) else job.state
    return job.progress.get("stage") or ("solve" if job.progress.get("step", 0) else "read")
