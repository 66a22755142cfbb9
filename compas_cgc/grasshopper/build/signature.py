"""Check of the inputs and outputs in the code of a component against its metadata."""

from __future__ import annotations

import ast
import re
from typing import Optional

__all__ = ["run_script", "signature_problems"]

ENVIRONMENT = re.compile(r"^# venv: compas_cgc$", re.MULTILINE)


def signature_problems(code: str, inputs: list[str], outputs: list[str]) -> list[str]:
    """Return the differences between ``RunScript`` and the declared inputs and outputs.

    Parameters
    ----------
    code
        Source of the component, for Rhino 8's Python 3.9.
    inputs, outputs
        Names in the order of the metadata.
    """
    try:
        tree = ast.parse(code, feature_version=(3, 9))
    except SyntaxError as error:
        return [f"code.py is not valid Python 3.9: {error}"]
    problems = []
    if not code.startswith("#! python 3\n"):
        problems.append("code.py must begin with the line '#! python 3'")
    if not ENVIRONMENT.search(code):
        problems.append("code.py must name the environment of the package in a line '# venv: compas_cgc'")
    function = run_script(tree)
    if function is None:
        return [*problems, "code.py must have one class with a method RunScript"]
    own = [argument.arg for argument in function.args.args]
    if own != ["self", *inputs]:
        problems.append(f"RunScript takes {own[1:]}, but the metadata declare the inputs {inputs}")
    for node in ast.walk(function):
        if isinstance(node, ast.Return):
            returned = [_name(part) for part in node.value.elts] if isinstance(node.value, ast.Tuple) else [_name(node.value)]
            if returned != outputs:
                problems.append(f"RunScript returns {returned}, but the metadata declare the outputs {outputs}")
    if not any(isinstance(node, ast.Return) for node in ast.walk(function)):
        problems.append("RunScript returns nothing")
    return problems


def run_script(tree: ast.Module) -> Optional[ast.FunctionDef]:
    """Return the method ``RunScript`` of the only class, or None."""
    classes = [node for node in tree.body if isinstance(node, ast.ClassDef)]
    if len(classes) != 1:
        return None
    methods = (node for node in classes[0].body if isinstance(node, ast.FunctionDef) and node.name == "RunScript")
    return next(methods, None)


def _name(node: Optional[ast.AST]) -> Optional[str]:
    """Return the name of a returned variable or attribute."""
    if isinstance(node, ast.Name):
        return node.id
    return node.attr if isinstance(node, ast.Attribute) else None
