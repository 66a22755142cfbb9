"""Examples of the paper on the page, described for designers."""

from __future__ import annotations

from typing import NamedTuple

__all__ = ["GALLERY", "Entry"]


class Entry(NamedTuple):
    """An example on the page."""

    number: int  # number in the paper
    variant: str  # variant in the paper
    title: str
    text: str  # one sentence

    @property
    def name(self) -> str:
        """Name of the example, see :attr:`compas_cgc.paper.examples.SurfaceExample.name`."""
        return f"example{self.number}_{self.variant}" if self.variant else f"example{self.number}"


_ENTRIES = (
    Entry(4, "a", "Nine fields", "Nine fields on four corner supports; the centre field has four times the curvature of the others."),
    Entry(7, "a", "Curved creases", "Eight mirrored sectors with curved and straight creases on four point supports."),
    Entry(6, "", "Free-form plan", "A dome over a drawn outline, supported along the whole edge."),
    Entry(3, "", "Sail on four corners", "A square supported at its corners only, with free edges."),
    Entry(2, "", "Pillow on a square", "A square with a fixed edge that rises to constant curvature."),
    Entry(5, "", "Developable cone", "A ring with a waist becomes developable, K = 0."),
)

GALLERY = {entry.name: entry for entry in _ENTRIES}
