"""Both solvers of the reference: GetFEM, with the body described again in its language for weak forms, and Palpate."""
import json
import os
import pathlib
import subprocess
import sys

import getfem
import numpy as np

ROOT = pathlib.Path(__file__).resolve().parents[3]
sys.path[:0] = [str(ROOT / "tests" / "verification"), str(ROOT / "tests" / "measure" / "gallery")]
PALPATE = pathlib.Path(os.environ.get("PALPATE_BIN_DIR", ROOT / "build/release/bin")).resolve() / "palpate"

from hard_reference import ISOCHORIC, Push
from reference import Scene, supported

# dW/dF of W(j1, j2, j4): GetFEM derives tangents of stresses four times as fast as those of energies.
J1 = f"({ISOCHORIC}-3)"
DJ1 = "(2*pow(Det(F),-2/3)*(F-Norm_sqr(F)/3*Inv(F)'))"
DJ2 = "(pow(Det(F),-4/3)*(2*(Norm_sqr(F)*F-F*(F'*F))-2/3*(sqr(Norm_sqr(F))-Norm_sqr(F'*F))*Inv(F)'))"
J4 = "(pow(Det(F),-2/3)*Norm_sqr(F*a)-1)"
FIBRES = f"k1*pos_part({J4})*exp(k2*sqr(pos_part({J4})))*pow(Det(F),-2/3)*(2*(F*a)@a-2/3*Norm_sqr(F*a)*Inv(F)')"
STRESSES = {"neo-hookean": f"mu/2*{DJ1}", "mooney-rivlin": f"C10*{DJ1}+C01*{DJ2}",
            "yeoh": f"(c10+2*c20*{J1}+3*c30*sqr({J1}))*{DJ1}",
            "veronda-westmann": f"c1*c2*exp(c2*{J1})*{DJ1}-c1*c2/2*{DJ2}",
            "holzapfel-gasser-ogden": f"mu/2*{DJ1}+{FIBRES}"}
RESIDUAL = 1e-7  # N


class ByGetfem(Push):
    """A body with a rigid patch: Taylor-Hood elements, one pressure for each material. rest: fields of an earlier patch at
    rest, if there is gravity."""

    def __init__(self, scene, place, radius, rest=None):
        getfem.util_trace_level(0)
        parts = sorted(set(scene.part))
        super().__init__(scene.points, scene.tetrahedra, stiff=lambda _: np.array([parts.index(part) for part in scene.part]))
        for number, part in enumerate(parts):
            self.add(number, scene.material(part))
        self.heavy = "gravity" in scene.text
        if self.heavy:
            self.pull = scene.text["material"]["density"] * np.array(scene.text["gravity"]["acceleration"], float)
            self.model.add_initialized_data("pull", self.pull)
            self.model.add_linear_term(self.integration, "-pull.Test_u")
        self.hold(place, radius, supported=supported(scene.text["fixed"]))
        self.names = ["u", "of_plane", *(f"pressure{number}" for number in range(len(parts)))]
        self.rest = rest or self.sagged()
        self.at_rest = self.rest["u"][self.held]

    def add(self, number, material):
        law = material["law"]
        numbers = {key: value for key, value in material.items() if key not in ("law", "density", "fiber", "group")}
        if law == "mooney-rivlin":
            numbers = {key.upper(): value for key, value in numbers.items()}
        if "fiber" in material:
            numbers["a"] = material["fiber"]
        self.material(number + 1, f"({STRESSES[law]}):Grad_Test_u", f"pressure{number}", **numbers)

    def state(self, *more):
        return {name: self.model.variable(name).copy() for name in (*self.names, *more)}

    def newton(self, iterations=20, halvings=6):
        """GetFEM's own loop does not end once an energy overflows. Steps are halved while the residual explodes."""
        model = self.model
        model.assembly("build_all")
        residual = np.abs(model.rhs()).max()
        for _ in range(iterations):
            if residual < RESIDUAL:
                return True
            at = model.from_variables()
            step = np.ravel(getfem.linsolve_mumps(model.tangent_matrix(), model.rhs()))
            before = residual
            for halving in range(halvings + 1):
                model.to_variables(at + step / 2**halving)
                model.assembly("build_rhs")
                residual = np.abs(model.rhs()).max()
                if residual < 1e3 * before:  # false for NaN
                    break
            else:
                return False
            model.assembly("build_all")
        return bool(residual < RESIDUAL)

    def sagged(self, steps=5):
        """The fields at rest; under gravity by load steps, without the tool."""
        if self.heavy:
            self.model.disable_variable("of_tool")
            self.model.disable_bricks(self.tool)
            for step in range(1, steps + 1):
                self.model.set_variable("pull", self.pull * step / steps)
                if not self.newton():
                    raise RuntimeError("GetFEM finds no rest state")
            self.model.enable_variable("of_tool")
            self.model.enable_bricks(self.tool)
        return self.state()

    def path(self, displacements):
        """Forces (n x 3, N) on the patch at equidistant displacements on a ray from rest, each extrapolated from those before;
        None if Newton does not converge."""
        states = [self.rest | {"of_tool": np.zeros(len(self.held))}]
        forces = []
        for displacement in displacements:
            last = states[-4:]
            weights = {1: [1], 2: [-1, 2], 3: [1, -3, 3], 4: [-1, 4, -6, 4]}[len(last)]
            for name in last[0]:
                self.model.set_variable(name, sum(weight * state[name] for weight, state in zip(weights, last)))
            self.model.set_private_rhs(self.tool, self.at_rest + np.asarray(displacement)[self.axes])
            if not self.newton():
                return None
            states.append(self.state("of_tool"))
            forces.append(self.force())
        return np.array(forces)


def by_palpate(scene_file, place, displacements):
    """Forces (n x 3, N) of `palpate solve`; rows of displacements without a solution are NaN."""
    given = "".join("{:.9g} {:.9g} {:.9g}\n".format(*displacement) for displacement in displacements)
    run = subprocess.run([PALPATE, "solve", scene_file, "--active", place, "--displacement", "-", "--json", "-q"], input=given,
                         capture_output=True, text=True, check=False)
    if run.returncode not in (0, 3):
        raise RuntimeError(run.stderr)
    return [json.loads(line) for line in run.stdout.splitlines()]
