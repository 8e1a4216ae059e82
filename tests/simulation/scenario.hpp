#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <utility>

#include "common/problem/problem.hpp"
#include "common/space/result_key.hpp"
#include "common/wire/wire.hpp"

namespace palpate::simulation {

/// What an honest worker finds: the header of its result, and the payload.
using Solver = std::pair<wire::Result, std::string> (*)(const Problem&, std::uint32_t space,
                                                        const LatticePoint& target,
                                                        const LatticePoint& parent);
/// Results that differ from what an honest worker finds.
using FalseResults = std::map<ResultKey, wire::Result>;

/// What a service is asked to build, and what becomes of it undisturbed.
struct Scenario {
  Problem problem;
  Solver solve = nullptr;
  std::string sealed;  ///< the bytes of the dataset

  /// Neighbours contradict each other, solves fail, branches are looked for, and payloads hold the
  /// bytes of a record.
  static Scenario rough(const std::filesystem::path& folder);
  /// Every result follows from those beside it, as in tissue: what does not, looks odd.
  static Scenario smooth(const std::filesystem::path& folder);

  /// The bytes of the dataset if these were found instead. Writes into `folder`, which no simulated
  /// disk may be at.
  std::string sealedWith(const FalseResults& instead, const std::filesystem::path& folder) const;
};

/// The same for all seeds.
struct Scenarios {
  explicit Scenarios(const std::filesystem::path& folder)
      : rough(Scenario::rough(folder)), smooth(Scenario::smooth(folder)) {}
  /// The one of a seed: where one may lie it is smooth, because nothing looks odd in the other.
  const Scenario& of(std::uint64_t seed) const;

  Scenario rough, smooth;
};

}  // namespace palpate::simulation
