"""Execution: tasks on worker processes, of this machine or of others, that tell how far they are and can be stopped."""

from __future__ import annotations
