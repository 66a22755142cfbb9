"""Pages of the manual that follow from the code: the reference and the command line. Run it before the site is built."""

from __future__ import annotations

import argparse
import io
import os
from contextlib import redirect_stdout
from importlib import import_module
from pathlib import Path

from compas_cgc._atomic_write import write_text
from compas_cgc.cli.main import COMMANDS
from compas_cgc.cli.main import build_parser

DOCS = Path(__file__).parent

# What each page of the reference holds, from the doors down.
PAGES = {
    "compas_cgc": ("What a script needs.", ["compas_cgc"]),
    "fabrication": ("From a solved surface to what is built.", ["compas_cgc.fabrication", "compas_cgc.fabrication.curves"]),
    "io": ("Files.", ["compas_cgc.io", "compas_cgc.io.rhino"]),
    "plot": ("Pictures. Takes the extra `plot`.", ["compas_cgc.plot"]),
    "scene": ("Meshes in Rhino, Grasshopper, notebooks and compas_viewer.", ["compas_cgc.scene"]),
    "analysis": ("How good a surface is.", ["compas_cgc.analysis"]),
    "solvers": (
        "Methods and their settings.",
        ["compas_cgc.solvers", "compas_cgc.solvers.flow", "compas_cgc.solvers.newton", "compas_cgc.solvers.projection"],
    ),
    "meshing": ("Arrays in, arrays out: topology, checks, meshes from curves.", ["compas_cgc.meshing"]),
    "discrete": ("Arrays in, arrays out: discrete differential geometry.", ["compas_cgc.discrete"]),
    "linalg": ("Sparse linear systems.", ["compas_cgc.linalg"]),
    "client": ("The client of the server: standard library only.", ["compas_cgc.client"]),
    "server": ("The server as a WSGI application.", ["compas_cgc.server"]),
    "grasshopper": (
        "What writes components and definitions.",
        ["compas_cgc.grasshopper.build.archive", "compas_cgc.grasshopper.build.definition"],
    ),
    "paper": (
        "The paper's examples, tables and benchmarks.",
        ["compas_cgc.paper.examples", "compas_cgc.paper.reproduction", "compas_cgc.paper.benchmarks"],
    ),
}


def public_names(module: str) -> list[str]:
    """Return the public names of a module."""
    return [name for name in import_module(module).__all__ if not name.startswith("__")]


def is_covered(module: str, name: str) -> bool:
    """Tell whether a file of the module has the name of what it holds, so that the name alone means the file."""
    return (Path(import_module(module).__file__ or "").parent / f"{name}.py").exists()


def anchor(module: str, name: str) -> str:
    """Return where a name stands on its page."""
    return f"{module}.{name}.{name}" if is_covered(module, name) else f"{module}.{name}"


def reference_page(title: str, text: str, modules: list[str]) -> str:
    """Return a page of the reference, which the docstrings fill."""
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
    page = "# Reference\n\nEvery public name. [How to type them on the command line](../cli.md) is a page of its own.\n"
    for name, (text, modules) in PAGES.items():
        page += f"\n## [{modules[0]}]({name}.md)\n\n{text}\n\n| name | what it is |\n| --- | --- |\n"
        for module in modules:
            for own in public_names(module):
                said = (getattr(import_module(module), own).__doc__ or "").strip().splitlines()
                line = said[0].replace("|", "\\|") if said and not own.isupper() else "a constant"
                page += f"| [`{own}`]({name}.md#{anchor(module, own)}) | {line} |\n"
    return page


def command_line() -> str:
    """Return what every command says of itself."""
    page = "# The command line\n\nWhat `compas-cgc COMMAND --help` says. Made by `python docs/pages.py`.\n"
    os.environ["COLUMNS"] = "110"
    for name in COMMANDS:
        parser = build_parser(name)
        (commands,) = (own for own in parser._actions if isinstance(own, argparse._SubParsersAction))
        said = io.StringIO()
        with redirect_stdout(said):
            commands.choices[name].print_help()
        page += f"\n## compas-cgc {name}\n\n```text\n{said.getvalue().rstrip()}\n```\n"
    return page


def write_pages() -> None:
    """Write all of them."""
    (DOCS / "api").mkdir(exist_ok=True)
    for name, (text, modules) in PAGES.items():
        title = "compas_cgc" if name == "compas_cgc" else modules[0]
        write_text(DOCS / "api" / f"{name}.md", reference_page(title, text, modules))
    write_text(DOCS / "api" / "index.md", index())
    write_text(DOCS / "cli.md", command_line())


if __name__ == "__main__":
    write_pages()
