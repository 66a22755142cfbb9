"""Rhino files: `.3dm` in and out in double precision, without Rhino.

Everything here works with rhino3dm alone; :mod:`compas_cgc.io.rhino.rhinocommon` is for code
that runs inside Rhino.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from ..._lazy import attach

if TYPE_CHECKING:
    from ..summary import describe
    from .layers import LayerNames
    from .layers import layer_names
    from .mould_layers import write_moulds
    from .read import read_3dm
    from .result_layers import write_result
    from .write import write_problem

__all__ = ["LayerNames", "describe", "layer_names", "read_3dm", "write_moulds", "write_problem", "write_result"]

# Looked up when they are first used: rhino3dm is not loaded to read the other formats.
__getattr__, __dir__ = attach(
    __name__,
    {
        "LayerNames": ".layers",
        "describe": "..summary",
        "layer_names": ".layers",
        "read_3dm": ".read",
        "write_moulds": ".mould_layers",
        "write_problem": ".write",
        "write_result": ".result_layers",
    },
)
