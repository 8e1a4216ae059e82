#include "common/interpolation/local_fit.hpp"

#include <cmath>
#include <utility>

#include "common/base/assertion.hpp"
#include "common/base/index.hpp"

namespace palpate {
namespace {

// Largest number of data of a source: the energy, three first, six second and ten third
// derivatives, in the order of the polynomial's terms.
constexpr int most_data = KnownDerivatives::MaxRowsAtCompileTime;
/// Limit of the size of all cached factorisations, in doubles (8 MB). When it is exceeded, the
/// cache is cleared. The fits of the drives of one site use about 150 different factorisations.
constexpr Eigen::Index most_kept = 1 << 20;

int total(const Orders& orders) { return orders[0] + orders[1] + orders[2]; }

std::vector<Orders> makeOrders() {
  std::vector<Orders> all;
  for (int sum = 0; sum <= LocalPolynomial::degree; ++sum)
    for (int a = sum; a >= 0; --a)
      for (int b = sum - a; b >= 0; --b) all.push_back({a, b, sum - a - b});
  return all;
}

const std::vector<Orders> all_orders = makeOrders();

constexpr int termsUpTo(int degree) { return (degree + 1) * (degree + 2) * (degree + 3) / 6; }

/// Powers x^n / n! of each coordinate x, at [axis][n + 3]; zero for n < 0.
using Powers = std::array<std::array<double, LocalPolynomial::degree + 4>, 3>;

Powers powersOf(const Eigen::Vector3d& x) {
  Powers powers{};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    powers[axis][3] = 1;
    for (std::size_t n = 1; n <= LocalPolynomial::degree; ++n)
      powers[axis][n + 3] =
          powers[axis][n + 2] * x[static_cast<Eigen::Index>(axis)] / static_cast<double>(n);
  }
  return powers;
}

/// Returns the derivative of the term x^a/a! y^b/b! z^c/c!, with a, b, c the entries of `term`.
/// `wanted` gives the order of the derivative along each axis, at most 3 in total.
double termAt(const Orders& term, const Orders& wanted, const Powers& powers) {
  double product = 1;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const int n = term[axis] - wanted[axis] + 3;
    product *= powers[axis][at(n)];
  }
  return product;
}

/// Returns the data of a source, scaled to a unit of length of `scale` metres.
KnownDerivatives dataOf(const Equilibrium& e, double scale, KnownOrders known) {
  const Eigen::Vector3d slope = -scale * e.force;
  const Eigen::Matrix3d curvature = -0.5 * scale * scale * (e.stiffness + e.stiffness.transpose());
  KnownDerivatives data(most_data);
  data.head<10>() << e.energy, slope, curvature(0, 0), curvature(0, 1), curvature(0, 2),
      curvature(1, 1), curvature(1, 2), curvature(2, 2);
  const SymmetricSlope& t = e.stiffness_by_p;  // rows are xx, xy, xz, yy, yz, zz
  data.tail<10>() << t(0, 0), t(0, 1), t(0, 2), t(3, 0), t(4, 0), t(5, 0), t(3, 1), t(3, 2),
      t(5, 1), t(5, 2);
  data.tail<10>() *= -scale * scale * scale;
  data.conservativeResize(termsUpTo(static_cast<int>(known)));
  return data;
}

// Weights and penalties, chosen to reduce the errors at 1000 exact solutions in balls of 60 and 100
// mm, with spacings from 15 to 33 mm. Penalties ten times as large or small change the errors by
// about 10 %. Without a penalty on the fifth degree, however, the errors at the rim double.
// smallest_penalty makes those derivatives zero that the sources together do not determine.
constexpr double smallest_penalty = 1e-6;
constexpr double distance_power = 4;  // weight of a source = distance^-distance_power
constexpr std::array<double, 6> penalty_extrapolating = {0, 0, 0, 1e-6, 1e-2, 1e-1},
                                penalty_completing = {0, 0, 0, 1e-6, 1e-4, 1e-1};

/// A slope is used if its prediction is at most this many times as bad as predicting no change. In
/// the middle of a coarse cell, even a slope with a bad prediction is useful. Near a point with
/// singular stiffness, in contrast, slopes of dT/ds are wrong by factors of thousands.
constexpr double farther_slopes = 3;

