"""Fig. 5 of the paper: the same pull for each law, as pictures and as a change of volume."""
import contextlib
import pathlib
import subprocess
import sys

import figure
import organs
from active_places import DRAWN_LAWS, places, scene_at, straight_path
from record import Incomplete, NotMeasured

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "support"))
from virtual_screen import virtual_screen

PULL, REACH = 0.04, 0.08  # m: the shown displacement, a lattice point, and the radius of the lattice


def view(record, *words, env=None):
    command = [str(word) for word in (record.programs / "palpate", "view", *words)]
    done = subprocess.run(command, capture_output=True, text=True, check=False, env=env, timeout=300, cwd=record.folder)
    if done.returncode != 0:
        raise Incomplete(f"{record.shown(command)} ended with {done.returncode}: {done.stderr.strip()[-1000:]}")


def hand(record, dataset, where, aim):
    """A recording of a hand that grips the node, pulls it to `aim` (m, scene) and stays: the same for all laws."""
    lines = [[0.0, *where.node], [0.2, *where.node], [1.5, *aim], [3.0, *aim]]
    path, recording = "scenes/pull.txt", "scenes/pull.h5"  # in the folder, because the picture names the replayed file
    (record.folder / path).write_text("".join(" ".join(map(repr, line)) + "\n" for line in lines), encoding="utf-8")
    view(record, dataset, "--device", f"virtual:{path}", "--contact", "glued", "--headless", "--fast", "--duration", 2.5,
         "--record", recording)
    return recording


def draw_shapes(record, datasets, where, aim):
    """figures/figure5-LAW.png for each law: the last frame of the same hand."""
    recording = hand(record, datasets["mr"], where, aim)
    with contextlib.ExitStack() as screen:
        try:
            env = screen.enter_context(virtual_screen())
        except OSError as why:
            raise NotMeasured(f"no screen to draw on (package xvfb): {why}") from why
        for law, dataset in datasets.items():
            picture = record.folder / "figures" / f"figure5-{law}.png"
            picture.parent.mkdir(parents=True, exist_ok=True)
            view(record, dataset, "--device", f"replay:{recording}", "--contact", "glued", "--fast", "--screenshot", picture, env=env)


SHAPE_COLUMNS = ["organ", "law", "displacement (mm)", "force (N)", "change of volume (%)", "min det F", "picture"]


def figure5(record):
    """Fig. 5: the same pull for each law: pictures, and the change of volume."""
    organ = organs.organ(record.nodes[0])
    where = places(record, organ)["A"]
    axis = max(range(3), key=lambda n: abs(where.outward[n]))
    pull = [PULL * (1 if where.outward[n] > 0 else -1) if n == axis else 0.0 for n in range(3)]
    datasets, points, sources = {}, {}, {}
    for law in DRAWN_LAWS:
        datasets[law] = record.dataset(f"{organ.name}-{law}-shape", scene_at(organ, law, where, radius=REACH, divisions=2)).value["dataset"]
        direction = [x / PULL for x in pull]
        sources[law], count = straight_path(record, f"{organ.name}-pull-{law}", organ, law, where, direction, PULL, 0.005)
        reached = sources[law].value["paths"][0]["reached"]
        if len(reached) < count:
            raise Incomplete(f"figure5: {organs.LAWS[law]} does not reach {1000 * PULL:g} mm: {sources[law].value['paths'][0]['failure']}")
        points[law] = reached[-1]
    virtual_hand = 400.0  # N/m: it yields to the force (viewer/devices/virtual_hand.hpp)
    aim = [x + p - f / virtual_hand for x, p, f in zip(where.node, pull, points["mr"]["force"])]
    pictures = {law: f"figure5-{law}.png" for law in datasets}
    try:
        draw_shapes(record, datasets, where, aim)
    except NotMeasured as why:
        record.not_measured("pictures", str(why))
        pictures = dict.fromkeys(datasets)
    rows = []
    for law, point in points.items():
        norm = lambda v: sum(x * x for x in v) ** 0.5
        rows.append([organ.name, organs.LAWS[law], 1000 * norm(point["displacement"]), norm(point["force"]), 100 * (point["volume"] - 1),
                     point["min_det_F"], pictures[law]])
        record.number(f"{organ.name}, {organs.LAWS[law]}/change of volume", rows[-1][4], "%", sources[law])
        record.number(f"{organ.name}, {organs.LAWS[law]}/force", rows[-1][3], "N", sources[law])
    figure.save_table(record, "figure5", SHAPE_COLUMNS, rows)
