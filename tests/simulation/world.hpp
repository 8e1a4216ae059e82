#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "tests/simulation/scheduler.hpp"

namespace palpate::simulation {

struct Outcome {
  std::optional<std::string> broken;  ///< what must not happen, and did
  Seconds simulated = 0;
  std::map<Accident, std::uint64_t> felt;
  std::size_t lies = 0;            ///< results that the scheduler was given and that were wrong
  std::size_t verdicts = 0;        ///< on who lied
  bool spoiled = false;            ///< what was sealed rests on lies that nobody found out
  bool tables_hurt = false;        ///< and with them what they knew of checks and liars
  std::vector<std::string> story;  ///< what happened, for people
};

/// Simulates a service under one seed, with the accidents that are given, until its dataset is
/// sealed and all have gone home. `folder` is used and emptied.
Outcome simulate(const Scenarios& scenarios, std::uint64_t seed, const std::vector<Event>& history,
                 const std::filesystem::path& folder);

}  // namespace palpate::simulation
