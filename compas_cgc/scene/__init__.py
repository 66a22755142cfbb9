"""Scene objects of COMPAS: CGC meshes in Rhino, Grasshopper, notebooks and compas_viewer, in curvature colours, with supports and creases.

COMPAS finds the functions of this module through ``compas_cgc.__all_plugins__``.
"""

from __future__ import annotations

from compas.plugins import plugin
from compas.scene import register

__all__ = ["register_grasshopper", "register_notebook", "register_rhino", "register_viewer"]


@plugin(category="factories", pluggable_name="register_scene_objects", requires=["Rhino"])
def register_rhino() -> None:
    """Register how a CGC mesh is drawn in Rhino.

    Examples
    --------
    >>> register_rhino()  # doctest: +SKIP
    """
    from ..datastructures import CGCMesh
    from .rhino import CGCMeshObject

    register(CGCMesh, CGCMeshObject, context="Rhino")


@plugin(category="factories", pluggable_name="register_scene_objects", requires=["Grasshopper"])
def register_grasshopper() -> None:
    """Register how a CGC mesh is drawn in Grasshopper.

    Examples
    --------
    >>> register_grasshopper()  # doctest: +SKIP
    """
    from ..datastructures import CGCMesh
    from .grasshopper import CGCMeshObject

    register(CGCMesh, CGCMeshObject, context="Grasshopper")


@plugin(category="factories", pluggable_name="register_scene_objects", requires=["compas_viewer"])
def register_viewer() -> None:
    """Register how a CGC mesh is drawn in compas_viewer.

    Examples
    --------
    >>> register_viewer()  # doctest: +SKIP
    """
    from ..datastructures import CGCMesh
    from .viewer import CGCMeshObject

    register(CGCMesh, CGCMeshObject, context="Viewer")


@plugin(category="factories", pluggable_name="register_scene_objects", requires=["compas_notebook"])
def register_notebook() -> None:
    """Register how a CGC mesh is drawn in a notebook.

    Examples
    --------
    >>> register_notebook()  # doctest: +SKIP
    """
    from ..datastructures import CGCMesh
    from .notebook import CGCMeshObject

    register(CGCMesh, CGCMeshObject, context="Notebook")
