#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <memory>
#include <vector>

namespace palpate {

/// The entries of the upper triangle of a symmetric matrix, sorted by row and then by column.
/// 1-based for MUMPS. Contains every diagonal entry.
struct SparsityPattern {
  std::int32_t n = 0;                     ///< number of rows
  std::vector<std::int32_t> row, column;  ///< of every entry, 1 to n, row <= column
  /// n + 1 offsets, 0-based. Row k has the entries row_begin[k] to row_begin[k + 1] - 1. The first
  /// of them is the diagonal entry.
  std::vector<std::int32_t> row_begin;

  /// Returns the index (0-based) of the entry in row min(a, b) and column max(a, b), both 0-based.
  /// The entry must exist.
  std::int32_t entryOf(std::int32_t a, std::int32_t b) const;

  /// Returns the product of the symmetric matrix that has these values with several columns. The
  /// values are read once, and the products of each entry form one vector.
  template <int columns>
  Eigen::Matrix<double, Eigen::Dynamic, columns, Eigen::RowMajor> times(
      const std::vector<double>& values,
      const Eigen::Matrix<double, Eigen::Dynamic, columns, Eigen::RowMajor>& x) const {
    Eigen::Matrix<double, Eigen::Dynamic, columns, Eigen::RowMajor> product(x.rows(), columns);
    product.setZero();
    for (std::size_t entry = 0; entry < values.size(); ++entry) {
      const std::int32_t a = row[entry] - 1, b = column[entry] - 1;
      product.row(a) += values[entry] * x.row(b);
      if (a != b) product.row(b) += values[entry] * x.row(a);
    }
    return product;
  }
};

/// Builds a pattern from the columns of the entries in each row, 0-based. Each row must contain its
/// diagonal and no column to the left of it. Columns may repeat and be unsorted.
SparsityPattern patternOf(std::vector<std::vector<std::int32_t>> columns_of_rows);

/// MUMPS's report on a factorisation.
struct Factorization {
  bool ok = false;
  std::int32_t negative_pivots = 0;     ///< INFOG(12)
  std::int32_t infog1 = 0, infog2 = 0;  ///< INFOG(1) and (2); negative: an error
};

/// Arithmetic of the factors. Single precision takes two thirds of the time and half of the memory.
/// Its solutions are right to about five digits, which is sufficient for a Newton correction or a
/// preconditioner.
enum class Precision : std::uint8_t { single_precision, double_precision };

/// Factorises symmetric indefinite matrices with one sparsity pattern as LDL^T, with sequential
/// MUMPS.
///
/// The analysis runs once, in of(), and uses only the pattern, so the same values always give the
/// same bits. MUMPS is not thread-safe: have at most one LinearSolver per process, and use it from
/// one thread. BLAS runs on one thread.
class LinearSolver {
 public:
  /// Returns a new solver, never null. Error if the analysis fails, or if OpenBLAS gets no memory
  /// (prepareBlas). `pattern` is copied. `singular`: the matrix may have a null space (the spurious
  /// pressure modes of P1/P1). MUMPS then detects vanishing pivots and sets their unknowns to zero.
  static std::unique_ptr<LinearSolver> of(const SparsityPattern& pattern, Precision precision,
                                          bool singular);
  virtual ~LinearSolver() = default;

  /// Factorises the matrix with these values, one per pattern entry. If MUMPS runs out of workspace
  /// (INFOG(1) = -8, -9), the workspace is doubled, at most four times. Error if the machine is out
  /// of memory (-7, -13), because such a failure tells nothing about the matrix.
  [[nodiscard]] virtual Factorization factorize(const std::vector<double>& values) = 0;

  /// Overwrites each column of `right_hand_sides` (n x k, column-major) with its solution. Requires
  /// a successful factorize(). Returns false if MUMPS reports an error.
  [[nodiscard]] virtual bool solve(Eigen::Ref<Eigen::MatrixXd> right_hand_sides) = 0;

  /// Return the number of entries of the factor, and of floating-point operations of one
  /// factorisation, as MUMPS counts them.
  virtual double factorEntries() const = 0;
  virtual double factorFlops() const = 0;
};

}  // namespace palpate
