#!/usr/bin/env python3
"""Plots the stiffness of a body at all places that a finger can touch, in N/mm, at a depth of DEPTH_MM.

    stiffness_map.py DATASET.h5 FIGURE.png [DEPTH_MM]
"""

import sys

import matplotlib

matplotlib.use("Agg")  # draws to a file, without a window
import matplotlib.pyplot as plt
import numpy as np
from mpl_toolkits.mplot3d.art3d import Poly3DCollection

import palpate


def main(file, figure, depth):
    dataset = palpate.Dataset(file)
    if not dataset.areas:
        sys.exit(f"{file}: the dataset has no surface that a finger can touch; force_curve.py plots active nodes")
    corners = dataset.vertices[dataset.triangles]
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)

    # Press every triangle at its centroid, in one call.
    answers = dataset.query(-depth * normals, at=corners.mean(axis=1), active=0)
    stiffness = np.einsum("ni,ni->n", answers.force, normals) / depth / 1e3
    felt = dataset.touchable & answers.inside
    if not felt.any():
        sys.exit(f"{file}: no place was solved {1e3 * depth:g} mm deep; use a smaller DEPTH_MM")
    print(f"{np.count_nonzero(felt)} places, {stiffness[felt].min():.3f} to {stiffness[felt].max():.3f} N/mm")

    colours = plt.get_cmap("viridis")(plt.Normalize(0, stiffness[felt].max())(stiffness))
    colours[~felt] = (0.8, 0.8, 0.8, 1)
    axes = plt.figure(figsize=(7, 5)).add_subplot(projection="3d")
    axes.add_collection3d(Poly3DCollection(1e3 * corners, facecolors=colours))
    lowest, highest = 1e3 * dataset.vertices.min(axis=0), 1e3 * dataset.vertices.max(axis=0)
    axes.set(xlim=(lowest[0], highest[0]), ylim=(lowest[1], highest[1]), zlim=(lowest[2], highest[2]), xlabel="mm",
             title=f"{dataset.name}: a finger of {1e3 * dataset.areas[0].finger_radius:g} mm, {1e3 * depth:g} mm deep")
    axes.set_box_aspect(highest - lowest)
    scale = plt.cm.ScalarMappable(plt.Normalize(0, stiffness[felt].max()), "viridis")
    plt.colorbar(scale, ax=axes, label="N/mm; grey: not touchable", shrink=0.7)
    plt.savefig(figure, dpi=120)


if __name__ == "__main__":
    if len(sys.argv) < 3:
        sys.exit("usage: stiffness_map.py DATASET.h5 FIGURE.png [DEPTH_MM]")
    main(sys.argv[1], sys.argv[2], 1e-3 * float(sys.argv[3] if len(sys.argv) > 3 else 5))
