"""Reader for Medit .mesh text files. meshio refuses files with keywords that it does not know."""
import numpy as np

from body import Body, add_parts, add_point_parts, wrong
from lines import data_lines, node_numbers

KINDS = {"edges": ("line", 2), "triangles": ("triangle", 3), "quadrilaterals": ("quad", 4), "tetrahedra": ("tetra", 4),
         "tetrahedrap2": ("tetra10", 10), "hexahedra": ("hexahedron", 8), "hexaedra": ("hexahedron", 8),
         "prisms": ("wedge", 6), "pyramids": ("pyramid", 5)}


class Medit:
    """The words of a file, and the contents of its keywords."""

    def __init__(self, path):
        self.path = path
        self.words = [(line, word) for line, text in data_lines(path) for word in text.split()]
        self.at, self.dimension, self.points, self.refs = 0, 3, None, None
        self.cells = {}  # kind -> (0-based nodes, numbers of parts)
        while self.at < len(self.words):
            line, word = self.words[self.at]
            self.at += 1
            self.keyword(line, word.lower())
        if self.points is None:
            wrong(path, None, "there are no Vertices in it: the file is truncated, or is not a Medit mesh")

    def keyword(self, line, word):
        if word == "dimension":
            self.dimension = int(self.take(1, 1)[0, 0])
        elif word == "vertices":
            rows = self.take(self.count(), self.dimension + 1)
            self.points, self.refs = rows[:, :-1], rows[:, -1].astype(np.int64)
        elif word in KINDS:
            kind, nodes = KINDS[word]
            rows = self.take(self.count(), nodes + 1).astype(np.int64)
            self.cells[kind] = rows[:, :-1] - 1, rows[:, -1]
        elif word[:1].isalpha():  # corners, ridges, normals and required entities are not cells
            while self.at < len(self.words) and not self.words[self.at][1][:1].isalpha():
                self.at += 1
        else:
            wrong(self.path, line, f"expected a keyword of Medit, found \"{word[:60]}\"")

    def count(self):
        return int(self.take(1, 1)[0, 0])

    def take(self, rows, width):
        words = self.words[self.at:self.at + rows * width]
        line = words[0][0] if words else None
        if len(words) < rows * width:
            wrong(self.path, line, f"expected {rows * width} numbers, found {len(words)}: the file is truncated")
        self.at += rows * width
        try:
            return np.array([word for _, word in words], dtype=float).reshape(rows, width)
        except ValueError:
            bad = next(number for number, word in words if not is_number(word))
            wrong(self.path, bad, "expected a number: the file is truncated")


def is_number(word):
    try:
        return bool(float(word)) or True
    except ValueError:
        return False


def read_medit(path):
    """Reads a mesh. Part numbers become groups; required and other marked entities are ignored."""
    medit = Medit(path)
    body, of_blocks = Body(medit.points), {}
    for kind, (nodes, parts) in medit.cells.items():
        if len(nodes):
            of_blocks[body.add(kind, nodes)] = parts
    add_parts(body, "ref", of_blocks)
    add_point_parts(body, "ref", medit.refs)
    return body
