#include "scheduler/builds/recorded_build.hpp"

#include <spdlog/spdlog.h>

#include <algorithm>

#include "common/base/assertion.hpp"

namespace palpate {

RecordedBuild::RecordedBuild(std::filesystem::path directory)
    : directory_(std::move(directory)),
      journal_(directory_),
      tables_(std::in_place, directory_),
      problem_(decodeProblem(tables_->build().problem)) {
  std::vector<KeptOut> liars;
  do {
    liars = tables_->keptOut();
    found_ = replayJournal(directory_, problem_, tables_->build().build, liars,
                           tables_->progress().value_or(Progress()).recorded);
    for (const std::string& damage : found_->recorded.damage)
      spdlog::warn("{}; the results recorded there will be computed again", damage);
    // A scheduler stores a check in the tables before its result enters the journal. Tables opened
    // after the journal was read therefore hold every check of the results found, and every
    // exclusion made meanwhile.
    tables_.emplace(directory_);
  } while (tables_->keptOut() != liars);
  PALPATE_ASSERT(plans().size() == problem_.active.size(), "each active node must have a plan");
}

bool RecordedBuild::complete() {
  return tables_->checks().empty() && std::ranges::all_of(plans(), &SpacePlan::complete);
}

std::optional<JournalRecord> RecordedBuild::find(const ResultKey& key) const {
  const auto found = found_->recorded.where.find(key);
  if (found == found_->recorded.where.end()) return std::nullopt;
  return journal_.read(found->second);
}

SpaceRowsList RecordedBuild::seal(const std::filesystem::path& file) {
  if (kernelFamily().empty())
    throw failure("{}: no result is recorded there yet", directory_.string());
  return sealPlans(
      file, problem_, plans(), kernelFamily(), [&](const ResultKey& key) { return find(key); },
      !complete());
}

wire::Status progressIn(const std::filesystem::path& directory) {
  if (const auto kept = StoredTables(directory).progress()) try {
      return statusFromJson(kept->status, directory.string());
    } catch (const Error&) {
      // The stored status is damaged: compute it from the journal.
    }
  RecordedBuild build(directory);
  return progressOf(build.problem(), build.tables().build().build, build.plans(),
                    build.kernelFamily(), build.complete());
}

}  // namespace palpate
