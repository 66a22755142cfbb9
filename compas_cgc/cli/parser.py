"""The parser of arguments: a mistake is answered by one sentence, not by a screen of options."""

from __future__ import annotations

import argparse
import re
import sys
from collections.abc import Sequence
from difflib import get_close_matches
from typing import Any
from typing import NoReturn
from typing import Optional

from .exits import REFUSED

__all__ = ["Parser"]


class Parser(argparse.ArgumentParser):
    """Refuses arguments with what is wrong, what was likely meant, and where to read on."""

    def error(self, message: str) -> NoReturn:
        """Tell what is wrong and exit."""
        said = re.sub(r"argument (\S+): ", r"\1: ", message)
        said = re.sub(r"invalid (?:int|float|_?\w+) value: (.*)", r"\1 is not understood; give a number, with a point for decimals", said)
        said = said.replace("expected one argument", "a value is missing after it")
        said = said.replace("the following arguments are required", "still needed")
        said = said.replace("unrecognized arguments", "there is no such argument")
        print(f"{self.prog}: {said}; see {self.prog} --help", file=sys.stderr)
        sys.exit(REFUSED)

    def parse_args(self, args: Optional[Sequence[str]] = None, namespace: Any = None) -> Any:
        """Return the arguments; unknown ones are told with those that look like them."""
        found, unknown = self.parse_known_args(args, namespace)
        if unknown:
            self._called(args).refuse_unknown(unknown)
        return found

    def refuse_unknown(self, unknown: Sequence[str]) -> NoReturn:
        """Tell which arguments are unknown, and what was meant by the first."""
        first = next((text for text in unknown if text.startswith("-")), None)
        if first is None:
            self.error(f"{' '.join(unknown)} is too much; put names with spaces into quotation marks")
        known = [option for action in self._actions for option in action.option_strings if option.startswith("--")]
        near = get_close_matches(first.split("=")[0].replace("_", "-"), known, 1, 0.6)
        self.error(f"there is no argument {first}" + (f", did you mean {near[0]}?" if near else ""))

    def _called(self, args: Optional[Sequence[str]]) -> Parser:
        """Return the parser of the command that is called."""
        words = sys.argv[1:] if args is None else args
        for action in self._actions:
            if isinstance(action, argparse._SubParsersAction):
                return next((action.choices[word] for word in words if word in action.choices), self)
        return self
