"""The same body in GetFEM, the library of the 2010 paper (python3-getfem), as far as its Newton gets in a given time: the
same mesh, elements, law, constraint and stabilisation, in its language for weak forms; Dirichlet values by multipliers,
as in the paper, whose sum is the force. MUMPS, one thread."""
import time

import numpy as np
import scipy.spatial

from record import needed

getfem = needed("getfem")

from peers import body

# Potential of F; docs/solver.md, "The Lagrangian", without the stabilisation.
POTENTIAL = ("C10*(pow(Det(F),-2/3)*Norm_sqr(F)-3) + C01*(pow(Det(F),-4/3)*(sqr(Norm_sqr(F))-Norm_sqr(F'*F))/2-3)"
             " - p*log(Det(F))")


class GetfemBody:
    def __init__(self, some_body, fixed):
        getfem.util_trace_level(0)
        getfem.util_warning_level(0)
        self.law = some_body.law
        mesh = getfem.Mesh("empty", 3)
        mesh.add_convex(getfem.GeoTrans("GT_PK(3,1)"), np.ascontiguousarray(some_body.points[some_body.tetrahedra].transpose(2, 1, 0)))
        tree = scipy.spatial.cKDTree(some_body.points)
        self.u, self.p = getfem.MeshFem(mesh, 3), getfem.MeshFem(mesh, 1)
        for fem in self.u, self.p:
            fem.set_fem(getfem.Fem("FEM_PK(3,1)"))
        self.u_node, self.p_node = (tree.query(fem.basic_dof_nodes().T)[1] for fem in (self.u, self.p))
        self.u_axis = np.arange(len(self.u_node)) % 3
        model = self.model = getfem.Model("real")
        model.add_fem_variable("u", self.u)
        model.add_fem_variable("p", self.p)
        model.add_initialized_data("C10", [some_body.law.c10])
        model.add_initialized_data("C01", [some_body.law.c01])
        model.add_macro("F", "(Id(3)+Grad_u)")
        exact = getfem.Integ("IM_TETRAHEDRON(1)")  # F is constant in an element, and the linear p is a factor
        model.add_nonlinear_term(getfem.MeshIm(mesh, exact), POTENTIAL)
        model.add_explicit_matrix("p", "p", self.stabilisation(some_body))
        held = np.flatnonzero(np.isin(self.u_node, fixed))
        self.moved = np.flatnonzero(np.isin(self.u_node, some_body.tool_nodes))
        self.constrain("held", held)
        self.tool = self.constrain("tool", self.moved)

    def stabilisation(self, some_body):
        """Stabilisation of the pressure equations, symmetric: -V alpha / mu VARIANCE of each element."""
        place = np.empty(len(some_body.points), int)
        place[self.p_node] = np.arange(len(self.p_node))
        made = getfem.Spmat("empty", len(place), len(place))
        for nodes, volume in zip(place[some_body.tetrahedra], some_body.volume):
            made.add(nodes, nodes, -body.STABILISATION / some_body.law.shear_modulus * volume * body.VARIANCE)
        return made

    def constrain(self, name, unknowns):
        rows = getfem.Spmat("empty", len(unknowns), self.u.nbdof())
        for i, unknown in enumerate(unknowns):
            rows.assign(i, int(unknown), 1.0)
        self.model.add_variable(name, len(unknowns))
        return self.model.add_constraint_with_multipliers("u", name, rows, np.zeros(len(unknowns)))

    def force(self):
        """Force of the tissue on the tool."""
        multipliers = self.model.variable("tool")
        return np.array([multipliers[self.u_axis[self.moved] == axis].sum() for axis in range(3)])

    def start(self, displacement, pressure, place):
        """Solves to an exact equilibrium with the tool at `place`, from nodal displacements (m) and pressures (Pa)."""
        self.model.set_variable("u", displacement[self.u_node, self.u_axis].astype(float))
        self.model.set_variable("p", pressure[self.p_node].astype(float))
        for name in "held", "tool":
            self.model.set_variable(name, np.zeros(len(self.model.variable(name))))
        self.move(place)
        return self.iterate(20)

    def move(self, place):
        self.model.set_private_rhs(self.tool, np.asarray(place, float)[self.u_axis[self.moved]])

    def iterate(self, most):
        """Newton from the current state; returns whether it converged. Uses the fastest of GetFEM's line searches: whole
        steps, halved only if the residual explodes (the default takes twice as many iterations)."""
        return bool(self.model.solve("max_iter", most, "max_res", 1e-7, "lsolver", "mumps", "lsearch", "simplest",
                                     "alpha max ratio", 1e4, "alpha min", 0.05, "alpha mult", 0.5)[1])

    def kept(self):
        return {name: self.model.variable(name) for name in ("u", "p", "held", "tool")}

    def history(self, start, place, most=12):
        """[{seconds, force, converged}] after each iteration from the stored `start` on the way to `place`: seconds of
        processor time since the start."""
        for name, value in start.items():
            self.model.set_variable(name, value)
        self.move(place)
        passed, made = 0.0, []
        while len(made) < most and not (made and made[-1]["converged"]):
            began = time.process_time()
            converged = self.iterate(1)
            passed += time.process_time() - began
            made.append({"seconds": passed, "force": self.force().tolist(), "converged": converged})
        return made
