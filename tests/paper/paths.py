"""Where paths lead: how many get to their end (Sec. 6.1), and the forces and shapes on the way (Figs. 6 and 5).

A path *merely converges* when Newton finds something at every step, as the paper counts: with its elements of equal order
and det F - 1, inverted elements and any inertia accepted. It is *valid* when every configuration has min det F > 0 and the
inertia of a stable equilibrium, with elements that satisfy inf-sup. Steps are fixed, or adaptive: transitions of 20 mm that
are halved where they fail, and for valid paths go by way of points beside (docs/solver.md)."""
import collections
import contextlib
import dataclasses
import functools
import json
import os
import shutil
import subprocess

import figure
import organs
import published
from record import Incomplete, NotMeasured, needed

LAW_WORDS = {"svk": "st-venant-kirchhoff", "msvk": "modified-st-venant-kirchhoff", "mr": "mooney-rivlin"}  # of the survey
RANDOM_PATHS = 200  # of a law, ten from each of 20 active nodes

# Sec. 6.1: surveys


@dataclasses.dataclass(frozen=True)
class Survey:
    nodes: int             # of the organ, about
    law: str
    kind: str = "regular"  # or "random"
    fixed_steps: bool = False
    tool: str = "rigid"
    radius: float = 0.0    # m, of the patch or finger
    merely: bool = False   # whether what merely converges is counted beside

    def touch(self):
        return "single node" if self.radius == 0 else f"{self.tool}, {1000 * self.radius:g} mm"

    def name(self):
        return f"{organs.organ(self.nodes).name}, {organs.LAWS[self.law]}, {self.touch()}, {self.kind}"


def surveys(record):
    """The paper's on its mesh and laws; and those that only ask how far ours get."""
    papers = [Survey(500, law, kind, fixed, merely=True) for law in ("svk", "msvk", "mr")
              for kind, fixed in (("regular", True), ("regular", False), ("random", True))]
    more = [Survey(500, law, tool="rigid", radius=0.015) for law in ("msvk", "mr")]
    more += [Survey(500, law, tool="finger", radius=0.02) for law in ("msvk", "mr")]
    more += [Survey(2000, law, merely=True) for law in ("msvk", "mr")]
    more += [Survey(2000, law, tool="rigid", radius=0.015) for law in ("msvk", "mr")]
    more += [Survey(2000, law, tool="finger", radius=0.02) for law in ("msvk", "mr")]
    return papers if record.quick else [survey for survey in papers + more if survey.nodes in record.nodes]


@dataclasses.dataclass
class Reached:
    """What became of the paths of a survey."""
    way: list      # m that each path got along
    length: float  # m of each
    complete: int
    without_inverted: int
    straight: int
    causes: collections.Counter
    measured: object

    def percent(self, count=None):
        return 100 * (self.complete if count is None else count) / len(self.way)


def step(record, survey):
    """m of a transition."""
    return 0.02 if not survey.fixed_steps else 0.005 if record.quick else 0.001


def steps_words(record, survey):
    return f"{1000 * step(record, survey):g} mm, {'fixed' if survey.fixed_steps else 'adaptive'}"


