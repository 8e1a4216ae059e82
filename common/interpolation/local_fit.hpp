#pragma once

#include <Eigen/QR>

#include "common/space/configuration.hpp"
#include "common/space/lattice.hpp"

namespace palpate {

/// Derivative orders along x, y, z.
using Orders = std::array<int, 3>;

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
};

/// A solved point near the position of a fit.
struct FitSource {
  LatticePoint offset;  ///< from the position, lattice coordinates; not zero
  const Equilibrium* data;
};

/// Weighted least-squares fits of local polynomials to energies, forces and stiffnesses: ten
/// numbers per source, near ones weigh more. What the sources do not determine is kept small by a
/// penalty on the derivatives above the second. One thread.
class LocalFits {
 public:
  /// `unit`: metres per lattice coordinate.
  explicit LocalFits(double unit) : unit_(unit) {}

  /// About a position where nothing is known. `edge`: scale of the fit, lattice coordinates, about
  /// the distance of the nearest source. At least one source; exact (to 1e-7) for energies of the
  /// third degree if the sources determine them. 2 <= degree <= 5.
  LocalPolynomial extrapolate(const std::vector<FitSource>& sources, std::int32_t edge,
                              int degree) const;
  /// About a solved point: its own data exactly, the higher derivatives from the sources around;
  /// zero without any. Exact (to 1e-7) for energies of the fourth degree if the sources determine
  /// them. Sources that lie alike share one factorisation.
  LocalPolynomial complete(const Equilibrium& own, const std::vector<FitSource>& sources,
                           std::int32_t edge);

 private:
  using Key = std::vector<std::int32_t>;
  struct Factors {
    Eigen::HouseholderQR<Eigen::MatrixXd> qr;
    Eigen::VectorXd weights;  ///< per datum
  };
  const Factors& completing(const std::vector<FitSource>& sources, std::int32_t edge);
  double unit_;
  std::map<Key, Factors> factors_;  ///< of complete(), by the offsets of the sources
};

}  // namespace palpate
