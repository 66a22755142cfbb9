"""Compiled shape operators of triangles by the normals at the middles of their edges, with two derivatives."""

from __future__ import annotations

import numpy as np

from .._compiled import kernel
from ._taylor import BLOCK
from ._taylor import PAIRS
from ._taylor import SECOND
from ._taylor import Expressions
from ._taylor import evaluate
from .arrays import Faces
from .arrays import FloatArray
from .arrays import IntArray
from .arrays import Vectors
from .arrays import Vertices

__all__ = ["expanded"]


def _parts(own: Expressions) -> list[int]:
    """Return the rows of what a face contributes; the first inputs are its edges, the next ones the reference directions of these.

    Of each edge the angle of the reference direction, from the normal outwards; of each edge ``(e x c)(e x c)^T / (l |c|^2)`` with its
    vector e, its length l and the cross product c of two edges; and |c|, twice the area.
    """
    edges, references = [own.inputs(3) for _ in range(3)], [own.inputs(3) for _ in range(3)]
    c = own.cross(edges[0], edges[1])
    double = own.root(own.dot(c, c))
    by_double = own.inverse(double)
    angles, tensors = [], []
    for e, reference in zip(edges, references):
        side, length = own.cross(e, c), own.root(own.dot(e, e))
        across = own.product(length, own.component(reference, c))
        tangent = own.product(own.component(reference, side), own.inverse(across))
        angles.append(own.angle(tangent, across))
        scale = own.product(own.inverse(own.root(length)), by_double)
        m = [own.product(x, scale) for x in side]
        tensors += [own.product(m[x], m[y]) for x in range(3) for y in range(x, 3)]
    return [*angles, *tensors, double]


_expressions = Expressions()
_outputs = np.array(_parts(_expressions))
_operations = _expressions.operations


def expanded(V: Vertices, F: Faces, U: Vectors, R: Vectors, index: IntArray, orders: int) -> FloatArray:
    """Return what every face contributes (m, 22, orders), as functions of the moves of its corners along their directions.

    Three angles of references, three tensors of six entries, and the area, up to first derivatives for 4 orders, up to second ones for 10.
    """
    out = np.empty((len(F), len(_outputs), orders))
    work = np.zeros((_expressions.rows + 1, SECOND, BLOCK))
    _expand(V, F, U, R, index, _operations, PAIRS, _outputs, work, out)
    return out


@kernel()
def _expand(
    V: Vertices,
    F: Faces,
    U: Vectors,
    R: Vectors,
    index: IntArray,
    operations: IntArray,
    pairs: IntArray,
    outputs: IntArray,
    W: FloatArray,
    out: FloatArray,
) -> None:
    """Write the parts of all faces into `out`, a block of faces after the other; the last block ends with copies of the last face."""
    m, last = len(F), len(outputs) - 1
    for first in range(0, m, BLOCK):
        for lane in range(BLOCK):
            f = min(first + lane, m - 1)
            for k in range(3):
                p, q = F[f, (k + 1) % 3], F[f, (k + 2) % 3]
                for x in range(3):
                    edge = W[3 * k + x]
                    edge[0, lane] = V[q, x] - V[p, x]
                    edge[1 + (k + 1) % 3, lane] = -U[p, x]
                    edge[1 + (k + 2) % 3, lane] = U[q, x]
                    W[9 + 3 * k + x, 0, lane] = R[index[f, k], x]
        evaluate(operations, pairs, out.shape[2], W)
        for lane in range(min(BLOCK, m - first)):
            for at in range(out.shape[2]):
                for k in range(last):
                    out[first + lane, k, at] = W[outputs[k], at, lane]
                out[first + lane, last, at] = 0.5 * W[outputs[last], at, lane]
