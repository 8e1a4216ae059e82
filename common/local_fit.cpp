#include "common/local_fit.hpp"

#include <Eigen/QR>
#include <cmath>

namespace palpate {
namespace {

constexpr std::size_t n_data = 10;  // of one source: energy, three slopes, six curvatures

constexpr std::array<Orders, n_data> data_orders = {{{0, 0, 0},
                                                     {1, 0, 0},
                                                     {0, 1, 0},
                                                     {0, 0, 1},
                                                     {2, 0, 0},
                                                     {1, 1, 0},
                                                     {1, 0, 1},
                                                     {0, 2, 0},
                                                     {0, 1, 1},
                                                     {0, 0, 2}}};

int total(const Orders& orders) {
  return orders[0] + orders[1] + orders[2];
}

std::vector<Orders> makeOrders() {
  std::vector<Orders> all;
  for (int sum = 0; sum <= LocalPolynomial::degree; ++sum)
    for (int a = sum; a >= 0; --a)
      for (int b = sum - a; b >= 0; --b) all.push_back({a, b, sum - a - b});
  return all;
}

constexpr int termsUpTo(int degree) {
  return (degree + 1) * (degree + 2) * (degree + 3) / 6;
}

/// x^n / n!, zero for n < 0.
double power(double x, int n) {
  constexpr std::array<double, 6> factorial = {1, 1, 2, 6, 24, 120};
  if (n < 0) return 0;
  double result = 1 / factorial[static_cast<std::size_t>(n)];
  for (; n > 0; --n) result *= x;
  return result;
}

/// Derivative `wanted` at x of the term x^a/a! y^b/b! z^c/c!.
double termAt(const Orders& term, const Orders& wanted, const Eigen::Vector3d& x) {
  return power(x[0], term[0] - wanted[0]) * power(x[1], term[1] - wanted[1]) *
         power(x[2], term[2] - wanted[2]);
}

/// The ten data in units in which `scale` is 1.
Eigen::Matrix<double, n_data, 1> dataOf(const Equilibrium& e, double scale) {
  const Eigen::Vector3d slope = -scale * e.force;
  const Eigen::Matrix3d curvature = -0.5 * scale * scale * (e.stiffness + e.stiffness.transpose());
  Eigen::Matrix<double, n_data, 1> data;
  data << e.energy, slope, curvature(0, 0), curvature(0, 1), curvature(0, 2), curvature(1, 1),
      curvature(1, 2), curvature(2, 2);
  return data;
}

// Chosen by the errors at 1000 exact solutions in balls of 60 and 100 mm, spacings from 15 to 33 mm; factors
// of ten in either direction change them by some 10 %, but for a fifth degree without penalty, which doubles
// those at the rim. What all sources together leave open (a direction in which none lies) tends to zero.
constexpr double distance_power = 4;  // of the weight of a source: its data are told so much less accurately
constexpr std::array<double, 6> penalty_extrapolating = {0, 0, 0, 1e-6, 1e-2, 1e-1},
                                penalty_completing = {0, 0, 0, 1e-6, 1e-4, 1e-1};

/// Rows: the weighted data of the sources, then the penalties. Columns: the terms of degree `from` to
/// `degree`.
struct WeightedSystem {
  WeightedSystem(const std::vector<FitSource>& sources, std::int32_t edge, int from, int degree,
                 const std::array<double, 6>& penalty)
      : weights(static_cast<Eigen::Index>(n_data * sources.size())) {
    const int first = termsUpTo(from - 1), unknowns = termsUpTo(degree) - first;
    matrix = Eigen::MatrixXd::Zero(weights.size() + unknowns, unknowns);
    const auto term = [first](int t) { return LocalPolynomial::orders(static_cast<std::size_t>(first + t)); };
    for (Eigen::Index row = 0; row < weights.size(); ++row) {
      const auto r = static_cast<std::size_t>(row);
      const LatticePoint& o = sources[r / n_data].offset;
      const Eigen::Vector3d x = Eigen::Vector3d(o[0], o[1], o[2]) / edge;
      weights[row] = std::pow(x.norm(), -distance_power);
      for (int t = 0; t < unknowns; ++t)
        matrix(row, t) = weights[row] * termAt(term(t), data_orders[r % n_data], x);
    }
    for (int t = 0; t < unknowns; ++t)
      matrix(weights.size() + t, t) = penalty[static_cast<std::size_t>(total(term(t)))];
  }

