"""Reader for Gmsh .msh files of version 1, 2, 4.0 and 4.1. meshio loses the groups of binary files."""
import re

import numpy as np

from body import DIMENSIONS, GMSH_ORDER, NODES_OF, WRITTEN, Body, wrong
from lines import ByteLines, bytes_of, node_numbers

GMSH_KINDS = {number: kind for kind, (number, _, _) in WRITTEN.items()}
GMSH_KINDS.update({3: "quad", 5: "hexahedron", 6: "wedge", 7: "pyramid", 10: "quad9", 12: "hexahedron27", 13: "wedge18",
                   14: "pyramid14", 16: "quad8", 17: "hexahedron20", 18: "wedge15", 19: "pyramid13"})
GMSH_NODES = {**NODES_OF, "quad9": 9, "hexahedron27": 27, "wedge18": 18, "pyramid14": 14, "quad8": 8, "pyramid13": 13}


class GmshFile(ByteLines):
    """The numbers of a .msh file, binary or text, section by section. version: 1, 2, 4 (means 4.0) or 4.1."""

    def __init__(self, path, data):
        super().__init__(path, data)
        self.version, self.binary, self.names_have_dimensions = "1", False, True
        self.words, self.text, self.taken = None, (0, 0), 0  # for a text section: words, range, number of words taken
        if (first := self.line()) == "$NOD":
            self.at = 0
            return
        if first != "$MeshFormat":
            wrong(path, 1, "this is not a Gmsh .msh file: its first line is not $MeshFormat")
        words = self.line().split()
        if len(words) < 3:
            wrong(path, 2, "there is no version, file type and data size here: the file is truncated; save it again")
        known = {"2": "2", "2.0": "2", "2.1": "2", "2.2": "2", "4": "4", "4.0": "4", "4.1": "4.1"}
        if words[0] not in known:
            wrong(path, 2, f"Gmsh's format version {words[0]} is not supported; save the mesh as version 4.1 or 2.2")
        self.version, self.binary = known[words[0]], words[1] == "1"
        self.names_have_dimensions = words[0] not in ("2", "2.0")
        self.size = np.dtype("<u8") if words[2:] != ["4"] else np.dtype("<u4")
        if self.binary and int.from_bytes(self.bytes(4), "little") != 1:
            wrong(path, 3, "it was written on a machine with another byte order; save it as ASCII")

    def bytes(self, count):
        if self.at + count > len(self.data):
            wrong(self.path, None, "the file is truncated")
        self.at += count
        return self.data[self.at - count:self.at]

    def sections(self):
        while self.at < len(self.data):
            line = self.line()
            if line.startswith("$") and line[:4].upper() != "$END":
                name = line[1:]
                begin = self.at
                end = self.data.find((b"$END" if self.version == "1" else b"$End") + name.encode(), begin)
                if end < 0:
                    wrong(self.path, None, f"the file is truncated: it ends inside ${name}")
                # A text section is split into words; a binary one is read in place.
                self.words = None if self.binary else self.data[begin:end].split()
                self.text, self.taken = (begin, end), 0
                yield name, begin, end
                self.at = end

    def here(self, back=0):
        """Returns the line of the last number taken, or of one `back` before it; None in a binary file."""
        if self.words is None:
            return None
        begin, end = self.text
        words = [begin + word.start() for word in re.finditer(rb"\S+", self.data[begin:end])]
        return 1 + self.data.count(b"\n", 0, [*words, end][min(self.taken - back - 1, len(words))])

    def take(self, kind, count=1):
        """Returns the next `count` numbers: "i" with 32 bits, "s" with the file's data size, "d" double."""
        if self.words is not None:
            convert, dtype = (float, float) if kind == "d" else (int, np.int64)
            taken = []
            try:
                for _ in range(count):
                    self.taken += 1
                    taken.append(convert(self.words[self.taken - 1]))
                return np.array(taken, dtype=dtype)
            except (IndexError, ValueError, OverflowError):
                wrong(self.path, self.here(), "the file is truncated, or has text in place of numbers")
        dtype = {"i": np.dtype("<i4"), "s": self.size, "d": np.dtype("<f8")}[kind]
        values = np.frombuffer(self.bytes(count * dtype.itemsize), dtype)
        return values if kind == "d" else values.astype(np.int64)


