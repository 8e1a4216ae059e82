#!/usr/bin/env python3
"""Presses a tool into a body, step by step, and prints the forces; the first line is an answer without contact.

    PYTHONPATH=. ./touch.py DATASET.h5 [DEPTH_MM]
"""

import math
import sys

import palpate

TICKS, TICKS_PER_LINE = 400, 40


def inward_normal(dataset, vertex):
    """Mean of the triangles at a vertex, into the body."""
    x, corners = dataset.vertices(), dataset.triangles()
    total = [0.0, 0.0, 0.0]
    for t in range(0, len(corners), 3):
        triangle = corners[t:t + 3]
        if vertex not in triangle:
            continue
        p, q, r = ([x[3 * c + i] for i in range(3)] for c in triangle)
        a, b = [q[i] - p[i] for i in range(3)], [r[i] - p[i] for i in range(3)]
        for i in range(3):
            j, k = (i + 1) % 3, (i + 2) % 3
            total[i] -= a[j] * b[k] - a[k] * b[j]
    length = math.sqrt(sum(c * c for c in total))
    return [c / length for c in total]


def main(file, depth):
    with palpate.Dataset(file) as dataset, dataset.contact() as contact, palpate.Guard("touch") as guard:
        space = dataset.space(0)
        inward = inward_normal(dataset, space.vertex)
        displacement = [depth * c for c in inward]
        sample = dataset.query(0, displacement)
        print("query", space.name.decode(), *map(repr, displacement), "force", *map(repr, sample.force),
              "inside", sample.inside)
        print("#    depth mm      force on the tool, N                  guards")
        for tick in range(TICKS):
            d = depth * 0.5 * (1 - math.cos(2 * math.pi * tick / TICKS)) - 2e-4
            tool = [space.rest_position[i] + d * inward[i] for i in range(3)]
            touch = contact.update(tool)
            force = guard.limit(tool, touch)
            if tick % TICKS_PER_LINE == 0:
                print(f"{1e3 * d:12.4f}  {force.force[0]:10.5f} {force.force[1]:10.5f} {force.force[2]:10.5f} ",
                      "touching" if touch.touching else "", *force.why())


if __name__ == "__main__":
    if len(sys.argv) < 2:
        sys.exit("usage: touch.py DATASET.h5 [DEPTH_MM]")
    main(sys.argv[1], 1e-3 * float(sys.argv[2] if len(sys.argv) > 2 else 5))
