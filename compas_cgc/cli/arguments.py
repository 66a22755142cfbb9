"""Arguments that commands share: reading of files and options of the methods."""

from __future__ import annotations

import argparse
import math
from collections.abc import Sequence
from typing import TYPE_CHECKING
from typing import Any
from typing import Optional

from ..errors import CGCError
from ..io.formats import READ_SUFFIXES
from ..io.formats import listed
from ..solvers import METHODS
from ..solvers import Option
from ..solvers import Settings
from ..solvers import options
from ..solvers import settings_for
from ..solvers.registry import owners
from .console import Parts

if TYPE_CHECKING:
    from ..io.reading import ReadProblem
    from ..model.problem import CGCProblem
    from ..model.units import GivenLength

__all__ = [
    "add_input",
    "add_options",
    "add_reading",
    "add_supports",
    "given_length",
    "read_input",
    "settings_of",
    "with_laws",
    "with_targets",
]

# Copied from `meshing.boundary`, which --help must not import.
SUPPORT_NAMES = ("boundary", "outline", "corners")
_ROLES = ("mesh", "supports", "creases", "targets", "constraints", "goals")


def add_input(parser: argparse.ArgumentParser, kind: str = "a") -> None:
    """Add the argument for the input file."""
    parser.add_argument("input", metavar="FILE", help=f"{kind} {listed(READ_SUFFIXES)} file")


def add_reading(parser: argparse.ArgumentParser) -> None:
    """Add the arguments for reading files."""
    group = parser.add_argument_group("reading files")
    group.add_argument(
        "--layer",
        action="append",
        default=[],
        metavar="ROLE=NAME",
        help=f"layer to read for ROLE, one of {', '.join(_ROLES)} (default: CGC::Mesh, CGC::Supports, ...; in a .dxf all visible layers)",
    )
    group.add_argument(
        "--crease",
        choices=("trace", "split"),
        default="trace",
        help="move creases to the nearest mesh edges (default), or split the mesh along them",
    )
    group.add_argument(
        "--edge-length", type=given_length, metavar="L", help="mesh curves and surfaces with this edge length, such as 0.35 or 350mm"
    )
    group.add_argument(
        "--weld",
        type=given_length,
        metavar="D",
        help="merge points closer than this, such as 0.001 or 1mm (default: the tolerance of a .3dm, else coincident points)",
    )
    group.add_argument("--mesh", metavar="NAME", help="name of the mesh in a COMPAS .json that holds several")
    text = "separate parts of the mesh that meet only in a point, or at an edge with more than two faces"
    group.add_argument("--manifold", action="store_true", help=text)


def given_length(text: str) -> GivenLength:
    """Return a length of the command line, in model units or with its unit.

    Raises
    ------
    argparse.ArgumentTypeError
        If it is not a finite length.
    """
    # Imported here so that help texts do not wait for numerical packages.
    from ..model.units import length_of

    try:
        return length_of(text, "the length")
    except CGCError as error:
        raise argparse.ArgumentTypeError(str(error)) from None


def add_supports(parser: argparse.ArgumentParser) -> None:
    """Add the argument for supports."""
    text = "support the whole open edge, the outline without holes, or the corners, instead of the points in the file"
    parser.add_argument("--supports", type=_supports, choices=SUPPORT_NAMES, help=text)


def _supports(text: str) -> str:
    """Return the name of supports.

    Raises
    ------
    argparse.ArgumentTypeError
        If the name is unknown, for example a list of vertices.
    """
    if text in SUPPORT_NAMES:
        return text
    points = "draw points on the layer CGC::Supports, or call mesh.set_supports([...]) in a script"
    raise argparse.ArgumentTypeError(
        f"must be {', '.join(SUPPORT_NAMES[:-1])} or {SUPPORT_NAMES[-1]}, not {text!r}; to support single places, {points}"
    )


def read_input(arguments: argparse.Namespace, *, result: bool = False) -> ReadProblem:
    """Read the input file, or the result stored in it; show progress on a terminal."""
    with Parts(1, quiet=getattr(arguments, "quiet", False)).part(f"reading {arguments.input}"):
        from ..io import read_problem

        return read_problem(arguments.input, **_reading(arguments), result=result)


