"""Reader for FEBio .feb files."""
import numpy as np

from body import NODES_OF, Body, wrong
from lines import bytes_of, define, node_numbers, numbers
from xml_elements import xml_of


LONGEST_RANGE = 10_000_000  # members of one set
FEBIO = {"tet4": "tetra", "tet10": "tetra10", "tri3": "triangle", "tri6": "triangle6", "hex8": "hexahedron",
         "hex20": "hexahedron20", "penta6": "wedge", "penta15": "wedge15", "pyra5": "pyramid", "quad4": "quad"}


class Febio:
    """The nodes, elements, sets and surfaces of a file, as a Body."""

    def __init__(self, path, meshes):
        self.path = path
        self.number_of = {}  # id of a node -> point
        self.nodes_of = {}  # name of a set -> points
        self.place = {}  # id of an element -> (block, cell)
        self.cells_of = {}  # name of an Elements section or an ElementSet -> [(block, cell)]
        self.body = Body(self.points(meshes))
        for mesh in meshes:
            for part in mesh.all("Elements"):
                self.elements(part)
            for node_set in mesh.all("NodeSet"):
                self.node_set(node_set)
            for element_set in mesh.all("ElementSet"):
                self.element_set(element_set)
            for surface in mesh.all("Surface"):
                self.surface(surface)

    def points(self, meshes):
        points = []
        for nodes in (nodes for mesh in meshes for nodes in mesh.all("Nodes")):
            name = nodes.attributes.get("name")
            for node in nodes.all("node"):
                self.define(self.number_of, node, len(points), "node")
                if name:
                    self.nodes_of.setdefault(name, []).append(len(points))
                points.append(numbers(node.text, self.path, node.line, 3, commas=True))
        return points

    def define(self, known, element, value, what):
        """Stores a value under the id of an element. Without an id, nothing can refer to the element."""
        if "id" in element.attributes:
            define(known, element.attributes["id"].strip(), value, what, self.path, element.line)

    def cell(self, element, kind):
        """Returns the nodes of an element or a face."""
        words = words_of(element)
        if len(words) != NODES_OF[kind]:
            wrong(self.path, element.line, f"expected {NODES_OF[kind]} nodes, found {len(words)}")
        return node_numbers(words, self.number_of, self.path, element.line)

    def elements(self, part):
        kind = FEBIO.get(part.attributes.get("type", "").lower())
        if kind is None:
            wrong(self.path, part.line, f"elements of type \"{part.attributes.get('type')}\" are not read; "
                                        "tetrahedra are tet4 and tet10")
        rows = part.all("elem", "e")
        if not rows:
            return
        block = self.body.add(kind, [self.cell(row, kind) for row in rows])
        places = [(block, cell) for cell in range(len(rows))]
        for row, place in zip(rows, places):
            self.define(self.place, row, place, "element")
        name = part.attributes.get("name") or (
            f"material {part.attributes['mat']}" if "mat" in part.attributes else "")
        if name:
            self.cells_of[name] = places
            self.body.group_of(places, name)

    def node_set(self, node_set):
        name = node_set.attributes.get("name", "")
        nodes = node_numbers(ids_in(node_set, self.path), self.number_of, self.path, node_set.line)
        for other in node_set.all("NodeSet"):
            nodes += self.nodes_of_set(other.attributes.get("node_set", ""), name)
        self.nodes_of[name] = self.body.point_groups[name] = nodes

    def nodes_of_set(self, name, of):
        if name not in self.nodes_of:
            self.body.notes.append(f"the set \"{of}\" names the set \"{name}\", which is not defined before it")
        return self.nodes_of.get(name, [])

    def element_set(self, element_set):
        name, ids = element_set.attributes.get("name", ""), ids_in(element_set, self.path)
        self.cells_of[name] = [self.place[i] for i in ids if i in self.place]
        self.body.note_missing(name, len(ids) - len(self.cells_of[name]), "element")
        self.body.group_of(self.cells_of[name], name)

    def surface(self, surface):
        for tag in ("tri3", "tri6"):
            faces = [self.cell(face, FEBIO[tag]) for face in surface.all(tag)]
            if faces:
                block = self.body.add(FEBIO[tag], faces)
                self.body.group(surface.attributes.get("name", ""), block, range(len(faces)))

    def vectors(self, data):
        """Reads a vector for each element of a set. Elements are given by their position in the set, from 1."""
        places = self.cells_of.get(data.attributes.get("elem_set", ""), [])
        name = data.attributes.get("var") or data.attributes.get("name") or data.attributes.get("type") or "fiber"
        rows = [row for row in data.all("e", "elem") if len(words_of(row)) == 3]
        of_places = [(self.place_in_set(row), row) for row in rows]
        of_places = [(at, row) for at, row in of_places if 0 <= at < len(places)]
        self.body.note_missing(name, len(rows) - len(of_places), "element", "data")
        for at, row in of_places:
            block, cell = places[at]
            vectors = self.body.vectors.setdefault(name, {})
            array = vectors.setdefault(block, np.zeros((len(self.body.blocks[block][1]), 3)))
            array[cell] = numbers(row.text, self.path, row.line, 3, commas=True)

    def place_in_set(self, row):
        """Returns the position of an element in its set, from 0."""
        lid = row.attributes.get("lid", "0")
        try:
            return int(lid) - 1
        except ValueError:
            wrong(self.path, row.line, f"lid=\"{lid}\" must be the position of an element in its set: 1, 2, ...")


