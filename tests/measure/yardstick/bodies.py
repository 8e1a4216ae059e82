#!/usr/bin/python3
"""Writes the bodies of the yardstick into `bodies`: a mesh (.msh), a scene (.toml) and, for others, the same as quadratic
tetrahedra with the numbers of the held and the moved nodes (.vtu). They define the benchmark, so they are kept in the
repository, and only a new edition of the benchmark may change them.

    tests/measure/yardstick/bodies.py

The shapes are bent boxes of tetrahedra. Nothing is random."""
import dataclasses
import pathlib
import sys
import typing

import numpy as np

HERE = pathlib.Path(__file__).resolve().parent
ROOT = HERE.parents[2]
sys.path[:0] = [str(ROOT / "tests" / "verification"), str(ROOT / "deploy" / "scenes")]

from hard_reference import box
from layers import surface_triangles, upright, vertex_normals, volumes, write_mesh

BODIES = HERE / "bodies"
PLACES = 40
LARGEST = 10  # N: the force on a tool
TOP = 1e-6   # m: nodes nearer than this to the plane of a support are held


@dataclasses.dataclass
class Shape:
    cells: tuple[int, int, int]
    bend: typing.Callable    # from the unit box (n x 3) to the body (n x 3, m)
    held: str                # the table [fixed]
    material: str
    radius: float            # m: of the rigid patches
    reach: float             # m: the largest displacement
    parts: typing.Callable = lambda middles: np.zeros(len(middles), int)  # of tetrahedra, from the middles in the unit box
    names: tuple[str, ...] = ("tissue",)


def dome(t):
    """Half a ball of radius 40 mm on the plane x = 0; only three quarters round, so that no tetrahedron is flat."""
    x, y, z = (2 * t[:, :2] - 1).T[0], (2 * t[:, 1] - 1), t[:, 2]
    s = 0.75
    ball = np.stack([z * np.sqrt(1 - s * (x**2 + y**2) / 2 + s * x**2 * y**2 / 3),
                     x * np.sqrt(1 - s * (y**2 + z**2) / 2 + s * y**2 * z**2 / 3),
                     y * np.sqrt(1 - s * (z**2 + x**2) / 2 + s * z**2 * x**2 / 3)], axis=1)
    return 0.04 * ball


def flap(t):
    """50 x 40 x 5 mm, clamped at x = 0, and bent upwards like an ear."""
    x, y = t[:, 0], t[:, 1] - 0.5
    narrow = 1 - 0.4 * x**2
    return np.stack([0.05 * x, 0.04 * y * narrow, 0.005 * t[:, 2] + 0.012 * x**2 + 0.03 * y**2 * narrow], axis=1)


def layers(t):
    """48 x 48 mm; 18 mm of fat under 2 mm of skin, whose surface is wavy."""
    height = np.where(t[:, 2] > 0.67, 0.020, 0.018 * t[:, 2] / (2 / 3))
    wave = 1 + 0.15 * np.sin(5 * t[:, 0]) * np.cos(4 * t[:, 1])
    return np.stack([0.048 * t[:, 0], 0.048 * t[:, 1], height * wave], axis=1)


def tube(t):
    """A hollow vessel, 60 mm long, 40 mm wide in the middle, with a wall of 7 mm, held at x = 0."""
    turn, wall = 2 * np.pi * t[:, 1], 0.012 + 0.003 * np.sin(np.pi * t[:, 0]) + 0.007 * t[:, 2]
    return np.stack([0.06 * t[:, 0], wall * np.cos(turn), wall * np.sin(turn)], axis=1)


def muscle(t):
    """A spindle of 80 mm, 24 to 36 mm wide, with fibres along x, held at both ends."""
    y, z = (2 * t[:, 1:] - 1).T
    wide = 0.012 + 0.006 * np.sin(np.pi * t[:, 0])
    round_y, round_z = y * np.sqrt(1 - 0.35 * z**2), z * np.sqrt(1 - 0.35 * y**2)
    return np.stack([0.08 * t[:, 0], wide * round_y, wide * round_z], axis=1)


