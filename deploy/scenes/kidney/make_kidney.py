#!/usr/bin/python3
"""Makes kidney.msh beside this script: medulla, cortex and capsule of a bean 11 cm long, in metres. Also makes kidney.stl, its
surface in mm, like the result of a segmentation (docs/tutorial.md).

    apt-get install python3-numpy gmsh
    deploy/scenes/kidney/make_kidney.py [--out DIR] [--size EDGE]

    x  from the hilum (-) to the convex side (+)        y  through its thickness        z  from pole to pole

The capsule is a layer of flat elements grown on the parenchyma. The medulla begins CORTEX below the surface.
"""
import argparse
import pathlib
import sys
import tempfile

import numpy as np

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent))
from implicit_body import blend, ellipsoid, mesh_surface, press, surface_of
from layers import grow, read_mesh, surface_triangles, vertex_normals, write_mesh, write_stl

CAPSULE = 0.001
CORTEX = 0.010
GRID_SPACING = 0.0025


def kidney(p):
    """Returns an approximate signed distance at points p (n x 3): negative inside."""
    upper = ellipsoid(p, (0.000, 0.000, 0.024), (0.027, 0.019, 0.031), tilt_deg=-14)
    lower = ellipsoid(p, (0.000, 0.000, -0.024), (0.026, 0.018, 0.031), tilt_deg=14)
    middle = ellipsoid(p, (0.004, 0.000, 0.000), (0.025, 0.020, 0.034))
    hilum = ellipsoid(p, (-0.031, 0.000, 0.000), (0.018, 0.020, 0.018))
    return press(blend(blend(upper, lower, 0.02), middle, 0.015), hilum, 0.012)


def main():
    here = pathlib.Path(__file__).resolve().parent
    options = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    options.add_argument("--out", type=pathlib.Path, default=here, help="folder for the mesh (beside this script)")
    options.add_argument("--size", type=float, default=0.0082, help="length of an edge, m")
    given = options.parse_args()
    given.out.mkdir(parents=True, exist_ok=True)
    surface = surface_of(kidney, (-0.045, -0.035, -0.07), (0.045, 0.035, 0.07), GRID_SPACING)
    with tempfile.TemporaryDirectory() as folder:
        made = pathlib.Path(folder) / "parenchyma.msh"
        mesh_surface(*surface, made, given.size, ("surface", "parenchyma"))
        points, tetrahedra, _, _ = read_mesh(made)
    part = np.where(kidney(points[tetrahedra].mean(axis=1)) < -CORTEX, 0, 1)
    triangles = surface_triangles(tetrahedra)
    points, layer, _ = grow(points, tetrahedra, triangles, CAPSULE * vertex_normals(points, triangles))
    tetrahedra = np.concatenate([tetrahedra, layer])
    part = np.concatenate([part, np.full(len(layer), 2)])
    write_mesh(given.out.resolve() / "kidney.msh", points, tetrahedra, part, ["medulla", "cortex", "capsule"])
    write_stl(given.out.resolve() / "kidney.stl", points, surface_triangles(tetrahedra), "The surface of Palpate's kidney, mm")


if __name__ == "__main__":
    main()
