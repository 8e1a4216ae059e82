#!/usr/bin/python3
"""Compares forces of the gallery's scenes by palpate with those by GetFEM, an independent library (python3-getfem).

    tests/measure/gallery/reference.py SCENE.toml DATASET.h5 [--touches 4] [--finer FINER.toml]
    PALPATE_BIN_DIR: the programs (build/release/bin)

Mesh and elements are the same; law, constraint, stabilisation, gravity and the finger's mean are implemented independently,
from docs/solver.md and docs/scene.md, in GetFEM's language for weak forms and NumPy. Prints one JSON object per touch: the
force by GetFEM, by `palpate solve` and by `palpate query`, and the differences relative to the first; with --finer also the
force by `palpate solve` on a finer mesh of the same scene, and the difference relative to that.
"""
import argparse
import json
import os
import pathlib
import subprocess
import sys
import tomllib

import getfem
import numpy as np
import scipy.spatial

ROOT = pathlib.Path(__file__).resolve().parents[3]
PALPATE = pathlib.Path(os.environ.get("PALPATE_BIN_DIR", ROOT / "build/release/bin")).resolve() / "palpate"
VARIANCE = (np.ones((4, 4)) + np.eye(4)) / 20 - 1 / 16  # <(p - <p>)^2> = p^T VARIANCE p of an element's nodal pressures

ISOCHORIC = "pow(Det(F),-2/3)*Norm_sqr(F)"
NEO_HOOKEAN = f"mu/2*({ISOCHORIC}-3)"
MOONEY_RIVLIN = f"C10*({ISOCHORIC}-3) + C01*(pow(Det(F),-4/3)*(sqr(Norm_sqr(F))-Norm_sqr(F'*F))/2-3)"
# The variation of k1/(2 k2) (exp(k2 E^2) - 1), E = max(0, j4 - 1): GetFEM cannot differentiate a positive part twice.
STRETCH = "pos_part(pow(Det(F),-2/3)*Norm_sqr(F*a)-1)"
FIBRES = (f"k1*{STRETCH}*exp(k2*sqr({STRETCH}))*pow(Det(F),-2/3)"
          "*(2*(F*a).(Grad_Test_u*a)-2/3*Norm_sqr(F*a)*Trace(Inv(F)*Grad_Test_u))")
CONSTRAINT = " - p*log(Det(F))"


def supported(fixed):
    """Returns a test whether places (3 x n) are in one of the half-spaces of the table [fixed]."""
    planes = [("xyz".index(plane["axis"]), plane["at"], side) for side, plane in fixed.items()]
    return lambda places: np.any([places[axis] < at if side == "below" else places[axis] > at for axis, at, side in planes], axis=0)


class Scene:
    """Points, tetrahedra, parts, fibres and fixed nodes of a scene file with a Gmsh 2.2 mesh."""

    def __init__(self, file):
        self.text = tomllib.loads(file.read_text(encoding="utf-8"))
        assert self.text["length_unit"] == "m"
        lines = iter((file.parent / self.text["mesh"]).read_text(encoding="utf-8").splitlines())
        names, elements, vectors = {}, [], {}
        for line in lines:
            if line == "$PhysicalNames":
                for _ in range(int(next(lines))):
                    dimension, number, name = next(lines).split()
                    names[int(dimension), int(number)] = name.strip('"')
            elif line == "$Nodes":
                nodes = np.array([next(lines).split() for _ in range(int(next(lines)))], float)
            elif line == "$Elements":
                elements = [list(map(int, next(lines).split())) for _ in range(int(next(lines)))]
            elif line == "$ElementData":
                header = [next(lines) for _ in range(8)]
                vectors = {int(row[0]): row[1:] for row in (np.array(next(lines).split(), float) for _ in range(int(header[7])))}
        row = {int(number): i for i, number in enumerate(nodes[:, 0])}
        self.points = nodes[:, 1:]
        volumes = [e for e in elements if e[1] == 4]
        self.tetrahedra = np.array([[row[n] for n in e[3 + e[2]:]] for e in volumes])
        self.part = [names[3, e[3]] for e in volumes]
        self.fibre = np.array([vectors[e[0]] for e in volumes]) if vectors else None
        self.fixed = self.held(names, elements, row)
        faces = np.sort(self.tetrahedra[:, [[1, 2, 3], [0, 2, 3], [0, 1, 3], [0, 1, 2]]].reshape(-1, 3), axis=1)
        unique, count = np.unique(faces, axis=0, return_counts=True)
        self.surface = unique[count == 1]

    def held(self, names, elements, row):
        fixed = self.text["fixed"]
        if {"below", "above"} & set(fixed):
            return np.flatnonzero(supported(fixed)(self.points.T))
        if "sphere" in fixed:
            return np.flatnonzero(np.linalg.norm(self.points - fixed["sphere"]["center"], axis=1) <= fixed["sphere"]["radius"])
        return np.unique([row[n] for e in elements if names.get(({2: 2, 4: 3}.get(e[1], 0), e[3])) == fixed["group"]
                          for n in e[3 + e[2]:]])

    def material(self, part):
        return next((region for region in self.text.get("region", []) if region["group"] == part), None) or self.text["material"]

    def finger(self, place, radius, parts=40):
        """Weights of the nodes: surface integrals of shape functions times the bump, by the midpoints of small triangles."""
        i, j = np.array([(i, j) for i in range(parts) for j in range(parts - i)]).T
        up = np.stack([i + 1 / 3, j + 1 / 3], axis=1)
        down = np.stack([i + 2 / 3, j + 2 / 3], axis=1)[i + j < parts - 1]
        a = np.concatenate([up, down]) / parts
        shape = np.column_stack([1 - a.sum(axis=1), a])
        weights = np.zeros(len(self.points))
        for triangle in self.surface:
            corners = self.points[triangle]
            squares = ((shape @ corners - place) ** 2).sum(axis=1) / radius**2
            bump = np.where(squares < 1, (1 - squares) ** 2, 0)
            if bump.any():
                area = np.linalg.norm(np.cross(corners[1] - corners[0], corners[2] - corners[0])) / 2
                weights[triangle] += area / len(shape) * bump @ shape
        weights[self.fixed] = 0
        return weights / weights.sum()


