"""``compas-cgc grasshopper``: build and install the components for Rhino 8."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import Optional

from .exits import DONE

__all__ = ["add_arguments", "build", "install", "uninstall"]

_EPILOG = """\
examples:
  compas-cgc grasshopper install
  compas-cgc grasshopper build -o grasshopper
  compas-cgc grasshopper build -o grasshopper --package https://packages.example.com/wheels
"""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of the command."""
    parser.description = "Build the Grasshopper components, example definitions and package for Rhino 8, or install the components."
    parser.epilog = _EPILOG
    actions = parser.add_subparsers(dest="action", metavar="ACTION", required=True)
    building = actions.add_parser("build", help="build components, definitions and package")
    building.add_argument("-o", "--output", required=True, metavar="DIR", help="folder to write to")
    installing = actions.add_parser("install", help="copy the components to the folder of Grasshopper")
    removing = actions.add_parser("uninstall", help="remove the installed components")
    for action in (installing, removing):
        action.add_argument("--to", metavar="DIR", help="folder to use instead of Grasshopper's")
        action.add_argument("--dry-run", action="store_true", help="print the changes without making them")
    for action in (building, installing):
        action.add_argument(
            "--package",
            metavar="INDEX|URL|WHEEL",
            help="wheel, or folder of wheels, for Rhino to install (default: the index of its pip)",
        )
        action.add_argument("--source", metavar="DIR", help="folder of other components (default: those of this package)")
    building.set_defaults(run=build)
    installing.set_defaults(run=install)
    removing.set_defaults(run=uninstall)


def build(arguments: argparse.Namespace) -> int:
    """Run ``compas-cgc grasshopper build``."""
    from ..grasshopper.build.build_all import build_all

    for path in build_all(Path(arguments.output), _path(arguments.source), arguments.package):
        print(path)
    return DONE


def install(arguments: argparse.Namespace) -> int:
    """Run ``compas-cgc grasshopper install``."""
    from ..grasshopper.build.build_all import user_object_files
    from ..grasshopper.build.install import install as put
    from ..grasshopper.build.install import user_objects_folder
    from .warm import warm

    files = user_object_files(_path(arguments.source), arguments.package)
    written, removed = put(files, _path(arguments.to) or user_objects_folder(), arguments.dry_run)
    _say("would write" if arguments.dry_run else "wrote", written)
    _say("would remove" if arguments.dry_run else "removed", removed)
    if not arguments.dry_run:
        warm()
        print("restart Rhino 8; the components are on the Grasshopper tab COMPAS CGC")
    return DONE


def uninstall(arguments: argparse.Namespace) -> int:
    """Run ``compas-cgc grasshopper uninstall``."""
    from ..grasshopper.build.install import uninstall as take
    from ..grasshopper.build.install import user_objects_folder

    removed = take(_path(arguments.to) or user_objects_folder(), arguments.dry_run)
    _say("would remove" if arguments.dry_run else "removed", removed)
    if not removed:
        print("there is nothing to remove")
    return DONE


def _path(text: Optional[str]) -> Optional[Path]:
    return Path(text) if text else None


def _say(what: str, paths: list[Path]) -> None:
    for path in paths:
        print(f"{what} {path}")
