"""How others answer, on the same organ: the table and figures of all peers.

Every peer is given the solved lattice points of one dataset and is asked for the forces at its probes, exact solutions at random
places of the ball that nobody was given. Times of Python peers are processor time of one core; what was built by several
workers counts as their seconds together."""
import dataclasses
import resource
import time

import figure
import organs
import published
import references
from record import Incomplete, NotMeasured, needed

COLUMNS = ["organ", "tool", "method", "configurations", "before the touch (s)", "memory, force (MB)", "memory, shape too (MB)", "answer (us)",
           "answer without one before (us)", "in", "mean error (N)", "median (N)", "95 % (N)", "largest error (N)", "95 % relative (%)", "not answered", "conservative"]
OURS = {"trilinear": ("tri-linear (paper)", "no"), "rbf-linear": ("RBF r (paper)", "no"), "rbf-cubic": ("RBF r³ (paper)", "no"),
        "potential": ("potential (this project)", "yes")}


PUBLISHED = {
    "learned livers": ("mean error of the shape below 1 mm, within 3 mm at 99.96 % (one force) and 99.84 % (two forces) of the nodes; more than 100 Hz; "
                       "no error of a force", "Pellicer-Valero et al., Expert Systems with Applications 143 (2020) 113083"),
}


@dataclasses.dataclass(frozen=True)
class Case:
    """radius and divisions of the ball, patch of the tool (m): the first is what peers were made with, others nobody tuned for."""
    nodes: int
    patch: float
    radius: float
    divisions: int
    probes: int

    def organ(self):
        return organs.organ(self.nodes)

    def name(self):
        return f"{self.organ().name}-" + (f"patch-{1000 * self.patch:g}mm" if self.patch else "node")

    def tool(self):
        return f"patch, {1000 * self.patch:g} mm" if self.patch else "single node"

    def scene(self):
        return organs.scene(self.organ(), "mr", radius=self.radius, divisions=self.divisions, patch=self.patch, name=f"peers-{self.name()}",
                            accuracy=f"probes = {self.probes}", storage='displacement = "all"')


@dataclasses.dataclass
class Setting:
    """A case, and what all peers of it read."""
    case: Case
    dataset: object         # record.Measured of its build
    configurations: object
    body: object
    build_s: float          # of all workers together
    path: list              # displacements of a hand, 1 mm apart, from rest
    fine: list              # likewise, 0.25 mm apart

    def key(self):
        return [self.configurations.identity]

    def row(self, method, value, errors, configurations=None, conservative="yes", language="Python"):
        """A row of COLUMNS; value: before_s (on top of the build), force_bytes, shape_bytes, answer_s, cold_s, any of them None."""
        count = len(self.configurations.place) if configurations is None else configurations
        of = lambda name, factor: None if value.get(name) is None else factor * value[name]
        before = None if value.get("before_s") is None else value["before_s"] + (self.build_s if count > 1 else 0)
        return [self.case.organ().name, self.case.tool(), method, count, before, of("force_bytes", 1e-6), of("shape_bytes", 1e-6), of("answer_s", 1e6),
                of("cold_s", 1e6), language, errors["mean"], errors["median"], errors["p95"], errors["worst"],
                None if errors["relative_p95"] is None else 100 * errors["relative_p95"], errors["unanswered"], conservative]


def cases(record):
    if record.quick:
        return [Case(500, 0.0, 0.06, 3, 20)]
    return [Case(2000, 0.0, 0.06, 4, 100), Case(2000, 0.02, 0.06, 4, 100)]


def setting(record, case):
    from peers import configurations
    made, build_s = built(record, case)
    read = configurations.read(made.value["dataset"])
    if read.unsolved or read.probes_unsolved:
        record.say(f"    {case.name()}: {read.unsolved} lattice points and {read.probes_unsolved} probes have no equilibrium, and are left out")
    if not len(read.probe_place):
        raise Incomplete(f"{case.name()}: no probe converged, there is nothing to hold answers against")
    hand = lambda steps, step: references.random_paths(1, radius=0.9 * case.radius, steps=steps, step=step, seed=48)[0]
    return Setting(case, made, read, read.body(configurations.mooney_rivlin()), build_s,
                   hand(20 if record.quick else 120, 0.001), hand(40 if record.quick else 160, 0.00025))


