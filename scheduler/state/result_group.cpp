#include "scheduler/state/result_group.hpp"

#include "common/base/assertion.hpp"

namespace palpate {

void ResultGroup::add(StoredResult result, std::string payload, Time now) {
  const TransitionKey key = result.key;
  const bool fresh =
      members_.try_emplace(key, Member{std::move(result), std::move(payload), {}}).second;
  PALPATE_ASSERT(fresh, "a second result of a transition is a duplicate of the first");
  if (!since_) since_ = now;
}

ResultGroup::Member* ResultGroup::find(const TransitionKey& key) {
  const auto found = members_.find(key);
  return found == members_.end() ? nullptr : &found->second;
}

ResultGroup::Members ResultGroup::commit() {
  PALPATE_ASSERT(since_.has_value() == !members_.empty(), "the first member starts the clock");
  std::vector<StoredResult> results;
  for (auto& [key, member] : members_) {
    member.result.where =
        journal_->append(member.result.header.SerializeAsString(), member.payload);
    results.push_back(member.result);
  }
  journal_->sync();
  // Only now: a row whose record the disk may still lose would be a hole that no replay can fill.
  store_->record(results, journal_->end());
  since_.reset();
  return std::exchange(members_, {});
}

}  // namespace palpate
