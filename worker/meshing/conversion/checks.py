"""Checks and repairs of a mesh before it is written."""
import numpy as np

from body import EDGES, GMSH_ORDER, TETGEN_ORDER, WRITTEN, counted, wrong

# Node orders that files of other formats use by mistake.
ORDERS = {"Gmsh": GMSH_ORDER, "TetGen": TETGEN_ORDER}
COINCIDENT = 1e-6  # relative to the diagonal, as in common/mesh/mesh.hpp
STRAIGHT = 1e-6  # relative to the edge's length, as in common/mesh/mesh.cpp
ROUNDED = 2e-6  # error of a midpoint written with six digits or as float32, relative to the largest coordinate


def check_points(body, source):
    if body.points.shape[1] < 3:
        wrong(source, None, f"its points have only {body.points.shape[1]} coordinates; a plane mesh has no volume")
    body.points = np.ascontiguousarray(body.points[:, :3])
    bad = np.flatnonzero(~np.isfinite(body.points).all(axis=1))
    if len(bad):
        wrong(source, None, f"point {bad[0]} (counted from 0) has a coordinate that is not finite")
    for kind, nodes in body.blocks:
        flat = nodes.reshape(-1)
        if len(flat) and (flat.min() < 0 or flat.max() >= len(body.points)):
            wrong(source, None, f"a cell ({kind}) uses point {flat.min() if flat.min() < 0 else flat.max()} (counted "
                                f"from 0), but there are {len(body.points)} points")


def weld(body):
    """Merges points at the same place into the one with the lowest number."""
    used = np.unique(np.concatenate([nodes.reshape(-1) for _, nodes in body.blocks]))
    points = body.points[used]
    near = COINCIDENT * np.linalg.norm(np.ptp(points, axis=0))
    # Sort the points along a direction in which the points of a regular mesh have different positions.
    position = points @ np.array([0.5129, 0.6427, 0.5691]) / np.linalg.norm([0.5129, 0.6427, 0.5691])
    order = np.argsort(position)
    lowest = np.arange(len(points))
    pairs = []
    for step in range(1, len(order)):
        first, second = order[:-step], order[step:]
        close = position[second] - position[first] <= near
        if not close.any():
            break
        close &= np.linalg.norm(points[second] - points[first], axis=1) <= near
        pairs.append(np.stack([first[close], second[close]]))
    first, second = np.concatenate(pairs, axis=1) if pairs else np.zeros((2, 0), dtype=int)
    while (lowest[first] != lowest[second]).any():  # until chains of close points are merged too
        least = np.minimum(lowest[first], lowest[second])
        np.minimum.at(lowest, first, least)
        np.minimum.at(lowest, second, least)
    count = np.count_nonzero(lowest != np.arange(len(points)))
    body.notes.append(f"merged: {counted(count, 'node')} that coincided with others")
    same_as = np.arange(len(body.points))
    same_as[used] = used[lowest]
    body.blocks = [(kind, same_as[nodes]) for kind, nodes in body.blocks]
    body.point_groups = {name: same_as[np.asarray(nodes, dtype=np.int64)] for name, nodes in body.point_groups.items()}


def off_middle(points, cells):
    """Returns the distances of mid-edge nodes from the middles, and their limits for straight edges: n x 6, in edge lengths."""
    off, straight = np.empty((len(cells), 6)), np.empty((len(cells), 6))
    rounding = ROUNDED * np.abs(points).max()
    for e, (a, b) in enumerate(EDGES):
        p, q = points[cells[:, a]], points[cells[:, b]]
        length = np.maximum(np.linalg.norm(q - p, axis=1), 1e-300)
        off[:, e] = np.linalg.norm(points[cells[:, 4 + e]] - (p + q) / 2, axis=1) / length
        straight[:, e] = np.maximum(STRAIGHT, rounding / length)
    return off, straight


def put_middles_right(body, source, straight):
    """Makes every tetrahedron straight: ten nodes in VTK's order, or four nodes."""
    for i, (kind, cells) in enumerate(body.blocks):
        if kind != "tetra10" or not len(cells):
            continue
        off, allowed = off_middle(body.points, cells)
        if (off > allowed).any():
            for name, order in ORDERS.items():
                other, allowed_there = off_middle(body.points, cells[:, order])
                if (other <= allowed_there).all():
                    body.notes.append(f"the mid-edge nodes of its tetrahedra were in {name}'s order; they were reordered")
                    cells, off, allowed = cells[:, order], other, allowed_there
                    break
        if (off <= allowed).all():
            if off.max() > STRAIGHT:
                body.notes.append(f"mid-edge nodes were rounded by up to {off.max():.2g} edge lengths; they were moved "
                                  "to the middles")
                for e, (a, b) in enumerate(EDGES):
                    body.points[cells[:, 4 + e]] = (body.points[cells[:, a]] + body.points[cells[:, b]]) / 2
            body.blocks[i] = (kind, cells)
        elif straight:
            body.notes.append(f"mid-edge nodes lie up to {off.max():.2g} edge lengths away from the middles; "
                              "only the corners are used, with straight edges")
            body.blocks[i] = ("tetra", cells[:, :4])
        else:
            at, e = np.unravel_index(off.argmax(), off.shape)
            middle = body.points[cells[at, list(EDGES[e])]].mean(axis=0)
            wrong(source, None, f"tetrahedron {at} of ten nodes (counted from 0) has a curved edge at "
                                f"({middle[0]:.6g}, {middle[1]:.6g}, {middle[2]:.6g}): its mid-edge node is "
                                f"{off.max():.2g} edge lengths away from the middle. In all tetrahedra, "
                                f"{np.count_nonzero(off > allowed)} edges are curved; "
                                "--straight uses only the corners, with straight edges")


def refuse_other_volumes(body, source):
    counts = {}
    for kind, cells in body.blocks:
        volume = kind.startswith(("hexa", "wedge", "pyramid", "penta", "polyhedron", "voxel", "tetra", "VTK_LAGRANGE_H",
                                  "VTK_LAGRANGE_T", "VTK_LAGRANGE_W", "VTK_LAGRANGE_P"))
        if volume and kind not in WRITTEN and kind != "VTK_LAGRANGE_TRIANGLE" and len(cells):
            counts[kind] = counts.get(kind, 0) + len(cells)
    if counts:
        found = ", ".join(f"{count} of kind {kind}" for kind, count in sorted(counts.items()))
        wrong(source, None, f"it has volume cells that are not tetrahedra of 4 or 10 nodes: {found}; mesh the body with "
                            "tetrahedra, or save its surface as .stl and convert that")
