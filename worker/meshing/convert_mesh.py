"""Reads a mesh of any format and writes what palpate reads: run by `palpate mesh` (mesh_conversion.hpp).

    python3 convert_mesh.py INPUT OUTPUT [--straight]

A mesh with tetrahedra becomes Gmsh's format 2.2, ASCII, with its groups; one of triangles alone the bytes that
closed_surface.cpp reads: two int64 (points, triangles), the points as float64, the triangles as int32. The first line
of stdout says which, "volume" or "surface"; each further line is a note for people. Exit 2 and one sentence on stderr
where the input is wrong, 3 and the name of a Python module where that is missing.

Formats with a reader here: those of which meshio loses groups (.inp, binary .msh), or that it does not know (.feb,
TetGen of ten nodes), and plain surfaces, whose errors then name the line. Everything else is read by meshio.
"""
import sys

sys.path[:] = [folder for folder in sys.path if folder]  # not the current one: files of others lie there

import contextlib
import errno
import io
import pathlib
import signal
import xml.parsers.expat

try:
    import numpy as np
except ModuleNotFoundError:
    print("numpy", file=sys.stderr)
    sys.exit(3)


class Wrong(Exception):
    """What is wrong with the input, as a sentence."""


class Unwritable(Exception):
    """Why the output could not be written."""


def wrong(source, line, what):
    raise Wrong(f"{source}:{line}: {what}" if line else f"{source}: {what}")


# Gmsh's number, dimension and number of nodes of every kind of cell that is written.
WRITTEN = {"vertex": (15, 0, 1), "line": (1, 1, 2), "line3": (8, 1, 3), "triangle": (2, 2, 3), "triangle6": (9, 2, 6),
           "tetra": (4, 3, 4), "tetra10": (11, 3, 10)}
# Corners of the edges of a tetrahedron in the order of VTK's mid-edge nodes, which Abaqus and FEBio share.
EDGES = ((0, 1), (1, 2), (0, 2), (0, 3), (1, 3), (2, 3))
# VTK's order from Gmsh's and back: the last two change places.
GMSH_ORDER = [0, 1, 2, 3, 4, 5, 6, 7, 9, 8]
# VTK's order from TetGen's, which its manual does not tell (found from its -o2).
TETGEN_ORDER = [0, 1, 2, 3, 6, 7, 9, 5, 8, 4]
# Of arrays with more different numbers the numbers are counted, not names of parts.
MOST_PARTS = 64
SURFACE_CELLS = ("triangle", "triangle6", "quad", "quad8", "quad9", "polygon")
DIMENSIONS = ("point", "curve", "surface", "volume")


class Body:
    """Cells in blocks of one kind, and what names parts of them."""

    def __init__(self, points):
        points = np.asarray(points, dtype=float)
        self.points = points.reshape(len(points), -1) if len(points) else np.zeros((0, 3))
        self.blocks = []  # (kind, nodes n x k), tetra10 in VTK's order
        self.groups = {}  # (dimension, name) -> {block: set of cells as an array}
        self.point_groups = {}  # name -> nodes
        self.vectors = {}  # name -> {block: n x 3}
        self.notes = []  # for people

    def add(self, kind, nodes):
        self.blocks.append((kind, np.asarray(nodes, dtype=np.int64)))
        return len(self.blocks) - 1

    def group(self, name, block, cells):
        cells = np.asarray(cells, dtype=np.int64)
        kind = self.blocks[block][0]
        if len(cells) == 0 or kind not in WRITTEN:
            return
        members = self.groups.setdefault((WRITTEN[kind][1], name), {})
        members[block] = np.union1d(members.get(block, cells), cells)

    def group_of(self, places, name):
        """The cells at (block, cell)."""
        for block in {block for block, _ in places}:
            self.group(name, block, [cell for of, cell in places if of == block])


# ---- Formats with a reader of their own --------------------------------------------------------


def numbers(text, source, line, count=None, kind=float, commas=False):
    """commas: between the numbers; else one is the decimal sign of another country, and refused."""
    words = (text.replace(",", " ") if commas else text).split()
    try:
        found = [kind(word) for word in words]
    except ValueError:
        wrong(source, line, f"\"{text.strip()[:60]}\" where numbers are expected")
    if count is not None and len(found) != count:
        wrong(source, line, f"{len(found)} numbers where {count} are expected")
    return found


def node_numbers(ids, number_of, source, line):
    try:
        return [number_of[i] for i in ids]
    except KeyError as missing:
        wrong(source, line, f"node {missing} is used and not defined")


def data_lines(path, comment="#"):
    """(number, text) of lines that say something; what follows `comment` says nothing."""
    try:
        with open(path, encoding="utf-8", errors="replace") as lines:
            for number, line in enumerate(lines, 1):
                text = line.split(comment)[0].strip()
                if text:
                    yield number, text
    except OSError as error:
        wrong(path, None, error.strerror)


def read_stl(path):
    data = path.read_bytes()
    binary = len(data) >= 84 and (b"\0" in data[:4096] or not data.lstrip().lower().startswith(b"solid"))
    count = int.from_bytes(data[80:84], "little")
    if len(data) >= 84:
        if len(data) == 84 + 50 * count or binary and len(data) > 84 + 50 * count:  # some write more behind
            facets = np.frombuffer(data, np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("more", "<u2")]),
                                   count, 84)
            corners = facets["corners"].astype(float).reshape(-1, 3)
            return surface_of(corners, np.arange(len(corners)).reshape(-1, 3))
    if binary:
        wrong(path, None, f"it announces {count} triangles in {84 + 50 * count} bytes, and has {len(data)}: "
                          "the file is truncated, or no STL")
    if not data.lstrip().lower().startswith(b"solid"):
        wrong(path, 1, "this is no STL file: it begins neither with \"solid\" nor with 84 bytes of a header")
    corners, last = [], 0
    for number, line in enumerate(data.decode("latin-1").splitlines(), 1):
        words = line.lower().split()
        if words and words[0] == "vertex":
            corners.append(numbers(" ".join(words[1:]), path, number, 3))
            last = number
    if len(corners) % 3:
        wrong(path, last, "the last triangle has not three corners: the file is truncated")
    return surface_of(np.array(corners).reshape(-1, 3), np.arange(len(corners)).reshape(-1, 3))


def surface_of(points, triangles):
    body = Body(points)
    body.add("triangle", triangles)
    return body


def polygons_of(points, polygons):
    """A surface of polygons, cut into triangles."""
    return surface_of(points, cut(points, polygons))


