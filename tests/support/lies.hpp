#pragma once

#include <functional>
#include <string>
#include <vector>

#include "common/base/assertion.hpp"
#include "common/wire/wire.hpp"

/// Broken or falsified results of workers, for tests of their detection.
namespace palpate::test {

/// Falsifies the header and payload of an honest worker's result.
using Lie = std::function<void(wire::Result&, std::string& payload)>;

/// A lie that changes the outcome of a result.
inline Lie lieAbout(const std::function<void(Outcome&)>& falsify) {
  return [falsify](wire::Result& result, std::string& payload) {
    std::optional<Outcome> outcome = fromWire(result);
    PALPATE_ASSERT(outcome && outcome->converged(), "honest workers find an equilibrium there");
    falsify(*outcome);
    if (!outcome->converged()) {
      payload.clear();
      result.clear_fields_id();
    }
    toWire(*outcome, payload, result);
    if (!outcome->converged()) result.clear_payload_bytes();
  };
}

/// Lies that change the force, energy or stiffness by a tenth or more, and one that reports a
/// failure instead of an equilibrium.
inline const std::vector<Lie>& lies() {
  static const std::vector<Lie> all = {
      lieAbout([](Outcome& o) { o.configuration().equilibrium.force *= 1.1; }),
      lieAbout([](Outcome& o) { o.configuration().equilibrium.energy *= 1.1; }),
      lieAbout([](Outcome& o) { o.configuration().equilibrium.stiffness *= 1.2; }),
      lieAbout([](Outcome& o) {
        o.end = Failure{.cause = Cause::iteration_limit, .step_reached = 0.5};
      })};
  return all;
}

}  // namespace palpate::test
