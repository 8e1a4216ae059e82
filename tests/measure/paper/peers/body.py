"""An independent implementation of docs/solver.md in NumPy: P1 displacement, P1 pressure with polynomial pressure
projection, a rigid tool. The peers are made of it, and it is compared with datasets.

A *state* is z, the unknowns (n): displacements of the free nodes (m), then scaled pressures q of all nodes, p = (mu/h) q
(Pa), h the mean edge length. Together with the displacement of the tool (3, m) it is a configuration. Residuals are in
newtons."""
import dataclasses

import numpy as np
import scipy.sparse
import scipy.sparse.linalg

STABILISATION = 1.0  # alpha
# <(p - <p>)^2> = p^T VARIANCE p of the four nodal pressures of an element.
VARIANCE = (np.ones((4, 4)) + np.eye(4)) / 20 - 1 / 16


@dataclasses.dataclass
class Assembled:
    energy: float            # L, J
    residual: np.ndarray     # n: dL/dz
    force: np.ndarray        # 3, N: of the tissue on the tool, with z constant
    tangent: object = None   # n x n, CSC: d2L/dz2
    coupling: np.ndarray = None  # n x 3: d2L/dz dp
    tool: np.ndarray = None  # 3 x 3: d2L/dp2


class Body:
    """points: N x 3, m. tetrahedra: M x 4. fixed and tool: node numbers; the tool's nodes move together."""

    def __init__(self, points, tetrahedra, fixed, tool, law):
        self.points, self.tetrahedra, self.law = np.asarray(points, float), np.asarray(tetrahedra), law
        corners = self.points[self.tetrahedra]
        edges = np.swapaxes(corners[:, 1:] - corners[:, :1], 1, 2)  # columns
        self.volume = np.linalg.det(edges) / 6
        if (self.volume <= 0).any():
            raise ValueError(f"tetrahedron {int(self.volume.argmin())} has a volume of {self.volume.min()} m^3")
        last = np.linalg.inv(edges)
        self.gradients = np.concatenate([-last.sum(axis=1, keepdims=True), last], axis=1)  # M x 4 x 3, 1/m
        pairs = np.sort(self.tetrahedra[:, [[0, 1], [0, 2], [0, 3], [1, 2], [1, 3], [2, 3]]].reshape(-1, 2), axis=1)
        ends = self.points[np.unique(pairs, axis=0)]
        self.pressure_scale = law.shear_modulus / np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1).mean()  # Pa
        self.number(np.asarray(fixed), np.asarray(tool))

    def number(self, fixed, tool):
        """slot: the index of each displacement component and pressure, N x 4, in (z, tool); fixed ones share a last one."""
        nodes = len(self.points)
        self.free = np.setdiff1d(np.arange(nodes), np.concatenate([fixed, tool]))
        self.tool_nodes, self.displacements = tool, 3 * len(self.free)
        self.size = self.displacements + nodes
        self.slot = np.full((nodes, 4), self.size + 3)
        self.slot[self.free, :3] = np.arange(self.displacements).reshape(-1, 3)
        self.slot[tool, :3] = self.size + np.arange(3)
        self.slot[:, 3] = self.displacements + np.arange(nodes)
        self.element_slot = self.slot[self.tetrahedra].reshape(-1, 16)
        row, column = (np.broadcast_to(part, (len(self.tetrahedra), 16, 16)).ravel()
                       for part in (self.element_slot[:, :, None], self.element_slot[:, None, :]))
        entry, self.entry_of = np.unique(row.astype(np.int64) * (self.size + 4) + column, return_inverse=True)
        self.rows, self.columns = entry // (self.size + 4), entry % (self.size + 4)

    # Conversion between states and nodal fields

    def fields(self, z, p):
        """Returns displacements (N x 3, m) and scaled pressures (N)."""
        u = np.concatenate([z, p, [0.0]])[self.slot[:, :3]]
        return u, z[self.displacements:]

    def state(self, displacement, pressure):
        """The state of nodal displacements (N x 3, m) and pressures (N, Pa)."""
        return np.concatenate([displacement[self.free].ravel(), pressure / self.pressure_scale]).astype(float)

    def deformation(self, z, p):
        u, _ = self.fields(z, p)
        return np.eye(3) + np.swapaxes(u[self.tetrahedra], 1, 2) @ self.gradients

    # The Lagrangian

    def elements(self, z, p, tangent=True):
        """For all elements, see element_sums."""
        _, q = self.fields(z, p)
        return element_sums(self.law, self.deformation(z, p), q[self.tetrahedra], self.gradients, self.volume, self.pressure_scale, tangent)

    def assemble(self, z, p, tangent=True):
        energy, residual, K = self.elements(z, p, tangent)
        r = np.bincount(self.element_slot.ravel(), residual.ravel(), self.size + 4)
        n = self.size
        made = Assembled(float(energy.sum()), r[:n], -r[n:n + 3])
        if tangent:
            values = np.bincount(self.entry_of, K.ravel(), len(self.rows))
            whole = scipy.sparse.csc_matrix((values, (self.rows, self.columns)), shape=(n + 4, n + 4))
            made.tangent = whole[:n, :n]
            right = whole[:, n:n + 3].toarray()
            made.coupling, made.tool = right[:n], right[n:n + 3]
        return made

    def admissible(self, z, p):
        return self.law.admissible(self.deformation(z, p))


