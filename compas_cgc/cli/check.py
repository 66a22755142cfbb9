"""``compas-cgc check``: what a file holds, what a solve would do with it, and what stands in the way."""

from __future__ import annotations

import argparse
from pathlib import Path

from .exits import DONE
from .exits import REFUSED
from .inputs import add_reading
from .inputs import reading


def add_parser(subparsers: argparse._SubParsersAction) -> None:
    """Add the command and its arguments."""
    parser = subparsers.add_parser(
        "check",
        help="say what a file holds and what keeps it from being solved",
        description="Read a file as solve does, and say what was found, what would be done and what stands in the way.",
    )
    parser.add_argument("input", metavar="FILE", help="a .3dm, .obj, .ply, .off, .stl or COMPAS .json file")
    add_reading(parser)
    parser.set_defaults(run=run)


def run(arguments: argparse.Namespace) -> int:
    """Run the command."""
    options = reading(arguments)
    if Path(arguments.input).suffix.lower() == ".3dm":
        from ..io.rhino import describe
        from ..io.rhino import read_model

        text, problems = describe(read_model(arguments.input, **options))
    else:
        from ..io import read_mesh

        mesh, notes = read_mesh(arguments.input, **options)
        roles = mesh.vertices_role()
        found = f"{len(roles)} vertices, {mesh.number_of_faces()} faces, {roles.count('fixed')} supports, {len(mesh.creases())} creases"
        text = "\n".join([f"{Path(arguments.input).name}: {found}, {len(mesh.regions())} regions", *(f"- {note}" for note in notes)])
        problems = mesh.check()
    print(text)
    if not problems:
        print("nothing stands in the way of a solve")
        return DONE
    print(f"{len(problems)} problem{'s' if len(problems) > 1 else ''}:")
    for problem in problems:
        print(f"- {problem}")
    return REFUSED if any(getattr(problem, "fatal", True) for problem in problems) else DONE
