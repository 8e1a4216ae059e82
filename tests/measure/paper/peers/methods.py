"""The peers, one function each: method(record, given) yields (row of setting.COLUMNS, forces at the probes,
record.Measured).

given: setting.Setting. Times of Python peers are processor time of one core. Along a hand's path each answer starts from
the one before; "without one before" starts from the configurations alone."""
from peers.setting import NOT_ASKED, median, timed
from record import NotMeasured

INTERPOLATIONS = {"trilinear": ("tri-linear (paper)", "no"), "rbf-linear": ("RBF r (paper)", "no"), "rbf-cubic": ("RBF r³ (paper)", "no"),
                  "potential": ("potential (this project)", "yes")}


def interpolations(record, given):
    """The paper's methods and ours, by the force fields of the client, in C++."""
    text = "".join("%.17g %.17g %.17g\n" % tuple(p) for p in given.configurations.probe_place)
    command = [record.bench / "palpate_force_query_bench", given.dataset.value["dataset"], "tip", *INTERPOLATIONS]
    measured = record.run(f"{given.name} forces and memory of interpolations", command, text, depends=[given.configurations.identity])
    for method, (label, conservative) in INTERPOLATIONS.items():
        told = measured.value["methods"][method]
        value = {"before_s": told["prepare_s"], "force_bytes": told["field_bytes"],
                 "shape_bytes": told["field_bytes"] + given.configurations.displacement.nbytes,
                 "answer_s": 1e-9 * told["query_ns"], "cold_s": 1e-9 * told["query_ns"]}
        yield given.row(label, value, given.errors(told["force"]), conservative=conservative, language="C++"), told["force"], measured


# Linear bodies

def compliance(record, given):
    """The answer of a linear simulator: the stiffness at rest."""
    import numpy
    from peers import body
    rest = given.configurations.stiffness[0]

    def make():
        made, seconds = timed(lambda: body.sensitivity(given.body.assemble(numpy.zeros(given.body.size), numpy.zeros(3))))
        repeats, p = 10000, given.configurations.probe_place[0]
        answer = timed(lambda: [rest @ p for _ in range(repeats)])[1] / repeats
        return {"before_s": seconds, "force_bytes": rest.nbytes, "shape_bytes": made.nbytes, "answer_s": answer, "cold_s": answer,
                "force": (given.configurations.probe_place @ rest.T).tolist()}

    measured = given.measure(record, "linear compliance", make)
    forces = measured.value["force"]
    yield given.row("linear compliance at rest", measured.value, given.errors(forces), 1), forces, measured


def corotated(record, given):
    """Linear elements in the frame of each one's rotation, in equilibrium to 1e-4. No compliance can be computed ahead
    for them, so they are solved like the whole body."""
    import numpy
    from peers import body, equilibrium, laws

    def make():
        model = equilibrium.Whole(given.configurations.body(laws.Corotated(given.body.law.shear_modulus)), body.Factors, 1e-4)
        steps = seconds_along(model, model.at_rest(), given.path[:10])
        found = chained(model, given.configurations.probe_place)
        factors = model.factors(model.assemble(numpy.zeros(given.body.size), numpy.zeros(3)))
        size = 12 * (factors.factors.L.nnz + factors.factors.U.nnz)
        return {"before_s": 0.0, "force_bytes": size, "shape_bytes": size, "answer_s": median(steps), "cold_s": None,
                "force": [one and one.force.tolist() for one in found], "stuck_on_the_path": steps.count(None), "steps": len(steps)}

    measured = given.measure(record, "co-rotated body", make, len(given.path))
    label = "co-rotated linear, in equilibrium"
    stuck(record, given, label, measured)
    yield given.row(label, measured.value, given.errors(measured.value["force"]), 0), measured.value["force"], measured


def chained(model, places):
    """Equilibria at places, each from the nearest one found so far; None without one."""
    import numpy
    from peers import equilibrium
    reached, found, left = [model.at_rest()], [None] * len(places), set(range(len(places)))
    while left:
        at = numpy.array([one.p for one in reached])
        distance = {n: numpy.linalg.norm(at - places[n], axis=1) for n in left}
        n = min(left, key=lambda m: distance[m].min())
        left.remove(n)
        found[n] = equilibrium.transition(model, reached[int(distance[n].argmin())], places[n])
        if found[n] is not None:
            reached.append(found[n])
    return found


def seconds_along(model, start, path):
    """Seconds of each answer on a hand's path, starting from the one before; None without an answer, and then from the
    last one."""
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


def few_elements(record):
    """Returns [(modes, tolerance of the weights)]."""
    return [(10, 1e-2)] if record.quick else [(10, 1e-2), (20, 1e-2), (20, 1e-3), (40, 1e-3)]


