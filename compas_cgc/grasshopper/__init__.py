"""Grasshopper: what the components do, and their files, made without Rhino."""

from __future__ import annotations
