"""The manual: its code runs page by page, its commands and options are known, its links lead somewhere, all public names are in it."""

from __future__ import annotations

import ast
import importlib
import importlib.util
import pkgutil
import re
import shlex
import shutil
import subprocess
from pathlib import Path

import numpy as np
import pytest

import compas_cgc
from compas_cgc.cli import main
from compas_cgc.cli.exits import DONE
from compas_cgc.cli.main import COMMANDS
from compas_cgc.cli.main import build_parser

ROOT = Path(__file__).parents[2]
DOCS = ROOT / "docs"
PAGES = sorted(path for path in DOCS.rglob("*.md") if "api" not in path.parts)
READ = [ROOT / "README.md", ROOT / "CONTRIBUTING.md", *PAGES]

# Run by tests that also look at what they give.
ELSEWHERE = {"goals.md", "gallery.md", "fairness.md"}
# Commands that other tests run, or that do not come to an end.
NOT_RUN = {"serve", "bench", "reproduce", "grasshopper", "warm", "example"}
# Long examples of what other tests show on smaller meshes.
NIGHTLY = {"fabrication.md", "freeform.md", "recipes.md", "studies.md", "roof.md", "canopy.md", "vault.md", "facade.md", "cushion.md"}


def blocks(path: Path, *languages: str) -> list[tuple[str, str]]:
    """Return language and text of the blocks of a page, also of those that are indented."""
    found = []
    for indent, language, text in re.findall(
        r"^( *)```(\w+)[^\n]*\n(.*?)^\1```", path.read_text(encoding="utf-8"), re.DOTALL | re.MULTILINE
    ):
        if language in languages:
            found.append((language, "\n".join(line[len(indent) :] for line in text.splitlines())))
    return found


def commands(text: str, *programs: str) -> list[list[str]]:
    """Return the calls of programs in a block, as words."""
    lines = text.replace("\\\n", " ").splitlines()
    return [words for words in (shlex.split(line, comments=True) for line in lines) if words and words[0] in programs]


def tutorials() -> list:
    with_code = [path for path in [*PAGES, ROOT / "CONTRIBUTING.md"] if path.name not in ELSEWHERE and blocks(path, "python", "sh")]
    marks = {path: [pytest.mark.nightly] if path.name in NIGHTLY else [] for path in with_code}
    return [pytest.param(path, id=path.name, marks=marks[path]) for path in with_code]


