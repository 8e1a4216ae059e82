#!/usr/bin/python3
"""Makes skin.msh beside this script: a block of fat under dermis and epidermis, with a stiff ball in the fat. Metres.

    apt-get install python3-numpy gmsh
    deploy/scenes/skin/make_skin.py [--out DIR] [--inclusion X Y DEPTH RADIUS | --none] [--size EDGE]

x and y are measured from the middle of the block. DEPTH is the depth of the ball's centre below the surface of the skin. The
skin is two layers of flat elements grown on top of the fat. With elements as small as the epidermis is thick, there would be
300 times as many.
"""
import argparse
import pathlib
import sys
import tempfile

import numpy as np

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent))
from implicit_body import mesh_geometry
from layers import grow, read_mesh, surface_triangles, write_mesh

WIDTH = 0.072
FAT = 0.017
LAYERS = (("dermis", 0.002), ("epidermis", 0.001))  # from the bottom up
INCLUSION = (0.012, -0.009, 0.010, 0.006)

GEO = """
SetFactory("OpenCASCADE");
Box(1) = {{-{width}/2, -{width}/2, 0, {width}, {width}, {fat}}};
"""
BALL = """
Sphere(2) = {{{x}, {y}, {z}, {radius}}};
BooleanFragments{{ Volume{{1}}; Delete; }}{{ Volume{{2}}; Delete; }}
Physical Volume("inclusion") = {{2}};
Physical Volume("fat") = {{3}};
"""


def skin(out, inclusion=INCLUSION, size=0.006):
    """Writes the mesh to the file `out`. inclusion: (x, y, depth, radius), m, or None."""
    thickness = sum(thick for _, thick in LAYERS)
    geo = GEO.format(width=WIDTH, fat=FAT)
    if inclusion is None:
        geo += 'Physical Volume("fat") = {1};\n'
    else:
        x, y, depth, radius = inclusion
        geo += BALL.format(x=x, y=y, z=FAT + thickness - depth, radius=radius)
    with tempfile.TemporaryDirectory() as folder:
        mesh_geometry(geo, pathlib.Path(folder) / "fat.msh", size)
        points, tetrahedra, group, group_names = read_mesh(pathlib.Path(folder) / "fat.msh")
    names = sorted(group_names.values())
    part = np.array([names.index(group_names[number]) for number in group])

    outside = surface_triangles(tetrahedra)
    def on(height):
        return outside[(np.abs(points[outside, 2] - height) < 1e-6).all(axis=1)]
    bottom, top = on(0), on(FAT)
    for name, thick in LAYERS:
        points, layer, top = grow(points, tetrahedra, top, np.tile([0, 0, thick], (len(points), 1)))
        tetrahedra = np.concatenate([tetrahedra, layer])
        part = np.concatenate([part, np.full(len(layer), len(names))])
        names.append(name)
    write_mesh(out, points, tetrahedra, part, names, [("fascia", bottom)])


def main():
    here = pathlib.Path(__file__).resolve().parent
    options = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    options.add_argument("--out", type=pathlib.Path, default=here, help="folder for the mesh (beside this script)")
    ball = options.add_mutually_exclusive_group()
    ball.add_argument("--inclusion", type=float, nargs=4, default=INCLUSION, metavar=("X", "Y", "DEPTH", "RADIUS"))
    ball.add_argument("--none", action="store_true", help="no inclusion")
    options.add_argument("--size", type=float, default=0.006, help="length of an edge, m")
    given = options.parse_args()
    given.out.mkdir(parents=True, exist_ok=True)
    skin(given.out.resolve() / "skin.msh", None if given.none else given.inclusion, given.size)


if __name__ == "__main__":
    main()