AT_ZERO = 'below = { axis = "x", at = 1e-6 }'
SHAPES = {
    "dome": Shape((4, 4, 3), dome, AT_ZERO, '[material]\nlaw = "neo-hookean"\nmu = 1667.0\ndensity = 950.0\n\n'
                  "[gravity]\nacceleration = [0, 0, -9.81]\n", 0.0145, 0.010),
    "flap": Shape((6, 5, 1), flap, AT_ZERO, '[material]\nlaw = "yeoh"\nc10 = 20000.0\nc20 = 5000.0\nc30 = 2000.0\n', 0.0108, 0.010),
    "layers": Shape((4, 4, 3), layers, 'below = { axis = "z", at = 1e-6 }',
                    '[[region]]\ngroup = "fat"\nlaw = "mooney-rivlin"\nc10 = 700.0\nc01 = 400.0\n\n'
                    '[[region]]\ngroup = "skin"\nlaw = "neo-hookean"\nmu = 20000.0\n', 0.0137, 0.006,
                    lambda middles: (middles[:, 2] > 2 / 3).astype(int), ("fat", "skin")),
    "tube": Shape((5, 10, 1), tube, AT_ZERO, '[material]\nlaw = "veronda-westmann"\nc1 = 1500.0\nc2 = 2.0\n', 0.0115, 0.006),
    "muscle": Shape((6, 3, 3), muscle, AT_ZERO + '\nabove = { axis = "x", at = 0.079999 }',
                    '[material]\nlaw = "holzapfel-gasser-ogden"\nmu = 3870.0\nk1 = 8000.0\nk2 = 2.0\nfiber = [1, 0, 0]\n',
                    0.0125, 0.008),
}

SCENE = """# A body of docs/yardstick.md. Lengths are in metres.
name = "{name}"
mesh = "{name}.msh"
length_unit = "m"

{material}
[discretization]
displacement = "P2"
pressure = "P1"

[fixed]
{held}

[workspace]
radius = {reach}
spacing = {spacing}
max_force = {largest}
{places}"""
PLACE = """
[[active]]
name = "{name}"
node = {node}
radius = {radius}
"""


def joined(points, tetrahedra):
    """Joins nodes at the same place, as at the seam of a tube."""
    _, first, same = np.unique(np.round(points, 9), axis=0, return_index=True, return_inverse=True)
    order = np.argsort(np.argsort(first))
    return points[np.sort(first)], order[same.ravel()][tetrahedra]


def spread(points, allowed, count):
    """Numbers of `count` nodes, each as far as possible from those before."""
    chosen = [int(allowed[0])]
    while len(chosen) < count:
        distance = np.min([np.linalg.norm(points[allowed] - points[node], axis=1) for node in chosen], axis=0)
        if distance.max() < 1e-9:
            raise ValueError(f"only {len(chosen)} places")
        chosen.append(int(allowed[distance.argmax()]))
    return chosen


def nodes_of(points, tetrahedra):
    """Corners and mid-edge nodes of tetrahedra, m x 10 x 3."""
    corners = points[tetrahedra]
    return np.concatenate([corners, (corners[:, [0, 0, 0, 1, 1, 2]] + corners[:, [1, 2, 3, 2, 3, 3]]) / 2], axis=1)


def movable(place, radius, tetrahedra, nodes, held):
    """Returns whether the volume around every node can be kept although the patch is rigid."""
    free = ~held & (np.linalg.norm(nodes - place, axis=2) > radius)
    can = np.zeros(tetrahedra.max() + 1, bool)
    np.logical_or.at(can, tetrahedra, free.any(axis=1)[:, None])
    return can.all()


