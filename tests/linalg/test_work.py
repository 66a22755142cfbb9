"""Work that is counted, by one search within another."""

from __future__ import annotations

from compas_cgc.linalg.work import CALL_OVERHEAD
from compas_cgc.linalg.work import Work
from compas_cgc.linalg.work import count
from compas_cgc.linalg.work import is_spent
from compas_cgc.linalg.work import rights
from compas_cgc.linalg.work import spend
from compas_cgc.linalg.work import until_spent


def paid(*amounts):
    for amount in amounts:
        spend(amount)
        yield amount


def test_what_a_search_within_another_takes_is_taken_off_both():
    whole, part = Work(10.0), Work(5.0)
    with whole.counted():
        with part.counted():
            assert list(until_spent(paid(2.0, 2.0, 2.0))) == [2.0, 2.0]
        assert not is_spent() and (whole.left, part.left) == (4.0, -1.0)
        with Work(100.0).counted():
            assert list(until_spent(paid(3.0, 3.0))) == [3.0]
            assert is_spent()


def test_steps_that_wait_for_a_search_that_uses_the_work_up_go_on_no_further():
    def steps():
        yield list(until_spent(paid(1.0, 1.0)))
        yield list(paid(1.0))

    with Work(1.5).counted():
        assert list(until_spent(steps())) == [[1.0]]
        assert list(until_spent(paid(0.0))) == []


def test_small_systems_take_what_every_call_does_and_what_is_finished_in_any_case_ends_no_steps():
    assert rights(1, 0) == CALL_OVERHEAD and rights(3, 3000) == 3 * (3000 + CALL_OVERHEAD)
    work = Work(1.0)
    with work.counted():
        count(2.0)
        assert is_spent() and work.left == -1.0
