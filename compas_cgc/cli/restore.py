"""``compas-cgc restore``: put a backup in the place of the jobs of a server."""

from __future__ import annotations

import argparse

from .backup import add_store_arguments
from .backup import store_of
from .exits import DONE

__all__ = ["add_arguments", "run"]


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of the command."""
    parser.description = "Put a backup in the place of the jobs of a stopped server. The present jobs are renamed, not deleted."
    parser.add_argument("folder", help="folder that compas-cgc backup has written")
    add_store_arguments(parser)
    parser.set_defaults(run=run)


def run(arguments: argparse.Namespace) -> int:
    """Run the command."""
    store = store_of(arguments)
    from ..server.jobs.backup import restore_store

    aside = restore_store(arguments.folder, store)
    print(f"restored {arguments.folder} to {store}")
    if aside:
        print(f"the jobs before are in {aside[0]}")
    return DONE
