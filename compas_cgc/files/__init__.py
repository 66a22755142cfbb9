"""Mesh files in and out."""

from __future__ import annotations

from .door import SUFFIXES
from .door import read_mesh
from .door import write_mesh

__all__ = ["SUFFIXES", "read_mesh", "write_mesh"]
