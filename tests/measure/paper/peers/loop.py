"""Newton in the loop: accuracy of a solver of the whole body while a hand moves.

A loop that answers every B seconds sees a hand of speed v move by v B. The solver starts from an exact equilibrium and
has B for the next one; for a hand that keeps moving it would start late, so this favours the solver. Solvers that have
not converged by then answer with what they have: GetFEM with its latest iterate; without an iterate, and for the worker
always, the linear answer from force and stiffness at the start.

Neither the hand nor a solver slower than a tick has to wait: at *two rates* the solver keeps solving for the hand's
position at its start, and a fast loop answers with force and stiffness of the last available equilibrium (as Courtecuisse
et al. 2015 do with compliances). The error of such an answer depends on the hand's motion meanwhile.

Times are of one core; the worker's are wall time."""
import json

import numpy as np

from peers.setting import larger

BUDGETS = [0.001, 0.016, 0.1]  # s
SPEEDS = [0.01, 0.05, 0.2]     # m/s
COLUMNS = ["solver", "time for an answer (ms)", "hand (mm/s)", "movement (mm)", "movements", "converged in time (%)",
           "median time to converge (ms)", "never converged", "mean error of what is answered (N)", "largest error of what is answered (N)"]


def movements(configurations, count):
    """(rows of the configurations at which hands start, unit vectors of their directions)"""
    random = np.random.default_rng(1000)
    rows = 1 + random.permutation(len(configurations.place) - 1)[:count]
    ways = random.standard_normal((len(rows), 3))
    return rows, ways / np.linalg.norm(ways, axis=1)[:, None]


def lengths():
    return sorted({round(speed * budget, 9) for speed in SPEEDS for budget in BUDGETS})


def by_worker(record, name, scene_file, configurations, count):
    """{length: [{force, seconds} or None]}: the exact forces and their solve times."""
    rows, ways = movements(configurations, count)
    paths = [[configurations.place[row].tolist(), (configurations.place[row] + length * way).tolist()]
             for length in lengths() for row, way in zip(rows, ways)]
    command = [record.bench / "palpate_path_forces", scene_file, "--active", "tip"]
    measured = record.run(f"{name} movements by the worker", command, json.dumps(paths))
    ends = [path["reached"][1] if len(path["reached"]) == 2 else None for path in measured.value["paths"]]
    return {length: ends[n * len(rows):(n + 1) * len(rows)] for n, length in enumerate(lengths())}, measured


def by_getfem(record, name, configurations, some_body, count):
    """{length: [history of iterations]}, and GetFEM's own equilibria of the start configurations."""
    from peers import getfem_body

    def make():
        rows, ways = movements(configurations, count)
        solver = getfem_body.GetfemBody(some_body, configurations.fixed)
        found, apart = {str(length): [] for length in lengths()}, 0.0
        for row, way in zip(rows, ways):
            started = solver.start(configurations.displacement[row], configurations.pressure[row], configurations.place[row])
            start = solver.kept()
            if started:
                apart = larger(apart, np.linalg.norm(solver.force() - configurations.force[row]))
            for length in lengths():
                found[str(length)].append(solver.history(start, configurations.place[row] + length * way) if started else [])
        return {"histories": found, "largest_difference_N": apart}

    measured = record.measure(f"{name} movements by GetFEM", make, configurations.identity, count, BUDGETS, SPEEDS,
                              command="tests/measure/paper/run peers")
    return {float(length): histories for length, histories in measured.value["histories"].items()}, measured


def rows_of(solver, outcomes, exact):
    """A row of COLUMNS for each budget and speed. outcomes(length): for each movement (seconds to converge or None,
    function of a time that gives the force answered then). exact(length): for each movement its force or None."""
    rows = []
    for budget in BUDGETS:
        for speed in SPEEDS:
            length = round(speed * budget, 9)
            both = [(outcome, force) for outcome, force in zip(outcomes(length), exact(length)) if None not in (outcome, force)]
            times = [outcome[0] for outcome, _ in both if outcome[0] is not None]
            wrong = [float(np.linalg.norm(np.subtract(outcome[1](budget), force))) for outcome, force in both]
            rows.append([solver, 1e3 * budget, 1e3 * speed, 1e3 * length, len(both),
                         100 * sum(time <= budget for time in times) / len(both) if both else None,
                         1e3 * float(np.median(times)) if times else None,
                         len(both) - len(times), float(np.mean(wrong)) if wrong else None, max(wrong) if wrong else None])
    return rows


def linear_answer(configurations, row, way):
    return configurations.force[row] + configurations.stiffness[row] @ way


