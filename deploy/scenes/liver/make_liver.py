#!/usr/bin/python3
"""Makes the liver-like organ that Palpate ships: liver-500.msh and liver-2000.msh beside this script.

    apt-get install python3-numpy gmsh
    deploy/scenes/liver/make_liver.py [--out DIR]

The shape is our own: ellipsoids blended into one implicit body, with the impressions of the neighbouring organs
pressed into it. It is no patient's liver, and it resembles one in what matters to a touch: a thick domed right lobe,
a thin left lobe that ends in a tip, a hollow underside with a sharp lower edge. Metres throughout.

    x  from the patient's right (-) to the left (+)        y  from the front (-) to the back (+)        z  upwards

Steps: sample the body on a grid, wrap a closed triangle surface around it (surface nets), project that onto the body,
and let the program gmsh re-mesh it to a uniform size and fill it with tetrahedra. Nothing is random: the same gmsh
gives the same files (the committed ones are by Gmsh 4.8.4, Debian 12).
"""
import argparse
import pathlib
import subprocess
import sys
import tempfile

import numpy as np

GRID_SPACING = 0.003  # m; the sharpest feature, the lower edge, has a radius of about 6 mm
MESHES = {  # file: (element size in metres that gives about that many nodes, Gmsh file version)
    "liver-500.msh": (0.0154, "2.2"),
    "liver-2000.msh": (0.0087, "4.1"),
}


def ellipsoid(p, center, semi_axes, tilt_deg=0.0):
    """Approximate signed distance of points p (n x 3) to an ellipsoid turned by tilt_deg about the y axis."""
    c, s = np.cos(np.radians(tilt_deg)), np.sin(np.radians(tilt_deg))
    q = (p - center) @ np.array([[c, 0, -s], [0, 1, 0], [s, 0, c]])
    k0 = np.linalg.norm(q / semi_axes, axis=1)
    k1 = np.linalg.norm(q / np.square(semi_axes), axis=1)
    return k0 * (k0 - 1) / np.maximum(k1, 1e-9)


def blend(a, b, width):
    """Union of two distances whose crease is rounded over `width` metres."""
    h = np.clip(0.5 + 0.5 * (b - a) / width, 0, 1)
    return b + (a - b) * h - width * h * (1 - h)


def press(body, tool, width):
    """The body without what the tool covers, the edge rounded over `width` metres."""
    return -blend(-body, tool, width)


def liver(p):
    """Signed distance-like function of the organ at points p (n x 3): negative inside."""
    right = ellipsoid(p, (-0.046, 0.002, 0.002), (0.050, 0.063, 0.062), tilt_deg=8)
    lower_right = ellipsoid(p, (-0.062, -0.012, -0.032), (0.032, 0.042, 0.044), tilt_deg=-10)
    middle = ellipsoid(p, (0.004, -0.014, 0.010), (0.048, 0.047, 0.042), tilt_deg=-14)
    left = ellipsoid(p, (0.050, -0.022, 0.020), (0.056, 0.038, 0.023), tilt_deg=-6)
    body = blend(blend(right, lower_right, 0.03), blend(middle, left, 0.03), 0.03)

    stomach = ellipsoid(p, (0.064, 0.010, -0.050), (0.074, 0.076, 0.058), tilt_deg=-14)
    kidney = ellipsoid(p, (-0.036, 0.064, -0.064), (0.040, 0.052, 0.050))
    gallbladder = ellipsoid(p, (-0.014, -0.044, -0.052), (0.016, 0.050, 0.030))
    spine = ellipsoid(p, (0.020, 0.080, 0.010), (0.037, 0.046, 0.180))
    heart = ellipsoid(p, (0.040, -0.014, 0.092), (0.060, 0.056, 0.046))
    ligament = ellipsoid(p, (0.020, -0.084, -0.005), (0.012, 0.030, 0.055))  # notch of the falciform ligament
    for organ, width in ((stomach, 0.014), (kidney, 0.02), (gallbladder, 0.014), (spine, 0.025), (heart, 0.03),
                         (ligament, 0.02)):
        body = press(body, organ, width)
    return body


