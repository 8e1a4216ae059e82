#pragma once

#include "scheduler/service/worker_registry.hpp"

namespace palpate {

struct AllotmentSettings {
  /// A worker is overdue if it delivered nothing for overdue_factor times the usual time between
  /// two results of a worker, and for overdue_at_least. Before the first result the limit is
  /// overdue_without_any. Workers without work are then given some of its targets.
  double overdue_factor = 8;
  std::chrono::seconds overdue_at_least{2}, overdue_without_any{30};
  /// Time without new work for an overdue worker that delivers nothing.
  std::chrono::seconds overdue_pause{30};
};

/// Limits the targets that each worker may hold, and decides when it has held them for too long. A
/// worker that does little or none of its work thus keeps little from others. The leases themselves
/// are in Leases. One thread.
class Allotment {
 public:
  using Time = Worker::Time;
  explicit Allotment(const AllotmentSettings& settings = {}) : settings_(settings) {}

  /// Returns the number of targets that a worker may hold in all: the number that it delivered, two
  /// at first. The upper limit is its work in the time in which the usual worker does two jobs.
  /// Returns 0 while an overdue worker gets no work.
  std::size_t limitOf(const Worker& worker, Time now) const;
  /// Notes that a worker without targets is given some.
  void noteFirst(Worker& worker, Time now) const { worker.moved = now; }
  /// Notes the delivery of a result that the worker was asked for.
  void noteDelivery(Worker& worker, Time now);
  /// Returns true if the worker delivered nothing for so long that its last target may go to
  /// another worker. `attempts` is the number of hand-outs of that target.
  bool isOverdue(const Worker& worker, std::uint32_t attempts, Time now) const;
  /// Notes that its last target went to another worker. It gets no work for a while, and then
  /// starts like a new worker.
  void noteOverdue(Worker& worker, Time now) const;

 private:
  AllotmentSettings settings_;
  double between_results_ = 0;  ///< s, recent mean over all workers; 0 before the first
};

}  // namespace palpate