/// Returns how many data of a source enter the fit. FitSource::known and LocalFits::Kind::known
/// both limit their order.
Eigen::Index numbersOf(KnownOrders of_source, KnownOrders of_kind) {
  return termsUpTo(static_cast<int>(std::min(of_source, of_kind)));
}

/// The least-squares system of a fit. Its rows are the weighted data of the sources, then the
/// penalties. Its columns are the terms of degree `from` to `degree`.
struct WeightedSystem {
  WeightedSystem(const std::vector<FitSource>& sources, std::int32_t edge, int from, int degree,
                 KnownOrders known, const std::array<double, 6>& penalty) {
    Eigen::Index data = 0;
    for (const FitSource& source : sources) data += numbersOf(source.known, known);
    weights.resize(data);
    const int first = termsUpTo(from - 1), unknowns = termsUpTo(degree) - first;
    matrix = Eigen::MatrixXd::Zero(weights.size() + unknowns, unknowns);
    const auto term = [first](int t) {
      const int index = first + t;
      return LocalPolynomial::orders(static_cast<std::size_t>(index));
    };
    Eigen::Index row = 0;
    for (const FitSource& source : sources) {
      const LatticePoint& o = source.offset;
      const Eigen::Vector3d x = Eigen::Vector3d(o[0], o[1], o[2]) / edge;
      const Powers powers = powersOf(x);
      const double weight = std::pow(x.norm(), -distance_power);
      for (Eigen::Index d = 0; d < numbersOf(source.known, known); ++d, ++row) {
        weights[row] = weight;
        for (int t = 0; t < unknowns; ++t)
          matrix(row, t) = weight * termAt(term(t), all_orders[at(d)], powers);
      }
    }
    int known_of_all = from > 0 ? from - 1 : static_cast<int>(known);
    for (const FitSource& source : sources)
      known_of_all = std::min(known_of_all, static_cast<int>(source.known));
    // Add a penalty row for each unknown (ridge regression). A derivative that some source lacks
    // always gets a penalty, because few sources may leave it undetermined.
    for (int t = 0; t < unknowns; ++t) {
      const int order = total(term(t));
      matrix(weights.size() + t, t) = order > known_of_all
                                          ? std::max(penalty[at(order)], smallest_penalty)
                                          : penalty[at(order)];
    }
  }

  Eigen::MatrixXd matrix;
  Eigen::VectorXd weights;  ///< one per datum
};

}  // namespace

const Orders& LocalPolynomial::orders(std::size_t index) { return all_orders[index]; }

LocalPolynomial::Forces LocalPolynomial::forcesAt(const Eigen::Vector3d& offset) {
  const Powers powers = powersOf(offset);
  Forces forces;
  for (Eigen::Index t = 0; t < terms; ++t)
    for (Eigen::Index axis = 0; axis < 3; ++axis)
      forces(axis, t) =
          -termAt(all_orders[palpate::at(t)], all_orders[palpate::at(1 + axis)], powers);
  return forces;
}

KnownDerivatives LocalPolynomial::derivativesAt(const Eigen::Vector3d& offset, int count) const {
  const Powers powers = powersOf(offset / scale);
  KnownDerivatives value = KnownDerivatives::Zero(count);
  for (std::size_t t = 0; t < terms; ++t) {
    const double derivative = derivatives[static_cast<Eigen::Index>(t)];
    if (derivative == 0) continue;
    for (int d = 0; d < count; ++d)
      value[d] += termAt(orders(t), all_orders[palpate::at(d)], powers) * derivative;
  }
  return value;
}

Equilibrium LocalPolynomial::at(const Eigen::Vector3d& offset) const {
  const KnownDerivatives value = derivativesAt(offset, 10);
  Equilibrium e;
  e.energy = value[0];
  e.force = -value.segment<3>(1) / scale;
  e.stiffness << value[4], value[5], value[6], value[5], value[7], value[8], value[6], value[8],
      value[9];
  e.stiffness /= -scale * scale;
  return e;
}

const LocalFits::Factors& LocalFits::factorsOf(const std::vector<FitSource>& sources,
                                               std::int32_t edge, int from, int degree) {
  Key key = {edge, from, degree};
  for (const FitSource& source : sources) {
    key.insert(key.end(), source.offset.begin(), source.offset.end());
    key.push_back(static_cast<std::int32_t>(source.known));
  }
  const auto found = factors_.find(key);
  if (found != factors_.end()) return found->second;
  if (kept_ > most_kept) {
    factors_.clear();
    kept_ = 0;
  }
  const WeightedSystem system(sources, edge, from, degree, kind_.known,
                              from == 0 ? penalty_extrapolating : penalty_completing);
  kept_ += system.matrix.size();
  return factors_.emplace(std::move(key), Factors{system.matrix.householderQr(), system.weights})
      .first->second;
}

