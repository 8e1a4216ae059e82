#include "scheduler/recorded_build.hpp"

#include <spdlog/spdlog.h>

#include <algorithm>

namespace palpate {

RecordedBuild::RecordedBuild(std::filesystem::path directory)
    : directory_(std::move(directory)),
      journal_(directory_),
      tables_(directory_),
      problem_(decodeProblem(tables_.build().problem)) {
  RecordedResults recorded = readResults(directory_, tables_.build().build);
  for (const std::string& damage : recorded.damage)
    spdlog::warn("{}; what was recorded there will be computed again", damage);
  for (const ResultKey& key : givenBy(tables_.keptOut(), recorded.results))
    recorded.results.erase(key);
  if (!recorded.results.empty())
    kernel_family_ = recorded.results.begin()->second.header.kernel_family();
  where_ = std::move(recorded.where);
  plans_ = replay(problem_, std::move(recorded.results)).plans;
}

bool RecordedBuild::complete() {
  return tables_.checks().empty() && std::ranges::all_of(plans_, &SpacePlan::complete);
}

std::optional<JournalRecord> RecordedBuild::find(const ResultKey& key) const {
  const auto found = where_.find(key);
  if (found == where_.end()) return std::nullopt;
  return journal_.read(found->second);
}

std::vector<SpaceTable> RecordedBuild::seal(const std::filesystem::path& file) {
  if (kernel_family_.empty())
    throw failure("{}: nothing is recorded there yet", directory_.string());
  return sealPlans(
      file, problem_, plans_, kernel_family_, [&](const ResultKey& key) { return find(key); },
      !complete());
}

}  // namespace palpate
