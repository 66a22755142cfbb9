"""Address of a server."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Optional

__all__ = ["Address"]


@dataclass(frozen=True)
class Address:
    """The address of a server, and its key where it has one."""

    url: str
    key: Optional[str] = None

    def __str__(self) -> str:
        return self.url
