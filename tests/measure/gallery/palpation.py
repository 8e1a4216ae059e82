"""Finds a stiff ball under layered skin from forces alone. Like a physician, it knows the layers of healthy skin, but not
what lies in them.

The top of the skin is pressed at places of a grid, everywhere by the same depth d, and the force F = k d is noted. Over a
stiff ball k is larger. To first order in the volume of the ball the increase is proportional to <e:e>: the mean over the
ball of the squared deviatoric strain that a finger, pressed by 1, causes in healthy skin (Eshelby, Proc. R. Soc. A 241,
1957). That strain follows from one axisymmetric linear problem: the finger on wide layers. So the bump of k lies over the
ball, and is wider for deeper balls. The change of k towards the sides of the block is fitted by polynomials with the block's
symmetry. The radius is then that of a ball under the finger, in the same axisymmetric problem, that raises k as much. It
must assume how stiff lumps are; a rigid ball instead of one 13 times as stiff as fat makes the radius 0.5 mm smaller.
"""
import dataclasses

import numpy as np
import scipy.interpolate
import scipy.optimize
import scipy.sparse
import scipy.sparse.linalg

STEP = 0.0005  # m: element size in the healthy skin
FAR = 0.036  # m: radius of the healthy skin
POISSON = 0.4995
RADIUS = 0.005  # m: assumed radius of balls; the shape of the bump hardly depends on it
FELT = 0.07


@dataclasses.dataclass
class Felt:
    place: np.ndarray  # x, y of the found centre, m
    depth: float  # depth of the centre, m
    radius: float  # of the ball, m
    height: float  # height of the bump: increase of the stiffness over the ball, relative to the skin without it

    @property
    def found(self):
        """Returns whether a hand would notice the bump. It notices differences of about 7 %."""
        return self.height > FELT


def weight(r, radius):
    """Weight of a finger at distance r from its middle."""
    return np.where(r < radius, (1 - (r / radius) ** 2) ** 2, 0)


def strain_matrices(r, z, corner_r, corner_z):
    """Returns B (4 x 8) of (e_rr, e_zz, e_tt, 2 e_rz) at a point of a rectangle, for u_r, u_z of its four corners."""
    (r0, r1), (z0, z1) = corner_r, corner_z
    a, b = (r - r0) / (r1 - r0), (z - z0) / (z1 - z0)
    shape = np.array([(1 - a) * (1 - b), a * (1 - b), a * b, (1 - a) * b])
    by_r = np.array([-(1 - b), 1 - b, b, -b]) / (r1 - r0)
    by_z = np.array([-(1 - a), -a, a, 1 - a]) / (z1 - z0)
    result = np.zeros((4, 8))
    result[0, 0::2] = by_r
    result[1, 1::2] = by_z
    result[2, 0::2] = shape / r
    result[3, 0::2], result[3, 1::2] = by_z, by_r
    return result


def pressed(layers, finger, ball=None):
    """Presses wide layers, (thickness m, shear modulus Pa) from above, on rigid ground, with a finger of that radius. ball: (depth
    of its centre, radius, shear modulus), under the finger. Returns the stiffness, N/m, and an interpolant of e:e over points (r,
    depth) for a weighted mean displacement of 1. Rectangles with averaged dilatation (B-bar, Hughes 1980), so that nearly
    incompressible layers do not lock."""
    thickness = sum(thick for thick, _ in layers)
    columns, rows = round(FAR / STEP), round(thickness / STEP)
    r, z = np.arange(columns + 1) * STEP, np.arange(rows + 1) * STEP  # z upward from the base
    middle_r, middle_z = (r[1:] + r[:-1]) / 2, (z[1:] + z[:-1]) / 2
    modulus = np.empty((columns, rows))
    below = thickness
    for thick, mu in layers:
        modulus[:, round((below - thick) / STEP):round(below / STEP)] = mu
        below -= thick
    if ball is not None:
        depth, radius, mu = ball
        parts = STEP * (np.arange(8) - 3.5) / 8
        distance = np.hypot((middle_r[:, None] + parts)[:, None, :, None], (middle_z[:, None] - thickness + depth + parts)[:, None])
        modulus *= (mu / modulus) ** (distance < radius).mean(axis=(2, 3))
    gauss = STEP / 2 * (1 + np.array([-1, 1]) / np.sqrt(3))
    shear = np.diag([2, 2, 2, 1.0])
    volumetric = np.array([1, 1, 1, 0.0])

    unit, strains = [], []  # for an element of unit shear modulus in each column; elements of a column differ only in the modulus
    for i in range(columns):
        points = [(r[i] + a, b) for a in gauss for b in gauss]
        b = [strain_matrices(at_r, at_z, (r[i], r[i + 1]), (0, STEP)) for at_r, at_z in points]
        w = [2 * np.pi * at_r * STEP ** 2 / 4 for at_r, _ in points]
        mean = sum(w_g * volumetric @ b_g for w_g, b_g in zip(w, b)) / sum(w)
        bar = [b_g + np.outer(volumetric / 3, mean - volumetric @ b_g) for b_g in b]
        lame = 2 * POISSON / (1 - 2 * POISSON)
        unit.append(sum(w_g * (b_g.T @ shear @ b_g + lame * np.outer(mean, mean)) for w_g, b_g in zip(w, bar)))
        strains.append((bar, w))
    number = np.arange((columns + 1) * (rows + 1)).reshape(columns + 1, rows + 1)
    corners = np.stack([number[:-1, :-1], number[1:, :-1], number[1:, 1:], number[:-1, 1:]], axis=-1)
    unknowns = np.stack([2 * corners, 2 * corners + 1], axis=-1).reshape(columns, rows, 8)
    values = np.array(unit)[:, None] * modulus[:, :, None, None]
    at = np.broadcast_arrays(unknowns[..., :, None], unknowns[..., None, :])
    stiffness = scipy.sparse.csr_matrix((values.ravel(), (at[0].ravel(), at[1].ravel())))

    load = np.zeros(stiffness.shape[0])  # unit total load, distributed by the finger's weight
    for i in range(columns):
        for at_r in r[i] + gauss:
            share = weight(at_r, finger) * 2 * np.pi * at_r * STEP / 2
            load[2 * number[i, -1] + 1] += share * (r[i + 1] - at_r) / STEP
            load[2 * number[i + 1, -1] + 1] += share * (at_r - r[i]) / STEP
    load /= load.sum()
    held = np.zeros(len(load), bool)
    held[2 * number[:, 0]] = held[2 * number[:, 0] + 1] = held[2 * number[0]] = True
    free = np.flatnonzero(~held)
    u = np.zeros(len(load))
    u[free] = scipy.sparse.linalg.spsolve(stiffness[free][:, free].tocsc(), load[free])
    mean_displacement = load @ u
    u /= mean_displacement

    squares = np.empty((columns, rows))
    for i, (bar, w) in enumerate(strains):
        e = np.einsum("gab,jb->gja", np.array(bar), u[unknowns[i]])
        e[:, :, :3] -= e[:, :, :3].mean(axis=2, keepdims=True)
        squares[i] = np.array(w) @ (e[..., :3] ** 2).sum(axis=2).reshape(4, rows) + np.array(w) @ (e[..., 3] ** 2 / 2)
        squares[i] /= sum(w)
    return 1 / mean_displacement, scipy.interpolate.RegularGridInterpolator(
        (middle_r, thickness - middle_z[::-1]), squares[:, ::-1], bounds_error=False, fill_value=None)