def element_sums(law, F, q, gradients, volume, pressure_scale, tangent=True):
    """Returns energy (M), residual (M x 16) and tangent (M x 16 x 16; None without `tangent`) of elements. The order is x, y, z,
    q of the first node, and so on. F: M x 3 x 3, q: M x 4, gradients of the shape functions: M x 4 x 3."""
    V, D, scale = volume, gradients, pressure_scale
    density = law.at(F, scale * q.mean(axis=1), tangent)
    stiff = STABILISATION * scale**2 / law.shear_modulus
    spread = q @ VARIANCE
    residual = np.empty((len(V), 4, 4))
    residual[:, :, :3] = D @ density.stress.transpose(0, 2, 1)
    residual[:, :, 3] = -scale / 4 * density.constraint[:, None] - stiff * spread
    energy = V * (density.energy - 0.5 * stiff * (spread * q).sum(axis=1))
    residual = residual.reshape(-1, 16) * V[:, None]
    if not tangent:
        return energy, residual, None
    K = np.empty((len(V), 4, 4, 4, 4))
    right = (density.tangent.reshape(-1, 27, 3) @ D.transpose(0, 2, 1)).reshape(-1, 3, 3, 3, 4)  # i j k, node b
    K[:, :, :3, :, :3] = (D @ right.transpose(0, 2, 1, 3, 4).reshape(-1, 3, 36)).reshape(-1, 4, 3, 3, 4).transpose(0, 1, 2, 4, 3)
    coupling = -scale / 4 * (D @ density.constraint_slope.transpose(0, 2, 1))  # the same for each of the four pressures
    K[:, :, :3, :, 3] = coupling[:, :, :, None]
    K[:, :, 3, :, :3] = coupling[:, None]
    K[:, :, 3, :, 3] = -stiff * VARIANCE
    return energy, residual, K.reshape(-1, 16, 16) * V[:, None, None]


class Factors:
    """Factors of a symmetric tangent."""

    def __init__(self, tangent):
        self.factors = scipy.sparse.linalg.splu(tangent, permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=1e-3,
                                                      options={"SymmetricMode": True})

    def solve(self, right):
        return self.factors.solve(np.asarray(right))


def sensitivity(assembled, factors=None):
    """Returns dz/dp, n x 3."""
    return -(factors or Factors(assembled.tangent)).solve(assembled.coupling)


def stiffness(assembled, slope):
    """dforce/dp, 3 x 3, N/m, from dz/dp."""
    return -(assembled.tool + assembled.coupling.T @ slope)