def built(record, case):
    """(the dataset, s of processor of its build, of all workers together; where parts of it were built earlier, the time on the wall
    of as many workers)."""
    began, used = time.monotonic(), processor_of_children()
    made = record.dataset(f"peers-{case.name()}", case.scene())
    measured = record.measure(f"{case.name()} processor time of the build",
                              lambda: processor_of_children() - used if time.monotonic() - began >= 0.98 * made.value["seconds"] else
                              made.value["seconds"] * made.value["jobs"], case.scene(), made.at, command=made.command)
    return made, measured.value


def processor_of_children():
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def agreement(record, given):
    """How far the dataset's configurations are from equilibrium, and their forces from the body's, in NumPy: N."""
    import numpy

    def make():
        read, worst = given.configurations, {"residual": 0.0, "force": 0.0}
        for displacement, pressure, place, force in zip(read.displacement, read.pressure, read.place, read.force):
            here = given.body.assemble(given.body.state(displacement, pressure), place, tangent=False)
            worst["residual"] = max(worst["residual"], float(numpy.abs(here.residual).max()))
            worst["force"] = max(worst["force"], float(numpy.linalg.norm(here.force - force)))
        return worst

    measured = record.measure(f"{given.case.name()} dataset and body", make, *given.key(), command="tests/paper/run peers")
    for name, value in measured.value.items():
        record.number(f"{given.case.name()}/largest {name} of a configuration, in NumPy", value, "N", measured)
    if measured.value["force"] > 1e-3:
        raise Incomplete(f"{given.case.name()}: the body in NumPy answers {measured.value['force']:.3g} N beside the dataset: they are not the same body")


def errors_of(given, forces):
    import numpy
    from peers import configurations
    answered = [[numpy.nan] * 3 if force is None else force for force in forces]
    return configurations.errors(numpy.array(answered, float), given.configurations.probe_force)


def timed(work):
    """(what it returns, s of processor)"""
    began = time.process_time()
    return work(), time.process_time() - began


# Interpolations

def interpolations(record, given):
    """The paper's and ours, by the force fields of the client, which are C++."""
    text = "".join("%.17g %.17g %.17g\n" % tuple(p) for p in given.configurations.probe_place)
    command = [record.bench / "palpate_force_query_bench", given.dataset.value["dataset"], "tip", *OURS]
    measured = record.run(f"{given.case.name()} forces of interpolations", command, text, depends=given.key())
    count = len(given.configurations.place)
    for method, (label, conservative) in OURS.items():
        value = measured.value["methods"][method]
        kept = {"trilinear": 3, "potential": 13}.get(method, 6) * 8 * count  # forces; energy, force, stiffness; places and weights
        shape = kept + given.configurations.displacement.nbytes
        yield given.row(label, {"before_s": value["prepare_s"], "force_bytes": kept, "shape_bytes": shape, "answer_s": 1e-9 * value["query_ns"],
                                "cold_s": 1e-9 * value["query_ns"]}, errors_of(given, value["force"]), conservative=conservative, language="C++"), measured


# Linear bodies

def compliance(record, given):
    """What a linear simulator answers: the stiffness at rest."""
    import numpy
    from peers import body
    rest = given.configurations.stiffness[0]

    def make():
        made, seconds = timed(lambda: body.sensitivity(given.body.assemble(numpy.zeros(given.body.size), numpy.zeros(3))))
        repeats = 10000
        p = given.configurations.probe_place[0]
        _, answer = timed(lambda: [rest @ p for _ in range(repeats)])
        return {"before_s": seconds, "force_bytes": rest.nbytes, "shape_bytes": made.nbytes, "answer_s": answer / repeats, "cold_s": answer / repeats,
                "force": (given.configurations.probe_place @ rest.T).tolist()}

    measured = record.measure(f"{given.case.name()} linear compliance", make, *given.key(), command="tests/paper/run peers")
    yield given.row("linear compliance at rest", measured.value, errors_of(given, measured.value["force"]), 1), measured