def cut(points, polygons):
    """Triangles of polygons: n x 3."""
    points = np.asarray(points, dtype=float).reshape(len(points), -1)[:, :3]
    by_size = {}
    for polygon in polygons:
        by_size.setdefault(len(polygon), []).append(polygon)
    triangles = [np.zeros((0, 3), dtype=np.int64)]
    for size, alike in by_size.items():
        alike = np.array(alike, dtype=np.int64)
        fan = np.stack([alike[:, [0, i, i + 1]] for i in range(1, size - 1)])
        a, b, c = (points[fan[:, :, i]] for i in range(3))
        normals = np.cross(b - a, c - a)
        plain_ones = ((normals * normals.sum(axis=0)).sum(axis=2) > 0).all(axis=0) | (size == 3)
        triangles.append(fan[:, plain_ones].reshape(-1, 3))
        triangles += [np.array(ears(points, list(polygon))) for polygon in alike[~plain_ones]]
    return np.concatenate(triangles)


def ears(points, polygon):
    """Triangles of a polygon of more corners, which need not be convex: ears are cut off (Meisters 1975)."""
    corners = points[polygon]
    normal = np.cross(corners, np.roll(corners, -1, axis=0)).sum(axis=0)  # twice its area, as a vector
    axis = int(np.abs(normal).argmax())
    flat = np.delete(points[polygon], axis, axis=1)
    turn = (1 if normal[axis] >= 0 else -1) * (-1 if axis == 1 else 1)

    def area(a, b, c):
        return turn * ((flat[b][0] - flat[a][0]) * (flat[c][1] - flat[a][1])
                       - (flat[b][1] - flat[a][1]) * (flat[c][0] - flat[a][0]))

    left, triangles = list(range(len(polygon))), []
    while len(left) > 3:
        for n, b in enumerate(left):
            a, c = left[n - 1], left[(n + 1) % len(left)]
            others = (p for p in left if p not in (a, b, c))
            if area(a, b, c) > 0 and not any(min(area(a, b, p), area(b, c, p), area(c, a, p)) >= 0 for p in others):
                break
        else:
            n, b = 1, left[1]  # degenerate: what it encloses is looked at later
            a, c = left[0], left[2]
        triangles.append((polygon[a], polygon[b], polygon[c]))
        del left[n]
    return [*triangles, tuple(polygon[n] for n in left)]


def read_obj(path):
    points, polygons = [], []
    for number, line in data_lines(path):
        words = line.split()
        if words[0] == "v":
            points.append(numbers(" ".join(words[1:4]), path, number, 3))
        elif words[0] == "f":
            corners = numbers(" ".join(word.split("/")[0] for word in words[1:]), path, number, kind=int)
            corners = [c - 1 if c > 0 else len(points) + c for c in corners]
            if len(corners) < 3 or min(corners) < 0 or max(corners) >= len(points):
                wrong(path, number, f"a face of corners that are not there: {len(points)} are defined before it")
            polygons.append(corners)
    return polygons_of(points, polygons)


def read_off(path):
    words = [(number, word) for number, line in data_lines(path) for word in line.split()]
    if not words or words[0][1].upper() != "OFF":
        wrong(path, 1, "this is no plain OFF file: it does not begin with OFF alone (COFF, NOFF and binary ones are not "
                       "read; save it as .stl, or as OFF without colours and normals)")
    at = 1

    def take(count, kind):
        nonlocal at
        if at + count > len(words):
            wrong(path, words[-1][0], "the file is truncated")
        line = words[at][0] if count else None
        taken = numbers(" ".join(word for _, word in words[at:at + count]), path, line, count, kind)
        at += count
        return taken

    n_points, n_faces, _ = take(3, int)
    points = np.array(take(3 * n_points, float)).reshape(-1, 3)
    polygons = []
    for _ in range(n_faces):
        line = words[at][0] if at < len(words) else None
        corners = take(take(1, int)[0], int)
        if len(corners) < 3 or min(corners) < 0 or max(corners) >= n_points:
            wrong(path, line, f"a face of corners that are not there: there are {n_points}")
        polygons.append(corners)
        while at < len(words) and words[at][0] == line:  # a colour
            at += 1
    return polygons_of(points, polygons)


PLY_TYPES = {"char": "i1", "int8": "i1", "uchar": "u1", "uint8": "u1", "short": "i2", "int16": "i2", "ushort": "u2",
             "uint16": "u2", "int": "i4", "int32": "i4", "uint": "u4", "uint32": "u4", "float": "f4", "float32": "f4",
             "double": "f8", "float64": "f8"}


def ply_header(path, data):
    """Order of bytes (empty: text), elements as (name, count, [(name, type, type of a list's length or None)])."""
    end = data.find(b"end_header")
    if not data.startswith(b"ply") or end < 0:
        wrong(path, 1, "this is no PLY file, or its header is truncated: there is no ply or no end_header")
    order, elements = None, []
    for number, line in enumerate(data[:end].decode("latin-1").splitlines(), 1):
        words = line.split()
        try:
            if words[:1] == ["format"]:
                order = {"ascii": "", "binary_little_endian": "<", "binary_big_endian": ">"}[words[1]]
            elif words[:1] == ["element"]:
                elements.append((words[1], int(words[2]), []))
            elif words[:1] == ["property"]:
                length = PLY_TYPES[words[2]] if words[1] == "list" else None
                elements[-1][2].append((words[-1], PLY_TYPES[words[-2]], length))
        except (KeyError, IndexError, ValueError):
            wrong(path, number, f"\"{line[:60]}\" is not understood")
    if order is None:
        wrong(path, 1, "its header does not say the format")
    return order, elements, data.find(b"\n", end) + 1


def read_ply(path):
    """Of our own: meshio waits forever for the end of a truncated header."""
    data = path.read_bytes()
    order, elements, at = ply_header(path, data)
    words = iter(data[at:].split()) if order == "" else None

    def take(kind, count):
        nonlocal at
        if words is not None:
            taken = [float(next(words)) for _ in range(count)]
            return taken if kind[0] == "f" else [int(x) for x in taken]
        dtype = np.dtype(order + kind)
        taken = np.frombuffer(data, dtype, count, at)
        at += count * dtype.itemsize
        return taken.tolist()

    points, polygons = [], []
    try:
        for name, count, properties in elements:
            for _ in range(count):
                row = {key: take(kind, 1)[0] if length is None else take(kind, take(length, 1)[0])
                       for key, kind, length in properties}
                if name == "vertex":
                    points.append([row["x"], row["y"], row["z"]])
                elif name == "face":
                    polygons.append(row["vertex_indices"] if "vertex_indices" in row else row["vertex_index"])
    except (StopIteration, RuntimeError, ValueError):
        wrong(path, None, "the file is truncated, or has words where numbers are expected")
    except KeyError as missing:
        wrong(path, None, f"its header has no property {missing}")
    for corners in polygons:
        if len(corners) < 3 or min(corners) < 0 or max(corners) >= len(points):
            wrong(path, None, f"a face of corners that are not there: there are {len(points)}")
    return polygons_of(points, polygons)