class Body:
    def __init__(self, scene):
        getfem.util_trace_level(0)
        getfem.util_warning_level(0)
        self.scene = scene
        mesh = self.mesh = getfem.Mesh("empty", 3)
        mesh.add_convex(getfem.GeoTrans("GT_PK(3,1)"), np.ascontiguousarray(scene.points[scene.tetrahedra].transpose(2, 1, 0)))
        self.u, self.p, self.flat = getfem.MeshFem(mesh, 3), getfem.MeshFem(mesh, 1), getfem.MeshFem(mesh, 1)
        for fem in self.u, self.p:
            fem.set_fem(getfem.Fem("FEM_PK(3,1)"))
        self.flat.set_fem(getfem.Fem("FEM_PK(3,0)"))
        tree = scipy.spatial.cKDTree(scene.points)
        self.u_node, self.p_node = (tree.query(fem.basic_dof_nodes().T)[1] for fem in (self.u, self.p))
        self.u_axis = np.arange(len(self.u_node)) % 3
        middles = scene.points[scene.tetrahedra].mean(axis=1)
        distance, self.flat_element = scipy.spatial.cKDTree(middles).query(self.flat.basic_dof_nodes().T)
        assert distance.max() < 1e-9 and len(set(self.flat_element)) == len(middles)
        self.rest = None

    def build(self, tool=None):
        """The model at rest, with the finger of these weights (n) or without one."""
        model = self.model = getfem.Model("real")
        model.add_fem_variable("u", self.u)
        model.add_fem_variable("p", self.p)
        model.add_macro("F", "(Id(3)+Grad_u)")
        mim = getfem.MeshIm(self.mesh, getfem.Integ("IM_TETRAHEDRON(2)"))
        model.add_nonlinear_term(mim, self.potential(mim) + CONSTRAINT)
        model.add_explicit_matrix("p", "p", self.stabilisation())
        if "gravity" in self.scene.text:
            pull = self.scene.text["material"]["density"] * np.array(self.scene.text["gravity"]["acceleration"], float)
            model.add_initialized_data("pull", pull)
            model.add_source_term_brick(mim, "u", "pull")
        held = np.flatnonzero(np.isin(self.u_node, self.scene.fixed))
        self.constrain("held", [{unknown: 1.0} for unknown in held])
        if tool is None:
            return
        rows = [{unknown: tool[self.u_node[unknown]] for unknown in np.flatnonzero((self.u_axis == axis) & (tool[self.u_node] > 0))}
                for axis in range(3)]
        self.tool = self.constrain("tool", rows)
        self.mean_at_rest = np.zeros(3)
        if self.rest is not None:
            for name, value in self.rest.items():
                model.set_variable(name, value)
            u = self.rest["u"]
            self.mean_at_rest = np.array([sum(weight * u[unknown] for unknown, weight in row.items()) for row in rows])

    def per_element(self, name, values):
        self.model.add_initialized_fem_data(name, self.flat, np.asarray(values)[self.flat_element].T)

    def potential(self, mim):
        materials = [self.scene.material(part) for part in self.scene.part]
        laws = {material["law"] for material in materials}
        if laws == {"mooney-rivlin"}:
            for name in "c10", "c01":
                self.per_element(name.upper(), [material[name] for material in materials])
            self.mu = np.array([2 * (material["c10"] + material["c01"]) for material in materials])
            return MOONEY_RIVLIN
        self.mu = np.array([material["mu"] for material in materials])
        self.per_element("mu", self.mu)
        if laws == {"neo-hookean"}:
            return NEO_HOOKEAN
        assert laws == {"holzapfel-gasser-ogden"}
        for name in "k1", "k2":
            self.per_element(name, [material[name] for material in materials])
        self.per_element("a", self.scene.fibre / np.linalg.norm(self.scene.fibre, axis=1)[:, None])
        self.model.add_nonlinear_term(mim, FIBRES)
        return NEO_HOOKEAN

    def stabilisation(self):
        place = np.empty(len(self.scene.points), int)
        place[self.p_node] = np.arange(len(self.p_node))
        made = getfem.Spmat("empty", len(place), len(place))
        a, b, c, d = (self.scene.points[self.scene.tetrahedra[:, i]] for i in range(4))
        volume = np.abs(np.einsum("ij,ij->i", np.cross(b - a, c - a), d - a)) / 6
        for nodes, v, mu in zip(place[self.scene.tetrahedra], volume, self.mu):
            made.add(nodes, nodes, -v / mu * VARIANCE)
        return made

    def constrain(self, name, rows):
        matrix = getfem.Spmat("empty", len(rows), self.u.nbdof())
        for i, row in enumerate(rows):
            for unknown, weight in row.items():
                matrix.assign(i, int(unknown), float(weight))
        self.model.add_variable(name, len(rows))
        return self.model.add_constraint_with_multipliers("u", name, matrix, np.zeros(len(rows)))

    def iterate(self):
        return bool(self.model.solve("max_iter", 40, "max_res", 1e-8, "lsolver", "mumps", "lsearch", "simplest",
                                     "alpha max ratio", 1e4, "alpha min", 0.05, "alpha mult", 0.5)[1])

    def sag(self, steps=5):
        """Computes the rest state under gravity, by load steps."""
        self.build()
        pull = self.model.variable("pull").copy()
        for step in range(steps):
            self.model.set_variable("pull", pull * (step + 1) / steps)
            assert self.iterate(), "no rest state"
        self.rest = {name: self.model.variable(name).copy() for name in ("u", "p", "held")}

    def force(self, weights, displacement, steps=8):
        """Force of the tissue on the displaced finger; None if Newton does not converge."""
        self.build(weights)
        for step in range(steps):
            self.model.set_private_rhs(self.tool, self.mean_at_rest + np.asarray(displacement) * (step + 1) / steps)
            if not self.iterate():
                return None
        return np.array(self.model.variable("tool"))


