"""Reader for VTK .vtu files. meshio reads neither text arrays nor LZ4 compression."""
import base64
import binascii
import lzma
import zlib

import numpy as np

from body import wrong
from vtk_cells import body_of, refuse_grid
from xml_elements import Element, xml_of

TYPES = {"Int8": "i1", "UInt8": "u1", "Int16": "i2", "UInt16": "u2", "Int32": "i4", "UInt32": "u4", "Int64": "i8",
         "UInt64": "u8", "Float32": "f4", "Float64": "f8"}


def lz4(block, size):
    """Decompresses a block of LZ4, which consists of literals and of copies of earlier bytes."""
    out, at = bytearray(), 0
    while at < len(block):
        token = block[at]
        literals, at = extended(block, at + 1, token >> 4)
        out += block[at:at + literals]
        at += literals
        if at >= len(block):
            break
        back = int.from_bytes(block[at:at + 2], "little")
        count, at = extended(block, at + 2, token & 15)
        count += 4
        begin = len(out) - back
        if back == 0 or begin < 0:
            raise ValueError("a copy of bytes outside the block")
        while count > 0:  # a copy may read bytes that it writes itself
            part = out[begin:begin + count]
            out += part
            begin += len(part)
            count -= len(part)
    if len(out) != size:
        raise ValueError("a block has the wrong length")
    return bytes(out)


def extended(block, at, length):
    """Adds the bytes that continue a length of four bits. Returns the length, and the position after these bytes."""
    if length == 15:
        while True:
            length += block[at]
            at += 1
            if block[at - 1] != 255:
                break
    return length, at


DECOMPRESS = {"vtkZLibDataCompressor": lambda block, size: zlib.decompress(block),
              "vtkLZMADataCompressor": lambda block, size: lzma.decompress(block), "vtkLZ4DataCompressor": lz4}


