"""Figures of shapes and error maps, with captions as in the paper."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING
from typing import Any
from typing import NamedTuple
from typing import Optional
from typing import Union

import numpy as np

from ..discrete.arrays import Edges
from ..discrete.arrays import Faces
from ..discrete.arrays import IntArray
from ..discrete.arrays import PerVertex
from ..discrete.arrays import Vertices
from ..errors import ArgumentError
from ..errors import names_what_was_meant
from ..fabrication.picture_key import Key
from ..model.roles import INTERNAL
from .layout import caption
from .layout import heading
from .layout import letter
from .layout import panels
from .layout import shown
from .legend import BELOW
from .legend import FOOT
from .legend import SIDE
from .legend import add_key
from .maps import draw_error
from .projected_mesh import look
from .shape import draw_shape
from .view import View
from .view import view_axes
from .view import view_named

if TYPE_CHECKING:
    from matplotlib.figure import Figure

__all__ = ["Shape", "comparison_figure", "error_figure", "shape_figure"]

HEAD = 0.28  # room for a title above a panel [in]


class Shape(NamedTuple):
    """One shape of a figure.

    Parameters
    ----------
    title
        Title or caption, such as "Initial shape".
    vertices
        (n, 3) [L].
    faces
        (m, 3).
    roles
        (n,) index into ROLES.
    creases
        (e, 2) edges to draw as thick lines.
    errors
        (n,) K - K̄ [1/L^2], for error_figure.

    Examples
    --------
    >>> import compas_cgc
    >>> plan = compas_cgc.read(compas_cgc.get("cushion.3dm")).to_problem()
    >>> Shape("plan", plan.vertices, plan.faces, plan.roles).title
    'plan'
    """

    title: str  # title or caption, such as "Initial shape"
    vertices: Vertices  # (n, 3) [L]
    faces: Faces  # (m, 3)
    roles: IntArray  # (n,) index into ROLES
    creases: Optional[Edges] = None  # (e, 2) edges to draw as thick lines
    errors: Optional[PerVertex] = None  # (n,) K - K̄ [1/L^2], for error_figure


@names_what_was_meant()
def shape_figure(
    shapes: Sequence[Union[Shape, tuple[Any, ...]]],
    views: Sequence[Union[str, View]] = ("diagonal", "plan"),
    *,
    unit: Optional[str] = None,
    dummies: bool = True,
) -> Figure:
    """Return a figure with one row per shape, in (a) diagonal and (b) plan view, all at the same scale.

    Parameters
    ----------
    shapes
        A :class:`Shape` or a tuple of its fields per row.
    views
        Views in every row.
    unit
        Unit of length for the scale bar.
    dummies
        Whether to show dummy faces.

    Returns
    -------
    matplotlib.figure.Figure
        For :func:`save`.

    Raises
    ------
    ValueError
        If there is no shape.
    MeshError
        If the arrays are not a triangle mesh with a role for every vertex.
    CGCError
        If matplotlib is not installed.

    References
    ----------
    Paper, Figures 7, 8, 11, 12, 15, 16, 19, 20, 23, 24, 27, 28.

    Examples
    --------
    >>> import compas_cgc
    >>> plan = compas_cgc.read(compas_cgc.get("cushion.3dm")).to_problem()
    >>> len(shape_figure([("a plan", plan.vertices, plan.faces, plan.roles)]).axes)
    2
    """
    shapes = checked(shapes, "shape_figure")
    if not views:
        raise ArgumentError("shape_figure requires at least one view, such as 'diagonal' or 'plan'")
    rows = [[look(*shape[1:4], view, dummies).frame for view in views] for shape in shapes]
    figure, axes = panels(rows, head=HEAD, foot=FOOT)
    for shape, row in zip(shapes, axes):
        for i, (ax, view) in enumerate(zip(row, views)):
            draw_shape(*shape[1:5], view=view, ax=ax, dummies=dummies, frame=shown(ax))
            caption(ax, f"{letter(i)} {view} view" if isinstance(view, str) else letter(i))
        heading(row, shape.title)
    add_key(axes[-1][-1], Key(unit or ""), view_axes(view_named(views[-1])))
    return figure


@names_what_was_meant()
def comparison_figure(
    shapes: Sequence[Union[Shape, tuple[Any, ...]]],
    view: Union[str, View] = "diagonal",
    columns: int = 2,
    *,
    unit: Optional[str] = None,
    dummies: bool = True,
) -> Figure:
    """Return a figure of shapes side by side in one view and at the same scale, with captions (a), (b), ...

    Parameters
    ----------
    shapes
        A :class:`Shape` or a tuple of its fields per picture; the title is the caption.
    view
        View of all pictures.
    columns
        Number of pictures per row.
    unit
        Unit of length for the scale bar.
    dummies
        Whether to show dummy faces.

    Returns
    -------
    matplotlib.figure.Figure
        For :func:`save`.

    Raises
    ------
    ValueError
        If there is no shape.
    MeshError
        If the arrays are not a triangle mesh with a role for every vertex.
    CGCError
        If matplotlib is not installed.

    References
    ----------
    Paper, Figure 18.

    Examples
    --------
    >>> import compas_cgc
    >>> plan = compas_cgc.read(compas_cgc.get("cushion.3dm")).to_problem()
    >>> len(comparison_figure([("a plan", plan.vertices, plan.faces, plan.roles)]).axes)
    1
    """
    shapes = checked(shapes, "comparison_figure")
    frames = [look(*shape[1:4], view, dummies).frame for shape in shapes]
    rows = [frames[i : i + columns] for i in range(0, len(frames), columns)]
    figure, axes = panels(rows, foot=FOOT)
    for i, (ax, shape) in enumerate(zip(sum(axes, []), shapes)):
        draw_shape(*shape[1:5], view=view, ax=ax, dummies=dummies, frame=shown(ax))
        caption(ax, f"{letter(i)} {shape.title}")
    add_key(axes[-1][0], Key(unit or ""), view_axes(view_named(view)))
    return figure


@names_what_was_meant()
def error_figure(
    shapes: Sequence[Union[Shape, tuple[Any, ...]]],
    view: Union[str, View] = "plan",
    *,
    unit: Optional[str] = None,
    label: Optional[str] = None,
) -> Figure:
    """Return a figure of error maps side by side, such as (a) initial and (b) final, each with its own colour scale.

    Parameters
    ----------
    shapes
        A :class:`Shape` with errors, or a tuple of its fields, per picture.
    view
        View of all pictures.
    unit
        Unit of length for the labels.
    label
        Label of the colour bars. Default: K - K̄ with its unit.

    Returns
    -------
    matplotlib.figure.Figure
        For :func:`save`.

    Raises
    ------
    ValueError
        If there is no shape, or one without errors.
    MeshError
        If the arrays are not a triangle mesh with a role for every vertex.
    CGCError
        If matplotlib is not installed.

    References
    ----------
    Paper, Figures 22 and 26.

    Examples
    --------
    >>> import compas_cgc
    >>> dome = compas_cgc.solve(compas_cgc.read(compas_cgc.get("cushion.3dm")))
    >>> errors = dome.curvature - dome.problem.targets
    >>> type(error_figure([("final", dome.vertices, dome.faces, dome.problem.roles, None, errors)])).__name__
    'Figure'
    """
    shapes = checked(shapes, "error_figure")
    errors = [given_errors(shape) for shape in shapes]
    frames = [look(*shape[1:4], view, dummies=False).frame for shape in shapes]
    figure, (axes,) = panels([frames], foot=FOOT + 0.25, side=SIDE)
    for i, (ax, shape, error) in enumerate(zip(axes, shapes, errors)):
        draw_error(*shape[1:4], error, view, ax, creases=shape.creases, unit=unit, label=label, frame=shown(ax))
        caption(ax, f"{letter(i)} {shape.title}\n{largest(shape)}")
    add_key(axes[0], Key(unit or ""), view_axes(view_named(view)), below=BELOW + 18.0)
    return figure


def checked(shapes: Sequence[Union[Shape, tuple[Any, ...]]], name: str) -> list[Shape]:
    """Return the shapes as :class:`Shape`; raise an error if there are none."""
    if not all(isinstance(shape, Shape) or 4 <= len(shape) <= 6 for shape in shapes):
        raise ArgumentError(f"{name} requires a Shape per picture, or (title, vertices, faces, roles) and optional creases, errors")
    result = [shape if isinstance(shape, Shape) else Shape(*shape) for shape in shapes]
    if not result:
        raise ValueError(f"{name} requires at least one shape")
    return result


def given_errors(shape: Shape) -> PerVertex:
    """Return the errors of a shape; raise an error if it has none."""
    if shape.errors is None:
        raise ValueError(f"error_figure requires errors, but {shape.title!r} has none")
    return shape.errors


def largest(shape: Shape) -> str:
    """Return a text with the largest error of a shape."""
    errors = np.abs(np.asarray(shape.errors, dtype=np.float64)[np.asarray(shape.roles) == INTERNAL])
    return f"largest error {np.nanmax(errors):.3g}" if np.isfinite(errors).any() else "no K prescribed"