def read_tetgen(path):
    """.node and .ele of one name; counted from 0 or 1. Attributes of elements are regions."""
    node_file, ele_file = path.with_suffix(".node"), path.with_suffix(".ele")
    lines = data_lines(node_file)
    line, header = next(lines, (1, ""))
    header = numbers(header, node_file, line, kind=int)
    if len(header) < 2 or header[1] != 3:
        wrong(node_file, line, "the first line is not: number of points, 3, attributes, markers")
    header += [0, 0]
    width = 4 + header[2] + header[3]
    number_of, points, markers = {}, [], []
    for line, text in lines:
        row = numbers(text, node_file, line, width)
        number_of[int(row[0])] = len(points)
        points.append(row[1:4])
        markers.append(int(row[-1]) if header[3] else 0)
    if len(points) != header[0]:
        wrong(node_file, None, f"{header[0]} points are announced, and there are {len(points)}: the file is truncated")
    body = Body(points)
    if len(set(markers)) > 1:
        add_point_parts(body, "marker", np.array(markers))
    lines = data_lines(ele_file)
    line, header = next(lines, (1, ""))
    header = numbers(header, ele_file, line, kind=int) + [0]
    if len(header) < 3 or header[1] not in (4, 10):
        wrong(ele_file, line, "the first line is not: number of tetrahedra, 4 or 10, attributes")
    cells, regions = [], []
    for line, text in lines:
        row = numbers(text, ele_file, line, 1 + header[1] + header[2])
        cells.append(node_numbers([int(i) for i in row[1:1 + header[1]]], number_of, ele_file, line))
        regions.append(row[1 + header[1]] if header[2] else 0)
    if len(cells) != header[0]:
        wrong(ele_file, None, f"{header[0]} tetrahedra are announced, there are {len(cells)}: the file is truncated")
    cells = np.array(cells, dtype=np.int64).reshape(-1, header[1])
    block = body.add("tetra", cells) if header[1] == 4 else body.add("tetra10", cells[:, TETGEN_ORDER])
    if header[2]:
        add_parts(body, "region", {block: np.array(regions)})
    return body


ABAQUS = {"C3D4": "tetra", "C3D10": "tetra10", "C3D8": "hexahedron", "C3D20": "hexahedron20", "C3D6": "wedge",
          "C3D15": "wedge15", "C3D5": "pyramid", "S3": "triangle", "STRI3": "triangle", "CPS3": "triangle",
          "CPE3": "triangle", "R3D3": "triangle", "M3D3": "triangle", "SFM3D3": "triangle", "STRI65": "triangle6",
          "CPS6": "triangle6", "CPE6": "triangle6", "M3D6": "triangle6", "S4": "quad", "CPS4": "quad", "R3D4": "quad",
          "T3D2": "line", "B31": "line", "T3D3": "line3", "B32": "line3"}
NODES_OF = {"hexahedron": 8, "hexahedron20": 20, "wedge": 6, "wedge15": 15, "pyramid": 5, "quad": 4,
            **{kind: row[2] for kind, row in WRITTEN.items()}}


def abaqus_kind(word):
    """C3D10MH is C3D10 with another formulation."""
    matches = [name for name in ABAQUS if word.startswith(name) and not word[len(name):len(name) + 1].isdigit()]
    return ABAQUS[max(matches, key=len)] if matches else None