class GmshMesh:
    """The contents of the sections of a file."""

    def __init__(self, file):
        self.file, self.old = file, file.version in ("1", "2")
        self.names = {}  # (dimension, number) of a physical group -> name
        self.groups_of = {}  # (dimension, number) of an entity -> numbers of physical groups
        self.number_of, self.points = {}, []  # number_of: tag of a node -> point
        self.rows = {}  # kind -> [(tag, [(dimension, number) of physical groups], tags of nodes)]
        self.groups_of_cell = {}  # (kind, sorted nodes) -> its groups in rows; old files repeat a cell per group
        self.vectors = {}  # name -> {tag of an element: vector}
        self.line_of_vectors = None
        sections = {"PhysicalNames": self.physical_names, "Entities": self.entities,
                    "PartitionedEntities": self.partitioned_entities, "Nodes": self.nodes,
                    "ParametricNodes": self.parametric_nodes, "Elements": self.elements, "ElementData": self.element_data,
                    "NOD": self.nodes, "ELM": self.first_elements}
        for section, begin, end in file.sections():
            if section in sections:
                self.read(section, sections[section], begin, end)

    def read(self, section, reader, begin, end):
        file = self.file
        try:
            reader(begin, end)
        except (IndexError, ValueError):
            line = None if file.binary else file.data.count(b"\n", 0, file.at)
            wrong(file.path, line, f"${section} is truncated, or has text in place of numbers; save it again")

    def physical_names(self, begin, end):
        has_dimensions = self.file.names_have_dimensions
        for text in self.file.data[begin:end].decode("utf-8", "replace").splitlines()[1:]:
            words = text.split(None, 2 if has_dimensions else 1)
            if len(words) == (3 if has_dimensions else 2):
                for dimension in [int(words[0])] if has_dimensions else range(4):
                    self.names[dimension, int(words[-2])] = words[-1].strip().strip('"')

    def entities(self, *_):
        file = self.file
        for dimension, count in enumerate(file.take("s", 4)):
            for _ in range(count):
                entity = dimension, int(file.take("i")[0])
                file.take("d", 6 if dimension or file.version == "4" else 3)
                self.groups_of[entity] = file.take("i", int(file.take("s")[0]))
                if dimension:
                    file.take("i", int(file.take("s")[0]))

    def partitioned_entities(self, *_):
        wrong(self.file.path, None, "the mesh is partitioned: save it whole (in Gmsh, Mesh, Unpartition)")

    def old_count(self):
        return int(self.file.line()) if self.file.binary else int(self.file.take("i")[0])

    def nodes(self, *_):
        file = self.file
        if self.old:
            for _ in range(self.old_count()):
                self.node(file.take("i")[0])
                self.points.append(file.take("d", 3))
            return
        if file.version == "4":
            self.nodes_of_4()
            return
        for _ in range(file.take("s", 4)[0]):
            dimension, _, parametric = file.take("i", 3)
            count = int(file.take("s")[0])
            for n, tag in enumerate(file.take("s", count), 1):
                self.node(tag, count - n)
            width = 3 + (int(dimension) if parametric else 0)
            self.points += list(file.take("d", width * count).reshape(count, width)[:, :3])

    def nodes_of_4(self):
        file = self.file
        for _ in range(file.take("s", 2)[0]):
            _, dimension, parametric = file.take("i", 3)
            for _ in range(file.take("s")[0]):
                self.node(file.take("i")[0])
                self.points.append(file.take("d", 3))
                file.take("d", int(dimension) if parametric else 0)

    def parametric_nodes(self, *_):
        """Reads nodes of version 2.2. Ignores their entities, and their parameters on the entities."""
        file = self.file
        for _ in range(self.old_count()):
            self.node(file.take("i")[0])
            self.points.append(file.take("d", 3))
            dimension, _ = file.take("i", 2)
            file.take("d", int(dimension) if dimension < 3 else 0)

    def node(self, tag, back=0):
        if int(tag) in self.number_of:
            wrong(self.file.path, self.file.here(back), f"node {tag} is defined twice; give each its own number")
        self.number_of[int(tag)] = len(self.number_of)

    def kind_of(self, number):
        if number not in GMSH_KINDS:
            wrong(self.file.path, self.file.here(), f"elements of Gmsh's type {number} are not read")
        return GMSH_KINDS[number]

    def add(self, kind, tag, groups, nodes):
        self.rows.setdefault(kind, []).append((tag, groups, nodes))

    def elements(self, *_):
        if self.old:
            self.old_elements()
            return
        file, is_4 = self.file, self.file.version == "4"
        for _ in range(file.take("s", 2 if is_4 else 4)[0]):
            *entity, number = (int(n) for n in file.take("i", 3))
            dimension, tag = reversed(entity) if is_4 else entity
            kind, count = self.kind_of(number), int(file.take("s")[0])
            groups = [(dimension, abs(int(group))) for group in self.groups_of.get((dimension, tag), [])]
            for row in file.take("i" if is_4 else "s", count * (1 + GMSH_NODES[kind])).reshape(count, -1):
                self.add(kind, row[0], groups, row[1:])

    def first_elements(self, *_):
        """Reads elements of version 1: tag, type, physical and elementary entity, number of nodes, nodes."""
        for _ in range(self.old_count()):
            tag, number, group, _, _ = self.file.take("i", 5)
            kind = self.kind_of(int(number))
            self.add_old(kind, np.array([tag, group, *self.file.take("i", GMSH_NODES[kind])]), 1)

    def old_elements(self):
        file, count = self.file, self.old_count()
        while count > 0:
            first, number, n_tags = (int(n) for n in file.take("i", 3))  # in a binary file: type and number of elements
            elements, begun = (number, []) if file.binary else (1, [first])
            kind = self.kind_of(first if file.binary else number)
            more = file.take("i", elements * (1 + n_tags + GMSH_NODES[kind]) - len(begun))
            for row in np.concatenate([np.array(begun, dtype=np.int64), more]).reshape(elements, -1):
                self.add_old(kind, row, n_tags)
            count -= elements

    def add_old(self, kind, row, n_tags):
        nodes = row[1 + n_tags:]
        dimension = WRITTEN[kind][1] if kind in WRITTEN else -1
        groups = [(dimension, abs(int(row[1])))] if n_tags and row[1] != 0 else []
        key = kind, tuple(sorted(nodes))
        known = self.groups_of_cell.get(key)
        if known is not None and groups and groups[0] not in known:
            known.append(groups[0])
            return
        self.groups_of_cell[key] = groups
        self.add(kind, row[0], groups, nodes)

    def element_data(self, begin, _):
        """Reads vectors; ignores all other data."""
        file = self.file
        file.at, file.words = begin, None
        strings = [file.line() for _ in range(int(file.line()))]
        for _ in range(int(file.line())):
            file.line()
        integers = [int(file.line()) for _ in range(int(file.line()))]
        name = strings[0].strip('"') if strings else ""
        if len(integers) < 3 or integers[1] != 3 or not name or name in self.vectors:
            return
        values = self.vectors[name] = {}
        self.line_of_vectors = file.data.count(b"\n", 0, begin)
        for _ in range(integers[2]):
            if file.binary:
                values[int(file.take("i")[0])] = file.take("d", 3)
            else:
                words = file.line().split()
                values[int(words[0])] = [float(word) for word in words[1:4]]

    def body(self):
        if not self.rows:
            wrong(self.file.path, None, "there is no $Elements section: the file is truncated")
        self.refuse_tetrahedra_of_one_tag()
        body = Body(self.points)
        for kind, rows in self.rows.items():
            cells = np.array([node_numbers(map(int, nodes), self.number_of, self.file.path, None)
                              for _, _, nodes in rows])
            block = body.add(kind, cells[:, GMSH_ORDER] if kind == "tetra10" else cells)
            self.add_groups(body, block, rows)
            self.add_vectors(body, block, rows)
        self.note_idle_names(body)
        return body

    def note_idle_names(self, body):
        borne = {name for _, name in body.groups}
        idle = sorted(name for name in self.names.values() if name not in borne)
        if idle:
            text = ", ".join(f'"{name}"' for name in idle[:5]) + (f" and {len(idle) - 5} more" if len(idle) > 5 else "")
            body.notes.append(f"these named groups have no elements and are lost: {text} (with Mesh.SaveAll = 1, version "
                              "2.2 saves elements without their groups)")

    def refuse_tetrahedra_of_one_tag(self):
        """Refuses equal tags if vectors refer to tags. Version 2.2 may write an element once for each of its groups."""
        if not self.vectors:
            return
        tags, counts = np.unique([int(row[0]) for kind in ("tetra", "tetra10") for row in self.rows.get(kind, [])],
                                 return_counts=True)
        if len(twice := tags[counts > 1]):
            wrong(self.file.path, self.line_of_vectors, "$ElementData cannot be assigned: two tetrahedra have the "
                                                        f"number {twice[0]}; give each its own number")

    def add_groups(self, body, block, rows):
        members = {}
        for cell, (_, groups, _) in enumerate(rows):
            for group in groups:
                members.setdefault(group, []).append(cell)
        for (dimension, number), cells in members.items():
            body.group(self.names.get((dimension, number), f"{DIMENSIONS[dimension]} {number}"), block, cells)

    def add_vectors(self, body, block, rows):
        cell_of = {int(tag): cell for cell, (tag, _, _) in enumerate(rows)}
        for name, values in self.vectors.items():
            for tag in values.keys() & cell_of.keys():
                array = body.vectors.setdefault(name, {}).setdefault(block, np.zeros((len(rows), 3)))
                array[cell_of[tag]] = values[tag]


def read_gmsh(path):
    return GmshMesh(GmshFile(path, bytes_of(path))).body()
