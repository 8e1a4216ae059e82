"""Fig. 7 of the paper: time and size of a configuration space, by lattice and row of Table 1.

Minutes by one and two workers here (quadratic elements only by local workers), and by up to 64 workers of the scheduler's
simulator, which repeats the recorded build: the same transitions with the durations recorded here (docs/internals/benchmarks.md).
The elements satisfy inf-sup, as by default; the paper's were of equal order."""
import pathlib

import figure
import newton_iteration
import organs
import published
from record import Incomplete, Measured, NotMeasured

SIMULATED = (2, 4, 8, 16, 32, 64)
WANTED_MINUTES = 8  # for all four lattices of the 500-node Mooney-Rivlin liver by two workers

COLUMNS = ["organ", "law", "elements", "configurations", "failed", "1 worker (min)", "2 workers (min)", "workers elsewhere (min)",
           "all solves (min)", *[f"{workers} workers, simulated (min)" for workers in SIMULATED], "longest chain (min)",
           "published, 64 cores (min)", "dataset (MB)", "with all nodes (MB)", "published (MB)"]


def cases(record):
    """Rows of Table 1, fastest first. The smallest set has no quadratic ones: 514 points take minutes."""
    rows = [row for row in newton_iteration.ROWS
            if row.nodes in record.nodes and row.law in record.laws and not (record.quick and row.order == 2)]
    return sorted(rows, key=lambda row: (row.order, row.nodes))


def lattices(record, row):
    return (5,) if record.quick and row.law == "mr" else (3,) if record.quick else tuple(organs.LATTICES)


def scene(row, divisions, **options):
    return organs.scene(row.organ(), row.law, divisions=divisions, **({} if row.order == 1 else row.stable()), **options)


def numbers_of_workers(record, row):
    """The numbers of workers for a lattice, each built once, that of Figs. 8 and 9 first; None: any workers. The
    quadratic row is built with these numbers only: it takes longest, and the sum of its solves gives the time of one
    worker."""
    return [None] if record.listen else [record.jobs, *({1, 2} - {record.jobs} if row.order == 1 else ())]


def built(record, row, divisions, workers):
    """With the number of workers given by -j this is the dataset of Figs. 8 and 9, under the same name."""
    name = f"{row.organ().name}-{row.law}{'-p2' if row.order == 2 else ''}-n{divisions}"
    same = record.listen or workers == record.jobs
    return record.dataset(name if same else f"{name}-j{workers}", scene(row, divisions), None if same else workers)


def wants_all_nodes(row, divisions):
    """True only for linear elements on the smallest lattice; sizes on larger lattices follow in proportion."""
    return row.order == 1 and divisions == min(organs.LATTICES)


def built_with_all_nodes(record, row, divisions):
    """Builds it again with the displacements of all nodes, as in the paper, for its size."""
    name = f"{row.organ().name}-{row.law}-n{divisions}-all-nodes"
    return record.dataset(name, scene(row, divisions, storage='displacement = "all"'))


def simulated(record, row, divisions, dataset):
    """Minutes of all solves; by simulated workers; of the longest chain of transitions that wait for each other."""
    state = pathlib.Path(dataset.value["dataset"] + ".state")
    if not state.is_dir():
        raise Incomplete(f"{state} is missing, but the simulator needs it; remove measurement and dataset of that build to repeat it")
    command = [record.bench / "palpate_speed_up_bench", state, "--workers", ",".join(map(str, SIMULATED))]
    measured = record.run(f"simulated workers, {row.name()}, n = {divisions}", command, depends=[dataset.value["seconds"]])
    seconds = [measured.value["work_s"], *[run["seconds"] for run in measured.value["rows"]], measured.value["longest_chain_s"]]
    return [s / 60 for s in seconds], measured


def measured_row(record, row, divisions):
    """A row of COLUMNS and its numbers; None if there was no time, "-" if not requested."""
    configurations = organs.LATTICES.get(divisions)  # without rest, as the paper counts
    start = [row.organ().name, organs.LAWS[row.law], newton_iteration.elements(row.stable(), row.law)]
    papers = published.BUILD_WORDS.get(configurations)
    with_all_nodes = None if wants_all_nodes(row, divisions) else "-"
    papers_size = published.DATASET_MB.get((row.published, configurations)) if row.order == 1 else None
    by = {}
    for workers in numbers_of_workers(record, row):
        try:
            by[workers] = built(record, row, divisions, workers)
        except NotMeasured as why:  # the dataset with another number of workers may exist
            record.not_measured(f"{row.name()}, {configurations}, {workers or 'any'} workers", str(why))
    if not by:
        return [*start, configurations, *[None] * (len(COLUMNS) - 8), papers, None, with_all_nodes, papers_size]
    dataset = next(iter(by.values()))
    try:
        many, simulator = simulated(record, row, divisions, dataset)
    except NotMeasured as why:
        record.not_measured(f"{row.name()}, {configurations}, simulated", str(why))
        many, simulator = [None] * (len(SIMULATED) + 2), None
    whole = None
    try:
        if wants_all_nodes(row, divisions):
            whole = built_with_all_nodes(record, row, divisions)
            with_all_nodes = whole.value["bytes"] / 1e6
    except NotMeasured as why:
        record.not_measured(f"{row.name()}, {configurations}, with all nodes", str(why))
    points = dataset.value["points"]
    minutes = [by[workers].value["seconds"] / 60 if workers in by else None for workers in (1, 2, None)]
    cells = [*start, points["points"] - 1, points["failed"], *minutes, *many, papers, dataset.value["bytes"] / 1e6, with_all_nodes,
             papers_size]
    sources = [None, None, None, dataset, dataset, by.get(1), by.get(2), by.get(None), *[simulator] * len(many), None, dataset, whole, None]
    record.row(f"{row.name()}, {points['points'] - 1}", COLUMNS, cells, sources)
    return cells


