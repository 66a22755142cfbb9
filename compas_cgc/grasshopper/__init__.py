"""Grasshopper: functions of the components, and builds of their files without Rhino."""

from __future__ import annotations
