"""Shares and budgets: greedy clients leave something for the next."""

from __future__ import annotations

import threading

import pytest

from compas_cgc.server.errors import Busy
from compas_cgc.server.jobs.shares import ByteBudget
from compas_cgc.server.jobs.shares import Shares


def taken(shares, client):
    count = 0
    while shares.acquire(client):
        count += 1
    return count


def test_a_client_alone_may_hold_two_thirds_and_ten_leave_some_for_the_eleventh():
    assert taken(Shares(64), "a") == 43
    shares, clients = Shares(64), [f"client-{k}" for k in range(10)]
    while sum(shares.acquire(client) for client in clients):
        pass
    assert shares.used < 64 and shares.acquire("eleventh")
    shares.release("eleventh")
    for client in clients:
        while shares._held[client]:
            shares.release(client)
    assert shares.used == 0 and taken(shares, "a") == 43


def test_two_slots_are_for_a_client_alone():
    assert taken(Shares(2), "a") == 2 and taken(Shares(1), "a") == 1


def test_bodies_wait_for_each_other_and_one_that_is_too_large_comes_alone():
    budget, order = ByteBudget(100, 10.0, 1, 4), []
    with budget.held(60):
        with budget.held(40):
            pass
        waits = threading.Thread(target=lambda: budget.held(200).__enter__() or order.append("large"))
        waits.start()
        order.append("small")
    waits.join()
    assert order == ["small", "large"]
    impatient = ByteBudget(100, 0.01, 1, 4)
    with pytest.raises(Busy, match="other large requests"), impatient.held(100), impatient.held(1):
        raise AssertionError("it is let in")


def test_waiting_bodies_of_a_client_leave_slots_for_others_and_small_ones_need_none():
    budget = ByteBudget(1000, 10.0, 10, 3)
    with budget.held(11, "a"), budget.held(11, "a"):
        with pytest.raises(Busy), budget.held(11, "a"):
            raise AssertionError("it is let in")
        with budget.held(10, "a"), budget.held(11, "b"):
            pass
