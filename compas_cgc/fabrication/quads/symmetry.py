"""Layouts of quads with the symmetry of their drawing.

Triangles, cuts and integers of a parametrisation do not have the symmetry of a drawing, so that lines at mirror images differ by
centimetres. Where the layouts at images have the same faces, corners are moved to the means of their images.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Sequence
from typing import NamedTuple
from typing import Optional

import numpy as np
from scipy.spatial import cKDTree

from ...discrete.arrays import FloatArray
from ...discrete.arrays import IntArray
from ...discrete.arrays import Vectors
from ...discrete.arrays import Vertices

__all__ = ["symmetrised"]

MAX_SHIFT = 0.4  # of the spacing: largest distance between a corner and the image of its partner
NEAREST_FACES = 6  # that are tried as the image of a face
SAME_ANGLE = 1e-6  # difference of two transformations in plan that is rounding
ISOTROPY = 1e-3  # relative difference of the moments of a rim below which its principal axes are those of the plan

_Faces = list[list[int]]


class _Image(NamedTuple):
    """A rotation or reflection in plan about the middle, and the corners to which it takes corners."""

    matrix: FloatArray  # (3, 3)
    to: IntArray  # (k,)


def symmetrised(points: Vectors, faces: _Faces, kinks: Vectors, rim: Vertices, spacing: float) -> Vectors:
    """Return corners of polygons (k, 3) moved to the means of their images under the symmetries of the layout; themselves without any.

    Parameters
    ----------
    points
        (k, 3) corners [L].
    faces
        Corners of every polygon, counterclockwise.
    kinks
        (c, 3) kinks of the outer rim of the roof [L].
    rim
        (r, 3) vertices of the outer rim [L].
    spacing
        Distance between lines [L].
    """
    middle = np.append(0.5 * (rim[:, :2].min(axis=0) + rim[:, :2].max(axis=0)), 0.0)
    arms = points - middle
    graph = _Graph(arms, faces)
    images = [_Image(np.eye(3), np.arange(len(points)))]
    for matrix in _candidates(rim - middle, kinks - middle):
        to = graph.image(matrix, MAX_SHIFT * spacing)
        if to is not None:
            images.append(_Image(matrix, to))
    group = _largest_group(images)
    if len(group) == 1:
        return points
    return np.asarray(middle + np.mean([arms[own.to] @ own.matrix for own in group], axis=0))


def _candidates(rim: Vectors, kinks: Vectors) -> list[FloatArray]:
    """Return matrices (3, 3) of rotations and reflections in plan that may take a rim to itself, without the identity.

    They are the eight of a square along the principal axes of the rim, and those that take the first kink to another.
    """
    values, axes = np.linalg.eigh(rim[:, :2].T @ rim[:, :2])
    base = 0.0 if values[1] - values[0] <= ISOTROPY * values[1] else float(np.arctan2(axes[1, 0], axes[0, 0]))
    angles = np.arctan2(kinks[:, 1], kinks[:, 0])
    turns = [k * 0.5 * np.pi for k in range(4)] + (angles - angles[:1]).tolist()
    flips = [2.0 * base + k * 0.5 * np.pi for k in range(4)] + (angles + angles[:1]).tolist()
    found: list[FloatArray] = [np.eye(3)]
    for angle, side in [*((turn, 1.0) for turn in turns), *((flip, -1.0) for flip in flips)]:
        c, s = np.cos(angle), np.sin(angle)
        matrix = np.array([[c, -side * s, 0.0], [s, side * c, 0.0], [0.0, 0.0, 1.0]])
        if not any(np.allclose(matrix, own, rtol=0.0, atol=SAME_ANGLE) for own in found):
            found.append(matrix)
    return found[1:]


class _Graph:
    """Polygons as half-edges, of which every connected part is mapped to another."""

    def __init__(self, arms: Vectors, faces: _Faces):
        self.arms, self.faces = arms, faces
        self.left = {(a, b): (f, k) for f, face in enumerate(faces) for k, (a, b) in enumerate(zip(face, face[1:] + face[:1]))}
        self.centres = np.array([arms[face].mean(axis=0) for face in faces])
        self.tree = cKDTree(self.centres)

    def image(self, matrix: FloatArray, reach: float) -> Optional[IntArray]:
        """Return the corner to which every corner (k,) goes, None unless faces go to faces and no corner is farther off than `reach`."""
        flipped = bool(np.linalg.det(matrix) < 0.0)
        moved, to, seen = self.arms @ matrix.T, np.full(len(self.arms), -1), np.zeros(len(self.faces), bool)
        # A face that is no quad has fewer images.
        for start in sorted(range(len(self.faces)), key=lambda face: len(self.faces[face]) == 4):
            if seen[start]:
                continue
            best = None
            for other in np.atleast_1d(self.tree.query(matrix @ self.centres[start], min(NEAREST_FACES, len(self.faces)))[1]).tolist():
                for shift in range(len(self.faces[other])):
                    found = self._walked(start, other, shift, flipped)
                    if found is None:
                        continue
                    here = np.fromiter(found[0], np.int64)
                    there = np.fromiter(found[0].values(), np.int64)
                    off = float(np.linalg.norm(moved[here] - self.arms[there], axis=1).max())
                    if off <= reach and (best is None or off < best[0]):
                        best = off, here, there, found[1]
            if best is None:
                return None
            to[best[1]] = best[2]
            seen[best[3]] = True
        return to if len(np.unique(to)) == len(to) else None

    def _walked(self, start: int, other: int, shift: int, flipped: bool) -> Optional[tuple[dict[int, int], list[int]]]:
        """Return where corners go if a face goes to another, its first corner to the one at `shift`; None if faces do not match."""
        sign = -1 if flipped else 1
        to: dict[int, int] = {}
        image = {start: other}
        waiting = deque([(start, other, shift)])
        while waiting:
            face, target, first = waiting.popleft()
            here, there = self.faces[face], self.faces[target]
            count = len(here)
            if len(there) != count:
                return None
            for k, corner in enumerate(here):
                if to.setdefault(corner, there[(first + sign * k) % count]) != there[(first + sign * k) % count]:
                    return None
            for a, b in zip(here, here[1:] + here[:1]):
                beside = self.left.get((b, a))
                beyond = self.left.get((to[a], to[b]) if flipped else (to[b], to[a]))
                if (beside is None) != (beyond is None):
                    return None
                if beside is None or beyond is None:
                    continue
                if beside[0] in image:
                    if image[beside[0]] != beyond[0]:
                        return None
                    continue
                image[beside[0]] = beyond[0]
                # The corner b lies at the start of the half-edge beside, its image at the end of the one beyond if flipped.
                at = beyond[1] + 1 if flipped else beyond[1]
                waiting.append((beside[0], beyond[0], (at - sign * beside[1]) % len(self.faces[beyond[0]])))
        return to, list(image)


def _largest_group(images: Sequence[_Image]) -> list[_Image]:
    """Return images that form a group, to which no other one can be added without leaving the given ones."""
    known = {own.to.tobytes(): own for own in images}
    group = {images[0].to.tobytes(): images[0]}
    for image in images[1:]:
        wider = {**group, image.to.tobytes(): image}
        waiting = deque(wider.values())
        while waiting and wider:
            one = waiting.popleft()
            for other in list(wider.values()):
                key = other.to[one.to].tobytes()
                if key not in known:
                    wider = {}
                    break
                if key not in wider:
                    wider[key] = known[key]
                    waiting.append(known[key])
        group = wider or group
    return list(group.values())
