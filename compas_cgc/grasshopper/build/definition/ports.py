"""Ports: inputs and outputs of the objects on a canvas."""

from __future__ import annotations

from collections.abc import Mapping
from uuid import UUID

from ....errors import FileError
from ....server.hops.endpoints import endpoint
from ..component_manifest import Bundle
from ..guids import own_guid
from .nodes import Definition
from .nodes import Group
from .nodes import Hops
from .nodes import Node
from .nodes import Note
from .nodes import Panel
from .nodes import Script

__all__ = ["check_wires", "input_names", "instance", "output_names", "source_guid", "sources_of"]


def instance(definition: Definition, node: Node) -> str:
    """Return the text from which the GUIDs of an object are derived."""
    return f"definition/{definition.name}/{node.key}"


def input_names(node: Node, bundles: Mapping[str, Bundle]) -> list[str]:
    """Return the names of the inputs on the left side of an object."""
    if isinstance(node, Hops):
        return [own.name for own in endpoint(node.uri).inputs]
    return [parameter.name for parameter in bundles[node.bundle].inputs] if isinstance(node, Script) else []


def output_names(node: Node, bundles: Mapping[str, Bundle]) -> list[str]:
    """Return the names of the outputs on the right side of an object."""
    if isinstance(node, Hops):
        return [own.name for own in endpoint(node.uri).outputs]
    return [parameter.name for parameter in bundles[node.bundle].outputs] if isinstance(node, Script) else []


def sources_of(node: Node) -> dict[str, tuple[str, ...]]:
    """Return the sources of an object by the name of the input; the input of a panel has no name."""
    if isinstance(node, Panel):
        return {"": (node.source,)} if node.source else {}
    if isinstance(node, (Script, Hops)):
        return {name: (wire,) if isinstance(wire, str) else tuple(wire) for name, wire in node.wires.items()}
    return {}


def source_guid(definition: Definition, wire: str) -> UUID:
    """Return the instance GUID of the parameter at which a wire starts."""
    key, _, output = wire.partition(".")
    node = next(node for node in definition.nodes if node.key == key)
    return own_guid(instance(definition, node), "Output", output) if output else own_guid(instance(definition, node))


def check_wires(definition: Definition, bundles: Mapping[str, Bundle]) -> None:
    """Check that both ends of all wires exist.

    Raises
    ------
    FileError
        If an end of a wire does not exist.
    """
    nodes = {node.key: node for node in definition.nodes}
    if len(nodes) < len(definition.nodes):
        raise FileError(f"the definition {definition.name} has two objects with the same key")
    for node in definition.nodes:
        if isinstance(node, Group) and not set(node.members) <= set(nodes):
            raise FileError(f"{definition.name}: the group {node.key} refers to an object that does not exist")
        for name, wires in sources_of(node).items():
            if isinstance(node, (Script, Hops)) and name not in input_names(node, bundles):
                raise FileError(f"{definition.name}: {node.key} has no input {name!r}")
            for wire in wires:
                key, _, output = wire.partition(".")
                outputs = output_names(nodes[key], bundles) if key in nodes else None
                if outputs is None or isinstance(nodes[key], (Group, Note)) or (output not in outputs if outputs else output):
                    raise FileError(f"{definition.name}: the source of the wire from {wire!r} to {node.key}.{name} does not exist")
