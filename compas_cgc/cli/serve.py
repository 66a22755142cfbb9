"""``compas-cgc serve``: run the compute server for browsers, Grasshopper (Hops) and scripts."""

from __future__ import annotations

import argparse
import os

from ..errors import CGCError
from .exits import DONE
from .parser import count

__all__ = ["add_arguments", "run"]

_EPILOG = """\
Set the key with the environment variable COMPAS_CGC_KEY: other users of the machine can see command-line arguments.
In Grasshopper, set the path of a Hops component to http://127.0.0.1:7331/cgc/dome (or /cgc/solve, /cgc/flow, /cgc/analyse).
"""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of the command."""
    parser.description = "Run the compute server for browsers, Grasshopper (Hops) and scripts until Ctrl-C."
    parser.epilog = _EPILOG
    parser.add_argument("--host", help="address to listen on (default 127.0.0.1: this machine only); any other address requires a key")
    parser.add_argument("--port", type=_port, help="port (default 7331); 0 selects a free port")
    parser.add_argument(
        "--key",
        action="append",
        help="key that clients must send (default: COMPAS_CGC_KEY, or none); repeatable, with separate limits for each key",
    )
    parser.add_argument(
        "--keys", metavar="FILE", help=".toml file with the keys of several owners, each with a name and a role; see the manual"
    )
    parser.add_argument("--workers", type=count, help="number of simultaneous solves (default: number of processors minus one)")
    parser.add_argument("--executor", metavar="ADDRESS", help="solve on other machines, such as dask://scheduler:8786")
    parser.add_argument(
        "--store", metavar="FILE", help="file that stores the jobs (default: a file in the user's data folder, one per port)"
    )
    parser.add_argument("--name", action="append", help="host name that clients use for this server; repeatable")
    parser.add_argument(
        "--trusted-proxy",
        metavar="ADDRESS",
        help="address of the proxy in front of the server; its X-Forwarded-For header identifies the clients",
    )
    parser.add_argument("--prefix", metavar="PATH", help="path under which the proxy publishes the server, such as /cgc")
    parser.add_argument("--log", choices=("text", "json"), help="log requests and jobs to standard error (default: warnings only)")
    parser.add_argument("--config", metavar="FILE", help=".toml file with these options and limits; see the manual")
    parser.set_defaults(run=run)


def run(arguments: argparse.Namespace) -> int:
    """Run the command."""
    from .._warm_up import is_warm
    from .warm import warm

    try:
        from ..server.keys import read_keys
        from ..server.operation.configuration import read_configuration
        from ..server.run import serve
    except ImportError as error:
        raise CGCError(f"the server requires {error.name}; install it with pip install 'compas_cgc[server]'") from None

    if arguments.keys is not None and arguments.key:
        raise CGCError("--keys and --key exclude each other; put the key into the file")
    if arguments.executor is not None and arguments.workers is not None:
        raise CGCError("--workers applies to this machine only; omit it if --executor is given")
    # Arguments take precedence over the file.
    options = {} if arguments.config is None else read_configuration(arguments.config)
    for name in ("host", "port", "keys", "workers", "executor", "store", "trusted_proxy", "prefix", "log"):
        if getattr(arguments, name) is not None:
            options[name] = getattr(arguments, name)
    keys = options.pop("keys", None)
    key = arguments.key or (read_keys(keys) if keys is not None else os.environ.get("COMPAS_CGC_KEY", "").split())
    names = tuple(name.lower() for name in arguments.name or options.pop("names", ()))
    options.pop("names", None)
    if not is_warm():
        # Compile once here, with a progress bar, instead of in every worker.
        warm()
    serve(**options, key=key, names=names)
    return DONE


def _port(text: str) -> int:
    if not text.isdecimal() or int(text) > 65535:
        raise argparse.ArgumentTypeError(f"must be a whole number from 0 to 65535, not {text!r}")
    return int(text)
