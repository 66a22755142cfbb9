#! python 3
# venv: compas_cgc
"""Divide a surface into panels, and report their moulds and their fit.

COMPAS CGC {{version}}
"""

import Grasshopper
import Rhino
import System

from compas_cgc.grasshopper.components.mould import mould


class Mould(Grasshopper.Kernel.GH_ScriptInstance):
    def RunScript(
        self,
        cgc_mesh,
        size: float,
        count: int,
        curves: System.Collections.Generic.List[Rhino.Geometry.Curve],
        along: str,
        material: str,
        thickness: float,
        tolerance: float,
        least_bending: bool,
        rough: bool,
        aside: float,
    ):
        given = (cgc_mesh, size, count, curves, along, material, thickness, tolerance, least_bending, rough, aside)
        out = mould(ghenv.Component, *given)  # noqa: F821
        return out.panels, out.on_moulds, out.moulds, out.names, out.mould, out.misses, out.change, out.stress, out.report
