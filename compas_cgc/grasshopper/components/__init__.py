"""Functions of the Grasshopper components.

Each function takes ``ghenv.Component`` and the inputs, and returns the outputs as a NamedTuple.
User errors become balloons on the component instead of exceptions.
"""

from __future__ import annotations

from ..runtime.loaded_packages import conflicts

try:
    from ...datastructures import CGCMesh  # noqa: F401
except ImportError as error:
    # A package refuses a version that another plug-in has loaded; the sentence is the balloon of every component.
    raise ImportError(next(iter(conflicts()), str(error))) from error
