"""A reduced-order model: proper orthogonal decomposition of the configurations, Galerkin projection, and Newton in the modes.

z = S p + Phi a: S the sensitivities at rest, so that without modes it is the linear body; Phi the first modes of the
remainder of the configurations. Modes of the displacement are orthonormal in the H1 seminorm (integral of grad u : grad
v), those of the pressure in L2. A pressure mode that no displacement mode balances makes the reduced saddle singular, so
each has a *supremizer*: the displacement on which it does most work (Rozza and Veroy 2007; Ballarin et al. 2015), by the
coupling at rest.

The force is minus the slope of the reduced Lagrangian along p, so it is conservative. The whole body is assembled in
every iteration (no hyper-reduction), as in the first phase of SOFA's ModelOrderReduction; `sampled.py` continues from
there."""
import dataclasses

import numpy as np
import scipy.linalg
import scipy.sparse

from peers import body, equilibrium


@dataclasses.dataclass
class Snapshots:
    """Data for bases of any number of modes, computed once."""
    lift: np.ndarray           # n x 3: dz/dp at rest
    displacement: np.ndarray   # modes as columns, most important first, of z's displacements
    pressure: np.ndarray       # likewise of z's pressures
    supremizers: np.ndarray    # one for each pressure mode
    u_spectrum: np.ndarray     # their singular values
    p_spectrum: np.ndarray
    states: np.ndarray         # L x n: z of the configurations
    places: np.ndarray         # L x 3
    grad_inner: object         # sparse, of displacements
    mass: np.ndarray           # lumped, of pressures, m^3


def inner_products(some_body):
    """Returns (integral of grad u : grad v for free displacements, lumped mass of the nodes)."""
    M, nodes = some_body.tetrahedra, len(some_body.points)
    weights = some_body.volume[:, None, None] * (some_body.gradients @ some_body.gradients.transpose(0, 2, 1))
    row, column = np.repeat(M, 4, axis=1).ravel(), np.tile(M, 4).ravel()
    scalar = scipy.sparse.csr_matrix((weights.ravel(), (row, column)), shape=(nodes, nodes))
    free = scalar[some_body.free][:, some_body.free]
    mass = np.bincount(M.ravel(), np.repeat(some_body.volume / 4, 4), nodes)
    return scipy.sparse.kron(free, scipy.sparse.identity(3), format="csc"), mass


def principal(columns, inner):
    """Modes (orthonormal under inner @) and singular values of snapshots in columns, by the method of snapshots."""
    gram = columns.T @ (inner @ columns)
    values, vectors = np.linalg.eigh((gram + gram.T) / 2)
    keep = np.flatnonzero(values > 1e-13 * values[-1])[::-1]
    return columns @ (vectors[:, keep] / np.sqrt(values[keep])), np.sqrt(values[keep])


def orthonormal(columns, inner):
    """Gram-Schmidt, twice; columns that depend on earlier ones are left out."""
    made = np.empty((len(columns), 0))
    for column in columns.T:
        length = np.sqrt(column @ (inner @ column))
        for _ in range(2):
            column = column - made @ (made.T @ (inner @ column))
        left = np.sqrt(max(column @ (inner @ column), 0))
        if left > 1e-8 * length:
            made = np.column_stack([made, column / left])
    return made


def snapshots(some_body, configurations):
    """Snapshots of the configurations; the first one is the rest state."""
    rest = some_body.assemble(np.zeros(some_body.size), np.zeros(3))
    lift = body.sensitivity(rest)
    states = np.array([some_body.state(u, p) for u, p in zip(configurations.displacement, configurations.pressure)])
    rise = (states - configurations.place @ lift.T).T
    n = some_body.displacements
    grad_inner, mass = inner_products(some_body)
    u_modes, u_spectrum = principal(rise[:n], grad_inner)
    p_modes, p_spectrum = principal(rise[n:], scipy.sparse.diags(mass))
    return Snapshots(lift, u_modes, p_modes, supremizers(some_body, p_modes, grad_inner), u_spectrum, p_spectrum, states,
                     configurations.place, grad_inner, mass)


