"""Goals: requirements besides K, such as height, volume or clearance."""

from __future__ import annotations
