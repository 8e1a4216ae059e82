#pragma once

#include <Eigen/QR>

#include "common/space/configuration.hpp"
#include "common/space/lattice.hpp"

namespace palpate {

/// Derivative orders along x, y, z.
using Orders = std::array<int, 3>;

/// The derivatives of the first terms of a LocalPolynomial, at most up to third order (20 terms),
/// scaled like LocalPolynomial::derivatives.
using KnownDerivatives = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, 20, 1>;

/// Taylor polynomial of the energy around a position, with total degree <= 5.
class LocalPolynomial {
 public:
  static constexpr int degree = 5, terms = 56;
  /// Returns the derivative orders of term `index`. Terms are sorted by total degree.
  static const Orders& orders(std::size_t index);
  /// Maps `derivatives` to the force at an offset; lengths in units of `scale`.
  using Forces = Eigen::Matrix<double, 3, terms>;
  static Forces forcesAt(const Eigen::Vector3d& offset);

  double scale = 1;  ///< metres
  /// Derivatives at the position, each times scale^(total order), J; one per term.
  Eigen::Matrix<double, terms, 1> derivatives = Eigen::Matrix<double, terms, 1>::Zero();

  /// Returns energy, force and stiffness `offset` metres from the position.
  Equilibrium at(const Eigen::Vector3d& offset) const;
  /// Returns the derivatives of the first `count` terms at `offset` (metres), at most up to third
  /// order, scaled like `derivatives`.
  KnownDerivatives derivativesAt(const Eigen::Vector3d& offset, int count) const;
};

/// Highest order up to which the derivatives of the fitted quantity, the energy or another one, are
/// known at a source. A source then has 1, 4, 10 or 20 numbers. For the energy, the orders 0 to 3
/// are the energy itself, the force, the stiffness and stiffness_by_p.
enum class KnownOrders : std::uint8_t { value = 0, slope = 1, curvature = 2, third = 3 };

/// A solved point near the position of a fit.
struct FitSource {
  LatticePoint offset;  ///< from the position, lattice coordinates; must not be zero
  const Equilibrium* data;
  /// Highest order of the source's data that is used; LocalFits::Kind::known limits it too.
  KnownOrders known = KnownOrders::third;
};

/// Weighted least-squares fits of local polynomials to energies, forces, stiffnesses and further
/// known derivatives. Nearer sources have larger weights. A penalty on derivatives of higher order
/// than the known ones keeps undetermined terms small. Fits with equal offsets and known orders of
/// the sources share one cached factorisation, even across spaces. One thread.
class LocalFits {
 public:
  /// Configures the data that a fit uses and the degrees of its polynomials, 2 to 5. With `known`
  /// below `curvature`, stiffnesses are ignored, and below `slope` also forces.
  struct Kind {
    KnownOrders known = KnownOrders::curvature;
    int highest_extrapolated = LocalPolynomial::degree;
    int highest_completed = LocalPolynomial::degree;
    /// Largest number of sources; the nearest are used.
    std::size_t most_extrapolated_from = 16, most_completed_from = 26;
    /// Whether callers use judge() to decide if a point's data of the highest known order are used.
    bool highest_known_are_judged = false;
  };

  /// `unit`: metres per lattice coordinate.
  explicit LocalFits(double unit) : LocalFits(unit, Kind()) {}
  LocalFits(double unit, Kind kind) : unit_(unit), kind_(kind) {}

  const Kind& kind() const { return kind_; }
  /// Returns the polynomial degree for an extrapolation from this number of sources.
  int degreeFor(std::size_t sources) const;

  /// Decides whether the derivatives of the highest known order at a point can be trusted. They
  /// predict how the derivatives of the next lower order change towards the points `around`.
  /// Returns Kind::known, or one order less if this prediction is worse than predicting no change
  /// (for slopes: more than three times as bad). This happens
  /// - if the derivative was computed as the difference of two tangents over a tiny step in which
  ///   the stiffness of an element jumps: it is then this jump divided by the step;
  /// - near a singular stiffness, where derivatives grow without limit;
  /// - if the points are too far apart for a derivative to predict anything.
  ///
  /// Kind::known must be at least `slope`.
  KnownOrders judge(const Equilibrium& own, const std::vector<FitSource>& around) const;

  /// Fits a polynomial around a position without data. `edge` is the length scale of the fit in
  /// lattice coordinates, about the distance of the nearest source. Needs at least one source and 2
  /// <= degree <= 5. Reproduces energies of third degree (to 1e-7) if the sources determine them.
  LocalPolynomial extrapolate(const std::vector<FitSource>& sources, std::int32_t edge, int degree);
  /// Fits a polynomial around a solved point. It reproduces the point's own data exactly. Its
  /// higher derivatives are fitted to the sources, and are zero if there are none. Reproduces
  /// energies of fourth degree (to 1e-7) if the sources determine them. `known` is the highest
  /// order of the point's own data that is used, as in FitSource.
  LocalPolynomial complete(const Equilibrium& own, const std::vector<FitSource>& sources,
                           std::int32_t edge, KnownOrders known = KnownOrders::third);

 private:
  using Key = std::vector<std::int32_t>;
  struct Factors {
    Eigen::HouseholderQR<Eigen::MatrixXd> qr;
    Eigen::VectorXd weights;  ///< one per datum
  };
  const Factors& factorsOf(const std::vector<FitSource>& sources, std::int32_t edge, int from,
                           int degree);
  /// Returns the fitted terms. The terms of `known` are subtracted from the data of the sources.
  Eigen::VectorXd fitted(const Factors& factors, const std::vector<FitSource>& sources,
                         const LocalPolynomial& known) const;
  double unit_;
  Kind kind_;
  std::map<Key, Factors> factors_;  ///< keys from factorsOf()
  Eigen::Index kept_ = 0;           ///< total size of the cached matrices, in doubles
};

/// Settings for fits of a finger's energy, whose third derivatives are known too.
inline constexpr LocalFits::Kind finger_fit = {.known = KnownOrders::third,
                                               .highest_extrapolated = 4,
                                               .highest_completed = 4,
                                               .most_extrapolated_from = 4,
                                               .most_completed_from = 6,
                                               .highest_known_are_judged = true};
/// Settings for fits of a finger's drive, whose first and second derivatives are known, and of the
/// slopes of the drive, whose first derivatives are known.
inline constexpr LocalFits::Kind finger_drive_fit = {.known = KnownOrders::curvature,
                                                     .highest_extrapolated = 3,
                                                     .highest_completed = 4,
                                                     .most_extrapolated_from = 6,
                                                     .most_completed_from = 12,
                                                     .highest_known_are_judged = true};
inline constexpr LocalFits::Kind finger_slope_fit = {.known = KnownOrders::slope,
                                                     .highest_extrapolated = 3,
                                                     .highest_completed = 3,
                                                     .most_extrapolated_from = 6,
                                                     .most_completed_from = 12,
                                                     .highest_known_are_judged = true};

}  // namespace palpate
