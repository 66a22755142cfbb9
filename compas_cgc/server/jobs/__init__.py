"""The job engine: queue, store and worker processes."""

from __future__ import annotations
