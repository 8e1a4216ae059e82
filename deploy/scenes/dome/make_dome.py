#!/usr/bin/python3
"""Makes dome.msh beside this script: half a ball of gel on a wall, its pole along x. Metres.

    apt-get install gmsh
    deploy/scenes/dome/make_dome.py [--out DIR] [--size EDGE]
"""
import argparse
import pathlib
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent))
from implicit_body import mesh_geometry

RADIUS = 0.05

GEO = """
SetFactory("OpenCASCADE");
Sphere(1) = {{0, 0, 0, {radius}, 0, Pi/2, 2*Pi}};
Rotate {{{{0, 1, 0}}, {{0, 0, 0}}, Pi/2}} {{ Volume{{1}}; }}
wall() = Surface In BoundingBox{{-1e-4, -1, -1, 1e-4, 1, 1}};
Physical Volume("gel") = {{1}};
Physical Surface("wall") = wall();
"""


def main():
    here = pathlib.Path(__file__).resolve().parent
    options = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    options.add_argument("--out", type=pathlib.Path, default=here, help="folder for the mesh (beside this script)")
    options.add_argument("--size", type=float, default=0.0088, help="length of an edge, m")
    given = options.parse_args()
    given.out.mkdir(parents=True, exist_ok=True)
    mesh_geometry(GEO.format(radius=RADIUS), given.out.resolve() / "dome.msh", given.size)


if __name__ == "__main__":
    main()
