"""Tasks of a COMPAS package: ``invoke --list`` names them, ``invoke test`` runs one."""

from __future__ import annotations

from pathlib import Path

from invoke import task

HERE = Path(__file__).parent


@task
def lint(ctx):
    """Check the style and the types."""
    with ctx.cd(HERE):
        ctx.run("ruff check . && ruff format --check . && mypy")


@task
def format(ctx):
    """Format the code."""
    with ctx.cd(HERE):
        ctx.run("ruff check --fix . && ruff format .")


@task(help={"nightly": "also run the long tests", "path": "folder or file of tests"})
def test(ctx, nightly=False, path="tests"):
    """Run the tests."""
    with ctx.cd(HERE):
        ctx.run(f"python -m pytest {path} {'-m' if nightly else ''} {chr(34) * 2 if nightly else ''}")


@task(help={"folder": "folder for the pages"})
def docs(ctx, folder="site"):
    """Build the manual."""
    with ctx.cd(HERE):
        ctx.run(f"mkdocs build --strict --site-dir {folder}", env={"NO_MKDOCS_2_WARNING": "1"})


@task(help={"folder": "folder for the components, the definitions and the yak package"})
def components(ctx, folder="dist/grasshopper"):
    """Build the Grasshopper components, the example definitions and the yak package."""
    with ctx.cd(HERE):
        ctx.run(f"compas-cgc grasshopper build {folder}")


@task
def build(ctx):
    """Build the source distribution and the wheel."""
    with ctx.cd(HERE):
        ctx.run("python -m build")
