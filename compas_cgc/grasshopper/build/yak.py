"""Yak package: a zip file for Rhino's package manager."""

from __future__ import annotations

import io
import zipfile
from collections.abc import Mapping

from ..._version import __version__

__all__ = ["TAG", "manifest", "yak_bytes", "yak_name"]

NAME = "compas_cgc"
TAG = "rh8-any"  # Rhino 8 on all systems
# Constant date (the earliest in a zip file), for reproducible files.
DATE = (1980, 1, 1, 0, 0, 0)


def yak_name() -> str:
    """Return the file name of the package."""
    return f"{NAME}-{__version__}-{TAG}.yak"


def manifest() -> str:
    """Return the text of ``manifest.yml``."""
    return "\n".join(
        [
            "---",
            f"name: {NAME}",
            f"version: {__version__}",
            "authors:",
            "- The compas_cgc developers",
            "description: Surfaces of piecewise constant Gaussian curvature on the Grasshopper canvas",
            "url: https://doi.org/10.1016/j.cad.2021.102992",
            "keywords:",
            "- compas",
            "- Gaussian curvature",
            "- geometry",
            "- shell",
            "icon: icon.png",
            "",
        ]
    )


def yak_bytes(files: Mapping[str, bytes]) -> bytes:
    """Return the package of files by name, with the manifest first, deterministically."""
    entries = {"manifest.yml": manifest().encode("utf-8"), **dict(sorted(files.items()))}
    out = io.BytesIO()
    with zipfile.ZipFile(out, "w", zipfile.ZIP_DEFLATED) as package:
        for name, data in entries.items():
            info = zipfile.ZipInfo(name, DATE)
            info.compress_type = zipfile.ZIP_DEFLATED
            info.create_system = 0
            info.external_attr = 0
            package.writestr(info, data, compresslevel=6)
    return out.getvalue()
