"""Which way each region bends: domes to either side, saddles and cylinders turned to where the energy of the plate is least."""

from __future__ import annotations

import numpy as np

from ...discrete.arrays import TINY
from ...discrete.arrays import FloatArray
from ...discrete.arrays import Mask
from ...model.tolerances import DRAWING_ACCURACY
from ...model.tolerances import NEGLIGIBLE
from ..constants import MAX_STEPS
from ..constants import TWIN_ENERGIES

__all__ = ["Patterns"]

DIRECTIONS = 64  # directions of saddles that are compared; 2.8° apart, from where the search turns to the best one
MODES = 4  # patterns of least energy from which others are found [patterns]; higher modes have more energy
MOST = 4  # patterns from which surfaces are sought; each costs a search
DEAREST = 1.5  # energy of a pattern over the least that is tried; the energy of a plate orders patterns, but not exactly
# share of its bending that a cylinder costs beside its misfit; four supports lie on cylinders in all directions, but on two that bend least
LIMP = 0.01


class Patterns:
    r"""Energies of a plate whose regions want to bend by themselves.

    .. math:: E(x) = x^T G x + 2 g^T x + c, \qquad x_r = (\pm 1, \cos t_r, \sin t_r),

    with the side of the dome of region r and twice the angle by which its saddle is turned. A cylinder is both, of any curvature.

    Parameters
    ----------
    gram
        ``(r, 3, r, 3)`` G.
    slope
        ``(r, 3)`` g.
    constant
        c.
    domes, saddles
        ``(r,)`` regions that want to bend to a dome, and to a saddle.
    sheets
        Energy of bending to the cylinder (1, 1, 0) if all regions want to bend to a cylinder of any curvature instead, 0 if not.
    side
        To which domes go where nothing else says it, 1 or -1.
    """

    def __init__(self, gram: FloatArray, slope: FloatArray, constant: float, domes: Mask, saddles: Mask, sheets: float, side: float):
        self._gram, self._slope, self._constant = gram, slope, constant
        self._domes, self._saddles, self._sheets, self._side = domes, saddles, sheets, side
        turns = 2.0 * np.pi * np.arange(DIRECTIONS) / DIRECTIONS
        self._circle = np.column_stack([0.0 * turns, np.cos(turns), np.sin(turns)])

    @property
    def turned(self) -> bool:
        """Whether regions may bend in several directions."""
        return bool(self._sheets or self._saddles.any())

    def energy(self, x: FloatArray) -> float:
        """Return the energy of a pattern (r, 3)."""
        return float(np.einsum("ra,rasb,sb->", x, self._gram, x) + 2.0 * np.einsum("ra,ra->", self._slope, x)) + self._constant

    def ranks(self, found: list[FloatArray]) -> list[int]:
        """Return, for each of some patterns, the number of the first with the same energy."""
        energies = [self.energy(x) for x in found]
        return [next(j for j, other in enumerate(energies) if abs(other - own) <= TWIN_ENERGIES * abs(own)) for own in energies]

    def found(self) -> list[FloatArray]:
        """Return patterns (r, 3), the likeliest first.

        Without saddles all domes go to one side, and then to the other. Regions with saddles between creases bend each in its own way.
        """
        if self._sheets:
            return self._cylinders()
        if not self._saddles.any():
            domes = self._one_side()
            return [domes, -domes] if domes.any() else [domes]
        uniform = self._uniform()
        if len(self._domes) == 1:
            return uniform
        own = [self._descended(x) for x in [*uniform, *self._modes()]]
        return self._best([self._descended(x, False) for x in uniform] + own)

    def _one_side(self) -> FloatArray:
        """Return the pattern (r, 3) of domes to their side alone."""
        x = np.zeros((len(self._domes), 3))
        x[:, 0] = self._side * self._domes
        return x

    def _uniform(self) -> list[FloatArray]:
        """Return the patterns whose domes go to one side and whose saddles are turned alike, of locally least energy."""
        domes = self._one_side()
        tried = [domes + self._saddles[:, None] * one for one in self._circle]
        energies = np.array([self.energy(x) for x in tried])
        if np.ptp(energies) <= DRAWING_ACCURACY * abs(energies.mean()):
            return [tried[0], tried[DIRECTIONS // 4]]
        lowest = np.flatnonzero((energies <= np.roll(energies, 1)) & (energies < np.roll(energies, -1)))
        return [tried[k] for k in lowest[np.argsort(energies[lowest], kind="stable")]]

    def _cylinders(self) -> list[FloatArray]:
        """Return the patterns of sheets that bend to one cylinder, of locally least energy, and of a plate that has little more."""
        ways = self._circle + [1.0, 0.0, 0.0]
        push = ways @ self._slope.sum(axis=0)
        alike = np.einsum("ka,rasb,kb->k", ways, self._gram, ways) + LIMP * self._sheets
        less = push**2 / alike
        most = np.flatnonzero((less >= np.roll(less, 1)) & (less > np.roll(less, -1)) & (less > DRAWING_ACCURACY * self._constant))
        plate = np.zeros((len(self._domes), 3))
        found = [plate - push[k] / alike[k] * ways[k] for k in most[np.argsort(-less[most], kind="stable")]]
        return [*found, plate] if not found or self._constant <= DEAREST * self.energy(found[0]) else found

    def _modes(self) -> list[FloatArray]:
        """Return the patterns with the signs and directions of the modes of least energy for their curvature, most domes to their side."""
        count = 3 * len(self._domes)
        G = self._gram.reshape(count, count)
        used = np.flatnonzero(np.column_stack([self._domes, self._saddles, self._saddles]).ravel())
        scale = np.sqrt(np.diag(G)[used])
        vectors = np.linalg.eigh(G[np.ix_(used, used)] / np.outer(scale, scale))[1][:, :MODES]
        found = []
        for mode in vectors.T:
            x: FloatArray = np.zeros(count)
            x[used] = mode
            x = np.asarray(x.reshape(-1, 3))
            x[:, 0] = np.where(x[:, 0] >= 0.0, 1.0, -1.0) * self._domes
            length = np.linalg.norm(x[:, 1:], axis=1)
            x[:, 1:] = np.where(length > 0.0, x[:, 1:].T / np.maximum(length, TINY), [[1.0], [0.0]]).T * self._saddles[:, None]
            found.append(-x if x[:, 0].sum() * self._side < 0.0 else x)
        return found

    def _descended(self, x: FloatArray, flips: bool = True) -> FloatArray:
        """Return the pattern where no region alone has less energy bent in another way; domes keep their sides unless they flip."""
        x = x.copy()
        for _ in range(MAX_STEPS):
            changed = False
            for r in range(len(x)):
                own = self._gram[r, :, r]
                pull = np.einsum("asb,sb->a", self._gram[r], x) - own @ x[r] + self._slope[r]
                sides = ([1.0, -1.0] if flips else [x[r, 0]]) if self._domes[r] else [0.0]
                ways = [self._circle if self._saddles[r] else 0.0 * self._circle[:1]] * len(sides)
                options = np.vstack([way + np.array([side, 0.0, 0.0]) for side, way in zip(sides, ways)])
                energies = np.einsum("oa,ab,ob->o", options, own, options) + 2.0 * options @ pull
                before = float(x[r] @ own @ x[r] + 2.0 * x[r] @ pull)
                best = int(np.argmin(energies))
                if energies[best] < before - NEGLIGIBLE * abs(before):
                    x[r], changed = options[best], True
            if not changed:
                break
        return x

    def _best(self, tried: list[FloatArray]) -> list[FloatArray]:
        """Return different patterns by increasing energy."""
        order = sorted(tried, key=self.energy)
        # Rounding may make the energy of a plate that hardly bends negative.
        limit = max(DEAREST * self.energy(order[0]), self.energy(order[0]))
        found: list[FloatArray] = []
        for x in order:
            if self.energy(x) <= limit and not any(np.allclose(x, other) for other in found):
                found.append(x)
        return found[:MOST]
