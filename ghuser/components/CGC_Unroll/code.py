#! python 3
# venv: compas_cgc
"""Unroll a solved surface into flat pieces on sheets. Regions with K = 0 keep all lengths.

COMPAS CGC {{version}}
"""

import Grasshopper
import Rhino  # noqa: F401
import System  # noqa: F401

from compas_cgc.grasshopper.components.unroll import unroll


class Unroll(Grasshopper.Kernel.GH_ScriptInstance):
    def RunScript(
        self,
        cgc_mesh,
        length: float,
        width: float,
        strain: float,
        spacing: float,
        path: str,
        write: bool,
        margin: float,
        allowance: float,
        per_sheet: bool,
        whole: bool,
        kerf: float,
        material: str,
        thickness: float,
    ):
        sheets = (length, width, strain, spacing, path, write, margin, allowance, per_sheet, whole, kerf, material, thickness)
        out = unroll(ghenv.Component, cgc_mesh, *sheets)  # noqa: F821
        return (
            out.outlines,
            out.folds,
            out.rulings,
            out.marks,
            out.sheets,
            out.labels,
            out.places,
            out.pieces,
            out.report,
            out.allowances,
            out.cut_list,
        )
