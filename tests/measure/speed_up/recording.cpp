#include "tests/measure/speed_up/recording.hpp"

#include "common/base/error.hpp"

namespace palpate::speed_up {

Recording::Recording(const std::filesystem::path& directory)
    : directory_(directory), tables_(directory), problem_(decodeProblem(tables_.build().problem)) {
  const JournalReader journal(directory);
  const auto take = [&](const ResultKey& key, wire::Result result, const Outcome& outcome) {
    kernel_family_ = result.kernel_family();
    // Fields added by the scheduler, which adds them again.
    result.clear_given_by();
    result.clear_steps();
    result.clear_start_parent();
    const double seconds = outcome.cost.seconds;
    seconds_ += seconds;
    solves_[key] = {std::move(result), outcome, "", seconds};
  };
  const RecordedResults recorded = readResults(directory, tables_.build().build, take);
  if (solves_.empty()) throw badInput("{}: nothing is recorded there", directory.string());
  for (auto& [key, solve] : solves_) solve.payload = journal.read(recorded.where.at(key)).payload;
}

double Recording::longest() const {
  double longest = 0;
  for (const auto& [key, solve] : solves_) longest = std::max(longest, solve.seconds);
  return longest;
}

void Recording::cutAt(double longest_seconds) {
  seconds_ = 0;
  for (auto& [key, solve] : solves_) {
    solve.seconds = std::min(solve.seconds, longest_seconds);
    seconds_ += solve.seconds;
  }
}

void Recording::scaleTo(double mean_seconds) {
  const double factor = mean_seconds * static_cast<double>(size()) / seconds_;
  for (auto& [key, solve] : solves_) solve.seconds *= factor;
  seconds_ *= factor;
}

const Recording::Solve& Recording::find(const ResultKey& key) const {
  const auto found = solves_.find(key);
  if (found != solves_.end()) return found->second;
  throw failure(
      "{}: {} is not recorded: let palpate build come to its end there, with this version",
      directory_.string(), textOf(key));
}

}  // namespace palpate::speed_up
