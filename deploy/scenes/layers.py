"""Tetrahedral meshes with named parts, and thin layers grown on their surfaces, for deploy/scenes.

A mesh is `points` (n x 3, m), `tetrahedra` (m x 4, node numbers from 0) and `part` (m, indices into the names of the parts).
"""
import pathlib

import numpy as np

FACES = np.array([[1, 2, 3], [0, 3, 2], [0, 1, 3], [0, 2, 1]])  # faces of a tetrahedron with positive volume, seen from outside


def read_mesh(file):
    """Reads a Gmsh file of version 2.2. Returns points, tetrahedra, their physical group numbers, and the groups' names."""
    lines = iter(pathlib.Path(file).read_text(encoding="utf-8").splitlines())
    names, elements = {}, []
    for line in lines:
        if line == "$PhysicalNames":
            for _ in range(int(next(lines))):
                dimension, number, name = next(lines).split()
                if dimension == "3":
                    names[int(number)] = name.strip('"')
        elif line == "$Nodes":
            nodes = np.array([next(lines).split() for _ in range(int(next(lines)))], float)
        elif line == "$Elements":
            elements = [list(map(int, next(lines).split())) for _ in range(int(next(lines)))]
    tetrahedra = np.array([e[3 + e[2]:] for e in elements if e[1] == 4])
    used, tetrahedra = np.unique(tetrahedra, return_inverse=True)
    place = {int(number): i for i, number in enumerate(nodes[:, 0])}
    points = nodes[[place[number] for number in used], 1:]
    return points, upright(points, tetrahedra.reshape(-1, 4)), np.array([e[3] for e in elements if e[1] == 4]), names


def volumes(points, tetrahedra):
    a, b, c, d = (points[tetrahedra[:, i]] for i in range(4))
    return np.einsum("ij,ij->i", np.cross(b - a, c - a), d - a) / 6


def upright(points, tetrahedra):
    """Returns the tetrahedra, reordered so that all volumes are positive."""
    tetrahedra = tetrahedra.copy()
    turned = volumes(points, tetrahedra) < 0
    tetrahedra[turned] = tetrahedra[turned][:, [1, 0, 2, 3]]
    return tetrahedra


def surface_triangles(tetrahedra):
    """Returns the faces that belong to one tetrahedron only (m x 3), counterclockwise seen from outside."""
    faces = tetrahedra[:, FACES].reshape(-1, 3)
    _, first, count = np.unique(np.sort(faces, axis=1), axis=0, return_index=True, return_counts=True)
    return faces[first[count == 1]]


def vertex_normals(points, triangles):
    """Returns unit normals at the points (n x 3), averaged over the triangles by area; zero without a triangle."""
    a, b, c = (points[triangles[:, i]] for i in range(3))
    normals = np.zeros_like(points)
    for corner in range(3):
        np.add.at(normals, triangles[:, corner], np.cross(b - a, c - a))
    return normals / np.maximum(np.linalg.norm(normals, axis=1), 1e-30)[:, None]


def grow(points, tetrahedra, triangles, offset):
    """Grows one layer of prisms on `triangles`, each cut into three tetrahedra that match its neighbours.

    offset  n x 3, m: from each point to its copy on the other side of the layer
    Returns the points followed by the copies, the layer's own tetrahedra, and the triangles on its other side.
    """
    below = np.unique(triangles)
    copy = np.full(len(points), -1)
    copy[below] = len(points) + np.arange(len(below))
    points = np.concatenate([points, points[below] + offset[below]])
    order = np.sort(triangles, axis=1)  # a face's diagonal starts at its lowest node, so both prisms cut the face the same way
    a, b, c = order.T
    layer = np.concatenate([np.stack([a, b, c, copy[c]], axis=1), np.stack([a, b, copy[b], copy[c]], axis=1),
                            np.stack([a, copy[a], copy[b], copy[c]], axis=1)])
    return points, upright(points, layer), copy[triangles]


def write_mesh(file, points, tetrahedra, part, names, surfaces=(), vectors=None):
    """Writes a Gmsh file of version 2.2.

    part      m, indices into `names`
    surfaces  named triangles where a body may be fixed: (name, m x 3) each
    vectors   one direction per tetrahedron: (name, m x 3)
    """
    groups = [(3, i + 1, name) for i, name in enumerate(names)]
    groups += [(2, len(names) + i + 1, name) for i, (name, _) in enumerate(surfaces)]
    with open(file, "w", encoding="utf-8") as out:
        out.write(f"$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n{len(groups)}\n")
        out.writelines(f'{dimension} {number} "{name}"\n' for dimension, number, name in groups)
        out.write(f"$EndPhysicalNames\n$Nodes\n{len(points)}\n")
        out.writelines("%d %.7g %.7g %.7g\n" % (i + 1, *point) for i, point in enumerate(points))
        triangles = [(len(names) + i + 1, triangle) for i, (_, some) in enumerate(surfaces) for triangle in some]
        out.write(f"$EndNodes\n$Elements\n{len(triangles) + len(tetrahedra)}\n")
        number = 0
        for group, nodes in [*triangles, *zip(part + 1, tetrahedra)]:
            number += 1
            out.write(f"{number} {2 if len(nodes) == 3 else 4} 2 {group} {group} " + " ".join(str(n + 1) for n in nodes) + "\n")
        out.write("$EndElements\n")
        if vectors is not None:
            out.write(f'$ElementData\n1\n"{vectors[0]}"\n1\n0\n3\n0\n3\n{len(tetrahedra)}\n')
            out.writelines("%d %.4f %.4f %.4f\n" % (len(triangles) + i + 1, *v) for i, v in enumerate(vectors[1]))
            out.write("$EndElementData\n")


def write_stl(file, points, triangles, title):
    """Writes a surface as binary STL in mm. Points are in m, triangles counterclockwise seen from outside."""
    corners = 1e3 * points[triangles]
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    records = np.zeros(len(triangles), [("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attribute", "<u2")])
    records["normal"], records["corners"] = normals, corners
    file.write_bytes(title.encode().ljust(80) + np.array(len(triangles), "<u4").tobytes() + records.tobytes())
