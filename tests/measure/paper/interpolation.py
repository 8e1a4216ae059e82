"""Figs. 8 and 9 of the paper: error of interpolated forces by method and lattice, including this project's method.

Errors are of the force vector, so that they do not divide by zero components (as Eqs. 13 and 14 do): absolute |f' - f| in
N, relative by max(|f|, references.FLOOR). A place is covered by tri-linear interpolation if the 8 corners of its cell are
in the ball and solved, by tri-cubic if the 64 points around it are, by radial functions always. For a place in a plane of
the lattice, points with zero weight are not needed."""
import dataclasses
import pathlib

import figure
import organs
import published
import references
from record import NotMeasured, content, needed

PAPERS = ["trilinear", "tricubic", "rbf-linear", "rbf-cubic"]
OURS = ["potential"]
LARGEST_RBF = 5000  # largest number of points for which the client makes radial functions; SciPy is used beyond it
LABELS = {"trilinear": "tri-linear", "tricubic": "tri-cubic", "rbf-linear": "RBF r", "rbf-cubic": "RBF r³", "potential": "potential"}


@dataclasses.dataclass(frozen=True)
class Case:
    nodes: int  # approximate number
    law: str

    def organ(self):
        return organs.organ(self.nodes)

    def name(self):
        return f"{self.organ().name}-{self.law}"


def cases(record):
    """The paper's two laws that converge in the whole ball."""
    laws = [law for law in ("mr", "msvk") if law in record.laws]
    return [Case(nodes, law) for nodes in record.nodes for law in (laws[:1] if record.quick else laws)]


def lattices(record):
    return (3, 5) if record.quick else tuple(organs.LATTICES)


def built(record, case, divisions):
    """Builds the dataset of one lattice in the ball of 100 mm."""
    return record.dataset(f"{case.name()}-n{divisions}", organs.scene(case.organ(), case.law, divisions=divisions))


def exact(record, case, kind):
    scene = organs.scene(case.organ(), case.law, divisions=5)
    step = 0.005 if record.quick else 0.001
    paths = (references.regular_paths(step=step) if kind == "regular" else
             references.random_paths(2 if record.quick else 40, steps=round(0.2 / step), step=step))
    return references.solved_along(record, f"{case.name()}-{kind}", scene, paths)


# Answers of the methods

def answers(record, name, dataset, methods, displacements):
    """Returns {method: {force (n x 3, N), query_ns, prepare_s}} by the force fields of the client, and the measurement."""
    text = "".join("%.17g %.17g %.17g\n" % tuple(p) for p in displacements)
    command = [record.bench / "palpate_force_query_bench", dataset, "tip", *methods]
    measured = record.run(f"forces of {name}", command, text)
    return {method: measured.value["methods"][method] for method in methods}, measured


