#include "viewer/potential_field.hpp"

#include <optional>

namespace palpate {
namespace {

using Derivatives = PotentialField::Derivatives;
using Orders = std::array<int, 3>;  ///< a, b, c of a derivative

std::size_t at(const Orders& orders) {
  std::size_t index = 0;
  for (std::size_t axis = 3; axis-- > 0;) index = 3 * index + static_cast<std::size_t>(orders[axis]);
  return index;
}

Orders plus(Orders orders, int axis, int times = 1) {
  orders[static_cast<std::size_t>(axis)] += times;
  return orders;
}

/// Builds the derivatives of all lattice points in units in which the spacing is 1.
class DerivativeTable {
 public:
  explicit DerivativeTable(const SpaceTable& space) : lattice_(space.lattice), table_(space.points.size()) {
    const Lattice& lattice = space.lattice;
    for (std::int32_t n = 0; n < lattice.size(); ++n) {
      solved_.push_back(isSolved(space.points[n].tag));
      if (solved_.back()) setExact(table_[n], space.points[n].equilibrium);
    }
    for (std::int32_t n = 0; n < lattice.size(); ++n) {
      if (!solved_[n]) continue;
      estimateMixedThird(n);
      estimateMixedFourth(n);
    }
  }
  std::vector<Derivatives> take() { return std::move(table_); }

 private:
  struct Neighbours {
    const Derivatives* lower = nullptr;  ///< one spacing down the axis; null when not solved
    const Derivatives* upper = nullptr;
  };

  void setExact(Derivatives& d, const Equilibrium& point) const {
    const double h = lattice_.spacing();
    d[at({0, 0, 0})] = point.energy;
    for (int i = 0; i < 3; ++i) {
      const Orders first = plus({0, 0, 0}, i);
      d[at(first)] = -h * point.force[i];
      for (int j = i; j < 3; ++j)
        d[at(plus(first, j))] = -h * h * 0.5 * (point.stiffness(i, j) + point.stiffness(j, i));
    }
  }

  const Derivatives* solvedAt(LatticePoint point) const {
    const auto number = lattice_.indexOf(point);
    return number && solved_[*number] ? &table_[*number] : nullptr;
  }

  Neighbours neighboursOf(std::int32_t n, int axis) const {
    LatticePoint lower = lattice_.point(n), upper = lower;
    --lower[static_cast<std::size_t>(axis)];
    ++upper[static_cast<std::size_t>(axis)];
    return {solvedAt(lower), solvedAt(upper)};
  }

  /// Second derivative along `axis` of a quantity whose value and first derivative are known here and at the
  /// neighbours.
  double secondFromHermite(std::int32_t n, const Orders& value, int axis) const {
    const auto [lower, upper] = neighboursOf(n, axis);
    const Derivatives& here = table_[n];
    const std::size_t f = at(value), slope = at(plus(value, axis));
    if (lower && upper)
      return 2 * ((*upper)[f] - 2 * here[f] + (*lower)[f]) - 0.5 * ((*upper)[slope] - (*lower)[slope]);
    if (upper) return 6 * ((*upper)[f] - here[f]) - 4 * here[slope] - 2 * (*upper)[slope];
    if (lower) return 6 * ((*lower)[f] - here[f]) + 4 * here[slope] + 2 * (*lower)[slope];
    return 0;
  }

  /// E_xyz as the mean of the differences along the axes that have two neighbours; else of those that have
  /// one.
  double mixedXyz(std::int32_t n) const {
    double central = 0, one_sided = 0;
    int n_central = 0, n_one_sided = 0;
    for (int axis = 0; axis < 3; ++axis) {
      const auto [lower, upper] = neighboursOf(n, axis);
      const Orders mixed = plus({1, 1, 1}, axis, -1);
      const double here = table_[n][at(mixed)];
      if (lower && upper) {
        central += 0.5 * ((*upper)[at(mixed)] - (*lower)[at(mixed)]);
        ++n_central;
      } else if (lower || upper) {
        one_sided += upper ? (*upper)[at(mixed)] - here : here - (*lower)[at(mixed)];
        ++n_one_sided;
      }
    }
    if (n_central > 0) return central / n_central;
    return n_one_sided > 0 ? one_sided / n_one_sided : 0;
  }

  void estimateMixedThird(std::int32_t n) {
    for (int axis = 0; axis < 3; ++axis)
      for (int other = 0; other < 3; ++other) {
        if (other == axis) continue;
        const Orders first = plus({0, 0, 0}, other);
        table_[n][at(plus(first, axis, 2))] = secondFromHermite(n, first, axis);
      }
    table_[n][at({1, 1, 1})] = mixedXyz(n);
  }

  /// Second difference along `axis` of the second derivative `orders`; nothing where a neighbour is missing.
  std::optional<double> secondDifference(std::int32_t n, const Orders& orders, int axis) const {
    const auto [lower, upper] = neighboursOf(n, axis);
    if (!lower || !upper) return std::nullopt;
    return (*upper)[at(orders)] - 2 * table_[n][at(orders)] + (*lower)[at(orders)];
  }

  void estimateMixedFourth(std::int32_t n) {
    for (int axis = 0; axis < 3; ++axis) {
      const int next = (axis + 1) % 3, last = (axis + 2) % 3;
      const Orders around = plus(plus({0, 0, 0}, next), last);
      table_[n][at(plus(around, axis, 2))] = secondDifference(n, around, axis).value_or(0);

      const Orders along_axis = plus({0, 0, 0}, axis, 2), along_next = plus({0, 0, 0}, next, 2);
      const auto by_axis = secondDifference(n, along_next, axis),
                 by_next = secondDifference(n, along_axis, next);
      double& fourth = table_[n][at(plus(along_axis, next, 2))];
      if (by_axis && by_next)
        fourth = 0.5 * (*by_axis + *by_next);
      else
        fourth = by_axis.value_or(by_next.value_or(0));
    }
  }

