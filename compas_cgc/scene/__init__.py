"""COMPAS scene objects for CGC meshes in Rhino, Grasshopper, notebooks and compas_viewer, with colours, supports and creases.

COMPAS finds these plugins through ``compas_cgc.__all_plugins__``.
"""

from __future__ import annotations

from compas.plugins import plugin
from compas.scene import register

__all__ = ["register_grasshopper", "register_notebook", "register_rhino", "register_viewer"]


@plugin(category="factories", pluggable_name="register_scene_objects", requires=["Rhino"])
def register_rhino() -> None:
    """Register the scene object for Rhino.

    Examples
    --------
    >>> register_rhino()  # doctest: +SKIP
    """
    from ..datastructures import CGCMesh
    from .rhino import CGCMeshObject

    register(CGCMesh, CGCMeshObject, context="Rhino")


@plugin(category="factories", pluggable_name="register_scene_objects", requires=["Grasshopper"])
def register_grasshopper() -> None:
    """Register the scene object for Grasshopper.

    Examples
    --------
    >>> register_grasshopper()  # doctest: +SKIP
    """
    from ..datastructures import CGCMesh
    from .grasshopper import CGCMeshObject

    register(CGCMesh, CGCMeshObject, context="Grasshopper")


@plugin(category="factories", pluggable_name="register_scene_objects", requires=["compas_viewer"])
def register_viewer() -> None:
    """Register the scene object for compas_viewer.

    Examples
    --------
    >>> register_viewer()  # doctest: +SKIP
    """
    from ..datastructures import CGCMesh
    from .viewer import CGCMeshObject

    register(CGCMesh, CGCMeshObject, context="Viewer")


@plugin(category="factories", pluggable_name="register_scene_objects", requires=["compas_notebook"])
def register_notebook() -> None:
    """Register the scene object for notebooks.

    Examples
    --------
    >>> register_notebook()  # doctest: +SKIP
    """
    from ..datastructures import CGCMesh
    from .notebook import CGCMeshObject

    register(CGCMesh, CGCMeshObject, context="Notebook")