class Abaqus:
    """Keywords of one .inp with what it includes. Numbers of nodes and elements hold in their part: a scope."""

    def __init__(self, path):
        self.files, self.scope, self.part_of = [path], "", {}  # part_of: instance -> scope
        self.points, self.number_of = [], {}  # number_of: (scope, number) -> point
        self.elements = {}  # (scope, number) -> (kind, points)
        self.sets = {"NSET": {}, "ELSET": {}}  # capitals of the name -> (name, [(scope, number)])
        self.keyword, self.options, self.kind = "", {}, None
        self.pending = []  # of an element whose nodes go on in the next line
        self.read(path)

    def read(self, path):
        for line, text in data_lines(path, comment="**"):
            self.path, self.line = path, line
            if text.startswith("*"):
                self.begin(text)
            elif self.keyword == "NODE":
                self.node(text)
            elif self.keyword == "ELEMENT":
                self.element(text)
            elif self.keyword in self.sets:
                self.members(text)
        self.refuse_half_an_element()

    def wrong(self, what):
        wrong(self.path, self.line, what)

    def refuse_half_an_element(self):
        if self.pending:
            self.wrong(f"element {self.pending[0]} has {len(self.pending) - 1} nodes where {NODES_OF[self.kind]} are expected "
                       "before this line: the file is truncated")

    def begin(self, text):
        self.refuse_half_an_element()
        words = [word.strip() for word in text[1:].split(",")]
        self.keyword = words[0].upper()
        pairs = (word.partition("=") for word in words[1:])
        self.options = {key.strip().upper(): value.strip().strip('"') for key, _, value in pairs}
        if self.keyword == "INCLUDE":
            self.include()
        elif self.keyword in ("PART", "ASSEMBLY", "INSTANCE", "END PART", "END ASSEMBLY", "END INSTANCE"):
            self.enter()
        elif self.keyword in ("NODE", "ELEMENT", "NSET", "ELSET"):
            if "INPUT" in self.options:
                self.wrong(f"INPUT={self.options['INPUT']} is not read: put the lines of that file here, or use *INCLUDE")
            if self.keyword == "ELEMENT":
                word = self.options.get("TYPE", "").upper()
                self.kind = abaqus_kind(word)
                if self.kind is None:
                    self.wrong(f"elements of type {word or '(none)'} are not read; tetrahedra are C3D4 and C3D10")
            elif self.keyword == "NSET" and self.options.get("NSET") and self.options.get("ELSET"):
                self.nodes_of_elements()

    def include(self):
        included = self.path.parent / self.options.get("INPUT", "")
        if included in self.files:
            self.wrong(f"{included} includes itself")
        path = self.path
        self.files.append(included)
        self.keyword = ""
        self.read(included)
        self.files.pop()
        self.path, self.keyword = path, ""

    def enter(self):
        """Parts have numbers of their own, and so has the assembly; an instance has those of its part."""
        if self.keyword == "PART":
            self.scope = "part " + self.options.get("NAME", "").upper()
        elif self.keyword == "INSTANCE":
            self.scope = "part " + self.options.get("PART", "").upper()
            self.part_of[self.options.get("NAME", "").upper()] = self.scope
        else:
            self.scope = "assembly" if self.keyword in ("ASSEMBLY", "END INSTANCE") else ""

    def node(self, text):
        row = numbers(text, self.path, self.line, commas=True)
        if len(row) != 4:
            self.wrong("a node is not a number and three coordinates")
        node = self.scope, int(row[0])
        if node in self.number_of and self.points[self.number_of[node]] != row[1:]:
            self.wrong(f"node {node[1]} is defined twice, at different places; of several parts export one")
        self.number_of[node] = len(self.points)
        self.points.append(row[1:])
        if self.options.get("NSET"):
            self.set_of("NSET").append(node)

    def element(self, text):
        self.pending += numbers(text, self.path, self.line, kind=int, commas=True)
        nodes = self.pending[1:]
        if len(nodes) > NODES_OF[self.kind]:
            self.wrong(f"an element of {len(nodes)} nodes where {NODES_OF[self.kind]} are expected")
        if len(nodes) < NODES_OF[self.kind]:
            return
        element = self.scope, self.pending[0]
        if element in self.elements:
            self.wrong(f"element {element[1]} is defined twice; of several parts export one")
        for node in nodes:
            if (self.scope, node) not in self.number_of:
                self.wrong(f"node {node} is used and not defined")
        self.elements[element] = self.kind, [self.number_of[self.scope, node] for node in nodes]
        if self.options.get("ELSET"):
            self.set_of("ELSET").append(element)
        self.pending = []

    def set_of(self, kind):
        """Members of the set that the options name; names differ by more than capitals."""
        name = self.options.get(kind)
        if not name:
            self.wrong(f"a *{kind} without a name")
        return self.sets[kind].setdefault(name.upper(), (name, []))[1]

    def members(self, text):
        if self.keyword == "NSET" and self.options.get("ELSET"):
            return
        found = self.set_of(self.keyword)
        instance = self.options.get("INSTANCE", "").upper()
        scope = self.part_of.get(instance, self.scope) if instance else self.scope
        if "GENERATE" in self.options:
            row = numbers(text, self.path, self.line, kind=int, commas=True)
            if len(row) not in (2, 3) or (len(row) == 3 and row[2] == 0):
                self.wrong("GENERATE needs first, last and step")
            found += [(scope, n) for n in range(row[0], row[1] + 1, row[2] if len(row) == 3 else 1)]
            return
        for word in (word.strip().strip('"') for word in text.split(",")):
            if word.lstrip("-").isdigit():
                found.append((scope, int(word)))
            elif word:
                found += self.known_set(self.keyword, word)

    def known_set(self, kind, name):
        if name.upper() not in self.sets[kind]:
            self.wrong(f"there is no set \"{name}\" before this line")
        return self.sets[kind][name.upper()][1]

    def nodes_of_elements(self):
        """*NSET, NSET=name, ELSET=elements."""
        elements = self.known_set("ELSET", self.options["ELSET"])
        number = {point: node for node, point in self.number_of.items()}
        self.set_of("NSET").extend(number[point] for e in elements if e in self.elements for point in self.elements[e][1])

    def body(self):
        parts = {scope for (scope, _), (kind, _) in self.elements.items() if kind.startswith("tetra")}
        if len(parts) > 1:
            wrong(self.files[0], None, f"there are tetrahedra in {len(parts)} parts ({', '.join(sorted(parts))}); export one")
        body, by_kind, place = Body(self.points), {}, {}
        for element, (kind, nodes) in self.elements.items():
            by_kind.setdefault(kind, []).append((element, nodes))
        for kind, rows in by_kind.items():
            block = body.add(kind, [nodes for _, nodes in rows])
            place.update({element: (block, i) for i, (element, _) in enumerate(rows)})
        for name, elements in self.sets["ELSET"].values():
            body.group_of([place[element] for element in elements if element in place], name)
            self.note_missing(body, name, elements, place, "element")
        for name, nodes in self.sets["NSET"].values():
            body.point_groups[name] = [self.number_of[node] for node in nodes if node in self.number_of]
            self.note_missing(body, name, nodes, self.number_of, "node")
        return body

    @staticmethod
    def note_missing(body, name, members, known, what):
        missing = sum(member not in known for member in members)
        if missing:
            body.notes.append(f"the set \"{name}\" names {missing} {what}(s) that are not there")


def read_abaqus(path):
    """*NODE, *ELEMENT, *NSET, *ELSET and *INCLUDE, of one part or instance."""
    return Abaqus(path).body()


class Element:
    """One of XML, with the line it begins in."""

    def __init__(self, tag, attributes, line):
        self.tag, self.attributes, self.line = tag, attributes, line
        self.text, self.children = "", []

    def all(self, *tags):
        return [child for child in self.children if child.tag in tags]


def read_xml(path):
    root = Element("", {}, 0)
    open_elements = [root]
    parser = xml.parsers.expat.ParserCreate()

    def begin(tag, attributes):
        element = Element(tag, attributes, parser.CurrentLineNumber)
        open_elements[-1].children.append(element)
        open_elements.append(element)

    def text(more):
        open_elements[-1].text += more

    parser.StartElementHandler = begin
    parser.EndElementHandler = lambda tag: open_elements.pop()
    parser.CharacterDataHandler = text
    parser.buffer_text = True
    try:
        parser.Parse(path.read_bytes(), True)
    except xml.parsers.expat.ExpatError as error:
        wrong(path, error.lineno, f"this is not XML: {xml.parsers.expat.errors.messages[error.code]}")
    return root


FEBIO = {"tet4": "tetra", "tet10": "tetra10", "tri3": "triangle", "tri6": "triangle6", "hex8": "hexahedron",
         "hex20": "hexahedron20", "penta6": "wedge", "penta15": "wedge15", "pyra5": "pyramid", "quad4": "quad"}


