#! python 3
# venv: compas_cgc
"""Constrain the positions of vertices, besides the curvature.

COMPAS CGC {{version}}
"""

import Grasshopper
import Rhino
import System

from compas_cgc.grasshopper.components.constraints import constraints


class Constraints(Grasshopper.Kernel.GH_ScriptInstance):
    def RunScript(
        self,
        cgc_mesh,
        points: System.Collections.Generic.List[Rhino.Geometry.Point3d],
        height: float,
        curve: Rhino.Geometry.Curve,
        plane: Rhino.Geometry.Plane,
        mirror: Rhino.Geometry.Plane,
        others: System.Collections.Generic.List[object],
    ):
        out = constraints(ghenv.Component, cgc_mesh, points, height, curve, plane, mirror, others)  # noqa: F821
        return out.goals