def write_vtu(file, points, part, tetrahedra, nodes, held, patches):
    """Quadratic tetrahedra in the order of VTK. patches: name, place, radius."""
    places, number = np.unique(np.round(nodes.reshape(-1, 3), 9), axis=0, return_inverse=True)
    cells = number.reshape(-1, 10)
    places[cells[:, :4]] = points[tetrahedra]
    fixed = np.zeros(len(places), int)
    fixed[cells[held]] = 1
    cells = cells[:, [0, 1, 2, 3, 4, 7, 5, 6, 8, 9]]

    def array(name, kind, values, form="%d", width=1):
        rows = np.asarray(values).reshape(-1, width)
        text = "\n".join(" ".join(form % value for value in row) for row in rows)
        return (f'<DataArray type="{kind}" Name="{name}" NumberOfTuples="{len(rows)}" NumberOfComponents="{width}" '
                f'format="ascii">\n{text}\n</DataArray>\n')

    moved = "".join(array(f"patch_{name}", "Int32", np.flatnonzero((np.linalg.norm(places - place, axis=1) <= radius) & (fixed == 0)))
                    for name, place, radius in patches)
    file.write_text(
        '<?xml version="1.0"?>\n<VTKFile type="UnstructuredGrid" version="1.0" byte_order="LittleEndian">\n<UnstructuredGrid>\n'
        f'<FieldData>\n{moved}</FieldData>\n<Piece NumberOfPoints="{len(places)}" NumberOfCells="{len(cells)}">\n'
        f'<PointData>\n{array("fixed", "UInt8", fixed)}</PointData>\n<CellData>\n{array("part", "Int32", part)}</CellData>\n'
        f'<Points>\n{array("points", "Float64", places, "%.7g", 3)}</Points>\n<Cells>\n'
        f'{array("connectivity", "Int32", cells, "%d", 10)}{array("offsets", "Int32", 10 * np.arange(1, len(cells) + 1))}'
        f'{array("types", "UInt8", np.full(len(cells), 24))}</Cells>\n</Piece>\n</UnstructuredGrid>\n</VTKFile>\n', encoding="utf-8")


def write(name, shape):
    unit, tetrahedra = box((1, 1, 1), shape.cells)
    part = shape.parts(unit[tetrahedra].mean(axis=1))
    points, tetrahedra = joined(shape.bend(unit), tetrahedra)
    tetrahedra = upright(points, tetrahedra)
    size = volumes(points, tetrahedra)
    write_mesh(BODIES / f"{name}.msh", points, tetrahedra, part, list(shape.names))
    nodes = nodes_of(points, tetrahedra)
    along, far = (2, np.inf) if '"z"' in shape.held else (0, points[:, 0].max() - TOP if "above" in shape.held else np.inf)
    held = (nodes[:, :, along] < TOP) | (nodes[:, :, along] > far)
    surface = np.unique(surface_triangles(tetrahedra))
    inner = surface[(points[surface, along] >= TOP) & (points[surface, along] <= far)]
    allowed = np.array([node for node in inner if movable(points[node], shape.radius, tetrahedra, nodes, held)])
    places = spread(points, allowed, PLACES)
    tables = "".join(PLACE.format(name=f"p{i:02d}", node=node, radius=shape.radius) for i, node in enumerate(places))
    (BODIES / f"{name}.toml").write_text(SCENE.format(name=name, material=shape.material, held=shape.held, reach=shape.reach,
                                                     spacing=shape.reach / 2, largest=LARGEST, places=tables), encoding="utf-8")
    patches = [(f"p{i:02d}", points[node], shape.radius) for i, node in enumerate(places)]
    write_vtu(BODIES / f"{name}.vtu", points, part, tetrahedra, nodes, held, patches)
    print(f"{name}: {len(points)} nodes, {len(tetrahedra)} tetrahedra of {1e9 * size.min():.0f} to {1e9 * size.max():.0f} mm^3, "
          f"{len(allowed)} possible places")


def main():
    BODIES.mkdir(exist_ok=True)
    for name, shape in SHAPES.items():
        write(name, shape)


if __name__ == "__main__":
    main()