def read_febio(path):
    """FEBio 2.5, 3 and 4: Geometry or Mesh with Nodes, Elements, NodeSet, ElementSet, Surface; fibres of MeshData."""
    root = read_xml(path)
    spec = (root.all("febio_spec") or [root])[0]
    meshes = spec.all("Geometry", "Mesh")
    if not meshes:
        wrong(path, spec.line, "there is no <Geometry> or <Mesh>: is this a .feb file of FEBio 2.5 or later?")
    number_of, points, place, lists = {}, [], {}, {}
    nodes_of_set = {}
    for nodes in (n for mesh in meshes for n in mesh.all("Nodes")):
        for node in nodes.all("node"):
            row = numbers(node.text, path, node.line, 3, commas=True)
            number_of[node.attributes.get("id", "")] = len(points)
            points.append(row)
            if nodes.attributes.get("name"):
                nodes_of_set.setdefault(nodes.attributes["name"], []).append(len(points) - 1)
    body = Body(points)

    def ids(element):
        """Of <node id="1"/>, <n id="1"/> and <e id="1"/>, or in the text."""
        return [c.attributes["id"] for c in element.children if "id" in c.attributes] + \
            element.text.replace(",", " ").split()

    for mesh in meshes:
        for part in mesh.all("Elements"):
            kind = FEBIO.get(part.attributes.get("type", "").lower())
            if kind is None:
                wrong(path, part.line, f"elements of type \"{part.attributes.get('type')}\" are not read; "
                                       "tetrahedra are tet4 and tet10")
            cells = []
            for element in part.all("elem", "e"):
                words = element.text.replace(",", " ").split()
                if len(words) != NODES_OF[kind]:
                    wrong(path, element.line, f"{len(words)} nodes where {NODES_OF[kind]} are expected")
                place[element.attributes.get("id", "")] = (len(body.blocks), len(cells))
                cells.append(node_numbers(words, number_of, path, element.line))
            if not cells:
                continue
            block = body.add(kind, cells)
            name = part.attributes.get("name") or (
                f"material {part.attributes['mat']}" if "mat" in part.attributes else "")
            if name:
                body.group(name, block, np.arange(len(cells)))
                lists[name] = [(block, i) for i in range(len(cells))]
        for node_set in mesh.all("NodeSet"):
            name = node_set.attributes.get("name", "")
            listed = node_numbers(ids(node_set), number_of, path, node_set.line)
            for other in node_set.all("NodeSet"):
                listed += nodes_of_set.get(other.attributes.get("node_set", ""), [])
            nodes_of_set[name] = body.point_groups[name] = listed
        for element_set in mesh.all("ElementSet"):
            name = element_set.attributes.get("name", "")
            lists[name] = [place[i] for i in ids(element_set) if i in place]
            body.group_of(lists[name], name)
        for surface in mesh.all("Surface"):
            faces = {}
            for face in surface.children:
                kind = FEBIO.get(face.tag)
                if kind in ("triangle", "triangle6"):
                    words = face.text.replace(",", " ").split()
                    if len(words) != NODES_OF[kind]:
                        wrong(path, face.line, f"{len(words)} nodes where {NODES_OF[kind]} are expected")
                    faces.setdefault(kind, []).append(node_numbers(words, number_of, path, face.line))
            for kind, cells in faces.items():
                body.group(surface.attributes.get("name", ""), body.add(kind, cells), np.arange(len(cells)))
    for data in (d for section in spec.all("MeshData") for d in section.all("ElementData")):
        rows = lists.get(data.attributes.get("elem_set", ""), [])
        name = data.attributes.get("var") or data.attributes.get("name") or data.attributes.get("type") or "fiber"
        for row in data.all("e", "elem"):
            vector = row.text.replace(",", " ").split()
            at = int(row.attributes.get("lid", "0")) - 1
            if len(vector) != 3 or not 0 <= at < len(rows):
                continue
            block, cell = rows[at]
            vectors = body.vectors.setdefault(name, {})
            vectors.setdefault(block, np.zeros((len(body.blocks[block][1]), 3)))[cell] = numbers(
                row.text, path, row.line, 3, commas=True)
    return body


class GmshFile:
    """Numbers of a .msh file of version 2.2 or 4.1, binary or text, section by section."""

    def __init__(self, path):
        self.path, self.data, self.at = path, path.read_bytes(), 0
        if self.line() != "$MeshFormat":
            wrong(path, 1, "this is not a Gmsh .msh file: its first line is not $MeshFormat")
        words = self.line().split()
        self.version, self.binary = words[0], words[1] == "1"
        self.size = np.dtype("<u8") if words[2:] != ["4"] else np.dtype("<u4")
        if self.binary and int.from_bytes(self.bytes(4), "little") != 1:
            wrong(path, 3, "it was written on a machine of another byte order")
        self.words = None

    def line(self):
        end = self.data.find(b"\n", self.at)
        end = len(self.data) if end < 0 else end
        text = self.data[self.at:end].decode("utf-8", "replace").strip()
        self.at = end + 1
        return text

    def bytes(self, count):
        if self.at + count > len(self.data):
            wrong(self.path, None, "the file is truncated")
        self.at += count
        return self.data[self.at - count:self.at]

    def sections(self):
        while self.at < len(self.data):
            line = self.line()
            if line.startswith("$") and not line.startswith("$End"):
                name = line[1:]
                begin = self.at
                end = self.data.find(b"$End" + name.encode(), begin)
                if end < 0:
                    wrong(self.path, None, f"the file is truncated: it ends inside ${name}")
                # A text section is numbers between words; a binary one is read where it lies.
                self.words = None if self.binary else iter(self.data[begin:end].split())
                yield name, begin, end

    def take(self, kind, count=1):
        """`count` numbers: "i" of 32 bits, "s" of the file's size, "d" double."""
        if self.words is not None:
            try:
                return np.array([next(self.words) for _ in range(count)], dtype=float if kind == "d" else np.int64)
            except (StopIteration, ValueError, RuntimeError):
                wrong(self.path, None, "the file is truncated, or has words where numbers are expected")
        dtype = {"i": np.dtype("<i4"), "s": self.size, "d": np.dtype("<f8")}[kind]
        values = np.frombuffer(self.bytes(count * dtype.itemsize), dtype)
        return values if kind == "d" else values.astype(np.int64)


