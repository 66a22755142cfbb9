"""Functions of the Grasshopper components.

Each function takes ``ghenv.Component`` and the inputs, and returns the outputs as a NamedTuple.
User errors become balloons on the component instead of exceptions.
"""

from __future__ import annotations
