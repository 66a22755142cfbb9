"""Blocks: consecutive variants that one worker solves together, the unit of work of a study.

The blocks depend on the study only and are independent of each other, so that the table is bitwise identical for any number of
workers.
"""

from __future__ import annotations

import pickle
from collections import OrderedDict
from typing import Union

from ..execution.worker import report
from ..execution.worker import stop_wanted
from .designs import DesignPlan
from .designs import plan_of
from .variants import Measured
from .variants import Plan

__all__ = ["solve_block"]

PLANS = 2  # number of plans cached by a worker

_plans: OrderedDict[str, Union[Plan, DesignPlan]] = OrderedDict()


def solve_block(digest: str, content: bytes, first: int, last: int) -> list[Measured]:
    """Return the rows and surfaces of the variants from `first` up to, but not including, `last`.

    Parameters
    ----------
    digest, content
        Digest of the study, and the study with its drawing as bytes, which are decoded once.
    first, last
        Numbers of variants.
    """
    plan = _plans.get(digest)
    if plan is None:
        plan = _plans[digest] = plan_of(*pickle.loads(content))
        if len(_plans) > PLANS:
            _plans.popitem(last=False)
    done = []
    for variant in range(first, last):
        if stop_wanted():
            break
        done.append(plan.measured(variant))
        report({"variants": len(done)})
    return done
