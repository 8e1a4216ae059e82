#pragma once

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <Eigen/QR>
#include <optional>
#include <vector>

namespace palpate {

/// The symmetric systems of interpolation with radial functions. A (n x n) is positive definite
/// only for weights that are orthogonal to some polynomials, the columns of P (n x m, m much
/// smaller than n):
///
///   A w + P c = f,  P^T w = 0    with a polynomial tail
///   A w = f                      without one
///
/// In an orthonormal basis whose first columns span P all but m rows and columns of A are definite,
/// so one Cholesky factorisation (n^3 / 3 multiplications and additions) serves both systems and
/// all right sides.
class ConditionalSystem {
 public:
  /// A: symmetric, both triangles; its memory becomes the factor. P: columns that depend on earlier
  /// ones (few or aligned points) are left out, their coefficients are zero.
  ConditionalSystem(Eigen::MatrixXd A, const Eigen::MatrixXd& P);
  ConditionalSystem(const ConditionalSystem&) = delete;
  ConditionalSystem& operator=(const ConditionalSystem&) = delete;

  /// False when A is not definite to the rounding: points too close to each other. Then nothing can
  /// be solved.
  bool definite() const { return definite_; }
  /// Of the definite part, estimated in the 1-norm; infinite when it is not definite.
  double condition() const;

  struct Solution {
    Eigen::MatrixXd weights;  ///< n x columns of f
    Eigen::MatrixXd tail;     ///< m x columns of f
  };
  Solution withTail(const Eigen::MatrixXd& f) const;
  /// Not finite when A itself is singular.
  Eigen::MatrixXd withoutTail(const Eigen::MatrixXd& f) const;

 private:
  using Factor = Eigen::LLT<Eigen::Ref<Eigen::MatrixXd>>;

  Eigen::MatrixXd A_;                        ///< in the basis; its definite corner holds the factor
  std::vector<Eigen::Index> columns_;        ///< of P that are independent
  Eigen::HouseholderQR<Eigen::MatrixXd> P_;  ///< of those columns; the basis
  Eigen::MatrixXd coupling_;      ///< rows of the columns of P, columns of the definite corner
  Eigen::MatrixXd first_;         ///< corner of the columns of P
  std::optional<Factor> factor_;  ///< none when P spans everything
  bool definite_ = true;
  Eigen::Index polynomials_ = 0;  ///< column count of P
};

}  // namespace palpate
