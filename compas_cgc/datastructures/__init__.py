"""The mesh that designers work with."""

from __future__ import annotations

from .cgcmesh import CGCMesh

__all__ = ["CGCMesh"]
