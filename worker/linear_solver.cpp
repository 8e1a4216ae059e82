#include "worker/linear_solver.hpp"

#include <cblas.h>
#include <dmumps_c.h>

#include "common/error.hpp"

namespace palpate {
namespace {

constexpr int initialize = -1, terminate = -2, analyse = 1, factorise = 2, substitute = 3;
constexpr int use_comm_world = -987654;
/// SCOTCH orders about as well but differently in every process, so its factors differ in the last bits.
constexpr int ordering_pord = 4;
constexpr int workspace_percent = 50;  ///< ICNTL(14); avoids nearly all retries
constexpr int workspace_retries = 4;

}  // namespace

struct LinearSolver::Mumps {
  DMUMPS_STRUC_C data{};
  std::vector<MUMPS_INT> row, column;
  std::vector<double> values;

  MUMPS_INT& control(int number) { return data.icntl[number - 1]; }
  int infog(int number) const { return data.infog[number - 1]; }
  int run(int job) {
    data.job = job;
    dmumps_c(&data);
    return infog(1);
  }
};

LinearSolver::LinearSolver(const Pattern& pattern, bool singular) : mumps_(std::make_unique<Mumps>()) {
  openblas_set_num_threads(1);
  Mumps& mumps = *mumps_;
  mumps.row.assign(pattern.row.begin(), pattern.row.end());
  mumps.column.assign(pattern.column.begin(), pattern.column.end());
  mumps.values.resize(pattern.row.size());
  mumps.data.par = 1;
  mumps.data.sym = 2;
  mumps.data.comm_fortran = use_comm_world;
  if (mumps.run(initialize) < 0) throw failure("MUMPS could not start: INFOG(1) = {}", mumps.infog(1));

  for (const int stream : {1, 2, 3}) mumps.control(stream) = -1;
  mumps.control(4) = 0;
  mumps.control(7) = ordering_pord;
  mumps.control(8) = 0;  // the unknowns are scaled already (System::pressureScale)
  mumps.control(12) = 1;
  mumps.control(13) = 1;  // count negative pivots exactly
  mumps.control(14) = workspace_percent;
  mumps.control(24) = singular ? 1 : 0;
  mumps.data.n = pattern.n;
  mumps.data.nnz = static_cast<MUMPS_INT8>(pattern.row.size());
  mumps.data.irn = mumps.row.data();
  mumps.data.jcn = mumps.column.data();
  mumps.data.a = mumps.values.data();
  if (mumps.run(analyse) < 0) {
    const int infog1 = mumps.infog(1), infog2 = mumps.infog(2);
    mumps.run(terminate);
    throw failure("MUMPS analysis of {} unknowns failed: INFOG(1) = {}, INFOG(2) = {}", pattern.n, infog1,
                  infog2);
  }
}

LinearSolver::~LinearSolver() {
  mumps_->run(terminate);
}

Factorization LinearSolver::factorize(const std::vector<double>& values) {
  Mumps& mumps = *mumps_;
  Factorization result;
  for (int attempt = 0; attempt <= workspace_retries; ++attempt) {
    std::copy(values.begin(), values.end(), mumps.values.begin());
    result.infog1 = mumps.run(factorise);
    result.infog2 = mumps.infog(2);
    if (result.infog1 != -8 && result.infog1 != -9) break;
    mumps.control(14) *= 2;
  }
  result.ok = result.infog1 >= 0;
  result.negative_pivots = mumps.infog(12);
  return result;
}

bool LinearSolver::solve(Eigen::Ref<Eigen::MatrixXd> right_hand_sides) {
  Mumps& mumps = *mumps_;
  mumps.data.rhs = right_hand_sides.data();
  mumps.data.nrhs = static_cast<MUMPS_INT>(right_hand_sides.cols());
  mumps.data.lrhs = static_cast<MUMPS_INT>(right_hand_sides.outerStride());
  return mumps.run(substitute) >= 0;
}

double LinearSolver::factorEntries() const {
  // Negative values are millions (MUMPS manual, INFOG(29)).
  const int entries = mumps_->infog(29);
  return entries >= 0 ? entries : -1e6 * entries;
}

double LinearSolver::factorFlops() const {
  return mumps_->data.rinfog[2];
}

}  // namespace palpate
