"""Hyper-reduction of a reduced model: energy-conserving sampling and weighting (ECSW; Farhat et al. 2014, 2015), the
method of SOFA's ModelOrderReduction. A few elements with non-negative weights replace all: the sampled Lagrangian is the
weighted sum of theirs, so the force stays conservative.

The weights are fitted (Lawson and Hanson's non-negative least squares, stopped at a tolerance) to the reduced work of all
elements in each training state, separately for elastic stresses and pressures (at an equilibrium their sum is zero, which
zero weights would match), on all modes and on the tool. Training states are configurations, and states between one and
the place of another, as they occur in Newton."""
import time

import numpy as np
import scipy.linalg

from peers import body, reduced


def non_negative(A, b, tolerance, most, together=8):
    """(columns, x > 0, |A x - b| / |b|) of few columns. The last is at most `tolerance`, unless more columns do not help
    or there are `most`. Active set on Gram matrices; up to `together` columns enter at once, because a pass over A takes
    most of the time."""
    right, b_length = (A.T @ b).astype(float), float(np.linalg.norm(b))
    chosen, x, gram = np.zeros(0, int), np.zeros(0), np.zeros((0, 0))
    residual, length, entering = b.copy(), b_length, together
    while length > tolerance * b_length and len(chosen) < most:
        gain = A.T @ residual
        gain[chosen] = 0
        new = np.argsort(-gain)[:entering]
        new = new[gain[new] > max(0.5 * gain.max(), 1e-9 * b_length)]
        if len(new) == 0:
            break
        beside = (A[:, new].T @ A[:, np.concatenate([chosen, new])]).astype(float)
        before = len(chosen)
        gram = np.block([[gram, beside[:, :before].T], [beside]])
        chosen, x, gram = inside(np.concatenate([chosen, new]), np.concatenate([x, np.zeros(len(new))]), gram, right)
        residual = b - A[:, chosen] @ x.astype(A.dtype)
        shorter = float(np.linalg.norm(residual))
        if shorter > (1 - 1e-6) * length:
            if entering == 1:
                break
            entering = 1  # one by one it cannot cycle (Lawson and Hanson 1974)
        else:
            entering = together
        length = min(length, shorter)
    return chosen, x, float(np.linalg.norm(residual)) / b_length


def inside(chosen, x, gram, right):
    """From x >= 0 to the least-squares solution of the columns that keep it so; the others are removed."""
    while True:
        damped = gram + 1e-10 * np.trace(gram) / len(gram) * np.eye(len(gram))
        wanted = scipy.linalg.cho_solve(scipy.linalg.cho_factor(damped), right[chosen])
        if (wanted > 0).all():
            return chosen, wanted, gram
        negative = wanted <= 0
        ratio = np.where(negative, x / np.maximum(x - wanted, 1e-300), np.inf)
        x = np.maximum(x + ratio.min() * (wanted - x), 0)
        keep = ~(negative & (ratio <= ratio.min() * (1 + 1e-12)))
        chosen, x, gram = chosen[keep], x[keep], gram[np.ix_(keep, keep)]


def training_states(model, count, random):
    """(coordinates, place) of configurations, and of as many states between one and a neighbour."""
    places, coordinates = model.made.places, model.coordinates
    chosen = random.permutation(len(places))[:count]
    states = [(coordinates[n], places[n]) for n in chosen]
    for n in chosen:
        neighbour = np.argsort(np.linalg.norm(places - places[n], axis=1))[random.integers(1, min(7, len(places)))]
        states.append((0.5 * (coordinates[n] + coordinates[neighbour]), places[n] + 0.3 * (places[neighbour] - places[n])))
    return [state for state in states if model.admissible(*state)]


def element_basis(model, elements=slice(None)):
    """Returns the 16 nodal values of elements by (a, p): m x 16 x (k + 3)."""
    n, k = model.basis.shape
    both = np.zeros((n + 4, k + 3))
    both[:n, :k], both[:n, k:], both[n:n + 3, k:] = model.basis, model.made.lift, np.eye(3)
    return both[model.body.element_slot[elements]]


