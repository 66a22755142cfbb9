"""Executors by address."""

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
        Address with kind, host and port.
    reserved
        Number of slots reserved for urgent tasks.

    Raises
    ------
    CGCError
        If the address is invalid, or a required package is not installed.
    """
    kind, _, place = address.partition("://")
    host, colon, port = place.rpartition(":")
    if kind != "dask" or not (host and colon and port.isdecimal()):
        raise CGCError(f"the address of an executor must be that of a Dask scheduler, dask://HOST:PORT, not {address!r}")
    from .dask_executor import DaskExecutor

    return DaskExecutor(f"tcp://{place}", reserved=reserved)