def corotated(record, given):
    """Linear elements in the frame of each one's rotation, in equilibrium to 1e-4."""
    import numpy
    from peers import body, equilibrium, laws

    def make():
        model = equilibrium.Whole(given.configurations.body(laws.Corotated(given.body.law.shear_modulus)), body.Factors, 1e-4)
        steps = [s for s in seconds_along(model, model.at_rest(), given.path[:10]) if s is not None]
        found = chained(model, given.configurations.probe_place)
        factors = model.factors(model.assemble(numpy.zeros(given.body.size), numpy.zeros(3)))
        size = 12 * (factors.factors.L.nnz + factors.factors.U.nnz)
        return {"before_s": 0.0, "force_bytes": size, "shape_bytes": size, "answer_s": median(steps), "cold_s": None,
                "force": [one and one.force.tolist() for one in found]}

    measured = record.measure(f"{given.case.name()} co-rotated", make, *given.key(), len(given.path), command="tests/paper/run peers")
    yield given.row("co-rotated linear, in equilibrium", measured.value, errors_of(given, measured.value["force"]), 0), measured


def median(values):
    import numpy
    return float(numpy.median(values)) if values else None


def chained(model, places):
    """Equilibria at places, each from the nearest that is there already; None where there is none."""
    import numpy
    reached, found = [model.at_rest()], [None] * len(places)
    left = set(range(len(places)))
    while left:
        at = numpy.array([one.p for one in reached])
        distance = {n: numpy.linalg.norm(at - places[n], axis=1) for n in left}
        n = min(left, key=lambda m: distance[m].min())
        left.remove(n)
        from peers import equilibrium
        found[n] = equilibrium.transition(model, reached[int(distance[n].argmin())], places[n])
        if found[n] is not None:
            reached.append(found[n])
    return found


def seconds_along(model, start, path):
    """Of each answer on a hand's path, from the one before; None where there was none, and then from the last there was."""
    from peers import equilibrium
    at, seconds = start, []
    for p in path:
        reached, took = timed(lambda: equilibrium.transition(model, at, p))
        seconds.append(None if reached is None else took)
        at = reached or at
    return seconds


# Reduced models

def modes(record):
    return [5, 10] if record.quick else [10, 20, 40, 60]


def sampled_models(record):
    """(modes, tolerance of the weights)"""
    return [(10, 1e-2)] if record.quick else [(10, 1e-2), (20, 1e-2), (20, 1e-3), (40, 1e-3)]