def draw(rows):
    groups = list(dict.fromkeys(tuple(row[:3]) for row in rows))

    def curve(axis, group, name, style, color, **options):
        column = COLUMNS.index(name)
        points = [(row[3], row[column]) for row in rows if tuple(row[:3]) == group and isinstance(row[column], float)]
        if points:
            axis.plot(*zip(*points), style, color=color, markersize=4, **options)

    def page(page):
        time, size, speed = page.subplots(1, 3)
        for n, group in enumerate(groups):
            color = figure.COLORS[n]
            curve(time, group, "2 workers (min)", "o-", color, label=f"{group[0]}, {group[1]}, {group[2]}")
            curve(time, group, "workers elsewhere (min)", "D-", color)
            curve(time, group, "1 worker (min)", "o:", color)
            curve(time, group, "64 workers, simulated (min)", "s--", color)
            curve(size, group, "dataset (MB)", "o-", color)
            curve(size, group, "with all nodes (MB)", "x", color)
            done = [row for row in rows if tuple(row[:3]) == group and row[COLUMNS.index("all solves (min)")] is not None]
            if done:
                work, *times = max(done, key=lambda row: row[3])[COLUMNS.index("all solves (min)"):][:len(SIMULATED) + 1]
                speed.plot(SIMULATED, [work / minutes for minutes in times], "s--", markersize=4, color=color)
        for label, style in (("1 worker", "o:"), ("2 workers", "o-"), ("64 workers, simulated", "s--")):
            time.plot([], [], style, color="black", markersize=4, label=label)
        time.plot([], [], "x", color="black", markersize=4, label="size with all nodes")
        for configurations, (least, most) in published.BUILD_MINUTES.items():
            label = "published, 64 cores" if configurations == min(published.BUILD_MINUTES) else None
            time.plot([configurations] * 2, [least, most], "*-", color="black", label=label)
            if published.BUILD_WORDS[configurations].startswith("less than"):
                time.plot([configurations], [least], "v", color="black")
        for (_, configurations), megabytes in published.DATASET_MB.items():
            size.plot([configurations], [megabytes], "*", color="black")
        speed.plot(SIMULATED, SIMULATED, color="black", linewidth=0.7)
        time.set(xscale="log", yscale="log", xlabel="configurations", ylabel="time (min)")
        size.set(xscale="log", yscale="log", xlabel="configurations", ylabel="dataset (MB)")
        speed.set(xscale="log", yscale="log", xlabel="simulated workers", ylabel="all solves / simulated time, largest lattice")
        figure.legend_below(page, time, lines=4)

    return page


def wanted(record):
    """The number of the specification: all four lattices of the 500-node Mooney-Rivlin liver by two workers."""
    row = next((row for row in cases(record) if (row.law, row.order, row.nodes) == ("mr", 1, 500)), None)
    if record.quick or row is None or record.listen:
        return
    try:
        by = [built(record, row, divisions, 2) for divisions in lattices(record, row)]
    except NotMeasured:
        return  # the rows give the reason
    record.number(f"{row.name()}, all {len(by)} lattices, 2 workers (wanted: at most {WANTED_MINUTES} min)",
                  sum(dataset.value["seconds"] for dataset in by) / 60, "min", Measured.of_all(by))


def save_table(record, rows):
    """Leaves out columns of workers that were not requested; numbers that the paper does not give are not missing
    measurements."""
    unasked = ("1 worker (min)", "2 workers (min)") if record.listen else ("workers elsewhere (min)",)
    kept = [n for n, column in enumerate(COLUMNS) if column not in unasked]
    shown = lambda row, n: "-" if row[n] is None and COLUMNS[n].startswith("published") else row[n]
    figure.save_table(record, "figure7-table", [COLUMNS[n] for n in kept], [[shown(row, n) for n in kept] for row in rows])


def figure7(record):
    """Fig. 7: time and size of configuration spaces by lattice, by one, two and 64 workers, beside the published ones."""
    wanted(record)
    every = [(row, divisions) for row in cases(record) for divisions in lattices(record, row)]
    every.sort(key=lambda one: (one[0].order, one[1]))  # quadratic ones take hours; small lattices of all rows first
    rows = [measured_row(record, row, divisions) for row, divisions in every]
    save_table(record, rows)
    figure.save_figure(record, "figure7", COLUMNS, rows, draw(rows), size=(11, 4.6), holes=True)
