"""Endpoints of the tasks on solved surfaces."""

from __future__ import annotations

from ...fabrication import MATERIALS
from ...fabrication.option_values import ALONG
from ...fabrication.option_values import NET_KINDS
from .schema import Endpoint
from .schema import Input
from .schema import Output
from .schema import icon

__all__ = ["BUILDS", "build_endpoints"]

BLUE = "#2b7bba"
BUILDS = "cgc/mould", "cgc/unroll", "cgc/membrane", "cgc/net", "cgc/quads"


def build_endpoints(drawn: dict[str, Input], info: Output) -> tuple[Endpoint, ...]:
    """Return the endpoints of the tasks on solved surfaces.

    Parameters
    ----------
    drawn
        Inputs of a solve for the drawing and its laws, by name.
    info
        The output of the report.
    """
    surface = (drawn["Mesh"], drawn["Creases"], drawn["K"], drawn["At"])
    spacing = Input("Spacing", "S", "Number", "Distance between curves. Defaults to 0: a twelfth of a region.", default=0.0, low=0.0)
    return (
        Endpoint(
            "cgc/mould",
            "CGC Mould",
            "Divide a solved surface into panels and place them on moulds.",
            icon("M3 20C3 11 21 11 21 20ZM7 8C10 4 14 4 17 8", BLUE),
            (
                *surface,
                Input("Count", "N", "Integer", "Approximate number of panels per region. Defaults to 4.", default=4, low=1, high=100_000),
                Input("Size", "W", "Number", "Width of the panels, instead of Count. Defaults to 0: use Count.", default=0.0, low=0.0),
                Input("Along", "Al", "Text", f"{' or '.join(ALONG)}. Defaults to {ALONG[0]}.", default=ALONG[0]),
                Input("Material", "Ma", "Text", f"{', '.join(MATERIALS)}. Defaults to glass.", default="glass"),
                Input("Thickness", "Th", "Number", "Thickness of the panels in mm. Defaults to 6.", default=6.0, low=0.0),
                Input(
                    "Tolerance",
                    "To",
                    "Number",
                    "Largest gap in mm for which panels with different K share a mould. Defaults to 0: one mould for each K.",
                    default=0.0,
                    low=0.0,
                ),
                Input(
                    "LeastBending",
                    "Lb",
                    "Boolean",
                    "True chooses moulds among spindles, bulges and hyperboloids too, so that panels bend least. Defaults to False.",
                    default=False,
                ),
            ),
            (
                Output("Panels", "P", "Mesh", "Panels in their final position."),
                Output("OnMoulds", "O", "Mesh", "Panels on their moulds. The poles of the moulds are at the origin."),
                Output("Moulds", "Mo", "Mesh", "Moulds, one per K."),
                Output("Mould", "I", "Integer", "Number of the mould of each panel, counted from 0."),
                Output("Names", "Na", "Text", "Names of the panels: region and number."),
                Output("Misses", "Mi", "Number", "Distance of each panel from its final position if it is placed without bending, in mm."),
                info,
            ),
        ),
        Endpoint(
            "cgc/unroll",
            "CGC Unroll",
            "Unroll a solved surface into flat pieces on sheets.",
            icon("M4 19L9 5H20L15 19ZM9 19L14 5", BLUE),
            (
                *surface,
                Input("Length", "L", "Number", "Length of the sheets. Defaults to 0: unlimited.", default=0.0, low=0.0),
                Input("Width", "W", "Number", "Width of the sheets. Defaults to 0: equal to the length.", default=0.0, low=0.0),
                Input(
                    "Strain",
                    "E",
                    "Number",
                    "Largest strain of flattened pieces, such as 0.002. Defaults to 0: unlimited.",
                    default=0.0,
                    low=0.0,
                ),
                Input(
                    "Spacing",
                    "D",
                    "Number",
                    "Distance between pieces on a sheet. Defaults to 0: a hundredth of its width.",
                    default=0.0,
                    low=0.0,
                ),
                Input(
                    "Margin",
                    "Ma",
                    "Number",
                    "Width of the strip left empty along the edges of a sheet. Defaults to 0.",
                    default=0.0,
                    low=0.0,
                ),
                Input(
                    "Allowance",
                    "Al",
                    "Number",
                    "Width of the strip around each piece for welded or sewn seams. Defaults to 0.",
                    default=0.0,
                    low=0.0,
                ),
                Input(
                    "Whole",
                    "Wh",
                    "Boolean",
                    "True refuses parts between creases that are larger than a sheet. False, the default, divides them.",
                    default=False,
                ),
                Input(
                    "Kerf",
                    "Ke",
                    "Number",
                    "Width that the tool removes; Allowances are the contours in the middle of it. Defaults to 0.",
                    default=0.0,
                    low=0.0,
                ),
                Input("Material", "Mt", "Text", "Material of the sheets, written in the cut list. Defaults to none.", default=""),
                Input(
                    "Thickness",
                    "Th",
                    "Number",
                    "Thickness of the sheets in mm, written in the cut list. Defaults to 0: none.",
                    default=0.0,
                    low=0.0,
                ),
            ),
            (
                Output("Outlines", "O", "Curve", "Closed outlines to cut, each followed by its holes."),
                Output("Folds", "F", "Curve", "Edges where the fold angle exceeds one degree."),
                Output("Rulings", "R", "Curve", "Rulings of ruled surfaces."),
                Output("Marks", "M", "Curve", "Matching marks at the nodes on both sides of a seam."),
                Output("Sheets", "S", "Curve", "Edges of the sheets."),
                Output("Labels", "L", "Text", "Names of the pieces."),
                Output("Places", "Pl", "Point", "Positions of the names."),
                Output("Pieces", "P", "Mesh", "Pieces in their final position, in the order of the names."),
                Output("Strains", "E", "Number", "Largest strain of each piece."),
                Output("Allowances", "Al", "Curve", "Closed contours to cut with an allowance or a kerf, each followed by its holes."),
                Output("Sheet", "Si", "Integer", "Number of the sheet of each piece, counted from 0."),
                Output("CutList", "C", "Text", "Rows of the cut list, with a heading; the last column explains the others."),
                info,
            ),
        ),
        Endpoint(
            "cgc/membrane",
            "CGC Membrane",
            "Compute the membrane forces of a solved surface under pressure and self-weight.",
            icon("M4 16C8 6 16 6 20 16M12 3V8M12 20V16M3 12H7M21 12H17", BLUE),
            (
                drawn["Mesh"],
                drawn["Supports"],
                *surface[1:],
                Input(
                    "Pressure",
                    "Pr",
                    "Number",
                    "Load along the normals per unit area, positive outwards. Defaults to 1.",
                    default=1.0,
                    low=-1e9,
                    high=1e9,
                ),
                Input(
                    "Weight",
                    "W",
                    "Number",
                    "Downward load per unit area of the surface. Defaults to 0.",
                    default=0.0,
                    low=-1e9,
                    high=1e9,
                ),
                Input("EdgeBeams", "B", "Boolean", "Whether free edges have beams. Defaults to true.", default=True),
            ),
            (
                Output("Mesh", "M", "Mesh", "Surface, coloured by N1: blue compression, red tension."),
                Output("N1", "N1", "Number", "Larger principal force at each vertex, tension positive."),
                Output("N2", "N2", "Number", "Smaller principal force at each vertex."),
                Output("Tension", "T", "Curve", "Crosses along the principal directions in tension."),
                Output("Compression", "C", "Curve", "Crosses along the principal directions in compression."),
                Output("Reactions", "R", "Curve", "Forces on the surface along the edges of regions, starting at their vertices."),
                Output("LineLoads", "L", "Number", "Magnitudes of the line loads on the edges of regions."),
                info,
            ),
        ),
        Endpoint(
            "cgc/net",
            "CGC Net",
            "Trace construction curves on a solved surface: lines of curvature, an asymptotic net or rulings.",
            icon("M4 20C8 14 8 10 6 4M12 20C16 14 16 10 14 4M4 8C10 12 15 12 21 9M3 15C10 19 16 19 21 16", BLUE),
            (
                *surface,
                spacing,
                Input(
                    "Through",
                    "T",
                    "Point",
                    "Points to trace curves through. If empty, a net at the spacing.",
                    many=True,
                    most=1000,
                    optional=True,
                ),
                drawn["Law"],
                Input("Kind", "Ki", "Text", f"{' or '.join(NET_KINDS)}. Empty: by K and laws.", default=""),
            ),
            (
                Output("First", "A", "Curve", "Curves of one family."),
                Output("Second", "B", "Curve", "Curves of the other family; empty for rulings."),
                Output("Nodes", "N", "Point", "Intersections of the two families."),
                Output("Sides", "S", "Number", "Lengths between nodes along the curves."),
                info,
            ),
        ),
        Endpoint(
            "cgc/quads",
            "CGC Quads",
            "Cover a solved surface with K > 0 or constant H by plane quads along lines of curvature, with beams along their sides.",
            icon("M3 8L11 4L21 7L14 12ZM3 8L5 18L14 21L14 12M14 21L21 16L21 7", BLUE),
            (
                *surface,
                Input("Spacing", "S", "Number", "Distance between lines. Defaults to 0: a twelfth of a region.", default=0.0, low=0.0),
                Input("Depth", "D", "Number", "Depth of the beams. Defaults to 0: a tenth of the spacing.", default=0.0, low=0.0),
                drawn["Law"],
            ),
            (
                Output("Faces", "F", "Curve", "Outlines of the plane faces, counterclockwise seen from outside."),
                Output("Beams", "B", "Curve", "Lines of the beams between nodes."),
                Output("Nodes", "N", "Point", "Corners of the faces; their numbers are those of the tables."),
                Output("Axes", "A", "Curve", "Axes of the nodes over the depth of the beams."),
                Output("Irregular", "I", "Point", "Inner nodes with other than four beams."),
                Output("Planarity", "P", "Number", "Largest distance between the diagonals of every face."),
                Output("Twist", "T", "Number", "Distance between the diagonals of every beam."),
                info,
            ),
        ),
    )
