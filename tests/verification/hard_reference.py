#!/usr/bin/python3
"""Computes the pushes of tests/verification/hard.cpp with GetFEM, an independent library (python3-getfem).

    tests/verification/hard_reference.py [NAME...]

Meshes, laws, constraint and tool are implemented independently. Prints the force in newtons of each case, and the Newton
iterations. A skin with n = 16 takes 15 minutes, and 10 GB of memory.
"""
import itertools
import sys

import getfem
import numpy as np

ISOCHORIC = "pow(Det(F),-2/3)*Norm_sqr(F)"
MATRIX = f"mu/2*({ISOCHORIC}-3)"
VENANT = "lambda_/2*sqr(Trace(E)) + G*Norm_sqr(E)"


def fibres_along(a):
    """The variation of k1/(2 k2) (exp(k2 E^2) - 1), E = max(0, kappa (j1 - 3) + (1 - 3 kappa) (j4 - 1)): GetFEM cannot
    differentiate a positive part twice."""
    stretched = f"(kappa*Norm_sqr(F)+(1-3*kappa)*Norm_sqr(F*{a}))"
    E = f"pos_part(pow(Det(F),-2/3)*{stretched}-1)"
    return (f"k1*{E}*exp(k2*sqr({E}))*pow(Det(F),-2/3)*(2*kappa*(F:Grad_Test_u)"
            f"+2*(1-3*kappa)*(F*{a}).(Grad_Test_u*{a})-2/3*{stretched}*Trace(Inv(F)*Grad_Test_u))")


def box(size, cells):
    """Returns nodes and tetrahedra of a box; each brick is cut along its diagonal into six."""
    cells = np.array(cells)
    number = np.arange(np.prod(cells + 1)).reshape(cells + 1, order="F")
    places = np.stack(np.unravel_index(np.arange(number.size), cells + 1, order="F"), 1)
    tetrahedra = []
    for corner in itertools.product(*map(range, cells)):
        for order in itertools.permutations(range(3)):
            path = [np.array(corner)]
            for axis in order:
                path.append(path[-1] + np.eye(3, dtype=int)[axis])
            tetrahedra.append([number[tuple(p)] for p in path])
    return places / cells * np.array(size), np.array(tetrahedra)


class Push:
    def __init__(self, points, tetrahedra, stiff=None, order=2):
        self.mesh = getfem.Mesh("empty", 3)
        shape = getfem.GeoTrans("GT_PK(3,1)")
        for element in tetrahedra:
            self.mesh.add_convex(shape, points[element].T)
        middles = points[tetrahedra].mean(1)
        parts = np.zeros(len(middles), int) if stiff is None else stiff(middles).astype(int)
        # GetFEM numbers elements in the order in which they were added.
        for part in range(parts.max() + 1):
            self.mesh.set_region(part + 1, np.array([np.where(parts == part)[0], -np.ones((parts == part).sum())], int))
        self.kept = []
        self.model = model = getfem.Model("real")
        self.displacement = getfem.MeshFem(self.mesh, 3)
        self.displacement.set_fem(getfem.Fem(f"FEM_PK(3,{order})"))
        self.integration = getfem.MeshIm(self.mesh, getfem.Integ("IM_TETRAHEDRON(%d)" % (5 if order == 2 else 3)))
        model.add_fem_variable("u", self.displacement)
        model.add_macro("F", "(Id(3)+Grad_u)")
        model.add_macro("E", "((F'*F-Id(3))/2)")

    def material(self, region, energy, pressure, *residuals, bulk=None, volume="log(Det(F))", **numbers):
        for name, value in numbers.items():
            self.model.add_initialized_data(name, value)
        self.model.add_nonlinear_term(self.integration, energy, region)
        for residual in residuals:
            self.model.add_nonlinear_term(self.integration, residual, region)
        if pressure:
            field = getfem.MeshFem(self.mesh, 1)
            field.set_fem(getfem.Fem("FEM_PK(3,1)"))
            part = getfem.MeshFem("partial", field, np.unique(field.basic_dof_on_region(region)))
            self.kept += [field, part]  # the model does not own them
            self.model.add_fem_variable(pressure, part)
            give = f"-sqr({pressure})/(2*{bulk})" if bulk else ""
            self.model.add_nonlinear_term(self.integration, f"-{pressure}*{volume}{give}", region)

    def bump_weights(self, near, radius):
        """Returns, per node, its share of the weighted mean that a soft finger on the plane z = near[2] prescribes."""
        shapes = getfem.MeshFem(self.mesh, 1)
        shapes.set_fem(self.displacement.fem()[0])
        fine = getfem.MeshIm(self.mesh, getfem.Integ("IM_STRUCTURED_COMPOSITE(IM_TETRAHEDRON(5),12)"))
        faces = self.mesh.outer_faces_in_box([-1, -1, near[2] - 1e-9], [1, 1, near[2] + 1e-9])
        self.mesh.set_region(99, faces)
        squared = "+".join(f"sqr(X({axis + 1})-{near[axis]})" for axis in range(3))
        weights = getfem.asm_generic(fine, 1, f"sqr(pos_part(1-({squared})/{radius ** 2}))*Test_w", 99,
                                     "w", 1, shapes, np.zeros(shapes.nbdof()))
        weights[np.linalg.norm(shapes.basic_dof_nodes().T - near, axis=1) > radius] = 0
        return weights / weights.sum()

    def solve(self, near, radius, way, steps=1, soft=False):
        self.hold(near, radius, soft)
        return self.move(way, steps)

    def hold(self, near, radius, soft=False, supported=lambda places: places[2] < 1e-9):
        """Fixes the nodes at supported places (3 x n). soft: the tool prescribes a weighted mean; otherwise all nodes within the
        radius."""
        places = self.displacement.basic_dof_nodes()
        fixed = np.where(supported(places))[0]
        held = np.setdiff1d(np.where(np.linalg.norm(places.T - near, axis=1) <= radius * (1 + 1e-12))[0], fixed)

        def constrain(name, rows):
            """rows: of each constraint, the degrees of freedom and their weights."""
            matrix = getfem.Spmat("empty", len(rows), self.displacement.nbdof())
            for i, row in enumerate(rows):
                for dof, weight in row:
                    matrix.assign(i, int(dof), float(weight))
            self.model.add_variable(name, len(rows))
            return self.model.add_constraint_with_multipliers("u", name, matrix, np.zeros(len(rows)))

        constrain("of_plane", [[(dof, 1)] for dof in fixed])
        self.held, self.axes = held, held % 3
        rows = [[(dof, 1)] for dof in held]
        if soft:
            weights, self.axes = self.bump_weights(np.array(near), radius), np.arange(3)
            rows = [[(3 * node + axis, weights[node]) for node in np.flatnonzero(weights)] for axis in self.axes]
        self.tool = constrain("of_tool", rows)

    def move(self, way, steps):
        """Moves the tool from rest in equal steps. Returns the force on it, and the number of Newton iterations."""
        iterations = 0
        for step in range(1, steps + 1):
            self.model.set_private_rhs(self.tool, np.array(way)[self.axes] * step / steps)
            iterations += self.model.solve("max_res", 1e-11, "max_iter", 300, "lsolver", "mumps",
                                           "lsearch", "simplest", "alpha min", 0.01)[0]
        return self.force(), iterations

    def force(self):
        multipliers = self.model.variable("of_tool")
        return [float(multipliers[self.axes == axis].sum()) for axis in range(3)]


