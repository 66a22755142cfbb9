"""Execution of tasks on worker processes, local or remote, with progress reports and cancellation."""

from __future__ import annotations
