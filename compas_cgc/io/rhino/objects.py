"""The objects of an archive with their layers and texts."""

from __future__ import annotations

from typing import TYPE_CHECKING
from typing import NamedTuple

if TYPE_CHECKING:
    import rhino3dm

__all__ = ["Item", "list_items"]


class Item(NamedTuple):
    """An object of a .3dm file."""

    geometry: rhino3dm.GeometryBase
    kind: str  # mesh, curve, point, point cloud, text dot, or the class in rhino3dm
    id: str
    layer: str  # full path, such as CGC::Mesh
    name: str
    text: dict[str, str]  # user text of the object and its geometry, keys in small letters
    layer_text: dict[str, str]  # user text of its layer, keys in small letters
    hidden: bool  # the object or its layer is hidden

    @property
    def label(self) -> str:
        """How errors and notes name it."""
        return f"{self.kind} {self.id} on layer {self.layer!r}"


def list_items(archive: rhino3dm.File3dm) -> list[Item]:
    """Return the objects of an archive in their order; those inside of block definitions are left out."""
    layers = {}
    for layer in archive.Layers:
        layers[layer.Index] = (layer.FullPath or layer.Name, _texts(layer), bool(layer.Visible))
    items = []
    for entry in archive.Objects:
        geometry, attributes = entry.Geometry, entry.Attributes
        if geometry is None or attributes.IsInstanceDefinitionObject:
            continue
        path, layer_text, visible = layers.get(attributes.LayerIndex, ("", {}, True))
        items.append(
            Item(
                geometry=geometry,
                kind=_kind(geometry),
                id=str(attributes.Id),
                layer=path,
                name=attributes.Name or "",
                text={**_texts(geometry), **_texts(attributes)},
                layer_text=layer_text,
                hidden=not (visible and attributes.Visible),
            )
        )
    return items


def _kind(geometry: rhino3dm.GeometryBase) -> str:
    import rhino3dm

    kinds = (
        (rhino3dm.Mesh, "mesh"),
        (rhino3dm.Curve, "curve"),
        (rhino3dm.PointCloud, "point cloud"),
        (rhino3dm.Point, "point"),
        (rhino3dm.TextDot, "text dot"),
    )
    return next((name for kind, name in kinds if isinstance(geometry, kind)), type(geometry).__name__)


def _texts(thing: rhino3dm.CommonObject) -> dict[str, str]:
    return {key.strip().casefold(): value for key, value in thing.GetUserStrings() or ()}
