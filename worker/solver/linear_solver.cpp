#include "worker/solver/linear_solver.hpp"

#include <dmumps_c.h>
#include <smumps_c.h>

#include <algorithm>

#include "common/base/assertion.hpp"
#include "common/base/error.hpp"
#include "common/mesh/node_set.hpp"
#include "worker/elements/blas_kernels.hpp"

namespace palpate {
namespace {

/// Values of MUMPS's parameter JOB, one per phase of its manual.
constexpr int initialize = -1, terminate = -2, analyse = 1, factorise = 2, substitute = 3;
constexpr int use_comm_world = -987654;
/// Values of INFOG(1) if the workspace of reals or of integers is too small.
constexpr int short_of_reals = -8, short_of_integers = -9;
/// Ordering methods, ICNTL(7). SCOTCH orders about as well, but differently in each process, so the
/// factors would differ in their last bits.
constexpr int ordering_pord = 4, ordering_amd = 0;
/// Values of INFOG(1) if MUMPS could not allocate integers or reals. INFOG(2) is then their number.
constexpr int no_integers = -7, no_reals = -13;
constexpr int workspace_percent = 50;  ///< ICNTL(14); avoids nearly all retries
constexpr int workspace_retries = 4;

/// Returns whether every unknown is coupled to every other one. PORD would then merge all unknowns
/// into one, and end the process.
bool isFull(const SparsityPattern& pattern) {
  const auto n = static_cast<std::size_t>(pattern.n);
  return pattern.row.size() == n * (n + 1) / 2;
}

/// Throws an Error if MUMPS ran out of memory. Unlike a matrix that cannot be factorised, a lack of
/// memory says nothing about the body.
void refuseWithoutMemory(int infog1, int infog2) {
  if (infog1 != no_integers && infog1 != no_reals) return;
  // A negative INFOG(2) is a number of millions (MUMPS manual).
  const double numbers = infog2 >= 0 ? infog2 : -1e6 * infog2;
  throw failure(
      "out of memory: the linear solver could not allocate {:.3g} numbers (MUMPS INFOG(1) = {}); "
      "close other programs, start fewer workers, raise the memory limit, or use a coarser mesh",
      numbers, infog1);
}

/// A solver in one of MUMPS's arithmetics, given by its structure, real type and entry point.
template <class Structure, class Real, void (*call)(Structure*)>
class Mumps : public LinearSolver {
 public:
  Mumps(const SparsityPattern& pattern, bool singular)
      : row_(pattern.row.begin(), pattern.row.end()),
        column_(pattern.column.begin(), pattern.column.end()),
        values_(pattern.row.size()) {
    data_.par = 1;
    data_.sym = 2;
    data_.comm_fortran = use_comm_world;
    if (run(initialize) < 0) throw failure("MUMPS could not start: INFOG(1) = {}", infog(1));
    for (const int stream : {1, 2, 3}) control(stream) = -1;
    control(4) = 0;
    control(7) = isFull(pattern) ? ordering_amd : ordering_pord;
    control(8) = 0;  // the unknowns are scaled already (System::pressureScale)
    control(12) = 1;
    control(13) = 1;  // count negative pivots exactly
    control(14) = workspace_percent;
    control(24) = singular ? 1 : 0;
    data_.n = pattern.n;
    data_.nnz = static_cast<MUMPS_INT8>(row_.size());
    data_.irn = row_.data();
    data_.jcn = column_.data();
    data_.a = values_.data();
    if (run(analyse) >= 0) return;
    const int infog1 = infog(1), infog2 = infog(2);
    run(terminate);
    throw failure("MUMPS analysis of {} unknowns failed: INFOG(1) = {}, INFOG(2) = {}", pattern.n,
                  infog1, infog2);
  }
  ~Mumps() override { run(terminate); }
  Mumps(const Mumps&) = delete;
  Mumps& operator=(const Mumps&) = delete;

