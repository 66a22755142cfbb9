#! python 3
# venv: compas_cgc
"""Set requirements on the surface besides its curvature, such as rise, volume or clearance, and regions with unknown K.

COMPAS CGC {{version}}
"""

import Grasshopper
import Rhino
import System

from compas_cgc.grasshopper.components.goals import goals


class Goals(Grasshopper.Kernel.GH_ScriptInstance):
    def RunScript(
        self,
        rise: float,
        height: float,
        volume: float,
        area: float,
        clear: System.Collections.Generic.List[Rhino.Geometry.Curve],
        clearance: System.Collections.Generic.List[float],
        below: float,
        within: Rhino.Geometry.Curve,
        keep_edges: bool,
        level_edges: bool,
        unknown: System.Collections.Generic.List[int],
        others: System.Collections.Generic.List[object],
    ):
        out = goals(
            ghenv.Component,  # noqa: F821
            rise,
            height,
            volume,
            area,
            clear,
            clearance,
            below,
            within,
            keep_edges,
            level_edges,
            unknown,
            others,
        )
        return out.goals
