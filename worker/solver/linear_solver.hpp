#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <memory>
#include <vector>

namespace palpate {

/// Where the upper triangle of a symmetric matrix has entries, row by row and in each row by
/// column. 1-based as MUMPS wants it; every diagonal entry is there.
struct SparsityPattern {
  std::int32_t n = 0;                     ///< rows
  std::vector<std::int32_t> row, column;  ///< of every entry, 1 to n, row <= column
  /// n + 1 numbers, 0-based: row k of them has the entries row_begin[k] to row_begin[k + 1], and
  /// the first of these is its diagonal.
  std::vector<std::int32_t> row_begin;

  /// The entry in row min(a, b) and column max(a, b), 0-based; it must be there.
  std::int32_t entryOf(std::int32_t a, std::int32_t b) const;
};

/// The pattern in which row k, 0-based, has these columns, also 0-based, at least k itself. They
/// may repeat and stand in any order, none of them left of the diagonal.
SparsityPattern patternOf(std::vector<std::vector<std::int32_t>> columns_of_rows);

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
/// Analysis happens once, in of(), on the pattern alone; so the same values always give
/// the same bits. MUMPS is not thread-safe: at most one LinearSolver per process, used from one
/// thread. BLAS is held to one thread.
class LinearSolver {
 public:
  /// A new one, never null. Error when the analysis fails, or OpenBLAS gets no memory
  /// (prepareBlas). `pattern` is copied. `singular`: the matrix may have a null space (the spurious
  /// pressure modes of P1/P1); pivots that vanish are then detected and their unknowns kept at
  /// zero.
  static std::unique_ptr<LinearSolver> of(const SparsityPattern& pattern, Precision precision,
                                          bool singular);
  virtual ~LinearSolver() = default;

  /// values: one per pattern entry, upper triangle. When MUMPS runs out of workspace (INFOG(1) =
  /// -8, -9) it is given twice as much, at most four times. Error when the machine has no memory
  /// left (-7, -13), which is no answer about the body.
  [[nodiscard]] virtual Factorization factorize(const std::vector<double>& values) = 0;

  /// Overwrites each column of `right_hand_sides` (n x k, column-major) with its solution. Only
  /// after an ok factorize(). False when MUMPS reports an error.
  [[nodiscard]] virtual bool solve(Eigen::Ref<Eigen::MatrixXd> right_hand_sides) = 0;

  /// Entries of the factor and floating-point operations of one factorisation, as MUMPS counts
  /// them.
  virtual double factorEntries() const = 0;
  virtual double factorFlops() const = 0;
};

}  // namespace palpate
