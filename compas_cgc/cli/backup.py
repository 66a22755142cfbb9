"""``compas-cgc backup``: copy the jobs of a server."""

from __future__ import annotations

import argparse
from pathlib import Path

from ..errors import CGCError
from .exits import DONE

__all__ = ["add_arguments", "add_store_arguments", "run", "store_of"]


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of the command."""
    parser.description = "Copy the jobs of a server with their requests and results into a new folder. The server may be running."
    parser.add_argument("folder", help="new folder for the backup")
    add_store_arguments(parser)
    parser.set_defaults(run=run)


def add_store_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the arguments that select a store."""
    parser.add_argument("--store", metavar="FILE", help="file with the jobs (default: that of the port, as in serve)")
    parser.add_argument("--port", type=int, default=7331, help="port of the server, if it has the default store (default 7331)")
    parser.add_argument("--config", metavar="FILE", help="configuration of the server")


def store_of(arguments: argparse.Namespace) -> Path:
    """Return the store that the arguments select."""
    try:
        from ..server.operation.configuration import read_configuration
        from ..server.run import default_store
    except ImportError as error:
        raise CGCError(f"the server requires {error.name}; install it with pip install 'compas_cgc[server]'") from None

    if arguments.store is not None:
        return Path(arguments.store)
    options = {} if arguments.config is None else read_configuration(arguments.config)
    return Path(options["store"]) if "store" in options else default_store(options.get("port", arguments.port))


def run(arguments: argparse.Namespace) -> int:
    """Run the command."""
    store = store_of(arguments)
    from ..server.jobs.backup import backup_store

    count = backup_store(store, arguments.folder)
    print(f"copied {count} job{'' if count == 1 else 's'} from {store} to {arguments.folder}")
    return DONE