def worker_rows(found, configurations, count):
    rows, ways = movements(configurations, count)

    def outcomes(length):
        made = []
        for end, row, way in zip(found[length], rows, ways):
            linear = linear_answer(configurations, row, length * way)
            answered = lambda budget, end=end, linear=linear: end["force"] if end["seconds"] <= budget else linear
            made.append(end and (end["seconds"], answered))
        return made

    return rows_of("this project's worker", outcomes, lambda length: [end and end["force"] for end in found[length]])


TWO_RATES = ["solver", "hand (mm/s)", "equilibria a second", "mean way since the last one (mm)", "mean error (N)", "95 % (N)",
             "largest error (N)"]


def two_rates(solver, seconds_of, path, force, stiffness):
    """A row of TWO_RATES for each speed. seconds_of(way): time of an equilibrium at this distance from the last, m to s;
    path: n x 3 positions of the hand (m) at its sampling distance, from rest; force and stiffness: the exact ones there.
    The first position is solved when the hand starts and is not counted; neither are solves that are unfinished when the
    hand stops."""
    path, force, rows = np.asarray(path), np.asarray(force), []
    for speed in SPEEDS:
        when = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(path, axis=0), axis=1))]) / speed
        solved, target, ready, came = 0, 0, 0.0, 0
        errors, ways = [], []
        for now, at in zip(when, range(len(path))):
            while ready <= now:  # the solver turns to the hand's position at the time when it was ready
                came += target != solved
                solved, target = target, int(np.searchsorted(when, ready, side="right")) - 1
                if target == solved:
                    ready = when[solved + 1] if solved + 1 < len(when) else np.inf
                else:
                    ready += seconds_of(float(np.linalg.norm(path[target] - path[solved])))
            way = path[at] - path[solved]
            ways.append(np.linalg.norm(way))
            errors.append(np.linalg.norm(force[solved] + stiffness[solved] @ way - force[at]))
        rows.append([solver, 1e3 * speed, came / when[-1], 1e3 * float(np.mean(ways)), float(np.mean(errors)),
                     float(np.percentile(errors, 95)), float(max(errors))])
    return rows


def seconds_by_way(times):
    """The medians of {way: [seconds]}, of which some may be empty, with linear interpolation between them."""
    ways = [way for way in sorted(times) if times[way]]
    medians = [float(np.median(times[way])) for way in ways]
    return lambda way: float(np.interp(way, ways, medians))


def worker_times(found):
    return {length: [end["seconds"] for end in ends if end] for length, ends in found.items()}


def getfem_times(histories):
    ends = {length: [history[-1] for history in each if history] for length, each in histories.items()}
    return {length: [end["seconds"] for end in each if end["converged"]] for length, each in ends.items()}


def exact_along(record, name, scene_file, some_body, path):
    """{reached: positions of the path that have an equilibrium, force, stiffness}, by the NumPy body; also the worker's
    forces, with largest_difference (N)."""
    from peers import body, equilibrium
    command = [record.bench / "palpate_path_forces", scene_file, "--active", "tip"]
    by_worker = record.run(f"{name} path by the worker", command, json.dumps([path]))
    other = [point["force"] for point in by_worker.value["paths"][0]["reached"]]

    def make():
        model = equilibrium.Whole(some_body, body.Factors)
        at, apart, made = model.at_rest(), 0.0, {"place": [[0.0] * 3], "force": [[0.0] * 3], "stiffness": []}
        made["stiffness"].append(body.stiffness(model.assemble(at.z, at.p), at.slope).tolist())
        for place, force in zip(path, other):
            at = equilibrium.transition(model, at, place)
            if at is None:
                break
            made["place"].append(place)
            made["force"].append(at.force.tolist())
            made["stiffness"].append(body.stiffness(model.assemble(at.z, at.p), at.slope).tolist())
            apart = larger(apart, np.linalg.norm(at.force - force))
        return {**made, "largest_difference": apart}

    return record.measure(f"{name} path in NumPy", make, other, path, command="tests/measure/paper/run peers")


def getfem_rows(histories, found, configurations, count):
    rows, ways = movements(configurations, count)

    def outcomes(length):
        made = []
        for history, row, way in zip(histories[length], rows, ways):  # no history: not even the start converged
            def answered(budget, history=history, linear=linear_answer(configurations, row, length * way)):
                done = [iterate for iterate in history if iterate["seconds"] <= budget and np.isfinite(iterate["force"]).all()]
                return done[-1]["force"] if done else linear
            made.append((history[-1]["seconds"] if history and history[-1]["converged"] else None, answered))
        return made

    return rows_of("GetFEM", outcomes, lambda length: [end and end["force"] for end in found[length][:len(rows)]])
