"""Newton's method and continuation, for the whole body and for what is reduced from it.

A *model* has assemble(z, p) -> Assembled, admissible(z, p), factors(assembled) and sensitivity(assembled, factors)."""
import dataclasses

import numpy as np

TOLERANCE = 1e-8       # of the residual's norm, relative to the force on the tool
FLOOR = 1e-9           # N
ITERATIONS = 15
HALVINGS = 6           # of a Newton step
SMALLEST_STEP = 1 / 32  # of a transition


@dataclasses.dataclass
class Solved:
    z: np.ndarray
    p: np.ndarray
    force: np.ndarray
    energy: float
    iterations: int
    slope: np.ndarray  # dz/dp


@dataclasses.dataclass
class Iterate:
    """After so many Newton iterations: what the loop would answer if it had to stop here."""
    force: np.ndarray
    residual: float


def converged(assembled):
    return np.linalg.norm(assembled.residual) <= FLOOR + TOLERANCE * np.linalg.norm(assembled.force)


def newton(model, z, p, iterations=ITERATIONS, on_iterate=None):
    """From z, with the tool at p; None without a solution."""
    if not model.admissible(z, p):
        return None
    assembled = model.assemble(z, p)
    for iteration in range(iterations + 1):
        norm = np.linalg.norm(assembled.residual)
        if on_iterate:
            on_iterate(Iterate(assembled.force, float(norm)))
        factors = model.factors(assembled)
        if converged(assembled):
            return Solved(z, p, assembled.force, assembled.energy, iteration, model.sensitivity(assembled, factors))
        if iteration == iterations:
            return None
        step = -factors.solve(assembled.residual)
        for halving in range(HALVINGS + 1):
            tried = z + step / 2**halving
            if model.admissible(tried, p):
                next_one = model.assemble(tried, p)
                if np.linalg.norm(next_one.residual) < norm:
                    break
        else:
            return None
        z, assembled = tried, next_one
    return None


def transition(model, start, target):
    """From one solution to another place of the tool, in as large steps as go; None when none goes."""
    at, done, step, iterations = start, 0.0, 1.0, 0
    way = np.asarray(target) - start.p
    while done < 1:
        step = min(step, 1 - done)
        p = np.asarray(target, float) if done + step >= 1 else at.p + step * way
        reached = newton(model, at.z + at.slope @ (p - at.p), p)
        if reached is None:
            step /= 2
            if step < SMALLEST_STEP:
                return None
            continue
        at, done, iterations = reached, done + step, iterations + reached.iterations
        step *= 2
    return dataclasses.replace(at, iterations=iterations)


class Whole:
    """The whole body as a model."""

    def __init__(self, body, factors):
        self.body, self.factors_of = body, factors

    def assemble(self, z, p):
        return self.body.assemble(z, p)

    def admissible(self, z, p):
        return self.body.admissible(z, p)

    def factors(self, assembled):
        return self.factors_of(assembled.tangent)

    def sensitivity(self, assembled, factors):
        return -factors.solve(assembled.coupling)

    def at_rest(self):
        return newton(self, np.zeros(self.body.size), np.zeros(3))
