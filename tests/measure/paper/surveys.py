"""Sec. 6.1 of the paper: how many paths reach their end.

A path *merely converges* if Newton converges at every step, the paper's criterion: with its elements of equal order and
det F - 1, accepting inverted elements and any inertia. It is *valid* if every configuration has min det F > 0 and the
inertia of a stable equilibrium, with elements that satisfy inf-sup. Steps are fixed, or adaptive: transitions of 20 mm
are halved where they fail, and for valid paths they may pass through points beside the path (docs/solver.md)."""
import collections
import dataclasses
import functools

import figure
import organs
import published
from record import Incomplete, Measured, NotMeasured

LAW_WORDS = {"svk": "st-venant-kirchhoff", "msvk": "modified-st-venant-kirchhoff", "mr": "mooney-rivlin"}  # words of the survey program


@dataclasses.dataclass(frozen=True)
class Survey:
    nodes: int             # approximate number of nodes of the organ
    law: str
    kind: str = "regular"  # or "random"
    fixed_steps: bool = False
    tool: str = "rigid"
    radius: float = 0.0    # m, of the patch or finger
    merely: bool = False   # whether merely converged paths are counted too

    def touch(self):
        return "single node" if self.radius == 0 else f"{self.tool}, {1000 * self.radius:g} mm"

    def name(self):
        return f"{organs.organ(self.nodes).name}, {organs.LAWS[self.law]}, {self.touch()}, {self.kind}"


def surveys(record):
    """The paper's survey on its mesh and laws, and surveys only of our paths."""
    papers = [Survey(500, law, kind, fixed, merely=True) for law in ("svk", "msvk", "mr")
              for kind, fixed in (("regular", True), ("regular", False), ("random", True))]
    more = [Survey(500, law, tool="rigid", radius=0.015) for law in ("msvk", "mr")]
    more += [Survey(500, law, tool="finger", radius=0.02) for law in ("msvk", "mr")]
    more += [Survey(2000, law, merely=True) for law in ("msvk", "mr")]
    more += [Survey(2000, law, tool="rigid", radius=0.015) for law in ("msvk", "mr")]
    more += [Survey(2000, law, tool="finger", radius=0.02) for law in ("msvk", "mr")]
    every = papers if record.quick else papers + more
    return [survey for survey in every if survey.nodes in record.nodes and survey.law in record.laws]


@dataclasses.dataclass
class Reached:
    """The results of a survey's paths."""
    way: list      # m, reached length of each path
    length: float  # m, full length of each path
    complete: int
    without_inverted: int
    straight: int
    causes: collections.Counter
    measured: object

    def percent(self, count=None):
        return 100 * (self.complete if count is None else count) / len(self.way)

    def why(self):
        """As text: why the other paths stopped."""
        return ", ".join(f"{count} {cause}" for cause, count in self.causes.most_common()) or "none did"


def step(record, survey):
    """m, length of a transition."""
    return 0.02 if not survey.fixed_steps else 0.005 if record.quick else 0.001


def steps_words(record, survey):
    return f"{1000 * step(record, survey):g} mm, {'fixed' if survey.fixed_steps else 'adaptive'}"


