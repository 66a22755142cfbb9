"""Surfaces of K = -1 from the angles along two asymptotic curves, fitted to points."""

from __future__ import annotations

from typing import NamedTuple
from typing import Optional

import numpy as np
from scipy import sparse
from scipy.interpolate import RectBivariateSpline
from scipy.interpolate import make_interp_spline
from scipy.spatial import cKDTree

from ..._compiled import kernel
from ...discrete.arrays import FloatArray

__all__ = ["KSurface", "fit_k_surface"]

MARGIN = 0.03  # of the parameter domain beyond the points [1/sqrt(-K)]
MIN_KNOTS, MAX_KNOTS = 6, 20  # of the angle along an asymptotic curve
KNOT = 0.15  # distance of knots [1/sqrt(-K)]
STEPS_PER_KNOT = 8  # of integration
STEP = 1e-5  # of difference quotients
SMOOTHING = 1e-4  # weight of second differences of the angles against distances
DAMPING = 1e-2  # first damping of Levenberg and Marquardt
ROUNDS, TRIALS = 12, 6  # of least squares, and of damping in one round
CONVERGED = 1e-5  # relative change of the sum of squares below which the fit stops
MIN_AREA = 1e-3  # of the parallelogram of unit tangents
FOOT_STEPS = 3  # of moving coordinates to the foot of a point


