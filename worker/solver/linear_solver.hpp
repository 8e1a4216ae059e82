#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <memory>
#include <vector>

#include "worker/solver/sparsity_pattern.hpp"

namespace palpate {

/// What MUMPS said about a factorisation.
struct Factorization {
  bool ok = false;
  std::int32_t negative_pivots = 0;     ///< INFOG(12)
  std::int32_t infog1 = 0, infog2 = 0;  ///< INFOG(1) and (2); negative: an error
};

/// Arithmetic of the factors. Single precision takes two thirds of the time and half of the memory;
/// what it solves is right to about five digits, for a Newton correction or a preconditioner as
/// good as all of them.
enum class Precision : std::uint8_t { single_precision, double_precision };

/// LDL^T of a symmetric indefinite matrix with a pattern that stays, by sequential MUMPS.
///
/// Analysis happens once, in the constructor, on the pattern alone; so the same values always give
/// the same bits. MUMPS is not thread-safe: at most one LinearSolver per process, used from one
/// thread. BLAS is held to one thread.
class LinearSolver {
 public:
  /// Error when the analysis fails, or OpenBLAS computes wrong products (prepareBlas). `pattern` is
  /// copied. `singular`: the matrix may have a null
  /// space (the spurious pressure modes of P1/P1); pivots that vanish are then detected and their
  /// unknowns kept at zero.
  LinearSolver(const SparsityPattern& pattern, Precision precision, bool singular);
  ~LinearSolver();
  LinearSolver(const LinearSolver&) = delete;
  LinearSolver& operator=(const LinearSolver&) = delete;

  /// values: one per pattern entry, upper triangle. When MUMPS runs out of workspace (INFOG(1) =
  /// -8, -9) it is given twice as much, at most four times.
  [[nodiscard]] Factorization factorize(const std::vector<double>& values);

  /// Overwrites each column of `right_hand_sides` (n x k, column-major) with its solution. Only
  /// after an ok factorize(). False when MUMPS reports an error.
  [[nodiscard]] bool solve(Eigen::Ref<Eigen::MatrixXd> right_hand_sides);

  /// Entries of the factor and floating-point operations of one factorisation, as MUMPS counts
  /// them.
  double factorEntries() const;
  double factorFlops() const;

  /// MUMPS in one arithmetic (linear_solver.cpp).
  class Arithmetic;

 private:
  std::unique_ptr<Arithmetic> mumps_;
};

}  // namespace palpate
