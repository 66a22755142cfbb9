"""Endpoint of the component for freeform designs on few moulds."""

from __future__ import annotations

from ..api.searches import MAX_PLACES
from .schema import MAX_ITEMS
from .schema import Endpoint
from .schema import Input
from .schema import Output
from .schema import icon

__all__ = ["RATIONALISE", "rationalise_endpoint"]

RATIONALISE = "cgc/rationalise"


def rationalise_endpoint(info: Output) -> Endpoint:
    """Return the endpoint; `info` is the output of the report."""
    return Endpoint(
        RATIONALISE,
        "CGC Rationalise",
        "Find the surface with panels from few moulds that is nearest to a freeform design.",
        icon("M3 18C5 11 10 9 12 12C14 9 19 11 21 18M8 10V19M16 10V19", "#2b7bba"),
        (
            Input("Mesh", "M", "Mesh", "The design as a mesh."),
            Input("Supports", "S", "Point", "Points that are held. If empty, the corners.", many=True, optional=True),
            Input("Panel", "P", "Number", "Width of the panels. Defaults to 0: a twelfth of the longer side.", default=0.0, low=0.0),
            Input("Moulds", "N", "Integer", "Number of moulds. Defaults to 4.", default=4, low=1, high=64),
            Input(
                "Within",
                "W",
                "Number",
                "Largest distance from the design, for which the fewest moulds are found. Defaults to 0: use Moulds.",
                default=0.0,
                low=0.0,
            ),
            Input("Seams", "C", "Curve", "Curves along seams. If empty, a grid.", many=True, most=MAX_ITEMS, optional=True),
            Input(
                "Radii",
                "R",
                "Number",
                "Radii of existing moulds instead of their number: positive for spheres, negative for saddles, 0 for flat.",
                many=True,
                most=MAX_ITEMS,
                optional=True,
            ),
            Input("Locked", "L", "Integer", "Numbers of panels that keep a mould.", many=True, most=MAX_ITEMS, optional=True),
            Input(
                "LockedMoulds",
                "LM",
                "Integer",
                "Mould of each of these panels, as a position in Radii counted from 0.",
                many=True,
                most=MAX_ITEMS,
                optional=True,
            ),
            Input(
                "Costs",
                "Co",
                "Number",
                "Six costs, of a mould and of a panel, for flat, sphere and saddle moulds. With Within, the cheapest surface is found.",
                many=True,
                optional=True,
            ),
            Input(
                "Weights",
                "We",
                "Number",
                "Places where distances count more: five numbers each, x, y, z, radius and factor.",
                many=True,
                most=5 * MAX_PLACES,
                optional=True,
            ),
        ),
        (
            Output("Mesh", "M", "Mesh", "Surface, coloured by its signed distance from the design."),
            Output("Panels", "P", "Mesh", "Panels."),
            Output("Mould", "I", "Integer", "Number of the mould of each panel, counted from 0."),
            Output("K", "K", "Number", "Gaussian curvature of the moulds in 1 / (model unit)²."),
            Output("Seams", "S", "Curve", "Seams."),
            Output("Distance", "D", "Number", "Signed distance of each vertex from the design."),
            info,
        ),
    )
