"""Reader for TetGen .node and .ele files. meshio does not know tetrahedra with ten nodes."""
import numpy as np

from body import TETGEN_ORDER, Body, add_parts, add_point_parts, wrong
from lines import data_lines, define, node_numbers, numbers, whole


def beside(path, ending):
    """Returns the file of the same name with this extension, in lower or upper case."""
    files = [path.with_suffix(other) for other in (ending, ending.upper(), ending.capitalize())]
    return next((file for file in files if file.is_file()), files[0])


def read_tetgen(path):
    """Reads the .node and the .ele file of the same name, numbered from 0 or 1. Attributes of elements are regions."""
    node_file, ele_file = beside(path, ".node"), beside(path, ".ele")
    lines = data_lines(node_file)
    line, header = next(lines, (1, ""))
    header = numbers(header, node_file, line, kind=int)
    if len(header) < 2 or header[1] != 3:
        wrong(node_file, line, "the first line must be: number of points, 3, number of attributes, number of markers")
    header += [0, 0]
    width = 4 + header[2] + header[3]
    number_of, points, markers = {}, [], []
    for line, text in lines:
        row = numbers(text, node_file, line, width)
        define(number_of, whole(row[0], "node number", node_file, line), len(points), "node", node_file, line)
        points.append(row[1:4])
        markers.append(whole(row[-1], "marker", node_file, line) if header[3] else 0)
    if len(points) != header[0]:
        wrong(node_file, None, f"expected {header[0]} points, found {len(points)}: the file is truncated")
    body = Body(points)
    if len(set(markers)) > 1:
        add_point_parts(body, "marker", np.array(markers))
    lines = data_lines(ele_file)
    line, header = next(lines, (1, ""))
    header = numbers(header, ele_file, line, kind=int) + [0]
    if len(header) < 3 or header[1] not in (4, 10):
        wrong(ele_file, line, "the first line must be: number of tetrahedra, 4 or 10, number of attributes")
    cells, regions = [], []
    for line, text in lines:
        row = numbers(text, ele_file, line, 1 + header[1] + header[2])
        nodes = [whole(node, "node number", ele_file, line) for node in row[1:1 + header[1]]]
        cells.append(node_numbers(nodes, number_of, ele_file, line))
        regions.append(row[1 + header[1]] if header[2] else 0)
    if len(cells) != header[0]:
        wrong(ele_file, None, f"expected {header[0]} tetrahedra, found {len(cells)}: the file is truncated")
    cells = np.array(cells, dtype=np.int64).reshape(-1, header[1])
    block = body.add("tetra", cells) if header[1] == 4 else body.add("tetra10", cells[:, TETGEN_ORDER])
    if header[2]:
        add_parts(body, "region", {block: np.array(regions)})
    return body
