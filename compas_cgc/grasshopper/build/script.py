"""Items and chunks of a Rhino 8 script component, in schema version 3."""

from __future__ import annotations

import base64
from collections.abc import Mapping
from collections.abc import Sequence
from typing import NamedTuple
from typing import Optional
from uuid import UUID

from .archive import Chunk
from .archive import Item
from .archive import chunk
from .archive import item
from .component_manifest import ACCESS
from .component_manifest import Bundle
from .component_manifest import Parameter
from .guids import HINTS
from .guids import PARAMETER
from .guids import own_guid

__all__ = ["Placement", "script_component"]


class Placement(NamedTuple):
    """Position and wires of a component on a canvas."""

    attributes: Chunk  # attributes of the component
    input_attributes: Sequence[Chunk]
    output_attributes: Sequence[Chunk]
    sources: Mapping[str, Sequence[UUID]]  # instance GUIDs of the parameters wired to each input


def script_component(bundle: Bundle, instance: str, placement: Optional[Placement] = None) -> tuple[list[Item], list[Chunk]]:
    """Return the items and chunks of a component.

    Parameters
    ----------
    bundle
        The component.
    instance
        Unique text from which the GUIDs of the component are derived.
    placement
        Position and wires, for a component on a canvas.
    """
    items = [
        item("Description", "gh_string", bundle.description),
        item("GraftStandardOutputLines", "gh_bool", True),
        item("IconDisplay", "gh_int32", bundle.icon_display),
        item("IconOverride", "gh_drawing_bitmap", bundle.icon),
        item("InstanceGuid", "gh_guid", own_guid(instance)),
        item("MarshGuids", "gh_bool", bundle.marshal_guids),
        item("MarshInputs", "gh_bool", False),
        item("MarshOutputs", "gh_bool", True),
        item("Name", "gh_string", bundle.name),
        item("NickName", "gh_string", bundle.nickname),
        item("ScriptComponentVersion", "gh_int32", 3),
        item("Tooltip", "gh_string", bundle.description),
        item("UsingLibraryInputParam", "gh_bool", False),
        item("UsingScriptInputParam", "gh_bool", False),
        item("UsingScriptOutputParam", "gh_bool", False),
        item("UsingStandardOutputParam", "gh_bool", False),
    ]
    chunks = [] if placement is None else [placement.attributes]
    return items, [*chunks, _parameters(bundle, instance, placement), _script(bundle)]


def _script(bundle: Bundle) -> Chunk:
    language = chunk("LanguageSpec", [item("Taxon", "gh_string", "*.*.python"), item("Version", "gh_string", "3.*")])
    text = base64.b64encode(bundle.code.encode("utf-8")).decode("ascii")
    items = [
        item("MarshGuids", "gh_bool", bundle.marshal_guids),
        item("MarshInputs", "gh_bool", False),
        item("MarshOutputs", "gh_bool", True),
        item("Text", "gh_string", text),
        item("Title", "gh_string", bundle.name),
    ]
    return chunk("Script", items, [language])


def _parameters(bundle: Bundle, instance: str, placement: Optional[Placement]) -> Chunk:
    items, chunks = [], []
    for side, parameters in (("Input", bundle.inputs), ("Output", bundle.outputs)):
        items.append(item(f"{side}Count", "gh_int32", len(parameters)))
        items += [item(f"{side}Id", "gh_guid", PARAMETER, i) for i in range(len(parameters))]
        for i, parameter in enumerate(parameters):
            chunks.append(_parameter(side, i, parameter, instance, placement))
    return chunk("ParameterData", items, chunks)


def _parameter(side: str, index: int, parameter: Parameter, instance: str, placement: Optional[Placement]) -> Chunk:
    incoming = side == "Input"
    hint = HINTS[parameter.hint]
    sources = placement.sources.get(parameter.name, ()) if placement and incoming else ()
    access = ACCESS.index(parameter.access)
    items = [
        item("AllowTreeAccess", "gh_bool", incoming),
        item("Description", "gh_string", parameter.description),
        item("InstanceGuid", "gh_guid", own_guid(instance, side, parameter.name)),
        item("Name", "gh_string", parameter.name),
        item("NickName", "gh_string", parameter.name),
        item("Optional", "gh_bool", incoming and parameter.optional),
        item("ScriptParamAccess", "gh_int32", access),
        item("ScriptParameterVersion", "gh_int32", 2),
        item("ShowTypeHints", "gh_bool", True),
        item("SourceCount", "gh_int32", len(sources)),
        item("ToolTip", "gh_string", parameter.description),
        item("TypeHintID", "gh_guid", hint.guid),
        *(item("Source", "gh_guid", source, i) for i, source in enumerate(sources)),
    ]
    if access:
        items.append(item("Access", "gh_int32", access))
    chunks = []
    if placement:
        chunks.append((placement.input_attributes if incoming else placement.output_attributes)[index])
    converter = chunk("ConverterData", [item("AssemblyName", "gh_string", hint.assembly), item("TypeName", "gh_string", hint.type)])
    return chunk(f"{side}Param", items, [*chunks, converter], index)
