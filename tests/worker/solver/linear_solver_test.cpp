#include "worker/solver/linear_solver.hpp"

#include <gtest/gtest.h>
#include <sys/resource.h>
#include <unistd.h>

#include <Eigen/Core>
#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <limits>
#include <stdexcept>

#include "common/base/error.hpp"
#include "common/base/index.hpp"

namespace palpate {
namespace {

TEST(SparsityPattern, HasEachEntryOnceInOrder) {
  const SparsityPattern pattern = patternOf({{2, 0, 2, 1}, {1}, {2, 2}});
  EXPECT_EQ(pattern.n, 3);
  EXPECT_EQ(pattern.row, (std::vector<std::int32_t>{1, 1, 1, 2, 3}));
  EXPECT_EQ(pattern.column, (std::vector<std::int32_t>{1, 2, 3, 2, 3}));
  EXPECT_EQ(pattern.row_begin, (std::vector<std::int32_t>{0, 3, 4, 5}));
}

TEST(SparsityPattern, FindsAnEntryFromEitherSide) {
  const SparsityPattern pattern = patternOf({{0, 2}, {1}, {2}});
  EXPECT_EQ(pattern.entryOf(0, 2), 1);
  EXPECT_EQ(pattern.entryOf(2, 0), 1);
  EXPECT_EQ(pattern.entryOf(2, 2), 3);
  EXPECT_THROW(static_cast<void>(pattern.entryOf(0, 1)), std::logic_error);
}

TEST(SparsityPattern, RefusesAnUnknownWithoutEntries) {
  EXPECT_THROW(static_cast<void>(patternOf({{0}, {}})), std::logic_error);
}

/// [2 1 0; 1 -3 1; 0 1 4]: one negative eigenvalue.
SparsityPattern tridiagonal() { return patternOf({{0, 1}, {1, 2}, {2}}); }
const std::vector<double> indefinite = {2, 1, -3, 1, 4};

TEST(LinearSolver, SolvesSeveralRightHandSidesAndCountsNegativePivots) {
  const auto solver = LinearSolver::of(tridiagonal(), Precision::double_precision, false);
  const Factorization factorization = solver->factorize(indefinite);
  ASSERT_TRUE(factorization.ok);
  EXPECT_EQ(factorization.negative_pivots, 1);
  Eigen::Matrix3d K;
  K << 2, 1, 0, 1, -3, 1, 0, 1, 4;
  Eigen::MatrixXd x = Eigen::MatrixXd::Identity(3, 3);
  ASSERT_TRUE(solver->solve(x));
  EXPECT_LT((K * x - Eigen::Matrix3d::Identity()).norm(), 1e-14);
}

/// A pattern of n unknowns; each bit of `bits` is a coupling.
SparsityPattern coupled(std::int32_t n, unsigned bits) {
  std::vector<std::vector<std::int32_t>> rows(at(n));
  for (std::int32_t row = 0; row < n; ++row) {
    rows[at(row)].push_back(row);
    for (std::int32_t column = row + 1; column < n; ++column, bits >>= 1)
      if (bits & 1) rows[at(row)].push_back(column);
  }
  return patternOf(rows);
}

TEST(LinearSolver, SolvesEveryMatrixOfAFewUnknowns) {
  for (std::int32_t n = 1; n <= 5; ++n)
    for (unsigned bits = 0; bits < 1u << n * (n - 1) / 2; ++bits) {
      const SparsityPattern pattern = coupled(n, bits);
      std::vector<double> values(pattern.row.size(), 1);
      for (std::int32_t row = 0; row < n; ++row) values[at(pattern.row_begin[at(row)])] = 10;
      const auto solver = LinearSolver::of(pattern, Precision::double_precision, false);
      EXPECT_TRUE(solver->factorize(values).ok) << n << " unknowns, couplings " << bits;
    }
}

TEST(LinearSolver, ReportsASingularMatrix) {
  const auto solver = LinearSolver::of(tridiagonal(), Precision::double_precision, false);
  const Factorization factorization = solver->factorize({1, 0, 0, 0, 1});
  EXPECT_FALSE(factorization.ok);
  EXPECT_EQ(factorization.infog1, -10);
}

TEST(LinearSolver, HandlesAKnownNullSpace) {
  const auto solver = LinearSolver::of(tridiagonal(), Precision::double_precision, true);
  ASSERT_TRUE(solver->factorize({1, 0, 0, 0, 1}).ok);
  Eigen::MatrixXd x = Eigen::Vector3d(3, 0, 5);
  ASSERT_TRUE(solver->solve(x));
  EXPECT_DOUBLE_EQ(x(0), 3);
  EXPECT_DOUBLE_EQ(x(2), 5);
}

/// A band of 20,000 unknowns, whose factors take 24 MB; only 8 MB are left.
TEST(LinearSolverDeathTest, OutOfMemoryIsAnErrorAndNoAnswer) {
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
  GTEST_SKIP() << "the sanitizer's own memory does not fit under the limit";
#endif
  constexpr int unknowns = 20000, band = 150;
  std::vector<std::vector<std::int32_t>> all(unknowns);
  for (int row = 0; row < unknowns; ++row)
    for (int column = row; column < std::min(row + band, unknowns); ++column)
      all[at(row)].push_back(column);
  const SparsityPattern pattern = patternOf(all);
  std::vector<double> values(pattern.row.size(), 0.001);
  for (int row = 0; row < unknowns; ++row) values[at(pattern.entryOf(row, row))] = unknowns;
  const auto factorizeInLittle = [&] {
    // OpenBLAS allocates its own memory at its first product.
    const auto small = LinearSolver::of(tridiagonal(), Precision::double_precision, false);
    static_cast<void>(small->factorize(indefinite));
    const auto solver = LinearSolver::of(pattern, Precision::double_precision, false);
    std::ifstream statm("/proc/self/statm");
    rlim_t pages = 0;
    statm >> pages;
    const rlim_t room = pages * static_cast<rlim_t>(sysconf(_SC_PAGESIZE)) + (8u << 20);
    const struct rlimit limit = {room, room};
    if (setrlimit(RLIMIT_AS, &limit) != 0) std::_Exit(3);
    try {
      static_cast<void>(solver->factorize(values));
      std::_Exit(4);
    } catch (const Error& error) {
      std::fputs(error.what(), stderr);
      std::_Exit(static_cast<int>(error.exitCode()));
    }
  };
  EXPECT_EXIT(factorizeInLittle(), testing::ExitedWithCode(1), "out of memory");
}

TEST(LinearSolver, GivesNoFiniteSolutionForAMatrixWithNaN) {
  for (const Precision precision : {Precision::single_precision, Precision::double_precision}) {
    const auto solver = LinearSolver::of(tridiagonal(), precision, false);
    for (std::size_t entry = 0; entry < indefinite.size(); ++entry) {
      std::vector<double> values = indefinite;
      values[entry] = std::numeric_limits<double>::quiet_NaN();
      Eigen::MatrixXd x = Eigen::Vector3d(1, 1, 1);
      const bool solved = solver->factorize(values).ok && solver->solve(x);
      EXPECT_FALSE(solved && x.allFinite()) << "entry " << entry;
    }
  }
}

}  // namespace
}  // namespace palpate
