"""Converts the cells of VTK's unstructured grids to a Body."""
import numpy as np

from body import NODES_OF, Body, add_parts, add_point_parts, are_numbers_of_parts, wrong
from polygons import triangles_of_strips

# VTK's type numbers of all cells that are read, or refused by name.
KINDS = {1: "vertex", 2: "poly-vertex", 3: "line", 4: "poly-line", 5: "triangle", 6: "strip", 7: "polygon",
         8: "pixel", 9: "quad", 10: "tetra", 11: "voxel", 12: "hexahedron", 13: "wedge", 14: "pyramid", 21: "line3",
         22: "triangle6", 23: "quad8", 24: "tetra10", 25: "hexahedron20", 26: "wedge15", 27: "pyramid13", 28: "quad9",
         29: "hexahedron27", 42: "polyhedron"}
# Lagrange and Bezier cells of any order; at orders one and two they equal the plain ones.
ANY_ORDER = {68: "line", 69: "triangle", 70: "quad", 71: "tetra", 72: "hexahedron", 73: "wedge", 74: "pyramid"}
PLAIN = {("line", 2): "line", ("line", 3): "line3", ("triangle", 3): "triangle", ("triangle", 6): "triangle6",
         ("tetra", 4): "tetra", ("tetra", 10): "tetra10", ("quad", 4): "quad", ("quad", 9): "quad9"}


def refuse_grid(path, line, kind):
    """Refuses a grid that is not unstructured."""
    if kind.lower() == "polydata":
        wrong(path, line, "it is a surface of VTK's PolyData, which is not read: save it as .stl (3D Slicer: Export to "
                          "File, STL; ParaView: File, Save Data, STL)")
    wrong(path, line, f"it is a {kind}; only unstructured grids of tetrahedra are read: convert it (ParaView: filter "
                      "Tetrahedralize, then Save Data, .vtu)")


def kind_of(number, nodes):
    if number in ANY_ORDER:
        return PLAIN.get((ANY_ORDER[number], nodes), f"{ANY_ORDER[number]} of {nodes} nodes")
    return KINDS.get(number, f"cell of VTK's type {number}")


def body_of(path, points, types, begins, nodes, cell_arrays, point_arrays):
    """Returns a Body. begins: indices into `nodes` of the first node of each cell, and the end. Arrays: name -> one row for each
    cell or point."""
    types, begins = np.asarray(types, dtype=np.int64), np.asarray(begins, dtype=np.int64)
    nodes, sizes = np.asarray(nodes, dtype=np.int64), np.diff(begins)
    if len(begins) != len(types) + 1 or (sizes < 0).any() or begins[-1] > len(nodes):
        wrong(path, None, f"the list of nodes does not match its {len(types)} cells: the file is truncated")
    body, cells_of = Body(points), {}  # cells_of: block -> cells of the file
    for number, size in sorted(set(zip(types.tolist(), sizes.tolist()))):
        cells = np.flatnonzero((types == number) & (sizes == size))
        rows = nodes[begins[cells][:, None] + np.arange(size)]
        kind = kind_of(number, size)
        if kind == "strip":
            of_strips = [triangles_of_strips(row.tolist()) for row in rows]
            cells, kind = np.repeat(cells, [len(triangles) for triangles in of_strips]), "triangle"
            rows = [triangle for triangles in of_strips for triangle in triangles]
        elif kind == "pixel":
            rows, kind = rows[:, [0, 1, 3, 2]], "quad"
        elif NODES_OF.get(kind, size) != size:
            wrong(path, None, f"cell {cells[0]} (counted from 0) is a {kind} of {size} nodes, not {NODES_OF[kind]}; "
                              "save the file again")
        if len(rows):
            cells_of[body.add(kind, rows)] = cells
    for name, array in cell_arrays.items():
        if len(array) != len(types):
            body.notes.append(f"the array \"{name}\" has {len(array)} rows for {len(types)} cells, and is ignored")
        elif array.ndim == 2 and array.shape[1] == 3:
            body.vectors[name] = {block: array[cells] for block, cells in cells_of.items()}
        elif are_numbers_of_parts(name, [array]):
            add_parts(body, name, {block: array[cells] for block, cells in cells_of.items()})
    for name, array in point_arrays.items():
        if len(array) == len(body.points) and are_numbers_of_parts(name, [array]):
            add_point_parts(body, name, array)
    return body
