"""Runtime of the components in Rhino: background tasks, feedback and servers."""

from __future__ import annotations
