"""Items and chunks of a Hops component."""

from __future__ import annotations

from collections.abc import Sequence

from ....server.hops.endpoints import endpoint
from ....server.hops.schema import Output
from ..archive import Chunk
from ..archive import Item
from ..archive import chunk
from ..archive import item
from ..guids import PARAMETER_TYPES
from ..guids import own_guid
from .nodes import Definition
from .nodes import Hops
from .ports import instance
from .ports import source_guid
from .ports import sources_of

__all__ = ["SERVER", "hops_component"]

SERVER = "http://127.0.0.1:7331"


def hops_component(
    definition: Definition, node: Hops, attributes: Chunk, inputs: Sequence[Chunk], outputs: Sequence[Chunk]
) -> tuple[list[Item], list[Chunk]]:
    """Return the items and chunks of a Hops component for a function of the server.

    Hops requests the parameters from the server when a definition is opened; these are shown
    until then.
    """
    function = endpoint(node.uri)
    items = [
        item("CacheResultsInMemory", "gh_bool", True),
        item("CacheSolveResults", "gh_bool", True),
        item("Description", "gh_string", function.text),
        item("InstanceGuid", "gh_guid", own_guid(instance(definition, node))),
        item("Name", "gh_string", "Hops"),
        item("NickName", "gh_string", function.name),
        item("RemoteDefinitionLocation", "gh_string", f"{SERVER}/{node.uri}"),
        item("RemoteSolveVersion", "gh_version", (0, 1, 0)),
        item("ShowInput_Enabled", "gh_bool", False),
        item("ShowInput_Path", "gh_bool", False),
        item("SynchronousSolve", "gh_bool", True),
    ]
    counts, chunks = [], []
    for side, declared, places in (("Input", function.inputs, inputs), ("Output", function.outputs, outputs)):
        counts.append(item(f"{side}Count", "gh_int32", len(declared)))
        counts += [item(f"{side}Id", "gh_guid", PARAMETER_TYPES[own.kind], i) for i, own in enumerate(declared)]
        for i, (own, place) in enumerate(zip(declared, places)):
            chunks.append(_parameter(definition, node, side, i, own, place))
    return items, [attributes, chunk("ParameterData", counts, chunks)]


def _parameter(definition: Definition, node: Hops, side: str, index: int, own: Output, place: Chunk) -> Chunk:
    wires = sources_of(node).get(own.name, ()) if side == "Input" else ()
    optional = getattr(own, "optional", False) or getattr(own, "default", None) is not None
    items = [
        item("Description", "gh_string", own.text),
        item("InstanceGuid", "gh_guid", own_guid(instance(definition, node), side, own.name)),
        item("Name", "gh_string", own.name),
        item("NickName", "gh_string", own.name),
        item("Optional", "gh_bool", side == "Input" and optional),
        item("SourceCount", "gh_int32", len(wires)),
        *(item("Source", "gh_guid", source_guid(definition, wire), i) for i, wire in enumerate(wires)),
    ]
    if getattr(own, "many", False):
        items.append(item("Access", "gh_int32", 1))
    return chunk(f"{side}Param", items, [place], index)
