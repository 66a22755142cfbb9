"""What lets others carry on: the version in one place, workflows that name what there is, pages for contributors."""

from __future__ import annotations

import re
import sys
from fnmatch import fnmatch
from pathlib import Path

import pytest

import compas_cgc

ROOT = Path(__file__).parents[2]
WORKFLOWS = sorted((ROOT / ".github" / "workflows").glob("*.yml"))
yaml = pytest.importorskip("yaml")


def test_the_tool_for_versions_finds_every_place():
    tomllib = pytest.importorskip("tomllib") if sys.version_info >= (3, 11) else pytest.importorskip("tomli")
    own = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["tool"]["bumpversion"]
    assert own["current_version"] == compas_cgc.__version__
    for place in own["files"]:
        search = place.get("search", "{current_version}").replace("{current_version}", compas_cgc.__version__)
        assert (ROOT / place["filename"]).read_text(encoding="utf-8").count(search) == 1, place["filename"]


def test_no_folder_of_tests_is_left_out(pytestconfig):
    folders = {part for path in (ROOT / "tests").rglob("test_*.py") for part in path.relative_to(ROOT).parts[:-1]}
    assert "build" in folders
    assert not [name for name in folders for pattern in pytestconfig.getini("norecursedirs") if fnmatch(name, pattern)]


@pytest.mark.parametrize("path", WORKFLOWS, ids=lambda path: path.stem)
def test_a_workflow_is_well_formed(path):
    flow = yaml.safe_load(path.read_text(encoding="utf-8"))
    jobs = flow["jobs"]
    assert flow["permissions"] == {"contents": "read"}, "jobs that need more say so themselves"
    for name, job in jobs.items():
        needs = job.get("needs", [])
        assert set([needs] if isinstance(needs, str) else needs) <= set(jobs), name
        assert job["runs-on"] and job["steps"]
        for step in job["steps"]:
            assert ("uses" in step) != ("run" in step), step
            assert "uses" not in step or re.fullmatch(r"[\w./-]+@[\w./-]+", step["uses"])
        matrix = job.get("strategy", {}).get("matrix", {})
        assert set(re.findall(r"matrix\.(\w+)", str(job))) <= set(matrix), name


def test_workflows_name_what_there_is():
    text = "".join(path.read_text(encoding="utf-8") for path in WORKFLOWS)
    extras = re.findall(r'"?\.\[(\w+)\]', text)
    declared = (ROOT / "pyproject.toml").read_text(encoding="utf-8")
    assert extras and all(re.search(rf"^{extra} = \[", declared, re.MULTILINE) for extra in extras)
    for script in re.findall(r"run: (\.github/\S+|examples/\S+)", text) + re.findall(r"(examples/\S+\.3dm)", text):
        assert (ROOT / script).exists(), script
    from compas_cgc.cli.main import COMMANDS

    assert set(re.findall(r"(?:compas-cgc|-m compas_cgc) ([a-z]+)", text)) <= set(COMMANDS)


@pytest.mark.parametrize("path", sorted((ROOT / ".github" / "ISSUE_TEMPLATE").glob("*.yml")), ids=lambda path: path.stem)
def test_issue_forms_are_well_formed(path):
    form = yaml.safe_load(path.read_text(encoding="utf-8"))
    if path.stem == "config":
        assert all(link["url"].startswith("https://") for link in form["contact_links"])
        return
    assert form["name"] and form["description"]
    ids = [field["id"] for field in form["body"] if field["type"] != "markdown"]
    assert len(ids) == len(set(ids)) and all(field["attributes"]["label"] for field in form["body"])


def test_what_a_newcomer_to_a_repository_looks_for_is_there():
    for name in ("CONTRIBUTING.md", "CODE_OF_CONDUCT.md", "SECURITY.md", "LICENSE", "CITATION.cff", ".github/pull_request_template.md"):
        assert len((ROOT / name).read_text(encoding="utf-8")) > 200, name
    assert yaml.safe_load((ROOT / ".pre-commit-config.yaml").read_text(encoding="utf-8"))["repos"]
