#pragma once

#include "scheduler/service/worker_registry.hpp"

namespace palpate {

struct AllotmentSettings {
  /// A worker is overdue if it has delivered nothing for overdue_factor times the mean time between
  /// two results of a worker, and for at least overdue_at_least. Before the first result of any
  /// worker, the limit is overdue_without_any. The last target of an overdue worker goes to a
  /// worker without work.
  double overdue_factor = 8;
  std::chrono::seconds overdue_at_least{2}, overdue_without_any{30};
  /// Time for which an overdue worker gets no new work, unless it delivers a result.
  std::chrono::seconds overdue_pause{30};
};

/// Limits the number of targets that each worker may hold, and decides when a worker has held its
/// targets for too long. A slow or broken worker thus keeps few targets from other workers. The
/// leases themselves are in Leases. One thread.
class Allotment {
 public:
  using Time = Worker::Time;
  explicit Allotment(const AllotmentSettings& settings = {}) : settings_(settings) {}

  /// Returns the number of targets that a worker may hold at a time: Worker::earned, but at least
  /// two. The upper limit is two full jobs; for a worker slower than the mean it is reduced in
  /// proportion. Returns 0 while an overdue worker gets no work.
  std::size_t limitOf(const Worker& worker, Time now) const;
  /// Call when a worker without targets is given some. The time to its next result is measured from
  /// `now`.
  void noteFirst(Worker& worker, Time now) const { worker.moved = now; }
  /// Call when a worker delivers a result that it was asked for.
  void noteDelivery(Worker& worker, Time now);
  /// Returns true if the worker has delivered nothing for so long that its last target may go to
  /// another worker. `attempts` is the number of times that this target was handed out.
  bool isOverdue(const Worker& worker, std::uint32_t attempts, Time now) const;
  /// Call when the last target of an overdue worker goes to another worker. The overdue worker gets
  /// no work for overdue_pause, and then starts with the limit of a new worker.
  void noteOverdue(Worker& worker, Time now) const;

 private:
  AllotmentSettings settings_;
  double between_results_ = 0;  ///< recent mean time between results of a worker, s; 0 at first
};

}  // namespace palpate
