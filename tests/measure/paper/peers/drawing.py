"""Figures of the peers; rows as in setting.COLUMNS."""
import math

import figure
from peers.setting import COLUMNS

ANSWER, MEAN = COLUMNS.index("answer (us)"), COLUMNS.index("mean error (N)")
FAMILIES = {"linear": 5, "co-rotated": 5, "POD": 0, "network": 3, "tri-linear": 4, "RBF": 4, "potential": 2, "full Newton": 6}
STYLES = ["-", "--", ":", "-.", (0, (1, 4)), (0, (6, 1, 1, 1, 1, 1)), (0, (8, 3)), (0, (2, 1))]


def color(method):
    return figure.COLORS[FAMILIES[next(family for family in FAMILIES if method.startswith(family))]]


def marker(method):
    return "s" if "ECSW" in method else "^" if method.startswith("network") else "*" if method.startswith("potential") else "o"


def label(method):
    """A short label that fits beside a point: POD 20, 213 elements."""
    return method.split(" (")[0] + (", all" if "all elements" in method else "")


def label_points(axis, points):
    """Labels points (x, y, text) on logarithmic axes. Moves a label down if it would cover another."""
    placed = []
    for x, y, text in sorted(points, key=lambda point: -point[1]):
        right = x > 3e4 and len(text) > 12  # no room to the right of it
        at = math.log10(y)
        while any(abs(math.log10(x / other)) < 1.3 and abs(at - height) < 0.085 for other, height in placed):
            at -= 0.01
        placed.append((x, at))
        axis.annotate(text, (x, y), textcoords="offset points", fontsize=6, ha="right" if right else "left",
                      xytext=(-5 if right else 5, 3 + 58 * (at - math.log10(y))))


def naming(draw, missing):
    """Wraps `draw` and names the missing methods above it."""
    def named(page):
        draw(page)
        if missing:
            page.suptitle(f"not measured: {', '.join(dict.fromkeys(missing))}", fontsize=8, color=figure.COLORS[1])

    return named


def groups_of(rows):
    return list(dict.fromkeys((row[0], row[1]) for row in rows))


def size(rows):
    return (4.6 * len(groups_of(rows)) + 3, 5.2)


def speed(rows):
    """Mean error over the time of an answer. Exact methods have a line at their time; unmeasured ones are not shown."""
    def draw(page):
        axes = page.subplots(1, len(groups_of(rows)), squeeze=False, sharey=True)[0]
        for axis, group in zip(axes, groups_of(rows)):
            labels = []
            for row in rows:
                if (row[0], row[1]) != group or row[ANSWER] is None:
                    continue
                if row[2].startswith("full Newton"):
                    axis.axvline(row[ANSWER], color="black", linewidth=0.8, linestyle=":" if "GetFEM" in row[2] else "--")
                    axis.text(row[ANSWER], 0.02, row[2], rotation=90, fontsize=6, transform=axis.get_xaxis_transform(), ha="right",
                              va="bottom")
                elif row[MEAN]:
                    axis.plot([row[ANSWER]], [row[MEAN]], linestyle="", markersize=7, color=color(row[2]), marker=marker(row[2]))
                    labels.append((row[ANSWER], row[MEAN], label(row[2])))
            label_points(axis, labels)
            axis.axvline(1000, color="grey", linewidth=0.6)
            axis.text(1000, 0.98, "1 kHz", fontsize=6, transform=axis.get_xaxis_transform(), ha="right", va="top")
            axis.set(xscale="log", yscale="log", xlabel="time of an answer, one core (us)", title=f"{group[0]}, {group[1]}")
        axes[0].set_ylabel("mean error at the probes (N)")

    return draw


def distributions(points):
    """points: [organ, tool, method, error; infinite without an answer]. The share of the probes with larger errors."""
    def draw(page):
        axes = page.subplots(1, len(groups_of(points)), squeeze=False, sharey=True)[0]
        for axis, group in zip(axes, groups_of(points)):
            seen = {}
            for method in dict.fromkeys(row[2] for row in points if (row[0], row[1]) == group):
                style = STYLES[seen.setdefault(color(method), 0) % len(STYLES)]
                seen[color(method)] += 1
                errors = sorted(row[3] for row in points if (row[0], row[1]) == group and row[2] == method)
                share = [100 * (1 - k / len(errors)) for k in range(len(errors))]
                there = sum(map(math.isfinite, errors))
                axis.plot(errors[:there], share[:there], linestyle=style, color=color(method), linewidth=2 if method.startswith("potential") else 1.1,
                          label=method)
            axis.set(xscale="log", xlabel="error of the force (N)", title=f"{group[0]}, {group[1]}")
            axis.legend(fontsize=5.5, loc="lower left")
        axes[0].set_ylabel("probes with a larger error (%)")

    return draw
