#include "scheduler/state/job_store.hpp"

#include <spdlog/spdlog.h>

#include "common/base/assertion.hpp"
#include "common/wire/wire.hpp"

namespace palpate {

JobStore::JobStore(const StateDirectory& directory, const Problem& problem,
                   std::uint64_t segment_bytes)
    : directory_(&directory),
      // Open the tables first: if the directory belongs to another build, their message names it.
      tables_(directory, problem),
      kept_out_(tables_.keptOut()),
      found_(replayJournal(directory.path(), problem, tables_.build().build, kept_out_,
                           tables_.progress().value_or(Progress()).recorded)),
      journal_(directory.path(), found_.recorded.end, segment_bytes) {
  journal_.dropAll(std::exchange(found_.recorded.torn, {}));
  for (const std::string& damage : found_.recorded.damage)
    spdlog::warn("{}; the results recorded there are computed again", damage);
  dropWhatLiarsGave();
}

void JobStore::dropWhatLiarsGave() {
  const std::vector<ResultKey> theirs = std::exchange(found_.of_liars, {});
  if (theirs.empty()) return;
  drop(theirs);
  found_.recorded.damage.push_back(
      fmt::format("{} results of excluded workers are dropped", theirs.size()));
}

void JobStore::drop(const JournalPosition& damaged) {
  tables_.forgetProgress();
  journal_.drop(damaged);
}

void JobStore::drop(const std::vector<ResultKey>& keys) {
  if (keys.empty()) return;
  tables_.forgetProgress();
  std::vector<JournalPosition> positions;
  for (const ResultKey& key : keys) {
    const auto where = found_.recorded.where.find(key);
    PALPATE_ASSERT(where != found_.recorded.where.end(), "only recorded results can be dropped");
    positions.push_back(where->second);
    found_.recorded.where.erase(where);
  }
  journal_.dropAll(std::move(positions));
}

void JobStore::append(const wire::Result& header, std::string_view payload) {
  const ResultKey key = keyOf(header);
  PALPATE_ASSERT(!knows(key), "a transition must have only one recorded result");
  PALPATE_ASSERT(header.lease().empty(), "a lease must not be recorded");
  appended_.emplace_back(key, journal_.append(header.SerializeAsString(), payload));
  found_.kernel_family = header.kernel_family();
}

void JobStore::commit() {
  journal_.sync();
  for (const auto& [key, where] : appended_) {
    const bool fresh = found_.recorded.where.emplace(key, where).second;
    PALPATE_ASSERT(fresh, "a group must have only one result per transition");
  }
  appended_.clear();
}

std::optional<JournalRecord> JobStore::find(const ResultKey& key) const {
  const auto where = found_.recorded.where.find(key);
  if (where == found_.recorded.where.end()) return std::nullopt;
  return journal_.read(where->second);
}

std::optional<wire::Result> JobStore::read(const ResultKey& key) const {
  return readRecorded(journal_, found_.recorded.where, key);
}

void JobStore::checkPresence() const {
  directory_->checkPresence();
  journal_.checkPresence();
}

}  // namespace palpate
