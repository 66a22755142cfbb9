"""The parser of arguments: a mistake is answered by one sentence, not by a screen of options."""

from __future__ import annotations

import argparse
import re
import sys
from collections.abc import Sequence
from typing import NoReturn
from typing import cast

from ..errors import nearest_name
from .exits import REFUSED

__all__ = ["Parser"]

# What people write for an argument whose name is not like it.
OTHER_WORDS = {"k": "--target", "curvature": "--target", "fix": "--supports", "fixed": "--supports", "mesh-size": "--edge-length"}


def _listed(names: str, last: str) -> str:
    return f"{', '.join(names.split())} and {last}"


class Parser(argparse.ArgumentParser):
    """Refuses arguments with what is wrong, what was likely meant, and where to read on."""

    def error(self, message: str) -> NoReturn:
        """Tell what is wrong and exit."""
        said = re.sub(r"argument (\S+): ", r"\1: ", message)
        said = re.sub(r"invalid (?:int|float|_?\w+) value: (.*)", r"\1 is not understood; give a number, with a point for decimals", said)
        said = said.replace("expected one argument", "a value is missing after it")
        said = said.replace("the following arguments are required", "still needed")
        said = re.sub(
            r"one of the arguments (.*) (\S+) is required", lambda found: f"still needed: one of {_listed(*found.groups())}", said
        )
        said = said.replace("unrecognized arguments", "there is no such argument")
        print(f"{self.prog}: {said}; see {self.prog} --help", file=sys.stderr)
        sys.exit(REFUSED)

    def refuse_unknown(self, unknown: Sequence[str]) -> NoReturn:
        """Tell which arguments are unknown, and what was meant by the first."""
        first = next((text for text in unknown if text.startswith("-")), None)
        if first is None:
            self.error(f"{' '.join(unknown)} is too much; put names with spaces into quotation marks")
        known = [option for action in self._actions for option in action.option_strings if option.startswith("--")]
        name = first.split("=")[0].replace("_", "-")
        other = OTHER_WORDS.get(name.lstrip("-").lower())
        near = other if other in known else nearest_name(name, known)
        self.error(f"there is no argument {first}" + ("" if near is None else f", did you mean {near}?"))

    def of(self, command: str) -> Parser:
        """Return the parser of a command, or this one where there is no such command."""
        for action in self._actions:
            if isinstance(action, argparse._SubParsersAction) and command in action.choices:
                return cast(Parser, action.choices[command])
        return self