MIDDLE = (0.02, 0.02, 0.04)
STEP = 0.5e-3  # m


def press(size, cells, depth, near=MIDDLE, radius=0.0101, taper=1, bulk=None, step=STEP):
    """Soft tissue without fibres; `taper`: width of the top relative to the bottom."""
    points, tetrahedra = box(size, cells)
    share = 1 - (1 - taper) * points[:, 2:] / size[2]
    points[:, :2] = np.array(size[:2]) / 2 + share * (points[:, :2] - np.array(size[:2]) / 2)
    push = Push(points, tetrahedra)
    push.material(-1, MATRIX, "p", bulk=bulk, mu=3000)
    return push.solve(near, radius, (0, 0, -depth), max(1, round(depth / step)))


def nearly_incompressible(strain, young=9000, poisson=0.499):
    """A cube of the law linear (strain e) or st-venant-kirchhoff (E)."""
    push = Push(*box((0.04,) * 3, (4, 4, 4)))
    G = young / (2 * (1 + poisson))
    push.model.add_macro("e", "Sym(Grad_u)")
    push.material(-1, f"G*Norm_sqr({strain})", "p", bulk=2 * G * poisson / (1 - 2 * poisson), volume=f"Trace({strain})", G=G)
    return push.solve(MIDDLE, 0.0101, (0, 0, -1e-3), 2)


def fibres(mu, k1, k2, depth, kappa=0, angle=None, step=STEP):
    """One family along x, or two at plus and minus `angle` degrees from x."""
    push = Push(*box((0.04,) * 3, (4, 4, 4)))
    turned = np.radians(angle or 0)
    families = ["a"] if angle is None else ["a", "b"]
    push.material(-1, MATRIX, "p", *map(fibres_along, families), mu=mu, k1=k1, k2=k2, kappa=kappa,
                  a=[np.cos(turned), np.sin(turned), 0], b=[np.cos(turned), -np.sin(turned), 0])
    return push.solve(MIDDLE, 0.0101, (0, 0, -depth), max(1, round(depth / step)))


def skin(contrast, n):
    push = Push(*box((0.04,) * 3, (n,) * 3), stiff=lambda X: X[:, 2] > 0.03)
    push.material(1, MATRIX, "p", mu=3000)
    push.material(2, MATRIX.replace("mu", "mu2"), "q", mu2=3000 * contrast)
    return push.solve(MIDDLE, 0.0145, (0, 0, -1e-3), 2, soft=True)


