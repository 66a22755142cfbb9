"""Docstrings of all public names: what goes in, what comes out, and an example that runs."""

from __future__ import annotations

import dataclasses
import importlib
import inspect
import pkgutil
import re

import pytest

import compas_cgc

# Doors: components are documented on the canvas, commands by their help.
LEFT_OUT = {"compas_cgc.cli", "compas_cgc.grasshopper.components"}


def public() -> dict[str, object]:
    """Return classes and functions that are public names of packages, each under one name."""
    packages = ["compas_cgc", *(own.name for own in pkgutil.walk_packages(compas_cgc.__path__, "compas_cgc.") if own.ispkg)]
    found: dict[int, tuple[str, object]] = {}
    for package in packages:
        if package in LEFT_OUT or any(part.startswith("_") for part in package.split(".")[1:]):
            continue
        module = importlib.import_module(package)
        for name in getattr(module, "__all__", ()):
            value = getattr(module, name)
            if (inspect.isclass(value) or inspect.isroutine(value)) and str(value.__module__).startswith("compas_cgc"):
                found.setdefault(id(value), (f"{package}.{name}", value))
    return dict(found.values())


PUBLIC = public()


def sections(doc: str) -> dict[str, str]:
    """Return the sections of a numpydoc docstring by their titles."""
    parts = re.split(r"^(\w[\w ]*)\n-{3,}\n", inspect.cleandoc(doc), flags=re.MULTILINE)
    return dict(zip(parts[1::2], parts[2::2]))


def described(text: str) -> set[str]:
    """Return the names that a section describes."""
    heads = [line for line in text.splitlines() if line and not line.startswith(" ")]
    return {name.strip().lstrip("*") for head in heads for name in head.split(":")[0].split(",")}


def taken(value: object) -> list[str]:
    """Return the names of what a function or a class takes."""
    if inspect.isclass(value) and issubclass(value, BaseException) and value.__init__ is BaseException.__init__:
        return []
    if dataclasses.is_dataclass(value):
        return [field.name for field in dataclasses.fields(value) if field.init]
    try:
        names = list(inspect.signature(value).parameters)
    except (TypeError, ValueError):
        return []
    return [name for name in names if name not in ("self", "cls", "args", "kwargs", "options")]


def lacking(value: object) -> list[str]:
    """Return what the docstring of a public name lacks, or has too much."""
    told = sections(value.__doc__ or "")
    known = set().union(*(described(told.get(title, "")) for title in ("Parameters", "Other Parameters", "Attributes")))
    missing = [f"the parameter {name}" for name in taken(value) if name not in known]
    if inspect.isroutine(value):
        takes = set(inspect.signature(value).parameters)
        missing += [f"no parameter {name}" for name in sorted(described(told.get("Parameters", "")) - takes)]
    if inspect.isroutine(value) and inspect.signature(value).return_annotation not in ("None", None, inspect.Signature.empty):
        missing += [] if "Returns" in told or "Yields" in told else ["Returns"]
    if not inspect.isclass(value) or not issubclass(value, BaseException):
        missing += [] if ">>> " in told.get("Examples", "") else ["an example"]
    return missing


@pytest.mark.parametrize("name", PUBLIC)
def test_a_public_name_is_documented(name):
    assert lacking(PUBLIC[name]) == []


if __name__ == "__main__":
    for name, value in PUBLIC.items():
        if lacking(value):
            print(name, lacking(value))
