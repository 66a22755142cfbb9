"""Rhino files: `.3dm` in and out in double precision, without Rhino.

Everything here works with rhino3dm alone; :mod:`compas_cgc.io.rhino.rhinocommon` is for code
that runs inside Rhino.
"""

from __future__ import annotations

from importlib import import_module

__all__ = ["LayerNames", "Model3dm", "constraints_of", "describe", "layer_names", "read_model", "write_model", "write_result"]

# Names are looked up when they are first used: rhino3dm is not loaded to read the other formats.
_HOME = {
    "LayerNames": ".layers",
    "Model3dm": ".model",
    "constraints_of": ".constraints",
    "describe": ".summary",
    "layer_names": ".layers",
    "read_model": ".read",
    "write_model": ".write",
    "write_result": ".result_layers",
}


def __getattr__(name: str) -> object:
    if name in _HOME:
        return getattr(import_module(_HOME[name], __name__), name)
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")


def __dir__() -> list[str]:
    return sorted(__all__)
