"""Tools for the shapes in deploy/scenes: implicit bodies, their surfaces, and tetrahedral meshes by gmsh.

A body is a function of points (n x 3, m), negative inside and close to the distance near its surface. It is sampled on a grid.
Surface nets extract a closed triangle surface, which is projected onto the body. gmsh remeshes the surface to a uniform size and
fills it with tetrahedra. Nothing is random: the same gmsh gives the same files. Used by the make_NAME.py of each scene. Metres.
"""
import pathlib
import subprocess
import sys
import tempfile

import numpy as np


def ellipsoid(p, center, semi_axes, tilt_deg=0.0):
    """Returns the approximate signed distance of points p (n x 3) to an ellipsoid rotated by tilt_deg about the y axis."""
    c, s = np.cos(np.radians(tilt_deg)), np.sin(np.radians(tilt_deg))
    q = (p - center) @ np.array([[c, 0, -s], [0, 1, 0], [s, 0, c]])
    k0 = np.linalg.norm(q / semi_axes, axis=1)
    k1 = np.linalg.norm(q / np.square(semi_axes), axis=1)
    return k0 * (k0 - 1) / np.maximum(k1, 1e-9)


def blend(a, b, width):
    """Returns the union of two signed distances, with its crease rounded over `width` metres."""
    h = np.clip(0.5 + 0.5 * (b - a) / width, 0, 1)
    return b + (a - b) * h - width * h * (1 - h)


def press(body, tool, width):
    """Returns the body minus the tool, with the edge rounded over `width` metres."""
    return -blend(-body, tool, width)


def surface_nets(field, spacing):
    """Extracts the closed surface of a body on a grid: one vertex per cell that it crosses, one quadrilateral per grid edge.

    field   nx x ny x nz, negative inside, positive on the whole boundary.
    Returns vertices (n x 3, relative to grid point 0,0,0) and triangles (m x 3, normals outward).
    """
    inside = field < 0
    corner_sum = np.zeros(tuple(n - 1 for n in field.shape) + (3,))
    crossings = np.zeros(tuple(n - 1 for n in field.shape))
    edges = []
    for axis in range(3):
        u, v = (axis + 1) % 3, (axis + 2) % 3
        low = np.moveaxis(field, axis, 0)[:-1]
        high = np.moveaxis(field, axis, 0)[1:]
        at = np.argwhere(np.moveaxis((low < 0) != (high < 0), 0, axis))
        fraction = field[tuple(at.T)] / (field[tuple(at.T)] - field[tuple((at + np.eye(3, dtype=int)[axis]).T)])
        point = at + fraction[:, None] * np.eye(3)[axis]
        cells = []
        for du, dv in ((-1, -1), (0, -1), (0, 0), (-1, 0)):  # around the edge, right-handed about the axis
            cell = at.copy()
            cell[:, u] += du
            cell[:, v] += dv
            np.add.at(corner_sum, tuple(cell.T), point)
            np.add.at(crossings, tuple(cell.T), 1)
            cells.append(cell)
        edges.append((cells, inside[tuple(at.T)]))

    active = crossings > 0
    number = np.full(active.shape, -1)
    number[active] = np.arange(active.sum())
    vertices = corner_sum[active] / crossings[active][:, None] * spacing
    triangles = []
    for cells, outwards in edges:
        a, b, c, d = (number[tuple(cell.T)] for cell in cells)
        b, d = np.where(outwards, b, d), np.where(outwards, d, b)
        triangles += [np.stack([a, b, c], axis=1), np.stack([a, c, d], axis=1)]
    return vertices, np.concatenate(triangles)


def relax(body, vertices, triangles, rounds):
    """Moves each vertex to the mean of its neighbours and back onto the body, `rounds` times."""
    pairs = np.unique(np.sort(np.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]]),
                              axis=1), axis=0)
    pairs = np.concatenate([pairs, pairs[:, ::-1]])
    degree = np.bincount(pairs[:, 0])[:, None]
    for _ in range(rounds):
        mean = np.zeros_like(vertices)
        np.add.at(mean, pairs[:, 0], vertices[pairs[:, 1]])
        vertices = onto_body(body, mean / degree)
    return vertices


