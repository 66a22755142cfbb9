"""The examples of the paper that the page offers, in words for designers."""

from __future__ import annotations

from typing import NamedTuple

__all__ = ["GALLERY", "Entry"]


class Entry(NamedTuple):
    """One example on offer."""

    number: int  # of the paper
    variant: str  # of the paper
    title: str
    text: str  # one sentence

    @property
    def name(self) -> str:
        """Name of :attr:`compas_cgc.paper.examples.SurfaceExample.name`."""
        return f"example{self.number}_{self.variant}" if self.variant else f"example{self.number}"


_ENTRIES = (
    Entry(4, "a", "Nine fields", "Four corners hold nine fields; the one in the centre curves four times as much."),
    Entry(7, "a", "Curved creases", "Eight mirrored sectors fold along curved and straight creases and stand on four points."),
    Entry(6, "", "Free-form plan", "A dome over a drawn outline, its whole edge held."),
    Entry(3, "", "Sail on four corners", "A square held at its corners only; its edges find their own way."),
    Entry(2, "", "Pillow on a square", "A flat square with its edge held rises to one curvature."),
    Entry(5, "", "Developable cone", "A waisted ring straightens until it can be unrolled, K = 0."),
)

GALLERY = {entry.name: entry for entry in _ENTRIES}
