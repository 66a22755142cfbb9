"""Grasshopper definitions: description as data, layout, writing and drawing."""

from __future__ import annotations

from .examples import EXAMPLES
from .nodes import Definition
from .picture import definition_svg
from .write import definition_archive

__all__ = ["EXAMPLES", "Definition", "definition_archive", "definition_svg"]
