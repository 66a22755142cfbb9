"""``compas-cgc serve``: solves for Grasshopper (Hops), browsers and scripts."""

from __future__ import annotations

import argparse
import os

from ..errors import CGCError
from .exits import DONE

__all__ = ["add_arguments", "run"]

_EPILOG = """\
The key is better given as the environment variable COMPAS_CGC_KEY than as an argument, which other users of the machine can see.
In Grasshopper put a Hops component and set its path to http://127.0.0.1:7331/cgc/dome (or /cgc/solve, /cgc/flow, /cgc/analyse).
"""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of the command."""
    parser.description = "Run the compute server for Grasshopper (Hops) and scripts until Ctrl-C."
    parser.epilog = _EPILOG
    parser.add_argument(
        "--host", default="127.0.0.1", help="address to listen on (default 127.0.0.1: this machine only); any other needs a key"
    )
    parser.add_argument("--port", type=_port, default=7331, help="port (default 7331), 0 for any free one")
    parser.add_argument(
        "--key",
        action="append",
        help="what clients have to send (default: COMPAS_CGC_KEY, or none); several, each with limits of its own, are given one by one",
    )
    parser.add_argument("--workers", type=_positive, help="solves at the same time (default: processors less one)")
    parser.add_argument("--executor", metavar="ADDRESS", help="solve on other machines instead, such as dask://scheduler:8786")
    parser.add_argument("--store", metavar="FILE", help="file that keeps the jobs (default: one of the user's, by the port)")
    parser.add_argument(
        "--name", action="append", default=[], help="host name that clients use for this server; may be given several times"
    )
    parser.add_argument(
        "--trusted-proxy", metavar="ADDRESS", help="address of the proxy in front of the server, whose X-Forwarded-For names the clients"
    )
    parser.set_defaults(run=run)


def run(arguments: argparse.Namespace) -> int:
    """Run the command."""
    from .._warm_up import is_warm
    from .warm import warm

    try:
        from ..server.run import serve
    except ImportError as error:
        raise CGCError(f"the server needs {error.name}; install it: pip install 'compas_cgc[server]'") from None

    key = arguments.key or os.environ.get("COMPAS_CGC_KEY", "").split()
    names = tuple(name.lower() for name in arguments.name)
    if arguments.executor is not None and arguments.workers is not None:
        raise CGCError("--workers are processes of this machine; leave it out where --executor names others")
    if not is_warm():
        # Here, with a bar, and not in every worker.
        warm()
    serve(
        arguments.host,
        arguments.port,
        key,
        arguments.workers,
        arguments.store,
        names=names,
        trusted_proxy=arguments.trusted_proxy,
        executor=arguments.executor,
    )
    return DONE


def _positive(text: str) -> int:
    if not text.isdecimal() or int(text) < 1:
        raise argparse.ArgumentTypeError(f"must be a whole number from 1 up, not {text!r}")
    return int(text)


def _port(text: str) -> int:
    if not text.isdecimal() or int(text) > 65535:
        raise argparse.ArgumentTypeError(f"must be a whole number from 0 to 65535, not {text!r}")
    return int(text)