def walked(record, survey, merely, iterations=None):
    """Measures a survey one node at a time, so that an interruption loses one at most. `iterations`: the most Newton
    iterations for merely converged paths, if different from the survey's default."""
    axes, nodes, directions = (("x",), 2, 6) if record.quick else (("x", "y"), 10, 26)
    each = 1 if record.quick else -(-record.random_paths // (len(axes) * nodes))
    words = [record.bench / "palpate_path_survey", organs.organ(survey.nodes).mesh, "--law", LAW_WORDS[survey.law], "--every-path",
             "--tool", survey.tool, "--radius", survey.radius, "--nodes", nodes, "--transition", step(record, survey)]
    steps = round(0.2 / step(record, survey))
    words += ["--random", each, "--steps", steps] if survey.kind == "random" else ["--directions", directions]
    words += (["--fixed-steps"] if survey.fixed_steps else []) + (["--merely-converged"] if merely else [])
    words += ["--iterations", iterations] if iterations else []
    name = f"paths of {survey.name()}, {steps_words(record, survey)}{', merely converged' if merely else ''}"
    name += f", {iterations} iterations" if iterations else ""
    parts = record.together([functools.partial(record.run, f"{name}, {axis} node {node + 1} of {nodes}",
                                               [*words, "--axis", axis, "--only-node", node]) for axis in axes for node in range(nodes)])
    command = record.shown([*words, "--axis", "|".join(axes), "--only-node", f"0..{nodes - 1}"])
    every = [path for part in parts for path in part.value["every_path"]]
    done = [path for path in every if "cause" not in path]
    return Reached(way=[path["reached_m"] for path in every], length=0.2 if survey.kind == "random" else 0.1, complete=len(done),
                   without_inverted=sum(path["smallest_det_F"] > 0 for path in done), straight=sum(path["detours"] == 0 for path in done),
                   causes=collections.Counter(path["cause"] for path in every if "cause" in path),
                   measured=Measured.of_all(parts, command))


def wilson(successes, trials, z=1.96):
    """Returns the 95 % interval of a share, % (Wilson 1927)."""
    share, spread = successes / trials, z * z / trials
    middle = (share + spread / 2) / (1 + spread)
    half = z / (1 + spread) * (share * (1 - share) / trials + spread / (4 * trials)) ** 0.5
    return 100 * max(0.0, middle - half), 100 * min(1.0, middle + half)


def interval(survey, reached):
    """As text: regular paths are complete, random ones are a sample."""
    return "{:.1f} to {:.1f}".format(*wilson(reached.complete, len(reached.way))) if survey.kind == "random" else "no sample"


SURVEY_COLUMNS = ["organ", "law", "tool", "paths", "steps", "number of paths", "published (%)", "merely converged (%)",
                  "95 % interval, merely converged (%)", "merely converged, no element inverted (%)", "valid (%)",
                  "95 % interval, valid (%)", "valid, straight (%)", "why the others stopped, merely converged",
                  "why the others stopped, valid"]


def what_is_surveyed(record, survey):
    """Returns the first columns."""
    return [organs.organ(survey.nodes).name, organs.LAWS[survey.law], survey.touch(), survey.kind, steps_words(record, survey)]


def is_the_papers(survey):
    return survey.nodes == 500 and survey.radius == 0


def survey_row(record, survey, merely, valid):
    comparable = survey.kind == "regular" and is_the_papers(survey)
    row = [*what_is_surveyed(record, survey), len(valid.way), published.CONVERGED[survey.law] if comparable else "-"]
    row += [merely.percent(), interval(survey, merely), merely.percent(merely.without_inverted)] if merely else [None] * 3
    row += [valid.percent(), interval(survey, valid), valid.percent(valid.straight), merely.why() if merely else None, valid.why()]
    for column, value in zip(SURVEY_COLUMNS, row):
        reached = merely if "merely" in column else valid
        if isinstance(value, float) or column == "number of paths":
            name = f"{survey.name()}, {steps_words(record, survey)}/{column.removesuffix(' (%)')}"
            record.number(name, value, "%" if column.endswith("(%)") else "", reached.measured)
    return row


def survival(record, survey, reached, counted):
    """How many paths reach which length: rows of SURVIVAL_COLUMNS."""
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


def how_far(record):
    """Sec. 6.1: how many paths reach their end, merely converged and valid, by law and steps."""
    rows, curves, failed, whole = [], [], [], True
    for one in surveys(record):
        try:
            merely = walked(record, one, True) if one.merely else None
            valid = walked(record, one, False)
        except (Incomplete, NotMeasured) as why:  # a failed survey does not affect others
            record.not_measured(f"{one.name()}, {steps_words(record, one)}", str(why))
            failed += [one.name()] if isinstance(why, Incomplete) else []
            start = what_is_surveyed(record, one)
            rows.append([*start, *[None] * (len(SURVEY_COLUMNS) - len(start))])
            whole = whole and not is_the_papers(one)
            continue
        rows.append(survey_row(record, one, merely, valid))
        if is_the_papers(one):
            curves += survival(record, one, merely, "merely converged") + survival(record, one, valid, "valid")
    figure.save_table(record, "paths", SURVEY_COLUMNS, rows)
    if curves and whole:
        figure.save_figure(record, "paths-way", SURVIVAL_COLUMNS, curves, draw_survival(curves), size=(11, 4.4))
    missing = [] if whole else ["paths-way: not all of the paper's surveys are measured"]
    if missing or failed:
        raise Incomplete("; ".join([*missing, *(f"failed: {name}" for name in failed)]))


LIMITS = (20, 50)
LIMIT_COLUMNS = ["organ", "law", "paths", "steps", "published (%)", "Newton iterations at most", "number of paths", "merely converged (%)",
                 "merely converged, no element inverted (%)", "why the others stopped"]


def limits(record):
    """Sec. 6.1: how the share of merely converged paths depends on the allowed Newton iterations."""
    asked = [(Survey(record.nodes[0], law, fixed_steps=fixed), limit) for law in record.laws for fixed in (True, False) for limit in LIMITS]
    figure.save_table(record, "limits", LIMIT_COLUMNS, [limited(record, one, limit) for one, limit in asked])


def limited(record, one, limit):
    """Returns a row of LIMIT_COLUMNS."""
    organ, law, _, kind, steps = what_is_surveyed(record, one)
    row = [organ, law, kind, steps, published.CONVERGED[one.law] if is_the_papers(one) else "-", limit]
    name = f"{one.name()}, {steps}, {limit} iterations"
    try:
        reached = walked(record, one, True, limit)
    except NotMeasured as why:
        record.not_measured(name, str(why))
        return [*row, *[None] * (len(LIMIT_COLUMNS) - len(row))]
    row += [len(reached.way), reached.percent(), reached.percent(reached.without_inverted), reached.why()]
    record.row(name, LIMIT_COLUMNS[7:9], row[7:9], [reached.measured] * 2)
    return row
