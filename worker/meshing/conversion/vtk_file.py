"""Reader for VTK's legacy format .vtk, up to version 5.1. meshio does not know all its types and cells."""
import urllib.parse

import numpy as np

from body import wrong
from lines import ByteLines, bytes_of
from vtk_cells import body_of, refuse_grid

TYPES = {"unsigned_char": "u1", "char": "i1", "signed_char": "i1", "unsigned_short": "u2", "short": "i2",
         "unsigned_int": "u4", "int": "i4", "unsigned_long": "u8", "long": "i8", "float": "f4", "double": "f8",
         "vtkidtype": "i4",  # 32 bits in files, whatever their size in memory
         "vtktypeint64": "i8", "vtktypeuint64": "u8", "vtktypeint32": "i4", "long_long": "i8",
         "unsigned_long_long": "u8"}
# Numbers per row of the attributes that have one header line. 0: the header line gives this number.
ROWS = {"VECTORS": 3, "NORMALS": 3, "TENSORS": 9, "TENSORS6": 6, "GLOBAL_IDS": 1, "PEDIGREE_IDS": 1,
        "TEXTURE_COORDINATES": 0, "COLOR_SCALARS": 0}


class VtkFile(ByteLines):
    """Reads the lines and arrays of a file in sequence."""

    def __init__(self, path):
        super().__init__(path, bytes_of(path))
        if not self.line().startswith("# vtk DataFile"):
            wrong(path, 1, "this is not a legacy VTK file: its first line is not \"# vtk DataFile Version\"; "
                           "an XML file must have the extension .vtu")
        self.line()  # title
        self.binary = self.line().upper() == "BINARY"

    def number(self):
        """Returns the number of the line that was read last; None in a binary file."""
        return None if self.binary else self.data.count(b"\n", 0, max(self.at - 1, 0)) + 1

    def wrong(self, what):
        wrong(self.path, self.number(), what)

    def words(self):
        """Returns the words of the next line that is not empty; an empty list at the end."""
        while self.at < len(self.data):
            if words := self.line().split():
                return words
        return []

    def take(self, kind, count):
        kind = kind.lower()
        if kind in ("string", "variant", "bit"):
            return self.skip(kind, count)
        if kind not in TYPES:
            self.wrong(f"an array of type \"{kind}\" is not read")
        dtype = np.dtype(">" + TYPES[kind])
        if not self.binary:
            found = []
            while len(found) < count and self.at < len(self.data):
                found += self.line().split()
            try:
                return np.array(found[:count], dtype=np.float64 if dtype.kind == "f" else np.int64) \
                    if len(found) == count else self.truncated()
            except (ValueError, OverflowError):
                self.wrong("expected numbers, found text")
        size = count * dtype.itemsize
        if self.at + size > len(self.data):
            self.truncated()
        values = np.frombuffer(self.data, dtype, count, self.at)
        self.at += size + (self.data[self.at + size:self.at + size + 1] == b"\n")
        return values.astype(np.float64 if dtype.kind == "f" else np.int64)

    def truncated(self):
        self.wrong("the file is truncated: an array has too few numbers")

    def skip(self, kind, count):
        """Skips texts, which name no parts. Reads bits, eight per byte in a binary file."""
        if not self.binary:
            if kind == "bit":
                return self.take("int", count)
            for _ in range(count):
                self.line()
            return None
        if kind == "bit":
            return np.unpackbits(self.take("unsigned_char", -(-count // 8)).astype(np.uint8))[:count].astype(np.int64)
        for _ in range(count):  # the top two bits of the first byte give the width of the length
            width = {3: 1, 2: 2, 1: 4, 0: 8}[self.data[self.at] >> 6] if self.at < len(self.data) else self.truncated()
            length = int.from_bytes(self.data[self.at:self.at + width], "big") & (1 << (8 * width - 2)) - 1
            self.at += width + length
        return None


class VtkGrid:
    """The contents of the sections of a file."""

    def __init__(self, file):
        self.file, self.points, self.types = file, None, np.zeros(0, int)
        self.begins, self.nodes = np.zeros(1, int), np.zeros(0, int)
        self.of_cells, self.of_points = {}, {}
        self.rows, self.arrays = 0, {}  # number of rows and target of the following attributes
        sections = {"DATASET": self.dataset, "POINTS": self.read_points, "CELLS": self.read_cells,
                    "CELL_TYPES": self.read_types, "CELL_DATA": self.begin_cells, "POINT_DATA": self.begin_points,
                    "FIELD": self.field, "SCALARS": self.scalars, "LOOKUP_TABLE": self.lookup_table,
                    "METADATA": self.metadata}
        while words := file.words():
            key = words[0].upper()
            try:
                if key in ROWS:
                    self.attribute(key, words)
                elif key in sections:
                    sections[key](words)
                else:
                    file.wrong(f"\"{words[0][:60]}\" is not a section of an unstructured grid")
            except (IndexError, ValueError):
                file.wrong(f"{key} is truncated, or has text in place of numbers")
        if self.points is None:
            file.wrong("there is no POINTS section: the file is truncated")

    def dataset(self, words):
        if words[1].upper() != "UNSTRUCTURED_GRID":
            refuse_grid(self.file.path, self.file.number(), words[1])

    def read_points(self, words):
        self.points = self.file.take(words[2], 3 * int(words[1])).reshape(-1, 3)

    def read_cells(self, words):
        file, count, size = self.file, int(words[1]), int(words[2])
        at = file.at
        following = file.words()
        if following[:1] == ["OFFSETS"]:
            self.begins = file.take(following[1], count)
            self.nodes = file.take(file.words()[1], size)
            return
        file.at = at
        mixed = file.take("int", size)
        self.begins, nodes, place = [0], [], 0
        for _ in range(count):
            length = int(mixed[place])
            nodes.append(mixed[place + 1:place + 1 + length])
            self.begins.append(self.begins[-1] + len(nodes[-1]))
            place += 1 + length
        self.nodes = np.concatenate(nodes) if nodes else np.zeros(0, int)

    def read_types(self, words):
        self.types = self.file.take("int", int(words[1]))

    def begin_cells(self, words):
        self.rows, self.arrays = int(words[1]), self.of_cells

    def begin_points(self, words):
        self.rows, self.arrays = int(words[1]), self.of_points

    def keep(self, name, values, components):
        if values is not None:
            self.arrays[urllib.parse.unquote(name)] = values.reshape(-1, components) if components > 1 else values

    def field(self, words):
        """Reads arrays that have one header line each."""
        for _ in range(int(words[2])):
            name, components, rows, kind = self.file.words()
            values = self.file.take(kind, int(components) * int(rows))
            self.keep(name, values, int(components))

    def scalars(self, words):
        components = int(words[3]) if len(words) > 3 else 1
        at = self.file.at
        if self.file.words()[:1] != ["LOOKUP_TABLE"]:
            self.file.at = at
        self.keep(words[1], self.file.take(words[2], components * self.rows), components)

    def lookup_table(self, words):
        self.file.take("unsigned_char" if self.file.binary else "float", 4 * int(words[2]))

    def attribute(self, key, words):
        components = ROWS[key] or int(words[2])
        kind = words[-1] if key != "COLOR_SCALARS" else "unsigned_char" if self.file.binary else "float"
        values = self.file.take(kind, components * self.rows)
        if key == "VECTORS":
            self.keep(words[1], values, components)

    def metadata(self, _):
        """Skips lines up to an empty line."""
        while self.file.at < len(self.file.data) and self.file.line():
            pass


def read_vtk(path):
    grid = VtkGrid(VtkFile(path))
    return body_of(path, grid.points, grid.types, grid.begins, grid.nodes, grid.of_cells, grid.of_points)
