"""Generated pages of the manual: the reference, the command line, and the numerical constants.

This file is a hook of mkdocs. Zensical has no hooks and reads the files that `python docs/pages.py` writes.
"""

from __future__ import annotations

import argparse
import ast
import io
import os
import re
import tokenize
from collections.abc import Callable
from collections.abc import Iterator
from contextlib import redirect_stdout
from functools import partial
from importlib import import_module
from pathlib import Path
from pkgutil import walk_packages
from typing import Any
from typing import NamedTuple
from typing import Optional

import compas_cgc
from compas_cgc._atomic_write import write_text
from compas_cgc.cli.main import COMMANDS
from compas_cgc.cli.main import build_parser
from compas_cgc.io import FORMATS
from compas_cgc.io import SUFFIXES

DOCS = Path(__file__).parent
PACKAGE = Path(compas_cgc.__file__).parent

# Title text and modules of each page of the reference.
PAGES = {
    "compas_cgc": ("Names for scripts.", ["compas_cgc"]),
    "fabrication": ("From a solved surface to fabrication.", ["compas_cgc.fabrication", "compas_cgc.fabrication.curves"]),
    "io": ("Files.", ["compas_cgc.io", "compas_cgc.io.rhino"]),
    "plot": ("Pictures. Requires the extra `plot`.", ["compas_cgc.plot"]),
    "scene": ("Meshes in Rhino, Grasshopper, notebooks and compas_viewer.", ["compas_cgc.scene"]),
    "analysis": ("Quality of a surface.", ["compas_cgc.analysis"]),
    "solvers": (
        "Methods and their settings.",
        ["compas_cgc.solvers", "compas_cgc.solvers.flow", "compas_cgc.solvers.newton", "compas_cgc.solvers.projection"],
    ),
    "meshing": ("Arrays in, arrays out: topology, checks, meshes from curves.", ["compas_cgc.meshing"]),
    "discrete": ("Arrays in, arrays out: discrete differential geometry.", ["compas_cgc.discrete"]),
    "linalg": ("Sparse linear systems.", ["compas_cgc.linalg"]),
    "rationalisation": ("From a freeform design to panels on few moulds.", ["compas_cgc.rationalisation"]),
    "study": ("Many variants of a drawing.", ["compas_cgc.study"]),
    "client": ("The client of the server: standard library only.", ["compas_cgc.client"]),
    "server": ("The server as a WSGI application.", ["compas_cgc.server"]),
    "grasshopper": (
        "Writers for components and definitions.",
        ["compas_cgc.grasshopper.build.archive", "compas_cgc.grasshopper.build.definition"],
    ),
    "paper": (
        "The paper's examples, tables and benchmarks.",
        ["compas_cgc.paper.examples", "compas_cgc.paper.reproduction", "compas_cgc.paper.benchmarks"],
    ),
}


# Interfaces that document themselves, and packages whose names are public elsewhere too.
LEFT_OUT = {"compas_cgc.cli", "compas_cgc.datastructures", "compas_cgc.server.page", "compas_cgc.grasshopper.components"}


# Packages whose numerical constants have a table each.
CONSTANTS = ("solvers", "model", "discrete")
CONSTANTS_TEXT = """# Numerical constants

All numbers that results depend on have a name at the top of a module, with their meaning and the reason for their value.
`python docs/pages.py` reads these tables from the comments of the code. Ratios and numbers of things have the unit 1. Solvers work
in a local frame, in which the drawing has unit size; L is a length there.

Bounds of steps and time are not reached in most solves; a solve that reaches one ends with a status that says so. Where a reason
says that half and twice a value give the same surfaces, up to four small problems that use the constant were solved with both: roofs
on corners, rims and walls, irregular meshes, drawn shapes, creases and goals. Harder problems may depend on it.
"""
# Parts of expressions that are numbers: literals, arithmetic, and functions such as np.radians. Lists are tables of indices or weights.
NUMERIC = (
    ast.Constant,
    ast.operator,
    ast.unaryop,
    ast.expr_context,
    ast.BinOp,
    ast.UnaryOp,
    ast.Name,
    ast.Attribute,
    ast.Call,
    ast.Tuple,
    ast.Dict,
)
TABLES = ("np.zeros", "np.eye", "np.arange")


