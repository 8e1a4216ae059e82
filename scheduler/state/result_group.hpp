#pragma once

#include <chrono>
#include <set>

#include "scheduler/state/job_store.hpp"

namespace palpate {

/// Results that came in and wait to become durable together: one sync for all (group commit),
/// because it costs as long as many small solves.
///
/// Nothing in it counts before commit() returned. One thread. `store` must outlive it.
class ResultGroup {
 public:
  using Time = std::chrono::steady_clock::time_point;

  struct Member {
    wire::Result result;  ///< as it is to be recorded
    Outcome outcome;      ///< what it says, without fields
    std::string payload;
    std::set<std::string> senders;  ///< peers that wait for the acknowledgement; may be empty
    bool is_checked = false;        ///< others solve it again
    bool is_disputed = false;       ///< another found something else
  };
  using Members = std::map<ResultKey, Member>;

  explicit ResultGroup(JobStore& store) : store_(&store) {}

  /// A transition that is not in the group yet.
  void add(const ResultKey& key, Member member, Time now);
  /// Null when the transition is not in the group.
  Member* find(const ResultKey& key);
  bool has(const ResultKey& key) const { return members_.contains(key); }
  const Members& members() const { return members_; }
  std::size_t size() const { return members_.size(); }
  /// Of payloads.
  std::size_t bytes() const { return bytes_; }
  /// When the first of them came; nothing when there is none.
  std::optional<Time> since() const { return since_; }

  /// Makes all of them durable, which is what an acknowledgement promises (docs/state.md). Returns
  /// them; the group is empty then. Errors are those of JobStore: nothing of the group may be
  /// acknowledged after one.
  Members commit();

 private:
  JobStore* store_;
  Members members_;
  std::size_t bytes_ = 0;
  std::optional<Time> since_;
};

}  // namespace palpate
