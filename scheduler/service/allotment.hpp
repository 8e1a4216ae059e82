#pragma once

#include "scheduler/service/worker_registry.hpp"

namespace palpate {

struct AllotmentSettings {
  /// A worker from which nothing came for so many times as long as it usually takes between two
  /// results of one, and for overdue_at_least (overdue_without_any when nothing is recorded yet),
  /// holds up others that have nothing to do: they are given some of it.
  double overdue_factor = 8;
  std::chrono::seconds overdue_at_least{2}, overdue_without_any{30};
  /// And it is given none for so long, if it delivers nothing.
  std::chrono::seconds overdue_pause{30};
};

/// How many targets each worker may hold, and when it held them for too long: whoever takes work
/// and does none of it, or little, keeps little from those who would. What they hold is for Leases
/// to know. One thread.
class Allotment {
 public:
  using Time = Worker::Time;
  explicit Allotment(const AllotmentSettings& settings = {}) : settings_(settings) {}

  /// So many it may hold in all: as many as it delivered, within what it does in the time in which
  /// the usual worker does two jobs; two at first.
  std::size_t limitOf(const Worker& worker, Time now) const;
  /// It held nothing, and is given something.
  void noteFirst(Worker& worker, Time now) const { worker.moved = now; }
  /// It delivered what it was asked for.
  void noteDelivery(Worker& worker, Time now);
  /// It delivered nothing for so long that others may be given what it holds, of which this was
  /// handed out so often.
  bool isOverdue(const Worker& worker, std::uint32_t attempts, Time now) const;
  /// They are. It is a newcomer again, once it may have anything.
  void noteOverdue(Worker& worker, Time now) const;

 private:
  AllotmentSettings settings_;
  double between_results_ = 0;  ///< s, of a worker, as it was lately; 0 before the first
};

}  // namespace palpate
