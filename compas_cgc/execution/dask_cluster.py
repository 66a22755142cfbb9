"""Eye on a Dask cluster: a thread that keeps the connection to its scheduler and tells who works for it."""

from __future__ import annotations

import logging
import threading
from typing import Any
from typing import Callable
from typing import NamedTuple

from ..errors import CGCError
from .dask_task import about

__all__ = ["PATIENCE", "ClusterWatch", "Message", "let_go"]

WATCH_INTERVAL = 0.5  # seconds between two looks at the cluster
PATIENCE = 3.0  # seconds that a scheduler may take to be found
BUSY = 30.0  # seconds that one may take to answer that is connected: when it ends that is seen at once

log = logging.getLogger(__name__)


class Message(NamedTuple):
    """What other threads tell the one that keeps the tasks."""

    kind: str  # task, event, done, lost, workers, cut, close
    content: Any = None


class ClusterWatch(threading.Thread):
    """The thread that looks at a cluster until it is told to close.

    Parameters
    ----------
    address
        Of the scheduler.
    topic
        Under which tasks report.
    tell
        Called with `event`s of tasks, with the `workers` at every look, when the connection is `cut`, and before the `close`.
    closing
        Set at the end.

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
            raise CGCError('a Dask cluster needs distributed: pip install "compas_cgc[dask]"') from None
        self._distributed = distributed
        self._address, self._topic, self._tell, self._closing = address, topic, tell, closing

    def run(self) -> None:
        """Keep a connection to the scheduler, and tell who works for it."""
        client: Any = None
        known: dict[str, str] = {}  # version by worker
        scheduler = ""
        while not self._closing.wait(WATCH_INTERVAL if client is not None or known else 0.0):
            try:
                if client is None:
                    client = self._connected()
                    known, scheduler = {}, _scheduler_of(client)
                # Dask connects anew by itself, to another scheduler too, which knows nothing of what was under way.
                if client.status != "running" or _scheduler_of(client) != scheduler:
                    raise OSError("the connection is broken")
                threads = client.sync(client.scheduler.ncores, callback_timeout=BUSY)
                known = {address: known[address] if address in known else _version_on(client, address) for address in threads}
                self._tell(Message("workers", (client, dict(threads), known)))
            except Exception as error:
                if client is not None:
                    log.error("the Dask scheduler %s is lost (%s); looking for it", self._address, error)
                    self._tell(Message("cut"))
                    let_go(client)
                client, known = None, {}
                self._closing.wait(WATCH_INTERVAL)
        if client is not None:
            self._tell(Message("close"))

    def _connected(self) -> Any:
        client = self._distributed.Client(self._address, timeout=PATIENCE, set_as_default=False, name="compas_cgc")
        client.subscribe_topic(self._topic, lambda event: self._tell(Message("event", event[1])))
        return client


def let_go(client: Any) -> None:
    """Close a connection to a cluster, which goes on."""
    try:
        client.close(timeout=1.0)
    except Exception as error:
        log.debug("the connection could not be closed: %s", error)


def _scheduler_of(client: Any) -> str:
    return str(client.sync(client.scheduler.identity, callback_timeout=BUSY)["id"])


def _version_on(client: Any, address: str) -> str:
    """Return the version on a worker, or what is wrong with it."""
    try:
        return str(client.run(about, workers=[address])[address])
    except Exception as error:
        return f"no version ({type(error).__name__}: {error})"[:200]
