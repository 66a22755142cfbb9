"""Archive of a definition for a .gh or .ghx file."""

from __future__ import annotations

from collections.abc import Iterable
from collections.abc import Mapping

from ..archive import Chunk
from ..archive import Item
from ..archive import chunk
from ..archive import item
from ..component_manifest import Bundle
from ..guids import COMPONENT_TYPES
from ..guids import LIBRARIES
from ..guids import PARAMETER_TYPES
from ..guids import own_guid
from ..script import Placement
from ..script import script_component
from .hops import hops_component
from .layout import Box
from .layout import layout
from .layout import port_boxes
from .nodes import Definition
from .nodes import Group
from .nodes import Hops
from .nodes import Node
from .nodes import Note
from .nodes import Script
from .ports import check_wires
from .ports import instance
from .ports import source_guid
from .ports import sources_of
from .widgets import widget

__all__ = ["definition_archive"]

# Constant date 2024-01-01 in ticks of 100 ns, for reproducible files.
DATE = 638396640000000000
PAPER = (150, 255, 255, 255)


def definition_archive(definition: Definition, bundles: Mapping[str, Bundle]) -> Chunk:
    """Return a definition for Rhino 8 with its layout and the source code of all components.

    Parameters
    ----------
    definition
        Objects and wires.
    bundles
        Components by their keys.

    Returns
    -------
    Chunk
        The root of the file.

    Raises
    ------
    FileError
        If an end of a wire does not exist.

    Examples
    --------
    >>> from compas_cgc.grasshopper.build.component_manifest import read_bundles
    >>> from compas_cgc.grasshopper.build.definition import EXAMPLES
    >>> bundles = {bundle.key: bundle for bundle in read_bundles()}
    >>> definition_archive(EXAMPLES["first_dome"], bundles).name  # doctest: +SKIP
    """
    check_wires(definition, bundles)
    boxes = layout(definition, bundles)
    # Groups come last, as in files of Grasshopper, because they lie behind the other objects.
    nodes = sorted(definition.nodes, key=lambda node: isinstance(node, Group))
    objects = [_object(i, definition, node, boxes, bundles) for i, node in enumerate(nodes)]
    kinds = {Script: "script", Hops: "hops"}
    used = {kinds[type(node)] for node in nodes if type(node) in kinds}
    parts = [
        chunk(
            "DocumentHeader",
            [
                item("DocumentID", "gh_guid", own_guid("definition", definition.name)),
                item("Preview", "gh_string", "Shaded"),
                item("PreviewMeshType", "gh_int32", 1),
                item("PreviewNormal", "gh_drawing_color", (100, 150, 0, 0)),
                item("PreviewSelected", "gh_drawing_color", (100, 0, 150, 0)),
            ],
        ),
        chunk(
            "DefinitionProperties",
            [
                item("Date", "gh_date", DATE),
                item("Description", "gh_string", definition.description),
                item("Name", "gh_string", f"{definition.name}.gh"),
                *([item("KeepOpen", "gh_bool", False)] if definition.rhino >= 8 else []),
            ],
            [
                chunk("Revisions", [item("RevisionCount", "gh_int32", 0)]),
                chunk("Projection", [item("Target", "gh_drawing_point", (40, 40)), item("Zoom", "gh_single", 0.8)]),
                chunk("Views", [item("ViewCount", "gh_int32", 0)]),
            ],
        ),
        chunk("RcpLayout", [item("GroupCount", "gh_int32", 0)]),
        chunk("GHALibraries", [item("Count", "gh_int32", len(used))], [_library(i, name) for i, name in enumerate(sorted(used))]),
        chunk("DefinitionObjects", [item("ObjectCount", "gh_int32", len(objects))], objects),
    ]
    inside = chunk("Definition", [item("plugin_version", "gh_version", (1, 0, definition.rhino))], parts)
    return chunk("Root", [item("ArchiveVersion", "gh_version", (0, 2, 2))], [inside])


def _library(index: int, name: str) -> Chunk:
    title, guid = LIBRARIES[name]
    items = [
        item("Author", "gh_string", "Robert McNeel & Associates"),
        item("Id", "gh_guid", guid),
        item("Name", "gh_string", title),
        item("Version", "gh_string", ""),
    ]
    return chunk("Library", items, index=index)


def _object(index: int, definition: Definition, node: Node, boxes: Mapping[str, Box], bundles: Mapping[str, Bundle]) -> Chunk:
    if isinstance(node, Script):
        return _script(index, definition, node, boxes[node.key], bundles)
    if isinstance(node, Hops):
        ports = [[_attributes(port) for port in side] for side in port_boxes(node, boxes[node.key], bundles)]
        items, chunks = hops_component(definition, node, _attributes(boxes[node.key]), *ports)
        return _wrapped(index, "hops", "Hops", items, chunks)
    if isinstance(node, Group):
        members = [own_guid(instance(definition, other)) for key in node.members for other in definition.nodes if other.key == key]
        items = [
            item("Border", "gh_int32", 1),
            item("Colour", "gh_drawing_color", PAPER),
            *(item("ID", "gh_guid", guid, i) for i, guid in enumerate(members)),
            item("ID_Count", "gh_int32", len(members)),
        ]
        return _wrapped(index, "group", "Group", _common(definition, node, node.name, items), [chunk("Attributes")])
    sources = [source_guid(definition, wire) for wires in sources_of(node).values() for wire in wires]
    kind, title, items, chunks = widget(node, boxes[node.key])
    if not isinstance(node, Note):
        items = [*items, item("Optional", "gh_bool", False), item("SourceCount", "gh_int32", len(sources))]
        items += [item("Source", "gh_guid", source, i) for i, source in enumerate(sources)]
    return _wrapped(index, kind, title, _common(definition, node, getattr(node, "name", ""), items, title), chunks)


def _script(index: int, definition: Definition, node: Script, box: Box, bundles: Mapping[str, Bundle]) -> Chunk:
    bundle = bundles[node.bundle]
    inputs, outputs = (list(map(_attributes, ports)) for ports in port_boxes(node, box, bundles))
    sources = {name: [source_guid(definition, wire) for wire in wires] for name, wires in sources_of(node).items()}
    items, chunks = script_component(bundle, instance(definition, node), Placement(_attributes(box), inputs, outputs, sources))
    if node.hidden:
        items = [*items, item("Hidden", "gh_bool", True)]
    return _wrapped(index, "script", bundle.name, items, chunks)


def _attributes(box: Box) -> Chunk:
    return chunk("Attributes", [item("Bounds", "gh_drawing_rectanglef", box), item("Pivot", "gh_drawing_pointf", box.centre)])


def _common(definition: Definition, node: Node, nickname: str, items: Iterable[Item], title: str = "Group") -> list[Item]:
    return [
        *items,
        item("Description", "gh_string", ""),
        item("InstanceGuid", "gh_guid", own_guid(instance(definition, node))),
        item("Name", "gh_string", title),
        item("NickName", "gh_string", nickname),
    ]


def _wrapped(index: int, kind: str, title: str, items: Iterable[Item], chunks: Iterable[Chunk]) -> Chunk:
    guid = COMPONENT_TYPES.get(kind) or PARAMETER_TYPES[kind]
    own = [item("GUID", "gh_guid", guid), item("Name", "gh_string", title)]
    if kind in LIBRARIES and LIBRARIES[kind][1].int:
        own.append(item("Lib", "gh_guid", LIBRARIES[kind][1]))
    return chunk("Object", own, [chunk("Container", items, chunks)], index)