def column(depth):
    """Buckles the column by a side load, and takes the load away again. The branch along x has the lower energy."""
    push = Push(*box((0.01, 0.01, 0.08), (2, 2, 16)))
    push.material(-1, MATRIX, "p", mu=3000)
    push.model.add_initialized_data("side", [300, 0, 0])  # N/m^3
    push.model.add_linear_term(push.integration, "-side.Test_u")
    push.hold((0.005, 0.005, 0.08), 0.0072)
    iterations = push.move((0, 0, -depth), round(depth / 0.25e-3))[1]
    push.model.set_variable("side", np.zeros(3))
    force, more = push.move((0, 0, -depth), 1)
    return force, iterations + more


def capsule(depth):
    push = Push(*box((0.04,) * 3, (4, 4, 4)), stiff=lambda X: X[:, 2] > 0.03)
    push.material(1, MATRIX, "p", mu=3000)
    push.material(2, MATRIX.replace("mu", "mu2"), "q", *map(fibres_along, "ab"), mu2=5000, k1=500e3, k2=20, kappa=0,
                  a=[np.sqrt(0.5), np.sqrt(0.5), 0], b=[np.sqrt(0.5), -np.sqrt(0.5), 0])
    return push.solve(MIDDLE, 0.0101, (0, 0, -depth), round(depth / 0.25e-3))


def bone(young):
    push = Push(*box((0.06,) * 3, (6, 6, 6)), stiff=lambda X: ((X > 0.02) & (X < 0.04)).all(1))
    push.material(1, MATRIX, "p", mu=3000)
    push.material(2, VENANT, None, lambda_=young * 0.3 / (1.3 * 0.4), G=young / 2.6)
    return push.solve((0.03, 0.03, 0.06), 0.0101, (0, 0, -5e-3), 5)


# Depths, mu, k1, k2, kappa, angle: carotid of a rabbit (Holzapfel, Gasser, Ogden 2000), iliac adventitia of a man
# (Gasser, Ogden, Holzapfel 2006).
ARTERIES = {"media": ((1e-6, 6e-3, 12e-3), 3000, 2363.2, 0.8393, 0, 29),
            "adventitia": ((1e-6, 6e-3, 12e-3), 300, 562, 0.7112, 0, 62),
            "dispersed adventitia": ((1e-6, 1.5e-3), 7640, 996.6e3, 524.6, 0.226, 49.98)}
CASES = {f"fibres, k1/mu = {ratio}, {1e3 * depth:g} mm": (fibres, 3000, 3000 * ratio, 0.84, depth)
         for ratio, depth in [(10, 1e-3), (100, 1e-6), (100, 1e-3), (100, 6e-3), (1000, 1e-6), (1000, 1e-3), (1000, 12e-3)]}
CASES |= {f"{name}, {1e3 * depth:g} mm": (fibres, mu, k1, k2, depth, kappa, angle, 0.25e-3)
          for name, (depths, mu, k1, k2, kappa, angle) in ARTERIES.items() for depth in depths}
CASES |= {f"skin {contrast} times stiffer, n = {n}": (skin, contrast, n) for contrast in (10, 100) for n in (4, 8, 16)}
CASES |= {f"column, {1e3 * depth:g} mm": (column, depth) for depth in (5e-3, 10e-3)}
CASES |= {f"bone of {young:g} Pa, P2": (bone, young) for young in (1e8, 1e10)}
CASES |= {f"capsule with fibres, {1e3 * depth:g} mm": (capsule, depth) for depth in (2e-3, 6e-3)}
CASES |= {f"{law}, nu = 0.499": (nearly_incompressible, strain) for law, strain in (("linear", "e"), ("st-venant-kirchhoff", "E"))}
CASES |= {"pressed in by 12 of 40 mm, nu = 0.49": (press, (0.04,) * 3, (4, 4, 4), 12e-3, MIDDLE, 0.0101, 1, 149e3),
          "pyramid, pressed in at its tip": (press, (0.04,) * 3, (4, 4, 8), 4e-3, MIDDLE, 0.003, 0.1),
          "one layer on bone": (press, (0.04, 0.04, 0.01), (4, 4, 1), 2e-3, (0.02, 0.02, 0.01), 0.0075),
          "flat elements": (press, (0.04,) * 3, (4, 4, 64), 6e-3)}

getfem.util_trace_level(0)
getfem.util_warning_level(0)

if __name__ == "__main__":
    for name, (run, *arguments) in CASES.items():
        if len(sys.argv) > 1 and not any(part in name for part in sys.argv[1:]):
            continue
        force, iterations = run(*arguments)
        print(f"{name}: {np.linalg.norm(force):.6g} N, {iterations} iterations", flush=True)