GMSH_KINDS = {number: kind for kind, (number, _, _) in WRITTEN.items()}
GMSH_KINDS.update({3: "quad", 5: "hexahedron", 6: "wedge", 7: "pyramid", 10: "quad9", 12: "hexahedron27", 13: "wedge18",
                   14: "pyramid14", 16: "quad8", 17: "hexahedron20", 18: "wedge15", 19: "pyramid13"})
GMSH_NODES = {**NODES_OF, "quad9": 9, "hexahedron27": 27, "wedge18": 18, "pyramid14": 14, "quad8": 8, "pyramid13": 13}


def read_gmsh(path):
    """Version 2.2 or 4.1; others by meshio."""
    file = GmshFile(path)
    if file.version not in ("2.2", "4.1"):
        return read_by_meshio(path)
    old = file.version == "2.2"
    names, of_entity, tags, points, rows, vectors = {}, {}, [], [], {}, {}
    for section, begin, end in file.sections():
        if section == "PhysicalNames":
            for text in file.data[begin:end].decode("utf-8", "replace").splitlines()[1:]:
                words = text.split(None, 2)
                if len(words) == 3:
                    names[int(words[0]), int(words[1])] = words[2].strip().strip('"')
        elif section == "Entities":
            counts = file.take("s", 4)
            for dimension, count in enumerate(counts):
                for _ in range(count):
                    entity = dimension, int(file.take("i")[0])
                    file.take("d", 6 if dimension else 3)
                    of_entity[entity] = file.take("i", int(file.take("s")[0]))
                    if dimension:
                        file.take("i", int(file.take("s")[0]))
        elif section == "PartitionedEntities":
            wrong(path, None, "the mesh is partitioned: save it whole (in Gmsh, Mesh, Unpartition)")
        elif section == "Nodes":
            if old:
                count = int(file.line()) if file.binary else int(file.take("i")[0])
                for _ in range(count):
                    tags.append(file.take("i")[0])
                    points.append(file.take("d", 3))
            else:
                blocks = file.take("s", 4)[0]
                for _ in range(blocks):
                    dimension, _, parametric = file.take("i", 3)
                    count = int(file.take("s")[0])
                    tags += list(file.take("s", count))
                    width = 3 + (int(dimension) if parametric else 0)
                    points += list(file.take("d", width * count).reshape(count, width)[:, :3])
        elif section == "Elements":
            read_gmsh_elements(file, old, rows, of_entity)
        elif section == "ElementData":
            read_gmsh_vectors(file, begin, vectors)
        file.at = end
    if not rows:
        wrong(path, None, "there is no $Elements section: the file is truncated")
    number_of = {int(tag): n for n, tag in enumerate(tags)}
    body = Body(points)
    for kind, elements in rows.items():
        cells = np.array([node_numbers(map(int, nodes), number_of, path, None) for _, _, nodes in elements])
        if kind == "tetra10":
            cells = cells[:, GMSH_ORDER]
        block = body.add(kind, cells)
        members = {}
        for i, (_, groups, _) in enumerate(elements):
            for key in groups:
                members.setdefault(key, []).append(i)
        for (dimension, number), cells_in in members.items():
            body.group(names.get((dimension, number), f"{DIMENSIONS[dimension]} {number}"), block, cells_in)
        place = {int(tag): i for i, (tag, _, _) in enumerate(elements)}
        for name, values in vectors.items():
            for tag, vector in values.items():
                if tag in place:
                    array = body.vectors.setdefault(name, {}).setdefault(block, np.zeros((len(elements), 3)))
                    array[place[tag]] = vector
    return body


def read_gmsh_elements(file, old, rows, of_entity):
    def kind_of(number):
        if number not in GMSH_KINDS:
            wrong(file.path, None, f"elements of Gmsh's type {number} are not read")
        return GMSH_KINDS[number]

    def add(kind, tag, groups, nodes):
        rows.setdefault(kind, []).append((tag, groups, nodes))

    if not old:
        blocks = file.take("s", 4)[0]
        for _ in range(blocks):
            dimension, entity, number = file.take("i", 3)
            kind, count = kind_of(int(number)), int(file.take("s")[0])
            groups = [(int(dimension), abs(int(g))) for g in of_entity.get((int(dimension), int(entity)), [])]
            for row in file.take("s", count * (1 + GMSH_NODES[kind])).reshape(count, -1):
                add(kind, row[0], groups, row[1:])
        return
    seen = {}  # a cell in several groups stands there once for each

    def add_old(kind, row, n_tags):
        nodes = row[1 + n_tags:]
        dimension = WRITTEN[kind][1] if kind in WRITTEN else -1
        groups = [(dimension, abs(int(row[1])))] if n_tags and row[1] != 0 else []
        key = kind, tuple(sorted(nodes))
        if key in seen and groups and groups[0] not in seen[key]:
            seen[key].append(groups[0])
            return
        seen[key] = groups
        add(kind, row[0], groups, nodes)

    count = int(file.line()) if file.binary else int(file.take("i")[0])
    while count > 0:
        if file.binary:
            number, elements, n_tags = (int(n) for n in file.take("i", 3))
            kind = kind_of(number)
            for row in file.take("i", elements * (1 + n_tags + GMSH_NODES[kind])).reshape(elements, -1):
                add_old(kind, row, n_tags)
            count -= elements
        else:
            tag, number, n_tags = (int(n) for n in file.take("i", 3))
            kind = kind_of(number)
            add_old(kind, np.concatenate([[tag], file.take("i", n_tags + GMSH_NODES[kind])]), n_tags)
            count -= 1


def read_gmsh_vectors(file, begin, vectors):
    file.at, file.words = begin, None
    strings = [file.line() for _ in range(int(file.line()))]
    for _ in range(int(file.line())):
        file.line()
    integers = [int(file.line()) for _ in range(int(file.line()))]
    name = strings[0].strip('"') if strings else ""
    if len(integers) < 3 or integers[1] != 3 or not name or name in vectors:
        return
    values = vectors[name] = {}
    for _ in range(integers[2]):
        if file.binary:
            values[int(file.take("i")[0])] = file.take("d", 3)
        else:
            words = file.line().split()
            values[int(words[0])] = [float(word) for word in words[1:4]]


# ---- Everything else ---------------------------------------------------------------------------


def plain(name):
    """"medit:ref" is "ref"."""
    return name.rsplit(":", 1)[-1]


