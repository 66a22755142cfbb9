"""Page on moulds: panels in plan and on their moulds, deviation without bending, and bending stress."""

from __future__ import annotations

from typing import TYPE_CHECKING
from typing import Any
from typing import Optional

import numpy as np

from .._figures import matplotlib_module
from .._figures import new_figure
from ..discrete import face_normals
from ..discrete.arrays import FloatArray
from ..errors import names_what_was_meant
from ..fabrication.figures import unit_symbol
from ..fabrication.front_view import front_view
from ..fabrication.mould_layout import shapes_note
from ..fabrication.mould_layout import side_note
from ..fabrication.mould_report import Mould
from ..fabrication.mould_report import MouldReport
from ..fabrication.mould_report import PanelFit
from ..fabrication.mould_surface import cap_mesh
from ..fabrication.picture_key import key_of
from ..meshing import boundary_loops
from ..model.problem import CGCProblem
from ..model.problem import PosesProblem
from .colours import INK
from .colours import PALETTE
from .free_texts import LETTER
from .legend import add_key

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

__all__ = ["moulds_figure"]

PAGE = (11.7, 8.3)  # A4 [in]
WARNING = "#b00020"
MIN_FONT = 2.0  # of the names of panels, below which they are left out [pt]
FONT = 6.2  # of the report [pt]
LINE_PITCH = 1.35  # of the report, relative to the font
TEXT_ROOM = 0.33  # height for the report above the plans, relative to A4
MAX_MOULDS = 4  # number of moulds that are drawn


@names_what_was_meant()
def moulds_figure(mesh: PosesProblem, report: MouldReport, title: str = "") -> Figure:
    """Return a page with figures of panels and moulds.

    Parameters
    ----------
    mesh
        The solved surface.
    report
        Report from :func:`compas_cgc.fabrication.moulds`.
    title
        Title of the page.

    Returns
    -------
    matplotlib.figure.Figure
        For :func:`save`.

    Raises
    ------
    CGCError
        If matplotlib is not installed.

    Examples
    --------
    >>> import compas_cgc
    >>> from compas_cgc.fabrication import moulds, panels
    >>> vault = compas_cgc.solve(compas_cgc.read(compas_cgc.get("vault.3dm")))
    >>> type(moulds_figure(vault, moulds(vault, panels(vault, 3.0)))).__name__
    'Figure'
    """
    problem = mesh.to_problem().without_dummies()
    sides = side_note([own.K for own in report.moulds])
    notes = [shapes_note(unit_symbol(problem.drawing.units)), *([sides] if sides else [])]
    lines = [*str(report).split("\n"), *notes]
    warned = 1 if report.overstressed else 0
    warning = _wrapped("\n".join(lines[:warned]))
    rest = "\n" * len(warning.splitlines()) + _wrapped("\n".join(lines[warned:]))
    # A longer report needs a taller page.
    height = PAGE[1] + max(0.0, (len(rest.splitlines()) + 1) * FONT * LINE_PITCH / 72.0 - TEXT_ROOM * PAGE[1])
    share = PAGE[1] / height
    figure = new_figure(PAGE[0], height)
    figure.text(0.03, 1.0 - 0.035 * share, title or "Moulds", fontsize=13, color=INK, va="top")
    for text, ink in ((warning, WARNING), (rest, INK)):
        figure.text(0.03, 1.0 - 0.075 * share, text, fontsize=FONT, color=ink, va="top", family="monospace", linespacing=LINE_PITCH)

    def lower(left: float) -> Axes:
        return figure.add_axes((left, 0.06 * share, 0.30, 0.52 * share))

    plan = lower(0.03)
    kinds = [PALETTE[(fit.mould - 1) % len(PALETTE)] for fit in report.panels]
    _draw_plan(plan, problem, report, colours=kinds)
    plan.set_title("panels, coloured by mould", fontsize=8)
    add_key(plan, key_of(problem)._replace(words=()), front_view(problem))
    _draw_values(figure, lower(0.35), problem, report, [fit.rigid for fit in report.panels], "deviation without bending [mm]")
    text = f"bending stress, {report.thickness:g} mm {report.material.name} [MPa]"
    _draw_values(figure, lower(0.67), problem, report, [fit.stress for fit in report.panels], text)
    shown = report.moulds[:MAX_MOULDS]
    side = min(0.28, 0.5 / len(shown))
    for k, mould in enumerate(shown):
        ax = figure.add_axes((0.98 - (len(shown) - k) * side, 1.0 - 0.35 * share, side - 0.01, 0.28 * share))
        _draw_mould(ax, mould, [fit for fit in report.panels if fit.mould == mould.number], report.unit)
    return figure


