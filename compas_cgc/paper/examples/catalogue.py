"""Catalogue of all examples and variants of the paper with the published values."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from typing import Optional
from typing import Union

from ...datastructures import CGCMesh
from ...discrete.arrays import FloatArray
from ...solvers.flow import FlowSettings
from .cone import example5
from .curves import example1
from .grids import example2
from .grids import example3
from .grids import example4
from .octants import example7
from .plan import example6

__all__ = ["CATALOGUE", "CurveExample", "SurfaceExample", "examples_of"]


@dataclass(frozen=True)
class CurveExample:
    """A variant of Example 1.

    Parameters
    ----------
    number
        Number of the example in the paper.
    variant
        Letter or name of the variant.
    title
        Title of the variant.
    build
        Function that returns the points and the arguments of the flow.

    Examples
    --------
    >>> from compas_cgc.paper.examples import examples_of
    >>> examples_of(1)[0].number
    1
    """

    number: int
    variant: str
    title: str
    build: Callable[[], tuple[FloatArray, dict]]

    @property
    def name(self) -> str:
        """Name for files."""
        return f"example{self.number}_{self.variant}"


@dataclass(frozen=True)
class SurfaceExample:
    """A variant of Examples 2 to 7.

    Parameters
    ----------
    number
        Number of the example in the paper.
    variant
        Letter or name of the variant, empty for an example with one variant only.
    title
        Title of the variant.
    build
        Function that returns the mesh and the settings of the flow.
    paper_size
        Number of vertices and faces, including dummies.
    paper_seconds
        Time on a Core i7-8850H [s].
    paper_error
        Largest |K - K̄| of the result [1/L^2].
    paper_start_error
        Largest |K - K̄| of the initial surface [1/L^2].
    counterpart
        Whether the mesh of the paper is known from a picture only.
    error_map
        Whether the paper shows an error map.

    Examples
    --------
    >>> from compas_cgc.paper.examples import examples_of
    >>> examples_of(6)[0].counterpart
    True
    """

    number: int
    variant: str  # empty for an example with one variant only
    title: str
    build: Callable[[], tuple[CGCMesh, FlowSettings]]
    paper_size: tuple[int, int]  # vertices and faces, including dummies
    paper_seconds: Optional[float] = None  # time on a Core i7-8850H [s]
    paper_error: Optional[float] = None  # largest |K - K̄|
    paper_start_error: Optional[float] = None  # largest |K - K̄| of the initial surface
    counterpart: bool = False  # whether the mesh of the paper is known from a picture only
    error_map: bool = False  # whether the paper shows an error map

    @property
    def name(self) -> str:
        """Name for files."""
        return f"example{self.number}_{self.variant}" if self.variant else f"example{self.number}"


def _curves() -> list[CurveExample]:
    return [
        CurveExample(1, f"{kind.lower()}{letter}", f"{kind}, {title}", partial(example1, kind, **options))
        for kind in ("C1", "C2")
        for letter, title, options in (
            ("a", "no internal boundary", dict(crease=False)),
            ("b", "S1 with s = 0.8", dict(s=0.8)),
            ("c", "S2 with e = 3", dict(e=3)),
        )
    ]


def _grids() -> list[SurfaceExample]:
    small, large = (144, 242), (324, 578)
    mixed = partial(example4, centre=4.0, around=1.0)
    return [
        SurfaceExample(2, "", "fixed boundary, K̄ = 1", example2, small, 117.8),
        SurfaceExample(2, "nofilter", "fixed boundary, K̄ = 1, without filter", partial(example2, False), small),
        SurfaceExample(3, "", "four corners fixed, K̄ = 1", example3, small, 111.5),
        SurfaceExample(3, "nofilter", "four corners fixed, K̄ = 1, without filter", partial(example3, False), small),
        SurfaceExample(4, "", "nine regions, K̄ = 4, S1 with s = 0.8", example4, large),
        SurfaceExample(4, "a", "K̄ = 4 in the centre, 1 around, S1 with s = 0.8", mixed, large, 273.0),
        SurfaceExample(4, "b", "K̄ = 4 in the centre, 1 around, S1 with s = 0.5", partial(mixed, s=0.5), large),
        SurfaceExample(4, "c", "K̄ = 4 in the centre, 1 around, S2 with e = 2", partial(mixed, s=1.0, e=2), large),
        SurfaceExample(4, "d", "K̄ = 4 in the centre, 1 around, S2 with e = 5", partial(mixed, s=1.0, e=5), large),
    ]


def _free_forms() -> list[SurfaceExample]:
    shown = dict(counterpart=True, error_map=True)
    return [
        SurfaceExample(5, "", "developable, K̄ = 0", example5, (226, 408), 488.5, **shown),
        SurfaceExample(6, "", "free-form plan, K̄ = 0.03", example6, (648, 1200), 963.8, 6.031e-4 * 0.03, **shown),
        SurfaceExample(7, "a", "curved creases, K̄ = 0.05", example7, (389, 712), 870.0, 2.071e-7, 7.349e-2, counterpart=True),
        SurfaceExample(7, "b", "curved creases, K̄ = 0", partial(example7, 0.0), (389, 712), None, 3.268e-3, 2.349e-2, counterpart=True),
    ]


CATALOGUE: list[Union[CurveExample, SurfaceExample]] = [*_curves(), *_grids(), *_free_forms()]


def examples_of(number: int, variant: Optional[str] = None) -> list[Union[CurveExample, SurfaceExample]]:
    """Return the variants of an example, or one variant.

    Parameters
    ----------
    number
        From 1 to 7.
    variant
        Name of the variant. Default: all variants.

    Returns
    -------
    list
        The examples.

    Raises
    ------
    ValueError
        If the example or variant does not exist.

    Examples
    --------
    >>> [example.variant for example in examples_of(4)]
    ['', 'a', 'b', 'c', 'd']
    """
    found = [example for example in CATALOGUE if example.number == number]
    if not found:
        raise ValueError(f"there is no example {number}; the paper has Examples 1 to 7")
    if variant is None:
        return found
    named = [example for example in found if example.variant == variant]
    if not named:
        known = ", ".join(repr(example.variant) for example in found)
        raise ValueError(f"Example {number} has no variant {variant!r}; its variants are {known}")
    return named
