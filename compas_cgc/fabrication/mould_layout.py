"""Positions of moulds, and of the panels on them, beside the roof."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from ..discrete.arrays import FloatArray
from ..model.problem import CGCProblem
from .mould_report import Mould
from .mould_report import MouldReport
from .mould_report import PanelFit

__all__ = ["MouldPlace", "mould_places", "shapes_note", "side_note"]

PANEL_SPACING = 1.2  # distance between panels, relative to the width of the cap
MOULD_OFFSET = 0.15  # distance of the moulds from the roof, relative to its size


class MouldPlace(NamedTuple):
    """Position of a mould, and of each of its panels on a copy of it."""

    mould: Mould
    pole: FloatArray  # (3,) [L]
    panels: list[PanelFit]
    poles: list[FloatArray]  # (3,) of every panel [L]


def shapes_note(unit: str) -> str:
    """Return the sentence on what is not on papers but in the .3dm file, whose unit of length is given by its symbol."""
    return (
        f"the .3dm file of the moulds, whose unit of length is {unit} while papers are in mm, holds the shape of outlines between corners "
        '(layer "Outlines"), the curved panels in the roof ("Panels in place"), each panel on its mould ("Panels on moulds"), and the '
        'lower and the upper face of a sheet on the mould ("Faces", hidden at first)'
    )


def side_note(curvatures: Sequence[float]) -> str:
    """Return the sentence on the shape and the face of moulds of some K, by the side of panels laid on them; empty if all are plane."""
    domes = (
        'K > 0: a mould for the hollow side of panels is humped, and its face is the lower one of the layer "Faces"; a mould for their '
        "bulging side is hollow, and its face is the upper one"
    )
    saddles = (
        'K < 0: a mould is a saddle, humped in one direction and hollow in the other; its face is the lower one of the layer "Faces" if '
        "panels are laid on it with their inside, the upper one if with their outside"
    )
    return "; ".join(([domes] if max(curvatures) > 0.0 else []) + ([saddles] if min(curvatures) < 0.0 else []))


def mould_places(problem: CGCProblem, report: MouldReport) -> list[MouldPlace]:
    """Return the positions of all moulds, in rows along y beside the surface."""
    low, high = problem.vertices.min(axis=0), problem.vertices.max(axis=0)
    corner = np.array([high[0] + MOULD_OFFSET * float(np.linalg.norm(high - low)), low[1], low[2]])
    places = []
    for mould in report.moulds:
        own = [fit for fit in report.panels if fit.mould == mould.number]
        pitch = PANEL_SPACING * 2.0 * mould.radius
        pole = corner + [0.5 * pitch, 0.5 * pitch, 0.0]
        columns = max(1, math.ceil(math.sqrt(2.0 * len(own))))
        poles = [pole + [(k % columns + 1) * pitch, k // columns * pitch, 0.0] for k in range(len(own))]
        places.append(MouldPlace(mould, pole, own, poles))
        corner = corner + [0.0, pitch * (math.ceil(len(own) / columns) + 0.5), 0.0]
    return places