def walked(record, survey, merely, random_paths):
    """Measures a survey from node to node, so that an interruption costs one at most."""
    axes, nodes, directions = (("x",), 2, 6) if record.quick else (("x", "y"), 10, 26)
    each = 1 if record.quick else -(-random_paths // (len(axes) * nodes))
    words = [record.bench / "palpate_path_survey", organs.organ(survey.nodes).mesh, "--law", LAW_WORDS[survey.law], "--every-path",
             "--tool", survey.tool, "--radius", survey.radius, "--nodes", nodes, "--transition", step(record, survey)]
    steps = round(0.2 / step(record, survey))
    words += ["--random", each, "--steps", steps] if survey.kind == "random" else ["--directions", directions]
    words += (["--fixed-steps"] if survey.fixed_steps else []) + (["--merely-converged"] if merely else [])
    name = f"paths of {survey.name()}, {steps_words(record, survey)}{', merely converged' if merely else ''}"
    parts = record.together([functools.partial(record.run, f"{name}, {axis} node {node + 1} of {nodes}",
                                               [*words, "--axis", axis, "--only-node", node]) for axis in axes for node in range(nodes)])
    every = [path for part in parts for path in part.value["every_path"]]
    done = [path for path in every if "cause" not in path]
    return Reached(way=[path["reached_m"] for path in every], length=0.2 if survey.kind == "random" else 0.1, complete=len(done),
                   without_inverted=sum(path["smallest_det_F"] > 0 for path in done), straight=sum(path["detours"] == 0 for path in done),
                   causes=collections.Counter(path["cause"] for path in every if "cause" in path),
                   measured=parts[0])


def wilson(successes, trials, z=1.96):
    """95 % interval of a share, % (Wilson 1927)."""
    share, spread = successes / trials, z * z / trials
    middle = (share + spread / 2) / (1 + spread)
    half = z / (1 + spread) * (share * (1 - share) / trials + spread / (4 * trials)) ** 0.5
    return 100 * max(0.0, middle - half), 100 * min(1.0, middle + half)


def interval(survey, reached):
    """In words: regular paths are all there are, random ones a sample."""
    return "{:.1f} to {:.1f}".format(*wilson(reached.complete, len(reached.way))) if survey.kind == "random" else "no sample"


SURVEY_COLUMNS = ["organ", "law", "tool", "paths", "steps", "number of paths", "published (%)", "merely converged (%)",
                  "95 % interval, merely converged (%)", "merely converged, no element inverted (%)", "valid (%)",
                  "95 % interval, valid (%)", "valid, straight (%)", "why the others stopped, merely converged",
                  "why the others stopped, valid"]


def survey_row(record, survey, merely, valid):
    causes = lambda reached: ", ".join(f"{count} {cause}" for cause, count in reached.causes.most_common()) or "none did"
    comparable = survey.kind == "regular" and survey.nodes == 500 and survey.radius == 0
    row = [organs.organ(survey.nodes).name, organs.LAWS[survey.law], survey.touch(), survey.kind, steps_words(record, survey),
           len(valid.way), published.CONVERGED[survey.law] if comparable else "-"]
    row += [merely.percent(), interval(survey, merely), merely.percent(merely.without_inverted)] if merely else [None] * 3
    row += [valid.percent(), interval(survey, valid), valid.percent(valid.straight), causes(merely) if merely else None, causes(valid)]
    for column, value in zip(SURVEY_COLUMNS, row):
        reached = merely if "merely" in column else valid
        if isinstance(value, float):
            name = f"{survey.name()}, {steps_words(record, survey)}/{column.removesuffix(' (%)')}"
            record.number(name, value, "%", reached.measured)
    return row


def survival(record, survey, reached, counted):
    """How many get how far: rows of SURVIVAL_COLUMNS."""
    parts = 50
    ways = [reached.length * n / parts for n in range(parts + 1)]
    share = lambda way: 100 * sum(r >= way - 1e-9 for r in reached.way) / len(reached.way)
    start = [organs.organ(survey.nodes).name, organs.LAWS[survey.law], survey.kind, steps_words(record, survey), counted]
    return [[*start, 1000 * way, share(way)] for way in ways]


SURVIVAL_COLUMNS = ["organ", "law", "paths", "steps", "counted", "way (mm)", "paths that got there (%)"]


def draw_survival(rows):
    panels = list(dict.fromkeys((row[2], row[3]) for row in rows))
    laws = list(dict.fromkeys(row[1] for row in rows))

    def draw(page):
        axes = page.subplots(1, len(panels), squeeze=False, sharey=True)[0]
        for axis, panel in zip(axes, panels):
            for n, law in enumerate(laws):
                for counted, line in (("valid", "-"), ("merely converged", "--")):
                    points = [(row[5], row[6]) for row in rows if (row[2], row[3]) == panel and row[1] == law and row[4] == counted]
                    axis.plot(*zip(*points), line, color=figure.COLORS[n], label=f"{law}, {counted}")
                if panel[0] == "regular":
                    word = next(word for word, name in organs.LAWS.items() if name == law)
                    axis.plot([100], [published.CONVERGED[word]], "*", markersize=9, color=figure.COLORS[n], clip_on=False,
                              label=f"{law}, published")
            axis.set(xlabel="way (mm)", ylim=(0, 102))
            axis.set_title(f"{panel[0]} paths, steps of {panel[1]}", fontsize=9)
        axes[0].set_ylabel("paths that get there (%)")
        figure.legend_below(page, axes[0], lines=3)

    return draw


def survey(record, random_paths=RANDOM_PATHS):
    """Sec. 6.1: how many paths get to their end, merely converged and valid, by law and steps."""
    rows, curves = [], []
    for one in surveys(record):
        try:
            merely = walked(record, one, True, random_paths) if one.merely else None
            valid = walked(record, one, False, random_paths)
        except NotMeasured as why:
            record.not_measured(f"{one.name()}, {steps_words(record, one)}", str(why))
            continue
        rows.append(survey_row(record, one, merely, valid))
        if one.nodes == 500 and one.radius == 0:
            curves += survival(record, one, merely, "merely converged") + survival(record, one, valid, "valid")
    figure.save_table(record, "paths", SURVEY_COLUMNS, rows)
    if curves:
        figure.save_figure(record, "paths-way", SURVIVAL_COLUMNS, curves, draw_survival(curves), size=(11, 4.4))


# The body: where it can be touched, and which way is out


@dataclasses.dataclass(frozen=True)
class Place:
    node: tuple     # m, at rest
    outward: tuple  # unit normal of the surface


def body(record, organ):
    """Points (n x 3, m), outward triangles, and fixed nodes, as the dataset of seven configurations has them."""
    needed("h5py")
    import h5py
    dataset = record.dataset(f"{organ.name}-body", organs.scene(organ, "linear", radius=0.001, divisions=1))
    with h5py.File(dataset.value["dataset"]) as file:
        return file["mesh/points"][:], file["mesh/surface"][:], file["mesh/fixed_nodes"][:]


def place(points, surface, node):
    numpy = needed("numpy")
    around = points[surface[(surface == node).any(1)]]
    normal = numpy.cross(around[:, 1] - around[:, 0], around[:, 2] - around[:, 0]).sum(0)
    return Place(tuple(map(float, points[node])), tuple(map(float, normal / numpy.linalg.norm(normal))))


def places(record, organ):
    """A is the organ's tip; F the node of the surface that is farthest from it and from what is held."""
    numpy = needed("numpy")
    points, surface, fixed = body(record, organ)
    skin = numpy.setdiff1d(numpy.unique(surface), fixed)
    distance = lambda others: numpy.linalg.norm(points[skin][:, None] - points[others][None], axis=2).min(1)
    tip = skin[numpy.linalg.norm(points[skin] - organ.tip, axis=1).argmin()]
    far = skin[numpy.minimum(distance(numpy.array([tip])), distance(fixed)).argmax()]
    return {"A": place(points, surface, tip), "F": place(points, surface, far)}


def scene_at(organ, law, where, **options):
    """The linear law knows nothing of inverted elements: there they are accepted, and counted."""
    scene = organs.scene(organ, law, active=f"near = [{', '.join(map(repr, where.node))}]", **options)
    return scene.replace("[workspace]\n", "[workspace]\nreject_inverted = false\n") if law == "linear" else scene


def straight_path(record, name, organ, law, where, direction, length, step_length):
    """The exact solutions from rest straight on, as far as they go."""
    count = round(length / step_length)
    file = record.scene(name, scene_at(organ, law, where))
    path = [[length * n / count * x for x in direction] for n in range(1, count + 1)]
    measured = record.run(f"path {name}", [record.bench / "palpate_path_forces", file, "--active", "tip"], json.dumps([path]))
    return measured, count


# Fig. 6: force against displacement

FORCE_COLUMNS = ["organ", "path", "law", "displacement (mm)", "force (N)", "min det F", "volume by that at rest (%)", "stopped by"]
FIGURE6_LAWS = ("linear", "svk", "mr")


def force_curve(record, organ, path, law, where, direction):
    """Rows of FORCE_COLUMNS; where the path stopped, in the last one, why."""
    step_length = 0.005 if record.quick else 0.001
    measured, count = straight_path(record, f"{organ.name}-{path}-{law}", organ, law, where, direction, 0.1, step_length)
    walk = measured.value["paths"][0]
    rows = [[organ.name, path, organs.LAWS[law], 0.0, 0.0, 1.0, 100.0, ""]]
    for point in walk["reached"]:
        norm = lambda v: sum(x * x for x in v) ** 0.5
        rows.append([organ.name, path, organs.LAWS[law], 1000 * norm(point["displacement"]), norm(point["force"]), point["min_det_F"],
                     100 * point["volume"], ""])
    rows[-1][-1] = "" if len(walk["reached"]) == count else walk["cause"]
    name = f"{organ.name}, {path}, {organs.LAWS[law]}"
    record.number(f"{name}/reached", rows[-1][3], "mm", measured)
    record.number(f"{name}/force there", rows[-1][4], "N", measured)
    return rows


def draw_forces(rows, paths):
    def draw(page):
        axes = page.subplots(1, len(paths), squeeze=False)[0]
        for axis, path in zip(axes, paths):
            for n, law in enumerate(FIGURE6_LAWS):
                curve = [row for row in rows if row[1] == path and row[2] == organs.LAWS[law]]
                axis.plot([row[3] for row in curve], [row[4] for row in curve], color=figure.COLORS[n], label=organs.LAWS[law])
                stopped = [row for row in curve if row[7]]
                axis.plot([row[3] for row in stopped], [row[4] for row in stopped], "x", color=figure.COLORS[n])
                if law == "linear":
                    inverted = [row for row in curve if row[5] <= 0][:1]
                    axis.plot([row[3] for row in inverted], [row[4] for row in inverted], "|", markersize=10, color=figure.COLORS[n])
            first = next(row for row in rows if row[1] == path and row[2] == organs.LAWS["mr"] and row[3] > 0)
            axis.plot([0, 100], [0, 100 * first[4] / first[3]], ":", linewidth=0.8, color="black",
                      label="slope of Mooney-Rivlin at rest: linear, without locking")
            axis.set(xlabel="displacement (mm)", xlim=(0, 102), ylim=(0, None))
            axis.set_title(path, fontsize=9)
        axes[0].set_ylabel("force (N)")
        axes[0].plot([], [], "x", color="black", label="no further on this branch")
        axes[0].plot([], [], "|", markersize=10, color=figure.COLORS[0], label="an element is inverted from here on")
        figure.legend_below(page, axes[0], lines=2)

    return draw


def figure6(record):
    """Fig. 6: force against displacement along four paths, pulled outward (1) and pressed inward (2) at two nodes, by law."""
    rows = []
    for nodes in record.nodes[:1]:
        organ = organs.organ(nodes)
        for letter, where in places(record, organ).items():
            for number, sign in ((1, 1), (2, -1)):
                direction = [sign * x for x in where.outward]
                for law in FIGURE6_LAWS:
                    rows += force_curve(record, organ, f"{letter}{number}", law, where, direction)
    paths = list(dict.fromkeys(row[1] for row in rows))
    figure.save_figure(record, "figure6", FORCE_COLUMNS, rows, draw_forces(rows, paths), size=(11, 3.6))


# Fig. 5: shapes

PULL, REACH = 0.04, 0.08  # m: the displacement that is shown, a point of the lattice, and the radius of that


@contextlib.contextmanager
def screen():
    """The environment of a program that draws: an Xvfb of its own, and OpenGL in software."""
    if not shutil.which("Xvfb"):
        raise NotMeasured("Xvfb is not installed (package xvfb)")
    with subprocess.Popen(["Xvfb", "-displayfd", "1", "-screen", "0", "1600x1000x24", "-nolisten", "tcp", "-noreset"],
                          stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True) as server:
        try:
            number = server.stdout.readline().strip()
            if not number:
                raise NotMeasured("Xvfb did not start")
            yield {**os.environ, "DISPLAY": f":{number}", "LIBGL_ALWAYS_SOFTWARE": "1"}
        finally:
            server.terminate()


def view(record, *words, env=None):
    command = [str(word) for word in (record.programs / "palpate", "view", *words)]
    done = subprocess.run(command, capture_output=True, text=True, check=False, env=env, timeout=300, cwd=record.folder)
    if done.returncode != 0:
        raise Incomplete(f"{record.shown(command)} ended with {done.returncode}: {done.stderr.strip()[-1000:]}")


def hand(record, dataset, where, aim):
    """A recording of a hand that takes hold of the node, pulls it to `aim` (m, scene) and stays: the same for all laws."""
    lines = [[0.0, *where.node], [0.2, *where.node], [1.5, *aim], [3.0, *aim]]
    path, recording = "scenes/pull.txt", "scenes/pull.h5"  # in the folder: the picture says what is replayed
    (record.folder / path).write_text("".join(" ".join(map(repr, line)) + "\n" for line in lines), encoding="utf-8")
    view(record, dataset, "--device", f"virtual:{path}", "--contact", "glued", "--headless", "--fast", "--duration", 2.5,
         "--record", recording)
    return recording


def draw_shapes(record, datasets, where, aim):
    """figures/figure5-LAW.png of each: the last picture of the same hand."""
    recording = hand(record, datasets["mr"], where, aim)
    with screen() as env:
        for law, dataset in datasets.items():
            picture = record.folder / "figures" / f"figure5-{law}.png"
            picture.parent.mkdir(parents=True, exist_ok=True)
            view(record, dataset, "--device", f"replay:{recording}", "--contact", "glued", "--fast", "--screenshot", picture, env=env)


SHAPE_COLUMNS = ["organ", "law", "displacement (mm)", "force (N)", "change of volume (%)", "min det F", "picture"]


def figure5(record):
    """Fig. 5: the same pull by law: pictures, and how much the volume changes."""
    organ = organs.organ(record.nodes[0])
    where = places(record, organ)["A"]
    axis = max(range(3), key=lambda n: abs(where.outward[n]))
    pull = [PULL * (1 if where.outward[n] > 0 else -1) if n == axis else 0.0 for n in range(3)]
    datasets, points, sources = {}, {}, {}
    for law in FIGURE6_LAWS:
        datasets[law] = record.dataset(f"{organ.name}-{law}-shape", scene_at(organ, law, where, radius=REACH, divisions=2)).value["dataset"]
        direction = [x / PULL for x in pull]
        sources[law], count = straight_path(record, f"{organ.name}-pull-{law}", organ, law, where, direction, PULL, 0.005)
        reached = sources[law].value["paths"][0]["reached"]
        if len(reached) < count:
            raise Incomplete(f"figure5: {organs.LAWS[law]} does not reach {1000 * PULL:g} mm: {sources[law].value['paths'][0]['failure']}")
        points[law] = reached[-1]
    virtual_hand = 400.0  # N/m: it gives way to the force (viewer/devices/virtual_hand.hpp)
    aim = [x + p - f / virtual_hand for x, p, f in zip(where.node, pull, points["mr"]["force"])]
    pictures = {law: f"figure5-{law}.png" for law in datasets}
    try:
        draw_shapes(record, datasets, where, aim)
    except NotMeasured as why:
        record.not_measured("pictures", str(why))
        pictures = dict.fromkeys(datasets)
    rows = []
    for law, point in points.items():
        norm = lambda v: sum(x * x for x in v) ** 0.5
        rows.append([organ.name, organs.LAWS[law], 1000 * norm(point["displacement"]), norm(point["force"]), 100 * (point["volume"] - 1),
                     point["min_det_F"], pictures[law]])
        record.number(f"{organ.name}, {organs.LAWS[law]}/change of volume", rows[-1][4], "%", sources[law])
        record.number(f"{organ.name}, {organs.LAWS[law]}/force", rows[-1][3], "N", sources[law])
    figure.save_table(record, "figure5", SHAPE_COLUMNS, rows)