def _reading(arguments: argparse.Namespace) -> dict[str, Any]:
    """Return the arguments for :func:`compas_cgc.io.read_problem`.

    Raises
    ------
    CGCError
        If ``--layer`` is invalid.
    """
    layers: dict[str, list[str]] = {}
    for text in arguments.layer:
        role, equals, name = text.partition("=")
        if not equals or role not in _ROLES or not name:
            raise CGCError(f"--layer must be ROLE=NAME with ROLE one of {', '.join(_ROLES)}, not {text!r}")
        layers.setdefault(role, []).append(name)
    return {
        "layers": layers or None,
        "crease": arguments.crease,
        "tolerance": arguments.weld,
        "edge_length": arguments.edge_length,
        "mesh": arguments.mesh,
        "manifold": arguments.manifold,
    }


def with_targets(problem: CGCProblem, texts: Sequence[str]) -> CGCProblem:
    """Return the problem with the targets of ``--target [REGION=]K``.

    Raises
    ------
    CGCError
        If a target is invalid.
    """
    # Targets of regions override the general one.
    for text in sorted(texts, key=lambda text: "=" in text):
        region, equals, number = text.rpartition("=")
        try:
            K = float(number)
            where = int(region) if equals else None
            if not math.isfinite(K):
                raise ValueError
        except ValueError:
            raise CGCError(f"--target must be a number or REGION=NUMBER, such as 0.03 or 4=0.03, not {text!r}") from None
        problem = problem.with_targets(K, region=where)
    return problem


def with_laws(problem: CGCProblem, texts: Sequence[str]) -> CGCProblem:
    """Return the problem with the laws of ``--law [REGION=]LAW``.

    Raises
    ------
    CGCError
        If a law is invalid.
    """
    from ..model.laws import laws_by_region

    try:
        return problem.with_laws(laws_by_region(texts, problem.number_of_regions())) if texts else problem
    except ValueError as error:
        raise CGCError(f"--law: {error}") from None


def add_options(parser: argparse.ArgumentParser) -> None:
    """Add ``--method`` and the options of all registered methods.

    If a flag is already used, the name of the method is put in front of it.
    """
    lines = "; ".join(f"{method.name}: {method.text.rstrip('.')}" for method in METHODS.values())
    group = parser.add_argument_group("how to solve", "An option of a single method also selects that method, unless --method is given.")
    group.add_argument("--method", default="auto", metavar="METHOD", help=_plain(f"auto (default): select one of the others; {lines}"))
    for name, own in options().items():
        kind: dict[str, Any] = (
            {"action": argparse.BooleanOptionalAction} if own.kind is bool else {"type": own.kind, "metavar": _metavar(own)}
        )
        taken = _flag(name) in parser._option_string_actions
        flag = f"--{owners(name)[0]}-{name.replace('_', '-')}" if taken else _flag(name)
        group.add_argument(flag, dest=f"option_{name}", default=None, help=_plain(_help(own)), **kind)


def settings_of(arguments: argparse.Namespace) -> Optional[Settings]:
    """Return the settings of the given options, or None if no option is given.

    Raises
    ------
    ValueError
        If the options contradict each other or are out of range.
    """
    return settings_for(arguments.method, {name: getattr(arguments, f"option_{name}") for name in options()})


def _flag(name: str) -> str:
    return "--" + name.replace("_", "-")


def _metavar(own: Option) -> str:
    return "|".join(own.choices) if own.choices else "N" if own.kind is int else "X"


def _help(own: Option) -> str:
    able = owners(own.name)
    by = "" if len(able) == len(METHODS) else f" ({', '.join(able)}"
    default = "" if own.default is None else f"default {'yes' if own.default is True else own.default}"
    end = (f"{by}; {default})" if default else f"{by})") if by else f" ({default})" if default else ""
    return own.summary.rstrip(".") + end


def _plain(text: str) -> str:
    """Escape percent signs for argparse."""
    return text.replace("%", "%%")