  Factorization factorize(const std::vector<double>& values) override {
    PALPATE_ASSERT(values.size() == values_.size(),
                   "MUMPS needs a value for every entry it analysed");
    Factorization result;
    for (int attempt = 0; attempt <= workspace_retries; ++attempt) {
      std::transform(values.begin(), values.end(), values_.begin(),
                     [](double value) { return static_cast<Real>(value); });
      result.infog1 = run(factorise);
      result.infog2 = infog(2);
      if (result.infog1 != short_of_reals && result.infog1 != short_of_integers) break;
      control(14) *= 2;
    }
    refuseWithoutMemory(result.infog1, result.infog2);
    result.ok = result.infog1 >= 0;
    result.negative_pivots = infog(12);
    return result;
  }

  bool solve(Eigen::Ref<Eigen::MatrixXd> right_hand_sides) override {
    PALPATE_ASSERT(right_hand_sides.rows() == data_.n, "each right-hand side must have n rows");
    // Scales each column so that its largest entry is one. Without this, small residuals would
    // underflow in single precision.
    Eigen::RowVectorXd scale = right_hand_sides.cwiseAbs().colwise().maxCoeff();
    scale = (scale.array() > 0).select(scale, 1.0);
    columns_ = (right_hand_sides.array().rowwise() / scale.array()).template cast<Real>();
    data_.rhs = columns_.data();
    data_.nrhs = static_cast<MUMPS_INT>(columns_.cols());
    data_.lrhs = static_cast<MUMPS_INT>(columns_.rows());
    if (run(substitute) < 0) {
      refuseWithoutMemory(infog(1), infog(2));
      return false;
    }
    right_hand_sides = columns_.template cast<double>().array().rowwise() * scale.array();
    return true;
  }

  double factorEntries() const override {
    // A negative INFOG(29) is a number of millions (MUMPS manual).
    return infog(29) >= 0 ? infog(29) : -1e6 * infog(29);
  }
  double factorFlops() const override { return static_cast<double>(data_.rinfog[2]); }

 private:
  int infog(int number) const { return data_.infog[number - 1]; }
  MUMPS_INT& control(int number) { return data_.icntl[number - 1]; }
  int run(int job) {
    data_.job = job;
    call(&data_);
    return infog(1);
  }

  Structure data_{};
  std::vector<MUMPS_INT> row_, column_;
  std::vector<Real> values_;
  Eigen::Matrix<Real, Eigen::Dynamic, Eigen::Dynamic> columns_;
};

}  // namespace

std::int32_t SparsityPattern::entryOf(std::int32_t a, std::int32_t b) const {
  const std::int32_t upper = std::min(a, b), wanted = std::max(a, b) + 1;
  const auto begin = column.begin() + row_begin[upper], end = column.begin() + row_begin[upper + 1];
  const auto found = std::lower_bound(begin, end, wanted);
  PALPATE_ASSERT(found != end && *found == wanted,
                 "the pattern must contain every entry of the elements");
  return static_cast<std::int32_t>(found - column.begin());
}

SparsityPattern patternOf(std::vector<std::vector<std::int32_t>> columns_of_rows) {
  SparsityPattern pattern;
  pattern.n = static_cast<std::int32_t>(columns_of_rows.size());
  for (std::int32_t row = 0; row < pattern.n; ++row) {
    std::vector<std::int32_t>& columns = columns_of_rows[row];
    sortUnique(columns);
    PALPATE_ASSERT(!columns.empty() && columns.front() == row,
                   "an unknown must occur in an element, or its row is singular");
    pattern.row_begin.push_back(static_cast<std::int32_t>(pattern.row.size()));
    for (const std::int32_t column : columns) {
      pattern.row.push_back(row + 1);
      pattern.column.push_back(column + 1);
    }
  }
  pattern.row_begin.push_back(static_cast<std::int32_t>(pattern.row.size()));
  return pattern;
}

std::unique_ptr<LinearSolver> LinearSolver::of(const SparsityPattern& pattern, Precision precision,
                                               bool singular) {
  prepareBlas();
  if (precision == Precision::single_precision)
    return std::make_unique<Mumps<SMUMPS_STRUC_C, float, smumps_c>>(pattern, singular);
  return std::make_unique<Mumps<DMUMPS_STRUC_C, double, dmumps_c>>(pattern, singular);
}

}  // namespace palpate
