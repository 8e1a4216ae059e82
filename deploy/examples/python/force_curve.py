#!/usr/bin/env python3
"""Plots the force of a tool along a straight line from rest, with its error bound and the solved points.

    force_curve.py DATASET.h5 FIGURE.svg [ACTIVE [X Y Z]]

X Y Z is the direction; by default the line goes through the point with the largest solved force.
"""

import sys

import matplotlib

matplotlib.use("Agg")  # draws to a file, without a window
import matplotlib.pyplot as plt
import numpy as np

import palpate


def main(file, figure, active=None, *direction):
    dataset = palpate.Dataset(file)
    arrays = palpate.Arrays(file)
    space = arrays[active or arrays.names[0]]
    if direction:
        way = np.array([float(component) for component in direction])
    else:
        way = space.position[np.nanargmax(np.linalg.norm(space.force, axis=1))]
    way = way / np.linalg.norm(way)
    radius = next(s.workspace_radius for s in dataset.spaces if s.name == space.name)

    depth = np.linspace(0, radius, 400)
    answers = dataset.query(depth[:, None] * way, active=space.name)
    force = np.linalg.norm(answers.force, axis=1)
    print(f"{space.name}: {force[answers.inside].max():.3f} N at most, {answers.inside.mean():.0%} of the path inside")

    # the lattice points on the line, which determine the curve
    along = space.position @ way
    on_way = space.solved & (along >= 0) & (np.linalg.norm(space.position - along[:, None] * way, axis=1) < 1e-9)

    axes = plt.figure(figsize=(6, 4)).add_subplot()
    axes.fill_between(1e3 * depth, force - answers.error_bound, force + answers.error_bound, alpha=0.3, label="error bound (99 %)")
    axes.plot(1e3 * depth, force, label="interpolated")
    axes.plot(1e3 * along[on_way], np.linalg.norm(space.force[on_way], axis=1), "k.", label="solved")
    axes.set(xlabel="displacement, mm", ylabel="force, N", title=f"{dataset.name}, {space.name}")
    axes.legend()
    plt.savefig(figure)


if __name__ == "__main__":
    if len(sys.argv) not in (3, 4, 7):
        sys.exit("usage: force_curve.py DATASET.h5 FIGURE.svg [ACTIVE [X Y Z]]")
    main(*sys.argv[1:])
