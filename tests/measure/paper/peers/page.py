"""Other methods on the same organ: the tables and figures of all peers.

Every peer receives the solved lattice points of one dataset, and is asked for the forces at its probes: exact solutions
at random places of the ball that no peer has seen. Builds by several workers count as their total processor seconds."""
import figure
import published
from peers import drawing, setting
from record import NotMeasured, needed


def peers(record):
    """Answers of other methods at the same places: linear bodies, reduced models, networks, Newton in the loop; and ours."""
    needed("numpy"), needed("scipy"), needed("h5py")
    from peers import loop, methods
    rows, loops, rates, errors = [], [], [], []
    for case in setting.cases(record):
        given = setting.setting(record, case)
        record.say(f"    {given.name}: {len(given.configurations.place)} configurations, {len(given.configurations.probe_place)} probes")
        for method in methods.BEFORE_THE_TOUCH:
            add(record, given, method, rows, errors)
        in_time, at_two_rates, main = newton(record, given)
        loops += [[case.organ().name, case.tool(), *row] for row in in_time]
        rates += [[case.organ().name, case.tool(), *row] for row in at_two_rates]
        for row, measured in main:
            rows.append(row)
            told(record, given, row, measured)
        add(record, given, methods.corotated, rows, errors)
    figure.save_table(record, "peers", setting.COLUMNS, rows)
    figure.save_table(record, "peers-newton", ["organ", "tool", *loop.COLUMNS], loops)
    figure.save_table(record, "peers-two-rates", ["organ", "tool", *loop.TWO_RATES], rates)
    figure.save_table(record, "peers-published", ["method", "what is published", "source"],
                      [[name, *said] for name, said in published.OTHERS.items()])
    draw = lambda drawn: drawing.naming(drawn, [row[2] for row in rows if row[drawing.ANSWER] is None])
    figure.save_figure(record, "peers-speed", setting.COLUMNS, rows, draw(drawing.speed(rows)), drawing.size(rows), holes=True)
    figure.save_figure(record, "peers-errors", ["organ", "tool", "method", "error (N)"], errors, draw(drawing.distributions(errors)),
                       drawing.size(errors))


def newton(record, given):
    """Like methods.newton; rows without values if it is not measured."""
    from peers import loop, methods
    try:
        return methods.newton(record, given)
    except NotMeasured as why:
        record.not_measured(f"{given.name}/full Newton", str(why))
        in_time, at_two_rates = ([["full Newton", *[None] * (len(columns) - 1)]] for columns in (loop.COLUMNS, loop.TWO_RATES))
        return in_time, at_two_rates, [(nothing_of(given, "full Newton"), None)]


def nothing_of(given, method):
    """The row of an unmeasured method."""
    return [given.case.organ().name, given.case.tool(), method] + [None] * (len(setting.COLUMNS) - 3)


def add(record, given, method, rows, errors):
    """Adds a method's rows, and [organ, tool, label, error] of each answer."""
    who = [given.case.organ().name, given.case.tool()]
    try:
        for row, forces, measured in method(record, given):
            rows.append(row)
            told(record, given, row, measured)
            errors += [[*who, row[2], length] for length in given.lengths_of_errors(forces)]
    except NotMeasured as why:
        record.not_measured(f"{given.name}/{method.__name__}", str(why))
        rows.append(nothing_of(given, method.__name__))


def told(record, given, row, measured):
    record.say(f"    {row[2]:44} " + " ".join(f"{value:.3g}" if isinstance(value, float) else str(value) for value in row[3:]))
    columns = setting.COLUMNS[3:-1]
    record.row(f"{given.name}/{row[2]}", columns, row[3:-1], [measured] * len(columns))
