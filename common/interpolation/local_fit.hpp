#pragma once

#include <Eigen/QR>

#include "common/space/configuration.hpp"
#include "common/space/lattice.hpp"

namespace palpate {

/// Derivative orders along x, y, z.
using Orders = std::array<int, 3>;

/// Leading derivatives of a LocalPolynomial, in its units; at most 20.
using KnownDerivatives = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, 20, 1>;

/// The energy around a position as a Taylor polynomial of total degree <= 5.
class LocalPolynomial {
 public:
  static constexpr int degree = 5, terms = 56;
  /// Derivative orders of term `index`; terms are sorted by total degree.
  static const Orders& orders(std::size_t index);

  double scale = 1;  ///< metres
  /// Derivatives at the position times scale^(total order), J; one per term.
  Eigen::Matrix<double, terms, 1> derivatives = Eigen::Matrix<double, terms, 1>::Zero();

  /// Returns energy, force and stiffness `offset` metres from the position.
  Equilibrium at(const Eigen::Vector3d& offset) const;
  /// Returns the first `count` derivatives at `offset`, at most of third order, in the units of
  /// `derivatives`.
  KnownDerivatives derivativesAt(const Eigen::Vector3d& offset, int count) const;
};

/// Highest known order of the derivatives of a source, for the energy or another quantity. The
/// orders correspond to 1, 4, 10 (energy, force, stiffness) or 20 numbers (with stiffness_by_p).
enum class KnownOrders : std::uint8_t { value = 0, slope = 1, curvature = 2, third = 3 };

/// A solved point near the position of a fit.
struct FitSource {
  LatticePoint offset;  ///< from the position, lattice coordinates; must not be zero
  const Equilibrium* data;
  /// Limits the orders of its data that count; LocalFits::Kind::known limits them too.
  KnownOrders known = KnownOrders::third;
};

/// Weighted least-squares fits of local polynomials to energies, forces, stiffnesses and further
/// known derivatives. Near sources weigh more. A penalty on derivatives above the known ones keeps
/// undetermined terms small. Sources in equal arrangements share one factorisation, across spaces
/// too. One thread.
class LocalFits {
 public:
  /// Configures the data and degrees of a fit. Orders lower than KnownOrders::curvature ignore
  /// stiffnesses, or forces too. Degrees are 2 to 5.
  struct Kind {
    KnownOrders known = KnownOrders::curvature;
    int highest_extrapolated = LocalPolynomial::degree;
    int highest_completed = LocalPolynomial::degree;
    std::size_t most_extrapolated_from = 16, most_completed_from = 26;  ///< nearest sources
    /// Whether `judge` decides if the highest known order counts.
    bool highest_known_are_judged = false;
  };

  /// `unit`: metres per lattice coordinate.
  explicit LocalFits(double unit) : LocalFits(unit, Kind()) {}
  LocalFits(double unit, Kind kind) : unit_(unit), kind_(kind) {}

  const Kind& kind() const { return kind_; }
  /// Returns the degree of an extrapolation from `sources` sources.
  int degreeFor(std::size_t sources) const;

  /// Decides whether to trust the highest known order of a point's own data. Returns one order less
  /// if that order predicts the change of the next lower one towards the points `around` worse than
  /// zero would (slopes: three times worse). This happens
  /// - for a difference of tangents over a tiny step in which the stiffness of an element jumps,
  ///   since it is then that jump divided by the step;
  /// - near a singular stiffness, where derivatives grow without limit;
  /// - if the points are too far apart for a derivative to predict anything.
  ///
  /// Kind::known must be at least `slope`.
  KnownOrders judge(const Equilibrium& own, const std::vector<FitSource>& around) const;

  /// Fits a polynomial around a position without data. `edge` is the scale of the fit in lattice
  /// coordinates, about the distance of the nearest source. Needs at least one source and 2 <=
  /// degree <= 5. Exact (to 1e-7) for energies of third degree if the sources determine them.
  LocalPolynomial extrapolate(const std::vector<FitSource>& sources, std::int32_t edge, int degree);
  /// Fits a polynomial around a solved point. It reproduces the point's own data exactly; higher
  /// derivatives come from the sources, and are zero without any. Exact (to 1e-7) for energies of
  /// fourth degree if the sources determine them. `known` limits the orders of its own data, as in
  /// FitSource.
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
  double unit_;
  Kind kind_;
  std::map<Key, Factors> factors_;  ///< by the offsets and known orders of the sources
  Eigen::Index kept_ = 0;           ///< total size of the cached matrices, in numbers
};

/// Fit of the energies of fingers, which have known third derivatives.
inline constexpr LocalFits::Kind finger_fit = {.known = KnownOrders::third,
                                               .highest_extrapolated = 4,
                                               .highest_completed = 4,
                                               .most_extrapolated_from = 4,
                                               .most_completed_from = 6,
                                               .highest_known_are_judged = true};
/// Fits of their drives, with two known derivatives, and of the slopes of the drives, with one.
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
