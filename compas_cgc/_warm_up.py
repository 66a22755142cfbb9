"""Warm-up: compiles and stores every kernel."""

from __future__ import annotations

from collections.abc import Callable
from collections.abc import Iterator
from functools import partial
from typing import TYPE_CHECKING
from typing import Any
from typing import Optional

if TYPE_CHECKING:
    from .datastructures import CGCMesh

__all__ = ["is_warm", "warm_up"]


def is_warm() -> bool:
    """Check whether the kernels of this version have been compiled on this machine."""
    from ._compiled import is_stored
    from .discrete._kernels import write_cross_vectors

    return is_stored(write_cross_vectors)


def warm_up(told: Optional[Callable[[float], object]] = None, builds: bool = False) -> int:
    """Compile and store the kernels; those already stored are only loaded.

    Parameters
    ----------
    told
        Called with the completed fraction, from 0 to 1.
    builds
        Whether to include the kernels of pieces, moulds and nets; processes that mostly solve load these when they need them.

    Returns
    -------
    int
        Number of calls.
    """
    calls = [*_calls(), *([_built] if builds else [])]
    for done, call in enumerate(calls):
        if told is not None:
            told(done / len(calls))
        call()
    if told is not None:
        told(1.0)
    return len(calls)


def _calls() -> Iterator[Callable[[], object]]:
    """Yield calls that together use every kernel of a solve, its analysis and its checks."""
    from .solvers.registry import METHODS

    for method in METHODS:
        yield partial(_solved, _dome, method=method)
    yield partial(_solved, _folded)
    for method, measure in (("projection", "smooth"), ("projection", "exact"), ("newton", "exact")):
        yield partial(_solved, _folded if method == "projection" else _dome, settings={"measure": measure}, method=method)
    yield partial(_solved, _folded, settings={"energy": "cotangent"}, method="flow")
    yield _ordered
    yield _drawn
    yield _carried


def _dome() -> CGCMesh:
    from .datastructures import CGCMesh

    mesh = CGCMesh.from_meshgrid(dx=5, nx=5)
    mesh.set_supports("boundary")
    mesh.set_target(0.01)
    return mesh


def _folded() -> CGCMesh:
    mesh = _dome()
    mesh.set_supports("corners")
    mesh.set_creases([[6 * i + 2 for i in range(6)]])
    return mesh


def _solved(drawn: Callable[[], CGCMesh], **options: Any) -> None:
    from .analysis import analyse
    from .solvers.run import solve

    analyse(solve(drawn(), **options))


def _ordered() -> None:
    from scipy import sparse

    from .linalg import nested_dissection

    chain = sparse.diags([1.0, 2.0, 1.0], [-1, 0, 1], shape=(20, 20), format="csr")
    nested_dissection(chain)


def _drawn() -> None:
    """Compile the kernels used to read drawings and to draw pictures."""
    import numpy as np

    from .discrete import energy_gradient
    from .meshing.valence_annealing import annealed
    from .meshing.visibility import in_sight

    vertices, faces = _dome().arrays()
    annealed(vertices[:, :2], faces, np.zeros(len(vertices), bool), np.zeros((0, 2), np.int64), lambda places: np.ones(len(places)))
    energy_gradient(vertices, faces, 0.01)
    in_sight(vertices, vertices, faces)


def _carried() -> None:
    """Compile the kernels used to find and carry over surfaces on other meshes."""
    from .solvers.coarse import laid_out_anew

    mesh = _dome()
    mesh.set_supports("boundary")
    other = laid_out_anew(mesh.to_problem(), 20)
    assert other is not None
    other.carried(other.problem.vertices)


def _built() -> None:
    """Compile the kernels used for pieces, moulds and nets of curves."""
    from .fabrication import curve_net
    from .fabrication import moulds
    from .fabrication import panels
    from .fabrication import unroll
    from .solvers.run import solve

    roof = solve(_dome())
    moulds(roof, panels(roof, count=2), material="timber")
    unroll(roof, (3.0, 3.0), strain=0.1)
    curve_net(roof, 1.0)
    saddle = _dome()
    saddle.set_supports("corners")
    curve_net(solve(saddle, targets=-0.01), 1.0)