def reduced_models(record, given):
    """POD and Galerkin with all elements, and with a few (ECSW)."""
    import numpy
    from peers import equilibrium, reduced, sampled
    made, making_s = None, None
    built = {}

    def base(count):
        nonlocal made, making_s
        if made is None:
            made, making_s = timed(lambda: reduced.snapshots(given.body, given.configurations))
        if count not in built:
            built[count] = timed(lambda: reduced.Reduced(given.body, made, count))
        return built[count]

    def answers(model, before):
        rest = model.at_rest()
        found, took = zip(*(timed(lambda p=p: reduced.answer(model, p, rest)) for p in given.configurations.probe_place))
        steps = seconds_along(model, rest, given.path)
        shape = given.body.size * 8 * (model.size + 3)
        return {"before_s": before, "force_bytes": model.memory(), "shape_bytes": max(shape, model.memory()), "answer_s": median([s for s in steps if s is not None]),
                "cold_s": median(list(took)), "force": [one and one.force.tolist() for one in found], "unknowns": model.size,
                "stuck_on_the_path": sum(s is None for s in steps), "steps": len(steps)}

    for count in modes(record):
        def whole(count=count):
            model, seconds = base(count)
            return answers(model, making_s + seconds)

        measured = record.measure(f"{given.case.name()} POD {count}", whole, *given.key(), len(given.path), command="tests/paper/run peers")
        yield given.row(f"POD {count} ({measured.value['unknowns']} unknowns), all elements", measured.value, errors_of(given, measured.value["force"])), measured
    for count, tolerance in sampled_models(record):
        def few(count=count, tolerance=tolerance):
            model, seconds = base(count)
            made = sampled.Sampled(model, tolerance, states=20 if record.quick else 60)
            by_newton = answers(made, making_s + seconds + made.seconds)
            rest = made.at_rest()
            forces = [reduced.followed(made, p, rest) for p in given.configurations.probe_place]
            follower = equilibrium.Follower(made, rest)
            steps = [took for force, took in (timed(lambda p=p: follower.answer(numpy.array(p))) for p in given.path) if force is not None]
            return {**by_newton, "elements": len(made.elements), "misfit": made.misfit, "answer_s": median(steps), "by_newton_s": by_newton["answer_s"],
                    "slowest_s": max(steps), "tangents_on_the_path": follower.tangents, "force": [None if f is None else f.tolist() for f in forces]}

        measured = record.measure(f"{given.case.name()} POD {count} of elements to {tolerance:g}", few, *given.key(), len(given.path),
                                  command="tests/paper/run peers")
        label = f"POD {count}, {measured.value['elements']} elements (ECSW, {tolerance:g})"
        for what, unit in ("by_newton_s", "s"), ("slowest_s", "s"), ("misfit", ""), ("tangents_on_the_path", ""), ("unknowns", ""):
            record.number(f"{given.case.name()}/{label}/{what}", measured.value[what], unit, measured)
        yield given.row(label, measured.value, errors_of(given, measured.value["force"])), measured


# Networks

def networks(record, given):
    """The best of a search for each kind."""
    from peers import network
    efforts = {"force": (3, 200, 1, 600, 100, 1, 12) if record.quick else (30, 600, 4, 5000, 1000, 3, 90),
               "energy": (3, 200, 1, 600, 100, 1, 12) if record.quick else (30, 600, 4, 5000, 1000, 3, 150),
               "energy and stiffness": (1, 100, 1, 300, 100, 1, 12) if record.quick else (4, 300, 2, 3000, 1000, 2, 300)}
    shortlist = None
    for kind in network.KINDS:
        effort = network.Effort(*efforts[kind])

        def trained(kind=kind, effort=effort, shortlist=shortlist):
            (model, told), seconds = timed(lambda: network.search(kind, given.configurations, effort, shortlist, record.say))
            exported = network.Exported(model)
            places = given.configurations.probe_place
            _, one_by_one = timed(lambda: [exported.force(p) for _ in range(20) for p in places])
            batch = places[[n % len(places) for n in range(1000)]]
            _, together = timed(lambda: [exported.force(batch) for _ in range(5)])
            return {**told, "before_s": seconds, "force_bytes": exported.memory(), "shape_bytes": None, "answer_s": one_by_one / (20 * len(places)),
                    "cold_s": one_by_one / (20 * len(places)), "batch_s": together / 5000, "parameters": exported.parameters(),
                    "force": exported.force(places).tolist()}

        measured = record.measure(f"{given.case.name()} network, {kind}", trained, *given.key(), effort, shortlist, command="tests/paper/run peers")
        for what, unit in ("batch_s", "s"), ("held_back_error", "N"), ("training_error", "N"), ("tried", ""), ("parameters", ""):
            record.number(f"{given.case.name()}/network: {kind}/{what}", measured.value[what], unit, measured)
        if kind == "energy":  # what fits an energy well is tried first where its stiffness is fitted too, which takes five times as long
            shortlist = measured.value["shortlist"]
        yield given.row(f"network: {kind} ({measured.value['settings'].split(',')[0]})", measured.value, errors_of(given, measured.value["force"]),
                        conservative="no" if kind == "force" else "yes"), measured


# Newton in the loop

