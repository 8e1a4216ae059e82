"""Claims of the paper's discussion, each tested: a table of the claim, the measurement, and whether it holds."""
import functools
import json
import random

import figure
import interpolation
import organs
import references
from record import Measured, NotMeasured, needed


def claims(record):
    """Claims of the paper's discussion, compared with measurements."""
    rows = []
    for claim, test in CLAIMS.items():
        try:
            rows += test(record, claim)
        except NotMeasured as why:
            rows.append(told(record, claim, "all of it", None, "", None, str(why)))
    figure.save_table(record, "claims", ["claim", "measured", "value", "unit"], rows)


def told(record, claim, what, value, unit, measured, why="nothing was solved"):
    if value is None:
        record.not_measured(f"{claim}/{what}", why)
    else:
        record.number(f"{claim}/{what}", value, unit, measured)
    return [claim, what, value, unit]


# RBF-cubic at 514 points equals tri-linear at 14146

def radial_beside_trilinear(record, claim):
    rows = []
    for case in interpolation.cases(record):
        for kind in ("regular", "random"):
            errors = {(row[2], row[3]): row for row in interpolation.errors_of(record, case, kind)}
            sizes = sorted({points for points, _ in errors})
            coarse, fine = errors[(sizes[0], "rbf-cubic")], errors[(sizes[-1], "trilinear")]
            of = f"tests/measure/paper/run figure{8 if kind == 'regular' else 9}"
            measured = Measured.of_all([interpolation.built(record, case, divisions) for divisions in interpolation.lattices(record)], of)
            for column, label in ((9, "mean"), (10, "largest")):
                rows.append(told(record, claim, f"{case.name()}, {kind} paths: {label} relative error of RBF-cubic at {sizes[0]} by that of tri-linear at {sizes[-1]}",
                                 coarse[column] / fine[column], "", measured))
    return rows


# The haptic loop depends neither on the material nor on convergence

def loop_beside_material(record, claim):
    generator = random.Random(17)
    places = [references.in_ball(generator, 0.05) for _ in range(500)]
    rows, times = [], {"trilinear": [], "potential": []}
    for count in record.nodes:
        organ = organs.organ(count)
        for law in organs.MATERIALS:
            dataset = record.dataset(f"{organ.name}-{law}-loop", organs.scene(organ, law, radius=0.06, divisions=3))
            given, measured = interpolation.answers(record, f"{organ.name} {law} loop", dataset.value["dataset"], list(times), places)
            work = seconds_a_point(dataset)
            for method, every in times.items():
                every.append(given[method]["query_ns"])
                rows.append(told(record, claim, f"{organ.name}, {organs.LAWS[law]}: a query of {method}{work}",
                                 given[method]["query_ns"], "ns", measured))
    for method, every in times.items():
        rows.append(told(record, claim, f"{method}: slowest by fastest of these", max(every) / min(every), "", measured))
    return rows


def seconds_a_point(dataset):
    """As text, if the number of workers is known."""
    points, jobs = dataset.value["points"], dataset.value["jobs"]
    if jobs is None:
        return ""
    seconds = dataset.value["seconds"] * jobs / max(1, points["expandable"] + points["terminating"])
    return f" (its build took {1000 * seconds:.0f} ms of a worker for each configuration)"


# k nodes take O(2^k)

def several_nodes(record, claim):
    """The paper says O(2^k), but lattices for k simultaneous nodes have N^k points. Counted, not solved."""
    measured = record.measure("points of lattices of several nodes", lambda: {n: len(ball(n)) for n in (2, 3, 5)}, command="tests/measure/paper/run claims")
    return [told(record, claim, f"{k} nodes, each of the {measured.value[str(n)]} points of a lattice",
                 measured.value[str(n)] ** k, "configurations", measured) for n in (5,) for k in (1, 2, 3)]


def ball(n):
    reach = range(-n, n + 1)
    return [(i, j, k) for i in reach for j in reach for k in reach if 0 < i * i + j * j + k * k <= n * n]


# The same point is the same configuration on every path

