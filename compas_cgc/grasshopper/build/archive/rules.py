"""Consistency rules of Grasshopper definitions."""

from __future__ import annotations

import base64
from collections.abc import Iterator
from uuid import UUID

from .tree import Chunk

__all__ = ["definition_problems", "walk"]


def definition_problems(root: Chunk) -> list[str]:
    """Return the violations of the consistency rules of Grasshopper files in a definition.

    Parameters
    ----------
    root
        Root chunk of a .gh or .ghx file, from :func:`read_archive`.

    Returns
    -------
    list of str
        One sentence per violation; empty for a valid definition.

    Examples
    --------
    >>> from compas_cgc.grasshopper.build.archive import chunk
    >>> len(definition_problems(chunk("Root"))) > 0
    True
    """
    if root.name != "Root" or root.get("ArchiveVersion") is None:
        return ["the archive is not a definition: its root is not named 'Root' or has no ArchiveVersion"]
    definition = root.child("Definition")
    objects = definition.child("DefinitionObjects") if definition else None
    if objects is None:
        return ["the archive is not a definition: it has no DefinitionObjects"]
    found = objects.children("Object")
    problems = list(_numbered("the definition", "ObjectCount", objects.get("ObjectCount"), [part.index for part in found]))
    names = list(_instances(objects))
    problems += [f"the instance {name} occurs twice" for name in sorted({n for n in names if names.count(n) > 1}, key=str)]
    known = set(names)
    for part in found:
        where = f"{part.get('Name', default='an object')} ({part.index})"
        container = part.child("Container")
        if not {entry.name for entry in part.items} <= {"GUID", "Lib", "Name"} or not part.has("GUID") or not part.has("Name"):
            problems.append(f"{where}: an object must have the items GUID, Lib and Name only")
        if container is None or len(part.chunks) != 1:
            problems.append(f"{where}: an object must have exactly one chunk, its Container")
            continue
        problems += _container_problems(where, container, known)
    return problems


def _container_problems(where: str, container: Chunk, known: set[UUID]) -> Iterator[str]:
    if container.child("Attributes") is None:
        yield f"{where}: it has no Attributes and thus no position on the canvas"
    data = container.child("ParameterData")
    if data is not None:
        for side in ("Input", "Output"):
            ids = [entry.index for entry in data.items if entry.name == f"{side}Id"]
            yield from _numbered(f"{where}: {side}Id", f"{side}Count", data.get(f"{side}Count"), ids)
            yield from _numbered(
                f"{where}: {side}Param", f"{side}Count", data.get(f"{side}Count"), [p.index for p in data.children(f"{side}Param")]
            )
    for count, entry in (("ListCount", "ListItem"), ("ID_Count", "ID")):
        if container.has(count):
            parts = [p.index for p in container.children(entry)] or [p.index for p in container.items if p.name == entry]
            yield from _numbered(f"{where}: {entry}", count, container.get(count), parts)
    for part in walk(container):
        sources = [entry for entry in part.items if entry.name == "Source"]
        if sources or part.has("SourceCount"):
            yield from _numbered(f"{where}: Source", "SourceCount", part.get("SourceCount"), [entry.index for entry in sources])
        for source in sources:
            if source.value not in known:
                yield f"{where}: a wire starts at {source.value}, which is not in the file"
        if part.name == "Script":
            yield from _script_problems(where, part)


def _script_problems(where: str, script: Chunk) -> Iterator[str]:
    language = script.child("LanguageSpec")
    # Scripts in C# and Python 2 are not checked.
    if language is None or not str(language.get("Taxon")).endswith("python") or not str(language.get("Version")).startswith("3"):
        return
    try:
        compile(base64.b64decode(str(script.get("Text")), validate=True).decode("utf-8"), where, "exec")
    except (ValueError, SyntaxError) as error:
        yield f"{where}: its source cannot be read: {error}"


def _numbered(where: str, name: str, count: object, indices: list) -> Iterator[str]:
    if count != len(indices) or sorted(-1 if i is None else i for i in indices) != list(range(len(indices))):
        yield f"{where}: {name} is {count}, but the parts are numbered {indices}"


def _instances(part: Chunk) -> Iterator[UUID]:
    for child in walk(part):
        if child.has("InstanceGuid"):
            yield child.get("InstanceGuid")


def walk(part: Chunk) -> Iterator[Chunk]:
    """Yield a chunk and all chunks below it."""
    yield part
    for child in part.chunks:
        yield from walk(child)
