"""Writes a mesh for Palpate: tetrahedra in Gmsh's format 2.2, or the triangles of a surface."""
import numpy as np

from body import DIMENSIONS, GMSH_ORDER, WRITTEN
from polygons import cut

SURFACE_CELLS = ("triangle", "triangle6", "quad", "quad8", "quad9", "polygon")


def safe(name):
    return " ".join(str(name).replace('"', "'").split())


def write_volume(body, output):
    physical = {}  # (dimension, name) -> number
    lists = {block: [[] for _ in cells] for block, (kind, cells) in enumerate(body.blocks) if kind in WRITTEN}
    of_points = {safe(name): nodes for name, nodes in sorted(body.point_groups.items()) if safe(name)}
    for (dimension, name), members in sorted(body.groups.items()):
        name = safe(name)
        if name in of_points:  # readers of Gmsh files would merge both into one group
            name += " elements" if dimension == 3 else f" ({DIMENSIONS[dimension]})"
            body.notes.append(f"\"{name}\" has the cells of a set, because a set of nodes has the same name")
        if not name:
            continue
        number = physical.setdefault((dimension, name), len(physical) + 1)
        for block, cells in members.items():
            for cell in cells:
                lists[block][cell].append(number)
    for name in of_points:
        physical.setdefault((0, name), len(physical) + 1)

    element, lines, first = 0, [], {}
    for name, nodes in of_points.items():
        number = physical[0, name]
        for node in np.unique(np.asarray(nodes, dtype=np.int64)):
            element += 1
            lines.append(f"{element} 15 2 {number} {number} {node + 1}")
    for block, (kind, cells) in enumerate(body.blocks):
        if kind not in WRITTEN:
            continue
        gmsh, dimension, _ = WRITTEN[kind]
        order = cells[:, GMSH_ORDER] if kind == "tetra10" else cells
        for cell, nodes in enumerate(order + 1):
            numbers_of = lists[block][cell] or ([0] if dimension == 3 else [])
            for number in numbers_of:
                element += 1
                first.setdefault((block, cell), element)
                lines.append(f"{element} {gmsh} 2 {number} {number} " + " ".join(map(str, nodes)))
    with open(output, "w", encoding="utf-8") as out:
        out.write("$MeshFormat\n2.2 0 8\n$EndMeshFormat\n")
        if physical:
            out.write(f"$PhysicalNames\n{len(physical)}\n")
            for (dimension, name), number in physical.items():
                out.write(f'{dimension} {number} "{name}"\n')
            out.write("$EndPhysicalNames\n")
        out.write(f"$Nodes\n{len(body.points)}\n")
        for n, point in enumerate(body.points.tolist(), 1):
            out.write(f"{n} {point[0]!r} {point[1]!r} {point[2]!r}\n")
        out.write(f"$EndNodes\n$Elements\n{len(lines)}\n")
        out.writelines(line + "\n" for line in lines)
        out.write("$EndElements\n")
        for name, blocks in sorted(body.vectors.items()):
            write_vectors(body, name, blocks, first, out)


def write_vectors(body, name, blocks, element_of, out):
    """Writes the vectors of the tetrahedra. element_of: their numbers in the file by (block, cell)."""
    rows = [(element_of[block, cell], vector) for block, array in blocks.items()
            if body.blocks[block][0] in ("tetra", "tetra10") for cell, vector in enumerate(array)]
    if not rows:
        return
    if not all(np.isfinite(vector).all() for _, vector in rows):
        body.notes.append(f"the vectors \"{safe(name)}\" are ignored, because some are not finite")
        return
    out.write(f'$ElementData\n1\n"{safe(name)}"\n1\n0\n3\n0\n3\n{len(rows)}\n')
    for number, vector in rows:
        out.write(f"{number} " + " ".join(repr(float(x)) for x in vector) + "\n")
    out.write("$EndElementData\n")


def triangles_of(body):
    triangles = [np.zeros((0, 3), dtype=np.int64)]
    for kind, cells in body.blocks:
        if kind in SURFACE_CELLS and len(cells):
            corners = {"triangle6": 3, "quad8": 4, "quad9": 4}.get(kind)
            polygons = [list(cell)[:corners] for cell in cells]
            triangles.append(cells if kind == "triangle" else cut(body.points, polygons))
    return np.concatenate(triangles)


def write_surface(body, triangles, output):
    with open(output, "wb") as out:
        out.write(np.array([len(body.points), len(triangles)], dtype="<i8").tobytes())
        out.write(body.points.astype("<f8").tobytes())
        out.write(triangles.astype("<i4").tobytes())
