"""Energy densities psi(F, p) = W(F) - p c(F) of many elements at once, with first and second derivatives.

F: M x 3 x 3, the deformation gradient of each element; p: M, its mean pressure, Pa. Second derivatives are M x 9 x 9, F
flattened by rows. SI units; docs/solver.md has the full Lagrangian."""
import dataclasses

import numpy as np


@dataclasses.dataclass
class Density:
    energy: np.ndarray              # M, J/m^3
    constraint: np.ndarray          # M: c(F)
    stress: np.ndarray              # M x 3 x 3, Pa: d psi / dF
    constraint_slope: np.ndarray    # M x 3 x 3: dc/dF
    tangent: np.ndarray = None      # M x 9 x 9, Pa: d2 psi / dF2


def dyad(a, b):
    """Returns a_ij b_kl as M x 9 x 9."""
    return a.reshape(-1, 9, 1) * b.reshape(-1, 1, 9)


def product(pattern, *tensors):
    """Returns a fourth-order product of second-order tensors as M x 9 x 9."""
    return np.einsum(pattern, *tensors).reshape(-1, 9, 9)


IDENTITY = np.eye(3)
NEXT, AFTER = [1, 2, 0], [2, 0, 1]


def cofactors(F):
    """Returns J F^-T by cross products, ten times as fast as NumPy's inverse."""
    one, other = F[:, NEXT], F[:, AFTER]
    return one[:, :, NEXT] * other[:, :, AFTER] - one[:, :, AFTER] * other[:, :, NEXT]


class MooneyRivlin:
    """W = C10 (j1 - 3) + C01 (j2 - 3) in isochoric invariants, c = ln det F."""

    def __init__(self, c10, c01):
        self.c10, self.c01, self.shear_modulus = c10, c01, 2 * (c10 + c01)

    def admissible(self, F):
        return bool((np.linalg.det(F) > 0).all())  # false for NaN

    def at(self, F, p, tangent=True):
        scalar = lambda s: s[:, None, None]
        G = cofactors(F)
        J = (F[:, 0] * G[:, 0]).sum(axis=1)
        G = G / scalar(J)  # dJ/dF = J G
        C = F.transpose(0, 2, 1) @ F
        i1 = np.trace(C, axis1=1, axis2=2)
        i2 = 0.5 * (i1**2 - np.einsum("mij,mij->m", C, C))
        d1, d2 = 2 * F, 2 * (scalar(i1) * F - F @ C)
        a1, a2 = self.c10 * J ** (-2 / 3), self.c01 * J ** (-4 / 3)
        stress1, stress2 = scalar(a1) * (d1 - scalar(2 / 3 * i1) * G), scalar(a2) * (d2 - scalar(4 / 3 * i2) * G)
        density = Density(a1 * i1 + a2 * i2 - 3 * (self.c10 + self.c01) - p * np.log(J), np.log(J),
                          stress1 + stress2 - scalar(p) * G, G)
        if tangent:
            turned = product("mil,mkj->mijkl", G, G)  # -dG/dF
            b = F @ F.transpose(0, 2, 1)
            unit = np.eye(9)[None]
            second2 = 2 * (dyad(d1, F) + scalar(i1) * unit - product("jl,mik->mijkl", IDENTITY, b)
                           - product("ik,mlj->mijkl", IDENTITY, C) - product("mil,mkj->mijkl", F, F))
            density.tangent = (
                -2 / 3 * dyad(stress1, G) + scalar(a1) * (2 * unit - 2 / 3 * dyad(G, d1) + scalar(2 / 3 * i1) * turned)
                - 4 / 3 * dyad(stress2, G) + scalar(a2) * (second2 - 4 / 3 * dyad(G, d2) + scalar(4 / 3 * i2) * turned)
                + scalar(p) * turned)
        return density


LEVI_CIVITA = np.zeros((3, 3, 3))
for i, j, k in ((0, 1, 2), (1, 2, 0), (2, 0, 1)):
    LEVI_CIVITA[i, j, k], LEVI_CIVITA[i, k, j] = 1, -1


class Corotated:
    """Linear elasticity in the frame of each element's rotation R of F = R S: e = S - I, W = mu (e:e - (tr e)^2 / 3), c =
    tr e; incompressible like the law that it replaces, and equal to it at rest."""

    def __init__(self, shear_modulus):
        self.shear_modulus = shear_modulus

    def admissible(self, F):
        return bool(np.isfinite(F).all())

    def at(self, F, p, tangent=True):
        U, stretches, V = np.linalg.svd(F)
        flip = np.sign(np.linalg.det(U @ V))
        stretches[:, 2] *= flip  # a rotation without a reflection, also in inverted elements
        U[:, :, 2] *= flip[:, None]
        R = U @ V
        scalar = lambda s: s[:, None, None]
        c, mu = stretches.sum(axis=1) - 3, self.shear_modulus
        weight = 2 / 3 * mu * c + p
        density = Density(mu * (((stretches - 1) ** 2).sum(axis=1) - c**2 / 3) - p * c, c, 2 * mu * (F - R) - scalar(weight) * R, R)
        if tangent:
            S = V.transpose(0, 2, 1) @ (stretches[:, :, None] * V)
            Q = np.einsum("mir,rnj->mijn", R, LEVI_CIVITA).reshape(-1, 9, 3)
            spin = scalar(stretches.sum(axis=1)) * IDENTITY - S
            turned = Q @ np.linalg.inv(spin) @ Q.transpose(0, 2, 1)  # dR/dF
            density.tangent = 2 * mu * np.eye(9)[None] - 2 / 3 * mu * dyad(R, R) - scalar(2 * mu + weight) * turned
        return density