def are_no_parts(body, name, numbers_in):
    if len(numbers_in) > MOST_PARTS:
        body.notes.append(f"the array \"{plain(name)}\" has {len(numbers_in)} different numbers: too many to name parts")
    return len(numbers_in) > MOST_PARTS or not np.all(numbers_in == np.round(numbers_in))


def add_parts(body, name, values):
    """Cells with one number in an array are a group; with 0 and 1 alone, those of 1, under its name."""
    values = {block: np.asarray(array) for block, array in values.items() if body.blocks[block][0] in WRITTEN}
    if not values or any(array.ndim > 1 and array.shape[1:] != (1,) for array in values.values()):
        return
    values = {block: array.reshape(-1) for block, array in values.items()}
    together = np.concatenate(list(values.values()))
    parts = np.unique(together)
    if are_no_parts(body, name, parts):
        return
    flag = len(parts) == 2 and parts[0] == 0 and parts[1] == 1
    for part in parts:
        if flag and part == 0:
            continue
        for block, array in values.items():
            body.group(plain(name) if flag else f"{plain(name)} {int(part)}", block, np.flatnonzero(array == part))


def add_point_parts(body, name, values):
    """The same of points; 0 is no part."""
    values = np.asarray(values)
    if values.ndim > 1:
        return
    parts = np.unique(values)
    if are_no_parts(body, name, parts):
        return
    flag = len(parts) == 2 and parts[0] == 0 and parts[1] == 1
    for part in parts[parts != 0]:
        body.point_groups[plain(name) if flag else f"{plain(name)} {int(part)}"] = np.flatnonzero(values == part)


def are_numbers_of_parts(name, arrays):
    """Integers, or floats of a name like that of parts; what Gmsh and VTK count for themselves is none."""
    if name == "gmsh:geometrical" or name.startswith("vtk") or name == "gmsh:dim_tags":
        return False
    if all(np.asarray(array).dtype.kind in "iu" for array in arrays):
        return True
    words = ("region", "material", "mat", "part", "label", "tag", "group", "ref", "domain", "fixed")
    return plain(name).lower().replace("_", "").rstrip("s").removesuffix("id") in words


LONGEST_READING = 900  # s


def give_up(*_):
    raise TimeoutError(f"it does not come to an end in {LONGEST_READING} s")


def read_by_meshio(path):
    try:
        import meshio
    except ImportError:
        raise ModuleNotFoundError("meshio", name="meshio") from None
    said = io.StringIO()
    signal.signal(signal.SIGALRM, give_up)  # some of its readers wait forever on files that were cut
    signal.alarm(LONGEST_READING)
    try:
        with contextlib.redirect_stdout(said), contextlib.redirect_stderr(said):
            read = meshio.read(path)
    except ModuleNotFoundError:
        raise
    except BaseException as error:  # meshio ends with sys.exit() where it cannot read
        if isinstance(error, KeyboardInterrupt):
            raise
        text = str(error) if not isinstance(error, SystemExit) else said.getvalue()
        text = " ".join((text or said.getvalue()).replace("Error:", "").split())
        if "deduce" in text:
            known = sorted({*meshio.extension_to_filetypes, ".feb"})
            wrong(path, None, f"no format of this ending is known; there is {', '.join(known)}")
        wrong(path, None, f"meshio cannot read it: {text or type(error).__name__}; is it whole, and of the format that "
                          "its ending says? Another program may save it as .vtu or .msh")
    finally:
        signal.alarm(0)
    return of_meshio(read)


def of_meshio(read):
    body = Body(read.points)
    for cell_block in read.cells:
        body.add(cell_block.type, cell_block.data)
    names = {(int(d), int(n)): name for name, (n, d) in
             ((name, row) for name, row in read.field_data.items() if np.shape(row) == (2,))}
    for name, members in read.cell_sets.items():
        if name.startswith("gmsh:"):
            continue
        for block, cells in enumerate(members):
            if cells is not None:
                body.group(name, block, cells)
    families = getattr(read, "cell_tags", None) or {}
    for name, arrays in read.cell_data.items():
        if all(np.ndim(a) == 2 and np.shape(a)[1] == 3 for a in arrays):
            body.vectors[name] = dict(enumerate(arrays))
        elif name == "gmsh:physical":
            for block, array in enumerate(arrays):
                dimension = WRITTEN.get(body.blocks[block][0], (0, 0, 0))[1]
                for number in np.unique(array[array != 0]):
                    body.group(names.get((dimension, int(number)), f"{DIMENSIONS[dimension]} {number}"), block,
                               np.flatnonzero(array == number))
        elif name == "cell_tags" and families:  # of MED: names by number
            for block, array in enumerate(arrays):
                for number in np.unique(array):
                    for family in families.get(int(number), []):
                        body.group(family, block, np.flatnonzero(array == number))
        elif are_numbers_of_parts(name, arrays):
            add_parts(body, name, dict(enumerate(arrays)))
    for name, nodes in read.point_sets.items():
        body.point_groups[name] = nodes
    families = getattr(read, "point_tags", None) or {}
    for name, array in read.point_data.items():
        if name == "point_tags" and families:
            for number in np.unique(array):
                for family in families.get(int(number), []):
                    body.point_groups[family] = np.flatnonzero(array == number)
        elif are_numbers_of_parts(name, [array]):
            add_point_parts(body, name, array)
    return body


READERS = {".stl": read_stl, ".obj": read_obj, ".off": read_off, ".ply": read_ply, ".node": read_tetgen,
           ".ele": read_tetgen, ".inp": read_abaqus, ".feb": read_febio, ".msh": read_gmsh}


# ---- Checks and output -------------------------------------------------------------------------


def check_points(body, source):
    if body.points.shape[1:] == (2,):
        wrong(source, None, "its points have two coordinates: a mesh of the plane has no volume")
    body.points = np.ascontiguousarray(body.points[:, :3])
    bad = np.flatnonzero(~np.isfinite(body.points).all(axis=1))
    if len(bad):
        wrong(source, None, f"point {bad[0]} (counted from 0) has a coordinate that is not finite")
    for kind, nodes in body.blocks:
        flat = nodes.reshape(-1)
        if len(flat) and (flat.min() < 0 or flat.max() >= len(body.points)):
            wrong(source, None, f"a cell ({kind}) uses point {flat.min() if flat.min() < 0 else flat.max()}, counted "
                                f"from 0; there are {len(body.points)}")


