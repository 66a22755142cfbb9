#! python 3
# venv: compas_cgc
"""Create a mesh with supports and creases. Surfaces, SubDs and outlines are meshed.

COMPAS CGC {{version}}
"""

import Grasshopper
import Rhino
import System

from compas_cgc.grasshopper.components.mesh import cgc_mesh


class Mesh(Grasshopper.Kernel.GH_ScriptInstance):
    def RunScript(
        self,
        mesh: Rhino.Geometry.Mesh,
        supports: System.Collections.Generic.List[Rhino.Geometry.Point3d],
        fix: str,
        creases: System.Collections.Generic.List[Rhino.Geometry.Curve],
        surfaces: System.Collections.Generic.List[Rhino.Geometry.GeometryBase],
        edge_length: float,
        flip: bool,
    ):
        out = cgc_mesh(ghenv.Component, mesh, supports, fix, creases, flip, surfaces, edge_length)  # noqa: F821
        return out.cgc_mesh, out.problems
