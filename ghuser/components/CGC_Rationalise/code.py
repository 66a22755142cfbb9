#! python 3
# venv: compas_cgc
"""Find the surface with panels from few moulds that is nearest to a freeform design.

COMPAS CGC {{version}}
"""

import Grasshopper
import Rhino
import System

from compas_cgc.grasshopper.components.rationalise import rationalise


class Rationalise(Grasshopper.Kernel.GH_ScriptInstance):
    def RunScript(
        self,
        design,
        panel: float,
        moulds: System.Collections.Generic.List[float],
        seams: System.Collections.Generic.List[Rhino.Geometry.Curve],
        limit: float,
        supports: System.Collections.Generic.List[Rhino.Geometry.Point3d],
        costs: System.Collections.Generic.List[float],
        weights: System.Collections.Generic.List[float],
        run: bool,
        wait: bool,
    ):
        out = rationalise(ghenv.Component, design, panel, moulds, seams, limit, supports, costs, weights, run, wait)  # noqa: F821
        return out.mesh, out.cgc_mesh, out.panels, out.classes, out.curvatures, out.seam_lines, out.distance, out.kinks, out.report
