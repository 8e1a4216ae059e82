#pragma once

#include <atomic>

#include "scheduler/service/lease_seal.hpp"
#include "scheduler/service/second_solves.hpp"

namespace palpate {

/// Counts the bytes of sent payloads that peers have not read. A payload is counted until the
/// messaging library releases it, which may happen in any thread. Shared payloads (the problem)
/// take no extra memory and are not counted.
class UnreadPayloads {
 public:
  /// Returns the payload for sending. It is counted until its last owner releases it.
  std::shared_ptr<const std::string> add(std::string payload) const {
    auto* const owned = new std::string(std::move(payload));
    *bytes_ += owned->size();
    return {owned, [bytes = bytes_](const std::string* sent) {
              *bytes -= sent->size();
              delete sent;
            }};
  }
  std::size_t bytes() const { return *bytes_; }

 private:
  /// Shared with the payloads, because they may outlive this object.
  std::shared_ptr<std::atomic<std::size_t>> bytes_ = std::make_shared<std::atomic<std::size_t>>(0);
};

/// Sends workers their jobs, the problem, and the configurations that jobs start from. One thread;
/// the references must outlive this object.
class Handouts {
 public:
  /// `problem_bytes` is encodeProblem(problem).
  Handouts(ServiceState& state, Workers& workers, const SecondSolves& seconds,
           std::string problem_bytes);

  /// Hands out waiting transitions and checks to the workers that ask and have room. Idle workers
  /// come first, because the second job of one worker could be the first job of another. Among idle
  /// workers, and among busy ones, proven workers come before new ones; among equals, workers with
  /// fewer targets come first.
  void handOut();
  void sendProblem(const Worker& worker);
  /// Sends the nodal fields that a job starts from. If workers have left too many bytes of fields
  /// unread (unread_starts), sends nothing; the worker asks again.
  void sendFields(const Worker& worker, const wire::FieldsRequest& request);
  /// Returns true if the result carries the seal of a lease to this worker (isLeaseSeal).
  bool asked(const Worker& worker, const wire::Result& result) const;
  /// Notes the duration of a solve, s. A solve that takes far longer than the longest one so far
  /// counts as hung.
  void noteSolve(double seconds) { longest_solve_ = std::max(longest_solve_, seconds); }

 private:
  void sendJob(const Worker& worker, const Handout& handout);
  std::optional<ResultKey> solverOf(const wire::FieldsRequest& request) const;
  std::chrono::seconds hungAfter() const;

  ServiceState& state_;
  Workers& workers_;
  const SecondSolves& seconds_;
  const std::shared_ptr<const std::string> problem_bytes_;
  const std::string secret_;
  UnreadPayloads unread_starts_;
  double longest_solve_;  ///< longest solve of all results, s; 0 before the first result
};

}  // namespace palpate
