// A quarter of an incompressible block under a pressure on the middle of its top, up to 69 %
// compression (Reese, Wriggers, Reddy 2000; p/p0 = 80). The top cannot move sideways, so a dead
// load and a follower load are the same.
#include <fmt/format.h>

#include "tests/verification/rig.hpp"

namespace palpate::verification {
namespace {

constexpr double mu_of_block = 80.194e6,
                 p0 = 4e6;  ///< Pa; lengths in metres, only ratios matter

/// Returns the block with the symmetry planes x = 1 and y = 0, so that the diagonals of the top run
/// towards its middle, (1, 0, 1). `load` is p/p0.
BodyModel block(const Discretization& discretization, int n, double load) {
  BodyModel body = bodyOf(cubeMesh(1, n), discretization, neoHookean(mu_of_block));
  hold(body, "xmax", "x");
  hold(body, "ymin", "y");
  hold(body, "zmin", "z");
  hold(body, "zmax", "xy");
  const auto pressed = facesWhere(body.mesh, [](const Eigen::Vector3d& X) {
    return X[2] > 1 - 1e-9 && X[0] > 0.5 - 1e-9 && X[1] < 0.5 + 1e-9;
  });
  addTraction(body, pressed, {0, 0, -load * p0});
  return body;
}

/// Returns how far the middle of the top moves down, relative to the block's height.
double depth(const Discretization& discretization, int n, double load, int steps) {
  const NewtonResult result = Rig(block(discretization, n, load)).loadInSteps(steps);
  const int middle_of_top = n + (n + 1) * (n + 1) * n;
  return -ofNode(result.state.u, middle_of_top)[2];
}

Row depthRow(const std::string& element, const Discretization& discretization, int n, double load,
             double reference, double tolerance) {
  return {fmt::format("{}, n = {}, p/p0 = {}: depth", element, n, load),
          depth(discretization, n, load, 1), reference, tolerance};
}

Row sameFromSteps(const std::string& element, const Discretization& discretization, int n) {
  return {fmt::format("{}, n = {}, p/p0 = 80: 16 load steps (reference: 1)", element, n),
          depth(discretization, n, 80, 16), depth(discretization, n, 80, 1), 1e-8};
}

/// Compares the depth found by Taylor-Hood elements at p/p0 = 20, 40, 60 and 80 with its limit,
/// which was extrapolated from fine meshes.
std::vector<Row> rowsOfLimits(int n, double tolerance) {
  const auto row = [&](double load, double limit) {
    return depthRow("P2/P1", taylor_hood, n, load, limit, tolerance);
  };
  return {row(20, 0.2197), row(40, 0.4246), row(60, 0.5846), row(80, 0.692)};
}

constexpr Discretization stabilized_J = {DisplacementSpace::p1, PressureSpace::p1_stabilized,
                                         Constraint::det_F_minus_1};

}  // namespace

std::vector<Case> punchCases() {
  return {{"block-punch", false,
           [] {
             return joined({rowsOfLimits(6, 0.01),
                            {depthRow("P1-stabilized, det F - 1", stabilized_J, 8, 80, 0.692, 0.03),
                             sameFromSteps("P2/P1", taylor_hood, 4),
                             sameFromSteps("P1-stabilized", stabilized, 8)}});
           }},
          {"block-punch-fine", true, [] {
             return joined({rowsOfLimits(8, 0.005), {sameFromSteps("P2/P1", taylor_hood, 8)}});
           }}};
}

}  // namespace palpate::verification
