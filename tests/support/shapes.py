"""Meshes with known curvature, as arrays."""

from __future__ import annotations

import numpy as np


def grid(n: int, width: float = 1.0):
    """Return n by n squares, all split along the same diagonal."""
    i, j = np.divmod(np.arange((n + 1) ** 2), n + 1)
    vertices = np.column_stack([i, j, np.zeros(len(i))]) * width / n
    a = (np.arange(n)[:, None] * (n + 1) + np.arange(n)).ravel()
    faces = np.column_stack([a, a + n + 1, a + n + 2, a, a + n + 2, a + 1]).reshape(-1, 3)
    return vertices, faces


def revolution(radius, height, around: int):
    """Return the open surface of revolution of a profile, rows turned by half an edge, normals outwards."""
    rows = len(radius)
    k, j = (x.ravel() for x in np.meshgrid(np.arange(rows), np.arange(around), indexing="ij"))
    angle = 2 * np.pi * (j + 0.5 * k) / around
    r, z = np.asarray(radius, float)[k], np.asarray(height, float)[k]
    vertices = np.column_stack([r * np.cos(angle), r * np.sin(angle), z])
    row = np.arange(rows - 1)[:, None] * around
    a, b = (row + np.arange(around)).ravel(), (row + (np.arange(around) + 1) % around).ravel()
    return vertices, np.column_stack([a, b, a + around, b, b + around, a + around]).reshape(-1, 3)


def icosphere(level: int, radius: float = 1.0):
    """Return a closed sphere from an icosahedron, every triangle split in four `level` times."""
    g = (1 + 5**0.5) / 2
    vertices = [(-1, g, 0), (1, g, 0), (-1, -g, 0), (1, -g, 0), (0, -1, g), (0, 1, g)]
    vertices += [(0, -1, -g), (0, 1, -g), (g, 0, -1), (g, 0, 1), (-g, 0, -1), (-g, 0, 1)]
    vertices = [np.array(v) / np.linalg.norm(v) for v in vertices]
    faces = [(0, 11, 5), (0, 5, 1), (0, 1, 7), (0, 7, 10), (0, 10, 11), (1, 5, 9), (5, 11, 4), (11, 10, 2), (10, 7, 6), (7, 1, 8)]
    faces += [(3, 9, 4), (3, 4, 2), (3, 2, 6), (3, 6, 8), (3, 8, 9), (4, 9, 5), (2, 4, 11), (6, 2, 10), (8, 6, 7), (9, 8, 1)]
    for _ in range(level):
        middle = {}

        def between(a, b, middle=middle):
            key = (min(a, b), max(a, b))
            if key not in middle:
                middle[key] = len(vertices)
                m = vertices[a] + vertices[b]
                vertices.append(m / np.linalg.norm(m))
            return middle[key]

        split = []
        for a, b, c in faces:
            ab, bc, ca = between(a, b), between(b, c), between(c, a)
            split += [(a, ab, ca), (b, bc, ab), (c, ca, bc), (ab, bc, ca)]
        faces = split
    return np.array(vertices) * radius, np.array(faces)


def torus(rows: int = 24, around: int = 36, small: float = 0.4):
    """Return a closed torus about a circle of radius 1."""
    i, j = (x.ravel() for x in np.meshgrid(np.arange(rows), np.arange(around), indexing="ij"))
    p, q = 2 * np.pi * i / rows, 2 * np.pi * j / around
    r = 1 + small * np.cos(p)
    vertices = np.column_stack([r * np.cos(q), r * np.sin(q), small * np.sin(p)])

    def at(a, b):
        return (a % rows) * around + b % around

    faces = np.column_stack([at(i, j), at(i, j + 1), at(i + 1, j), at(i, j + 1), at(i + 1, j + 1), at(i + 1, j)])
    return vertices, faces.reshape(-1, 3)


def double_torus():
    """Return a closed surface of genus 2: two tori joined through a missing face each."""
    first, f = torus(12, 16)
    second, g = first + [2.6, 0, 0], f
    # Take the outermost face of each and join their three edges by a prism.
    a = int(np.argmax(first[f].mean(axis=1)[:, 0]))
    b = int(np.argmin(second[g].mean(axis=1)[:, 0]))
    n = len(first)
    p, q = f[a], g[b][::-1] + n
    shift = min(range(3), key=lambda s: np.linalg.norm(first[p] - second[np.roll(q, s) - n], axis=1).sum())
    q = np.roll(q, shift)
    tube = []
    for k in range(3):
        u, v, x, y = p[k], p[(k + 1) % 3], q[k], q[(k + 1) % 3]
        tube += [(u, v, y), (u, y, x)]
    vertices = np.vstack([first, second])
    faces = np.vstack([np.delete(f, a, axis=0), np.delete(g, b, axis=0) + n, tube])
    return vertices, faces


def delaunay_disk(count: int, seed: int = 0, radius: float = 1.0):
    """Return an irregular plane disk."""
    from scipy.spatial import Delaunay

    rng = np.random.default_rng(seed)
    rim = int(2.2 * count**0.5)
    angle = 2 * np.pi * np.arange(rim) / rim
    r = np.sqrt(rng.uniform(0, 0.9, count - rim))
    t = rng.uniform(0, 2 * np.pi, count - rim)
    points = np.vstack([np.column_stack([np.cos(angle), np.sin(angle)]), np.column_stack([r * np.cos(t), r * np.sin(t)])]) * radius
    faces = Delaunay(points).simplices.astype(np.int64)
    u, v = points[faces[:, 1]] - points[faces[:, 0]], points[faces[:, 2]] - points[faces[:, 0]]
    down = u[:, 0] * v[:, 1] - u[:, 1] * v[:, 0] < 0
    faces[down] = faces[down][:, ::-1]
    return np.column_stack([points, np.zeros(len(points))]), faces


def plan_area(vertices, faces):
    """The area that triangles cover seen from above, those that face down taken off."""
    (ax, ay), (bx, by), (cx, cy) = (vertices[faces[:, k], :2].T for k in range(3))
    return 0.5 * np.sum((bx - ax) * (cy - ay) - (by - ay) * (cx - ax))


def alternating(n):
    """Return the faces of n by n squares, split along diagonals that alternate."""
    i, j = np.divmod(np.arange(n * n), n)
    a = i * (n + 1) + j
    b, c, d = a + 1, a + n + 2, a + n + 1
    one, other = np.stack([[a, d, c], [a, c, b]]), np.stack([[a, d, b], [d, c, b]])
    return np.where(((i + j) % 2 == 0)[None, None], one, other).transpose(0, 2, 1).reshape(-1, 3)
