"""Messages that carry their remedies."""

from __future__ import annotations

from compas_cgc.errors import Sentence
from compas_cgc.errors import allow_more_steps
from compas_cgc.errors import joined
from compas_cgc.errors import more_steps
from compas_cgc.errors import scaled
from compas_cgc.errors import without_more_steps


def test_the_remedy_for_a_limit_of_steps_goes_from_text_and_remedies_and_others_stay():
    said = joined([allow_more_steps("not converged in 20 steps", 20), Sentence("K̄ up to 3; the target is 6", [scaled(0.5)])])
    assert said.startswith("not converged in 20 steps; allow more steps; K̄") and said.remedies == (more_steps(20), scaled(0.5))
    without = without_more_steps(said)
    assert without == "not converged in 20 steps; K̄ up to 3; the target is 6"
    assert without.remedies == (scaled(0.5),)
    assert without_more_steps("converged") == "converged"
