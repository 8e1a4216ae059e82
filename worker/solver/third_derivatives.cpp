#include "worker/solver/third_derivatives.hpp"

#include <algorithm>

#include "common/base/assertion.hpp"
#include "common/base/index.hpp"

namespace palpate {
namespace {

/// Step of the central differences, in mean edge lengths. The strain that it causes is about equal.
/// The truncation error grows with the square of the step, round-off with its inverse.
constexpr double difference = 1e-4;

/// The numbers x_a^T A x_b for all pairs of six columns.
using Pairs = Eigen::Matrix<double, 6, 6>;
using SixColumns = Eigen::Matrix<double, Eigen::Dynamic, 6, Eigen::RowMajor>;

/// Returns d3 Pi [x_a, x_b, x_c] for all b and c, where a is the column `along`.
Pairs elementPart(const System& system, const State& state, const Eigen::MatrixXd& sensitivity,
                  const SixColumns& x, Eigen::Index along, double min_det_F) {
  const double step = difference * system.meanEdge() * std::clamp(min_det_F, 1e-3, 1.0) /
                      std::max(1.0, sensitivity.col(along).topRows(x.rows()).cwiseAbs().maxCoeff());
  Residual residual;
  Tangent up, down;
  system.assemble(system.moved(state, sensitivity.col(along), step, state.displacement), residual,
                  up);
  system.assemble(system.moved(state, sensitivity.col(along), -step, state.displacement), residual,
                  down);
  for (std::size_t entry = 0; entry < up.values.size(); ++entry)
    up.values[entry] = (up.values[entry] - down.values[entry]) / (2 * step);
  return x.transpose() * system.pattern().times(up.values, x);
}

/// The derivatives of B with respect to s, applied to nodal displacements u. Each is one vector.
struct Weighted {
  std::array<Eigen::Vector3d, 3> first;                  ///< B'_j u
  std::array<std::array<Eigen::Vector3d, 3>, 3> second;  ///< B''_jk u
};

template <class Displacement>
Weighted weighted(const FingerWeights& finger, Displacement displacement) {
  Weighted sum;
  for (std::size_t j = 0; j < 3; ++j) {
    sum.first[j].setZero();
    sum.second[j].fill(Eigen::Vector3d::Zero());
  }
  for (std::size_t n = 0; n < finger.nodes.size(); ++n) {
    const Eigen::Vector3d u = displacement(finger.nodes[n]);
    for (int j = 0; j < 3; ++j) {
      sum.first[at(j)] += finger.gradients[n][j] * u;
      for (int k = 0; k < 3; ++k) sum.second[at(j)][at(k)] += finger.curvatures[n](j, k) * u;
    }
  }
  return sum;
}

}  // namespace

void setThirdDerivatives(const System& system, const State& state,
                         const Eigen::MatrixXd& sensitivity, const FingerWeights& finger,
                         Equilibrium& equilibrium) {
  PALPATE_ASSERT(sensitivity.cols() == 6 && system.multipliers() >= 3, "the tool must be a finger");
  const SixColumns x = sensitivity.topRows(system.unknowns());
  const Eigen::Matrix<double, 3, 6> multiplier = sensitivity.bottomRows<3>();
  std::array<Pairs, 3> element;
  for (int a = 0; a < 3; ++a)
    element[at(a)] = elementPart(system, state, sensitivity, x, a, equilibrium.min_det_F);
  std::array<Weighted, 6> moved;
  for (int a = 0; a < 6; ++a)
    moved[at(a)] = weighted(finger, [&](std::int32_t node) -> Eigen::Vector3d {
      Eigen::Vector3d u;
      for (int i = 0; i < 3; ++i) u[i] = x(system.numbers().at({node, i}), a);
      return u;
    });
  const State& rest = system.restState();
  const Weighted whole = weighted(finger, [&](std::int32_t node) -> Eigen::Vector3d {
    return ofNode(state.u, node) - ofNode(rest.u, node);
  });
  // Returns the terms with one derivative of B. s moves along axis k; a and b are the columns of
  // the other two directions.
  const auto of_one_place = [&](int a, int b, int k) {
    return multiplier.col(a).dot(moved[at(b)].first[at(k)]) +
           multiplier.col(b).dot(moved[at(a)].first[at(k)]);
  };
  for (std::size_t c = 0; c < symmetric_axes.size(); ++c) {
    const auto [i, j] = symmetric_axes[c];
    for (int k = 0; k < 3; ++k) {
      const auto row = static_cast<Eigen::Index>(c);
      equilibrium.stiffness_by_p(row, k) =
          -(element[at(i)](j, k) + element[at(j)](k, i) + element[at(k)](i, j)) / 3;
      equilibrium.stiffness_by_s(row, k) =
          of_one_place(i, j, k) - (element[at(i)](j, 3 + k) + element[at(j)](i, 3 + k)) / 2;
      // Here k is the axis of p; i and j are axes of s.
      equilibrium.drive_slope_by_p(row, k) =
          of_one_place(k, 3 + j, i) + of_one_place(k, 3 + i, j) +
          multiplier.col(k).dot(whole.second[at(i)][at(j)]) +
          state.multiplier.dot(moved[at(k)].second[at(i)][at(j)]) -
          (element[at(k)](3 + i, 3 + j) + element[at(k)](3 + j, 3 + i)) / 2;
    }
  }
}

}  // namespace palpate