  Eigen::MatrixXd matrix;
  Eigen::VectorXd weights;  ///< per datum
};

}  // namespace

const Orders& LocalPolynomial::orders(std::size_t index) {
  static const std::vector<Orders> all = makeOrders();
  return all[index];
}

Equilibrium LocalPolynomial::at(const Eigen::Vector3d& offset) const {
  const Eigen::Vector3d x = offset / scale;
  Eigen::Matrix<double, n_data, 1> value = Eigen::Matrix<double, n_data, 1>::Zero();
  for (std::size_t d = 0; d < n_data; ++d)
    for (std::size_t t = 0; t < terms; ++t)
      value[static_cast<Eigen::Index>(d)] +=
          termAt(orders(t), data_orders[d], x) * derivatives[static_cast<Eigen::Index>(t)];
  Equilibrium e;
  e.energy = value[0];
  e.force = -value.segment<3>(1) / scale;
  e.stiffness << value[4], value[5], value[6], value[5], value[7], value[8], value[6], value[8], value[9];
  e.stiffness /= -scale * scale;
  return e;
}

const Eigen::MatrixXd& LocalFits::completing(const std::vector<FitSource>& sources, std::int32_t edge) {
  Key key = {edge};
  for (const FitSource& source : sources) key.insert(key.end(), source.offset.begin(), source.offset.end());
  const auto known = operators_.find(key);
  if (known != operators_.end()) return known->second;
  const WeightedSystem system(sources, edge, 3, LocalPolynomial::degree, penalty_completing);
  const Eigen::Index rows = system.matrix.rows(), data = system.weights.size();
  Eigen::MatrixXd right = Eigen::MatrixXd::Zero(rows, data);
  right.topRows(data) = system.weights.asDiagonal();
  return operators_.emplace(std::move(key), system.matrix.householderQr().solve(right)).first->second;
}

LocalPolynomial LocalFits::extrapolate(const std::vector<FitSource>& sources, std::int32_t edge,
                                       int degree) const {
  LocalPolynomial result;
  result.scale = unit_ * edge;
  const WeightedSystem system(sources, edge, 0, degree, penalty_extrapolating);
  Eigen::VectorXd right = Eigen::VectorXd::Zero(system.matrix.rows());
  for (std::size_t s = 0; s < sources.size(); ++s)
    right.segment<n_data>(static_cast<Eigen::Index>(n_data * s)) = dataOf(*sources[s].data, result.scale);
  right.head(system.weights.size()).array() *= system.weights.array();
  result.derivatives.head(system.matrix.cols()) = system.matrix.householderQr().solve(right);
  return result;
}

LocalPolynomial LocalFits::complete(const Equilibrium& own, const std::vector<FitSource>& sources,
                                    std::int32_t edge) {
  LocalPolynomial result;
  result.scale = unit_ * edge;
  result.derivatives.head<n_data>() = dataOf(own, result.scale);
  if (sources.empty()) return result;
  Eigen::VectorXd data(static_cast<Eigen::Index>(n_data * sources.size()));
  for (std::size_t s = 0; s < sources.size(); ++s) {
    const LatticePoint& o = sources[s].offset;
    data.segment<n_data>(static_cast<Eigen::Index>(n_data * s)) =
        dataOf(*sources[s].data, result.scale) -
        dataOf(result.at(unit_ * Eigen::Vector3d(o[0], o[1], o[2])), result.scale);
  }
  result.derivatives.tail<LocalPolynomial::terms - n_data>() = completing(sources, edge) * data;
  return result;
}

}  // namespace palpate
