"""The layers of the package: imports point down, no two parts import each other, no lazy import hides one."""

from __future__ import annotations

import ast
import re
from functools import cache
from importlib import import_module
from pathlib import Path

import pytest

PACKAGE = Path(__file__).parents[2] / "compas_cgc"

# From the bottom: a part imports from layers below its own.
LAYERS = [
    {"_version", "errors", "client"},
    {"_lazy", "_atomic_write", "_compiled", "_samples", "execution"},
    {"_figures"},
    {"discrete"},
    {"linalg", "meshing"},
    {"model"},
    {"datastructures"},
    {"solvers", "analysis", "fabrication"},
    {"io", "plot"},
    {"_warm_up"},
    {"scene"},
    {"paper", "rationalisation"},
    {"study"},
    {"server"},
    {"grasshopper", "rpc"},
    {"cli"},
]
PUBLIC = {"__init__", "__main__"}  # the face of the package, which names everything
INSIDE = {
    "solvers": [
        {"constants", "settings"},
        {"allowance", "method", "carried", "coarse", "half_sphere"},
        {"newton", "polish", "evened", "branch_ends"},
        {"projection"},
        {"flow", "determined", "drawn_side"},
        {"registry"},
        {"choices", "running"},
        {"between_lines"},
        {"rising"},
        {"larger_cap", "limits"},
        {"reasons"},
        {"selection"},
        {"continued"},
        {"run", "sensitivity"},
    ],
    "server": [
        {"errors", "keys", "limits", "memory"},
        {"security"},
        {"jobs"},
        {"api"},
        {"hops", "operation", "page"},
        {"waitress_channel", "waitress_threads", "preload", "app"},
        {"run"},
    ],
    "grasshopper": [{"runtime", "build"}, {"components"}],
    "paper": [{"examples", "weingarten"}, {"reproduction", "benchmarks"}],
}
LONGEST = 10


def imports_of(path: Path) -> set:
    """Return the modules of the package that a file imports anywhere, as paths of names below the package."""
    found = set()
    parent = path.relative_to(PACKAGE).parent.parts
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.ImportFrom):
            if node.level:
                base = parent[: len(parent) - node.level + 1]
                names = (*base, *(node.module.split(".") if node.module else ()))
            elif node.module and node.module.split(".")[0] == "compas_cgc":
                names = tuple(node.module.split(".")[1:])
            else:
                continue
            found.update((*names, alias.name) for alias in node.names)
        elif isinstance(node, ast.Import):
            found.update(tuple(alias.name.split(".")[1:]) for alias in node.names if alias.name.startswith("compas_cgc."))
    return found


@cache
def graph_of(folder: tuple) -> dict:
    """Return which parts of a folder of the package import which others."""
    depth = len(folder)
    edges: dict = {}
    for path in sorted(PACKAGE.joinpath(*folder).rglob("*.py")):
        own = path.relative_to(PACKAGE).with_suffix("").parts[depth]
        if own in PUBLIC:
            continue
        others = {names[depth] for names in imports_of(path) if len(names) > depth and names[:depth] == folder}
        edges.setdefault(own, set()).update(others - {own} - PUBLIC)
    parts = set(edges)
    return {part: others & parts for part, others in edges.items()}


FOLDERS = [(), *((name,) for name in INSIDE)]


@pytest.mark.parametrize("folder", FOLDERS, ids=lambda folder: "/".join(folder) or "package")
def test_imports_point_downwards(folder):
    layers = LAYERS if not folder else INSIDE[folder[0]]
    rank = {name: i for i, layer in enumerate(layers) for name in layer}
    graph = graph_of(folder)
    assert set(graph) <= set(rank), f"{sorted(set(graph) - set(rank))} have no layer yet"
    wrong = [f"{part} -> {other}" for part, others in graph.items() for other in others if rank[other] >= rank[part]]
    assert not wrong, f"these imports point up or sideways: {', '.join(sorted(wrong))}"


def test_chains_between_the_parts_are_short():
    graph = graph_of(())

    def longest(part):
        return 1 + max(map(longest, graph[part]), default=0)

    chains = {part: longest(part) for part in graph}
    assert max(chains.values()) <= LONGEST, chains


def test_the_public_names_that_are_looked_up_are_those_that_are_declared():
    import compas_cgc

    packages = {name for name in dir(compas_cgc) if name not in (*compas_cgc.__all__, "__all_plugins__")}
    assert {"fabrication", "io", "solvers"} <= packages <= {path.parent.name for path in PACKAGE.glob("[!_]*/__init__.py")}
    for stub in PACKAGE.rglob("__init__.pyi"):
        package = import_module(".".join(("compas_cgc", *stub.parent.relative_to(PACKAGE).parts)))
        body = ast.parse(stub.read_text(encoding="utf-8")).body
        names = [node.names[0].asname for node in body if isinstance(node, ast.ImportFrom)]
        assert all(hasattr(package, node.target.id) for node in body if isinstance(node, ast.AnnAssign))
        assert sorted(names) == package.__all__ and set(names) <= set(dir(package))
        assert all(getattr(package, name) is getattr(package, name) is not None for name in names)


def test_the_sign_of_a_target_is_tested_by_its_law_alone():
    """Elsewhere code reads types, which the law K = K̄ has as others have."""
    by_law = re.compile(r"types_of\((?:[^()]|\([^()]*\))*\)")
    tested = re.compile(r"targets?(\[[^<>=]*\])?\)?(\.(min|max)\([^)]*\))? *[<>]=? *-?0\b|sign\([^)]*targets|\b0(\.0)? *[<>]=? *\w*targets")
    found = [
        f"{path.relative_to(PACKAGE)}:{number}: {line.strip()}"
        for layer in ("model", "solvers", "analysis", "datastructures", "server", "study")
        for path in sorted((PACKAGE / layer).rglob("*.py"))
        for number, line in enumerate(path.read_text(encoding="utf-8").splitlines(), 1)
        if tested.search(by_law.sub("types", line.split("#")[0])) and path.name != "laws.py"
    ]
    assert not found, "\n".join(found)
