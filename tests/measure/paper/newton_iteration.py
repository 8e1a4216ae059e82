"""Table 1 of the paper: cost of one Newton iteration, compared in the same run with GetFEM, the paper's library.

Ours is the assembly of residual and tangent, and factorisation with one solve, at the start of a step of 1 mm. GetFEM's
is its assembly and its linear solve by the same MUMPS, at rest, which analyses the pattern of the tangent each time. Ours
does that once for a body; its time stands in a separate column. The best round counts on both sides. A round has one
iteration of GetFEM and the median of several of ours. Seconds."""
import dataclasses
import sys

import figure
import organs
import published
from record import NotMeasured, needed

REFERENCE = organs.REFERENCE.parent / "oracle" / "getfem_reference.py"


@dataclasses.dataclass(frozen=True)
class Row:
    """A row of the paper: law, displacement order, approximate number of nodes, and the published number."""
    law: str
    order: int
    nodes: int
    published: int

    def organ(self):
        return organs.organ(self.nodes)

    def name(self):
        return f"{organs.LAWS[self.law]}, {'linear' if self.order == 1 else 'quadratic'}, {self.organ().name}"

    def papers(self):
        """The paper's elements, of equal order: displacement, pressure, constraint. The quadratic ones have 12,323
        unknowns, which requires a quadratic pressure."""
        space = f"P{self.order}"
        return dict(displacement=space, pressure=space if self.law == "mr" else "none", constraint="det-F-1")

    def stable(self):
        """Our elements, which satisfy inf-sup and cannot invert; without a pressure nothing changes."""
        return dict(displacement=f"P{self.order}") if self.law == "mr" else self.papers()


ROWS = [Row("svk", 1, 500, 501), Row("mr", 1, 500, 501), Row("svk", 1, 2000, 2011), Row("mr", 2, 500, 501), Row("mr", 1, 2000, 2011)]


def elements(discretization, law):
    pressure = discretization.get("pressure") or ("P1-stabilized" if discretization["displacement"] == "P1" else "P1")
    return discretization["displacement"] + ("" if law == "svk" else f"/{pressure}, {discretization.get('constraint', 'ln-det-F')}")


def ours(record, row, discretization, turn):
    file = record.scene(f"iteration-{row.organ().name}-{row.law}-{'-'.join(discretization.values())}",
                        organs.scene(row.organ(), row.law, **discretization))
    command = [record.bench / "palpate_newton_bench", "--scene", file, "--rounds", 1, "--repetitions", 10 if record.quick else 20]
    return record.run(f"iteration and analysis of {row.name()}, {elements(discretization, row.law)}, round {turn}", command)


def why_no_getfem(row):
    """Why GetFEM cannot run this row; empty if it can."""
    if not REFERENCE.is_file():
        return f"GetFEM: there is no {REFERENCE}"
    if row.organ().source != "reference":
        return f"GetFEM: {REFERENCE.name} holds what lies below a plane, and {row.organ().name} is held in a sphere"
    try:
        needed("getfem")
    except NotMeasured as missing:
        return str(missing)
    return None


def getfem(record, row, turn):
    """With zero displacement: only the assembly and the linear solve are measured."""
    command = ["env", "OPENBLAS_NUM_THREADS=1", "OMP_NUM_THREADS=1", sys.executable, REFERENCE, row.organ().mesh, "--law", row.law,
               "--poisson", organs.POISSON, "--fixed-below", "x", 0.15, "--active", *row.organ().tip, "--to", 1e-6, 0, 0, "--steps", 1,
               "--order", row.order, "--pressure-order", row.order]
    return record.run(f"GetFEM of {row.name()}, round {turn}", command)


COLUMNS = ["law, order, organ", "published unknowns", "published assembly (s)", "published solve (s)", "published total (s)",
           "GetFEM 5.4 assembly (s)", "GetFEM 5.4 solve (s)", "GetFEM 5.4 total (s)",
           "elements", "unknowns", "assembly (s)", "solve (s)", "total (s)", "analysis, once (s)", "times faster than GetFEM 5.4",
           "times faster, analysed each time",
           "stable elements", "stable unknowns", "stable assembly (s)", "stable solve (s)", "stable total (s)"]


def seconds_of(samples):
    """Unknowns, and seconds of the best round: in the paper's parts, and of the analysis; with one source measurement."""
    best = min(samples, key=lambda sample: sample.value["newton_iteration"]["median_ms"])
    seconds = lambda *parts: sum(best.value[part]["median_ms"] for part in parts) / 1e3
    return [best.value["unknowns"], seconds("assemble_residual_and_tangent"), seconds("factorize", "solve_one"),
            seconds("newton_iteration"), seconds("analysis_once")], best


def getfem_seconds(samples):
    best = min(samples, key=lambda sample: sample.value["assembly_s"] + sample.value["solve_s"])
    return [best.value["assembly_s"], best.value["solve_s"], best.value["assembly_s"] + best.value["solve_s"]], best


def measured_row(record, row):
    same, stable, theirs = [], [], []
    missing = why_no_getfem(row)
    if missing:
        record.not_measured(f"{row.name()}/GetFEM 5.4", missing)
    for turn in range(1, (1 if record.quick else 5) + 1):  # in turns, so that other load on the machine affects all of them
        same.append(ours(record, row, row.papers(), turn))
        stable.append(ours(record, row, row.stable(), turn))
        if not missing:
            theirs.append(getfem(record, row, turn))
    paper = published.NEWTON_ITERATION[(row.law, row.order, row.published)]
    (unknowns, *same), by = seconds_of(same)
    (stable_unknowns, *stable, _), stable_by = seconds_of(stable)
    theirs, theirs_by = getfem_seconds(theirs) if theirs else ([None] * 3, None)
    cells = [row.name(), paper["unknowns"], paper["assembly"], paper["solve"], paper["total"], *theirs,
             elements(row.papers(), row.law), unknowns, *same, theirs[2] / same[2] if theirs_by else None,
             theirs[2] / (same[2] + same[3]) if theirs_by else None,
             elements(row.stable(), row.law), stable_unknowns, *stable]
    sources = [*[None] * 5, *[theirs_by] * 3, None, *[by] * 7, None, *[stable_by] * 4]
    record.row(row.name(), COLUMNS, cells, sources)
    return cells


def table1(record):
    """Table 1: a Newton iteration, published, by GetFEM 5.4 and by ours, with the paper's elements and with stable ones."""
    rows = [row for row in ROWS if row.nodes in record.nodes and row.law in record.laws]
    figure.save_table(record, "table1", COLUMNS, [whole_row(record, row) for row in rows])


def whole_row(record, row):
    try:
        return measured_row(record, row)
    except NotMeasured as why:
        record.not_measured(row.name(), str(why))
        return [row.name(), *[None] * (len(COLUMNS) - 1)]
