#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "tests/simulation/scheduler.hpp"

namespace palpate::simulation {

struct Outcome {
  std::optional<std::string> broken;  ///< the promise that was broken
  Seconds simulated = 0;
  std::map<Accident, std::uint64_t> felt;
  std::size_t lies = 0;            ///< false results that the scheduler received
  std::size_t verdicts = 0;        ///< verdicts on liars
  bool spoiled = false;            ///< the sealed dataset contains undetected lies
  bool tables_hurt = false;        ///< the tables, which list checks and liars, were damaged
  std::vector<std::string> story;  ///< the events, human-readable
};

/// Simulates a service under one seed with these accidents, until its dataset is sealed and all
/// processes have ended. Uses and empties `folder`.
Outcome simulate(const Scenarios& scenarios, std::uint64_t seed, const std::vector<Event>& history,
                 const std::filesystem::path& folder);

}  // namespace palpate::simulation
