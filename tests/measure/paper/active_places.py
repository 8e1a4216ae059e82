"""The active nodes of the paper's curves and pictures (Figs. 5 and 6), and exact solutions along straight paths from
there."""
import dataclasses
import json

import organs
from record import needed

DRAWN_LAWS = ("linear", "svk", "mr")  # in both figures


@dataclasses.dataclass(frozen=True)
class Place:
    node: tuple     # m, at rest
    outward: tuple  # unit normal of the surface


def body(record, organ):
    """Points (n x 3, m), outward triangles, and fixed nodes of a dataset of seven configurations."""
    needed("h5py")
    import h5py
    dataset = record.dataset(f"{organ.name}-body", organs.scene(organ, "linear", radius=0.001, divisions=1))
    with h5py.File(dataset.value["dataset"]) as file:
        return file["mesh/points"][:], file["mesh/surface"][:], file["mesh/fixed_nodes"][:]


def place(points, surface, node):
    numpy = needed("numpy")
    around = points[surface[(surface == node).any(1)]]
    normal = numpy.cross(around[:, 1] - around[:, 0], around[:, 2] - around[:, 0]).sum(0)
    return Place(tuple(map(float, points[node])), tuple(map(float, normal / numpy.linalg.norm(normal))))


def places(record, organ):
    """A is the organ's tip; F is the surface node farthest from it and from the fixed nodes."""
    numpy = needed("numpy")
    points, surface, fixed = body(record, organ)
    skin = numpy.setdiff1d(numpy.unique(surface), fixed)
    distance = lambda others: numpy.linalg.norm(points[skin][:, None] - points[others][None], axis=2).min(1)
    tip = skin[numpy.linalg.norm(points[skin] - organ.tip, axis=1).argmin()]
    far = skin[numpy.minimum(distance(numpy.array([tip])), distance(fixed)).argmax()]
    return {"A": place(points, surface, tip), "F": place(points, surface, far)}


def scene_at(organ, law, where, **options):
    """The linear law has no limit at inverted elements, so they are accepted and counted."""
    scene = organs.scene(organ, law, active=f"near = [{', '.join(map(repr, where.node))}]", **options)
    return scene.replace("[workspace]\n", "[workspace]\nreject_inverted = false\n") if law == "linear" else scene


def straight_path(record, name, organ, law, where, direction, length, step_length):
    """The exact solutions from rest along a straight path, as far as they converge."""
    count = round(length / step_length)
    file = record.scene(name, scene_at(organ, law, where))
    path = [[length * n / count * x for x in direction] for n in range(1, count + 1)]
    measured = record.run(f"path {name}", [record.bench / "palpate_path_forces", file, "--active", "tip"], json.dumps([path]))
    return measured, count
