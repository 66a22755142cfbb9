"""Argument parser that reports a mistake in one sentence instead of a screen of options."""

from __future__ import annotations

import argparse
import re
import sys
from collections.abc import Sequence
from typing import Any
from typing import NoReturn
from typing import cast

from ..errors import nearest_name
from .exits import REFUSED

__all__ = ["Parser", "count"]

# Synonyms that are not similar to the name of the option.
SYNONYMS = {"k": "--target", "curvature": "--target", "fix": "--supports", "fixed": "--supports", "mesh-size": "--edge-length"}


def _listed(names: str, last: str) -> str:
    return f"{', '.join(names.split())} and {last}"


class Parser(argparse.ArgumentParser):
    """Parser whose errors name the wrong argument, suggest an option, and refer to the help."""

    def __init__(self, *args: Any, **options: Any):
        super().__init__(*args, **options)
        # Before Python 3.14 argparse takes -1e-2 for an option, and lengths such as -25mm in every version.
        self._negative_number_matcher = re.compile(r"^-(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?[a-zA-Z]*$")

    def error(self, message: str) -> NoReturn:
        """Print one sentence and exit."""
        text = re.sub(r"argument (\S+): ", r"\1: ", message)
        text = re.sub(r"invalid (?:int|float|_?\w+) value: (.*)", r"\1 is not a number; use a decimal point", text)
        text = text.replace("expected one argument", "expects a value")
        text = text.replace("the following arguments are required", "missing")
        text = re.sub(r"one of the arguments (.*) (\S+) is required", lambda match: f"missing: one of {_listed(*match.groups())}", text)
        text = text.replace("unrecognized arguments", "unknown arguments")
        print(f"{self.prog}: {text}; see {self.prog} --help", file=sys.stderr)
        sys.exit(REFUSED)

    def refuse_unknown(self, unknown: Sequence[str]) -> NoReturn:
        """Report the first unknown option and suggest a known one."""
        first = next((text for text in unknown if text.startswith("-")), None)
        if first is None:
            self.error(f"unexpected argument {' '.join(unknown)}; put names that contain spaces in quotation marks")
        known = [option for action in self._actions for option in action.option_strings if option.startswith("--")]
        name = first.split("=")[0].replace("_", "-")
        other = SYNONYMS.get(name.lstrip("-").lower())
        near = other if other in known else nearest_name(name, known)
        self.error(f"unknown option {first}" + ("" if near is None else f", did you mean {near}?"))

    def of(self, command: str) -> Parser:
        """Return the parser of a command, or this parser if the command is unknown."""
        for action in self._actions:
            if isinstance(action, argparse._SubParsersAction) and command in action.choices:
                return cast(Parser, action.choices[command])
        return self


def count(text: str) -> int:
    """Return a number from 1 up."""
    if not text.isdecimal() or int(text) < 1:
        raise argparse.ArgumentTypeError(f"must be a whole number from 1 up, not {text!r}")
    return int(text)
