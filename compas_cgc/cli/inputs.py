"""The arguments that say how a file is read, for every command that reads one."""

from __future__ import annotations

import argparse
from typing import Any

from ..errors import CGCError

__all__ = ["add_reading", "reading"]

ROLES = ("mesh", "supports", "creases", "targets", "constraints")


def add_reading(parser: argparse.ArgumentParser) -> None:
    """Add the arguments for reading ``.3dm`` files."""
    group = parser.add_argument_group("reading .3dm files")
    group.add_argument(
        "--layer",
        action="append",
        default=[],
        metavar="ROLE=NAME",
        help=f"read a layer of another name, ROLE being {', '.join(ROLES)} (default: CGC::Mesh and so on)",
    )
    group.add_argument(
        "--crease",
        choices=("trace", "split"),
        default="trace",
        help="lead creases off the mesh edges along the nearest edges (default), or split the mesh along them",
    )
    group.add_argument("--edge-length", type=float, metavar="L", help="mesh outlines without a mesh with edges of this length")
    group.add_argument("--weld", type=float, metavar="D", help="distance within which points are one (default: the file's tolerance)")


def reading(arguments: argparse.Namespace) -> dict[str, Any]:
    """Return the arguments for :func:`compas_cgc.io.read_mesh`."""
    layers: dict[str, list[str]] = {}
    for text in arguments.layer:
        role, equals, name = text.partition("=")
        if not equals or role not in ROLES or not name:
            raise CGCError(f"--layer must be ROLE=NAME with ROLE one of {', '.join(ROLES)}, not {text!r}")
        layers.setdefault(role, []).append(name)
    return {"layers": layers or None, "crease": arguments.crease, "tolerance": arguments.weld, "edge_length": arguments.edge_length}