Eigen::VectorXd LocalFits::fitted(const Factors& factors, const std::vector<FitSource>& sources,
                                  const LocalPolynomial& known) const {
  const bool has_terms = !known.derivatives.isZero(0);
  Eigen::VectorXd right = Eigen::VectorXd::Zero(factors.qr.rows());
  Eigen::Index row = 0;
  for (const FitSource& source : sources) {
    const LatticePoint& o = source.offset;
    const Eigen::Index numbers = numbersOf(source.known, kind_.known);
    auto data = right.segment(row, numbers);
    data = dataOf(*source.data, known.scale, kind_.known).head(numbers);
    if (has_terms)
      data -=
          known.derivativesAt(unit_ * Eigen::Vector3d(o[0], o[1], o[2]), static_cast<int>(numbers));
    row += numbers;
  }
  if (right.isZero(0)) return Eigen::VectorXd::Zero(factors.qr.cols());  // for instance a guess
  right.head(factors.weights.size()).array() *= factors.weights.array();
  return factors.qr.solve(right);
}

KnownOrders LocalFits::judge(const Equilibrium& own, const std::vector<FitSource>& around) const {
  PALPATE_ASSERT(kind_.known >= KnownOrders::slope, "solved points must have first derivatives");
  // Sums of squared difference quotients, after and before subtraction of the changes that the
  // derivative predicts.
  double with = 0, without = 0;
  for (const FitSource& source : around) {
    const Eigen::Vector3d step =
        unit_ * Eigen::Vector3d(source.offset[0], source.offset[1], source.offset[2]);
    const auto add = [&](const auto& change, const auto& explained) {
      with += (change - explained).squaredNorm() / step.squaredNorm();
      without += change.squaredNorm() / step.squaredNorm();
    };
    if (kind_.known == KnownOrders::slope) {
      using Number = Eigen::Matrix<double, 1, 1>;
      add(Number(source.data->energy - own.energy), Number(-own.force.dot(step)));
    } else if (kind_.known == KnownOrders::curvature) {
      add(Eigen::Vector3d(source.data->force - own.force), Eigen::Vector3d(own.stiffness * step));
    } else {
      add(Eigen::Matrix3d(source.data->stiffness - own.stiffness),
          symmetricOf(own.stiffness_by_p * step));
    }
  }
  const double farther = kind_.known == KnownOrders::slope ? farther_slopes : 1;
  const int one_less = with <= farther * farther * without ? 0 : 1;
  return static_cast<KnownOrders>(static_cast<int>(kind_.known) - one_less);
}

int LocalFits::degreeFor(std::size_t sources) const {
  const int of_sources = sources < 2 ? 2 : sources < 4 ? 3 : sources < 8 ? 4 : 5;
  return std::min(of_sources, kind_.highest_extrapolated);
}

LocalPolynomial LocalFits::extrapolate(const std::vector<FitSource>& sources, std::int32_t edge,
                                       int degree) {
  PALPATE_ASSERT(!sources.empty() && 2 <= degree && degree <= LocalPolynomial::degree,
                 "a fit needs a solved point and a valid degree");
  LocalPolynomial result;
  result.scale = unit_ * edge;
  const Factors& factors = factorsOf(sources, edge, 0, degree);
  result.derivatives.head(factors.qr.cols()) = fitted(factors, sources, result);
  return result;
}

LocalPolynomial LocalFits::complete(const Equilibrium& own, const std::vector<FitSource>& sources,
                                    std::int32_t edge, KnownOrders known) {
  LocalPolynomial result;
  result.scale = unit_ * edge;
  known = std::min(known, kind_.known);
  const Eigen::Index n_known = termsUpTo(static_cast<int>(known));
  result.derivatives.head(n_known) = dataOf(own, result.scale, known);
  // Without sources the higher derivatives stay zero.
  if (sources.empty()) return result;
  const Factors& factors =
      factorsOf(sources, edge, static_cast<int>(known) + 1, kind_.highest_completed);
  result.derivatives.segment(n_known, factors.qr.cols()) = fitted(factors, sources, result);
  return result;
}

}  // namespace palpate
