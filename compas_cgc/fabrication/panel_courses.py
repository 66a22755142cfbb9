"""Courses of erection of panels."""

from __future__ import annotations

import numpy as np

from ..model.problem import CGCProblem
from .assembly import numbered_courses
from .mould_report import MouldReport

__all__ = ["panel_courses"]


def panel_courses(problem: CGCProblem, report: MouldReport) -> list[int]:
    """Return the course of every panel of a report: 1 for panels on supports, 2 for their neighbours, and so on."""
    held = np.zeros(len(problem.vertices), bool)
    held[problem.supports] = True
    number = {fit.panel.name: k for k, fit in enumerate(report.panels)}
    beside: list[set[int]] = [set() for _ in report.panels]
    for seam in report.seams:
        one, other = (number[name] for name in seam.panels)
        beside[one].add(other)
        beside[other].add(one)
    stands = []
    for fit in report.panels:
        cut = fit.panel.cut
        used = np.unique((problem.faces if cut is None else cut.faces)[fit.panel.faces])
        # The vertices of the mesh come first in the cut mesh.
        stands.append(bool(held[used[used < len(held)]].any()))
    lowest = np.array([fit.vertices[:, 2].min() for fit in report.panels])
    return numbered_courses(np.array(stands), lowest, [sorted(own) for own in beside])
