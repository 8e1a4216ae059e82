"""Boxes of tetrahedra, for tests in Python."""
import itertools

import numpy as np


def box(cells=(3, 2, 2), size=0.02):
    """Returns points (m) and tetrahedra of a box of cubes of `size`, with Kuhn's six tetrahedra per cube."""
    n = np.array(cells) + 1
    points = size * np.array(list(np.ndindex(*n)), float)
    tetrahedra = []
    for cell in np.ndindex(*cells):
        for order in itertools.permutations(range(3)):
            corner, four = np.array(cell), [np.ravel_multi_index(cell, n)]
            for axis in order:
                corner = corner + np.eye(3, dtype=int)[axis]
                four.append(np.ravel_multi_index(corner, n))
            x = points[four]
            tetrahedra.append(four if np.linalg.det(x[1:] - x[0]) > 0 else [four[0], four[2], four[1], four[3]])
    return points, np.array(tetrahedra)


def write_gmsh(file, points, tetrahedra):
    lines = ["$MeshFormat", "2.2 0 8", "$EndMeshFormat", "$Nodes", len(points)]
    lines += [f"{n + 1} {x:.17g} {y:.17g} {z:.17g}" for n, (x, y, z) in enumerate(points)]
    lines += ["$EndNodes", "$Elements", len(tetrahedra)]
    lines += [f"{e + 1} 4 2 0 1 " + " ".join(str(node + 1) for node in t) for e, t in enumerate(tetrahedra)]
    file.write_text("\n".join(map(str, lines + ["$EndElements", ""])), encoding="utf-8")
