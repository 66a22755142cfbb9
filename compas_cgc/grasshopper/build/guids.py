"""GUIDs of Grasshopper's components and type hints, and stable GUIDs of the components of this package."""

from __future__ import annotations

import uuid
from typing import NamedTuple

__all__ = ["COMPONENT_TYPES", "HINTS", "LIBRARIES", "PARAMETER", "PARAMETER_TYPES", "Hint", "own_guid"]

OURS = uuid.uuid5(uuid.NAMESPACE_DNS, "compas_cgc.grasshopper")


def own_guid(*words: str) -> uuid.UUID:
    """Return a GUID that depends only on the words."""
    return uuid.uuid5(OURS, "/".join(words))


class Hint(NamedTuple):
    """A type hint of a Rhino 8 script parameter."""

    guid: uuid.UUID
    assembly: str
    type: str


def _hint(guid: str, assembly: str = "RhinoCommon", type: str = "") -> Hint:
    return Hint(uuid.UUID(guid), assembly, type if "." in type else f"Rhino.Geometry.{type}")


_CORE = "System.Private.CoreLib"

# Type hints whose converters are known from files saved by Rhino.
HINTS = {
    "none": _hint("6a184b65-baa3-42d1-a548-3915b401de53", _CORE, "System.Object"),
    "ghdoc": _hint("1c282eeb-dd16-439f-94e4-7d92b542fe8b", _CORE, "System.Object"),
    "float": _hint("9d51e32e-c038-4352-9554-f4137ca91b9a", _CORE, "System.Double"),
    "int": _hint("48d01794-d3d8-4aef-990e-127168822244", _CORE, "System.Int32"),
    "bool": _hint("d60527f5-b5af-4ef6-8970-5f96fe412559", _CORE, "System.Boolean"),
    "str": _hint("3aceb454-6dbd-4c5b-9b6b-e71f8c1cdf88", _CORE, "System.String"),
    "complex": _hint("309690df-6229-4774-91bb-b1c9c0bfa54d", "System.Runtime.Numerics", "System.Numerics.Complex"),
    "color": _hint("24b1d1a3-ab79-498c-9e44-c5b14607c4d3", "System.Drawing.Primitives", "System.Drawing.Color"),
    "point": _hint("e1937b56-b1da-4c12-8bd8-e34ee81746ef", type="Point3d"),
    "vector": _hint("15a50725-e3d3-4075-9f7c-142ba5f40747", type="Vector3d"),
    "plane": _hint("3897522d-58e9-4d60-b38c-978ddacfedd8", type="Plane"),
    "rectangle": _hint("83da014b-a550-4bf5-89ff-16e54225bd5d", type="Rectangle3d"),
    "polyline": _hint("66fa617b-e3e8-4480-9f1e-2c0688c1d21b", type="Polyline"),
    "curve": _hint("9ba89ec2-5315-435f-a621-b66c5fa2f301", type="Curve"),
    "mesh": _hint("794a1f9d-21d5-4379-b987-9e8bbf433912", type="Mesh"),
    "brep": _hint("2ceb0405-fdfe-403d-a4d6-8786da45fb9d", type="Brep"),
    "geometrybase": _hint("c37956f4-d39c-49c7-af71-1e87f8031b26", type="GeometryBase"),
}

# Types of components; `script` is the Python 3 script of Rhino 8.
COMPONENT_TYPES = {
    name: uuid.UUID(guid)
    for name, guid in {
        "script": "719467e6-7cf5-4848-99b0-c5dd57e5442c",
        "hops": "c69bb52c-88ba-4640-b69f-188d111029e8",
        "slider": "57da07bd-ecab-415d-9d86-af36d7073abc",
        "panel": "59e0b89a-e487-49f8-bab8-b5bab16be14c",
        "toggle": "2e78987b-9dfb-42a2-8b76-3923ac8bd91a",
        "button": "a8b97322-2d53-47cd-905e-b932c3ccd74e",
        "list": "00027467-0d24-4fa7-b178-8dc0ac5f42ec",
        "scribble": "7f5c6c55-f846-4a08-9c9a-cfdc285cc6fe",
        "group": "c552a431-af5b-46a9-a8a4-0fcbc27ef596",
    }.items()
}

PARAMETER_TYPES = {
    name: uuid.UUID(guid)
    for name, guid in {
        "Number": "3e8ca6be-fda8-4aaf-b5c0-3c54c8bb7312",
        "Integer": "2e3ab970-8545-46bb-836c-1c11e5610bce",
        "Boolean": "cb95db89-6165-43b6-9c41-5702bc5bf137",
        "Text": "3ede854e-c753-40eb-84cb-b48008f14fd4",
        "Mesh": "1e936df3-0eea-4246-8549-514cb8862b7a",
        "Curve": "d5967b9f-e8ee-436b-a8ad-29fdcecf32d5",
        "Point": "fbac3e32-f100-4292-8692-77240a42fd1a",
    }.items()
}

PARAMETER = uuid.UUID("08908df5-fa14-4982-9ab2-1aa0927566aa")  # inputs and outputs of Rhino 8 scripts
# Libraries; since Rhino 8.32, the script component belongs to Grasshopper itself.
LIBRARIES = {
    "script": ("Grasshopper", uuid.UUID(int=0)),
    "hops": ("Hops", uuid.UUID("82cb7266-a8bc-4d3e-99f6-b91504c7117f")),
}
