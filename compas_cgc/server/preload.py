"""Loads kernels and modules when it is imported, once for all workers that are forked from the process that does so."""

from __future__ import annotations

from .api.warm_up import warm_up_writer
from .hops.warm_up import warm_up

__all__: list[str] = []

warm_up()
warm_up_writer()
