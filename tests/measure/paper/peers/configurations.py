"""The input of every peer, the solved lattice points of a dataset; and the probes, which no peer may see before it
answers."""
import dataclasses

import references
from record import needed

np = needed("numpy")

from peers import body, laws


@dataclasses.dataclass
class Configurations:
    identity: str          # hash of the dataset's contents
    points: object         # N x 3, m
    tetrahedra: object     # M x 4
    fixed: object          # node numbers
    tool: object
    spacing: float         # m
    radius: float          # m, radius of the ball
    place: object          # L x 3, m: displacement of the tool; the first is rest
    force: object          # L x 3, N: tissue on tool
    stiffness: object      # L x 3 x 3, N/m
    energy: object         # L, J
    displacement: object   # L x N x 3, m, float32
    pressure: object       # L x N, Pa, float32
    unsolved: int          # number of unsolved lattice points
    probe_place: object    # R x 3
    probe_force: object    # R x 3
    probe_energy: object   # R
    probes_unsolved: int

    def body(self, law):
        return body.Body(self.points, self.tetrahedra, self.fixed, self.tool, law)


def read(path, node_fields=True):
    """Reads the first active node of a dataset with [storage] displacement = "all"."""
    h5py = needed("h5py")
    with h5py.File(path) as file:
        points, probes, spaces = file["points"], file["probes"], file["spaces"]
        rows = slice(*spaces["first_point"][:2])
        solved = np.isin(points["tag"][rows], (1, 2))
        of = lambda name: points[name][rows][solved] if node_fields or name not in ("displacement", "pressure") else None
        tested = slice(*spaces["first_probe"][:2])
        right = np.isin(probes["tag"][tested], (1, 2))
        return Configurations(
            file.attrs["content_hash"].decode(), *(file["mesh"][name][:] for name in ("points", "tetrahedra", "fixed_nodes")),
            file["patches/node"][slice(*spaces["first_patch_node"][:2])], float(points.attrs["spacing"]), float(points.attrs["radius"]),
            *(of(name) for name in ("position", "force", "stiffness", "energy", "displacement", "pressure")), int((~solved).sum()),
            *(probes[name][tested][right] for name in ("position", "force", "energy")), int((~right).sum()))


def mooney_rivlin():
    import organs
    return laws.MooneyRivlin(organs.C10, organs.C01)


def errors(force, exact):
    """Errors of answered forces, n x 3, NaN without an answer: {mean, median, p95, worst (N), relative_p95 (%, of |error|
    / max(|F|, references.FLOOR)), in_target (% of all, within 3 % or 10 mN, as in `palpate report`), unanswered}."""
    length = np.linalg.norm(np.asarray(force, float) - exact, axis=1)
    answered = np.isfinite(length)
    if not answered.any():
        return {"mean": None, "median": None, "p95": None, "worst": None, "relative_p95": None, "in_target": 0.0,
                "unanswered": int(len(length))}
    in_target = 100 * float((length <= np.maximum(0.03 * np.linalg.norm(exact, axis=1), 0.01)).mean())
    relative = 100 * length / np.maximum(np.linalg.norm(exact, axis=1), references.FLOOR)
    length, relative = length[answered], relative[answered]
    return {"mean": float(length.mean()), "median": float(np.median(length)), "p95": float(np.percentile(length, 95)),
            "worst": float(length.max()), "relative_p95": float(np.percentile(relative, 95)), "in_target": in_target,
            "unanswered": int((~answered).sum())}
