"""The job engine: a store, worker processes and what runs in them."""

from __future__ import annotations
