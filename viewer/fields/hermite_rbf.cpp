#include "viewer/fields/hermite_rbf.hpp"

#include <cmath>

#include "common/base/error.hpp"
#include "common/interpolation/conditional_system.hpp"

namespace palpate {
namespace {

constexpr int functionals = HermiteRbf::functionals;

/// The axes along which a functional differentiates; -1: no more.
constexpr std::array<std::array<int, 2>, functionals> axes_of = {
    {{-1, -1}, {0, -1}, {1, -1}, {2, -1}, {0, 0}, {1, 1}, {2, 2}, {1, 2}, {0, 2}, {0, 1}}};

constexpr int orderOf(int functional) { return functional == 0 ? 0 : functional < 4 ? 1 : 2; }

/// Powers of x, y, z, in ascending degree.
constexpr std::array<std::array<int, 3>, 20> monomials = {
    {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {2, 0, 0}, {0, 2, 0}, {0, 0, 2},
     {0, 1, 1}, {1, 0, 1}, {1, 1, 0}, {3, 0, 0}, {0, 3, 0}, {0, 0, 3}, {2, 1, 0},
     {2, 0, 1}, {1, 2, 0}, {0, 2, 1}, {1, 0, 2}, {0, 1, 2}, {1, 1, 1}}};

/// Derivatives of r^7 at d, up to the fourth: with g0 = phi and g(k+1) = g(k)' / r they are sums of
/// products of components of d and Kronecker deltas.
class RadialDerivatives {
 public:
  explicit RadialDerivatives(const Eigen::Vector3d& d) : d_(d) {
    const double s = d.squaredNorm(), r = std::sqrt(s);
    g_ = {r * s * s * s, 7 * r * s * s, 35 * r * s, 105 * r, r > 0 ? 105 / r : 0};
  }

  double along(const std::array<int, 4>& axes, int order) const {
    const auto [i, j, k, l] = axes;
    const auto delta = [](int a, int b) { return a == b ? 1.0 : 0.0; };
    switch (order) {
      case 0:
        return g_[0];
      case 1:
        return g_[1] * d_[i];
      case 2:
        return g_[2] * d_[i] * d_[j] + g_[1] * delta(i, j);
      case 3:
        return g_[3] * d_[i] * d_[j] * d_[k] +
               g_[2] * (delta(i, j) * d_[k] + delta(i, k) * d_[j] + delta(j, k) * d_[i]);
      default:
        return g_[4] * d_[i] * d_[j] * d_[k] * d_[l] +
               g_[3] * (delta(i, j) * d_[k] * d_[l] + delta(i, k) * d_[j] * d_[l] +
                        delta(i, l) * d_[j] * d_[k] + delta(j, k) * d_[i] * d_[l] +
                        delta(j, l) * d_[i] * d_[k] + delta(k, l) * d_[i] * d_[j]) +
               g_[2] * (delta(i, j) * delta(k, l) + delta(i, k) * delta(j, l) +
                        delta(i, l) * delta(j, k));
    }
  }

  /// Functional `a` of p and functional `b` of q applied to phi(|p - q|), d = p - q.
  double between(int a, int b) const {
    std::array<int, 4> axes = {0, 0, 0, 0};
    std::size_t order = 0;
    for (const int functional : {a, b})
      for (int n = 0; n < orderOf(functional); ++n)
        axes[order++] = axes_of[static_cast<std::size_t>(functional)][static_cast<std::size_t>(n)];
    const double derivative = along(axes, static_cast<int>(order));
    return orderOf(b) == 1 ? -derivative : derivative;
  }

