"""The package as a whole: layers, imports, README."""

from __future__ import annotations

import re
import subprocess
import sys
from pathlib import Path

import pytest

import compas_cgc

ROOT = Path(__file__).parents[2]


def test_importing_the_package_loads_nothing_heavy():
    code = (
        "import sys, compas_cgc; print(sorted({'numpy', 'scipy', 'numba', 'compas', 'rhino3dm', 'flask', 'matplotlib'} & set(sys.modules)))"
    )
    out = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True, cwd=ROOT)
    assert out.stdout.strip() == "[]"


def test_the_command_line_helps_without_loading_the_solvers():
    code = (
        "import sys; from compas_cgc.cli.main import build_parser; build_parser(); print('numba' in sys.modules or 'compas' in sys.modules)"
    )
    out = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True, cwd=ROOT)
    assert out.stdout.strip() == "False"


def test_public_names_are_there():
    for name in compas_cgc.__all__:
        assert getattr(compas_cgc, name) is not None
    with pytest.raises(AttributeError, match="no attribute 'nothing'"):
        compas_cgc.nothing  # noqa: B018


@pytest.mark.parametrize(("wrong", "right"), [("fabricaton", "fabrication"), ("CGCMash", "CGCMesh"), ("sovle", "solve")])
def test_a_misspelt_name_gets_the_one_that_was_meant(wrong, right):
    with pytest.raises(AttributeError, match=f"no attribute '{wrong}'; did you mean '{right}'"):
        getattr(compas_cgc, wrong)


@pytest.mark.parametrize("name", ["__wrapped__", "_repr_html_"])
def test_names_that_tools_ask_for_are_simply_not_there(name):
    with pytest.raises(AttributeError, match=f"no attribute '{name}'$"):
        getattr(compas_cgc, name)


def test_a_module_that_is_no_package_has_no_path():
    # What ``from module import name`` asks for where names are looked up lazily.
    code = "from compas_cgc.io.rhino import rhinocommon; print(hasattr(rhinocommon, '__path__'))"
    out = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True, cwd=ROOT)
    assert out.stdout.strip() == "False"


def test_the_readme_script_runs(tmp_path, monkeypatch, capsys):
    (script,) = re.findall(r"```python\n(.*?)```", (ROOT / "README.md").read_text(encoding="utf-8"), re.DOTALL)
    monkeypatch.chdir(tmp_path)
    exec(compile(script, "README.md", "exec"), {})
    assert capsys.readouterr().out.count("converged") == 1
    assert (tmp_path / "roof.json").exists()


def test_pictures_and_pages_that_the_documents_name_are_there():
    for page in [ROOT / "README.md", *(ROOT / "docs").glob("*.md")]:
        for target in re.findall(r"\]\((?!https?:)([^)#]+)\)", page.read_text(encoding="utf-8")):
            assert (page.parent / target).exists(), f"{page.name} names {target}"