class VtuFile:
    """The arrays of a file."""

    def __init__(self, path):
        self.path, data = path, path.read_bytes()
        begin = data.find(b"<AppendedData")
        self.appended, self.is_base64 = b"", False
        if begin >= 0:  # its bytes are not XML
            head_end = data.find(b">", begin)
            self.is_base64 = b"base64" in data[begin:head_end]
            self.appended = data[data.find(b"_", head_end) + 1:]
            end = self.appended.rfind(b"</AppendedData")
            if end < 0:
                wrong(path, None, "the file is truncated: there is no </AppendedData>")
            self.appended = self.appended[:end]
            data = data[:begin] + b"</VTKFile>"
        root = xml_of(path, data)
        files = root.all("VTKFile")
        if not files or files[0].attributes.get("type") != "UnstructuredGrid":
            refuse_grid(path, 1, (files[0].attributes.get("type") if files else root.children[0].tag) or "VTKFile")
        file = files[0].attributes
        self.order = ">" if file.get("byte_order") == "BigEndian" else "<"
        self.header = np.dtype(self.order + TYPES.get(file.get("header_type", "UInt32"), "u4"))
        self.compressor = file.get("compressor", "")
        if self.compressor and self.compressor not in DECOMPRESS:
            wrong(path, 1, f"compressor=\"{self.compressor}\" is not known; save it without compression")
        grid = files[0].all("UnstructuredGrid")
        self.pieces = grid[0].all("Piece") if grid else []

    def array(self, element):
        """Returns the values of a DataArray; None for texts, which name no parts."""
        kind = element.attributes.get("type", "")
        if kind not in TYPES:
            return None
        dtype = np.dtype(self.order + TYPES[kind])
        form = element.attributes.get("format", "ascii")
        try:
            if form == "ascii":
                values = np.array(element.text.split(), dtype=np.float64 if dtype.kind == "f" else np.int64)
            else:
                values = np.frombuffer(self.bytes(element, form), dtype)
        except (ValueError, IndexError, binascii.Error, zlib.error, lzma.LZMAError, OverflowError) as error:
            name = element.attributes.get("Name", "")
            wrong(self.path, element.line, f"the array \"{name}\" cannot be read ({error}): the file is truncated or "
                                           "damaged; save it again")
        values = values.astype(np.float64 if dtype.kind == "f" else np.int64)
        components = int(element.attributes.get("NumberOfComponents", 1) or 1)
        return values.reshape(-1, components) if components > 1 else values

    def bytes(self, element, form):
        if form == "appended":
            data, is_base64 = self.appended[int(element.attributes["offset"]):], self.is_base64
        else:
            data, is_base64 = "".join(element.text.split()).encode(), True
        return self.compressed(data, is_base64) if self.compressor else self.plain(data, is_base64)

    def plain(self, data, is_base64):
        """Returns the uncompressed data that follow their number of bytes."""
        width = self.header.itemsize
        if not is_base64:
            return self.part(data, width, self.numbers(data, 1)[0])
        head = base64_of(data, width)
        size = self.numbers(head, 1)[0]
        # Some writers encode the length and the data together. Others encode the length separately,
        # and its code then ends with "=".
        alone = -(-width // 3) * 4
        return base64_of(data[alone:], size) if data[alone - 1:alone] == b"=" else base64_of(data, width + size)[width:]

    def compressed(self, data, is_base64):
        """Decompresses data. The header: number of blocks, size of a block, size of the last block, all compressed sizes."""
        width = self.header.itemsize
        count = self.numbers(base64_of(data, width) if is_base64 else data, 1)[0]
        head_size = (3 + count) * width
        head = base64_of(data, head_size) if is_base64 else data
        _, usual, last, *sizes = self.numbers(head, 3 + count)
        begin = -(-head_size // 3) * 4 if is_base64 else head_size
        blocks = base64_of(data[begin:], sum(sizes)) if is_base64 else data[begin:]
        out, at = [], 0
        for n, size in enumerate(sizes):
            full = last if n == count - 1 and last else usual
            out.append(DECOMPRESS[self.compressor](self.part(blocks, at, size), full))
            at += size
        return b"".join(out)

    def numbers(self, data, count):
        return np.frombuffer(data, self.header, count).tolist()

    @staticmethod
    def part(data, begin, size):
        if begin + size > len(data):
            raise ValueError("it has too few bytes")
        return data[begin:begin + size]

    def arrays(self, section):
        return {element.attributes.get("Name", ""): values for element in section.all("DataArray")
                if (values := self.array(element)) is not None}


def base64_of(data, size):
    """Returns the first `size` decoded bytes."""
    out = base64.b64decode(data[:-(-size // 3) * 4])
    if len(out) < size:
        raise ValueError("it has too few bytes")
    return out[:size]


def read_vtu(path):
    """Reads all pieces of a file into one body."""
    file = VtuFile(path)
    points, types, begins, nodes, of_cells, of_points = [np.zeros((0, 3))], [], [0], [], {}, {}
    for piece in file.pieces:
        sections = {name: file.arrays((piece.all(name) or [Element(name, {}, piece.line)])[0])
                    for name in ("Points", "Cells", "CellData", "PointData")}
        for name in ("connectivity", "offsets", "types"):
            if name not in sections["Cells"]:
                wrong(path, piece.line, f"this piece has no cells: the array \"{name}\" is missing")
        if not sections["Points"]:
            wrong(path, piece.line, "this piece has no points")
        first, cells = sum(map(len, points)), sections["Cells"]
        points.append(next(iter(sections["Points"].values())))
        nodes.append(cells["connectivity"] + first)
        begins += (cells["offsets"] + begins[-1]).tolist()
        types.append(cells["types"])
        for name, array in sections["CellData"].items():
            of_cells.setdefault(name, []).append(array)
        for name, array in sections["PointData"].items():
            of_points.setdefault(name, []).append(array)

    def joined(arrays):
        return {name: np.concatenate(parts) for name, parts in arrays.items() if len({a.shape[1:] for a in parts}) == 1}

    return body_of(path, np.concatenate(points), np.concatenate(types or [[]]), begins, np.concatenate(nodes or [[]]),
                   joined(of_cells), joined(of_points))
