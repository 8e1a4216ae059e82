"""Exact forces for comparison with interpolations: along the paper's regular and random paths, each solved from the one
before, or via points beside the path if the direct step fails (docs/solver.md).

Displacements in metres, forces in newtons (tissue on tool). Unreached points of a path are counted, never filled in.
Relative errors are |f' - f| / max(|f|, FLOOR), of force vectors."""
import dataclasses
import functools
import itertools
import json
import random

import organs
from record import Measured

FLOOR = 0.05  # N: smaller forces count as this in relative errors


@dataclasses.dataclass
class References:
    displacement: list  # of all reached points, n x 3
    force: list         # n x 3
    wanted: int         # number of requested points
    after_detour: int   # number of reached points on or after a detour of their path
    measured: object    # source (record.Measured)


def regular_paths(length=0.1, step=0.001):
    """Straight paths from rest in 26 directions (Sec. 6.1)."""
    count = round(length / step)
    return [[[length * n / count * x for x in direction] for n in range(1, count + 1)] for direction in organs.directions()]


def random_paths(count, radius=0.1, steps=200, step=0.001, seed=2010):
    """Paths from rest through uniformly random places in the ball, with `steps` steps of equal length in all."""
    generator = random.Random(seed)
    return [random_path(generator, radius, steps, step) for _ in range(count)]


def random_path(generator, radius, steps, step):
    at, target, path = [0.0, 0.0, 0.0], [0.0, 0.0, 0.0], []
    while len(path) < steps:
        way = [t - a for t, a in zip(target, at)]
        distance = sum(w * w for w in way) ** 0.5
        if distance < step:  # the remainder of a leg is dropped, so that all steps have the same length
            target = in_ball(generator, radius)
            continue
        at = [a + step * w / distance for a, w in zip(at, way)]
        path.append(at)
    return path


def in_ball(generator, radius):
    while True:
        place = [generator.uniform(-radius, radius) for _ in range(3)]
        if sum(x * x for x in place) <= radius * radius:
            return place


def solved_along(record, name, scene, paths, detours=True):
    """Measures the exact solutions along `paths`, one path at a time, so that an interruption loses one at most."""
    command = [record.bench / "palpate_path_forces", record.scene(name, scene), "--active", "tip", *(["--detours"] if detours else [])]
    each = record.together([functools.partial(record.run, f"{name} path {n + 1} of {len(paths)}", command, json.dumps([path]))
                            for n, path in enumerate(paths)])
    reached = [measured.value["paths"][0]["reached"] for measured in each]
    points = [point for path in reached for point in path]
    after = sum(sum(itertools.accumulate((point["detours"] > 0 for point in path), max)) for path in reached)
    return References([point["displacement"] for point in points], [point["force"] for point in points],
                      sum(map(len, paths)), after, Measured.of_all(each, f"tests/measure/paper/run {record.target}"))
