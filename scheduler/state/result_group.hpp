#pragma once

#include <chrono>
#include <set>

#include "scheduler/state/job_store.hpp"

namespace palpate {

/// Results that wait to become durable together. One sync covers all of them (group commit),
/// because a sync costs as much as many small solves.
///
/// No result is durable before commit() has returned. One thread. `store` must outlive this object.
class ResultGroup {
 public:
  using Time = std::chrono::steady_clock::time_point;

  struct Member {
    wire::Result result;  ///< as it will be recorded
    Outcome outcome;      ///< decoded from `result`, without nodal fields
    std::string payload;
    std::set<std::string> senders;  ///< peers that wait for the acknowledgement; may be empty
    bool is_checked = false;        ///< another worker is to solve it again
    bool is_disputed = false;       ///< another worker found a different result
  };
  using Members = std::map<ResultKey, Member>;

  explicit ResultGroup(JobStore& store) : store_(&store) {}

  /// Adds a result. Its transition must not be in the group yet.
  void add(const ResultKey& key, Member member, Time now);
  /// Returns null if the transition is not in the group.
  Member* find(const ResultKey& key);
  bool has(const ResultKey& key) const { return members_.contains(key); }
  const Members& members() const { return members_; }
  std::size_t size() const { return members_.size(); }
  /// Total size of the payloads.
  std::size_t bytes() const { return bytes_; }
  /// Arrival time of the first result; none if the group is empty.
  std::optional<Time> since() const { return since_; }

  /// Makes all results durable, so that they may be acknowledged (docs/internals/state.md). Returns
  /// them and empties the group. Throws like JobStore; after an error no result of the group may be
  /// acknowledged.
  Members commit();

 private:
  JobStore* store_;
  Members members_;
  std::size_t bytes_ = 0;
  std::optional<Time> since_;
};

}  // namespace palpate
