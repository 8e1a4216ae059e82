#pragma once

#include <chrono>

#include "scheduler/state/job_store.hpp"
#include "scheduler/state/journal.hpp"

namespace palpate {

/// Results that came in and wait to become durable together: one sync and one transaction for all
/// (group commit), because each of the two costs as long as many small solves.
///
/// Nothing in it counts before commit() returned. One thread. `store` and `journal` must outlive
/// it.
class ResultGroup {
 public:
  using Time = std::chrono::steady_clock::time_point;

  struct Member {
    StoredResult result;  ///< `where` is filled by commit()
    std::string payload;
    std::set<std::string> senders;  ///< peers that wait for the acknowledgement; may be empty
  };
  using Members = std::map<TransitionKey, Member>;

  ResultGroup(JobStore& store, Journal& journal) : store_(&store), journal_(&journal) {}

  /// A transition that is not in the group yet.
  void add(StoredResult result, std::string payload, Time now);
  /// Null when the transition is not in the group.
  Member* find(const TransitionKey& key);
  std::size_t size() const { return members_.size(); }
  /// When the first of them came; nothing when there is none.
  std::optional<Time> since() const { return since_; }

  /// Makes all of them durable: journal append, fdatasync, transaction, in that order, which is
  /// what an acknowledgement promises (docs/state.md). Returns them; the group is empty then.
  /// Errors are those of Journal and JobStore: nothing of the group may be acknowledged after one.
  Members commit();

 private:
  JobStore* store_;
  Journal* journal_;
  Members members_;
  std::optional<Time> since_;
};

}  // namespace palpate