def surface_nets(field, spacing):
    """Closed surface of a body sampled on a grid: one vertex per cell that it passes, one quadrilateral per grid edge.

    field   nx x ny x nz, negative inside, positive on the whole rim.
    Returns vertices (n x 3, in the frame of grid point 0,0,0) and triangles (m x 3, normals outwards).
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


def relax(vertices, triangles, rounds):
    """Moves every vertex to the middle of its neighbours and back onto the body, `rounds` times."""
    pairs = np.unique(np.sort(np.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]]),
                              axis=1), axis=0)
    pairs = np.concatenate([pairs, pairs[:, ::-1]])
    degree = np.bincount(pairs[:, 0])[:, None]
    for _ in range(rounds):
        mean = np.zeros_like(vertices)
        np.add.at(mean, pairs[:, 0], vertices[pairs[:, 1]])
        vertices = onto_body(mean / degree)
    return vertices


def onto_body(points):
    """One Newton step along the gradient of the implicit function."""
    step = 1e-5
    value = liver(points)
    gradient = np.stack([(liver(points + step * e) - liver(points - step * e)) / (2 * step) for e in np.eye(3)],
                        axis=1)
    return points - gradient * (value / np.maximum((gradient**2).sum(axis=1), 1e-2))[:, None]


def check_closed(triangles):
    """Every directed edge once, with its reverse: closed and consistently oriented."""
    directed = np.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]])
    if len(np.unique(directed, axis=0)) != len(directed) or set(map(tuple, directed)) != set(map(tuple, directed[:, ::-1])):
        sys.exit("make_liver: the surface is not closed; a smaller GRID_SPACING resolves it")


def organ_surface():
    """Vertices (n x 3, m) and triangles (m x 3) of the organ's surface."""
    low, high = np.array([-0.13, -0.10, -0.10]), np.array([0.14, 0.09, 0.10])
    shape = np.ceil((high - low) / GRID_SPACING).astype(int)
    grid = np.stack(np.meshgrid(*[np.arange(n) for n in shape], indexing="ij"), axis=-1).reshape(-1, 3)
    field = liver(low + GRID_SPACING * grid).reshape(shape)
    vertices, triangles = surface_nets(field, GRID_SPACING)
    check_closed(triangles)
    return relax(low + vertices, triangles, rounds=5), triangles


def write_stl(file, vertices, triangles):
    a, b, c = (vertices[triangles[:, i]] for i in range(3))
    normals = np.cross(b - a, c - a)
    normals /= np.linalg.norm(normals, axis=1)[:, None]
    with open(file, "w") as out:
        out.write("solid liver\n")
        for n, *corners in zip(normals, a, b, c):
            out.write("facet normal %.9g %.9g %.9g\nouter loop\n" % tuple(n))
            out.writelines("vertex %.9g %.9g %.9g\n" % tuple(corner) for corner in corners)
            out.write("endloop\nendfacet\n")
        out.write("endsolid liver\n")


GEO = """
Merge "{stl}";
ClassifySurfaces{{Pi, 1, 1, Pi}};
CreateGeometry;
faces() = Surface{{:}};
Surface Loop(1) = faces();
Volume(1) = {{1}};
Physical Surface("capsule") = faces();
Physical Volume("liver") = {{1}};
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


def gmsh(folder, *arguments):
    run = subprocess.run(["gmsh", *arguments], cwd=folder, capture_output=True, text=True)
    if run.returncode != 0:
        sys.exit(f"make_liver: gmsh {' '.join(arguments)} failed:\n{run.stdout[-2000:]}{run.stderr[-2000:]}")


def mesh_with_gmsh(stl, out, size, version):
    folder = stl.parent
    (folder / "liver.geo").write_text(GEO.format(stl=stl.name, size=size))
    gmsh(folder, "-3", "liver.geo", "-format", "msh22", "-o", "liver.msh")
    # A second run, because a 4.1 file written by the first would carry the whole parametrised surface along.
    gmsh(folder, "liver.msh", "-save", "-format", {"2.2": "msh22", "4.1": "msh41"}[version], "-o", str(out))


def main():
    here = pathlib.Path(__file__).resolve().parent
    options = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    options.add_argument("--out", type=pathlib.Path, default=here, help="folder for the meshes (beside this script)")
    out = options.parse_args().out.resolve()
    out.mkdir(parents=True, exist_ok=True)
    vertices, triangles = organ_surface()
    with tempfile.TemporaryDirectory() as folder:
        stl = pathlib.Path(folder) / "liver.stl"
        write_stl(stl, vertices, triangles)
        for name, (size, version) in MESHES.items():
            mesh_with_gmsh(stl, out / name, size, version)
            print(f"wrote {out / name}")


if __name__ == "__main__":
    main()