class Bases:
    """Created once for all reduced models of a setting, when the first of them is measured."""

    def __init__(self, given):
        self.given, self.made, self.models = given, None, {}

    def model(self, count):
        """(reduced.Reduced, s of processor time to make it)"""
        from peers import reduced
        if self.made is None:
            self.made = timed(lambda: reduced.snapshots(self.given.body, self.given.configurations))
        if count not in self.models:
            self.models[count] = timed(lambda: reduced.Reduced(self.given.body, self.made[0], count))
        return self.models[count][0], self.made[1] + self.models[count][1]


def by_newton(given, model, before):
    """Answers and time of a reduced model with Newton to convergence."""
    from peers import reduced
    rest = model.at_rest()
    found, took = zip(*(timed(lambda p=p: reduced.answer(model, p, rest)) for p in given.configurations.probe_place))
    steps = seconds_along(model, rest, given.path)
    return {"before_s": before, "force_bytes": model.memory(), "shape_bytes": model.memory_with_shape(), "answer_s": median(steps),
            "cold_s": median(took), "force": [one and one.force.tolist() for one in found], "unknowns": model.size,
            "stuck_on_the_path": steps.count(None), "steps": len(steps)}


def reduced_models(record, given):
    """POD and Galerkin with all elements."""
    bases = Bases(given)
    for count in modes(record):
        def make(count=count):
            model, seconds = bases.model(count)
            return by_newton(given, model, seconds)

        measured = given.measure(record, f"reduced, POD {count}", make, len(given.path))
        label = f"POD {count} ({measured.value['unknowns']} unknowns), all elements"
        stuck(record, given, label, measured)
        yield given.row(label, measured.value, given.errors(measured.value["force"])), measured.value["force"], measured


def stuck(record, given, label, measured):
    """How often there was no answer on the hand's path; times are of the other answers."""
    record.number(f"{given.name}/{label}/stuck_on_the_path", measured.value["stuck_on_the_path"], f"of {measured.value['steps']}", measured)


def sampled_models(record, given):
    """The same with few elements (ECSW), following the hand with old tangents."""
    import numpy
    from peers import equilibrium, reduced, sampled
    bases = Bases(given)
    for count, tolerance in few_elements(record):
        def make(count=count, tolerance=tolerance):
            model, seconds = bases.model(count)
            few = sampled.Sampled(model, tolerance, states=20 if record.quick else 60)
            newton, rest = by_newton(given, few, seconds + few.seconds), few.at_rest()
            forces = [reduced.followed(few, p, rest) for p in given.configurations.probe_place]
            follower = equilibrium.Follower(few, rest)
            answered = [timed(lambda p=p: follower.answer(numpy.array(p))) for p in given.path]
            steps = [took for force, took in answered if force is not None]
            return {**newton, "elements": len(few.elements), "misfit": few.misfit, "answer_s": median(steps),
                    "by_newton_s": newton["answer_s"], "slowest_s": max(steps), "tangents_on_the_path": follower.tangents,
                    "stuck_on_the_path": len(answered) - len(steps), "steps": len(answered),
                    "force": [None if force is None else force.tolist() for force in forces]}

        measured = given.measure(record, f"reduced, POD {count} of elements to {tolerance:g}", make, len(given.path))
        label = f"POD {count}, {measured.value['elements']} elements (ECSW, {tolerance:g})"
        for what, unit in ("by_newton_s", "s"), ("slowest_s", "s"), ("misfit", ""), ("tangents_on_the_path", ""), ("unknowns", ""):
            record.number(f"{given.name}/{label}/{what}", measured.value[what], unit, measured)
        stuck(record, given, label, measured)
        yield given.row(label, measured.value, given.errors(measured.value["force"])), measured.value["force"], measured


# Networks

def efforts(record):
    """For each kind, for network.Effort: what is tried, and the time limit."""
    if record.quick:
        return {"force": (3, 200, 1, 600, 100, 1, 12), "energy": (3, 200, 1, 600, 100, 1, 12),
                "energy and stiffness": (1, 100, 1, 300, 100, 1, 12)}
    return {"force": (30, 600, 4, 5000, 1000, 3, 90), "energy": (30, 600, 4, 5000, 1000, 3, 150),
            "energy and stiffness": (16, 400, 4, 4000, 1500, 3, 260)}


