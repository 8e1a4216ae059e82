// A St. Venant-Kirchhoff cube under a dead pressure reaches a limit point at stretch 1/sqrt(3),
// where its tangent is no longer positive definite. Beyond the pressure E/(3 sqrt(3)) there is no
// equilibrium.
#include <cmath>

#include "tests/verification/rig.hpp"

namespace palpate::verification {
namespace {

constexpr double edge_of_cube = 0.1;  ///< metres
const double exact_stretch = 1 / std::sqrt(3), exact_pressure = tissue::young / (3 * std::sqrt(3));

/// Returns a cube on three symmetry planes, with a pressure of 1 Pa (per area at rest) on the side
/// xmax.
BodyModel cube() {
  BodyModel body = bodyOf(cubeMesh(edge_of_cube, 1), p1_displacement, stVenantKirchhoff());
  holdSymmetryPlanes(body);
  const auto pressed = facesWhere(
      body.mesh, [](const Eigen::Vector3d& X) { return X[0] > edge_of_cube * (1 - 1e-9); });
  addTraction(body, pressed, {-1, 0, 0});
  return body;
}

/// Returns the equilibrium with the side xmax held at `stretch`, which may lie on either side of
/// the limit point. It is reached in steps.
State compressedTo(double stretch) {
  BodyModel body = cube();
  hold(body, "xmax", "x");
  Rig rig(body);
  rig.setLoadFactor(0);
  State state = rig.system().restState();
  constexpr int steps = 10;
  for (int step = 1; step <= steps; ++step) {
    for (const std::int32_t node : body.mesh.node_groups.at("xmax"))
      ofNode(state.u, node)[0] = (stretch - 1) * edge_of_cube * step / steps;
    state = rig.equilibrium(std::move(state)).state;
  }
  return state;
}

/// Returns the number of negative eigenvalues of the tangent when the side xmax is free. If there
/// are none, the state is stable under the load that keeps it.
int negativeUnderLoad(double stretch) {
  const State state = compressedTo(stretch);
  return Rig(cube()).negativeEigenvalues(state);
}

/// Returns the stretch at which the tangent ceases to be positive definite, found by bisection.
double stretchOfLimitPoint() {
  double stable = 0.65, unstable = 0.5;
  while (stable - unstable > 1e-8) {
    const double middle = (stable + unstable) / 2;
    (negativeUnderLoad(middle) == 0 ? stable : unstable) = middle;
  }
  return stable;
}

/// Raises the pressure while there is a stable equilibrium, and halves the step when there is none.
/// Returns rows for the last pressure and its stretch.
std::vector<Row> rowsOfLastLoad() {
  Rig rig(cube());
  double reached = 0, step = 1000;
  State state = rig.system().restState();
  while (step > 1e-6) {
    rig.setLoadFactor(reached + step);
    NewtonResult result = rig.seek(state);
    if (result.cause == Cause::none && rig.negativeEigenvalues(result.state) == 0) {
      reached += step;
      state = std::move(result.state);
    } else {
      step /= 2;
    }
  }
  const std::int32_t pressed = rig.system().model().mesh.node_groups.at("xmax").front();
  return {{"limit point, last load with an equilibrium", reached, exact_pressure, 1e-6, "Pa"},
          {"limit point, stretch at that load", 1 + ofNode(state.u, pressed)[0] / edge_of_cube,
           exact_stretch, 1e-3}};
}

std::vector<Row> limitPointRows() {
  return joined(
      {{{"limit point, tangent no longer definite: stretch", stretchOfLimitPoint(), exact_stretch,
         1e-5}},
       rowsOfLastLoad(),
       {{"negative eigenvalues at stretch 0.60", double(negativeUnderLoad(0.60)), 0, 0},
        {"negative eigenvalues at stretch 0.55", double(negativeUnderLoad(0.55)), 1, 0}}});
}

}  // namespace

std::vector<Case> limitPointCases() { return {{"st-venant-limit-point", false, limitPointRows}}; }

}  // namespace palpate::verification
