"""Newton's method and continuation for the whole body and for reduced models.

A *model* has assemble(z, p) -> Assembled, admissible(z, p), factors(assembled), sensitivity(assembled, factors) and
tolerance, of the residual's norm relative to the force on the tool."""
import dataclasses

import numpy as np

TOLERANCE = 1e-8
FLOOR = 1e-9           # N
ITERATIONS = 15
HALVINGS = 6           # most halvings of a Newton step
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
    """The answer of the loop if it has to stop after this number of Newton iterations."""
    force: np.ndarray
    residual: float


def converged(model, assembled):
    return np.linalg.norm(assembled.residual) <= FLOOR + model.tolerance * np.linalg.norm(assembled.force)


def newton(model, z, p, iterations=ITERATIONS, on_iterate=None):
    """Solves from z, with the tool at p; None without a solution."""
    if not model.admissible(z, p):
        return None
    assembled = model.assemble(z, p)
    for iteration in range(iterations + 1):
        norm = np.linalg.norm(assembled.residual)
        if on_iterate:
            on_iterate(Iterate(assembled.force, float(norm)))
        factors = model.factors(assembled)
        if converged(model, assembled):
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
    """From one solution to another place of the tool, in the largest steps that converge; None if none does."""
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


class Follower:
    """Equilibria along a hand's path without a new tangent in each. Broyden's rank-one updates (Kelley 1995, Sec. 7.3)
    correct the inverse of an old tangent and dz/dp; both are computed again if the residual does not halve. For small
    dense models, which have residual(z, p) too. tolerance: of the residual relative to the force; the error of the force
    is of this size or below."""

    def __init__(self, model, solved, tolerance=1e-5):
        self.model, self.tolerance, self.tangents = model, tolerance, 0
        self.z, self.p = solved.z, solved.p
        self.renew()

    def renew(self):
        assembled = self.model.assemble(self.z, self.p)
        self.inverse = np.linalg.inv(assembled.tangent)
        self.slope = -self.inverse @ assembled.coupling
        self.tangents += 1

    def answer(self, p, iterations=15):
        """The force with the tool at p, from its last place; None without a solution, and then nothing changes."""
        before = self.z, self.p
        found = self.iterate(before[0] + self.slope @ (p - before[1]), p, iterations)
        if found is None:
            self.z, self.p = before
            self.renew()
            return None
        way = p - before[1]
        if way @ way > 0:
            self.slope = self.slope + np.outer((self.z - before[0] - self.slope @ way) / (way @ way), way)
        return found

    def iterate(self, z, p, iterations):
        last = step = None
        for _ in range(iterations):
            if not self.model.admissible(z, p):
                return None
            assembled = self.model.residual(z, p)
            norm = np.linalg.norm(assembled.residual)
            self.z, self.p = z, p
            if norm <= FLOOR + self.tolerance * np.linalg.norm(assembled.force):
                return assembled.force
            if last is not None:
                if norm > 0.5 * np.linalg.norm(last):
                    self.renew()
                else:
                    change = self.inverse @ (assembled.residual - last)
                    self.inverse = self.inverse + np.outer((step - change) / (step @ change), step @ self.inverse)
            step, last = -self.inverse @ assembled.residual, assembled.residual
            z = z + step
        return None

    def walk(self, p, step=0.001):
        """The same in steps of at most 1 mm, like a hand's motion."""
        way = p - self.p
        force, start = None, self.p
        count = max(1, int(np.ceil(np.linalg.norm(way) / step)))
        for n in range(1, count + 1):
            force = self.answer(start + n / count * way)
            if force is None:
                return None
        return force


class Whole:
    """The whole body as a model."""

    def __init__(self, body, factors, tolerance=TOLERANCE):
        self.body, self.factors_of, self.tolerance = body, factors, tolerance

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