def asked(verb, file, active, touches):
    given = "".join(" ".join(f"{x:.12g}" for x in touch) + "\n" for touch in touches)
    words = [PALPATE, verb, file, "--active", active, "--at", "-", "--displacement", "-", "--json", "-q"]
    return [json.loads(line) for line in subprocess.run(words, input=given, stdout=subprocess.PIPE, text=True).stdout.splitlines()]


def touches_of(scene, count, depth):
    """The same places all over the surface, with displacements that push and slide, each time."""
    random = np.random.default_rng(1)
    points, result = scene.points, []
    middle = points.mean(axis=0)
    free = scene.surface[~np.isin(scene.surface, scene.fixed).any(axis=1)]
    for triangle in free[random.permutation(len(free))[:8 * count]]:
        corners = points[triangle]
        normal = np.cross(corners[1] - corners[0], corners[2] - corners[0])
        normal /= np.linalg.norm(normal)
        inward = -normal if normal @ (corners.mean(axis=0) - middle) > 0 else normal
        aside = np.cross(inward, random.normal(size=3))
        pushed = inward + 0.4 * aside / np.linalg.norm(aside)
        result.append([*corners.mean(axis=0), *(depth * pushed / np.linalg.norm(pushed))])
    return result


def main():
    options = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    options.add_argument("scene", type=pathlib.Path)
    options.add_argument("dataset", type=pathlib.Path)
    options.add_argument("--touches", type=int, default=4)
    options.add_argument("--finer", type=pathlib.Path)
    given = options.parse_args()
    scene = Scene(given.scene)
    (active,) = scene.text["active"]
    touches = touches_of(scene, given.touches, 0.6 * scene.text["workspace"]["radius"])
    interpolated = asked("query", given.dataset, active["name"], touches)
    most = 3.3  # N: the limit of the device
    kept = [(touch, answer) for touch, answer in zip(touches, interpolated)
            if answer["inside"] and np.linalg.norm(answer["force"]) < most][:given.touches]
    exact = asked("solve", given.scene, active["name"], [touch for touch, _ in kept])
    finer = asked("solve", given.finer, active["name"], [touch for touch, _ in kept]) if given.finer else [None] * len(kept)
    body = Body(scene)
    if "gravity" in scene.text:
        body.sag()
    for (touch, query), solve, refined in zip(kept, exact, finer):
        force = body.force(scene.finger(np.array(solve["at"]), active["radius"]), touch[3:])
        row = {"at": solve["at"], "displacement": touch[3:], "getfem": None if force is None else force.tolist(),
               "solve": solve["force"], "query": query["force"]}
        if force is not None and solve["force"] is not None:
            row["solve_differs"], row["query_differs"] = (np.linalg.norm(np.array(answer["force"]) - force) / np.linalg.norm(force)
                                                          for answer in (solve, query))
        if refined and refined["force"] is not None and solve["force"] is not None:
            row["finer"] = refined["force"]
            row["finer_differs"] = (np.linalg.norm(np.array(solve["force"]) - refined["force"]) / np.linalg.norm(refined["force"]))
        print(json.dumps(row), flush=True)


if __name__ == "__main__":
    sys.exit(main())