def pages() -> dict[str, tuple[str, list[str]]]:
    """Return text and modules of each page; packages that PAGES does not list go to the page of their parent."""
    found = {name: (text, list(modules)) for name, (text, modules) in PAGES.items()}
    listed = {module for _, modules in PAGES.values() for module in modules} | LEFT_OUT
    for own in walk_packages(compas_cgc.__path__, "compas_cgc."):
        parts = own.name.split(".")[1:]
        if own.ispkg and own.name not in listed and not any(part.startswith("_") for part in parts):
            if getattr(import_module(own.name), "__all__", ()):
                found[parts[0] if parts[0] in found else "compas_cgc"][1].append(own.name)
    return found


def public_names(module: str) -> list[str]:
    """Return the public names of a module."""
    return [name for name in import_module(module).__all__ if not name.startswith("__")]


def is_covered(module: str, name: str) -> bool:
    """Check whether a submodule has the same name as the object, so that the plain path would mean the submodule."""
    return (Path(import_module(module).__file__ or "").parent / f"{name}.py").exists()


def anchor(module: str, name: str) -> str:
    """Return the anchor of a name on its page."""
    return f"{module}.{name}.{name}" if is_covered(module, name) else f"{module}.{name}"


def reference_page(title: str, text: str, modules: list[str]) -> str:
    """Return a page of the reference with mkdocstrings directives."""
    page = f"# {title}\n\n{text}\n"
    for module in modules:
        heading = f"\n## `{module}`\n" if len(modules) > 1 else ""
        level = "\n    options:\n      heading_level: 3" if len(modules) > 1 else ""
        options = level or "\n    options:"
        plain = [name for name in public_names(module) if not is_covered(module, name)]
        members = "".join(f"\n        - {name}" for name in plain)
        page += f"{heading}\n::: {module}{options}\n      members:{members}\n"
        for name in public_names(module):
            if is_covered(module, name):
                page += f"\n::: {anchor(module, name)}{options}\n      show_root_heading: true\n      show_root_toc_entry: true\n"
    return page


def index() -> str:
    """Return the list of all public names with the first lines of their docstrings."""
    page = "# Reference\n\nThis page lists all public names. See also [the command line](../cli.md).\n"
    for name, (text, modules) in pages().items():
        page += f"\n## [{modules[0]}]({name}.md)\n\n{text}\n\n| name | description |\n| --- | --- |\n"
        for module in modules:
            for own in public_names(module):
                lines = (getattr(import_module(module), own).__doc__ or "").strip().splitlines()
                line = lines[0].replace("|", "\\|") if lines and not own.isupper() else "a constant"
                page += f"| [`{own}`]({name}.md#{anchor(module, own)}) | {line} |\n"
    return page


def command_line() -> str:
    """Return the page with the help texts of all commands."""
    page = "# The command line\n\nThe output of `compas-cgc COMMAND --help`, written by `python docs/pages.py`.\n"
    os.environ["COLUMNS"] = "110"  # the width that argparse uses
    for name in COMMANDS:
        parser = build_parser(name)
        (commands,) = (own for own in parser._actions if isinstance(own, argparse._SubParsersAction))
        stream = io.StringIO()
        with redirect_stdout(stream):
            commands.choices[name].print_help()
        page += f"\n## compas-cgc {name}\n\n```text\n{stream.getvalue().rstrip()}\n```\n"
    return page


def formats() -> str:
    """Return the page on files with the table of formats."""
    rows = ["| | format | coordinates | supports, creases | targets | goals | extra |", "| --- | --- | --- | --- | --- | --- | --- |"]
    for suffix in SUFFIXES:
        own = FORMATS[suffix]
        cells = (f"`{suffix}`", own.name, own.coordinates, own.supports, own.targets, own.goals, f"`{own.extra}`" if own.extra else "")
        rows.append(f"| {' | '.join(cells)} |")
    before, _, rest = (DOCS / "3dm.md").read_text(encoding="utf-8").partition("<!-- formats -->\n")
    return before + "<!-- formats -->\n" + "\n".join(rows) + "\n<!-- end -->" + rest.partition("<!-- end -->")[2]


class Constant(NamedTuple):
    """A numerical constant at the top of a module."""

    name: str
    value: str
    unit: str
    meaning: str
    reason: str
    module: str  # path relative to the package compas_cgc


