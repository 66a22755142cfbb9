"""Executors by their address."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ..errors import CGCError

if TYPE_CHECKING:
    from .protocol import TaskExecutor

__all__ = ["executor_at"]


def executor_at(address: str, reserved: int = 0) -> TaskExecutor:
    """Return the executor at an address such as ``dask://scheduler:8786``.

    Parameters
    ----------
    address
        Kind, host and port.
    reserved
        Number of tasks at once that are kept for those that somebody waits for.

    Raises
    ------
    CGCError
        If it is none, or what it needs is not installed.
    """
    kind, _, place = address.partition("://")
    host, colon, port = place.rpartition(":")
    if kind != "dask" or not (host and colon and port.isdecimal()):
        raise CGCError(f"an executor is given as dask://HOST:PORT, the address of a Dask scheduler, not {address!r}")
    from .dask_executor import DaskExecutor

    return DaskExecutor(f"tcp://{place}", reserved=reserved)
