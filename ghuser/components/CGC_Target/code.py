#! python 3
# venv: compas_cgc
"""Set the target Gaussian curvature, everywhere or region by region.

COMPAS CGC {{version}}
"""

import Grasshopper
import Rhino
import System

from compas_cgc.grasshopper.components.target import target


class Target(Grasshopper.Kernel.GH_ScriptInstance):
    def RunScript(
        self,
        cgc_mesh,
        K: System.Collections.Generic.List[float],
        region: System.Collections.Generic.List[int],
        point: System.Collections.Generic.List[Rhino.Geometry.Point3d],
    ):
        out = target(ghenv.Component, cgc_mesh, K, region, point)  # noqa: F821
        return out.cgc_mesh
