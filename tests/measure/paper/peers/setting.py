"""The common input of all peers of one organ and tool, and the rows of the table."""
import dataclasses
import resource
import time

import organs
import references
from record import Incomplete

COMMAND = "tests/measure/paper/run peers"
COLUMNS = ["organ", "tool", "method", "configurations", "before the touch (s)", "memory, force (MB)", "memory, shape too (MB)",
           "answer (us)", "answer without one before (us)", "in", "mean error (N)", "median (N)", "95 % (N)", "largest error (N)",
           "95 % relative (%)", "within 3 % or 10 mN (%)", "not answered", "conservative"]
NOT_ASKED = dict.fromkeys(["mean", "median", "p95", "worst", "relative_p95", "in_target", "unanswered"])  # at the probes


@dataclasses.dataclass(frozen=True)
class Case:
    nodes: int      # approximate number of nodes of the organ
    patch: float    # m, of the patch that moves with the node; 0: only the node
    radius: float   # m, of the ball
    divisions: int  # lattice spacings in it
    probes: int

    def organ(self):
        return organs.organ(self.nodes)

    def name(self):
        return f"{self.organ().name}-" + (f"patch-{1000 * self.patch:g}mm" if self.patch else "node")

    def tool(self):
        return f"patch, {1000 * self.patch:g} mm" if self.patch else "single node"

    def scene(self, probes=True):
        return organs.scene(self.organ(), "mr", radius=self.radius, divisions=self.divisions, patch=self.patch,
                            name=f"peers-{self.name()}", accuracy=f"probes = {self.probes}" if probes else "",
                            storage='displacement = "all"')


@dataclasses.dataclass
class Setting:
    """A case, and the input of its peers."""
    case: Case
    dataset: object         # record.Measured of its build
    configurations: object  # configurations.Configurations
    body: object            # body.Body
    build_s: object         # s of processor time of all workers; None if they ran elsewhere
    path: list              # displacements of a hand, m, 1 mm apart, from rest
    fine: list              # the same, 0.25 mm apart
    name: str

    def measure(self, record, what, make, *depends):
        """Measures a function whose result depends on the dataset and `depends`."""
        return record.measure(f"{self.name} {what}", make, self.configurations.identity, *depends, command=COMMAND)

    def row(self, method, value, errors, configurations=None, conservative="yes", language="Python"):
        """A row of COLUMNS. value: before_s (in addition to the build), force_bytes, shape_bytes, answer_s, cold_s; any
        of them None if not measured, or a word if there is none."""
        count = len(self.configurations.place) if configurations is None else configurations
        of = lambda name, factor: value.get(name) if isinstance(value.get(name), (str, type(None))) else factor * value[name]
        build = self.build_s if count > 1 else 0
        before = None if None in (value.get("before_s"), build) else value["before_s"] + build
        return [self.case.organ().name, self.case.tool(), method, count, before, of("force_bytes", 1e-6), of("shape_bytes", 1e-6),
                of("answer_s", 1e6), of("cold_s", 1e6), language, errors["mean"], errors["median"], errors["p95"], errors["worst"],
                errors["relative_p95"], errors["in_target"], errors["unanswered"], conservative]

    def errors(self, forces):
        """Errors of forces at the probes, None without an answer."""
        import numpy
        from peers import configurations
        answered = [[numpy.nan] * 3 if force is None else force for force in forces]
        return configurations.errors(numpy.array(answered, float), self.configurations.probe_force)

    def lengths_of_errors(self, forces):
        """N; infinite without an answer."""
        import numpy
        return [float("inf") if force is None else float(numpy.linalg.norm(numpy.subtract(force, exact)))
                for force, exact in zip(forces, self.configurations.probe_force)]


def cases(record):
    """The peers were developed with the first; nothing was tuned for the patch."""
    if record.quick:
        return [Case(500, 0.0, 0.06, 3, 20)]
    return [Case(2000, 0.0, 0.06, 4, 100), Case(2000, 0.02, 0.06, 4, 100)]


def setting(record, case):
    from peers import configurations
    made, build_s = built(record, case)
    read = configurations.read(made.value["dataset"])
    if read.unsolved or read.probes_unsolved:
        record.say(f"    {case.name()}: {read.unsolved} lattice points and {read.probes_unsolved} probes have no equilibrium, and are "
                   "omitted")
    if not len(read.probe_place):
        raise Incomplete(f"{case.name()}: no probe converged, so there is nothing to compare answers with")
    hand = lambda steps, step: references.random_paths(1, radius=0.9 * case.radius, steps=steps, step=step, seed=48)[0]
    given = Setting(case, made, read, read.body(configurations.mooney_rivlin()), build_s,
                    hand(20 if record.quick else 120, 0.001), hand(40 if record.quick else 120, 0.00025), case.name())
    counts = {"configurations": len(read.place), "lattice points without equilibrium": read.unsolved, "probes": len(read.probe_place),
              "probes without equilibrium": read.probes_unsolved}
    for what, count in counts.items():
        record.number(f"{case.name()}/{what}", count, "", made)
    agree(record, given)
    return given


def built(record, case):
    """(the dataset with the probes; s of processor time of a build without them, over all workers; if a part was built
    earlier, wall time times the number of workers; None if workers ran elsewhere)."""
    began, used = time.monotonic(), processor_of_children()
    alone = record.dataset(f"peers-{case.name()}-alone", case.scene(probes=False))

    def seconds():
        if alone.value["jobs"] is None:
            return None
        at_once = time.monotonic() - began >= 0.98 * alone.value["seconds"]
        return processor_of_children() - used if at_once else alone.value["seconds"] * alone.value["jobs"]

    took = record.measure(f"{case.name()} processor time of the build", seconds, case.scene(probes=False), alone.at, command=alone.command)
    return record.dataset(f"peers-{case.name()}", case.scene()), took.value


def processor_of_children():
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def agree(record, given):
    """Compares the NumPy body with the dataset: how far its configurations are from equilibrium, and the difference of
    forces."""
    import numpy

    def make():
        read, worst = given.configurations, {"residual": 0.0, "force": 0.0}
        for displacement, pressure, place, force in zip(read.displacement, read.pressure, read.place, read.force):
            here = given.body.assemble(given.body.state(displacement, pressure), place, tangent=False)
            worst["residual"] = larger(worst["residual"], numpy.abs(here.residual).max())
            worst["force"] = larger(worst["force"], numpy.linalg.norm(here.force - force))
        return worst

    measured = given.measure(record, "dataset and body", make)
    for name, value in measured.value.items():
        record.number(f"{given.name}/largest {name} of a configuration, in NumPy", value, "N", measured)
    if not measured.value["force"] <= 1e-3:
        raise Incomplete(f"{given.name}: the body in NumPy differs from the dataset by {measured.value['force']:.3g} N: they are not the "
                         "same body")


def larger(one, other):
    """NaN if one of them is None."""
    import numpy
    return float(numpy.maximum(one, other))


def timed(work):
    """(the result, s of processor time)"""
    began = time.process_time()
    return work(), time.process_time() - began


def median(values):
    """The median of numbers without None; None if there are none."""
    import numpy
    there = [value for value in values if value is not None]
    return float(numpy.median(there)) if there else None