def radial_by_scipy(record, name, dataset, method, displacements):
    """The paper's Eq. 12 without a polynomial, dense, for lattices that the client refuses. Takes hours and gigabytes."""
    numpy, h5py = needed("numpy"), needed("h5py")
    needed("scipy")
    import scipy.linalg
    from scipy.spatial.distance import cdist

    def make():
        with h5py.File(dataset) as file:
            solved = numpy.isin(file["points/tag"][:], (1, 2))
            places, forces = file["points/position"][:][solved], file["points/force"][:][solved]
        power = {"rbf-linear": 1, "rbf-cubic": 3}[method]
        scale = numpy.abs(places).max()
        weights = scipy.linalg.solve(cdist(places / scale, places / scale) ** power, forces, assume_a="sym", overwrite_a=True)
        at = numpy.array(displacements) / scale
        force = numpy.concatenate([cdist(part, places / scale) ** power @ weights for part in numpy.array_split(at, 1 + len(at) // 500)])
        return {"force": force.tolist(), "query_ns": None, "prepare_s": None}

    return record.measure(f"{method} of {name} by SciPy", make, content(pathlib.Path(dataset)), displacements,
                          command=f"tests/measure/paper/run {record.target}")


def all_answers(record, name, dataset, displacements):
    """({method: its answers}, {method: their sources})"""
    solved = dataset.value["points"]["expandable"] + dataset.value["points"]["terminating"]
    radial = [method for method in PAPERS if method.startswith("rbf")]
    few = solved <= LARGEST_RBF
    methods = [method for method in PAPERS + OURS if few or method not in radial]
    given, measured = answers(record, name, dataset.value["dataset"], methods, displacements)
    sources = dict.fromkeys(methods, measured)
    if not few:
        for method in radial:
            sources[method] = radial_by_scipy(record, name, dataset.value["dataset"], method, displacements)
            given[method] = sources[method].value
    return given, sources


# Places that the paper's methods cover

def covered(dataset, displacements):
    """{method: n booleans}: whether all points with a weight in the paper's method are solved."""
    numpy, h5py = needed("numpy"), needed("h5py")
    with h5py.File(dataset) as file:
        solved = numpy.isin(file["points/tag"][:], (1, 2)) & (file["points/ijk"][:] % round(file["points"].attrs["divisions"]) == 0).all(1)
        ijk = file["points/ijk"][:][solved] // round(file["points"].attrs["divisions"])
        spacing = file["points"].attrs["spacing"]
    reach = int(numpy.abs(ijk).max()) + 3
    there = numpy.zeros((2 * reach + 1,) * 3, dtype=bool)
    there[tuple((ijk + reach).T)] = True
    at = numpy.array(displacements) / spacing
    in_plane = numpy.abs(at - numpy.round(at)) < 1e-9  # for each axis: only the points of that plane have a weight
    lowest = numpy.where(in_plane, numpy.round(at), numpy.floor(at)).astype(int) + reach
    lowest = numpy.clip(lowest, 1, 2 * reach - 2)

    def all_of(offsets):
        cube = [numpy.array((i, j, k)) for i in offsets for j in offsets for k in offsets]
        return numpy.all([there[tuple((lowest + corner).T)] | (in_plane & (corner != 0)).any(1) for corner in cube], axis=0)

    eight, all64 = all_of((0, 1)), all_of((-1, 0, 1, 2))
    everywhere = numpy.ones(len(lowest), dtype=bool)
    return {"trilinear": eight, "tricubic": all64, **{method: everywhere for method in PAPERS + OURS if method not in ("trilinear", "tricubic")}}


COLUMNS = ["organ", "law", "configurations", "method", "places wanted", "places solved", "covered (%)", "mean error (N)", "largest error (N)",
           "mean relative error (%)", "largest relative error (%)", "mean error, covered (N)", "largest error, covered (N)",
           "mean relative error, covered (%)", "largest relative error, covered (%)", "median relative error (%)",
           "places after a detour"]


def errors(record, kind):
    """A row of COLUMNS for each completely measured case, lattice and method; the others are named."""
    return [row for case in cases(record) for row in whole(record, f"{case.name()}, {kind} paths", lambda: errors_of(record, case, kind))]


def whole(record, name, rows):
    """rows(), or none if a part of them is missing: figures and comparisons never lack a lattice."""
    try:
        return rows()
    except NotMeasured as why:
        record.not_measured(name, str(why))
        return []


def errors_of(record, case, kind):
    numpy = needed("numpy")
    rows = []
    truth = exact(record, case, kind)
    force = numpy.array(truth.force)
    length = numpy.maximum(numpy.linalg.norm(force, axis=1), references.FLOOR)
    for divisions in lattices(record):
        dataset = built(record, case, divisions)
        given, sources = all_answers(record, f"{case.name()} n{divisions} {kind}", dataset, truth.displacement)
        inside = covered(dataset.value["dataset"], truth.displacement)
        for method in PAPERS + OURS:
            error = numpy.linalg.norm(numpy.array(given[method]["force"]) - force, axis=1)
            measures = [error.mean(), error.max(), 100 * (error / length).mean(), 100 * (error / length).max()]
            part = inside[method]
            few = [None] * 4 if not part.any() else [error[part].mean(), error[part].max(), 100 * (error / length)[part].mean(),
                                                     100 * (error / length)[part].max()]
            row = [case.organ().name, organs.LAWS[case.law], dataset.value["points"]["points"] - 1, method, truth.wanted, len(force),
                   100 * float(part.mean()), *map(float, measures), *(None if m is None else float(m) for m in few),
                   100 * float(numpy.median(error / length)), truth.after_detour]
            rows.append(row)
            record.row(f"{kind} paths, {case.name()}/{row[2]}/{method}", COLUMNS[4:], row[4:],
                       [truth.measured] * 2 + [sources[method]] * len(COLUMNS[6:-1]) + [truth.measured])
    return rows


def draw_errors(rows, kind):
    """Mean and largest relative error over configurations, one column for each organ and law."""
    groups = list(dict.fromkeys((row[0], row[1]) for row in rows))

    def draw(page):
        axes = page.subplots(2, len(groups), squeeze=False, sharex=True, sharey="row")
        for column, group in enumerate(groups):
            for line, (measure, label) in enumerate(((13, "mean"), (14, "largest"))):
                axis = axes[line][column]
                for n, method in enumerate(PAPERS + OURS):
                    points = [(row[2], row[measure]) for row in rows if (row[0], row[1]) == group and row[3] == method and row[measure] is not None]
                    axis.plot(*zip(*points) if points else ([], []), marker="o" if method in PAPERS else "s", markersize=4,
                              linestyle="-" if method in PAPERS else "--", label=LABELS[method], color=figure.COLORS[n])
                if label == "largest":
                    for (method, configurations), percent in published.LARGEST_ERROR.items():
                        axis.plot([configurations], [percent], marker="*", markersize=9, linestyle="", color=figure.COLORS[(PAPERS + OURS).index(method)],
                                  label=f"published, {LABELS[method]}")
                axis.set(xscale="log", yscale="log")
                if column == 0:
                    axis.set_ylabel(f"{label} relative error (%)")
            axes[0][column].set_title(f"{group[0]}, {group[1]}", fontsize=9)
            axes[1][column].set_xlabel("configurations")
        figure.legend_below(page, axes[1][0], lines=2 if len(groups) > 1 else 4)
        page.suptitle(f"Along {kind} paths, at covered places", fontsize=10)

    return draw


def figure_of(record, name, kind):
    rows = errors(record, kind)
    groups = len({(row[0], row[1]) for row in rows})
    figure.save_figure(record, name, COLUMNS, rows, draw_errors(rows, kind), size=(3.4 * groups + 1, 6), holes=True)


def figure8(record):
    """Errors of interpolated forces along regular paths: the paper's four methods on its lattices, and ours."""
    figure_of(record, "figure8", "regular")


def figure9(record):
    """Errors of interpolated forces along random paths."""
    figure_of(record, "figure9", "random")


def methods(record):
    """Every method by its cost: configurations, seconds of building, ns per query, bytes."""
    rows = [row for case in cases(record) for row in whole(record, f"{case.name()}, costs", lambda: costs_of(record, case))]
    groups = len({(row[0], row[1]) for row in rows})
    figure.save_figure(record, "methods", METHOD_COLUMNS, rows, draw_methods(rows), size=(10, 4.6 * groups + 0.6), holes=True)


def costs_of(record, case):
    rows = []
    by_key = {(row[2], row[3]): row for row in errors_of(record, case, "random")}
    truth = exact(record, case, "random")
    for divisions in lattices(record):
        dataset = built(record, case, divisions)
        given, sources = all_answers(record, f"{case.name()} n{divisions} random", dataset, truth.displacement)
        for method in PAPERS + OURS:
            row = by_key[(dataset.value["points"]["points"] - 1, method)]
            rows.append([row[0], row[1], method, row[2], dataset.value["seconds"], given[method]["query_ns"], dataset.value["bytes"] / 1e6,
                         row[7], row[9], row[8], row[15]])
            by, answered = dataset, sources[method]
            record.row(f"{case.name()}/{row[2]}/{method}", METHOD_COLUMNS[3:], rows[-1][3:], [by, by, answered, by, *[answered] * 4])
    return rows


METHOD_COLUMNS = ["organ", "law", "method", "configurations", "build (s)", "query (ns)", "dataset (MB)", "mean error (N)",
                  "mean relative error (%)", "largest error (N)", "median relative error (%)"]


def draw_methods(rows):
    """Mean error, which places behind folds dominate, and median error, against each cost."""
    groups = list(dict.fromkeys((row[0], row[1]) for row in rows))
    lines = [(group, error, label) for group in groups for error, label in ((7, "mean error (N)"), (10, "median relative error (%)"))]

    def draw(page):
        axes = page.subplots(len(lines), 4, squeeze=False, sharex="col", sharey="row")
        for axes_of_line, (group, error, label) in zip(axes, lines):
            for axis, cost in zip(axes_of_line, (3, 4, 5, 6)):
                for n, method in enumerate(PAPERS + OURS):
                    points = [(row[cost], row[error]) for row in rows if (row[0], row[1]) == group and row[2] == method and row[cost] is not None]
                    axis.plot(*zip(*points) if points else ([], []), marker="o" if method in PAPERS else "s", markersize=4, label=LABELS[method],
                              linestyle="" if cost == 5 else "-" if method in PAPERS else "--", color=figure.COLORS[n])
                axis.set(xscale="log", yscale="log")
            axes_of_line[0].set_ylabel(f"{group[0]}\n{group[1]}\n{label}")
        for axis, cost in zip(axes[-1], (3, 4, 5, 6)):
            axis.set_xlabel(METHOD_COLUMNS[cost])
        figure.legend_below(page, axes[0][0])

    return draw
