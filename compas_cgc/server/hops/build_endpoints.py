"""Endpoints that build from a solved surface."""

from __future__ import annotations

from ...fabrication import MATERIALS
from ...fabrication.option_values import ALONG
from .schema import Endpoint
from .schema import Input
from .schema import Output
from .schema import icon

__all__ = ["BUILDS", "build_endpoints"]

BLUE = "#2b7bba"
BUILDS = "cgc/mould", "cgc/unroll", "cgc/membrane", "cgc/net"


def build_endpoints(drawn: dict[str, Input], info: Output) -> tuple[Endpoint, ...]:
    """Return the endpoints.

    Parameters
    ----------
    drawn
        The inputs of a solve that say what is drawn, by name.
    info
        The output of the report.
    """
    surface = (drawn["Mesh"], drawn["Creases"], drawn["K"], drawn["At"])
    spacing = Input("Spacing", "S", "Number", "Distance between curves. Defaults to 0, a twelfth of a region.", default=0.0, low=0.0)
    return (
        Endpoint(
            "cgc/mould",
            "CGC Mould",
            "Divide a solved surface into panels, and lay them onto the moulds that they are made on.",
            icon("M3 20C3 11 21 11 21 20ZM7 8C10 4 14 4 17 8", BLUE),
            (
                *surface,
                Input("Count", "N", "Integer", "Panels to each region, nearly. Defaults to 4.", default=4, low=1, high=100_000),
                Input(
                    "Size", "W", "Number", "Width of the panels, instead of Count. Defaults to 0, which is by Count.", default=0.0, low=0.0
                ),
                Input("Along", "Al", "Text", f"{' or '.join(ALONG)}. Defaults to {ALONG[0]}.", default=ALONG[0]),
                Input("Material", "Ma", "Text", f"{', '.join(MATERIALS)}. Defaults to glass.", default="glass"),
                Input("Thickness", "Th", "Number", "Thickness of the panels in mm. Defaults to 6.", default=6.0, low=0.0),
            ),
            (
                Output("Panels", "P", "Mesh", "Panels in place."),
                Output("OnMoulds", "O", "Mesh", "The panels as they lie on their moulds, whose poles are at the origin."),
                Output("Moulds", "Mo", "Mesh", "The moulds, one for every K."),
                Output("Mould", "I", "Integer", "Number of the mould of every panel, from 0."),
                Output("Names", "Na", "Text", "Names of the panels, region and number."),
                Output("Misses", "Mi", "Number", "By how much each panel misses its place if it is not bent, in mm."),
                info,
            ),
        ),
        Endpoint(
            "cgc/unroll",
            "CGC Unroll",
            "Lay a solved surface out as flat pieces within sheets.",
            icon("M4 19L9 5H20L15 19ZM9 19L14 5", BLUE),
            (
                *surface,
                Input("Length", "L", "Number", "Length of the sheets. Defaults to 0, no end of it.", default=0.0, low=0.0),
                Input("Width", "W", "Number", "Width of the sheets. Defaults to 0, as the length.", default=0.0, low=0.0),
                Input(
                    "Strain", "E", "Number", "Largest strain of flattened pieces, such as 0.002. Defaults to 0, any.", default=0.0, low=0.0
                ),
                Input(
                    "Spacing",
                    "D",
                    "Number",
                    "Distance between pieces on a sheet. Defaults to 0, which is a hundredth of its width.",
                    default=0.0,
                    low=0.0,
                ),
                Input("Margin", "Ma", "Number", "What is left free along the edges of a sheet. Defaults to 0.", default=0.0, low=0.0),
                Input(
                    "Allowance",
                    "Al",
                    "Number",
                    "Width of a strip around every piece, for seams to be welded or sewn. Defaults to 0.",
                    default=0.0,
                    low=0.0,
                ),
                Input(
                    "Whole",
                    "Wh",
                    "Boolean",
                    "True to keep panels between creases whole: those larger than a sheet are refused. Defaults to false, they are cut.",
                    default=False,
                ),
            ),
            (
                Output("Outlines", "O", "Curve", "Closed outlines to be cut, holes after them."),
                Output("Folds", "F", "Curve", "Edges where facets fold by more than a degree."),
                Output("Rulings", "R", "Curve", "Rulings, where the surface is ruled."),
                Output("Marks", "M", "Curve", "Ticks at the same nodes on both sides of a seam."),
                Output("Sheets", "S", "Curve", "Edges of the sheets."),
                Output("Labels", "L", "Text", "Names of the pieces."),
                Output("Places", "Pl", "Point", "Places of the names."),
                Output("Pieces", "P", "Mesh", "The pieces in place, in the order of the names."),
                Output("Strains", "E", "Number", "Largest strain of every piece."),
                Output("Allowances", "Al", "Curve", "Closed outlines with the allowance around them, holes after them."),
                Output("Sheet", "Si", "Integer", "Number of the sheet of every piece, from 0."),
                Output("CutList", "C", "Text", "Rows of the cut list: sheet, piece, region, area, size, folds, neighbours, course, mould."),
                info,
            ),
        ),
        Endpoint(
            "cgc/membrane",
            "CGC Membrane",
            "Find the membrane forces of a solved surface under a pressure and self weight.",
            icon("M4 16C8 6 16 6 20 16M12 3V8M12 20V16M3 12H7M21 12H17", BLUE),
            (
                drawn["Mesh"],
                drawn["Supports"],
                *surface[1:],
                Input(
                    "Pressure",
                    "Pr",
                    "Number",
                    "Load along the normals for each area, outwards where positive. Defaults to 1.",
                    default=1.0,
                    low=-1e9,
                    high=1e9,
                ),
                Input(
                    "Weight",
                    "W",
                    "Number",
                    "Load downwards for each area of the surface. Defaults to 0.",
                    default=0.0,
                    low=-1e9,
                    high=1e9,
                ),
                Input("EdgeBeams", "B", "Boolean", "Whether free edges have beams. Defaults to true.", default=True),
            ),
            (
                Output("Mesh", "M", "Mesh", "Surface, coloured by N1: blue presses, red pulls."),
                Output("N1", "N1", "Number", "Larger principal force of every vertex, tension positive."),
                Output("N2", "N2", "Number", "Smaller principal force of every vertex."),
                Output("Tension", "T", "Curve", "Crosses along the principal directions, of forces that pull."),
                Output("Compression", "C", "Curve", "Crosses of forces that press."),
                Output("Reactions", "R", "Curve", "Forces on the surface along the lines around regions, from their vertex on."),
                Output("LineLoads", "L", "Number", "Sizes of the line loads on the edges around regions."),
                info,
            ),
        ),
        Endpoint(
            "cgc/net",
            "CGC Net",
            "Trace the curves that a solved surface is built along: lines of curvature, an asymptotic net or rulings.",
            icon("M4 20C8 14 8 10 6 4M12 20C16 14 16 10 14 4M4 8C10 12 15 12 21 9M3 15C10 19 16 19 21 16", BLUE),
            (
                *surface,
                spacing,
                Input(
                    "Through",
                    "T",
                    "Point",
                    "Points to trace curves through. Nothing: a net at the spacing.",
                    many=True,
                    most=1000,
                    optional=True,
                ),
            ),
            (
                Output("First", "A", "Curve", "Curves of one family."),
                Output("Second", "B", "Curve", "Curves of the other family; rulings have none."),
                Output("Nodes", "N", "Point", "Where curves of the two families cross."),
                Output("Sides", "S", "Number", "Lengths between nodes along the curves."),
                info,
            ),
        ),
    )
