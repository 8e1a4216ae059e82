"""Meshes as all readers return them (cells with groups), and errors in input files."""
import numpy as np

# Gmsh's type number, the dimension and the number of nodes of every kind of cell that is written.
WRITTEN = {"vertex": (15, 0, 1), "line": (1, 1, 2), "line3": (8, 1, 3), "triangle": (2, 2, 3), "triangle6": (9, 2, 6),
           "tetra": (4, 3, 4), "tetra10": (11, 3, 10)}
# Corners of the edges of a tetrahedron, in the order in which VTK, Abaqus and FEBio number the
# mid-edge nodes.
EDGES = ((0, 1), (1, 2), (0, 2), (0, 3), (1, 3), (2, 3))
# Converts the ten nodes of a tetrahedron between VTK's and Gmsh's order: the last two change
# places.
GMSH_ORDER = [0, 1, 2, 3, 4, 5, 6, 7, 9, 8]
# Converts TetGen's order to VTK's. TetGen's manual does not give its order, which was found from
# output of its option -o2.
TETGEN_ORDER = [0, 1, 2, 3, 6, 7, 9, 5, 8, 4]
NODES_OF = {"hexahedron": 8, "hexahedron20": 20, "wedge": 6, "wedge15": 15, "pyramid": 5, "quad": 4,
            **{kind: row[2] for kind, row in WRITTEN.items()}}
DIMENSIONS = ("point", "curve", "surface", "volume")
# An array with more different values than this is treated as data, not as numbers of parts.
MOST_PARTS = 64


class Wrong(Exception):
    """An error in the input file, as a sentence."""


def wrong(source, line, what):
    raise Wrong(f"{source}:{line}: {what}" if line else f"{source}: {what}")


def counted(count, noun):
    return f"{count} {noun}" if count == 1 else f"{count} {noun}s"


class Body:
    """Cells in blocks of one kind, and their groups."""

    def __init__(self, points):
        points = np.asarray(points, dtype=float)
        self.points = points.reshape(len(points), -1) if len(points) else np.zeros((0, 3))
        self.blocks = []  # (kind, nodes n x k), tetra10 in VTK's order
        self.groups = {}  # (dimension, name) -> {block: set of cells as an array}
        self.point_groups = {}  # name -> node numbers
        self.vectors = {}  # name -> {block: n x 3}
        self.notes = []  # sentences for the user

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
        """Adds the cells at places (block, cell) to a group."""
        for block in {block for block, _ in places}:
            self.group(name, block, [cell for of, cell in places if of == block])

    def note_missing(self, name, missing, what, by="set"):
        if missing:
            self.notes.append(f"the {by} \"{name}\" names {counted(missing, 'missing ' + what)}")


def plain(name):
    """Returns the name without a prefix: "ref" for "medit:ref"."""
    return name.rsplit(":", 1)[-1]


def are_numbers_of_parts(name, arrays):
    """Returns whether arrays contain part numbers. These are integers, or floats if the name of the array means parts."""
    if name == "gmsh:geometrical" or name.startswith("vtk") or name == "gmsh:dim_tags":
        return False
    if all(np.asarray(array).dtype.kind in "iu" for array in arrays):
        return True
    words = ("region", "material", "mat", "part", "label", "tag", "group", "ref", "domain", "fixed")
    return plain(name).lower().replace("_", "").rstrip("s").removesuffix("id") in words


def are_no_parts(body, name, numbers_in):
    if len(numbers_in) > MOST_PARTS:
        body.notes.append(f"the array \"{plain(name)}\" has {len(numbers_in)} different values, too many for parts")
    numbers_in = np.asarray(numbers_in, dtype=float)
    are_whole = np.isfinite(numbers_in) & (numbers_in == np.round(numbers_in))
    return len(numbers_in) > MOST_PARTS or not np.all(are_whole)


def add_parts(body, name, values):
    """Makes a group for each part number. If the numbers are 0 and 1, makes only one group, for 1."""
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
    """Like add_parts for points; 0 is not a part."""
    values = np.asarray(values)
    if values.ndim > 1:
        return
    parts = np.unique(values)
    if are_no_parts(body, name, parts):
        return
    flag = len(parts) == 2 and parts[0] == 0 and parts[1] == 1
    for part in parts[parts != 0]:
        body.point_groups[plain(name) if flag else f"{plain(name)} {int(part)}"] = np.flatnonzero(values == part)
