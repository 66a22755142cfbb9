"""Build of the Grasshopper files: user objects, definitions and the Rhino package."""

from __future__ import annotations