def training(model, states):
    """A and b of the fit. Rows of A: states x (elastic, pressure) x (k + 3); columns: elements. Rows of one kind have the
    same scale."""
    some_body, basis = model.body, element_basis(model).astype(np.float32)
    A = np.empty((len(states), 2, basis.shape[2], len(basis)), np.float32)
    for n, (a, p) in enumerate(states):
        z = model.whole(a, p)
        still = np.concatenate([z[:some_body.displacements], np.zeros(len(some_body.points))])
        elastic, total = (some_body.elements(state, p, False)[1] for state in (still, z))
        elastic.reshape(-1, 4, 4)[:, :, 3] = 0
        for kind, residual in enumerate((elastic, total - elastic)):
            A[n, kind] = np.matmul(residual.astype(np.float32)[:, None], basis)[:, 0].T
    size = np.sqrt((A.sum(axis=3, dtype=float) ** 2).mean(axis=(0, 2)))
    A /= np.maximum(size, 1e-30)[None, :, None, None].astype(np.float32)
    A = A.reshape(-1, A.shape[-1])
    return A, A.sum(axis=1, dtype=float).astype(np.float32)


class Sampled(reduced.Galerkin):
    """A reduced model whose sums run over few elements. tolerance: of the fit of the weights; states: number of
    configurations for the fit."""

    def __init__(self, model, tolerance, states=60, most=1500):
        began = time.process_time()
        A, b = training(model, training_states(model, states, np.random.default_rng(2015)))
        elements, weights, self.misfit = non_negative(A, b, tolerance, most)
        order = np.argsort(elements)
        self.elements, self.weights = elements[order], weights[order]
        self.seconds = time.process_time() - began
        self.made, self.coordinates, self.columns, self.displacements = model.made, model.coordinates, model.columns, model.body.displacements
        self.law, self.pressure_scale = model.body.law, model.body.pressure_scale
        self.gradients, self.volume = model.body.gradients[self.elements], model.body.volume[self.elements] * self.weights
        self.basis = element_basis(model, self.elements)
        self.size = model.basis.shape[1]

    def nodal(self, a, p):
        """Returns deformation gradients and pressures of the elements."""
        values = (self.basis @ np.concatenate([a, p])).reshape(-1, 4, 4)
        return np.eye(3) + np.swapaxes(values[:, :, :3], 1, 2) @ self.gradients, values[:, :, 3]

    def admissible(self, a, p):
        return self.law.admissible(self.nodal(a, p)[0])

    def assemble(self, a, p):
        energy, residual, K = body.element_sums(self.law, *self.nodal(a, p), self.gradients, self.volume, self.pressure_scale)
        k, flat = len(a), self.basis.reshape(-1, self.basis.shape[2])
        r, tangent = residual.ravel() @ flat, flat.T @ np.matmul(K, self.basis).reshape(flat.shape)
        return body.Assembled(float(energy.sum()), r[:k], -r[k:], tangent[:k, :k], tangent[:k, k:], tangent[k:, k:])

    def residual(self, a, p):
        """Like assemble, without a tangent."""
        energy, residual, _ = body.element_sums(self.law, *self.nodal(a, p), self.gradients, self.volume, self.pressure_scale, False)
        r = residual.ravel() @ self.basis.reshape(-1, self.basis.shape[2])
        return body.Assembled(float(energy.sum()), r[:len(a)], -r[len(a):])

    def memory(self):
        """Bytes that an answer of the force reads: modes of three displacements and a pressure at four corners, the place
        of the tool, other data of an element, and starting coordinates."""
        of_u, of_q = self.columns
        basis = 8 * len(self.elements) * (12 * (of_u + 3) + 4 * (of_q + 3))
        return basis + self.gradients.nbytes + self.volume.nbytes + self.coordinates.nbytes

    def memory_with_shape(self):
        """The displacement of all nodes by their modes and the place of the tool, in the precision of datasets."""
        return self.memory() + 4 * self.displacements * (self.columns[0] + 3)
