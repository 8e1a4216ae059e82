#pragma once

#include <functional>
#include <string>
#include <vector>

#include "common/base/assertion.hpp"
#include "common/wire/wire.hpp"

/// Results as workers deliver them that are broken, or lie, for tests of what finds them out.
namespace palpate::test {

/// Falsifies a result that an honest worker found: its header and its payload.
using Lie = std::function<void(wire::Result&, std::string& payload)>;

/// Of a result with another outcome.
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

/// What a result says of forces, and so what a hand feels, falsified by a tenth or more; and a
/// failure where there is none.
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