def onto_body(body, points):
    """Projects points by one Newton step along the gradient of the implicit function."""
    step = 1e-5
    value = body(points)
    gradient = np.stack([(body(points + step * e) - body(points - step * e)) / (2 * step) for e in np.eye(3)],
                        axis=1)
    return points - gradient * (value / np.maximum((gradient**2).sum(axis=1), 1e-2))[:, None]


def check_closed(triangles):
    """Exits unless each directed edge occurs once, with its reverse: closed and consistently oriented."""
    directed = np.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]])
    if len(np.unique(directed, axis=0)) != len(directed) or set(map(tuple, directed)) != set(map(tuple, directed[:, ::-1])):
        sys.exit("the surface is not closed; use a smaller grid spacing")


def surface_of(body, low, high, spacing):
    """Returns vertices (n x 3, m) and triangles (m x 3) of the surface of a body between the corners `low` and `high`."""
    low = np.asarray(low)
    shape = np.ceil((np.asarray(high) - low) / spacing).astype(int)
    grid = np.stack(np.meshgrid(*[np.arange(n) for n in shape], indexing="ij"), axis=-1).reshape(-1, 3)
    vertices, triangles = surface_nets(body(low + spacing * grid).reshape(shape), spacing)
    check_closed(triangles)
    return relax(body, low + vertices, triangles, rounds=5), triangles


def write_stl(file, vertices, triangles):
    a, b, c = (vertices[triangles[:, i]] for i in range(3))
    normals = np.cross(b - a, c - a)
    normals /= np.linalg.norm(normals, axis=1)[:, None]
    with open(file, "w") as out:
        out.write("solid body\n")
        for n, *corners in zip(normals, a, b, c):
            out.write("facet normal %.9g %.9g %.9g\nouter loop\n" % tuple(n))
            out.writelines("vertex %.9g %.9g %.9g\n" % tuple(corner) for corner in corners)
            out.write("endloop\nendfacet\n")
        out.write("endsolid body\n")


SETTINGS = """
Mesh.MeshSizeMin = {size};
Mesh.MeshSizeMax = {size};
Mesh.MeshSizeExtendFromBoundary = 0;
Mesh.Algorithm = 6;      // frontal Delaunay: the most even triangles
Mesh.Algorithm3D = 1;    // Delaunay
Mesh.Optimize = 1;
Mesh.OptimizeThreshold = 0.4;
Mesh.Smoothing = 10;
Mesh.Binary = 0;
General.NumThreads = 1;
"""

FILLED = """
Merge "{stl}";
ClassifySurfaces{{Pi, 1, 1, Pi}};
CreateGeometry;
faces() = Surface{{:}};
Surface Loop(1) = faces();
Volume(1) = {{1}};
Physical Surface("{surface}") = faces();
Physical Volume("{volume}") = {{1}};
"""


def gmsh(folder, *arguments):
    run = subprocess.run(["gmsh", *arguments], cwd=folder, capture_output=True, text=True)
    if run.returncode != 0:
        sys.exit(f"gmsh {' '.join(arguments)} failed:\n{run.stdout[-2000:]}{run.stderr[-2000:]}")


def mesh_surface(vertices, triangles, out, size, names, version="2.2"):
    """Meshes the inside of a closed surface with edges of about `size` metres and writes it to the file `out`.

    names   names of the two physical groups: (surface, volume)
    """
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        write_stl(folder / "body.stl", vertices, triangles)
        geometry = FILLED.format(stl="body.stl", surface=names[0], volume=names[1])
        (folder / "body.geo").write_text(geometry + SETTINGS.format(size=size))
        gmsh(folder, "-3", "body.geo", "-format", "msh22", "-o", "body.msh")
        # Save in a second run: a 4.1 file from the first would contain the whole parametrised
        # surface.
        gmsh(folder, "body.msh", "-save", "-format", {"2.2": "msh22", "4.1": "msh41"}[version], "-o", str(out))


def mesh_geometry(geometry, out, size):
    """Meshes `geometry` (text in gmsh's language) with edges of about `size` metres; writes the file `out`, version 2.2."""
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        (folder / "body.geo").write_text(geometry + SETTINGS.format(size=size))
        gmsh(folder, "-3", "body.geo", "-format", "msh22", "-o", str(out))
