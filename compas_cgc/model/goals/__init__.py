"""Goals: what a designer asks of a surface besides K, such as its height, its volume or what stays clear under it."""

from __future__ import annotations
