"""Monitor of a Dask cluster: a thread that keeps the connection to the scheduler and reports the workers."""

from __future__ import annotations

import logging
import threading
from typing import Any
from typing import Callable
from typing import NamedTuple

from ..errors import CGCError
from .dask_task import about

__all__ = ["CONNECT_TIMEOUT", "ClusterWatch", "Message", "let_go"]

WATCH_INTERVAL = 0.5  # polling interval of the cluster [s]
CONNECT_TIMEOUT = 3.0  # of a scheduler [s]
RESPONSE_TIMEOUT = 30.0  # of a connected scheduler [s]; its end is noticed immediately

log = logging.getLogger(__name__)


class Message(NamedTuple):
    """Message of other threads to the thread that manages the tasks."""

    kind: str  # task, event, done, lost, workers, cut, close
    content: Any = None


class ClusterWatch(threading.Thread):
    """Thread that monitors a cluster until `closing` is set.

    Parameters
    ----------
    address
        Address of the scheduler.
    topic
        Dask topic of the reports of tasks.
    tell
        Called with every `event` of a task, with the `workers` at every poll, when the connection is `cut`, and before the `close`.
    closing
        Event that ends the thread.

    Raises
    ------
    CGCError
        If distributed is not installed.
    """

    def __init__(self, address: str, topic: str, tell: Callable[[Message], object], closing: threading.Event):
        super().__init__(daemon=True)
        try:
            import distributed
        except ImportError:
            raise CGCError('a Dask cluster requires distributed: pip install "compas_cgc[dask]"') from None
        self._distributed = distributed
        self._address, self._topic, self._tell, self._closing = address, topic, tell, closing

    def run(self) -> None:
        """Keep a connection to the scheduler and report the workers."""
        client: Any = None
        known: dict[str, str] = {}  # version by worker
        scheduler = ""
        while not self._closing.wait(WATCH_INTERVAL if client is not None or known else 0.0):
            try:
                if client is None:
                    client = self._connected()
                    known, scheduler = {}, _scheduler_of(client)
                # Dask reconnects automatically, also to a new scheduler, which does not know the running tasks.
                if client.status != "running" or _scheduler_of(client) != scheduler:
                    raise OSError("the connection is broken")
                threads = client.sync(client.scheduler.ncores, callback_timeout=RESPONSE_TIMEOUT)
                known = {address: known[address] if address in known else _version_on(client, address) for address in threads}
                self._tell(Message("workers", (client, dict(threads), known)))
            except Exception as error:
                if client is not None:
                    log.error("the connection to the Dask scheduler %s is lost (%s); reconnecting", self._address, error)
                    self._tell(Message("cut"))
                    let_go(client)
                client, known = None, {}
                self._closing.wait(WATCH_INTERVAL)
        if client is not None:
            self._tell(Message("close"))

    def _connected(self) -> Any:
        client = self._distributed.Client(self._address, timeout=CONNECT_TIMEOUT, set_as_default=False, name="compas_cgc")
        client.subscribe_topic(self._topic, lambda event: self._tell(Message("event", event[1])))
        return client


def let_go(client: Any) -> None:
    """Close the connection to a cluster, without stopping the cluster."""
    try:
        client.close(timeout=1.0)
    except Exception as error:
        log.debug("the connection could not be closed: %s", error)


def _scheduler_of(client: Any) -> str:
    return str(client.sync(client.scheduler.identity, callback_timeout=RESPONSE_TIMEOUT)["id"])


def _version_on(client: Any, address: str) -> str:
    """Return the version of the package on a worker, or a description of the error."""
    try:
        return str(client.run(about, workers=[address])[address])
    except Exception as error:
        return f"no version ({type(error).__name__}: {error})"[:200]
