"""Layer writer: meshes, points, curves and dots put on the layers of an archive."""

from __future__ import annotations

from collections.abc import Iterable
from collections.abc import Mapping
from collections.abc import Sequence
from typing import Optional

import numpy as np
import rhino3dm

from ...discrete.arrays import FloatArray

__all__ = ["LayerWriter"]

Colour = tuple[int, int, int]


class LayerWriter:
    """An archive that is being drawn to.

    Parameters
    ----------
    archive
        A new one, or one that was read.
    """

    def __init__(self, archive: rhino3dm.File3dm):
        self.archive = archive

    def clear(self, parent: str) -> None:
        """Delete everything on a top layer and its sublayers."""
        within = {layer.Index for layer in self.archive.Layers if (layer.FullPath or layer.Name).split("::")[0] == parent}
        for name in [str(entry.Attributes.Id) for entry in self.archive.Objects if entry.Attributes.LayerIndex in within]:
            self.archive.Objects.Delete(name)

    def layer(self, path: str, colour: Colour = (0, 0, 0), visible: bool = True) -> int:
        """Return the index of a layer (its full path), made with its parents if there is none yet."""
        found = {layer.FullPath or layer.Name: layer.Index for layer in self.archive.Layers}
        if path in found:
            return found[path]
        parent, _, name = path.rpartition("::")
        layer = rhino3dm.Layer()
        layer.Name, layer.Color, layer.Visible = name, (*colour, 255), visible
        if parent:
            above = self.layer(parent)
            layer.ParentLayerId = next(other.Id for other in self.archive.Layers if other.Index == above)
        return self.archive.Layers.Add(layer)

    def attributes(
        self, layer: int, name: str = "", text: Optional[Mapping[str, str]] = None, colour: Optional[Colour] = None
    ) -> rhino3dm.ObjectAttributes:
        """Return attributes of an object on a layer, with a name, user text and a colour of its own."""
        attributes = rhino3dm.ObjectAttributes()
        attributes.LayerIndex, attributes.Name = layer, name
        for key, value in (text or {}).items():
            attributes.SetUserString(key, value)
        if colour is not None:
            attributes.ObjectColor, attributes.ColorSource = (*colour, 255), rhino3dm.ObjectColorSource.ColorFromObject
        return attributes

    def mesh(self, mesh: rhino3dm.Mesh, attributes: rhino3dm.ObjectAttributes) -> None:
        """Add a mesh."""
        self.archive.Objects.AddMesh(mesh, attributes)

    def points(self, points: FloatArray, attributes: rhino3dm.ObjectAttributes) -> None:
        """Add points (k, 3) [L]."""
        for x, y, z in np.asarray(points, dtype=np.float64).tolist():
            self.archive.Objects.AddPoint(rhino3dm.Point3d(x, y, z), attributes)

    def cloud(self, points: FloatArray, attributes: rhino3dm.ObjectAttributes) -> None:
        """Add points (k, 3) [L] as one object: a point cloud where there are several."""
        if len(points) == 1:
            self.points(points, attributes)
            return
        cloud = rhino3dm.PointCloud()
        for x, y, z in np.asarray(points, dtype=np.float64).tolist():
            cloud.Add(rhino3dm.Point3d(x, y, z))
        self.archive.Objects.AddPointCloud(cloud, attributes)

    def polyline(self, points: FloatArray, attributes: rhino3dm.ObjectAttributes) -> None:
        """Add a polyline through points (k, 3) [L]."""
        line = [rhino3dm.Point3d(x, y, z) for x, y, z in np.asarray(points, dtype=np.float64).tolist()]
        self.archive.Objects.AddPolyline(line, attributes)

    def dot(self, text: str, place: Sequence[float], attributes: rhino3dm.ObjectAttributes) -> None:
        """Add a text dot at a place (3,) [L]."""
        self.archive.Objects.AddTextDot(text, rhino3dm.Point3d(*(float(x) for x in place)), attributes)

    def document_text(self, texts: Iterable[tuple[str, str]]) -> None:
        """Set document user text."""
        for key, value in texts:
            self.archive.Strings[key] = value
