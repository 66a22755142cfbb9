#! python 3
# venv: compas_cgc
"""Set the target Gaussian curvature or the law, everywhere or region by region.

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
        law: System.Collections.Generic.List[str],
        radius: System.Collections.Generic.List[float],
    ):
        out = target(ghenv.Component, cgc_mesh, K, region, point, law, radius)  # noqa: F821
        return out.cgc_mesh