def uniqueness(record, claim):
    """Reaches lattice points straight from rest, and along the axes in two orders, and compares the forces."""
    numpy = needed("numpy")
    rows = []
    step = 0.02
    points = ball(2 if record.quick else 5)
    for case in interpolation.cases(record):
        scene = organs.scene(case.organ(), case.law, divisions=5)
        chunks = [(order, n, points[n:n + 50]) for order in ("straight", "xyz", "zyx") for n in range(0, len(points), 50)]
        ends = record.together([functools.partial(ends_of, record, f"{case.name()}-{order}-{n}", scene, [way(p, order, step) for p in chunk])
                                for order, n, chunk in chunks])  # an interruption loses one chunk at most
        reached = {(p, order): end for (order, _, chunk), some in zip(chunks, ends) for p, end in zip(chunk, some.value)}
        all_ways = [p for p in points if all(reached[(p, order)] for order in ("straight", "xyz", "zyx"))]
        spread = [max(numpy.linalg.norm(numpy.subtract(reached[(p, a)], reached[(p, "straight")])) for a in ("xyz", "zyx")) for p in all_ways]
        same = [s <= 1e-5 * max(1, numpy.linalg.norm(reached[(p, "straight")])) for p, s in zip(all_ways, spread)]
        for what, value, unit in ((f"reached in all three ways, of {len(points)}", len(all_ways), "points"),
                                  ("of these with one force (to 1e-5)", sum(same), "points"),
                                  ("largest difference of forces", float(max(spread, default=0)), "N")):
            rows.append(told(record, claim, f"{case.name()}: {what}", value, unit, Measured.of_all(ends, "tests/measure/paper/run claims")))
    return rows


def way(point, order, step):
    target = [step * x for x in point]
    if order == "straight":
        return [target]
    path, at = [], [0.0, 0.0, 0.0]
    for axis in ("xyz".index(letter) for letter in order):
        if point[axis] != 0:
            at = [target[a] if a == axis else at[a] for a in range(3)]
            path.append(at)
    return path


def ends_of(record, name, scene, paths):
    """The force at the end of each path, or None if it was not reached."""
    measured = record.run(f"ends of {name}", [record.bench / "palpate_path_forces", record.scene(name, scene), "--active", "tip"], json.dumps(paths))
    measured.value = [path["reached"][-1]["force"] if len(path["reached"]) == len(points) else None
                      for path, points in zip(measured.value["paths"], paths)]
    return measured


# Which error is largest?

TOOLS = {"single node": {}, "rigid patch of 25 mm": {"patch": 0.025}, "finger of 25 mm": {"patch": 0.025, "tool": "finger"}}


def which_error(record, claim):
    """Mean relative difference of forces at the same displacements, within 30 mm of the tip, for each kind of change."""
    generator = random.Random(7)
    places = [references.in_ball(generator, 0.03) for _ in range(12 if record.quick else 60)]
    coarse = organs.organ(500)

    def forces(organ, tool, scale=1.0, **options):
        scene = organs.scene(organ, **{"law": "mr", "radius": 0.03, "divisions": 2, **TOOLS[tool], **options})
        words = [organ.name, tool, *map(str, options.values()), *([] if scale == 1 else [f"by {scale}"])]
        ends = ends_of(record, "-".join(words).replace(" ", "-"), scene, [[[scale * x for x in place]] for place in places])
        ends.value = [force and [f / scale for f in force] for force in ends.value]
        return ends

    def differs(what, others, ours):
        value, count = relative(others.value, ours.value)
        return told(record, claim, f"{what} ({count} of {len(places)} places)", value, "%", others)

    rows = []
    for tool in TOOLS:
        ours = forces(coarse, tool)
        if tool.startswith("finger"):
            rows += [differs(f"law, {tool}: {organs.LAWS[law]}", forces(coarse, tool, law=law), ours) for law in ("linear", "svk", "msvk")]
            rows.append(differs(f"law, {tool}: linear, in elements that do not lock (Mooney-Rivlin's forces of displacements a "
                                "1000th as large, times 1000)", forces(coarse, tool, scale=0.001), ours))
            rows.append(differs(f"elements, {tool}: P1/P1, det F - 1 (the paper's)", forces(coarse, tool, pressure="P1", constraint="det-F-1"), ours))
            rows += interpolated(record, claim, coarse, TOOLS[tool], places, ours)
        rows.append(differs(f"elements, {tool}: P2/P1 on the same mesh", forces(coarse, tool, displacement="P2"), ours))
        for finer in finer_meshes(record, coarse):
            rows.append(differs(f"mesh, {tool}: {finer.name}", forces(finer, tool), ours))
    value, count, wanted, measured = snapping(record, coarse)
    rows.append(told(record, claim,
                     f"snapping to the nearest node, a finger of 20 mm pressed in by 5 mm ({count} of {wanted} places)", value, "%", measured))
    return rows


