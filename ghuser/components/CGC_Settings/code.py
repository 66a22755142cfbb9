#! python 3
# venv: compas_cgc
"""Set the method and options of a solve. Without settings, Solve chooses the method.

COMPAS CGC {{version}}
"""

import Grasshopper
import Rhino  # noqa: F401
import System  # noqa: F401

from compas_cgc.grasshopper.components.settings import settings


class Settings(Grasshopper.Kernel.GH_ScriptInstance):
    def RunScript(
        self,
        method: str,
        steps: int,
        tolerance: float,
        s: float,
        delay: int,
        filter_radius: float,
        nearness: float,
        smoothness: float,
        crease_stiffness: float,
        measure: str,
    ):
        out = settings(
            ghenv.Component,  # noqa: F821
            method,
            steps,
            tolerance,
            s,
            delay,
            filter_radius,
            nearness,
            smoothness,
            crease_stiffness,
            measure,
        )
        return out.settings
