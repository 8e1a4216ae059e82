"""Fig. 6 of the paper: force against displacement along four paths, by law."""
import figure
import organs
from active_places import DRAWN_LAWS, places, straight_path

FORCE_COLUMNS = ["organ", "path", "law", "displacement (mm)", "force (N)", "min det F", "volume by that at rest (%)", "stopped by"]


def force_curve(record, organ, path, law, where, direction):
    """Rows of FORCE_COLUMNS; the last one gives the reason if the path stopped."""
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
            for n, law in enumerate(DRAWN_LAWS):
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
        axes[0].plot([], [], "x", color="black", label="no further straight on")
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
                for law in DRAWN_LAWS:
                    rows += force_curve(record, organ, f"{letter}{number}", law, where, direction)
    paths = list(dict.fromkeys(row[1] for row in rows))
    figure.save_figure(record, "figure6", FORCE_COLUMNS, rows, draw_forces(rows, paths), size=(11, 3.6))
