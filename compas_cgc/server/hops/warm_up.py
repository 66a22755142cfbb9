"""Initialisation of a worker before its first task."""

from __future__ import annotations

from ..._warm_up import warm_up as warm_up_kernels
from ...datastructures import CGCMesh
from ..api.rhino_mesh import mesh_text
from ..limits import Limits
from .functions import run_function
from .protocol import context_of

__all__ = ["warm_up"]


def warm_up() -> None:
    """Load the kernels and the modules for Hops, so that the first request is not delayed."""
    warm_up_kernels()
    try:
        mesh = mesh_text(*CGCMesh.from_meshgrid(dx=2, nx=2).arrays())
    except ImportError:
        # Without rhino3dm, the components report their own error.
        return
    values = {"Mesh": mesh, "K": 0.01}
    asked = [{"ParamName": name, "InnerTree": {"{0}": [{"data": value}]}} for name, value in values.items()]
    run_function("cgc/dome", asked, context_of({}), Limits())
