"""Messages that carry their remedies, so that a user interface can offer each as a button."""

from __future__ import annotations

from collections.abc import Iterable
from typing import NamedTuple

__all__ = [
    "COARSER",
    "FINER",
    "FOUND",
    "HALVED",
    "HALF",
    "Remedy",
    "Sentence",
    "allow_more_steps",
    "joined",
    "more_steps",
    "scaled",
    "sentence_of",
    "use_method",
    "without_more_steps",
]

MORE_STEPS = 5  # factor of the number of steps
MARGIN = 0.95  # of the largest feasible K, which is found within 5 %
ALLOW = "; allow more steps"
HALF = 0.5  # factor of K where no feasible K is known; a search finds the largest one


class Remedy(NamedTuple):
    """A change of a problem that resolves the cause of a message."""

    field: str  # what to change, see the table of the server
    value: object  # plain data


FINER, COARSER = Remedy("edge_scale", 0.7), Remedy("edge_scale", 1.4)  # factor of the edge length of a new mesh
HALVED = Remedy("scale", HALF)  # factor of all targets
FOUND = Remedy("unknown", "all")  # K is solved for


def more_steps(steps: int) -> Remedy:
    """Return the remedy for a limit of steps that was reached."""
    return Remedy("settings", {"steps": MORE_STEPS * steps})


def use_method(name: str) -> Remedy:
    """Return the remedy for a method that does not suit a problem."""
    return Remedy("method", name)


def scaled(factor: float) -> Remedy:
    """Return the remedy for targets of which only a part is feasible."""
    return Remedy("scale", float(f"{MARGIN * factor:.3g}"))


class Sentence(str):
    """A message, or a part of one, with its remedies.

    Parameters
    ----------
    text
        The sentence.
    remedies
        Changes that resolve its cause, the most specific first.

    Examples
    --------
    >>> goal = Sentence("the rise 3", [Remedy("without", "rise")])
    >>> said = Sentence("{} is out of reach; remove it").format(goal)
    >>> said, said.remedies
    ('the rise 3 is out of reach; remove it', (Remedy(field='without', value='rise'),))
    """

    remedies: tuple[Remedy, ...]

    def __new__(cls, text: str, remedies: Iterable[Remedy] = ()) -> Sentence:
        """Return a sentence; the remedies of a given sentence are kept."""
        sentence = super().__new__(cls, text)
        sentence.remedies = (*getattr(text, "remedies", ()), *remedies)
        return sentence

    def format(self, *parts: object) -> Sentence:  # type: ignore[override]
        """Return the sentence with its parts filled in, and the remedies of all."""
        return Sentence(super().format(*parts), [*self.remedies, *(own for part in parts for own in getattr(part, "remedies", ()))])


def joined(parts: Iterable[str], between: str = "; ") -> Sentence:
    """Return sentences in a row, with the remedies of all."""
    parts = list(parts)
    return Sentence(between.join(parts), [own for part in parts for own in getattr(part, "remedies", ())])


def allow_more_steps(said: str, steps: int) -> Sentence:
    """Return a sentence on a limit of steps that was reached, with its remedy."""
    return Sentence(said + ALLOW, [more_steps(steps)])


def without_more_steps(said: str) -> Sentence:
    """Return a sentence without the remedy of :func:`allow_more_steps`, for a problem that no number of steps solves."""
    kept = [own for own in getattr(said, "remedies", ()) if own.field != more_steps(0).field]
    return Sentence(str(said).replace(ALLOW, ""), kept)


def sentence_of(error: BaseException) -> Sentence:
    """Return the message of an error with its remedies."""
    return Sentence(str(error), getattr(error.args[0], "remedies", ()) if error.args else ())
