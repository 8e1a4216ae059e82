#!/usr/bin/env python3
"""Presses a tool into a body, step by step, and prints the forces. The first line is a query without contact.

    touch.py DATASET.h5 [DEPTH_MM]
"""

import sys

import numpy as np

import palpate

TICKS, TICKS_PER_LINE = 400, 40


def inward_normal(dataset, vertex):
    """Returns the mean unit normal of the triangles at a vertex, pointing into the body."""
    a, b, c = dataset.vertices[dataset.triangles[(dataset.triangles == vertex).any(axis=1)]].transpose(1, 0, 2)
    normal = -np.cross(b - a, c - a).sum(axis=0)
    return normal / np.linalg.norm(normal)


def main(file, depth):
    options = palpate.Guard.defaults("touch")
    with palpate.Dataset(file) as dataset, palpate.Contact(dataset) as contact, palpate.Guard(options) as guard:
        space = dataset.spaces[0]
        inward = inward_normal(dataset, space.vertex)
        displacement = depth * inward
        answer = dataset.query(displacement, active=space.name)
        print("query", space.name, *displacement.tolist(), "force", *answer.force.tolist(), "inside", bool(answer.inside))
        print("#    depth mm      force on the tool, N                  guards")
        for tick in range(TICKS):
            d = depth * 0.5 * (1 - np.cos(2 * np.pi * tick / TICKS)) - 2e-4
            tool = space.rest_position + d * inward
            touch = contact.update(tool)
            force = guard.limit(tool, touch)
            if tick % TICKS_PER_LINE == 0:
                print(f"{1e3 * d:12.4f}  " + " ".join(f"{component:10.5f}" for component in force.force),
                      " touching" if touch.touching else "", *force.guards)


if __name__ == "__main__":
    if len(sys.argv) < 2:
        sys.exit("usage: touch.py DATASET.h5 [DEPTH_MM]")
    main(sys.argv[1], 1e-3 * float(sys.argv[2] if len(sys.argv) > 2 else 5))
