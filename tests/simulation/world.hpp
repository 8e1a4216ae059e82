#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "tests/simulation/scheduler.hpp"

namespace palpate::simulation {

/// The same for all seeds: the problem, and what becomes of it undisturbed.
struct Scenario {
  Problem problem;
  std::string sealed;  ///< the bytes of the dataset
};
/// Builds it once, in a folder that is empty.
Scenario makeScenario(const std::filesystem::path& folder);

struct Outcome {
  std::optional<std::string> broken;  ///< what must not happen, and did
  Seconds simulated = 0;
  std::map<Accident, std::uint64_t> felt;
  std::vector<std::string> story;  ///< what happened, for people
};

/// Simulates a service under one seed, with the accidents that are given, until its dataset is
/// sealed and all have gone home. `folder` is used and emptied.
Outcome simulate(const Scenario& scenario, std::uint64_t seed, const std::vector<Event>& history,
                 const std::filesystem::path& folder);

}  // namespace palpate::simulation
