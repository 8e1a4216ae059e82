#!/usr/bin/python3
"""Makes muscle.msh beside this script: a belly between two tendons, with a fibre direction in each element. Metres.

    apt-get install python3-numpy gmsh
    deploy/scenes/muscle/make_muscle.py [--out DIR] [--size EDGE]

The belly lies along x with radius(x), a little flatter in z. The fibres follow the flow in a pipe of that shape: at (x, y, z)
along (1, y r'/r, z r'/r), so that fibres at the surface follow the surface.
"""
import argparse
import pathlib
import sys
import tempfile

import numpy as np

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent))
from implicit_body import mesh_surface, surface_of
from layers import read_mesh, surface_triangles, write_mesh

HALF_LENGTH = 0.075
BELLY = 0.024  # radius in the middle
TENDON = 0.009  # radius at the ends
FLATNESS = 0.8  # ratio of the extents in z and y
GRID_SPACING = 0.0025


def radius(x):
    return TENDON + (BELLY - TENDON) * np.cos(np.clip(np.pi * x / (2 * HALF_LENGTH), -np.pi / 2, np.pi / 2)) ** 2


def slope(x):
    return (radius(x + 1e-6) - radius(x - 1e-6)) / 2e-6


def muscle(p):
    """Returns an approximate signed distance at points p (n x 3): negative inside."""
    side = np.hypot(p[:, 1], p[:, 2] / FLATNESS) - radius(p[:, 0])
    end = np.abs(p[:, 0]) - HALF_LENGTH
    width = 0.004  # rounding of the edge between them
    h = np.clip(0.5 + 0.5 * (side - end) / width, 0, 1)
    return end + (side - end) * h + width * h * (1 - h)


def main():
    here = pathlib.Path(__file__).resolve().parent
    options = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    options.add_argument("--out", type=pathlib.Path, default=here, help="folder for the mesh (beside this script)")
    options.add_argument("--size", type=float, default=0.0072, help="length of an edge, m")
    given = options.parse_args()
    given.out.mkdir(parents=True, exist_ok=True)
    margin = 4 * GRID_SPACING
    high = np.array([HALF_LENGTH, BELLY, BELLY]) + margin
    with tempfile.TemporaryDirectory() as folder:
        made = pathlib.Path(folder) / "belly.msh"
        mesh_surface(*surface_of(muscle, -high, high, GRID_SPACING), made, given.size, ("skin", "muscle"))
        points, tetrahedra, _, _ = read_mesh(made)
    x, y, z = points[tetrahedra].mean(axis=1).T
    fibres = np.stack([np.ones_like(x), y * slope(x) / radius(x), z * slope(x) / radius(x)], axis=1)
    fibres /= np.linalg.norm(fibres, axis=1)[:, None]
    outside = surface_triangles(tetrahedra)
    ends = outside[(np.abs(points[outside, 0]) > HALF_LENGTH - 0.005).all(axis=1)]
    write_mesh(given.out.resolve() / "muscle.msh", points, tetrahedra, np.zeros(len(tetrahedra), int), ["muscle"],
               [("tendons", ends)], ("fibres", fibres))


if __name__ == "__main__":
    main()