def words_of(element):
    return element.text.replace(",", " ").split()


def ids_in(element, path):
    """Returns the ids of children like <node id="1"/>, and those in the text, where 1:4 is 1 to 4 and 1:9:2 every second one."""
    ids = [child.attributes["id"].strip() for child in element.children if "id" in child.attributes]
    for word in words_of(element):
        if ":" not in word:
            ids.append(word)
            continue
        ends = numbers(word.replace(":", " "), path, element.line, kind=int)
        if len(ends) not in (2, 3) or ends[-1] <= 0 and len(ends) == 3 or (ends[1] - ends[0]) >= LONGEST_RANGE:
            wrong(path, element.line, f"expected a range like 1:4 or 1:9:2, found \"{word[:60]}\"")
        ids += [str(i) for i in range(ends[0], ends[1] + 1, ends[2] if len(ends) == 3 else 1)]
    return ids


def spec_of(path, reading=()):
    """Returns the children of <febio_spec>; the contents of other files replace <Include> and from="..."."""
    root = xml_of(path, bytes_of(path))
    spec = (root.all("febio_spec") or [root])[0]

    def of_file(name, line):
        other = path.parent / name.strip()
        if not other.is_file():
            wrong(path, line, f"there is no file {other}, which this line names; put it there")
        if any(other.samefile(file) for file in (*reading, path)):
            wrong(path, line, f"{other} includes itself")
        return spec_of(other, (*reading, path))

    found = []
    for child in spec.children:
        if child.tag == "Include":
            found += of_file(child.text, child.line)
        elif "from" in child.attributes:
            found += [other for other in of_file(child.attributes["from"], child.line) if other.tag == child.tag]
        else:
            found.append(child)
    return found


def read_febio(path):
    """Reads FEBio 2.5, 3 and 4: Nodes, Elements, NodeSet, ElementSet and Surface of Geometry or Mesh; fibres of MeshData."""
    sections = spec_of(path)
    meshes = [section for section in sections if section.tag in ("Geometry", "Mesh")]
    if not meshes:
        wrong(path, 1, "there is no <Geometry> or <Mesh>: is this a .feb file of FEBio 2.5 or later?")
    febio = Febio(path, meshes)
    for section in sections:
        for data in section.all("ElementData") if section.tag == "MeshData" else []:
            febio.vectors(data)
    return febio.body
