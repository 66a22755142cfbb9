"""Blocks: consecutive variants that one worker solves in one go, the unit of work of a study.

Which variants make a block depends on the study alone, and no block knows of another, so that the table is the same to the last bit
however many workers there are.
"""

from __future__ import annotations

import pickle
from collections import OrderedDict

from ..execution.worker import report
from ..execution.worker import stop_wanted
from .variants import Measured
from .variants import Plan

__all__ = ["solve_block"]

PLANS = 2  # that a worker keeps

_plans: OrderedDict[str, Plan] = OrderedDict()


def solve_block(digest: str, content: bytes, first: int, last: int, alone: bool = False) -> list[Measured]:
    """Return what was measured of the variants from the first up to, without, the last.

    Parameters
    ----------
    digest, content
        Name of the study, and itself with its drawing as bytes, which are read once.
    first, last
        Numbers of variants.
    alone
        Whether each is solved without looking at others of its block, one of which may end the process.
    """
    plan = _plans.get(digest)
    if plan is None:
        plan = _plans[digest] = Plan(*pickle.loads(content))
        if len(_plans) > PLANS:
            _plans.popitem(last=False)
    done = []
    for variant in range(first, last):
        if stop_wanted():
            break
        done.append(plan.measured(variant, alone))
        report({"variants": len(done)})
    return done