def off_middle(points, cells):
    """How far mid-edge nodes lie off the middles of their edges, and how far is still straight, in lengths: n x 6."""
    off, straight = np.empty((len(cells), 6)), np.empty((len(cells), 6))
    rounding = ROUNDED * np.abs(points).max()
    for e, (a, b) in enumerate(EDGES):
        p, q = points[cells[:, a]], points[cells[:, b]]
        length = np.maximum(np.linalg.norm(q - p, axis=1), 1e-300)
        off[:, e] = np.linalg.norm(points[cells[:, 4 + e]] - (p + q) / 2, axis=1) / length
        straight[:, e] = np.maximum(STRAIGHT, rounding / length)
    return off, straight


# Orders that files of other formats have by mistake.
ORDERS = {"Gmsh": GMSH_ORDER, "TetGen": TETGEN_ORDER}
STRAIGHT = 1e-6  # as common/mesh/mesh.cpp has it: of an edge's length
ROUNDED = 2e-6  # of the largest coordinate: what six digits, or float32, leave of a middle


def put_middles_right(body, source, straight):
    """Ten nodes in VTK's order with straight edges, or four."""
    for i, (kind, cells) in enumerate(body.blocks):
        if kind != "tetra10" or not len(cells):
            continue
        off, allowed = off_middle(body.points, cells)
        if (off > allowed).any():
            for name, order in ORDERS.items():
                other, allowed_there = off_middle(body.points, cells[:, order])
                if (other <= allowed_there).all():
                    body.notes.append(f"its tetrahedra of ten nodes have their mid-edge nodes in {name}'s order; put right")
                    cells, off, allowed = cells[:, order], other, allowed_there
                    break
        if (off <= allowed).all():
            if off.max() > STRAIGHT:
                body.notes.append(f"mid-edge nodes are rounded, off the middles by up to {off.max():.2g} of the edge; "
                                  "put there")
                for e, (a, b) in enumerate(EDGES):
                    body.points[cells[:, 4 + e]] = (body.points[cells[:, a]] + body.points[cells[:, b]]) / 2
            body.blocks[i] = (kind, cells)
        elif straight:
            body.notes.append(f"mid-edge nodes lie off the middles of their edges by up to {off.max():.2g} of the edge; "
                              "the corners are taken, with straight edges")
            body.blocks[i] = ("tetra", cells[:, :4])
        else:
            at, e = np.unravel_index(off.argmax(), off.shape)
            middle = body.points[cells[at, list(EDGES[e])]].mean(axis=0)
            wrong(source, None, f"tetrahedron {at} of ten nodes (counted from 0) has a curved edge at "
                                f"({middle[0]:.6g}, {middle[1]:.6g}, {middle[2]:.6g}): its mid-edge node is off the "
                                f"middle by {off.max():.2g} of its length; of all tetrahedra "
                                f"{np.count_nonzero(off > allowed)} edges are curved; "
                                "--straight takes the corners with straight edges")


def refuse_other_volumes(body, source):
    counts = {}
    for kind, cells in body.blocks:
        volume = kind.startswith(("hexa", "wedge", "pyramid", "penta", "polyhedron", "voxel", "tetra", "VTK_LAGRANGE_H",
                                  "VTK_LAGRANGE_T", "VTK_LAGRANGE_W", "VTK_LAGRANGE_P"))
        if volume and kind not in WRITTEN and kind != "VTK_LAGRANGE_TRIANGLE" and len(cells):
            counts[kind] = counts.get(kind, 0) + len(cells)
    if counts:
        found = ", ".join(f"{count} of kind {kind}" for kind, count in sorted(counts.items()))
        wrong(source, None, f"it has volume cells that are no tetrahedra of 4 or 10 nodes: {found}; mesh the body with "
                            "tetrahedra, or have its surface meshed (save it as .stl)")


def safe(name):
    return " ".join(str(name).replace('"', "'").split())


def write_volume(body, output):
    physical = {}  # (dimension, name) -> number
    lists = {block: [[] for _ in cells] for block, (kind, cells) in enumerate(body.blocks) if kind in WRITTEN}
    of_points = {safe(name): nodes for name, nodes in sorted(body.point_groups.items()) if safe(name)}
    for (dimension, name), members in sorted(body.groups.items()):
        name = safe(name)
        if name in of_points:  # a reader of Gmsh's files takes the nodes of both for one group
            name += " elements" if dimension == 3 else f" ({DIMENSIONS[dimension]})"
            body.notes.append(f"\"{name}\" are the cells of a set whose name a set of nodes has too")
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
    """Of the tetrahedra; element_of: numbers in the file by (block, cell)."""
    rows = [(element_of[block, cell], vector) for block, array in blocks.items()
            if body.blocks[block][0] in ("tetra", "tetra10") for cell, vector in enumerate(array)]
    if not rows:
        return
    if not all(np.isfinite(vector).all() for _, vector in rows):
        body.notes.append(f"the vectors \"{safe(name)}\" are left out: some are not finite")
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


def convert(source, output, straight):
    """"volume" or "surface", and notes."""
    path = pathlib.Path(source)
    body = READERS.get(path.suffix.lower(), read_by_meshio)(path)
    check_points(body, source)
    refuse_other_volumes(body, source)
    is_volume = any(kind.startswith("tetra") and len(cells) for kind, cells in body.blocks)
    if is_volume:
        put_middles_right(body, source, straight)
    triangles = triangles_of(body)
    if not is_volume and not len(triangles):
        wrong(source, None, "there are neither tetrahedra nor triangles in it")
    try:
        if is_volume:
            write_volume(body, output)
        else:
            write_surface(body, triangles, output)
    except OSError as error:
        more = "; make room, or set TMPDIR to another folder" if error.errno in (errno.ENOSPC, errno.EDQUOT) else ""
        raise Unwritable(f"{output}: cannot be written: {error.strerror or error}{more}") from None
    return ["volume" if is_volume else "surface", *body.notes]


def main(arguments):
    straight = "--straight" in arguments
    source, output = [a for a in arguments if a != "--straight"]
    try:
        print("\n".join(convert(source, output, straight)))
    except Wrong as what:
        print(str(what).replace("\n", "?"), file=sys.stderr)  # one line, whatever the file is called
        return 2
    except Unwritable as why:
        print(why, file=sys.stderr)
        return 1
    except ModuleNotFoundError as missing:
        print(missing.name, file=sys.stderr)
        return 3
    except OSError as error:
        print(f"{error.filename or source}: {error.strerror or error}", file=sys.stderr)
        return 2
    except MemoryError:
        print(f"{source}: this machine has not enough memory for it", file=sys.stderr)
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