def _wrapped(text: str) -> str:
    """Wrap lines to the width beside the moulds."""
    from textwrap import wrap

    lines = []
    for line in text.splitlines():
        indent = "  " if line.startswith(" ") else ""
        lines += wrap(line, 84, initial_indent="", subsequent_indent=indent + "  ")
    return "\n".join(lines)


def _draw_plan(ax: Axes, problem: CGCProblem, report: MouldReport, colours: list) -> None:
    axes = front_view(problem)[:2]
    collections, outlines = matplotlib_module("collections"), []
    triangles, fill = [], []
    for fit, colour in zip(report.panels, colours):
        sheet = fit.vertices @ axes.T
        triangles.append(sheet[fit.faces])
        fill += [colour] * len(fit.faces)
        outlines += [sheet[np.append(loop, loop[0])] for loop in boundary_loops(fit.faces)]
    ax.add_collection(collections.PolyCollection(np.concatenate(triangles), facecolors=fill, edgecolors=fill, linewidths=0.2))
    ax.add_collection(collections.LineCollection(outlines, colors=INK, linewidths=0.4))
    _name_panels(ax, report, triangles, colours)
    _tidy(ax)


def _name_panels(ax: Axes, report: MouldReport, triangles: list[FloatArray], colours: list) -> None:
    """Write the name of every panel at its centre, fitted to its width, light on dark colours."""
    across = np.ptp(np.concatenate(triangles).reshape(-1, 2), axis=0)
    box = ax.get_window_extent()
    scale = 72.0 / ax.figure.dpi * float((np.array([box.width, box.height]) / np.maximum(1.04 * across, 1e-300)).min())  # points to a unit
    to_rgb = matplotlib_module("colors").to_rgb
    for fit, own, colour in zip(report.panels, triangles, colours):
        ahead, back = own[:, 1] - own[:, 0], own[:, 2] - own[:, 0]
        areas = 0.5 * np.abs(ahead[:, 0] * back[:, 1] - ahead[:, 1] * back[:, 0])
        x, y = areas @ own.mean(axis=1) / areas.sum()
        size = min(0.75 * float(np.sqrt(areas.sum())) * scale / (LETTER * len(fit.panel.name)), 8.0)
        if size < MIN_FONT:
            continue
        ink = INK if np.dot(to_rgb(colour), [0.299, 0.587, 0.114]) > 0.45 else "white"
        ax.text(x, y, fit.panel.name, fontsize=size, ha="center", va="center", color=ink, clip_on=True)


def _draw_values(figure: Figure, ax: Axes, problem: CGCProblem, report: MouldReport, values: list[Optional[float]], what: str) -> None:
    known = [value for value in values if value is not None]
    cm, colors = matplotlib_module("cm"), matplotlib_module("colors")
    scale = cm.ScalarMappable(colors.Normalize(0.0, max(known, default=1.0) or 1.0), "YlOrRd")
    _draw_plan(ax, problem, report, ["#b5b5b5" if value is None else scale.to_rgba(value) for value in values])
    ax.set_title(what, fontsize=8)
    bar = figure.colorbar(scale, ax=ax, orientation="horizontal", fraction=0.04, pad=0.02)
    bar.ax.tick_params(labelsize=6)


def _draw_mould(ax: Axes, mould: Mould, panels: list[PanelFit], unit: float) -> None:
    """Draw a mould from above with the outlines of all its panels."""
    vertices, faces = cap_mesh(mould.surface, mould.radius)
    collections = matplotlib_module("collections")
    light = 0.75 + 0.25 * face_normals(vertices, faces) @ np.array([-0.5, 0.5, 0.707])
    fill = np.clip(light, 0.0, 1.0)[:, None] * np.array(matplotlib_module("colors").to_rgb(PALETTE[(mould.number - 1) % len(PALETTE)]))
    ax.add_collection(collections.PolyCollection(vertices[faces][:, :, :2], facecolors=fill, edgecolors=fill, linewidths=0.2))
    lines: list[Any] = []
    for fit in panels:
        lines += [fit.on_mould[np.append(loop, loop[0])][:, :2] for loop in boundary_loops(fit.faces)]
    ax.add_collection(collections.LineCollection(lines, colors=INK, linewidths=0.3))
    ax.set_title(f"mould {mould.number}: {mould.kind}\nK = {mould.K / unit**2:.4g} 1/m²", fontsize=7)
    _tidy(ax)


def _tidy(ax: Axes) -> None:
    ax.autoscale()
    ax.margins(0.02)
    ax.set_aspect("equal")
    ax.set_axis_off()
