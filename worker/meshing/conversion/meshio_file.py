"""Reader for all other formats, by meshio."""
import contextlib
import io
import pathlib
import re
import signal
import tempfile

import numpy as np

from body import DIMENSIONS, WRITTEN, Body, add_parts, add_point_parts, are_numbers_of_parts, wrong
from lines import bytes_of

LONGEST_READING = 900  # s
COMPRESSED = (".gz", ".bz2", ".xz", ".zip", ".zst", ".7z")


def give_up(*_):
    raise TimeoutError(f"timed out after {LONGEST_READING} s")


def heed_warnings(path, said):
    """Returns meshio's warnings about omitted parts of a file as notes. Refuses a file if meshio omitted cells."""
    warnings = [" ".join(text.split()) for text in re.split(r"\s*Warning:", said)[1:]]
    for text in warnings:
        if re.search(r"cells|parse line|not closed|End-of-file|expected \d+ markers", text):
            wrong(path, None, f"a part of it cannot be read (meshio: {text}); mesh the body with tetrahedra of 4 or 10 "
                              "nodes, and save the whole mesh as .vtu or .msh")
    return [f"meshio: {text}" for text in dict.fromkeys(warnings)]


@contextlib.contextmanager
def without_mark(path):
    """Yields the path of a file, or of a copy without its UTF-8 byte order mark, which meshio would read as text."""
    with open(path, "rb") as file:
        if file.read(3) != b"\xef\xbb\xbf" or file.read(1) == b"<":  # XML allows the mark, and may name files in its folder
            yield path
            return
    with tempfile.TemporaryDirectory() as folder:
        copy = pathlib.Path(folder) / path.name
        copy.write_bytes(bytes_of(path))
        yield copy


def read_by_meshio(path, of_format=None):
    try:
        import meshio
    except ImportError:
        raise ModuleNotFoundError("meshio", name="meshio") from None
    said = io.StringIO()
    signal.signal(signal.SIGALRM, give_up)  # some meshio readers never return for truncated files
    signal.alarm(LONGEST_READING)
    try:
        with contextlib.redirect_stdout(said), contextlib.redirect_stderr(said), without_mark(path) as file:
            read = meshio.read(file, of_format)
    except ModuleNotFoundError:
        raise
    except BaseException as error:  # meshio calls sys.exit() if it cannot read a file
        if isinstance(error, KeyboardInterrupt):
            raise
        text = str(error) if not isinstance(error, SystemExit) else said.getvalue()
        text = " ".join((text or said.getvalue()).replace("Error:", "").split())
        if "deduce" in text:
            refuse_ending(path, {*meshio.extension_to_filetypes, ".feb"})
        wrong(path, None, f"meshio cannot read it: {text or type(error).__name__}; check that it is complete and that its "
                          "extension matches its format, or save it as .vtu or .msh with another program")
    finally:
        signal.alarm(0)
    notes = heed_warnings(path, said.getvalue())
    body = of_meshio(read)
    body.notes += notes
    return body


def refuse_ending(path, known):
    if path.suffix.lower() in COMPRESSED:
        wrong(path, None, "it is compressed: decompress it first")
    wrong(path, None, "unknown extension; save a surface as .stl, a mesh of tetrahedra as .vtu, or use "
                      f"another known extension: {', '.join(sorted(known))}")


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
        elif name == "cell_tags" and families:  # MED: names by number
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
