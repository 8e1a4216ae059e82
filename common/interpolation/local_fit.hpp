#pragma once

#include <Eigen/QR>

#include "common/space/configuration.hpp"
#include "common/space/lattice.hpp"

namespace palpate {

/// Derivative orders along x, y, z.
using Orders = std::array<int, 3>;

/// Some derivatives of the first terms of a LocalPolynomial, in its units.
using KnownDerivatives = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, 20, 1>;

/// Energy around a position, as its Taylor polynomial of total degree <= 5.
class LocalPolynomial {
 public:
  static constexpr int degree = 5, terms = 56;
  /// Orders of term `index`: ascending total degree.
  static const Orders& orders(std::size_t index);

  double scale = 1;  ///< metres
  /// Derivatives at the position times scale^(total order), J; one per term.
  Eigen::Matrix<double, terms, 1> derivatives = Eigen::Matrix<double, terms, 1>::Zero();

  /// Energy, force and stiffness `offset` metres from the position.
  Equilibrium at(const Eigen::Vector3d& offset) const;
  /// The first `count` derivatives there, of the third order at most, as `derivatives` has them.
  KnownDerivatives derivativesAt(const Eigen::Vector3d& offset, int count) const;
};

/// Up to which order the derivatives of a source are known, of the energy or another quantity in
/// its place: 1, 4, 10 (energy, force, stiffness) or 20 numbers (stiffness_by_p too).
enum class KnownOrders : std::uint8_t { value = 0, slope = 1, curvature = 2, third = 3 };

/// A solved point near the position of a fit.
struct FitSource {
  LatticePoint offset;  ///< from the position, lattice coordinates; not zero
  const Equilibrium* data;
  /// Of its data no more than these count, nor than LocalFits::Kind::known.
  KnownOrders known = KnownOrders::third;
};

/// Weighted least-squares fits of local polynomials to energies, forces and stiffnesses, and what
/// else is known: near sources weigh more. What the sources do not determine is kept small by a
/// penalty on the derivatives above the known ones. Sources that lie alike share one factorisation,
/// of other spaces too. One thread.
class LocalFits {
 public:
  /// What is fitted to what: data of lower orders than KnownOrders::curvature leave stiffnesses, or
  /// forces too, unlooked at. Degrees are 2 to 5.
  struct Kind {
    KnownOrders known = KnownOrders::curvature;
    int highest_extrapolated = LocalPolynomial::degree;
    int highest_completed = LocalPolynomial::degree;
    std::size_t most_extrapolated_from = 16, most_completed_from = 26;  ///< sources, the nearest
    /// Whether what is known of the highest order counts only where judge says so.
    bool highest_known_are_judged = false;
  };

  /// `unit`: metres per lattice coordinate.
  explicit LocalFits(double unit) : LocalFits(unit, Kind()) {}
  LocalFits(double unit, Kind kind) : unit_(unit), kind_(kind) {}

  const Kind& kind() const { return kind_; }
  /// The degree of extrapolations that so many sources support.
  int degreeFor(std::size_t sources) const;

  /// What of a point's own data counts, by the points around it: all that is known, or one order
  /// less, where the derivatives of the highest order are farther (slopes: three times farther)
  /// than zero is from how those below it change on the way to those points. So it is with a
  /// difference of tangents over a tiny step in which the stiffness of an element jumps: it is that
  /// jump over the step. So it is near a singular stiffness, where derivatives grow without limit,
  /// and where the points are too far apart for a derivative to say anything. Not of values alone.
  KnownOrders judge(const Equilibrium& own, const std::vector<FitSource>& around) const;

  /// About a position where nothing is known. `edge`: scale of the fit, lattice coordinates, about
  /// the distance of the nearest source. At least one source; exact (to 1e-7) for energies of the
  /// third degree if the sources determine them. 2 <= degree <= 5.
  LocalPolynomial extrapolate(const std::vector<FitSource>& sources, std::int32_t edge, int degree);
  /// About a solved point: its own data exactly, the higher derivatives from the sources around;
  /// zero without any. Exact (to 1e-7) for energies of the fourth degree if the sources determine
  /// them. `known`: of its own data, as of a source.
  LocalPolynomial complete(const Equilibrium& own, const std::vector<FitSource>& sources,
                           std::int32_t edge, KnownOrders known = KnownOrders::third);

 private:
  using Key = std::vector<std::int32_t>;
  struct Factors {
    Eigen::HouseholderQR<Eigen::MatrixXd> qr;
    Eigen::VectorXd weights;  ///< per datum
  };
  const Factors& factorsOf(const std::vector<FitSource>& sources, std::int32_t edge, int from,
                           int degree);
  double unit_;
  Kind kind_;
  std::map<Key, Factors> factors_;  ///< by the offsets of the sources
  Eigen::Index kept_ = 0;           ///< numbers in them
};

/// For the energies of fingers, whose third derivatives are known.
inline constexpr LocalFits::Kind finger_fit = {.known = KnownOrders::third,
                                               .highest_extrapolated = 4,
                                               .highest_completed = 4,
                                               .most_extrapolated_from = 4,
                                               .most_completed_from = 6,
                                               .highest_known_are_judged = true};
/// For their drives, of which two derivatives are known, and for the slopes of these, with one.
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
