"""Figures as SVG, with their data as CSV; tables as Markdown.

Axes have the units in their labels. Incomplete data are not drawn: a column with a None is refused (record.Incomplete),
unless holes are part of the figure."""
import csv
import io
import math

from interruption import write_whole
from record import Incomplete, needed

# Colours that are distinguishable also in grey and for the colour-blind (Okabe and Ito 2008).
COLORS = ["#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9", "#000000", "#999933"]


def as_csv(name, columns, rows, holes=False):
    """The data of a figure or table as text; `columns` are names with units, such as "force (N)"."""
    rows = [list(row) for row in rows]
    if not rows:
        raise Incomplete(f"{name}: there are no data")
    for row in rows:
        if len(row) != len(columns):
            raise Incomplete(f"{name}: a row has {len(row)} instead of {len(columns)} values: {row}")
        if not holes and any(value is None for value in row):
            raise Incomplete(f"{name}: no value of {columns[row.index(None)]} in {row}")
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(columns)
    writer.writerows([shown(value) for value in row] for row in rows)
    return text.getvalue()


def faults(folder):
    """Errors in tables and figures of a complete run: rows without a number, and invalid numbers."""
    found = []
    for path in sorted(folder.glob("*.csv")):
        rows = list(csv.reader(io.StringIO(path.read_text(encoding="utf-8"))))[1:]
        of_text = not any(map(has_number, rows))
        for row in rows:
            if "nan" in row or not (of_text or has_number(row)):
                found.append(f"{path.name}: {', '.join(row)}")
    return found


def has_number(row):
    def is_number(cell):
        try:
            return math.isfinite(float(cell))
        except ValueError:
            return False

    return any(map(is_number, row))


def shown(value):
    return "" if value is None else f"{value:.6g}" if isinstance(value, float) else value


def save_figure(record, name, columns, rows, draw, size=(7, 4.2), holes=False):
    """Calls draw(figure) on a matplotlib figure, and saves NAME.svg and NAME.csv; equal data give equal bytes."""
    data = as_csv(name, columns, rows, holes)
    needed("matplotlib")
    import matplotlib
    matplotlib.use("svg")
    import matplotlib.pyplot as plot
    with plot.rc_context({"svg.hashsalt": "palpate", "svg.fonttype": "none", "font.size": 9, "axes.spines.top": False,
                          "axes.spines.right": False, "axes.grid": True, "grid.alpha": 0.3, "legend.frameon": False,
                          "axes.prop_cycle": plot.cycler(color=COLORS)}):
        figure = plot.figure(figsize=size, layout="constrained")
        draw(figure)
        text = io.StringIO()
        figure.savefig(text, format="svg", metadata={"Date": None, "Creator": "Palpate"})
        plot.close(figure)
    write_whole(record.folder / "figures" / f"{name}.csv", data)
    write_whole(record.folder / "figures" / f"{name}.svg", text.getvalue())


def legend_below(page, axis, lines=1):
    """A legend of the curves of `axis` below all axes of a page, in this number of lines."""
    handles, labels = axis.get_legend_handles_labels()
    room = (0.22 * lines + 0.1) / page.get_figheight()
    page.get_layout_engine().set(rect=(0, room, 1, 1 - room))
    page.legend(handles, labels, loc="lower center", ncols=-(-len(labels) // lines))


def save_table(record, name, columns, rows):
    """FOLDER/figures/NAME.md and NAME.csv. Text is kept; None becomes "not measured"."""
    write_whole(record.folder / "figures" / f"{name}.csv", as_csv(name, columns, rows, holes=True))
    cell = lambda value: "not measured" if value is None else f"{value:.3g}" if isinstance(value, float) else str(value)
    lines = [columns, ["---"] * len(columns), *[[cell(value) for value in row] for row in rows]]
    write_whole(record.folder / "figures" / f"{name}.md", "".join(f"| {' | '.join(line)} |\n" for line in lines))
