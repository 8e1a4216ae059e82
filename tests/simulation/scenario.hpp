#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <utility>

#include "common/problem/problem.hpp"
#include "common/space/result_key.hpp"
#include "common/wire/wire.hpp"

namespace palpate::simulation {

/// Computes an honest worker's result: its header and its payload.
using Solver = std::pair<wire::Result, std::string> (*)(const Problem&, std::uint32_t space,
                                                        const LatticePoint& target,
                                                        const LatticePoint& parent);
/// Results that differ from those of an honest worker.
using FalseResults = std::map<ResultKey, wire::Result>;

/// A problem for the service, and its dataset when nothing disturbs the build.
struct Scenario {
  Problem problem;
  Solver solve = nullptr;
  std::string sealed;  ///< the bytes of the dataset

  /// A scenario with inconsistent neighbours, failing solves, searches for branches, and payloads
  /// that contain the bytes of a record.
  static Scenario rough(const std::filesystem::path& folder);
  /// A scenario in which, as in tissue, each result is consistent with its neighbours, so that
  /// inconsistent results look odd (oddnessBeside).
  static Scenario smooth(const std::filesystem::path& folder);

  /// Returns the bytes of the dataset in which these results replace the honest ones. Writes into
  /// `folder`, which must not be on a simulated disk.
  std::string sealedWith(const FalseResults& instead, const std::filesystem::path& folder) const;
};

/// The scenarios that all seeds share.
struct Scenarios {
  explicit Scenarios(const std::filesystem::path& folder)
      : rough(Scenario::rough(folder)), smooth(Scenario::smooth(folder)) {}
  /// Returns the scenario of a seed: smooth if a worker may lie, because nothing looks odd in the
  /// rough one.
  const Scenario& of(std::uint64_t seed) const;

  Scenario rough, smooth;
};

}  // namespace palpate::simulation
