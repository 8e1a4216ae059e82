"""Reader for Abaqus .inp files, whose sets meshio loses."""
from body import NODES_OF, Body, wrong
from lines import data_lines, numbers, whole
from meshio_file import read_by_meshio

ABAQUS = {"C3D4": "tetra", "C3D10": "tetra10", "C3D8": "hexahedron", "C3D20": "hexahedron20", "C3D6": "wedge",
          "C3D15": "wedge15", "C3D5": "pyramid", "S3": "triangle", "STRI3": "triangle", "CPS3": "triangle",
          "CPE3": "triangle", "R3D3": "triangle", "M3D3": "triangle", "SFM3D3": "triangle", "STRI65": "triangle6",
          "CPS6": "triangle6", "CPE6": "triangle6", "M3D6": "triangle6", "S4": "quad", "CPS4": "quad", "R3D4": "quad",
          "T3D2": "line", "B31": "line", "T3D3": "line3", "B32": "line3"}
# Keywords that create or move nodes and elements beyond the lines of *NODE and *ELEMENT.
GENERATORS = ("NGEN", "NFILL", "NCOPY", "NMAP", "ELGEN", "ELCOPY", "SYMMETRIC MODEL GENERATION")
REMEDY = "write a flat model that lists every node and element, or convert it to .vtu with another program"
NO_CONTINUUM = ("MASS", "ROTARYI", "HEATCAP", "SPRING", "DASHPOT", "CONN", "GAP", "DCOUP", "JOINTC", "ITS")
LONGEST_RANGE = 10_000_000  # members of one set


def abaqus_kind(word):
    """Returns the kind of cell for an element type. Ignores the formulation: C3D10MH is read as C3D10."""
    matches = [name for name in ABAQUS if word.startswith(name) and not word[len(name):len(name) + 1].isdigit()]
    return ABAQUS[max(matches, key=len)] if matches else None


