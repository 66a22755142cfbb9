"""User objects: component bundles as .ghuser files."""

from __future__ import annotations

from ...errors import FileError
from .archive import Chunk
from .archive import chunk
from .archive import from_bytes
from .archive import item
from .archive import to_bytes
from .component_manifest import Bundle
from .guids import COMPONENT_TYPES
from .script import script_component

__all__ = ["is_ours", "user_object"]

PREFIX = "COMPAS CGC: "


def user_object(bundle: Bundle) -> Chunk:
    """Return a bundle as the archive of a .ghuser file."""
    items, chunks = script_component(bundle, f"component/{bundle.key}")
    inner = to_bytes(chunk("UserObject", items, chunks))
    return chunk(
        "UserObject",
        [
            item("BaseID", "gh_guid", COMPONENT_TYPES["script"]),
            item("Category", "gh_string", bundle.category),
            item("Description", "gh_string", bundle.description),
            item("Exposure", "gh_int32", bundle.exposure),
            item("Icon", "gh_bytearray", bundle.icon),
            item("InstanceGuid", "gh_guid", bundle.guid),
            item("Name", "gh_string", PREFIX + bundle.name),
            item("NickName", "gh_string", bundle.nickname),
            item("Object", "gh_bytearray", inner),
            item("SubCategory", "gh_string", bundle.subcategory),
        ],
    )


def is_ours(data: bytes) -> bool:
    """Check whether the bytes of a file are a user object of this package."""
    try:
        archive = from_bytes(data)
    except FileError:
        return False
    return archive.name == "UserObject" and str(archive.get("Name", default="")).startswith(PREFIX)
