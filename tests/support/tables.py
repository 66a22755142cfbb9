"""Rows and notes of the tables that workshops receive as CSV."""

from __future__ import annotations

import csv
from collections.abc import Iterable


def rows_and_notes(lines: Iterable[str]) -> tuple[list[dict[str, str]], list[str]]:
    """Return the rows of a table without its column of notes, and the notes, which have rows of their own after them."""
    rows = list(csv.DictReader(lines))
    notes = [row.pop("notes") for row in rows]
    count = len(notes) - sum(map(bool, notes))
    assert not any(notes[:count]) and all(notes[count:])
    assert all(any(row.values()) == (k < count) for k, row in enumerate(rows))
    return rows[:count], notes[count:]