def networks(record, given):
    """The best network of a search for each kind."""
    from peers import network
    shortlist = None
    for kind in network.KINDS:
        effort = network.Effort(*efforts(record)[kind])

        def make(kind=kind, effort=effort, shortlist=shortlist):
            (model, told), seconds = timed(lambda: network.search(kind, given.configurations, effort, shortlist, record.say))
            exported, places = network.Exported(model), given.configurations.probe_place
            one_by_one = median([timed(lambda p=p: exported.force(p))[1] for _ in range(20) for p in places])
            batch = places[[n % len(places) for n in range(1000)]]
            together = median([timed(lambda: exported.force(batch))[1] for _ in range(9)]) / len(batch)
            return {**told, "before_s": seconds, "force_bytes": exported.memory(), "answer_s": one_by_one,
                    "cold_s": one_by_one, "batch_s": together, "parameters": exported.parameters(),
                    "force": exported.force(places).tolist()}

        measured = given.measure(record, f"network, {kind}", make, effort, shortlist)
        told = {**measured.value, "shape_bytes": "answers none"}
        for what, unit in (("batch_s", "s"), ("held_back_error", "N"), ("training_error", "N"), ("tried", ""), ("finalists", ""),
                           ("seeds", ""), ("epochs", ""), ("polish", ""), ("parameters", "")):
            record.number(f"{given.name}/network: {kind}/{what}", told[what], unit, measured)
        record.say(f"        {kind}: {told['settings']}, best of {told['tried']}; {told['held_back_error']:.3g} N on configurations held "
                   "back")
        if kind == "energy":  # its best settings are tried first with the stiffness, which takes five times as long
            shortlist = told["shortlist"]
        yield (given.row(f"network: {kind} ({told['settings'].split(',')[0]})", told, given.errors(told["force"]),
                         conservative="no" if kind == "force" else "yes"), told["force"], measured)


# Newton in the loop

def newton(record, given):
    """(rows of loop.COLUMNS, rows of loop.TWO_RATES, [(row of setting.COLUMNS, record.Measured)]). A converged answer is
    the exact force, at separate places; the probes are not used."""
    from peers import loop
    count, scene = 3 if record.quick else 5, scene_file(record, given.case)
    found, by_worker = loop.by_worker(record, given.name, scene, given.configurations, count)
    along = loop.exact_along(record, given.name, scene, given.body, given.fine)
    exact = along.value
    record.number(f"{given.name}/largest difference of worker and NumPy on a path", exact["largest_difference"], "N", along)
    record.number(f"{given.name}/places of the path with an equilibrium", len(exact["place"]) - 1, f"of {len(given.fine)}", along)
    in_time, rates, main = [], [], []

    def add(solver, rows, times, measured):
        behind = []
        if any(times.values()):
            behind = loop.two_rates(solver, loop.seconds_by_way(times), exact["place"], exact["force"], exact["stiffness"])
        else:
            record.not_measured(f"{given.name}/{solver} at two rates", "not one of its movements converged")
        in_time.extend(rows)
        rates.extend(behind or [[solver] + [None] * (len(loop.TWO_RATES) - 1)])
        for columns, some in (loop.COLUMNS, rows), (loop.TWO_RATES, behind):
            hand = columns.index("hand (mm/s)")
            for row in some:
                record.row(f"{given.name}/{solver}, {' '.join(f'{value:g}' for value in row[1:hand + 1])}", columns[hand + 1:],
                           row[hand + 1:], [measured] * len(row))
        value = {"before_s": 0.0, "answer_s": median(times[0.001])}
        main.append((given.row(f"full Newton, {solver} (1 mm)", value, NOT_ASKED, 0, language="C++"), measured))

    add("this project's worker", loop.worker_rows(found, given.configurations, count), loop.worker_times(found), by_worker)
    try:
        histories, measured = loop.by_getfem(record, given.name, given.configurations, given.body, count)
    except NotMeasured as why:
        record.not_measured(f"{given.name}/GetFEM", str(why))
        in_time.append(["GetFEM"] + [None] * (len(loop.COLUMNS) - 1))
        rates.append(["GetFEM"] + [None] * (len(loop.TWO_RATES) - 1))
        main.append((given.row("full Newton, GetFEM (1 mm)", {}, NOT_ASKED, 0, language="C++"), by_worker))
        return in_time, rates, main
    record.number(f"{given.name}/GetFEM/largest difference of the force at {count} configurations", measured.value["largest_difference_N"],
                  "N", measured)
    add("GetFEM", loop.getfem_rows(histories, found, given.configurations, count), loop.getfem_times(histories), measured)
    return in_time, rates, main


def scene_file(record, case):
    return record.scene(f"peers-{case.name()}", case.scene())


BEFORE_THE_TOUCH = [interpolations, compliance, reduced_models, sampled_models, networks]