def scene_file(record, case):
    path = record.folder / "scenes" / f"peers-{case.name()}.toml"
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(case.scene(), encoding="utf-8")
    return path


def newton(record, given):
    """(rows of loop.COLUMNS, rows of loop.TWO_RATES, rows of COLUMNS with what they were measured by)."""
    from peers import loop
    count, name, scene = 3 if record.quick else 6, given.case.name(), scene_file(record, given.case)
    found, by_worker = loop.by_worker(record, name, scene, given.configurations, count)
    along = loop.exact_along(record, name, scene, given.body, given.fine)
    exact = along.value
    record.number(f"{name}/largest difference of worker and NumPy on a path", exact["largest_difference"], "N", along)
    none = {"mean": 0.0, "median": 0.0, "p95": 0.0, "worst": 0.0, "relative_p95": 0.0, "unanswered": 0}
    in_time, rates, main = [], [], []

    def add(solver, rows, times, measured):
        in_time.extend(rows)
        rates.extend(loop.two_rates(solver, loop.seconds_by_way(times), exact["place"], exact["force"], exact["stiffness"]))
        main.append((given.row(f"full Newton, {solver} (1 mm)", {"before_s": 0.0, "answer_s": median(times[0.001])}, none, 0, language="C++"), measured))

    add("this project's worker", loop.worker_rows(found, given.configurations, count), loop.worker_times(found), by_worker)
    try:
        histories, measured = loop.by_getfem(record, name, given.configurations, given.body, count)
    except NotMeasured as why:
        record.not_measured(f"{name}/GetFEM", str(why))
        in_time.append(["GetFEM"] + [None] * (len(loop.COLUMNS) - 1))
        return in_time, rates, main
    record.number(f"{name}/GetFEM/largest difference of the force at {count} configurations", measured.value["largest_difference_N"], "N", measured)
    add("GetFEM", loop.getfem_rows(histories, found, given.configurations, count), loop.getfem_times(histories), measured)
    return in_time, rates, main


# The page

def peers(record):
    """What others would answer at the same places: linear bodies, reduced models, networks, Newton in the loop; and we."""
    needed("numpy"), needed("scipy"), needed("h5py")
    from peers import loop
    rows, loops, rates, distributions = [], [], [], []
    for case in cases(record):
        given = setting(record, case)
        record.say(f"    {case.name()}: {len(given.configurations.place)} configurations, {len(given.configurations.probe_place)} probes")
        agreement(record, given)
        for part in interpolations, compliance, reduced_models, networks, corotated:
            try:
                for row, measured in part(record, given):
                    rows.append(row)
                    told(record, case, row, measured)
                    distributions += lengths_of(given, row[2], measured)
            except NotMeasured as why:
                record.not_measured(f"{case.name()}/{part.__name__}", str(why))
                rows.append([case.organ().name, case.tool(), part.__name__] + [None] * (len(COLUMNS) - 3))
        in_time, at_two_rates, main = newton(record, given)
        loops += [[case.organ().name, case.tool(), *row] for row in in_time]
        rates += [[case.organ().name, case.tool(), *row] for row in at_two_rates]
        for row, measured in main:
            rows.append(row)
            told(record, case, row, measured)
    figure.save_table(record, "peers", COLUMNS, rows)
    figure.save_table(record, "peers-newton", ["organ", "tool", *loop.COLUMNS], loops)
    figure.save_table(record, "peers-two-rates", ["organ", "tool", *loop.TWO_RATES], rates)
    figure.save_table(record, "peers-published", ["method", "what is published", "source"],
                      [[name, *said] for name, said in {**published.OTHERS, **PUBLISHED}.items()])
    figure.save_figure(record, "peers-speed", COLUMNS, rows, draw_speed(rows), size=(4.6 * len(cases(record)) + 3, 5.2), holes=True)
    figure.save_figure(record, "peers-errors", ["organ", "tool", "method", "error (N)"], distributions, draw_distributions(distributions),
                       size=(4.6 * len(cases(record)) + 3, 5.2))