class Abaqus:
    """The model in an .inp file and the files that it includes. Node and element numbers are valid in one scope, mostly a part."""

    def __init__(self, path):
        self.files, self.scope, self.part_of = [path], "", {}  # part_of: name of an instance -> scope
        self.moved = {}  # scope -> (path, line) that moves an instance of the scope
        self.points, self.number_of = [], {}  # number_of: (scope, number) -> point
        self.elements = {}  # (scope, number) -> (kind, points)
        self.sets = {"NSET": {}, "ELSET": {}}  # name in capitals -> (name, [(scope, number)])
        self.keyword, self.options, self.kind = "", {}, None
        self.left_out, self.left = {}, ""  # type of elements -> number of skipped lines
        self.pending = []  # numbers of an element that continues in the next line
        self.read(path)

    def read(self, path):
        keyword = ""  # a keyword line that continues in the next line
        for line, text in data_lines(path, comment="**"):
            self.path, self.line = path, line
            if keyword and text[0] in "+-.0123456789":  # a data line: the keyword line was complete despite its comma
                self.begin(keyword)
                keyword = ""
            if keyword or text.startswith("*"):
                keyword += text
                if not text.endswith(","):
                    self.begin(keyword)
                    keyword = ""
            elif self.keyword == "NODE":
                self.node(text)
            elif self.keyword == "ELEMENT":
                self.element(text)
            elif self.keyword in self.sets:
                self.members(text)
            elif self.keyword == "LEFT OUT":
                self.left_out[self.left] += 1
            elif self.keyword == "INSTANCE":
                self.move(text)
            elif self.keyword == "SYSTEM":
                self.wrong(f"*SYSTEM moves the nodes after it, which is not supported; {REMEDY}")
        self.refuse_half_an_element()

    def wrong(self, what):
        wrong(self.path, self.line, what)

    def refuse_half_an_element(self):
        if self.pending:
            self.wrong(f"element {self.pending[0]} has {len(self.pending) - 1} nodes before this line, not "
                       f"{NODES_OF[self.kind]}: the file is truncated")

    def begin(self, text):
        self.refuse_half_an_element()
        words = [word.strip() for word in text[1:].split(",")]
        self.keyword = words[0].upper()
        pairs = (word.partition("=") for word in words[1:])
        self.options = {key.strip().upper(): value.strip().strip('"') for key, _, value in pairs}
        if self.keyword == "INCLUDE":
            self.include()
        elif self.keyword in GENERATORS:
            self.wrong(f"*{self.keyword} creates nodes or elements, which is not supported; {REMEDY}")
        elif self.keyword in ("PART", "ASSEMBLY", "INSTANCE", "END PART", "END ASSEMBLY", "END INSTANCE"):
            self.enter()
        elif self.keyword in ("NODE", "ELEMENT", "NSET", "ELSET"):
            if "INPUT" in self.options:
                self.wrong(f"INPUT={self.options['INPUT']} is not read: insert the lines of that file here, or use *INCLUDE")
            if self.keyword == "ELEMENT":
                word = self.options.get("TYPE", "").upper()
                self.kind = abaqus_kind(word)
                if self.kind is None:
                    self.leave_out(word)
            elif self.keyword == "NODE" and self.options.get("SYSTEM", "R").upper() != "R":
                self.wrong(f"*NODE, SYSTEM={self.options['SYSTEM']}: only rectangular coordinates are read; {REMEDY}")
            elif self.keyword == "NSET" and self.options.get("NSET") and self.options.get("ELSET"):
                self.nodes_of_elements()

    def leave_out(self, word):
        """Ignores masses, springs and connectors, which are not part of a continuum."""
        if not word.startswith(NO_CONTINUUM):
            self.wrong(f"elements of type {word or '(none)'} are not read; tetrahedra are C3D4 and C3D10")
        self.left_out.setdefault(word, 0)
        self.keyword = "LEFT OUT"
        self.left = word

    def include(self):
        name = self.options.get("INPUT")
        if not name:
            self.wrong("*INCLUDE names no file: write *INCLUDE, INPUT=FILE")
        included = self.path.parent / name
        if not included.is_file():
            self.wrong(f"*INCLUDE, INPUT={name}: there is no file {included}; put it there, or insert its lines here")
        if any(included.samefile(file) for file in self.files):
            self.wrong(f"{included} includes itself")
        path = self.path
        self.files.append(included)
        self.keyword = ""
        self.read(included)
        self.files.pop()
        self.path, self.keyword = path, ""

    def enter(self):
        """Changes the scope. Each part and the assembly have their own numbers; an instance has those of its part."""
        if self.keyword == "PART":
            self.scope = "part " + self.options.get("NAME", "").upper()
        elif self.keyword == "INSTANCE":
            self.scope = "part " + self.options.get("PART", "").upper()
            self.part_of[self.options.get("NAME", "").upper()] = self.scope
        else:
            self.scope = "assembly" if self.keyword in ("ASSEMBLY", "END INSTANCE") else ""

    def move(self, text):
        """Reads a position of an instance: its shift, or two points of an axis and an angle."""
        row = numbers(text, self.path, self.line, commas=True)
        if any(row[6:] if len(row) == 7 else row):
            self.moved.setdefault(self.scope, (self.path, self.line))

    def node(self, text):
        row = numbers(text, self.path, self.line, commas=True)
        if len(row) != 4:
            self.wrong("expected a node number and three coordinates")
        node = self.scope, whole(row[0], "node number", self.path, self.line)
        if node not in self.number_of:
            self.number_of[node] = len(self.points)
            self.points.append(row[1:])
        elif self.points[self.number_of[node]] != row[1:]:
            self.wrong(f"node {node[1]} is defined twice, at different places; if there are several parts, export one of them")
        if self.options.get("NSET"):
            self.set_of("NSET").append(node)

    def element(self, text):
        self.pending += numbers(text, self.path, self.line, kind=int, commas=True)
        nodes = self.pending[1:]
        if len(nodes) > NODES_OF[self.kind]:
            self.wrong(f"expected an element of {NODES_OF[self.kind]} nodes, found {len(nodes)}")
        if len(nodes) < NODES_OF[self.kind]:
            return
        element = self.scope, self.pending[0]
        if element in self.elements:
            self.wrong(f"element {element[1]} is defined twice; if there are several parts, export one of them")
        for node in nodes:
            if (self.scope, node) not in self.number_of:
                self.wrong(f"node {node} is used but not defined")
        self.elements[element] = self.kind, [self.number_of[self.scope, node] for node in nodes]
        if self.options.get("ELSET"):
            self.set_of("ELSET").append(element)
        self.pending = []

    def set_of(self, kind):
        """Returns the members of the set that the options name. The case of names is ignored."""
        name = self.options.get(kind)
        if not name:
            self.wrong(f"*{kind} has no name")
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
            step = row[2] if len(row) == 3 else 1
            members = range(row[0], row[1] + (1 if step > 0 else -1), step)
            if not members:
                self.wrong(f"GENERATE from {row[0]} to {row[1]} by {step} makes no member; "
                           "exchange the first and the last number, or remove the set")
            if (row[1] - row[0]) // step >= LONGEST_RANGE:
                self.wrong(f"GENERATE makes more than {LONGEST_RANGE} members: list only existing ones")
            found += [(scope, n) for n in members]
            return
        for word in (word.strip().strip('"') for word in text.split(",")):
            instance, _, of_instance = word.rpartition(".")
            if word.lstrip("-").isdigit():
                found.append((scope, int(word)))
            elif of_instance.isdigit() and instance.upper() in self.part_of:
                found.append((self.part_of[instance.upper()], int(of_instance)))
            elif word:
                found += self.known_set(self.keyword, word)

    def known_set(self, kind, name):
        """Returns the members of the set of this name. In the assembly, the name may begin with an instance: "INSTANCE.SET"."""
        instance, _, of_instance = name.rpartition(".")
        known = of_instance if instance.upper() in self.part_of else name
        if known.upper() not in self.sets[kind]:
            self.wrong(f"there is no set \"{name}\" before this line")
        members = self.sets[kind][known.upper()][1]
        return [m for m in members if known == name or m[0] == self.part_of[instance.upper()]]

    def nodes_of_elements(self):
        """Reads *NSET, NSET=name, ELSET=elements."""
        elements = self.known_set("ELSET", self.options["ELSET"])
        number = {point: node for node, point in self.number_of.items()}
        self.set_of("NSET").extend(number[point] for e in elements if e in self.elements for point in self.elements[e][1])

    def refuse_instances_of(self, scope):
        """Refuses several instances of a part, and a moved instance."""
        count = list(self.part_of.values()).count(scope)
        if count > 1:
            wrong(self.files[0], None, f"there are {count} instances of {scope}, which has tetrahedra; export one of them")
        if scope in self.moved:
            wrong(*self.moved[scope], f"this line moves an instance of {scope}, which is not supported; remove the "
                                      f"line if the body may stay at the place of the part, or {REMEDY}")

    def body(self):
        if not self.elements and self.left_out:
            wrong(self.files[0], None, f"elements of type {', '.join(self.left_out)} are not read; tetrahedra are C3D4 "
                                       "and C3D10")
        parts = {scope for (scope, _), (kind, _) in self.elements.items() if kind.startswith("tetra")}
        if len(parts) > 1:
            wrong(self.files[0], None, f"there are tetrahedra in {len(parts)} parts; export one of {', '.join(sorted(parts))}")
        for scope in parts:
            self.refuse_instances_of(scope)
        body, by_kind, place = Body(self.points), {}, {}
        for element, (kind, nodes) in self.elements.items():
            by_kind.setdefault(kind, []).append((element, nodes))
        for kind, rows in by_kind.items():
            block = body.add(kind, [nodes for _, nodes in rows])
            place.update({element: (block, i) for i, (element, _) in enumerate(rows)})
        for word, lines in self.left_out.items():
            body.notes.append(f"elements of type {word} are omitted ({lines} lines)")
        for name, elements in self.sets["ELSET"].values():
            body.group_of([place[element] for element in elements if element in place], name)
            body.note_missing(name, sum(element not in place for element in elements), "element")
        for name, nodes in self.sets["NSET"].values():
            body.point_groups[name] = [self.number_of[node] for node in nodes if node in self.number_of]
            body.note_missing(name, sum(node not in self.number_of for node in nodes), "node")
        return body


def read_abaqus(path):
    """Reads *NODE, *ELEMENT, *NSET, *ELSET and *INCLUDE, of one part or instance. AVS UCD files have the same extension, and
    begin with five numbers; meshio reads them."""
    first = next((text for _, text in data_lines(path, comment="#")), "").split()
    if len(first) == 5 and all(word.isdigit() for word in first):
        return read_by_meshio(path, "avsucd")
    return Abaqus(path).body()