  const Lattice& lattice_;
  std::vector<Derivatives> table_;
  std::vector<bool> solved_;
};

/// Quintic Hermite basis on [0, 1] and its derivatives: [derivative 0..2][end 0..1][order 0..2].
using Basis = std::array<std::array<std::array<double, 3>, 2>, 3>;

Basis quinticHermite(double t) {
  const double s = 1 - t;
  Basis basis;
  const auto set = [&basis](int derivative, double f0, double f1, double g0, double g1, double k0,
                            double k1) {
    basis[static_cast<std::size_t>(derivative)] = {{{f0, g0, k0}, {f1, g1, k1}}};
  };
  // f: value 1 at the end, g: slope 1, k: curvature 1; the upper end mirrors the lower one, odd orders change
  // sign.
  const auto f = [](double x) { return 1 + x * x * x * (-10 + x * (15 - 6 * x)); };
  const auto g = [](double x) { return x + x * x * x * (-6 + x * (8 - 3 * x)); };
  const auto k = [](double x) { return 0.5 * x * x * (1 + x * (-3 + x * (3 - x))); };
  const auto df = [](double x) { return x * x * (-30 + x * (60 - 30 * x)); };
  const auto dg = [](double x) { return 1 + x * x * (-18 + x * (32 - 15 * x)); };
  const auto dk = [](double x) { return x * (1 + x * (-4.5 + x * (6 - 2.5 * x))); };
  const auto ddf = [](double x) { return x * (-60 + x * (180 - 120 * x)); };
  const auto ddg = [](double x) { return x * (-36 + x * (96 - 60 * x)); };
  const auto ddk = [](double x) { return 1 + x * (-9 + x * (18 - 10 * x)); };
  set(0, f(t), f(s), g(t), -g(s), k(t), k(s));
  set(1, df(t), -df(s), dg(t), dg(s), dk(t), -dk(s));
  set(2, ddf(t), ddf(s), ddg(t), -ddg(s), ddk(t), ddk(s));
  return basis;
}

/// Derivatives (a, b, c), a + b + c <= 2, of the interpolant in a cell, at [a + 3 b + 9 c]; the others stay
/// zero. Sums over z, then y, then x, so that the longest loops run over neighbours in memory.
Derivatives evaluateCell(const std::array<const Derivatives*, 8>& corners, const Eigen::Vector3d& local) {
  const Basis x = quinticHermite(local.x()), y = quinticHermite(local.y()), z = quinticHermite(local.z());
  Derivatives result{};
  for (std::size_t x_end = 0; x_end < 2; ++x_end) {
    double lines[3][3][3] = {};  // [derivative f along z][e along y][order a at the corner]
    for (std::size_t y_end = 0; y_end < 2; ++y_end) {
      double planes[3][9] = {};  // [derivative f along z][orders a + 3 b at the corner]
      for (std::size_t z_end = 0; z_end < 2; ++z_end) {
        const double* values = corners[x_end + 2 * y_end + 4 * z_end]->data();
        for (std::size_t c = 0; c < 3; ++c)
          for (std::size_t f = 0; f < 3; ++f)
            for (std::size_t ab = 0; ab < 9; ++ab) planes[f][ab] += z[f][z_end][c] * values[9 * c + ab];
      }
      for (std::size_t f = 0; f < 3; ++f)
        for (std::size_t e = 0; e + f < 3; ++e)
          for (std::size_t b = 0; b < 3; ++b)
            for (std::size_t a = 0; a < 3; ++a) lines[f][e][a] += y[e][y_end][b] * planes[f][a + 3 * b];
    }
    for (std::size_t f = 0; f < 3; ++f)
      for (std::size_t e = 0; e + f < 3; ++e)
        for (std::size_t d = 0; d + e + f < 3; ++d)
          for (std::size_t a = 0; a < 3; ++a) result[d + 3 * e + 9 * f] += x[d][x_end][a] * lines[f][e][a];
  }
  return result;
}

}  // namespace

PotentialField::PotentialField(const SpaceTable& space)
    : grid_(space), derivatives_(DerivativeTable(space).take()) {
  for (std::int32_t n = 0; n < space.lattice.size(); ++n) {
    points_.push_back(space.points[n].equilibrium);
    displacement_.push_back(space.lattice.displacement(n));
  }
}

ForceSample PotentialField::evaluate(const Eigen::Vector3d& displacement) const noexcept {
  const CellPlace place = grid_.find(displacement);
  if (place.corners == nullptr)
    return sampleOutside(points_[place.nearest], displacement - displacement_[place.nearest],
                         grid_.spacing());

  std::array<const Derivatives*, 8> corners;
  for (std::size_t c = 0; c < 8; ++c) corners[c] = &derivatives_[(*place.corners)[c]];
  const Derivatives d = evaluateCell(corners, place.local);
  const double h = grid_.spacing();
  ForceSample sample;
  sample.inside = true;
  sample.energy = d[0];
  sample.force = -Eigen::Vector3d(d[1], d[3], d[9]) / h;
  sample.stiffness << d[2], d[4], d[10], d[4], d[6], d[12], d[10], d[12], d[18];
  sample.stiffness /= -h * h;
  return sample;
}

}  // namespace palpate
