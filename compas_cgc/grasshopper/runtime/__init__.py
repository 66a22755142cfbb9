"""Runtime of the components: background tasks, feedback and servers, shared while they run in Rhino."""

from __future__ import annotations
