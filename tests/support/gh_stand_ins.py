"""Components on a canvas of stand-ins for Rhino and Grasshopper."""

from __future__ import annotations

import sys
import time
import types

import pytest

# COMPAS looks for Rhino when it is loaded; it must not find the stand-ins.
import compas_cgc.datastructures  # noqa: F401
from compas_cgc.grasshopper.build.component_manifest import Bundle
from compas_cgc.grasshopper.build.component_manifest import read_bundles

from .rhino_classes import Brep  # noqa: F401
from .rhino_classes import Component
from .rhino_classes import DataTree  # noqa: F401
from .rhino_classes import Document
from .rhino_classes import Instances  # noqa: F401
from .rhino_classes import Mesh  # noqa: F401
from .rhino_classes import Plane  # noqa: F401
from .rhino_classes import Point3d  # noqa: F401
from .rhino_classes import PolylineCurve  # noqa: F401
from .rhino_classes import SmoothCurve  # noqa: F401
from .rhino_classes import SubD  # noqa: F401
from .rhino_classes import modules
from .rhino_classes import rhino_mesh  # noqa: F401
from .rhino_classes import square  # noqa: F401
from .server_process import PATIENCE


@pytest.fixture
def rhino(monkeypatch):
    """Put the stand-ins where imports find them."""
    for name, made in modules().items():
        monkeypatch.setitem(sys.modules, name, made)


class Placed:
    """A component on a canvas, run as Grasshopper runs it."""

    def __init__(self, bundle: Bundle, document=None):
        self.bundle = bundle
        self.component = Component(Document() if document is None else document, [own.name for own in bundle.inputs])
        space = {"ghenv": types.SimpleNamespace(Component=self.component)}
        exec(compile(bundle.code, f"{bundle.key}/code.py", "exec"), space)
        (self.script,) = [value for value in space.values() if isinstance(value, type) and value.__module__ == "builtins"]

    def run(self, **inputs):
        """Return the outputs by name; inputs that are not named are not connected."""
        assert set(inputs) <= {parameter.name for parameter in self.bundle.inputs}
        self.component.balloons.clear()
        self.component.expired = False
        for parameter in self.component.Params.Input:
            if parameter.Name in inputs and not parameter.Sources:
                parameter.Sources.append("a wire")
        given = [inputs.get(parameter.name) for parameter in self.bundle.inputs]
        returned = self.script().RunScript(*given)
        names = [parameter.name for parameter in self.bundle.outputs]
        return dict(zip(names, returned if len(names) > 1 else [returned]))

    def settle(self, **inputs):
        """Return the outputs by name once the canvas comes to rest, which may take as long as something is compiled."""
        out, end = self.run(**inputs), time.monotonic() + PATIENCE
        while self.component.document.scheduled:
            assert time.monotonic() < end, "the canvas does not come to rest"
            time.sleep(0.02)
            self.component.document.tick()
            if self.component.expired:
                out = self.run(**inputs)
        return out

    def said(self, level):
        """Return the texts of the balloons of a level."""
        return [text for own, text in self.component.balloons if own == level]


BUNDLES = {bundle.key: bundle for bundle in read_bundles()}


def place(name, document=None):
    """Put a component on a canvas."""
    return Placed(BUNDLES[f"CGC_{name}"], document)