def _is_number(value: ast.expr) -> bool:
    """Check whether an expression is a number or consists of numbers; tables of indices are no numerical constants."""
    if not all(isinstance(node, NUMERIC) for node in ast.walk(value)) or ast.unparse(value).startswith(TABLES):
        return False
    leaves = [node.value for node in ast.walk(value) if isinstance(node, ast.Constant)]
    if any(isinstance(leaf, (bool, str, bytes)) or leaf is None for leaf in leaves):
        return False
    limits = any(isinstance(node, ast.Attribute) and node.attr in ("eps", "tiny") for node in ast.walk(value))
    scalar = not any(isinstance(node, (ast.Tuple, ast.Dict)) for node in ast.walk(value))
    return limits or (bool(leaves) and (scalar or any(isinstance(leaf, float) for leaf in leaves)))


def _comments(text: str) -> dict[int, str]:
    """Return the comments of the beginning of a module by line."""
    tokens = tokenize.generate_tokens(io.StringIO(text).readline)
    return {token.start[0]: token.string.lstrip("# ") for token in tokens if token.type == tokenize.COMMENT}


def constants(module: Path) -> Iterator[Constant]:
    """Yield the numerical constants of a module, with the parts of their comments: ``meaning [unit]; reason``.

    The comment is in the line of the constant, or in the lines above it.
    """
    text = module.read_text(encoding="utf-8")
    found: list[tuple[ast.stmt, ast.Name, ast.expr]] = []
    for node in ast.parse(text).body:
        if isinstance(node, (ast.Assign, ast.AnnAssign)) and node.value is not None:
            target, value = (node.targets[0] if isinstance(node, ast.Assign) else node.target), node.value
            several = isinstance(target, ast.Tuple) and isinstance(value, ast.Tuple)
            for one, own in zip(target.elts, value.elts) if several else [(target, value)]:
                if isinstance(one, ast.Name) and one.id.isupper() and _is_number(own):
                    found.append((node, one, own))
    if not found:
        return
    lines = text.splitlines()[: found[-1][0].end_lineno]
    comments = _comments("\n".join(lines) + "\n")
    for node, name, value in found:
        used = [line for line in range(node.lineno, (node.end_lineno or node.lineno) + 1) if line in comments]
        above = node.lineno - 1
        while (not used or used[0] < node.lineno) and above in comments and lines[above - 1].startswith("#"):
            used, above = [above, *used], above - 1
        comment = " ".join(comments[line] for line in used)
        meaning, _, reason = comment.partition("; ")
        meaning, _, unit = meaning.rstrip("]").partition(" [")
        source = ast.get_source_segment(text, value) or ""
        yield Constant(name.id, source, unit or "1", meaning, reason, module.relative_to(PACKAGE).as_posix())


def constants_page() -> str:
    """Return the page with the tables of numerical constants."""
    page = CONSTANTS_TEXT
    for name in CONSTANTS:
        found = [own for path in sorted((PACKAGE / name).rglob("*.py")) for own in constants(path)]
        page += f"\n## {name}\n\n{len(found)} constants\n\n| name | value | unit | meaning | reason | module |\n"
        page += "| --- | --- | --- | --- | --- | --- |\n"
        for own in found:
            cells = (f"`{own.name}`", f"`{own.value}`", own.unit, own.meaning, own.reason, f"`{own.module}`")
            page += f"| {' | '.join(cell.replace('|', '&#124;') for cell in cells)} |\n"
    return page


def made() -> dict[str, Callable[[], str]]:
    """Return the functions that create the pages, by path."""
    found: dict[str, Callable[[], str]] = {"api/index.md": index, "cli.md": command_line, "3dm.md": formats, "constants.md": constants_page}
    for name, (text, modules) in pages().items():
        found[f"api/{name}.md"] = partial(reference_page, modules[0], text, modules)
    return found


def on_page_read_source(page: Any, config: Any) -> Optional[str]:
    """Pass generated pages to mkdocs, so that they match the current code."""
    make = made().get(page.file.src_uri)
    return make() if make else None


def on_page_content(html: str, page: Any, config: Any, files: Any) -> str:
    """Remove reStructuredText roles of docstrings from the text."""
    plain = re.sub(r":(?:class|func|meth|mod|attr|data|exc|math):(<code>)~?(?:compas_cgc\.(?:\w+\.)*)?", r"\1", html)
    return re.sub(r":(?:class|func|meth|mod|attr|data|exc):(?=<)", "", plain)


if __name__ == "__main__":
    for path, make in made().items():
        (DOCS / path).parent.mkdir(exist_ok=True)
        write_text(DOCS / path, make())
