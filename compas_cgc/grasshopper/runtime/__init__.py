"""What the components share while they run in Rhino."""

from __future__ import annotations
