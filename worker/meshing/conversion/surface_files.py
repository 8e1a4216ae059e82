"""Readers for plain surfaces: .stl, .obj, .off and .ply. Errors name the line."""
import numpy as np

from body import Body, wrong
from lines import MARKS, bytes_of, data_lines, numbers
from polygons import cut, triangles_of_strips


def surface_of(points, triangles):
    body = Body(points)
    body.add("triangle", triangles)
    return body


def polygons_of(points, polygons):
    """Returns a surface of polygons, split into triangles."""
    return surface_of(points, cut(points, polygons))


def read_stl(path):
    data = path.read_bytes().removeprefix(b"\xef\xbb\xbf")
    binary = len(data) >= 84 and (b"\0" in data[:4096] or not data.lstrip().lower().startswith(b"solid"))
    count = int.from_bytes(data[80:84], "little")
    if len(data) >= 84:
        if len(data) == 84 + 50 * count or binary and len(data) > 84 + 50 * count:  # some programs append data
            facets = np.frombuffer(data, np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("more", "<u2")]),
                                   count, 84)
            corners = facets["corners"].astype(float).reshape(-1, 3)
            return surface_of(corners, np.arange(len(corners)).reshape(-1, 3))
    if data[:2] in MARKS:
        wrong(path, 1, f"the text is {MARKS[data[:2]]}: save it as ASCII, or binary")
    if binary:
        wrong(path, None, f"it announces {count} triangles ({84 + 50 * count} bytes), but has {len(data)} bytes: "
                          "the file is truncated, or is not STL")
    if not data.lstrip().lower().startswith(b"solid"):
        wrong(path, 1, "this is not an STL file: it begins neither with \"solid\" nor with a header of 84 bytes")
    corners, last, number, ended = [], 0, 1, False
    for number, line in enumerate(data.decode("latin-1").rstrip().splitlines(), 1):
        words = line.lower().split()
        if words and words[0] == "vertex":
            corners.append(numbers(" ".join(words[1:]), path, number, 3))
            last = number
        if "".join(words).startswith("endsolid"):
            ended = True
        elif words and words[0] in ("solid", "facet", "vertex"):
            ended = False
    if len(corners) % 3:
        wrong(path, last, "the last triangle has fewer than three corners: the file is truncated")
    if not ended:
        wrong(path, number, "there is no endsolid after this line: the file is truncated; save it again")
    return surface_of(np.array(corners).reshape(-1, 3), np.arange(len(corners)).reshape(-1, 3))


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
                wrong(path, number, f"a face has a corner that does not exist: {len(points)} vertices are defined before it")
            polygons.append(corners)
    if not points:
        wrong(path, None, "there is no vertex (v) in it: the file may be truncated")
    return polygons_of(points, polygons)


def read_off(path):
    words = [(number, word) for number, line in data_lines(path) for word in line.split()]
    if words and words[0][1][:3].upper() == "OFF" and words[0][1][3:].isdigit():  # no line break after OFF
        words[:1] = [(words[0][0], "OFF"), (words[0][0], words[0][1][3:])]
    if not words or words[0][1].upper() != "OFF":
        wrong(path, 1, "this is not a plain OFF file: it does not begin with OFF alone (COFF, NOFF and binary files are not "
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
            wrong(path, line, f"a face has a corner that does not exist: there are {n_points} vertices")
        polygons.append(corners)
        while at < len(words) and words[at][0] == line:  # a colour
            at += 1
    return polygons_of(points, polygons)


PLY_TYPES = {"char": "i1", "int8": "i1", "uchar": "u1", "uint8": "u1", "short": "i2", "int16": "i2", "ushort": "u2",
             "uint16": "u2", "int": "i4", "int32": "i4", "uint": "u4", "uint32": "u4", "float": "f4", "float32": "f4",
             "double": "f8", "float64": "f8"}


def ply_header(path, data):
    """Returns byte order (empty: text), elements (name, count, [(name, type, type of length if a list)]), start of data."""
    end = data.find(b"end_header")
    if not data.startswith(b"ply") or end < 0:
        wrong(path, 1, "this is not a PLY file, or its header is truncated: ply or end_header is missing")
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
            wrong(path, number, f"unknown header line \"{line[:60]}\"")
    if order is None:
        wrong(path, 1, "its header has no line with the format")
    return order, elements, data.find(b"\n", end) + 1


def read_ply(path):
    """Reads a .ply file. meshio would wait forever for the end of a truncated header."""
    data = bytes_of(path)
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
                elif name == "tristrips":
                    polygons += triangles_of_strips(row["vertex_indices"])
    except (StopIteration, RuntimeError, ValueError, OverflowError):
        wrong(path, None, "the file is truncated, or has text in place of numbers")
    except KeyError as missing:
        wrong(path, None, f"its header has no property {missing}")
    for corners in polygons:
        if not isinstance(corners, list):
            wrong(path, None, "the corners of its faces are not a list: its header has no property list vertex_indices")
        if len(corners) < 3 or min(corners) < 0 or max(corners) >= len(points):
            wrong(path, None, f"a face has a corner that does not exist: there are {len(points)} vertices")
    return polygons_of(points, polygons)