def finer_meshes(record, coarse):
    """Only of the same organ: a substitute for a missing reference liver would be meaningless here."""
    finer = {} if record.quick else {nodes: organs.organ(nodes) for nodes in (2000, 6000)}
    for nodes, organ in finer.items():
        if organ.source == coarse.source and organ not in [other for fewer, other in finer.items() if fewer < nodes]:
            yield organ
        else:
            record.not_measured(f"which error dominates/mesh of about {nodes} nodes", f"there is none of the organ of {coarse.name}")


def relative(forces, reference):
    """Mean of |f - r| / max(|r|, FLOOR), %, over places where both are known (None: nowhere), and their number."""
    numpy = needed("numpy")
    both = [(f, r) for f, r in zip(forces, reference) if f and r]
    each = [100 * numpy.linalg.norm(numpy.subtract(f, r)) / max(references.FLOOR, numpy.linalg.norm(r)) for f, r in both]
    return (float(numpy.mean(each)) if each else None), len(both)


def interpolated(record, claim, organ, tool, places, exact):
    dataset = record.dataset(f"{organ.name}-which", organs.scene(organ, "mr", radius=0.03, divisions=2, **tool))
    given, measured = interpolation.answers(record, "which", dataset.value["dataset"], ["trilinear", "potential"], places)
    wrong = {method: relative(given[method]["force"], exact.value) for method in given}
    return [told(record, claim,
                 f"interpolation: {interpolation.LABELS[method]}, lattice of 15 mm ({count} of {len(places)} places)", value, "%", measured)
            for method, (value, count) in wrong.items()]


def snapping(record, organ):
    """Compares a finger pressed 5 mm inward at random places of the surface with the nearest node: the paper snaps to
    nodes. Returns the mean relative difference (%), the number of places, the requested number, and the source."""
    numpy = needed("numpy")
    needed("h5py")
    import h5py
    region = "surface = { sphere = { center = [%s], radius = 0.05 } }" % ", ".join(map(str, organ.tip))
    scene = organs.scene(organ, "mr", radius=0.02, divisions=2, patch=0.02, tool="finger", active=region)
    mesh = record.dataset(f"{organ.name}-which", organs.scene(organ, "mr", radius=0.03, divisions=2, **TOOLS["finger of 25 mm"]))
    with h5py.File(mesh.value["dataset"]) as file:
        points, triangles, fixed = file["mesh/points"][:], file["mesh/surface"][:], set(file["mesh/fixed_nodes"][:].tolist())
    generator = random.Random(23)
    near = [t for t in triangles.tolist() if not fixed.intersection(t) and numpy.linalg.norm(points[t].mean(0) - organ.tip) < 0.045]
    touches = []
    for triangle in generator.sample(near, min(len(near), 8 if record.quick else 60)):
        a, b = sorted((generator.random(), generator.random()))
        corners = points[triangle]
        place = a * corners[0] + (b - a) * corners[1] + (1 - b) * corners[2]
        normal = numpy.cross(corners[1] - corners[0], corners[2] - corners[0])
        press = -0.005 * normal / numpy.linalg.norm(normal)
        touches.append((place, min(corners, key=lambda corner: numpy.linalg.norm(corner - place)), press))
    file = record.scene("snapping", scene)
    line = lambda place, press: "%.9g %.9g %.9g %.9g %.9g %.9g\n" % (*place, *press)
    text = "".join(line(place, press) + line(node, press) for place, node, press in touches)
    measured = record.run("snapping", [record.programs / "palpate", "solve", file, "--active", "tip", "--at", "-", "--displacement", "-", "--json", "-q"],
                          text, lines=True, codes=(0, 3))
    forces = [answer["force"] for answer in measured.value]
    return *relative(forces[1::2], forces[::2]), len(touches), measured


CLAIMS = {"RBF-cubic with few points equals tri-linear with many": radial_beside_trilinear,
          "the haptic loop depends on neither material nor convergence": loop_beside_material,
          "k nodes at once take 2^k times the configurations": several_nodes,
          "a displacement has one configuration": uniqueness,
          "which error dominates": which_error}