 private:
  Eigen::Vector3d d_;
  std::array<double, 5> g_;
};

double monomial(std::array<int, 3> powers, int functional, const Eigen::Vector3d& p) {
  double value = 1;
  for (int n = 0; n < orderOf(functional); ++n) {
    int& power = powers[static_cast<std::size_t>(
        axes_of[static_cast<std::size_t>(functional)][static_cast<std::size_t>(n)])];
    value *= power--;
    if (power < 0) return 0;
  }
  for (int axis = 0; axis < 3; ++axis)
    for (int n = 0; n < powers[static_cast<std::size_t>(axis)]; ++n) value *= p[axis];
  return value;
}

Eigen::MatrixXd matrixOf(const std::vector<Eigen::Vector3d>& positions) {
  const auto n = static_cast<Eigen::Index>(positions.size());
  Eigen::MatrixXd A(functionals * n, functionals * n);
  for (Eigen::Index j = 0; j < n; ++j)
    for (Eigen::Index i = j; i < n; ++i) {
      const RadialDerivatives phi(positions[static_cast<std::size_t>(i)] -
                                  positions[static_cast<std::size_t>(j)]);
      for (int b = 0; b < functionals; ++b)
        for (int a = 0; a < functionals; ++a) {
          const double entry = phi.between(a, b);
          A(functionals * i + a, functionals * j + b) = entry;
          A(functionals * j + b, functionals * i + a) = entry;
        }
    }
  return A;
}

Eigen::MatrixXd polynomialsOf(const std::vector<Eigen::Vector3d>& positions) {
  Eigen::MatrixXd P(functionals * static_cast<Eigen::Index>(positions.size()), monomials.size());
  for (Eigen::Index row = 0; row < P.rows(); ++row)
    for (std::size_t m = 0; m < monomials.size(); ++m)
      P(row, static_cast<Eigen::Index>(m)) =
          monomial(monomials[m], static_cast<int>(row % functionals),
                   positions[static_cast<std::size_t>(row / functionals)]);
  return P;
}

Eigen::VectorXd dataOf(const std::vector<Jet>& jets) {
  Eigen::VectorXd data(functionals * static_cast<Eigen::Index>(jets.size()));
  for (std::size_t n = 0; n < jets.size(); ++n) {
    const Jet& jet = jets[n];
    const Eigen::Matrix3d& H = jet.hessian;
    data.segment<functionals>(functionals * static_cast<Eigen::Index>(n)) << jet.value,
        jet.gradient, H(0, 0), H(1, 1), H(2, 2), (H(1, 2) + H(2, 1)) / 2, (H(0, 2) + H(2, 0)) / 2,
        (H(0, 1) + H(1, 0)) / 2;
  }
  return data;
}

}  // namespace

HermiteRbf::HermiteRbf(const std::vector<Eigen::Vector3d>& positions, const std::vector<Jet>& jets)
    : blocks_((positions.size() + rbf_lanes - 1) / rbf_lanes) {
  const Eigen::MatrixXd A = matrixOf(positions), P = polynomialsOf(positions);
  const Eigen::VectorXd data = dataOf(jets);
  const ConditionalSystem system(A, P);
  if (!system.definite())
    throw failure(
        "potential-rbf cannot tell {} solved points apart that lie too close to each other; "
        "choose another method",
        positions.size());
  auto [weights, tail] = system.withTail(data);
  const auto correction = system.withTail(data - A * weights - P * tail);
  weights += correction.weights;
  tail += correction.tail;
  residual_ = (data - A * weights - P * tail).cwiseAbs().maxCoeff() /
              std::max(1e-300, data.cwiseAbs().maxCoeff());

  for (std::size_t m = 0; m < monomials.size(); ++m)
    polynomial_[m] = tail(static_cast<Eigen::Index>(m), 0);
  for (std::size_t n = 0; n < positions.size(); ++n) {
    HermiteBlock& block = blocks_[n / rbf_lanes];
    const std::size_t lane = n % rbf_lanes;
    const auto w = weights.col(0).segment<functionals>(functionals * static_cast<Eigen::Index>(n));
    block.a[lane] = w[0];
    for (int axis = 0; axis < 3; ++axis) {
      block.position[axis][lane] = positions[n][axis];
      block.b[axis][lane] = -w[1 + axis];  // the gradient is taken at the point, not at p
      block.C[axis][lane] = w[4 + axis];
      block.C[3 + axis][lane] = w[7 + axis] / 2;  // twice in the symmetric matrix
    }
  }
}

Jet HermiteRbf::evaluate(const RbfKernels& kernels, const Eigen::Vector3d& p) const noexcept {
  HermiteSums sums;
  kernels.hermite(blocks_.data(), blocks_.size(), p.data(), sums);
  const auto& c = polynomial_;
  const double x = p.x(), y = p.y(), z = p.z();
  Jet jet;
  const double xx = 2 * c[4] + 6 * c[10] * x + 2 * (c[13] * y + c[14] * z);
  const double yy = 2 * c[5] + 6 * c[11] * y + 2 * (c[15] * x + c[16] * z);
  const double zz = 2 * c[6] + 6 * c[12] * z + 2 * (c[17] * x + c[18] * y);
  const double yz = c[7] + 2 * (c[16] * y + c[18] * z) + c[19] * x;
  const double xz = c[8] + 2 * (c[14] * x + c[17] * z) + c[19] * y;
  const double xy = c[9] + 2 * (c[13] * x + c[15] * y) + c[19] * z;
  jet.value = c[0] +
              x * (c[1] + x * (c[4] + x * c[10] + y * c[13] + z * c[14]) + z * (z * c[17] + c[8])) +
              y * (c[2] + y * (c[5] + y * c[11] + x * c[15] + z * c[16]) + x * c[9]) +
              z * (c[3] + z * (c[6] + z * c[12] + y * c[18]) + y * c[7]) + x * y * z * c[19];
  // Of each degree from the next lower derivative (Euler): the gradient of the quadratic part is
  // its Hessian times p, of the cubic part half of it.
  const Eigen::Vector3d linear(c[1], c[2], c[3]);
  Eigen::Matrix3d quadratic, hessian;
  quadratic << 2 * c[4], c[9], c[8], c[9], 2 * c[5], c[7], c[8], c[7], 2 * c[6];
  hessian << xx, xy, xz, xy, yy, yz, xz, yz, zz;
  jet.gradient = linear + 0.5 * (quadratic + hessian) * p;
  jet.hessian = hessian;

  jet.value += sums.value;
  jet.gradient += Eigen::Vector3d(sums.gradient[0], sums.gradient[1], sums.gradient[2]);
  const double(&h)[6] = sums.hessian;
  Eigen::Matrix3d radial;
  radial << h[0], h[5], h[4], h[5], h[1], h[3], h[4], h[3], h[2];
  jet.hessian += radial;
  return jet;
}

}  // namespace palpate
