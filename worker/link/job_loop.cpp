#include "worker/link/job_loop.hpp"

#include <algorithm>
#include <exception>

#include "common/base/assertion.hpp"
#include "common/wire/wire.hpp"
#include "worker/solver/path.hpp"

namespace palpate {
namespace {

/// Solves the jobs of one problem. Each result also names its build, target and start.
class ProblemSolver {
 public:
  ProblemSolver(std::shared_ptr<const Problem> problem, const ElementKernels& kernels)
      : problem_(std::move(problem)),
        lattice_(uniformLattice(problem_->scene)),
        build_(problemId(*problem_)),
        solver_(*problem_, kernels,
                {.largest_force = solved_force_share * problem_->scene.workspace.max_force}) {}

  const std::shared_ptr<const Problem>& problem() const { return problem_; }

  void solve(const ReadyJob& ready, Mailbox& mailbox) {
    const wire::Job& job = ready.job;
    PALPATE_ASSERT(ready.start || job.start_id().empty(), "a job needs its start configuration");
    PALPATE_ASSERT(job.space() < problem_->active.size() && job.targets_size() > 0,
                   "a job needs an active node and displacements");
    solver_.chooseTool(job.space());
    Failure start_failure;
    const auto start =
        ready.start ? solver_.startFrom(*ready.start, displacementOf(job.start()), start_failure)
                    : solver_.startAtRest(start_failure);
    // If the start cannot be prepared, every target fails, and each failure is reported as a
    // result.
    for (int n = 0; n < job.targets_size(); ++n) {
      const wire::Target& target = job.targets(n);
      if (!mailbox.begin(job.id(), target.point())) return;
      const int transitions = static_cast<int>(std::max(1U, target.steps()));
      // A failed transition ends the path (Rescue::none), because the scheduler's plan decides
      // which targets are tried again, and from which start.
      const Outcome outcome =
          start ? walk(solver_, *start, displacementOf(target.point()), transitions, Rescue::none)
                      .outcome
                : Outcome{start_failure, {}};
      FinishedTarget finished;
      finished.last_of_job = n + 1 == job.targets_size();
      describe(job, target, finished.result);
      if (outcome.converged()) finished.fields = outcome.configuration().fields.encode();
      toWire(outcome, finished.fields, finished.result);
      mailbox.finish(std::move(finished));
    }
  }

 private:
  Eigen::Vector3d displacementOf(const wire::Point& point) const {
    return lattice_.displacementOf(fromWire(point));
  }

  void describe(const wire::Job& job, const wire::Target& target, wire::Result& result) const {
    result.set_build(std::string(build_.bytes()));
    result.set_space(job.space());
    *result.mutable_target() = target.point();
    *result.mutable_parent() = job.start();
    result.set_start_id(job.start_id());
    result.set_lease(target.lease());
    result.set_kernel_family(arithmetic(solver_.system().kernels()));
  }

  std::shared_ptr<const Problem> problem_;
  Lattice lattice_;
  ContentId build_;
  TransitionSolver solver_;
};

}  // namespace

void solveJobs(Mailbox& mailbox, const ElementKernels& kernels) {
  try {
    std::unique_ptr<ProblemSolver> solver;
    while (const auto ready = mailbox.next()) {
      if (!solver || solver->problem() != ready->problem) {
        solver.reset();  // one MUMPS instance at a time
        solver = std::make_unique<ProblemSolver>(ready->problem, kernels);
      }
      solver->solve(*ready, mailbox);
    }
    mailbox.solverEnds("");
  } catch (const std::exception& error) {
    mailbox.solverEnds(error.what());
  }
}

}  // namespace palpate