def told(record, case, row, measured):
    record.say(f"    {row[2]:44} " + " ".join(f"{value:.3g}" if isinstance(value, float) else str(value) for value in row[3:]))
    for column, value in zip(COLUMNS[3:-1], row[3:-1]):
        if value is not None and column != "in":
            name, unit = column.rsplit(" (", 1) if column.endswith(")") else (column, "")
            record.number(f"{case.name()}/{row[2]}/{name}", value, unit.rstrip(")"), measured)


def lengths_of(given, method, measured):
    """[organ, tool, method, error] of each answered probe."""
    import numpy
    forces = measured.value.get("force")
    if forces is None:  # of interpolations
        key = next(key for key, (label, _) in OURS.items() if label == method)
        forces = measured.value["methods"][key]["force"]
    return [[given.case.organ().name, given.case.tool(), method, float(numpy.linalg.norm(numpy.subtract(force, exact)))]
            for force, exact in zip(forces, given.configurations.probe_force) if force is not None]


FAMILIES = {"linear": 5, "co-rotated": 5, "POD": 0, "network": 3, "tri-linear": 4, "RBF": 4, "potential": 2, "full Newton": 6}


def look(method):
    family = next(family for family in FAMILIES if method.startswith(family))
    return {"color": figure.COLORS[FAMILIES[family]], "marker": "s" if "ECSW" in method else "^" if family == "network" else "*" if family == "potential" else "o"}


def groups_of(rows):
    return list(dict.fromkeys((row[0], row[1]) for row in rows))


def draw_speed(rows):
    """Mean error over the time of an answer. What is exact, and what was not measured, has no place in it."""
    def draw(page):
        axes = page.subplots(1, len(groups_of(rows)), squeeze=False, sharey=True)[0]
        for axis, group in zip(axes, groups_of(rows)):
            shown = [row for row in rows if (row[0], row[1]) == group and row[7] is not None and row[10]]
            for row in shown:
                axis.plot([row[7]], [row[10]], linestyle="", markersize=7, **look(row[2]))
                axis.annotate(row[2].replace(" (paper)", "").replace(" (this project)", ""), (row[7], row[10]), textcoords="offset points", xytext=(5, 3), fontsize=6)
            for row in rows:
                if (row[0], row[1]) == group and row[2].startswith("full Newton") and row[7] is not None:
                    axis.axvline(row[7], color="black", linewidth=0.8, linestyle=":" if "GetFEM" in row[2] else "--")
                    axis.text(row[7], 0.02, row[2], rotation=90, fontsize=6, transform=axis.get_xaxis_transform(), ha="right", va="bottom")
            axis.axvline(1000, color="grey", linewidth=0.6)
            axis.set(xscale="log", yscale="log", xlabel="time of an answer, one core (us)", title=f"{group[0]}, {group[1]}")
        axes[0].set_ylabel("mean error at the probes (N)")

    return draw


def draw_distributions(points):
    """The share of the probes whose error is larger than so much."""
    def draw(page):
        groups = groups_of(points)
        axes = page.subplots(1, len(groups), squeeze=False, sharey=True)[0]
        for axis, group in zip(axes, groups):
            seen = {}
            for method in dict.fromkeys(row[2] for row in points if (row[0], row[1]) == group):
                color = look(method)["color"]
                style = ["-", "--", ":", "-.", (0, (1, 4)), (0, (6, 1, 1, 1, 1, 1)), (0, (8, 3)), (0, (2, 1))][seen.setdefault(color, 0) % 8]
                seen[color] += 1
                errors = sorted(row[3] for row in points if (row[0], row[1]) == group and row[2] == method)
                share = [100 * (1 - k / len(errors)) for k in range(len(errors))]
                axis.plot(errors, share, linestyle=style, color=color, linewidth=2 if method.startswith("potential") else 1.1, label=method)
            axis.set(xscale="log", xlabel="error of the force (N)", title=f"{group[0]}, {group[1]}")
            axis.legend(fontsize=5.5, loc="lower left")
        axes[0].set_ylabel("probes with a larger error (%)")

    return draw