@pytest.mark.parametrize("path", tutorials())
def test_the_code_of_a_page_runs(path, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    for name in compas_cgc.samples():
        shutil.copy(compas_cgc.get(name), tmp_path / name)
    # What a page calls the reader's own file.
    shutil.copy(compas_cgc.get("nine_regions.3dm"), tmp_path / "roof.3dm")
    shutil.copy(compas_cgc.get("vault.3dm"), tmp_path / "design.3dm")
    for name, text in re.findall(r'^```toml title="([^"]+)"\n(.*?)^```', path.read_text(encoding="utf-8"), re.DOTALL | re.MULTILINE):
        (tmp_path / name).write_text(text, encoding="utf-8")
    names: dict = {"__name__": "page"}
    for language, text in blocks(path, "python", "py", "sh"):
        if language == "sh":
            for words in commands(text, "compas-cgc", "ccx"):
                if words[0] == "ccx":
                    if shutil.which("ccx") is None:
                        break  # what follows reads its results
                    subprocess.run(words, check=True, capture_output=True, timeout=300)
                    continue
                build_parser(words[1]).parse_args(words[1:])
                if words[1] not in NOT_RUN:
                    assert main([*words[1:], *(["--no-page"] if words[1] == "mould" else [])]) == DONE, capsys.readouterr().err
        elif language == "python" or path.name == "fabrication.md":
            exec(compile(text, path.name, "exec"), names)


@pytest.mark.nightly
def test_the_surfaces_of_the_gallery_are_fair():
    text = (DOCS / "gallery.md").read_text(encoding="utf-8")
    pictures = re.findall(r"images/gallery/(\w+)\.png", text)
    first, *codes = (text for _, text in blocks(DOCS / "gallery.md", "python"))
    assert len(pictures) == len(codes) >= 7
    for name, code in zip(pictures, codes):
        names: dict = {"__name__": "gallery"}
        exec(compile(f"{first}\n{code}", "gallery.md", "exec"), names)
        assert names["result"].converged and names["result"].verdict.fair, name
        assert (DOCS / "images" / "gallery" / f"{name}.png").exists()


def made_by(name: str):
    """Return a module of the scripts that make the manual."""
    spec = importlib.util.spec_from_file_location(name, DOCS / f"{name}.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def test_samples_and_gallery_are_made_from_the_same_drawings(monkeypatch):
    monkeypatch.syspath_prepend(str(DOCS))
    assert (DOCS / "gallery.md").read_text(encoding="utf-8") == made_by("gallery").page()
    for name, mesh in made_by("drawings").samples().items():
        read, drawn = compas_cgc.read(compas_cgc.get(f"{name}.3dm")).to_problem(), mesh.to_problem()
        for array in ("vertices", "faces", "roles", "targets", "creases"):
            assert np.array_equal(getattr(read, array), getattr(drawn, array), equal_nan=array == "targets"), (name, array)


def test_python_on_pages_can_be_parsed():
    for path in READ:
        for _, text in blocks(path, "python", "py"):
            ast.parse(text, filename=path.name)


def options_of(command: str) -> set[str]:
    parser = build_parser(command)
    (commands,) = (own for own in parser._actions if hasattr(own, "choices") and isinstance(own.choices, dict))
    found: set[str] = set()
    todo = [commands.choices[command]]
    while todo:
        for action in todo.pop()._actions:
            found.update(action.option_strings)
            if isinstance(getattr(action, "choices", None), dict):
                todo += action.choices.values()
    return found


def test_commands_and_options_that_pages_name_are_known():
    known = {name: options_of(name) for name in COMMANDS}
    wrong = []
    for path in [path for path in READ if path.name != "cli.md"]:
        text = path.read_text(encoding="utf-8")
        for call in re.findall(r"compas-cgc ([a-z]+)([^`\n]*)", text):
            command, rest = call
            if command not in known:
                wrong.append(f"{path.name}: compas-cgc {command}")
                continue
            wrong += [
                f"{path.name}: compas-cgc {command} {own}"
                for own in re.findall(r"(?<![\w-])--[a-z][\w-]*", rest)
                if own not in known[command]
            ]
        everything = set.union(*known.values()) | {"--version", "--help"}
        inline = re.findall(r"`(--[a-z][\w-]*)", text)
        if path.name != "CONTRIBUTING.md":
            wrong += [f"{path.name}: {own}" for own in inline if own not in everything]
    assert not wrong, wrong


def anchors(path: Path) -> set[str]:
    """Return the anchors of a page as the site makes them."""
    heads = re.findall(r"^#+ +(.*?)\s*$", path.read_text(encoding="utf-8"), re.MULTILINE)
    plain = [re.sub(r"\[([^\]]*)\]\([^)]*\)", r"\1", head) for head in heads]
    return {re.sub(r"[-\s]+", "-", re.sub(r"[^\w\s-]", "", head).strip().lower()) for head in plain}


def test_links_lead_somewhere():
    for path in READ:
        text = re.sub(r"```.*?```", "", path.read_text(encoding="utf-8"), flags=re.DOTALL)
        for target in re.findall(r"\]\((?!https?:|mailto:)([^)\s]+)\)", text):
            page, _, anchor = target.partition("#")
            aim = (path.parent / page).resolve() if page else path
            assert aim.exists(), f"{path.name} names {target}"
            if anchor and aim.suffix == ".md" and "api" not in aim.parts:
                assert anchor in anchors(aim), f"{path.name} names {target}"


def test_every_public_name_is_in_the_reference():
    pages = made_by("pages")
    index = pages.index()
    packages = [own.name for own in pkgutil.walk_packages(compas_cgc.__path__, "compas_cgc.") if own.ispkg]
    for package in ["compas_cgc", *packages]:
        if not any(part.startswith("_") for part in package.split(".")[1:]) and package not in pages.LEFT_OUT:
            for name in getattr(importlib.import_module(package), "__all__", ()):
                assert name.startswith("__") or f"#{pages.anchor(package, name)})" in index, (
                    f"{package}.{name} is on no page of docs/pages.py"
                )
    own = {path.relative_to(DOCS).as_posix() for path in (DOCS / "api").glob("*.md")}
    assert set(pages.made()) == own | {"3dm.md", "cli.md", "constants.md"}


def test_numerical_constants_have_meaning_and_reason():
    pages = made_by("pages")
    found = [own for name in pages.CONSTANTS for path in (pages.PACKAGE / name).rglob("*.py") for own in pages.constants(path)]
    assert len(found) > 300
    assert [f"{own.module}: {own.name}" for own in found if not (own.meaning and own.reason)] == []


def test_comments_of_constants_are_read_from_their_line_or_from_above(tmp_path):
    pages = made_by("pages")
    pages.PACKAGE = tmp_path
    module = tmp_path / "module.py"
    module.write_text(
        "# about the module\n\nSTEP = 1e-8  # step [L]; root of eps\nNAMES = ('a', 'b')\n# share of\n# all; measured\nPART: float = 2 / 3\n"
        "A, B = np.radians(3.0), (0.5, 1.0)  # two; by definition\nLEFT = 4\n\n\ndef f():\n    INNER = 1.0\n",
        encoding="utf-8",
    )
    assert [tuple(own[:5]) for own in pages.constants(module)] == [
        ("STEP", "1e-8", "L", "step", "root of eps"),
        ("PART", "2 / 3", "1", "share of all", "measured"),
        ("A", "np.radians(3.0)", "1", "two", "by definition"),
        ("B", "(0.5, 1.0)", "1", "two", "by definition"),
        ("LEFT", "4", "1", "", ""),
    ]


def test_samples_are_the_examples_of_the_clone():
    for path in (ROOT / "examples").glob("*.3dm"):
        assert path.read_bytes() == Path(compas_cgc.get(path.name)).read_bytes()
    with pytest.raises(compas_cgc.FileError, match="the samples are canopy.3dm, .*vault.3dm"):
        compas_cgc.get("nothing.3dm")


@pytest.mark.nightly
def test_the_site_builds_without_a_warning(tmp_path, monkeypatch):
    mkdocs = pytest.importorskip("mkdocs.commands.build", reason="the extra docs is not installed")
    pytest.importorskip("mkdocstrings", reason="the extra docs is not installed")
    from mkdocs.config import load_config

    monkeypatch.setenv("NO_MKDOCS_2_WARNING", "1")
    config = load_config(str(ROOT / "mkdocs.yml"), strict=True, site_dir=str(tmp_path / "site"))
    mkdocs.build(config)
    assert "nine_regions.png" in (tmp_path / "site" / "index.html").read_text(encoding="utf-8")
    assert 'id="compas_cgc.solve"' in (tmp_path / "site" / "api" / "compas_cgc.html").read_text(encoding="utf-8")
