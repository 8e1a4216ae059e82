"""Splits polygons and strips into triangles."""
import numpy as np


def cut(points, polygons):
    """Returns the triangles of polygons, n x 3."""
    points = np.asarray(points, dtype=float).reshape(len(points), -1)[:, :3]
    by_size = {}
    for polygon in polygons:
        by_size.setdefault(len(polygon), []).append(polygon)
    triangles = [np.zeros((0, 3), dtype=np.int64)]
    for size, alike in by_size.items():
        alike = np.array(alike, dtype=np.int64)
        fan = np.stack([alike[:, [0, i, i + 1]] for i in range(1, size - 1)])
        a, b, c = (points[fan[:, :, i]] for i in range(3))
        normals = np.cross(b - a, c - a)
        plain_ones = ((normals * normals.sum(axis=0)).sum(axis=2) > 0).all(axis=0) | (size == 3)
        triangles.append(fan[:, plain_ones].reshape(-1, 3))
        triangles += [np.array(ears(points, list(polygon))) for polygon in alike[~plain_ones]]
    return np.concatenate(triangles)


def ears(points, polygon):
    """Returns the triangles of a polygon, which need not be convex, by cutting off ears (Meisters 1975)."""
    corners = points[polygon]
    normal = np.cross(corners, np.roll(corners, -1, axis=0)).sum(axis=0)  # twice the area, as a vector
    axis = int(np.abs(normal).argmax())
    flat = np.delete(points[polygon], axis, axis=1)
    turn = (1 if normal[axis] >= 0 else -1) * (-1 if axis == 1 else 1)

    def area(a, b, c):
        return turn * ((flat[b][0] - flat[a][0]) * (flat[c][1] - flat[a][1])
                       - (flat[b][1] - flat[a][1]) * (flat[c][0] - flat[a][0]))

    left, triangles = list(range(len(polygon))), []
    while len(left) > 3:
        for n, b in enumerate(left):
            a, c = left[n - 1], left[(n + 1) % len(left)]
            others = (p for p in left if p not in (a, b, c))
            if area(a, b, c) > 0 and not any(min(area(a, b, p), area(b, c, p), area(c, a, p)) >= 0 for p in others):
                break
        else:
            n, b = 1, left[1]  # degenerate polygon; the surface checks judge the result
            a, c = left[0], left[2]
        triangles.append((polygon[a], polygon[b], polygon[c]))
        del left[n]
    return [*triangles, tuple(polygon[n] for n in left)]


def triangles_of_strips(corners):
    """Returns the triangles of strips. A strip ends with -1; every second triangle of a strip is reversed."""
    triangles, strip = [], []
    for corner in corners:
        strip = [*strip, corner] if corner >= 0 else []
        if len(strip) >= 3:
            a, b, c = strip[-3:]
            triangles.append([a, b, c] if len(strip) % 2 else [b, a, c])
    return [t for t in triangles if len(set(t)) == 3]
