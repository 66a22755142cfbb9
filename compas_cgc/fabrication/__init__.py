"""Fabrication: what a solved surface is built from."""

from __future__ import annotations

__all__: list[str] = []
