"""Mesh files in and out."""

from __future__ import annotations

from .registry import SUFFIXES
from .registry import read_mesh
from .registry import write_mesh

__all__ = ["SUFFIXES", "read_mesh", "write_mesh"]