class KSurface(NamedTuple):
    """A surface of constant K < 0 in asymptotic coordinates, which are arc lengths."""

    u: FloatArray  # (n,) along the first family [L]
    v: FloatArray  # (m,) along the second family [L]
    points: FloatArray  # (n, m, 3) [L]
    angles: FloatArray  # (n, m) from the first family to the second [rad]
    at: FloatArray  # (k, 2) coordinates of the fitted points [L]
    off: FloatArray  # (k,) distances of the fitted points [L]

    def values(self, at: FloatArray, du: int = 0, dv: int = 0) -> FloatArray:
        """Return the points at coordinates (k, 2), or their derivatives (k, 3)."""
        splines = [RectBivariateSpline(self.u, self.v, self.points[:, :, k]) for k in range(3)]
        return np.column_stack([spline.ev(*at.T, dx=du, dy=dv) for spline in splines])

    def feet(self, points: FloatArray) -> FloatArray:
        """Return the coordinates (k, 2) of the points of the surface nearest to points (k, 3) [L]."""
        m = len(self.v)
        near = cKDTree(self.points.reshape(-1, 3)).query(points)[1]
        at = np.column_stack([self.u[near // m], self.v[near % m]])
        for _ in range(FOOT_STEPS):
            at = at + _foot_move(self.values(at, 1, 0), self.values(at, 0, 1), points - self.values(at))
        return at


class _Problem(NamedTuple):
    """Points and the grid of the fit, in units of 1/sqrt(-K)."""

    points: FloatArray  # (k, 3)
    grids: tuple[FloatArray, FloatArray]  # coordinates, 0 among them
    knots: tuple[FloatArray, FloatArray]
    frame: FloatArray  # (3, 3) first tangent, left and normal at the origin
    origin: FloatArray  # (3,)
    twist: float  # 1 or -1, torsion of the first family


class _State(NamedTuple):
    """Unknowns of the fit with their surface."""

    unknowns: FloatArray  # angles at the knots of both curves, rotation vector and shift
    at: FloatArray  # (k, 2) coordinates of the points
    points: FloatArray  # (k, 3) on the surface
    normals: FloatArray  # (k, 3)
    surface: tuple[FloatArray, FloatArray]  # points and angles on the grid

    def residual(self, given: FloatArray) -> FloatArray:
        """Return the distances of given points along the normals (k,)."""
        return np.einsum("ki,ki->k", self.points - given, self.normals)


def fit_k_surface(
    points: FloatArray, at: FloatArray, angles: FloatArray, frame: FloatArray, K: float, origin: FloatArray
) -> Optional[KSurface]:
    r"""Return the surface of constant K < 0 nearest to points, None if the fit does not converge.

    In asymptotic coordinates, which are arc lengths, the angle :math:`\omega` between the curves satisfies the sine-Gordon equation
    :math:`\omega_{uv} = -K \sin \omega`. It is given by its values along the two curves through the origin (Goursat problem). A frame
    with geodesic curvatures :math:`-\omega_u` and :math:`\omega_v` and torsions :math:`\pm\sqrt{-K}` is carried along the curves.

    Parameters
    ----------
    points
        (k, 3) [L].
    at
        (k, 2) approximate asymptotic coordinates [L].
    angles
        (k,) approximate angles between the families [rad].
    frame
        (3, 3) approximate tangent of the first family at (0, 0), the direction to its left, and the normal; the second family is to the
        left.
    K
        Gaussian curvature [1/L^2].
    origin
        (3,) approximate point at (0, 0) [L].

    References
    ----------
    Eisenhart, *A treatise on the differential geometry of curves and surfaces* (1909), section 119.
    """
    scale = float(np.sqrt(-K))
    given, start = scale * points, scale * at
    grids, knots = zip(*(_grid(start[:, axis]) for axis in (0, 1)))
    first = np.concatenate([_along(knots[axis], start[:, axis], start[:, 1 - axis], angles) for axis in (0, 1)])
    unknowns = np.r_[first, np.zeros(6)]
    own = min(
        (_Problem(given, grids, knots, frame, scale * origin, twist) for twist in (1.0, -1.0)),
        key=lambda one: float(np.median(np.linalg.norm(_placed(one, unknowns, start)[0] - given, axis=1))),
    )
    state = _at_feet(own, unknowns, start)
    bends = _second_differences([len(each) for each in knots])
    smooth = SMOOTHING**2 * (bends.T @ bends)
    damping, cost = DAMPING, _cost(state, own, bends)
    for _ in range(ROUNDS):
        slopes = _slopes(own, state)
        for _ in range(TRIALS):
            damped = damping * np.r_[np.ones(len(first)), np.full(6, 1e-4)]
            step = np.linalg.solve(
                slopes.T @ slopes + smooth + np.diag(damped), -slopes.T @ state.residual(given) - smooth @ state.unknowns
            )
            tried = _at_feet(own, state.unknowns + step, state.at)
            reached = _cost(tried, own, bends)
            if reached < cost:
                break
            damping *= 8.0
        else:
            break
        done = cost - reached < CONVERGED * cost
        state, cost, damping = tried, reached, max(damping / 10.0, 1e-10)
        if done:
            break
    surface, omega = state.surface
    off = np.linalg.norm(state.points - given, axis=1)
    if not np.isfinite(surface).all() or not np.isfinite(off).all():
        return None
    # A shift of the coordinates does not change the surface; the mean of the points keeps its coordinates.
    shift = (state.at - start).mean(axis=0)
    u, v = ((grid - moved) / scale for grid, moved in zip(grids, shift))
    return KSurface(u, v, _moved(own, state.unknowns, surface) / scale, omega, (state.at - shift) / scale, off / scale)


def _grid(values: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return grid coordinates over values, 0 among them, and knots."""
    low, high = float(values.min()) - MARGIN, float(values.max()) + MARGIN
    count = int(np.clip(np.ceil((high - low) / KNOT), MIN_KNOTS, MAX_KNOTS))
    step = (high - low) / (count * STEPS_PER_KNOT)
    grid = step * np.arange(np.floor(low / step), np.ceil(high / step) + 1)
    return grid, np.linspace(grid[0], grid[-1], count + 1)


def _along(knots: FloatArray, along: FloatArray, across: FloatArray, angles: FloatArray) -> FloatArray:
    """Return the mean angle near the knots of a coordinate curve."""
    near = np.exp(-((along - knots[:, None]) ** 2 + across**2) / (2.0 * (0.3 * KNOT) ** 2))
    far = 1e-12 * np.exp(-((along - knots[:, None]) ** 2 + across**2) / 0.5)
    weights = near + far
    return weights @ angles / weights.sum(axis=1)


def _second_differences(counts: list[int]) -> FloatArray:
    rows = []
    for first, count in zip((0, counts[0]), counts):
        for k in range(1, count - 1):
            row = np.zeros(sum(counts) + 6)
            row[first + k - 1 : first + k + 2] = (1.0, -2.0, 1.0)
            rows.append(row)
    return np.array(rows)


def _cost(state: _State, own: _Problem, bends: FloatArray) -> float:
    cost = float((state.residual(own.points) ** 2).sum() + SMOOTHING**2 * ((bends @ state.unknowns) ** 2).sum())
    return cost if np.isfinite(cost) else np.inf


def _surface(own: _Problem, unknowns: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return the points and angles of a surface on the grid, before its rigid motion."""
    count = len(own.knots[0])
    angles = [
        make_interp_spline(own.knots[0], unknowns[:count])(own.grids[0]),
        make_interp_spline(own.knots[1], unknowns[count:-6])(own.grids[1]),
    ]
    zero = [int(np.argmin(np.abs(grid))) for grid in own.grids]
    middle = 0.5 * (angles[0][zero[0]] + angles[1][zero[1]])
    first, second = (each + (middle - each[k]) for each, k in zip(angles, zero))
    steps = [float(grid[1] - grid[0]) for grid in own.grids]
    return _integrated(first, second, zero[0], zero[1], steps[0], steps[1], own.twist, own.frame, own.origin)


def _moved(own: _Problem, unknowns: FloatArray, points: FloatArray) -> FloatArray:
    """Return points (..., 3) after the rigid motion of the unknowns, about the origin of the surface."""
    return (points - own.origin) @ _rotation(unknowns[-6:-3]).T + own.origin + unknowns[-3:]


def _rotation(vector: FloatArray) -> FloatArray:
    angle = float(np.linalg.norm(vector))
    x, y, z = vector / angle if angle else vector
    cross = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    return np.asarray(np.eye(3) + np.sin(angle) * cross + (1.0 - np.cos(angle)) * (cross @ cross))


def _placed(
    own: _Problem, unknowns: FloatArray, at: FloatArray
) -> tuple[FloatArray, FloatArray, FloatArray, tuple[FloatArray, FloatArray]]:
    """Return points and both tangents at coordinates (k, 2), and the surface."""
    surface = _surface(own, unknowns)
    if not np.isfinite(surface[0]).all():
        wrong = np.full((len(at), 3), np.nan)
        return wrong, wrong, wrong, surface
    splines = [RectBivariateSpline(*own.grids, surface[0][:, :, k]) for k in range(3)]
    point, first, second = (np.column_stack([one.ev(*at.T, dx=du, dy=dv) for one in splines]) for du, dv in ((0, 0), (1, 0), (0, 1)))
    turn = _rotation(unknowns[-6:-3]).T
    return _moved(own, unknowns, point), first @ turn, second @ turn, surface


def _at_feet(own: _Problem, unknowns: FloatArray, at: FloatArray) -> _State:
    """Return the state whose coordinates are those of the feet of the points."""
    for _ in range(FOOT_STEPS):
        point, first, second, _ = _placed(own, unknowns, at)
        away = own.points - point
        move = np.clip(_foot_move(first, second, away), -KNOT, KNOT)
        at = np.clip(at + move, [grid[0] for grid in own.grids], [grid[-1] for grid in own.grids])
    point, first, second, surface = _placed(own, unknowns, at)
    normals = np.cross(first, second)
    normals /= np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), np.finfo(float).tiny)
    return _State(unknowns, at, point, normals, surface)


def _foot_move(first: FloatArray, second: FloatArray, away: FloatArray) -> FloatArray:
    """Return the changes of coordinates (k, 2) that best produce displacements, given both tangents (k, 3)."""
    a, b, c = (np.einsum("ki,ki->k", x, y) for x, y in ((first, first), (first, second), (second, second)))
    p, q = np.einsum("ki,ki->k", first, away), np.einsum("ki,ki->k", second, away)
    area = np.maximum(a * c - b * b, MIN_AREA)
    return np.column_stack([(c * p - b * q) / area, (a * q - b * p) / area])


def _slopes(own: _Problem, state: _State) -> FloatArray:
    """Return the derivatives of the residuals with respect to the unknowns (k, p), by differences."""
    columns = []
    weights = _weights(own.grids, state.at)
    flat = weights @ state.surface[0].reshape(-1, 3)
    here = _moved(own, state.unknowns, flat)
    for k in range(len(state.unknowns)):
        moved = state.unknowns.copy()
        moved[k] += STEP
        points = flat if k >= len(moved) - 6 else weights @ _surface(own, moved)[0].reshape(-1, 3)
        columns.append(np.einsum("ki,ki->k", _moved(own, moved, points) - here, state.normals) / STEP)
    return np.column_stack(columns)


def _weights(grids: tuple[FloatArray, FloatArray], at: FloatArray) -> sparse.csr_matrix:
    """Return the matrix of cubic interpolation from values on a grid to coordinates (k, 2)."""
    first, parts = [], []
    for grid, values in zip(grids, at.T):
        step = grid[1] - grid[0]
        cell = np.clip(np.floor((values - grid[0]) / step).astype(np.int64) - 1, 0, len(grid) - 4)
        t = (values - grid[cell]) / step
        others = [[j for j in range(4) if j != i] for i in range(4)]
        parts.append(np.column_stack([np.prod([(t - j) / (i - j) for j in rest], axis=0) for i, rest in enumerate(others)]))
        first.append(cell)
    rows = np.repeat(np.arange(len(at)), 16)
    columns = (first[0][:, None, None] + np.arange(4)[:, None]) * len(grids[1]) + first[1][:, None, None] + np.arange(4)
    weights = parts[0][:, :, None] * parts[1][:, None, :]
    return sparse.csr_matrix((weights.ravel(), (rows, columns.ravel())), shape=(len(at), len(grids[0]) * len(grids[1])))


@kernel()
def _integrated(
    first: FloatArray,
    second: FloatArray,
    i0: int,
    j0: int,
    du: float,
    dv: float,
    twist: float,
    frame: FloatArray,
    origin: FloatArray,
) -> tuple[FloatArray, FloatArray]:
    """Return the points (n, m, 3) and angles (n, m) of the surface of K = -1 with given angles along the axes."""
    n, m = len(first), len(second)
    angle = np.empty((n, m))
    angle[:, j0] = first
    angle[i0, :] = second
    for si in (1, -1):
        for sj in (1, -1):
            i = i0
            while 0 <= i + si < n:
                j = j0
                while 0 <= j + sj < m:
                    a, b, c = angle[i + si, j], angle[i, j + sj], angle[i, j]
                    x = a + b - c + si * sj * du * dv * np.sin(0.5 * (a + b))
                    for _ in range(2):
                        x = a + b - c + si * sj * du * dv * np.sin(0.25 * (a + b + c + x))
                    angle[i + si, j + sj] = x
                    j += sj
                i += si
    points, frames = np.empty((n, m, 3)), np.empty((n, m, 3, 3))
    points[i0, j0] = origin
    frames[i0, j0] = frame
    for s in (1, -1):
        i = i0
        while 0 <= i + s < n:
            bend = -s * (angle[i + s, j0] - angle[i, j0]) / du
            _carry(frames[i, j0], points[i, j0], bend, twist, s * du, frames[i + s, j0], points[i + s, j0])
            i += s
    for i in range(n):
        turned = frames[i, j0].copy()
        c, s0 = np.cos(angle[i, j0]), np.sin(angle[i, j0])
        frames[i, j0, 0] = c * turned[0] + s0 * turned[1]
        frames[i, j0, 1] = c * turned[1] - s0 * turned[0]
        for s in (1, -1):
            j = j0
            while 0 <= j + s < m:
                bend = s * (angle[i, j + s] - angle[i, j]) / dv
                _carry(frames[i, j], points[i, j], bend, -twist, s * dv, frames[i, j + s], points[i, j + s])
                j += s
    return points, angle


@kernel(inner=True)
def _carry(frame: FloatArray, point: FloatArray, bend: float, twist: float, step: float, frame_out: FloatArray, out: FloatArray) -> None:
    """Carry a frame and its point along a helix of given curvature and torsion."""
    # Numbers instead of short arrays, each of which would be allocated.
    kx, ky, kz = (
        twist * frame[0, 0] + bend * frame[2, 0],
        twist * frame[0, 1] + bend * frame[2, 1],
        twist * frame[0, 2] + bend * frame[2, 2],
    )
    speed = np.sqrt(kx**2 + ky**2 + kz**2)
    kx, ky, kz = kx / speed, ky / speed, kz / speed
    turn = speed * step
    c, s = np.cos(turn), np.sin(turn)
    for row in range(3):
        x, y, z = frame[row, 0], frame[row, 1], frame[row, 2]
        u, v, w = ky * z - kz * y, kz * x - kx * z, kx * y - ky * x
        along = kx * x + ky * y + kz * z
        frame_out[row, 0] = x * c + u * s + along * kx * (1.0 - c)
        frame_out[row, 1] = y * c + v * s + along * ky * (1.0 - c)
        frame_out[row, 2] = z * c + w * s + along * kz * (1.0 - c)
        if row == 0:
            out[0] = point[0] + (x * s + u * (1.0 - c) + along * kx * (turn - s)) / speed
            out[1] = point[1] + (y * s + v * (1.0 - c) + along * ky * (turn - s)) / speed
            out[2] = point[2] + (z * s + w * (1.0 - c) + along * kz * (turn - s)) / speed
