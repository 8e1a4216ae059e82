#include "scheduler/state/result_group.hpp"

#include "common/base/assertion.hpp"
#include "common/wire/wire.hpp"

namespace palpate {

void ResultGroup::add(const ResultKey& key, Member member, Time now) {
  PALPATE_ASSERT(key == keyOf(member.result), "a result must be filed under its own key");
  PALPATE_ASSERT(member.payload.size() == member.result.payload_bytes(),
                 "a payload must have its announced length");
  bytes_ += member.payload.size();
  const bool fresh = members_.try_emplace(key, std::move(member)).second;
  PALPATE_ASSERT(fresh, "a group must have only one result per transition");
  if (!since_) since_ = now;
}

ResultGroup::Member* ResultGroup::find(const ResultKey& key) {
  const auto found = members_.find(key);
  return found == members_.end() ? nullptr : &found->second;
}

ResultGroup::Members ResultGroup::commit() {
  PALPATE_ASSERT(since_.has_value() == !members_.empty(),
                 "a group must have a start time if it has results");
  for (const auto& [key, member] : members_) store_->append(member.result, member.payload);
  store_->commit();
  since_.reset();
  bytes_ = 0;
  return std::exchange(members_, {});
}

}  // namespace palpate
