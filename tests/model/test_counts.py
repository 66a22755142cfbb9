"""Numbers of things in words."""

from compas_cgc.model.counts import MAX_LISTED
from compas_cgc.model.counts import listed


def test_the_first_names_of_long_lists_are_written_with_the_number_of_others():
    names = [f"A{k}" for k in range(MAX_LISTED + 2)]
    assert listed(names[:3], "see the table") == "A0, A1, A2"
    assert listed(names[:-2], "see the table").endswith(f", A{MAX_LISTED - 1}")
    assert listed(names[:-1], "see the table").endswith(f", A{MAX_LISTED - 1} and 1 other (see the table)")
    assert listed(names, "see the table") == ", ".join(names[:-2]) + " and 2 others (see the table)"
