"""The functions behind the Grasshopper components.

Each takes ``ghenv.Component`` and the inputs, and gives the outputs as a NamedTuple.
User errors become balloons on the component, never exceptions.
"""

from __future__ import annotations