def ball_points(count=200):
    """The same evenly distributed points in the unit ball (count x 3) each time."""
    i = np.arange(count) + 0.5
    radius, polar = (i / count) ** (1 / 3), np.arccos(1 - 2 * ((i * 0.6180339887) % 1))
    turn = 2 * np.pi * i * 0.7548776662
    directions = np.stack([np.sin(polar) * np.cos(turn), np.sin(polar) * np.sin(turn), np.cos(polar)], axis=1)
    return radius[:, None] * directions


def mean_strain(strain, r, depth):
    """<e:e> over a ball with its centre at `depth`, at distances r from the finger."""
    offsets = RADIUS * ball_points()
    along = np.hypot(r[:, None] + offsets[:, 0], offsets[:, 1])
    deep = np.broadcast_to(depth + offsets[:, 2], along.shape)
    return strain(np.stack([along, deep], axis=-1)).mean(axis=1)


def smooth_columns(places, half):
    """Returns polynomials up to the eighth order with the symmetry of a square block, one per column."""
    x, y = (places / half).T ** 2
    return np.stack([x ** i * y ** j + x ** j * y ** i for i in range(5) for j in range(i + 1) if i + j < 5], axis=1)


def radius_of(height, depth, layers, finger, modulus, healthy):
    """Returns the radius, m, of a ball of that modulus, Pa, at that depth, which raises the stiffness by the share `height`."""
    def excess(radius):
        return pressed(layers, finger, (depth, radius, modulus))[0] / healthy - 1 - height
    largest = depth - sum(thick for thick, _ in layers[:-1])
    return largest if excess(largest) < 0 else scipy.optimize.brentq(excess, STEP, largest, xtol=1e-5)


def feel(places, stiffness, layers, finger, half, lump):
    """Finds what lies under the skin from the stiffness k (N/m) at places (n x 2, m from the middle of the block).

        layers   of healthy skin, (thickness m, shear modulus Pa) from above; balls lie in the last one
        finger   its radius, m
        half     of the width of the block, m
        lump     assumed shear modulus of a ball, Pa
    """
    healthy, strain = pressed(layers, finger)
    above = sum(thick for thick, _ in layers[:-1]) + RADIUS
    lowest = np.array([-half, -half, above])
    highest = np.array([half, half, above + layers[-1][0] - 2 * RADIUS])
    smooth = smooth_columns(places, half)

    def fitted(ball):
        """The bump of a ball at (x, y, depth), its height, the smooth part, and the residual of both."""
        bump = mean_strain(strain, np.hypot(*(places - ball[:2]).T), ball[2])
        columns = np.column_stack([bump, smooth])
        solution = np.linalg.lstsq(columns, stiffness, rcond=None)[0]
        return solution[0] * bump, smooth @ solution[1:], stiffness - columns @ solution

    starts = [(x, y, (lowest[2] + highest[2]) / 2) for x in (-half / 2, 0, half / 2) for y in (-half / 2, 0, half / 2)]
    tries = [scipy.optimize.least_squares(lambda ball: fitted(ball)[2], start, x_scale=0.005, bounds=(lowest, highest))
             for start in starts]
    stiffer = [one for one in tries if fitted(one.x)[0].sum() > 0] or tries
    best = min(stiffer, key=lambda one: one.cost)
    bump, without, _ = fitted(best.x)
    height = (bump / without).max()
    return Felt(best.x[:2], best.x[2], radius_of(height, best.x[2], layers, finger, lump, healthy) if height > FELT else 0, height)