def supremizers(some_body, p_modes, grad_inner, most=60):
    """Returns one for each of the first pressure modes psi: A s = B^T psi, A the H1 seminorm, B the coupling at rest."""
    n, factors = some_body.displacements, body.Factors(grad_inner)
    at_rest = some_body.assemble(np.zeros(some_body.size), np.zeros(3)).tangent[:n, n:]
    return factors.solve(at_rest @ p_modes[:, :most])


class Galerkin:
    """The common part of all reduced models, with size, made, coordinates, assemble and admissible."""

    tolerance = equilibrium.TOLERANCE

    def factors(self, assembled):
        return Dense(assembled.tangent)

    def sensitivity(self, assembled, factors):
        return -factors.solve(assembled.coupling)

    def at_rest(self):
        return equilibrium.newton(self, np.zeros(self.size), np.zeros(3))


class Reduced(Galerkin):
    """A model with `modes` displacement modes, `pressures` pressure modes and their supremizers."""

    def __init__(self, some_body, made, modes, pressures=None, supremized=True):
        self.body, self.made = some_body, made
        pressures = min(modes if pressures is None else pressures, made.pressure.shape[1])
        self.modes, self.pressures = min(modes, made.displacement.shape[1]), pressures
        u = made.displacement[:, :self.modes]
        if supremized:
            u = orthonormal(np.column_stack([u, made.supremizers[:, :pressures]]), made.grad_inner)
        q = made.pressure[:, :pressures]
        self.columns = u.shape[1], q.shape[1]
        self.scale = np.concatenate([np.abs(u).max(axis=0), np.abs(q).max(axis=0)])
        # Coordinates are the displacement of a mode's largest entry, m, so that a residual is in newtons, as for the whole
        # body.
        self.basis = scipy.linalg.block_diag(u, q) / self.scale
        self.size = self.basis.shape[1]
        rise, n = (made.states - made.places @ made.lift.T).T, some_body.displacements
        self.coordinates = (self.scale[:, None] * np.vstack([u.T @ (made.grad_inner @ rise[:n]), q.T @ (made.mass[:, None] * rise[n:])])).T

    def whole(self, a, p):
        return self.made.lift @ p + self.basis @ a

    def assemble(self, a, p):
        full = self.body.assemble(self.whole(a, p), p)
        Phi, S = self.basis, self.made.lift
        KPhi, KS = full.tangent @ Phi, full.tangent @ S
        coupled = KS + full.coupling
        return body.Assembled(full.energy, Phi.T @ full.residual, full.force - S.T @ full.residual, Phi.T @ KPhi, Phi.T @ coupled,
                              full.tool + full.coupling.T @ S + S.T @ coupled)

    def admissible(self, a, p):
        return self.body.admissible(self.whole(a, p), p)

    def memory(self):
        """Bytes that an answer reads: modes without the zeros between displacement and pressure, sensitivities, starting
        coordinates, and gradients, volumes and corners of all elements."""
        of_u, of_q = self.columns
        rows = self.body.displacements, self.body.size - self.body.displacements
        elements = self.body.gradients.nbytes + self.body.volume.nbytes + 4 * self.body.tetrahedra.size
        return 8 * (rows[0] * of_u + rows[1] * of_q) + self.made.lift.nbytes + self.coordinates.nbytes + elements

    def memory_with_shape(self):
        return self.memory()  # includes all rows of the displacement


class Dense:
    def __init__(self, tangent):
        self.tangent = tangent

    def solve(self, right):
        return np.linalg.solve(self.tangent, right)


def answer(model, p, rest):
    """Without an earlier answer: from the nearest configuration, otherwise along paths ever closer to that from rest.
    None without a solution."""
    for start in starts(model, p):
        reached = equilibrium.transition(model, start, p)
        if reached is not None:
            return reached
    return equilibrium.transition(model, rest, p)


def starts(model, p, most=4):
    """Returns equilibria of the model at the configurations nearest to p."""
    for n in np.argsort(np.linalg.norm(model.made.places - p, axis=1))[:most]:
        start = equilibrium.newton(model, model.coordinates[n], model.made.places[n])
        if start is not None:
            yield start


def followed(model, p, rest):
    """The force after a hand has come from the nearest configuration, with old tangents; otherwise that of answer(); None
    without one."""
    for start in starts(model, p):
        force = equilibrium.Follower(model, start).walk(p)
        if force is not None:
            return force
    reached = answer(model, p, rest)
    return reached and reached.force
