#!/usr/bin/env python3
"""A robot finger maps the stiffness of a flat surface. It presses at 5 x 5 places, and measures force and depth in its joints only.

    robot_map.py DATASET.h5 FIGURE.png X Y Z [SPACING_MM [DEPTH_MM]]

X Y Z is the middle place, m. Needs python3-dartpy, python3-matplotlib and the package of docs/python.md.
"""

import sys

import matplotlib
import numpy as np

import palpate
from palpation import START, STEP, Robot, palpate_with

matplotlib.use("Agg")
import matplotlib.pyplot as plt

MOVE, PRESS = 0.3, 0.5  # s, to the next place, and until the force is measured


def path_over(places, depth):
    """Returns the targets of the tip: above a place, down, up, above the next place."""
    blend = 0.5 * (1 - np.cos(np.pi * np.linspace(0, 1, round(MOVE / STEP))))[:, None]
    last, path = np.array([0, 0, START]), []
    for x, y in places:
        above, below = np.array([x, y, START]), np.array([x, y, -depth])
        path += [last + blend * (above - last), above + blend * (below - above), np.tile(below, (round(PRESS / STEP), 1)),
                 below + blend * (above - below)]
        last = above
    return np.concatenate(path)


def main(file, figure, place, spacing, depth):
    grid = spacing * np.arange(-2, 3)
    places = [(x, y) for y in grid for x in grid]
    path = path_over(places, depth)
    count = len(path) // len(places)
    measured = round((2 * MOVE + PRESS) / STEP) - 1  # the last step before the finger rises
    stiffness = [estimate[2] / -felt.point[2] for step, (felt, estimate) in
                 enumerate(palpate_with(Robot(), palpate.Dataset(file), place, path)) if step % count == measured]
    for (x, y), k in zip(places, stiffness):
        print(f"{1e3 * x:7.1f} {1e3 * y:7.1f} mm  {k:8.2f} N/m")
    drawn = plt.pcolormesh(1e3 * grid, 1e3 * grid, np.reshape(stiffness, (5, 5)), shading="nearest")
    plt.colorbar(drawn, label="stiffness, N/m")
    plt.xlabel("x, mm")
    plt.ylabel("y, mm")
    plt.gca().set_aspect("equal")
    plt.savefig(figure, dpi=120)


if __name__ == "__main__":
    if len(sys.argv) not in (6, 7, 8):
        sys.exit("usage: robot_map.py DATASET.h5 FIGURE.png X Y Z [SPACING_MM [DEPTH_MM]]")
    spacing_mm, depth_mm = (float(word) for word in (sys.argv[6:] + ["8", "3"][len(sys.argv) - 6:]))
    main(sys.argv[1], sys.argv[2], [float(word) for word in sys.argv[3:6]], 1e-3 * spacing_mm, 1e-3 * depth_mm)
