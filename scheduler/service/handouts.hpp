#pragma once

#include "scheduler/service/lease_seal.hpp"
#include "scheduler/service/second_solves.hpp"
#include "scheduler/service/unread_payloads.hpp"

namespace palpate {

/// What workers are given: jobs, the problem, and the configurations that jobs start from. One
/// thread; the references must outlive it.
class Handouts {
 public:
  /// `problem_bytes` is encodeProblem(problem).
  Handouts(ServiceState& state, Workers& workers, const SecondSolves& seconds,
           std::string problem_bytes);

  /// Jobs for whoever asks and may have one, as long as something waits: to those that hold
  /// nothing, and then to those that hold least, first to those that are known to do what they are
  /// given. The second job of a worker would be the first of another.
  void handOut();
  void sendProblem(const Worker& worker);
  /// The fields of a start; nothing when too much of that lies unread: the worker asks again.
  void sendFields(const Worker& worker, const wire::FieldsRequest& request);
  /// Whether this worker was asked for that result.
  bool asked(const Worker& worker, const wire::Result& result) const;
  /// A solve took so long, s: those that take far longer are hung.
  void noteSolve(double seconds) { longest_solve_ = std::max(longest_solve_, seconds); }

 private:
  void sendJob(const Worker& worker, const Handout& handout);
  std::optional<ResultKey> solverOf(const wire::FieldsRequest& request) const;
  std::chrono::seconds hungAfter() const;

  ServiceState& state_;
  Workers& workers_;
  const SecondSolves& seconds_;
  const std::shared_ptr<const std::string> problem_bytes_;
  LeaseSeal seal_;
  UnreadPayloads unread_starts_;
  double longest_solve_;  ///< s, of all results; 0 before the first
};

}  // namespace palpate
