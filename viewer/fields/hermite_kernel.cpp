#include "viewer/fields/hermite_kernel.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <cmath>

#include "common/base/assertion.hpp"
#include "common/base/index.hpp"

namespace palpate {
namespace {

/// Relative increase of the matrix diagonal, so that the matrix stays regular if two sites nearly
/// coincide.
constexpr double ridge = 1e-10;

/// Variances of the noise of E, T and dT/ds. For comparison, the variances of the kernel are 1, 1
/// and 3 to 9. docs/internals/measurements.md has the errors with other values.
constexpr std::array<double, 3> noise = {0, 1e-4, 3e-3};

/// The axes of up to four successive differentiations.
struct Axes {
  std::array<int, 4> axis{};
  int count = 0;
  void append(const Axes& more) {
    for (int n = 0; n < more.count; ++n) axis[at(count++)] = more.axis[at(n)];
  }
};

Axes axesOf(int quantity) {
  if (quantity == 0) return {};
  if (quantity < 4) return {{quantity - 1}, 1};
  const auto [a, b] = symmetric_axes[at(quantity - 4)];
  return {{a, b}, 2};
}

/// Derivatives of the kernel at one x. The kernel is a function g of q = |x|^2; x is in units of
/// the width.
class Kernel {
 public:
  explicit Kernel(const Eigen::Vector3d& x) : x_(x) {
    const double q = 1 + x.squaredNorm();
    double factor = 1 / std::sqrt(q);
    for (std::size_t n = 0; n < g_.size(); ++n) {
      g_[n] = factor;
      factor *= (-0.5 - static_cast<double>(n)) / q;
    }
  }

  /// Returns the derivative of g(|x|^2) along the axes.
  double derivative(const Axes& axes) const {
    const auto x = [&](int n) { return x_[axes.axis[at(n)]]; };
    const auto d = [&](int m, int n) { return axes.axis[at(m)] == axes.axis[at(n)] ? 1.0 : 0.0; };
    switch (axes.count) {
      case 0: return g_[0];
      case 1: return 2 * g_[1] * x(0);
      case 2: return 4 * g_[2] * x(0) * x(1) + 2 * g_[1] * d(0, 1);
      case 3:
        return 8 * g_[3] * x(0) * x(1) * x(2) +
               4 * g_[2] * (d(0, 1) * x(2) + d(0, 2) * x(1) + d(1, 2) * x(0));
      default:
        return 16 * g_[4] * x(0) * x(1) * x(2) * x(3) +
               8 * g_[3] *
                   (d(0, 1) * x(2) * x(3) + d(0, 2) * x(1) * x(3) + d(0, 3) * x(1) * x(2) +
                    d(1, 2) * x(0) * x(3) + d(1, 3) * x(0) * x(2) + d(2, 3) * x(0) * x(1)) +
               4 * g_[2] * (d(0, 1) * d(2, 3) + d(0, 2) * d(1, 3) + d(0, 3) * d(1, 2));
    }
  }

 private:
  Eigen::Vector3d x_;
  std::array<double, 5> g_;
};

using Block = Eigen::Matrix<double, place_quantities, place_quantities>;

/// Returns the covariances of the quantities at `to` (rows) and `from` (columns), which are
/// derivatives of the kernel with respect to both places. Here, the quantities are the energy and
/// its derivatives, without the minus signs of T and dT/ds.
Block blockOf(const Eigen::Vector3d& to, const Eigen::Vector3d& from, double width) {
  const Kernel kernel((to - from) / width);
  Block block;
  for (int row = 0; row < place_quantities; ++row)
    for (int column = 0; column < place_quantities; ++column) {
      Axes axes = axesOf(row);
      const Axes by_from = axesOf(column);
      axes.append(by_from);
      block(row, column) = (by_from.count % 2 == 0 ? 1 : -1) * kernel.derivative(axes);
    }
  return block;
}

}  // namespace

HermiteWeights hermiteWeights(const Eigen::Vector3d& place,
                              const std::vector<Eigen::Vector3d>& sites, double width) {
  PALPATE_ASSERT(!sites.empty() && width > 0, "Hermite interpolation needs sites and a width");
  const Eigen::Index n = place_quantities * static_cast<Eigen::Index>(sites.size());
  Eigen::MatrixXd matrix = Eigen::MatrixXd::Zero(n, n), to_place(place_quantities, n);
  for (std::size_t column = 0; column < sites.size(); ++column) {
    const auto c = static_cast<Eigen::Index>(place_quantities * column);
    to_place.middleCols<place_quantities>(c) = blockOf(place, sites[column], width);
    // Only the lower triangle is filled, because ldlt() reads only that.
    for (std::size_t row = column; row < sites.size(); ++row)
      matrix.block<place_quantities, place_quantities>(
          static_cast<Eigen::Index>(place_quantities * row), c) =
          blockOf(sites[row], sites[column], width);
  }
  matrix.diagonal() *= 1 + ridge;
  for (Eigen::Index i = 0; i < n; ++i)
    matrix(i, i) += noise[at(axesOf(static_cast<int>(i % place_quantities)).count)];
  Eigen::MatrixXd coefficients = matrix.ldlt().solve(to_place.transpose()).transpose();
  std::vector<Eigen::Index> lower_order;  // E and T
  for (Eigen::Index i = 0; i < n; ++i)
    if (i % place_quantities < 4) lower_order.push_back(i);
  Eigen::RowVectorXd order_difference = coefficients.row(0);
  order_difference(lower_order) -= Eigen::MatrixXd(matrix(lower_order, lower_order))
                                       .ldlt()
                                       .solve(Eigen::VectorXd(to_place.row(0)(lower_order)))
                                       .transpose();
  // Converts the derivatives to metres; in units of the width they are width^order times larger. T
  // and dT/ds are negative derivatives, so their signs change.
  for (Eigen::Index i = 0; i < n; ++i) {
    const int quantity = static_cast<int>(i % place_quantities);
    const double unit = (quantity == 0 ? 1 : -1) * std::pow(width, axesOf(quantity).count);
    coefficients.col(i) *= unit;
    order_difference[i] *= unit;
    if (i < place_quantities) coefficients.row(i) /= unit;
  }
  return {coefficients.cast<float>(), order_difference.cast<float>()};
}

}  // namespace palpate
