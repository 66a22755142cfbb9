"""Pictures of shapes, errors, histories and curves, as in the paper's Figures 4-30.

``draw_...`` functions draw on given axes (or on a new figure) and return the axes;
``..._figure`` functions return whole figures; :func:`save` writes them.
Requires the extra ``plot``; matplotlib is imported lazily.
"""

from __future__ import annotations

from .._figures import save
from ..fabrication.picture_key import Key
from ..fabrication.picture_key import key_of
from .curve import Curve
from .curve import curve_figure
from .curve import draw_curve
from .figures import Shape
from .figures import comparison_figure
from .figures import error_figure
from .figures import shape_figure
from .history import draw_history
from .history import history_figure
from .maps import draw_curvature
from .maps import draw_error
from .moulds import moulds_figure
from .shape import draw_shape
from .studio_light import studio
from .studio_light import studio_image
from .view import VIEWS
from .view import View
from .zebra import draw_zebra

__all__ = [
    "VIEWS",
    "Curve",
    "Key",
    "Shape",
    "View",
    "comparison_figure",
    "curve_figure",
    "draw_curvature",
    "draw_curve",
    "draw_error",
    "draw_history",
    "draw_shape",
    "draw_zebra",
    "error_figure",
    "history_figure",
    "key_of",
    "moulds_figure",
    "save",
    "shape_figure",
    "studio",
    "studio_image",
]
